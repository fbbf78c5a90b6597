//! The lanes as pictures: translucent boxes over the hero or boxes in strips beside it, the reference as
//! a dashed white frame, fading trails, and a tag with name and error for each.
//!
//! Nothing here is simulated or read back: in the lanes layout only the picture is shifted.

use std::collections::VecDeque;

use bevy::prelude::*;
use bevy_egui::{EguiContexts, EguiPrimaryContextPass, egui};
use box_physics::prelude::{BodyState, Integrator, RigidBox};

use crate::compare::track::Track;
use crate::compare::{Comparison, Layout, Quantity, Run};
use crate::demo::Demo2012;
use crate::session::Session;
use crate::style;
use crate::visuals::painted_cuboid;

/// Opacity of a ghost.
const GHOST: f32 = 0.16;
/// How much of the past a trail shows \[s\], and how many points it has at most.
const TRAIL: f64 = 1.5;
const TRAIL_POINTS: usize = 96;
/// Distance of two lanes, and width of a strip, in radii of the box.
const PITCH: f32 = 2.7;
const STRIP: f32 = 2.3;
/// Dashes along an edge of the reference.
const DASHES: usize = 6;
/// The picture goes this much farther away for each lane beside the hero.
const STEP_BACK: f32 = 0.4;

/// Draws the lanes of a [`Comparison`] over the picture of the first 3-D camera. Needs a renderer and
/// [`ComparePlugin`](crate::compare::ComparePlugin); tags need `EguiPlugin`.
pub struct GhostPlugin;

impl Plugin for GhostPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Trails>().add_systems(
            Update,
            (place_ghosts, place_strips, lengthen_trails, draw_frames).chain(),
        );
        if app.is_plugin_added::<bevy_egui::EguiPlugin>() {
            app.add_systems(EguiPrimaryContextPass, draw_tags);
        }
    }
}

/// The box of a lane; once spawned it stays, and is hidden when it is not wanted.
#[derive(Component, Clone, Copy, Debug)]
pub struct Ghost(pub Integrator);

/// The ground under a lane.
#[derive(Component, Clone, Copy, Debug)]
pub struct Strip(pub Integrator);

/// Where the marked point of every trajectory has been, newest last; the hero's first.
#[derive(Resource, Default)]
struct Trails {
    points: Vec<(Integrator, VecDeque<(f64, Vec3)>)>,
}

/// Every trajectory that is drawn: scheme, state, books, by how much its picture is shifted.
fn shown(run: &Run, layout: Layout) -> Vec<(Integrator, &BodyState, &Track, Vec3)> {
    let hero = (
        run.hero.integrator,
        &run.hero.state,
        &run.hero.track,
        Vec3::ZERO,
    );
    let side = sideways(run) * PITCH * run.law.body.radius() as f32;
    let lanes = run.lanes.iter().enumerate().map(|(k, r)| {
        let offset = match layout {
            Layout::Lanes => side * place(k),
            Layout::Solo | Layout::Ghosts => Vec3::ZERO,
        };
        (r.lane.integrator, &r.lane.state, &r.track, offset)
    });
    let beside = if layout == Layout::Solo {
        0
    } else {
        run.lanes.len()
    };
    [hero].into_iter().chain(lanes.take(beside)).collect()
}

/// Right, left, right, left of the hero.
fn place(k: usize) -> f32 {
    let ring = (k / 2 + 1) as f32;
    if k.is_multiple_of(2) { ring } else { -ring }
}

/// Across the motion, horizontally.
fn sideways(run: &Run) -> Vec3 {
    let v = run.start().velocity.as_vec3();
    let along = Vec3::new(v.x, 0.0, v.z);
    if along.length() > 0.1 {
        along.cross(Vec3::Y).normalize()
    } else {
        Vec3::X
    }
}

fn color(integrator: Integrator, alpha: f32) -> Color {
    let [r, g, b] = style::of(integrator).rgb;
    Color::srgb_u8(r, g, b).with_alpha(alpha)
}

