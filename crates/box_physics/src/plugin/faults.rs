//! Validation of settings and components. Each fault is logged once, and nothing panics.

use core::time::Duration;

use bevy::app::App;
use bevy::ecs::bundle::Bundle;
use bevy::ecs::change_detection::{DetectChanges, Ref};
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::query::{Added, Changed, Has, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Commands, Local, Query, Res, ResMut, SystemChangeTick};
use bevy::ecs::world::World;
use bevy::time::{Real, Time, Virtual};
use bevy::transform::components::Transform;
use bevy::utils::prelude::ShortName;
use log::{info, warn};

use super::components::Checked;
use super::contacts::ContactEnabled;
use super::forces::Step;
use super::parallel::PhysicsThreads;
use super::placement::show_changes;
use super::resources::{GlobalIntegrator, PhysicsClock, Wind, WorldGravity};
use super::sets::BeforeSteps;
use super::sleeping::any_newer;
use crate::body::RigidBox;
use crate::error::InvalidValue;
use crate::floor::{ContactSettings, Floor, StaticPlane};

/// Warns at startup if there is no `Time`.
pub(crate) fn warn_without_time(time: Option<Res<Time>>) {
    if time.is_none() {
        warn!(
            "box_physics: there is no `Time` (add MinimalPlugins, DefaultPlugins or TimePlugin), so \
             nothing will move"
        );
    }
}

/// Restores settings that were removed, with their default values.
pub(crate) fn restore_resources(world: &mut World) {
    fn restore<R: Resource + Default>(world: &mut World, name: &str) {
        if !world.contains_resource::<R>() {
            world.init_resource::<R>();
            warn!("box_physics: the resource {name} was removed; its default is restored");
        }
    }
    restore::<WorldGravity>(world, "WorldGravity");
    restore::<GlobalIntegrator>(world, "GlobalIntegrator");
    restore::<PhysicsClock>(world, "PhysicsClock");
    restore::<PhysicsThreads>(world, "PhysicsThreads");
    if world.contains_resource::<ContactEnabled>() {
        restore::<ContactSettings>(world, "ContactSettings");
    }
}

/// Returns `true` if all world settings are valid. Logs each change.
pub(crate) fn settings_are_valid(world: &mut World) -> bool {
    let found = validate_settings(world).err();
    let mut clock = world.resource_mut::<PhysicsClock>();
    let known = clock.fault;
    if found.map(|f| f.field) != known.map(|f| f.field) {
        clock.fault = found;
        match found {
            Some(fault) => warn!("box_physics: nothing moves until this is corrected: {fault}"),
            None => info!("box_physics: the settings are valid again"),
        }
    }
    found.is_none()
}

fn validate_settings(world: &World) -> Result<(), InvalidValue> {
    let gravity = world.resource::<WorldGravity>().0;
    for (field, value) in [
        ("WorldGravity.x", gravity.x),
        ("WorldGravity.y", gravity.y),
        ("WorldGravity.z", gravity.z),
    ] {
        InvalidValue::check(value.is_finite(), field, value, "finite")?;
    }
    let wind = world
        .get_resource::<Wind>()
        .map_or(0.0, |wind| wind.0.length());
    InvalidValue::check(wind.is_finite(), "Wind", wind, "finite")?;
    let substeps = world.resource::<PhysicsClock>().substeps;
    InvalidValue::check(
        substeps <= MAX_SUBSTEPS,
        "PhysicsClock.substeps",
        substeps.into(),
        "at most 1024",
    )?;
    let floor = world.get_resource::<Floor>();
    if let Some(settings) = world.get_resource::<ContactSettings>() {
        if let Some(floor) = floor {
            floor.validate().map_err(named)?;
        }
        if floor.is_some() || world.resource::<Step>().has_contact() {
            settings.validate().map_err(named)?;
        }
    }
    Ok(())
}

/// Qualifies the field name with the name of its resource.
fn named(error: InvalidValue) -> InvalidValue {
    let field = match error.field {
        "height" => "Floor.height",
        "restitution" => "Floor.restitution",
        "friction" => "Floor.friction",
        "static_friction" => "Floor.static_friction",
        "velocity.x" => "Floor.velocity.x",
        "velocity.y" => "Floor.velocity.y",
        "velocity.z" => "Floor.velocity.z",
        "restitution_threshold" => "ContactSettings.restitution_threshold",
        "tolerance" => "ContactSettings.tolerance",
        "max_impacts" => "ContactSettings.max_impacts",
        "max_iterations" => "ContactSettings.max_iterations",
        other => other,
    };
    InvalidValue { field, ..error }
}

/// Maximum number of substeps per tick; more would freeze any game.
const MAX_SUBSTEPS: u32 = 1024;

