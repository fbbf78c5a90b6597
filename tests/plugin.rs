//! The plugin in an app without window or renderer: its effect on entities, step by step.

#[path = "plugin/clock.rs"]
mod clock;
#[path = "plugin/contacts.rs"]
mod contacts;
#[path = "plugin/planes.rs"]
mod planes;
#[path = "plugin/pushes.rs"]
mod pushes;
#[path = "plugin/shown.rs"]
mod shown;
#[path = "plugin/snapshots.rs"]
mod snapshots;

use std::time::Duration;

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::force::{Forces, Gravity};
use box_physics::plugin::{Stage, integrator_path};
use box_physics::prelude::*;

/// One tick of a 60 Hz clock in whole nanoseconds, as Bevy stores it.
fn tick() -> Duration {
    Time::<Fixed>::from_hz(60.0).timestep()
}

/// An app in which every `update` is exactly one tick.
fn app() -> App {
    app_with(PhysicsPlugins::default())
}

fn app_with<M>(physics: impl bevy::app::Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .add_plugins(physics)
        .insert_resource(Time::<Fixed>::from_hz(60.0))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    // The first update only starts the clock.
    app.update();
    app.world_mut().resource_mut::<PhysicsClock>().reset();
    app
}

fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

fn tumbling() -> BodyState {
    BodyState::at(DVec3::new(0.0, 50.0, 0.0))
        .with_velocity(DVec3::new(1.0, 2.0, 3.0))
        .with_angular_velocity(&brick(), DVec3::new(1.5, 2.5, 1.0))
}

fn state(app: &App, entity: Entity) -> BodyState {
    *app.world().get::<BodyState>(entity).expect("a body")
}

fn core(integrator: Integrator, state: &mut BodyState, law: &impl ForceModel, steps: u32) {
    let mut memory = IntegratorMemory::default();
    for _ in 0..steps {
        integrator.step(&brick(), state, law, tick().as_secs_f64(), &mut memory);
    }
}

#[test]
fn the_plugin_equals_the_core_bit_for_bit_under_every_integrator() {
    let gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
    for &integrator in Integrator::ALL {
        let mut app = app();
        app.insert_resource(GlobalIntegrator(integrator));
        let entity = app.world_mut().spawn((brick(), tumbling())).id();
        for _ in 0..60 {
            app.update();
        }
        let mut expected = tumbling();
        core(integrator, &mut expected, &gravity, 60);
        assert_eq!(state(&app, entity), expected, "{integrator}");
        let transform = app.world().get::<Transform>(entity).expect("required");
        assert_eq!(transform.translation, expected.position.as_vec3());
        assert_eq!(transform.rotation, expected.rotation.as_quat());
    }
}

#[test]
fn every_force_component_reaches_the_core() {
    let mut app = app();
    let springs = vec![Spring {
        body_point: DVec3::X * 0.5,
        anchor: DVec3::Y,
        stiffness: 20.0,
        damping: 0.5,
    }];
    let points = vec![PointForce {
        body_point: DVec3::Y * 0.1,
        force: DVec3::Z,
        frame: Frame::Body,
    }];
    let entity = app
        .world_mut()
        .spawn((
            brick(),
            tumbling(),
            (
                LinearDrag(0.1),
                QuadraticDrag(0.02),
                AngularDamping(0.3),
                AngularDrag(0.01),
            ),
            GravityScale(0.5),
            BodyTorque(DVec3::X * 0.2),
            ExternalForce {
                force: DVec3::Y * 3.0,
                torque: DVec3::Z * 0.1,
            },
            Springs(springs.clone()),
            PointForces(points.clone()),
        ))
        .id();
    for _ in 0..30 {
        app.update();
    }
    let law = Forces {
        acceleration: DVec3::new(0.0, -9.81, 0.0) * 0.5 + DVec3::Y * 3.0 * brick().inverse_mass(),
        dissipation: Dissipation {
            linear_drag: 0.1,
            quadratic_drag: 0.02,
            angular_damping: 0.3,
            angular_drag: 0.01,
            ..Dissipation::NONE
        },
        body_torque: DVec3::X * 0.2,
        world_torque: DVec3::Z * 0.1,
        point_forces: &points,
        springs: &springs,
    };
    let mut expected = tumbling();
    core(Integrator::Split, &mut expected, &law, 30);
    assert_eq!(state(&app, entity), expected);
}