/// A box for every lane, where the lane is.
fn place_ghosts(
    comparison: Res<Comparison>,
    mut ghosts: Query<(
        &Ghost,
        &mut Transform,
        &mut Visibility,
        &mut Mesh3d,
        &mut MeshMaterial3d<StandardMaterial>,
    )>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut made: Local<Option<(Vec3, [Handle<Mesh>; 2], Handle<StandardMaterial>)>>,
    mut tints: Local<Vec<(Integrator, Handle<StandardMaterial>)>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let half = run.law.body.half_extents().as_vec3();
    let fits = made.as_ref().is_some_and(|(size, ..)| *size == half);
    if !fits {
        let plain = meshes.add(Cuboid::from_size(half * 2.0));
        let painted = meshes.add(painted_cuboid(half));
        let white = match made.take() {
            Some((_, _, white)) => white,
            None => materials.add(StandardMaterial {
                perceptual_roughness: 0.6,
                ..default()
            }),
        };
        *made = Some((half, [plain, painted], white));
    }
    let Some((_, [plain, painted], white)) = &*made else {
        return;
    };
    let layout = comparison.settings.layout;
    let wanted = shown(run, layout);
    let mut tint = |i: Integrator| match tints.iter().find(|(s, _)| *s == i) {
        Some((_, tint)) => tint.clone(),
        None => {
            let tint = materials.add(StandardMaterial {
                base_color: color(i, GHOST),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            });
            tints.push((i, tint.clone()));
            tint
        }
    };
    let mut missing: Vec<_> = wanted[1..].to_vec();
    for (ghost, mut transform, mut visibility, mut mesh, mut material) in &mut ghosts {
        let found = missing.iter().position(|(i, ..)| *i == ghost.0);
        let Some(k) = found else {
            visibility.set_if_neq(Visibility::Hidden);
            continue;
        };
        let (integrator, state, _, offset) = missing.swap_remove(k);
        *transform = pose(state, offset);
        visibility.set_if_neq(Visibility::Visible);
        let (shape, look) = match layout {
            Layout::Lanes => (painted, white.clone()),
            Layout::Solo | Layout::Ghosts => (plain, tint(integrator)),
        };
        if mesh.0 != *shape {
            mesh.0 = shape.clone();
        }
        if material.0 != look {
            material.0 = look;
        }
    }
    for (integrator, state, _, offset) in missing {
        commands.spawn((
            Ghost(integrator),
            Mesh3d(plain.clone()),
            MeshMaterial3d(tint(integrator)),
            pose(state, offset),
            bevy::light::NotShadowCaster,
        ));
    }
}

fn pose(state: &BodyState, offset: Vec3) -> Transform {
    Transform::from_translation(state.position.as_vec3() + offset)
        .with_rotation(state.rotation.as_quat())
}

/// The ground under every lane, and the picture far enough away to show them all.
fn place_strips(
    comparison: Res<Comparison>,
    mut strips: Query<(&Strip, &mut Transform, &mut Visibility)>,
    mut cameras: Query<&mut crate::camera::OrbitCamera>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    session: Option<Res<Session>>,
    mut plane: Local<Option<Handle<Mesh>>>,
    mut away: Local<Option<(String, f32)>>,
    mut commands: Commands,
) {
    let Some(run) = &comparison.run else {
        return;
    };
    let layout = comparison.settings.layout;
    let lanes = layout == Layout::Lanes;
    let radius = run.law.body.radius() as f32;
    let across = sideways(run);
    let start = run.start();
    let moving = start.velocity.length() > 0.1;
    let ground = match run.law.floor {
        Some(floor) => floor.height as f32 + 0.004,
        None => start.position.y as f32 - 1.5 * radius,
    };
    let size = Vec3::new(
        STRIP * radius,
        1.0,
        if moving { 40.0 } else { 3.5 } * radius,
    );
    let mut missing: Vec<_> = if lanes {
        shown(run, layout).iter().map(|s| (s.0, s.3)).collect()
    } else {
        Vec::new()
    };
    let at = |offset: Vec3| {
        let origin = start.position.as_vec3();
        Transform::from_xyz(origin.x + offset.x, ground, origin.z + offset.z)
            .with_rotation(Quat::from_rotation_arc(Vec3::X, across))
            .with_scale(size)
    };
    for (strip, mut transform, mut visibility) in &mut strips {
        match missing.iter().position(|(i, _)| *i == strip.0) {
            Some(k) => {
                *transform = at(missing.swap_remove(k).1);
                visibility.set_if_neq(Visibility::Visible);
            }
            None => {
                visibility.set_if_neq(Visibility::Hidden);
            }
        }
    }
    for (integrator, offset) in missing {
        let plane = plane
            .get_or_insert_with(|| meshes.add(Plane3d::new(Vec3::Y, Vec2::splat(0.5))))
            .clone();
        commands.spawn((
            Strip(integrator),
            Mesh3d(plane),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color: color(integrator, 0.35),
                alpha_mode: AlphaMode::Blend,
                unlit: true,
                ..default()
            })),
            at(offset),
            bevy::light::NotShadowCaster,
        ));
    }
    let factor = if lanes {
        1.0 + STEP_BACK * run.lanes.len() as f32
    } else {
        1.0
    };
    let scene = session.map_or_else(String::new, |s| s.scenario.id.to_owned());
    // A new scene has just brought its own camera.
    let before = match &*away {
        Some((old, factor)) if *old == scene => *factor,
        _ => 1.0,
    };
    if factor != before {
        for mut camera in &mut cameras {
            camera.distance *= factor / before;
        }
    }
    *away = Some((scene, factor));
}

