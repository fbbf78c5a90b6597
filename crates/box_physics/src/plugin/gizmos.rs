//! Draws bounding boxes, axes, velocities and contacts of bodies (feature `gizmos`).

use bevy::app::{App, Plugin, Update};
use bevy::color::Color;
use bevy::ecs::prelude::*;
use bevy::gizmos::config::GizmoConfigGroup;
use bevy::gizmos::prelude::*;
use bevy::math::{Isometry3d, Vec3};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::time::{Fixed, Real, Time};
use bevy::transform::components::Transform;

use super::{ContactPhase, FloorContact, WorldAabb};
use crate::body::RigidBox;
use crate::state::BodyState;

/// Maximum number of boxes drawn. More would be slow and hard to read.
const MAX_DRAWN: usize = 2000;
/// Time for which a contact is displayed \[s\]; a bounce lasts only one step.
const SHOWN_FOR: f32 = 0.25;

const AABB: Color = Color::srgb_u8(240, 228, 66);
/// Body axes x, y and z, in the colors of the faces of the game's boxes.
const AXES: [(Vec3, Color); 3] = [
    (Vec3::X, Color::srgb_u8(0, 114, 178)),
    (Vec3::Y, Color::srgb_u8(230, 159, 0)),
    (Vec3::Z, Color::srgb_u8(0, 158, 115)),
];
const CONTACT: Color = Color::srgb_u8(213, 94, 0);

/// Draws what [`BodyGizmos`] selects. Requires Bevy's `GizmoPlugin` (included in `DefaultPlugins`). Parts of the
/// physics that were left out are not drawn.
///
/// ```ignore
/// App::new()
///     .add_plugins((DefaultPlugins, PhysicsPlugins::default(), BodyGizmosPlugin))
///     .add_systems(Startup, |mut gizmos: ResMut<GizmoConfigStore>| {
///         gizmos.config_mut::<BodyGizmos>().1.axes = false;
///     })
///     .run();
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyGizmosPlugin;

/// The set of the drawing systems in `Update`. Order systems that change [`BodyGizmos`] before it.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BodyGizmosSystems;

/// Selects what is drawn. This is a gizmo group: line width, depth and render layers are in Bevy's `GizmoConfigStore`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect, GizmoConfigGroup)]
#[reflect(Default)]
pub struct BodyGizmos {
    /// The [`WorldAabb`] of every body.
    pub aabbs: bool,
    /// The axes of bodies, and their velocity as the distance covered in 0.25 s.
    pub axes: bool,
    /// Contact points of bodies with [`ReportContacts`](super::ReportContacts): a cross, and an arrow whose length
    /// grows with the square root of the impulse relative to that of the body's weight in one step.
    pub contacts: bool,
    /// Draws axes and contacts of this body only; `None` draws those of all bodies.
    pub only: Option<Entity>,
}

impl Default for BodyGizmos {
    /// Draws everything for every body.
    fn default() -> Self {
        Self {
            aabbs: true,
            axes: true,
            contacts: true,
            only: None,
        }
    }
}

impl BodyGizmos {
    fn details(&self, entity: Entity) -> bool {
        self.only.is_none_or(|only| only == entity)
    }
}

impl Plugin for BodyGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<BodyGizmos>().add_systems(
            Update,
            (
                draw_aabbs,
                draw_axes,
                draw_contacts.run_if(resource_exists::<Messages<FloorContact>>),
            )
                .in_set(BodyGizmosSystems),
        );
    }
}

fn draw_aabbs(boxes: Query<&WorldAabb>, mut gizmos: Gizmos<BodyGizmos>) {
    if gizmos.config_ext.aabbs {
        for aabb in boxes.iter().take(MAX_DRAWN) {
            gizmos.aabb_3d(aabb.0, Transform::IDENTITY, AABB);
        }
    }
}

fn draw_axes(
    bodies: Query<(Entity, &RigidBox, &BodyState, &Transform)>,
    mut gizmos: Gizmos<BodyGizmos>,
) {
    let what = *gizmos.config_ext;
    if !what.axes {
        return;
    }
    let wanted = bodies.iter().filter(|b| what.details(b.0));
    for (_, body, state, transform) in wanted.take(MAX_DRAWN) {
        let at = transform.translation;
        let length = 1.4 * body.radius() as f32;
        for (axis, color) in AXES {
            gizmos.arrow(at, at + transform.rotation * axis * length, color);
        }
        gizmos.arrow(at, at + 0.25 * state.velocity.as_vec3(), Color::WHITE);
    }
}

/// A displayed contact.
struct Shown {
    entity: Entity,
    corner: usize,
    at: Vec3,
    normal: Vec3,
    /// Impulse along the normal \[N s\].
    impulse: f64,
    /// Time since the contact was reported \[s\].
    age: f32,
}