#[test]
fn switching_live_and_per_body_carries_the_state_over_exactly() {
    let mut app = app();
    let own = app
        .world_mut()
        .spawn((
            brick(),
            tumbling(),
            BodyIntegrator(Integrator::ExplicitEuler),
        ))
        .id();
    let global = app.world_mut().spawn((brick(), tumbling())).id();
    let gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
    let (mut expected_own, mut expected_global) = (tumbling(), tumbling());
    for &integrator in Integrator::ALL {
        app.insert_resource(GlobalIntegrator(integrator));
        for _ in 0..5 {
            app.update();
        }
        core(integrator, &mut expected_global, &gravity, 5);
        core(Integrator::ExplicitEuler, &mut expected_own, &gravity, 5);
        assert_eq!(state(&app, global), expected_global, "{integrator}");
        assert_eq!(state(&app, own), expected_own);
    }
    // Without the override, the global integrator applies.
    app.world_mut().entity_mut(own).remove::<BodyIntegrator>();
    app.insert_resource(GlobalIntegrator(Integrator::Rk4));
    app.update();
    core(Integrator::Rk4, &mut expected_own, &gravity, 1);
    assert_eq!(state(&app, own), expected_own);
}

#[test]
fn impulses_act_in_order_at_the_start_of_the_step() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    let (center, world, body) = (
        DVec3::X * 2.0,
        DVec3::new(0.1, 50.2, 0.0),
        DVec3::new(0.5, 0.0, 0.125),
    );
    app.world_mut()
        .write_message(ApplyImpulse::center(entity, center));
    app.world_mut()
        .write_message(ApplyImpulse::at_world_point(entity, DVec3::Y, world));
    app.world_mut()
        .write_message(ApplyImpulse::at_body_point(entity, DVec3::Z, body));
    app.update();
    let mut expected = tumbling();
    expected.velocity += center * brick().inverse_mass();
    expected.apply_impulse(&brick(), DVec3::Y, world);
    expected.apply_impulse_at_body_point(&brick(), DVec3::Z, body);
    core(Integrator::Split, &mut expected, &Gravity(DVec3::ZERO), 1);
    assert_eq!(state(&app, entity), expected);
    // Once only.
    app.update();
    core(Integrator::Split, &mut expected, &Gravity(DVec3::ZERO), 1);
    assert_eq!(state(&app, entity), expected);
}

#[test]
fn an_impulse_for_a_body_that_is_gone_is_dropped() {
    let mut app = app();
    let gone = app.world_mut().spawn((brick(), tumbling())).id();
    let stays = app.world_mut().spawn((brick(), tumbling())).id();
    app.world_mut()
        .write_message(ApplyImpulse::center(gone, DVec3::X));
    app.world_mut()
        .write_message(ApplyImpulse::center(stays, DVec3::X * 3.0));
    app.world_mut().despawn(gone);
    app.update();
    assert_eq!(state(&app, stays).velocity.x, 2.0);
}

#[test]
fn pause_stops_and_a_single_step_is_one_tick() {
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    app.world_mut()
        .write_message(ApplyImpulse::center(entity, DVec3::X * 3.0));
    for _ in 0..10 {
        app.update();
    }
    assert_eq!(state(&app, entity), tumbling(), "paused");
    // The step happens at once, not at the next tick, and includes the pending impulse.
    app.world_mut().commands().queue(StepPhysics(1));
    app.world_mut().flush();
    let mut expected = tumbling();
    expected.velocity += DVec3::X * 3.0 * brick().inverse_mass();
    core(
        Integrator::Split,
        &mut expected,
        &Gravity(DVec3::new(0.0, -9.81, 0.0)),
        1,
    );
    assert_eq!(state(&app, entity), expected);
    let clock = *app.world().resource::<PhysicsClock>();
    assert_eq!((clock.steps(), clock.elapsed()), (1, tick()));
    app.update();
    assert_eq!(state(&app, entity), expected, "still paused");
}

#[test]
fn substeps_divide_the_tick() {
    let mut app = app();
    app.world_mut().resource_mut::<PhysicsClock>().substeps = 4;
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.update();
    let mut expected = tumbling();
    let mut memory = IntegratorMemory::default();
    let h = tick().as_secs_f64() / 4.0;
    for _ in 0..4 {
        let gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
        Integrator::Split.step(&brick(), &mut expected, &gravity, h, &mut memory);
    }
    assert_eq!(state(&app, entity), expected);
    assert_eq!(app.world().resource::<PhysicsClock>().elapsed(), tick());
}