/// Follows a point of every trajectory: the centre where the box travels, else the tip of its longest
/// edge, which shows a flip.
fn lengthen_trails(comparison: Res<Comparison>, mut trails: ResMut<Trails>) {
    let Some(run) = &comparison.run else {
        return;
    };
    let tip = tip(run);
    let now = run.clock;
    let wanted = shown(run, comparison.settings.layout);
    trails
        .points
        .retain(|(i, _)| wanted.iter().any(|(j, ..)| i == j));
    for (integrator, state, ..) in wanted {
        let k = match trails.points.iter().position(|(i, _)| *i == integrator) {
            Some(k) => k,
            None => {
                trails.points.push((integrator, VecDeque::new()));
                trails.points.len() - 1
            }
        };
        let points = &mut trails.points[k].1;
        // A restart, or a step back.
        while points.back().is_some_and(|(t, _)| *t > now) {
            points.pop_back();
        }
        if points
            .back()
            .is_none_or(|(t, _)| now - t > TRAIL / TRAIL_POINTS as f64)
        {
            points.push_back((now, state.point(tip).as_vec3()));
        }
        while points.front().is_some_and(|(t, _)| now - t > TRAIL) {
            points.pop_front();
        }
    }
}

/// The point that trails and tags follow, body axes \[m\].
fn tip(run: &Run) -> bevy::math::DVec3 {
    let start = run.start();
    let travels = start.velocity.length() > 0.1
        || run.law.floor.is_some()
        || run.law.forces.gravity.length() > 0.0;
    let half = run.law.body.half_extents();
    if travels {
        bevy::math::DVec3::ZERO
    } else if half.x >= half.y && half.x >= half.z {
        bevy::math::DVec3::X * half.x
    } else if half.y >= half.z {
        bevy::math::DVec3::Y * half.y
    } else {
        bevy::math::DVec3::Z * half.z
    }
}

/// Edges of ghosts and of the reference, and the trails.
fn draw_frames(comparison: Res<Comparison>, trails: Res<Trails>, mut gizmos: Gizmos) {
    let Some(run) = &comparison.run else {
        return;
    };
    let layout = comparison.settings.layout;
    if layout == Layout::Solo {
        return;
    }
    let body = &run.law.body;
    for (k, (integrator, state, _, offset)) in shown(run, layout).into_iter().enumerate() {
        if k > 0 && layout == Layout::Ghosts {
            for [a, b] in edges(body, state, offset) {
                gizmos.line(a, b, color(integrator, 0.95));
            }
        }
        if let (Some(reference), true) = (run.trusted(), k == 0 || layout == Layout::Lanes) {
            for [a, b] in edges(body, reference, offset) {
                for d in 0..DASHES {
                    let part = |s: f32| a.lerp(b, s / DASHES as f32);
                    let from = d as f32;
                    gizmos.line(part(from), part(from + 0.55), Color::WHITE);
                }
            }
        }
        let Some((_, points)) = trails.points.iter().find(|(i, _)| *i == integrator) else {
            continue;
        };
        let count = points.len().max(2) as f32;
        gizmos.linestrip_gradient(
            points
                .iter()
                .enumerate()
                .map(|(n, (_, at))| (*at + offset, color(integrator, n as f32 / (count - 1.0)))),
        );
    }
}