/// Counts the simulated time that `Time<Virtual>` drops after a hitch.
pub(crate) fn count_dropped_time(
    real: Option<Res<Time<Real>>>,
    time: Option<Res<Time<Virtual>>>,
    clock: Option<ResMut<PhysicsClock>>,
) {
    let (Some(real), Some(time), Some(mut clock)) = (real, time, clock) else {
        return;
    };
    let lost = real.delta().saturating_sub(time.max_delta());
    if lost.is_zero() || clock.paused || time.is_paused() {
        return;
    }
    let lost = lost.as_secs_f64() * time.relative_speed_f64();
    // The value may exceed the range of a `Duration`.
    let lost = Duration::try_from_secs_f64(lost).unwrap_or(Duration::MAX);
    clock.dropped = clock.dropped.saturating_add(lost);
}

/// Inserts a `B` into bodies without the required component `C`. It was removed, or the body was spawned before the
/// plugin was added.
fn restore_component<C: Component, B: Bundle + Default>(
    bodies: Query<Entity, (With<RigidBox>, Without<C>)>,
    mut commands: Commands,
    mut warned: Local<bool>,
) {
    for entity in &bodies {
        commands.entity(entity).try_insert(B::default());
        if !core::mem::replace(&mut *warned, true) {
            warn!(
                "box_physics: {entity} has a RigidBox, but no {}; it is restored. If it should not be a body, remove the \
                 RigidBox (logged once)",
                ShortName::of::<C>()
            );
        }
    }
}

/// Makes `C` a required component of every body. Where it is missing, it is restored as part of `B`.
pub(crate) fn require<C: Component + Default, B: Bundle + Default>(app: &mut App) {
    // An error means that bodies were spawned before the plugin was added. The system below completes them.
    let _ = app.try_register_required_components::<RigidBox, C>();
    app.add_systems(
        BeforeSteps,
        restore_component::<C, B>.before(show_changes::<true>),
    );
}

/// Logs invalid values that bypassed the constructors: once per entity, until they are valid again.
pub(crate) fn report_invalid<C: Checked>(
    components: Query<Ref<C>>,
    entities: Query<(Entity, Ref<C>), Or<(With<RigidBox>, With<StaticPlane>)>>,
    (mut lines, mut known): (Local<u32>, Local<Vec<Entity>>),
    ticks: SystemChangeTick,
) {
    let (last, now) = (ticks.last_run(), ticks.this_run());
    // Scans whole columns first, because usually nothing has changed.
    let any = components.contiguous_iter().is_ok_and(|mut tables| {
        tables.any(|column| any_newer(column.changed_ticks_slice(), last, now))
    });
    if !any {
        return;
    }
    for (entity, component) in entities.iter().filter(|(_, c)| c.is_changed()) {
        match component.check() {
            Ok(()) => known.retain(|&e| e != entity),
            Err(error) if *lines < MAX_INVALID_LINES && !known.contains(&entity) => {
                known.push(entity);
                *lines += 1;
                let end = if *lines == MAX_INVALID_LINES {
                    " (further ones are not logged)"
                } else {
                    ""
                };
                let name = ShortName::of::<C>();
                warn!("box_physics: {entity}: {error}; its {name} does not act{end}");
            }
            Err(_) => {}
        }
    }
}

/// Logs invalid planes when they are added or changed. `report_invalid` checks their surface components.
pub(crate) fn report_invalid_planes(planes: Query<(Entity, &StaticPlane), Changed<StaticPlane>>) {
    for (entity, plane) in &planes {
        if let Err(error) = plane.validate() {
            warn!("box_physics: {entity}: {error}; this StaticPlane is left out");
        }
    }
}

/// Maximum number of log lines about invalid values of one component.
const MAX_INVALID_LINES: u32 = 10;

/// Warns about bodies below a parent that is not at the origin. `Transform` is written in world coordinates, so such a
/// body would be displayed in the wrong place.
///
/// Checked when a body gets a parent, and when an entity with children moves or gets another parent.
pub(crate) fn report_parents(
    bodies: Query<(Entity, Ref<RigidBox>, Ref<ChildOf>)>,
    moved: Query<
        (),
        (
            With<Children>,
            Or<(Changed<Transform>, Changed<ChildOf>, Added<RigidBox>)>,
        ),
    >,
    parents: Query<(&Transform, Has<RigidBox>)>,
    ancestors: Query<&ChildOf>,
    mut warned: Local<bool>,
) {
    if *warned || bodies.is_empty() {
        return;
    }
    let displaces = |parent: Entity| {
        parents
            .get(parent)
            .is_ok_and(|(transform, is_body)| is_body || *transform != Transform::IDENTITY)
    };
    let any_moved = !moved.is_empty();
    let found = bodies
        .iter()
        .filter(|(_, body, parent)| any_moved || body.is_added() || parent.is_changed())
        .find_map(|(body, ..)| {
            let parent = ancestors.iter_ancestors(body).find(|&p| displaces(p))?;
            Some((body, parent))
        });
    if let Some((body, parent)) = found {
        *warned = true;
        warn!(
            "box_physics: {body} is a body below {parent}, whose Transform is not the identity (or which \
             is a body itself). Bodies are simulated in world coordinates and their Transform is \
             published so: it will be shown elsewhere than it is. Keep bodies at the top of the hierarchy \
             (logged once)"
        );
    }
}