#[test]
fn a_step_of_zero_changes_nothing() {
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    app.update();
    assert_eq!(state(&app, entity), tumbling());
    // In a schedule of variable time, a frame of zero length is a tick of zero.
    let mut app = app_with(PhysicsPlugins::in_schedule(Update));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.update();
    assert_eq!(state(&app, entity), tumbling());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        10,
    )));
    app.update();
    assert_eq!(app.world().resource::<PhysicsClock>().step(), 0.01);
    assert_ne!(state(&app, entity), tumbling());
}

#[test]
fn changing_transform_teleports_and_keeps_the_motion() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let spinning =
        BodyState::at(DVec3::new(0.1, 1.0, 0.3)).with_angular_velocity(&brick(), DVec3::Y * 3.0);
    let entity = app.world_mut().spawn((brick(), spinning)).id();
    app.update();
    let before = state(&app, entity);
    assert_eq!(
        before.position, spinning.position,
        "its f64 digits survive the f32 Transform"
    );
    app.world_mut()
        .get_mut::<Transform>(entity)
        .expect("required")
        .translation
        .x = 7.5;
    app.update();
    let after = state(&app, entity);
    assert_eq!(
        after.position,
        DVec3::new(7.5, f64::from(1.0_f32), f64::from(0.3_f32))
    );
    assert!((after.angular_velocity(&brick()) - DVec3::Y * 3.0).length() < 1e-12);
    // An invalid position is ignored and corrected.
    app.world_mut()
        .get_mut::<Transform>(entity)
        .expect("required")
        .translation
        .y = f32::NAN;
    app.update();
    assert_eq!(state(&app, entity).position, after.position);
    assert_eq!(
        app.world()
            .get::<Transform>(entity)
            .expect("required")
            .translation
            .y,
        1.0
    );
}

#[test]
fn a_body_starts_at_its_transform() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let turned = Quat::from_rotation_y(0.5);
    let entity = app
        .world_mut()
        .spawn((
            brick(),
            Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(turned),
        ))
        .id();
    app.update();
    let state = state(&app, entity);
    assert_eq!(state.position, DVec3::new(1.0, 2.0, 3.0));
    assert!((state.rotation.as_quat() - turned).length() < 1e-6);
    assert!((state.rotation.length() - 1.0).abs() < 1e-15);
}

#[test]
fn a_body_that_is_not_finite_is_quarantined_and_its_neighbors_are_unaffected() {
    let run = |poison: bool| {
        let mut app = app();
        let left = app.world_mut().spawn((brick(), tumbling())).id();
        let bad = app.world_mut().spawn((brick(), tumbling())).id();
        let right = app.world_mut().spawn((brick(), tumbling())).id();
        for step in 0..20 {
            if poison && step == 10 {
                app.world_mut()
                    .get_mut::<BodyState>(bad)
                    .expect("a body")
                    .velocity
                    .x = f64::NAN;
            }
            app.update();
        }
        (app, [left, bad, right])
    };
    let (clean, ids) = run(false);
    let (app, [left, bad, right]) = run(true);
    assert_eq!(state(&app, left), state(&clean, ids[0]));
    assert_eq!(state(&app, right), state(&clean, ids[2]));
    let frozen = state(&app, bad);
    assert!(frozen.is_valid());
    let mut at_ten = tumbling();
    core(
        Integrator::Split,
        &mut at_ten,
        &Gravity(DVec3::new(0.0, -9.81, 0.0)),
        10,
    );
    assert_eq!(frozen.position.as_vec3(), at_ten.position.as_vec3());
    assert!(app.world().get::<Quarantined>(bad).is_some());
}

#[test]
fn quarantine_is_reported_once_and_can_be_left() {
    let mut app = app();
    let entity = app
        .world_mut()
        .spawn((
            brick(),
            tumbling(),
            ExternalForce {
                force: DVec3::splat(f64::INFINITY),
                torque: DVec3::ZERO,
            },
        ))
        .id();
    let good = state(&app, entity);
    let mut told = 0;
    for _ in 0..5 {
        app.update();
        let mut messages = app.world_mut().resource_mut::<Messages<BodyQuarantined>>();
        for message in messages.drain() {
            assert_eq!(
                (message.entity, message.integrator),
                (entity, Integrator::Split)
            );
            told += 1;
        }
    }
    assert_eq!(told, 1);
    assert_eq!(state(&app, entity), good, "frozen at its last good state");
    app.world_mut()
        .entity_mut(entity)
        .remove::<(Quarantined, ExternalForce)>();
    app.update();
    assert!(
        state(&app, entity).position.y != good.position.y,
        "and it goes on"
    );
}