/// The twelve edges.
fn edges(body: &RigidBox, state: &BodyState, offset: Vec3) -> [[Vec3; 2]; 12] {
    let half = body.half_extents();
    let corner = |k: usize| {
        let sign = |bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
        let local = half * bevy::math::DVec3::new(sign(1), sign(2), sign(4));
        state.point(local).as_vec3() + offset
    };
    let mut found = [[Vec3::ZERO; 2]; 12];
    let mut n = 0;
    for k in 0..8 {
        for bit in [1, 2, 4] {
            if k & bit == 0 {
                found[n] = [corner(k), corner(k | bit)];
                n += 1;
            }
        }
    }
    found
}

/// Name and error at every box. The tags of ghosts, which are all in one place, stand in a column
/// beside them, each with a line to its box.
fn draw_tags(
    comparison: Res<Comparison>,
    session: Option<Res<Session>>,
    demo: Option<Res<Demo2012>>,
    mut contexts: EguiContexts,
    camera: Query<(&Camera, &GlobalTransform), With<Camera3d>>,
    window: Query<&Window>,
) -> Result {
    let (Some(run), Some((camera, eye))) = (&comparison.run, camera.iter().next()) else {
        return Ok(());
    };
    let layout = comparison.settings.layout;
    if layout == Layout::Solo || run.lanes.is_empty() {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let scale = window.iter().next().map_or(1.0, Window::scale_factor) / context.pixels_per_point();
    let Some(view) = camera.logical_viewport_rect() else {
        return Ok(());
    };
    let point = |v: Vec2| egui::pos2(v.x * scale, v.y * scale);
    let view = egui::Rect::from_min_max(point(view.min), point(view.max));
    let painter = context
        .layer_painter(egui::LayerId::new(egui::Order::Background, "tags".into()))
        .with_clip_rect(view);
    let tip = tip(run);
    let radius = run.law.body.radius() as f32;
    let seen = |at: Vec3| camera.world_to_viewport(eye, at).ok().map(point);
    let attitude = run.attitude_says_more();
    let mut taken: Vec<egui::Rect> = Vec::new();
    // Below the one line that a hidden panel leaves.
    let hidden = session.as_ref().is_some_and(|s| s.hidden);
    // The demo of 2012 moves its box itself.
    let stepper = match (&demo, &session) {
        (Some(demo), Some(session)) => demo.active(session),
        _ => None,
    };
    let line = if hidden { 46.0 } else { 10.0 };
    let mut next = view.top() + line;
    for (k, (integrator, state, track, offset)) in shown(run, layout).into_iter().enumerate() {
        let name = match stepper {
            Some(stepper) if k == 0 => stepper.name().to_owned(),
            _ => style::tagged(integrator),
        };
        let text = tag(name, k == 0, track, attitude);
        let centre = state.position.as_vec3() + offset;
        let font = egui::FontId::proportional(13.0);
        let looks = style::of(integrator).color();
        let galley = painter.layout_no_wrap(text, font, egui::Color32::WHITE);
        let size = galley.size() + egui::vec2(12.0, 6.0);
        let corner = match layout {
            Layout::Lanes => {
                let Some(above) = seen(centre + Vec3::Y * radius * 1.25) else {
                    continue;
                };
                let mut corner = egui::pos2(above.x - 0.5 * size.x, above.y - size.y);
                // Above those that are there already.
                while let Some(other) = taken
                    .iter()
                    .find(|t| t.intersects(egui::Rect::from_min_size(corner, size)))
                {
                    corner.y = other.top() - size.y - 2.0;
                }
                corner
            }
            Layout::Solo | Layout::Ghosts => {
                let corner = egui::pos2(view.left() + 12.0, next);
                next += size.y + 4.0;
                let from = egui::pos2(corner.x + size.x, corner.y + 0.5 * size.y);
                if let Some(to) = seen(state.point(tip).as_vec3() + offset) {
                    painter.line_segment(
                        [from, to],
                        egui::Stroke::new(1.0, looks.gamma_multiply(0.6)),
                    );
                }
                corner
            }
        };
        let place = egui::Rect::from_min_size(corner, size);
        taken.push(place);
        painter.rect_filled(place, 4.0, heat(track, attitude));
        painter.rect_stroke(
            place,
            4.0,
            egui::Stroke::new(if k == 0 { 2.5 } else { 1.5 }, looks),
            egui::StrokeKind::Inside,
        );
        painter.galley(corner + egui::vec2(6.0, 3.0), galley, egui::Color32::WHITE);
    }
    Ok(())
}

/// `■ RK4 · 0.13°`.
fn tag(mut text: String, hero: bool, track: &Track, attitude: bool) -> String {
    if hero {
        text.push_str(" (hero)");
    }
    if let Some(t) = track.diverged {
        return format!("{text} · DIVERGED @ t = {t:.1} s");
    }
    let (value, unit) = now(track, attitude);
    if value.is_finite() {
        text.push_str(&format!(" · {}{unit}", short(value)));
    }
    text
}

/// Two significant digits; a tag is read in passing.
fn short(value: f64) -> String {
    match value {
        v if v < 1e-11 => "0".to_owned(),
        v if v < 1e-3 => format!("{v:.0e}"),
        v if v < 0.1 => format!("{v:.3}"),
        v if v < 10.0 => format!("{v:.2}"),
        v => format!("{v:.0}"),
    }
}

fn now(track: &Track, attitude: bool) -> (f64, &'static str) {
    let sample = &track.now.sample;
    if attitude {
        (sample.get(Quantity::Attitude), "°")
    } else {
        (sample.get(Quantity::Position), " m")
    }
}

/// The tag's ground: dark green where the error cannot be seen, dark red where the pose is lost.
fn heat(track: &Track, attitude: bool) -> egui::Color32 {
    let (value, _) = now(track, attitude);
    let lost = if attitude { 90.0 } else { 1.0 };
    // Four decades from harmless to lost.
    let share = if track.diverged.is_some() {
        1.0
    } else {
        ((value.max(1e-12) / lost).log10() / 4.0 + 1.0).clamp(0.0, 1.0) as f32
    };
    let mix = |a: f32, b: f32| (a + (b - a) * share) as u8;
    egui::Color32::from_rgba_unmultiplied(mix(18.0, 120.0), mix(64.0, 22.0), mix(40.0, 26.0), 225)
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_scenarios::Scenario;

    #[test]
    fn a_box_has_twelve_edges_of_its_size() {
        let body = RigidBox::new(bevy::math::DVec3::new(0.5, 0.25, 0.125), 1.0).expect("valid");
        let state = BodyState::default().with_rotation(bevy::math::DQuat::from_rotation_x(0.7));
        let lengths = edges(&body, &state, Vec3::X).map(|[a, b]| a.distance(b));
        for size in [1.0, 0.5, 0.25] {
            let count = lengths.iter().filter(|l| (*l - size).abs() < 1e-5);
            assert_eq!(count.count(), 4, "{size}");
        }
    }

    /// Only the picture is shifted: the states drawn are those simulated.
    #[test]
    fn lanes_stand_side_by_side_in_the_picture_alone() {
        let setup = Scenario::find("slide").expect("a scene").setup;
        let mut run = Run::new(&setup, None, Integrator::Split, 1.0 / 60.0);
        run.choose([
            Integrator::Rk4,
            Integrator::ExplicitEuler,
            Integrator::Midpoint,
        ]);
        let places: Vec<_> = shown(&run, Layout::Lanes);
        assert_eq!(places.len(), 4);
        for (k, a) in places.iter().enumerate() {
            assert_eq!(a.1, &setup.initial);
            // Across the slide, and apart.
            assert!(a.3.x.abs() < 1e-6 && a.3.y == 0.0);
            let apart = PITCH * setup.body.radius() as f32 * 0.99;
            assert!(places[..k].iter().all(|b| a.3.distance(b.3) > apart));
        }
        assert!(
            shown(&run, Layout::Ghosts)
                .iter()
                .all(|s| s.3 == Vec3::ZERO)
        );
        assert_eq!(shown(&run, Layout::Solo).len(), 1);
    }
}
