//! The plugin in an app without window or renderer: its effect on entities, step by step.

#[path = "plugin/clock.rs"]
mod clock;
#[path = "plugin/contacts.rs"]
mod contacts;
#[path = "plugin/forced.rs"]
mod forced;
#[path = "plugin/planes.rs"]
mod planes;
#[path = "plugin/pushes.rs"]
mod pushes;
#[path = "plugin/quarantine.rs"]
mod quarantine;
#[path = "plugin/shown.rs"]
mod shown;
#[path = "plugin/snapshots.rs"]
mod snapshots;
mod world;

use std::time::Duration;

use bevy::diagnostic::DiagnosticsStore;
use bevy::prelude::*;
use box_physics::force::{Forces, Gravity};
use box_physics::plugin::{Stage, integrator_path};
use box_physics::prelude::*;

use world::{Play, app, app_with, brick, tumbling};

const WEIGHT: Gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
const FREE: Gravity = Gravity(DVec3::ZERO);

/// One tick of a 60 Hz clock in whole nanoseconds, as Bevy stores it.
fn tick() -> Duration {
    Time::<Fixed>::from_hz(60.0).timestep()
}

fn core(integrator: Integrator, state: &mut BodyState, law: &impl ForceModel, steps: u32) {
    let mut memory = IntegratorMemory::default();
    for _ in 0..steps {
        integrator.step(&brick(), state, law, tick().as_secs_f64(), &mut memory);
    }
}

#[test]
fn the_plugin_equals_the_core_bit_for_bit_under_every_integrator() {
    for &integrator in Integrator::ALL {
        let mut app = app();
        app.insert_resource(GlobalIntegrator(integrator));
        let entity = app.spawn((brick(), tumbling()));
        app.play(60);
        let mut expected = tumbling();
        core(integrator, &mut expected, &WEIGHT, 60);
        assert_eq!(app.state(entity), expected, "{integrator}");
        let transform = app.get::<Transform>(entity);
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
    let entity = app.spawn((
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
    ));
    app.play(30);
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
    assert_eq!(app.state(entity), expected);
}

#[test]
fn switching_live_and_per_body_carries_the_state_over_exactly() {
    let mut app = app();
    let own = app.spawn((
        brick(),
        tumbling(),
        BodyIntegrator(Integrator::ExplicitEuler),
    ));
    let global = app.spawn((brick(), tumbling()));
    let (mut expected_own, mut expected_global) = (tumbling(), tumbling());
    for &integrator in Integrator::ALL {
        app.insert_resource(GlobalIntegrator(integrator));
        app.play(5);
        core(integrator, &mut expected_global, &WEIGHT, 5);
        core(Integrator::ExplicitEuler, &mut expected_own, &WEIGHT, 5);
        assert_eq!(app.state(global), expected_global, "{integrator}");
        assert_eq!(app.state(own), expected_own);
    }
    // Without the override, the global integrator applies.
    app.entity(own).remove::<BodyIntegrator>();
    app.insert_resource(GlobalIntegrator(Integrator::Rk4));
    app.update();
    core(Integrator::Rk4, &mut expected_own, &WEIGHT, 1);
    assert_eq!(app.state(own), expected_own);
}

#[test]
fn impulses_act_in_order_at_the_start_of_the_step() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let entity = app.spawn((brick(), tumbling()));
    let (center, world, body) = (
        DVec3::X * 2.0,
        DVec3::new(0.1, 50.2, 0.0),
        DVec3::new(0.5, 0.0, 0.125),
    );
    app.send(ApplyImpulse::center(entity, center));
    app.send(ApplyImpulse::at_world_point(entity, DVec3::Y, world));
    app.send(ApplyImpulse::at_body_point(entity, DVec3::Z, body));
    app.update();
    let mut expected = tumbling();
    expected.velocity += center * brick().inverse_mass();
    expected.apply_impulse(&brick(), DVec3::Y, world);
    expected.apply_impulse_at_body_point(&brick(), DVec3::Z, body);
    core(Integrator::Split, &mut expected, &FREE, 1);
    assert_eq!(app.state(entity), expected);
    // Once only.
    app.update();
    core(Integrator::Split, &mut expected, &FREE, 1);
    assert_eq!(app.state(entity), expected);
}

#[test]
fn pause_stops_and_a_single_step_is_one_tick() {
    let mut app = app();
    let entity = app.spawn((brick(), tumbling()));
    app.pause();
    app.send(ApplyImpulse::center(entity, DVec3::X * 3.0));
    app.play(10);
    assert_eq!(app.state(entity), tumbling(), "paused");
    // The step happens at once, not at the next tick, and includes the pending impulse.
    app.step(1);
    let mut expected = tumbling();
    expected.velocity += DVec3::X * 3.0 * brick().inverse_mass();
    core(Integrator::Split, &mut expected, &WEIGHT, 1);
    assert_eq!(app.state(entity), expected);
    let clock = app.clock();
    assert_eq!((clock.steps(), clock.elapsed()), (1, tick()));
    app.update();
    assert_eq!(app.state(entity), expected, "still paused");
}

#[test]
fn substeps_divide_the_tick() {
    let mut app = app();
    app.world_mut().resource_mut::<PhysicsClock>().substeps = 4;
    let entity = app.spawn((brick(), tumbling()));
    app.update();
    let mut expected = tumbling();
    let mut memory = IntegratorMemory::default();
    let h = tick().as_secs_f64() / 4.0;
    for _ in 0..4 {
        Integrator::Split.step(&brick(), &mut expected, &WEIGHT, h, &mut memory);
    }
    assert_eq!(app.state(entity), expected);
    assert_eq!(app.clock().elapsed(), tick());
}

#[test]
fn changing_transform_teleports_and_keeps_the_motion() {
    let mut app = app();
    app.insert_resource(WorldGravity(DVec3::ZERO));
    let spinning =
        BodyState::at(DVec3::new(0.1, 1.0, 0.3)).with_angular_velocity(&brick(), DVec3::Y * 3.0);
    let entity = app.spawn((brick(), spinning));
    app.update();
    let before = app.state(entity);
    assert_eq!(
        before.position, spinning.position,
        "its f64 digits survive the f32 Transform"
    );
    app.edit::<Transform>(entity).translation.x = 7.5;
    app.update();
    let after = app.state(entity);
    assert_eq!(
        after.position,
        DVec3::new(7.5, f64::from(1.0_f32), f64::from(0.3_f32))
    );
    assert!((after.angular_velocity(&brick()) - DVec3::Y * 3.0).length() < 1e-12);
    // An invalid position is ignored and corrected.
    app.edit::<Transform>(entity).translation.y = f32::NAN;
    app.update();
    assert_eq!(app.state(entity).position, after.position);
    assert_eq!(app.get::<Transform>(entity).translation.y, 1.0);
}

#[test]
fn parts_can_be_left_out() {
    let mut app = app_with(
        PhysicsPlugins::default()
            .build()
            .disable::<AabbPlugin>()
            .disable::<PhysicsDiagnosticsPlugin>(),
    );
    let entity = app.spawn((brick(), tumbling()));
    app.update();
    assert!(app.world().get::<WorldAabb>(entity).is_none());
    assert!(app.world().get_resource::<PhysicsTimings>().is_none());
    assert_ne!(app.state(entity), tumbling());
}

#[test]
fn the_aabb_contains_the_box_after_every_step() {
    let mut app = app();
    let entity = app.spawn((brick(), tumbling()));
    for _ in 0..30 {
        app.update();
        let aabb = app.get::<WorldAabb>(entity).0;
        let s = app.state(entity);
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
        app.spawn((brick(), tumbling()));
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