#[test]
fn parts_can_be_left_out() {
    let mut app = app_with(
        PhysicsPlugins::default()
            .build()
            .disable::<AabbPlugin>()
            .disable::<PhysicsDiagnosticsPlugin>(),
    );
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.update();
    assert!(app.world().get::<WorldAabb>(entity).is_none());
    assert!(app.world().get_resource::<PhysicsTimings>().is_none());
    assert_ne!(state(&app, entity), tumbling());
}

#[test]
fn the_aabb_contains_the_box_after_every_step() {
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    for _ in 0..30 {
        app.update();
        let aabb = app
            .world()
            .get::<WorldAabb>(entity)
            .expect("comes with the plugin")
            .0;
        let s = state(&app, entity);
        for corner in box_physics::aabb::corners(brick().half_extents()) {
            let p = s.point(corner);
            assert!(
                aabb.min.as_dvec3().cmple(p + 1e-12).all()
                    && aabb.max.as_dvec3().cmpge(p - 1e-12).all()
            );
        }
    }
}

#[test]
fn timings_are_measured_and_published() {
    let mut app = app();
    app.insert_resource(Floor::default());
    app.insert_resource(GlobalIntegrator(Integrator::Rk4));
    for _ in 0..10 {
        app.world_mut().spawn((brick(), tumbling()));
    }
    app.update();
    app.update();
    let timings = app.world().resource::<PhysicsTimings>();
    assert_eq!(timings.integrator(Integrator::Rk4).bodies, 10);
    assert_eq!(timings.integrator(Integrator::Rk4).outcome.evaluations, 40);
    assert!(
        timings
            .integrator(Integrator::Rk4)
            .per_body()
            .is_some_and(|ns| ns > 0.0)
    );
    assert!(timings.stage(Stage::Integrate) > 0 && timings.total() > 0);
    let store = app.world().resource::<DiagnosticsStore>();
    for path in [
        PhysicsDiagnosticsPlugin::STEP,
        Stage::Integrate.path(),
        integrator_path(Integrator::Rk4),
    ] {
        let value = store
            .get(&path)
            .and_then(bevy::diagnostic::Diagnostic::value);
        assert!(value.is_some_and(|v| v > 0.0), "{path}");
    }
}

#[test]
fn a_dropped_box_comes_to_rest_and_its_pose_repeats_bit_for_bit() {
    let mut app = app();
    app.insert_resource(Floor::new(0.0, 0.3, 0.5).expect("valid"));
    let start = BodyState::at_pose(
        DVec3::new(0.0, 2.0, 0.0),
        DQuat::from_xyzw(0.2, 0.1, 0.3, 0.9),
    )
    .with_angular_velocity(&brick(), DVec3::new(1.0, -2.0, 0.5));
    let entity = app.world_mut().spawn((brick(), start)).id();
    for _ in 0..1200 {
        app.update();
    }
    let rested = state(&app, entity);
    assert!(rested.velocity.length() == 0.0 && rested.angular_momentum.length() == 0.0);
    assert!(rested.position.y > 0.12 && rested.position.y < 0.51);
    for _ in 0..1000 {
        app.update();
        assert_eq!(state(&app, entity), rested);
    }
    // A push wakes it.
    app.world_mut()
        .write_message(ApplyImpulse::center(entity, DVec3::Y * 9.0));
    app.update();
    assert!(state(&app, entity).velocity.y > 2.0);
}