fn draw_contacts(
    mut contacts: MessageReader<FloorContact>,
    bodies: Query<&RigidBox>,
    fixed: Option<Res<Time<Fixed>>>,
    time: Res<Time<Real>>,
    mut shown: Local<Vec<Shown>>,
    mut gizmos: Gizmos<BodyGizmos>,
) {
    for contact in &mut *shown {
        contact.age += time.delta_secs();
    }
    shown.retain(|contact| contact.age < SHOWN_FOR);
    let what = *gizmos.config_ext;
    for contact in contacts.read().filter(|c| what.details(c.entity)) {
        // The end of a contact does not hide it: a bounce begins and ends in one step.
        if contact.phase == ContactPhase::Ended {
            continue;
        }
        let (entity, report) = (contact.entity, contact.report);
        let acted = |corner: usize| report.corners >> corner & 1 == 1;
        shown.retain(|old| old.entity != entity || !acted(old.corner));
        shown.extend((0..8).filter(|&k| acted(k)).map(|corner| Shown {
            entity,
            corner,
            at: report.points[corner].as_vec3(),
            normal: report.normal.as_vec3(),
            impulse: report.normal_impulses[corner],
            age: 0.0,
        }));
    }
    if !what.contacts {
        return;
    }
    let step = fixed.map_or(1.0 / 60.0, |fixed| fixed.timestep().as_secs_f64());
    let wanted = shown.iter().filter(|c| what.details(c.entity));
    for contact in wanted.take(MAX_DRAWN) {
        // The body may have been despawned.
        let Ok(body) = bodies.get(contact.entity) else {
            continue;
        };
        let at = contact.at;
        let size = 0.15 * body.radius() as f32;
        gizmos.cross(Isometry3d::from_translation(at), size, CONTACT);
        // The square root compresses the range: an impact has a hundred times the impulse that supports a resting box.
        let weight = body.mass() * 9.81 * step;
        let length = (contact.impulse / weight).sqrt().min(12.0) as f32 * 2.0 * size;
        gizmos.arrow(at, at + contact.normal * length.max(size), CONTACT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::any::TypeId;

    use crate::floor::Floor;
    use crate::plugin::{AabbPlugin, FloorPlugin, PhysicsPlugins, ReportContacts};
    use bevy::gizmos::{GizmoAsset, GizmoHandles};
    use bevy::prelude::*;
    use bevy::time::TimeUpdateStrategy;

    /// Points of the lines that the last frame drew, with their colors.
    fn drawn(app: &mut App) -> Vec<(Vec3, LinearRgba)> {
        app.update();
        let world = app.world();
        let handles = world.resource::<GizmoHandles>().handles();
        let Some(handle) = &handles[&TypeId::of::<BodyGizmos>()] else {
            return Vec::new();
        };
        let Some(asset) = world.resource::<Assets<GizmoAsset>>().get(handle) else {
            return Vec::new();
        };
        let view = asset.buffer();
        let lists = view
            .list_positions
            .iter()
            .copied()
            .zip(view.list_colors.iter().copied());
        let strips = view
            .strip_positions
            .iter()
            .copied()
            .zip(view.strip_colors.iter().copied());
        // Line strips are separated by NaN points.
        lists.chain(strips).filter(|(p, _)| p.is_finite()).collect()
    }

    fn count(points: &[(Vec3, LinearRgba)], color: Color) -> usize {
        points.iter().filter(|p| p.1 == color.to_linear()).count()
    }

    fn app_with<M>(physics: impl bevy::app::Plugins<M>) -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .add_plugins(physics)
            // The only part of `GizmoPlugin` that a group needs. The rest requires meshes.
            .init_asset::<GizmoAsset>()
            .add_plugins(BodyGizmosPlugin)
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
            .insert_resource(Floor::default());
        app
    }

    fn set(app: &mut App, what: BodyGizmos) {
        let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
        *store.config_mut::<BodyGizmos>().1 = what;
    }

    #[test]
    fn each_kind_is_drawn_where_it_is_and_can_be_switched_off() {
        let mut app = app_with(PhysicsPlugins::default());
        let lying = |x| {
            (
                RigidBox::default(),
                Transform::from_xyz(x, 0.5, 0.0),
                ReportContacts,
            )
        };
        let one = app.world_mut().spawn(lying(0.0)).id();
        app.world_mut().spawn(lying(10.0));
        for _ in 0..3 {
            app.update();
        }
        let all = drawn(&mut app);
        let near = |p: &&(Vec3, LinearRgba)| p.0.x < 5.0;
        for color in [AABB, AXES[0].1, AXES[1].1, AXES[2].1, Color::WHITE, CONTACT] {
            let left = all.iter().filter(near).filter(|p| p.1 == color.to_linear());
            assert!(left.count() * 2 == count(&all, color) && count(&all, color) > 0);
        }
        // The corners of the drawn box coincide with those of the body.
        let aabb: Vec<_> = all.iter().filter(|p| p.1 == AABB.to_linear()).collect();
        let corner = |p: &Vec3| {
            (p.y.abs() < 1e-5 || (p.y - 1.0).abs() < 1e-5) && (p.z.abs() - 0.5).abs() < 1e-5
        };
        assert!(aabb.iter().all(|p| corner(&p.0)), "{aabb:?}");

        set(
            &mut app,
            BodyGizmos {
                only: Some(one),
                ..default()
            },
        );
        let details = drawn(&mut app);
        assert_eq!(count(&details, AABB), count(&all, AABB));
        for color in [AXES[0].1, Color::WHITE, CONTACT] {
            assert_eq!(2 * count(&details, color), count(&all, color));
        }

        let nothing = BodyGizmos {
            aabbs: false,
            axes: false,
            contacts: false,
            only: None,
        };
        set(&mut app, nothing);
        assert_eq!(drawn(&mut app), []);
    }

    #[test]
    fn parts_of_the_physics_that_were_left_out_are_not_missed() {
        let plugins = PhysicsPlugins::default();
        let mut app = app_with(
            plugins
                .build()
                .disable::<AabbPlugin>()
                .disable::<FloorPlugin>(),
        );
        app.world_mut().spawn(RigidBox::default());
        app.update();
        let all = drawn(&mut app);
        assert_eq!((count(&all, AABB), count(&all, CONTACT)), (0, 0));
        assert!(count(&all, AXES[0].1) > 0);
    }
}