#[test]
fn floor_contacts_are_told_to_those_who_ask() {
    let mut app = app();
    app.insert_resource(Floor::new(0.0, 0.0, 0.5).expect("valid"));
    let drop = BodyState::at(DVec3::new(0.0, 0.5, 0.0));
    let heard = app.world_mut().spawn((brick(), drop, ReportContacts)).id();
    app.world_mut().spawn((brick(), drop));
    let mut contacts = Vec::new();
    for _ in 0..60 {
        app.update();
        let mut messages = app.world_mut().resource_mut::<Messages<FloorContact>>();
        contacts.extend(messages.drain());
    }
    let [contact] = contacts[..] else {
        panic!("a flat landing is one contact, but there are {contacts:?}");
    };
    assert_eq!(
        (contact.entity, contact.phase),
        (heard, ContactPhase::Began)
    );
    assert_eq!(contact.report.corners.count_ones(), 4);
    assert!(contact.report.point().y.abs() < 1e-6);
    // J = m √(2 g d) with d = 0.25 m, plus the weight until the end of that step.
    let (impulse, expected) = (
        contact.report.normal_impulse(),
        3.0 * (2.0_f64 * 9.81 * 0.25).sqrt(),
    );
    assert!(impulse >= expected * (1.0 - 1e-9) && impulse <= expected + 3.0 * 9.81 / 60.0 + 1e-9);
}

#[test]
fn the_end_of_a_contact_is_told_even_when_the_box_is_thrown_far() {
    let mut app = app();
    app.insert_resource(Floor::new(0.0, 0.0, 0.5).expect("valid"));
    let lying = BodyState::at(DVec3::new(0.0, 0.25, 0.0));
    let entity = app.world_mut().spawn((brick(), lying, ReportContacts)).id();
    for _ in 0..10 {
        app.update();
    }
    app.world_mut()
        .write_message(ApplyImpulse::center(entity, DVec3::Y * 3000.0));
    app.world_mut()
        .resource_mut::<Messages<FloorContact>>()
        .clear();
    let mut phases = Vec::new();
    for _ in 0..3 {
        app.update();
        let mut messages = app.world_mut().resource_mut::<Messages<FloorContact>>();
        phases.extend(messages.drain().map(|m| m.phase));
    }
    assert_eq!(
        phases.iter().filter(|p| **p == ContactPhase::Ended).count(),
        1,
        "{phases:?}"
    );
}

#[test]
fn an_impulse_that_is_not_finite_is_refused() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.world_mut()
        .write_message(ApplyImpulse::center(entity, DVec3::splat(f64::NAN)));
    app.world_mut().write_message(ApplyImpulse::at_body_point(
        entity,
        DVec3::X,
        DVec3::splat(f64::INFINITY),
    ));
    app.update();
    let mut expected = tumbling();
    core(Integrator::Split, &mut expected, &Gravity(DVec3::ZERO), 1);
    assert_eq!(state(&app, entity), expected);
    assert!(app.world().get::<Quarantined>(entity).is_none());
}

#[test]
fn a_new_body_is_shown_where_it_starts_even_while_paused() {
    let mut app = app();
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.update();
    let transform = app.world().get::<Transform>(entity).expect("required");
    assert_eq!(transform.translation, tumbling().position.as_vec3());
    let aabb = app.world().get::<WorldAabb>(entity).expect("comes along").0;
    assert!(aabb.min.y > 49.0 && aabb.max.y < 51.0 && aabb.min.y < aabb.max.y);
    assert_eq!(state(&app, entity), tumbling());
}

#[test]
fn a_state_written_while_paused_is_shown_at_once() {
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    app.update();
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    let back = BodyState::at_pose(
        DVec3::new(7.0, 8.0, 9.0),
        DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
    );
    *app.world_mut().get_mut(entity).expect("a body") = back;
    app.update();
    let transform = *app.world().get::<Transform>(entity).expect("required");
    assert_eq!(transform.translation, Vec3::new(7.0, 8.0, 9.0));
    assert_eq!(transform.rotation, back.rotation.as_quat());
    let aabb = app.world().get::<WorldAabb>(entity).expect("comes along").0;
    // The axes are permuted: x is along the world's y, and so on.
    assert!((Vec3::from(aabb.max) - Vec3::new(7.125, 8.5, 9.25)).length() < 1e-5);
    // A pending teleport is not overwritten.
    app.world_mut()
        .get_mut::<Transform>(entity)
        .expect("required")
        .translation
        .x = -1.0;
    app.world_mut()
        .get_mut::<BodyState>(entity)
        .expect("a body")
        .velocity = DVec3::Z;
    app.update();
    let shown = app.world().get::<Transform>(entity).expect("required");
    assert_eq!(shown.translation.x, -1.0);
    app.world_mut().commands().queue(StepPhysics(1));
    app.world_mut().flush();
    let after = state(&app, entity);
    assert_eq!((after.position.x, after.velocity.z), (-1.0, 1.0));
}
