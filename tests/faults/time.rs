//! Clocks: missing, stopped, jumping, and with a tick that is far too long.

use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

use super::{Log, Play, app, assert_shown_sanely, brick, tumbling};

#[test]
fn a_missing_clock_is_reported() {
    let log = Log::start();
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), PhysicsPlugins::default()));
    let entity = app.spawn((brick(), tumbling()));
    app.play(5);
    assert_eq!(app.state(entity), tumbling());
    log.says_once("TimePlugin");
    app.step(1);
    app.step(1);
    log.says_once("Time<Fixed>");
    // The same in a custom schedule.
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        PhysicsPlugins::in_schedule(Update),
    ));
    app.play(5);
    log.says_once("TimePlugin");
}

/// Frames of zero length in a schedule of variable time: nothing moves, nothing is reported, and requests
/// take effect at the first tick of nonzero length.
#[test]
fn frames_of_no_time_change_nothing() {
    let log = Log::start();
    for &integrator in Integrator::ALL {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, PhysicsPlugins::in_schedule(Update)))
            .insert_resource(Floor::default())
            .insert_resource(GlobalIntegrator(integrator))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(8)));
        app.update();
        let lying = BodyState::at(DVec3::Y * 0.25);
        let falling = BodyState::at(DVec3::Y * 0.3).with_velocity(DVec3::NEG_Y * 9.0);
        let ids =
            [tumbling(), lying, falling].map(|start| app.spawn((brick(), start, ReportContacts)));
        app.play(3);
        let all = |app: &App| ids.map(|id| app.state(id));
        let told = |app: &mut App| app.drain::<FloorContact>().len();
        let steps = |app: &App| app.clock().steps();
        let before = (all(&app), steps(&app));
        told(&mut app);

        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        app.send(ApplyImpulse::center(ids[0], DVec3::X * 3.0));
        app.play(5);
        assert_eq!((all(&app), steps(&app)), before, "{integrator}");
        assert_eq!(told(&mut app), 0, "{integrator}");

        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(8)));
        app.update();
        let pushed = app.state(ids[0]).velocity.x - before.0[0].velocity.x;
        assert!((pushed - 1.0).abs() < 1e-9, "{integrator}: {pushed} m/s");
    }
    log.is_silent();
}

#[test]
fn a_tick_of_eleven_days() {
    let log = Log::start();
    for &integrator in Integrator::ALL {
        for with_floor in [false, true] {
            let mut app = app();
            app.insert_resource(Time::<Fixed>::from_seconds(1e6))
                .insert_resource(GlobalIntegrator(integrator));
            if with_floor {
                app.insert_resource(Floor::default());
            }
            app.spawn((brick(), tumbling(), QuadraticDrag(0.1)));
            app.spawn((brick(), tumbling()));
            app.spawn((brick(), BodyState::at(DVec3::Y * 0.25)));
            for _ in 0..3 {
                app.step(1);
                assert_shown_sanely(&mut app);
            }
        }
    }
    log.take();
}

#[test]
fn a_hitch_costs_a_bounded_number_of_steps_and_is_counted() {
    let log = Log::start();
    let mut app = app();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(10)));
    let before = app.clock();
    app.update();
    let clock = app.clock();
    let steps = clock.steps() - before.steps();
    assert!((14..=16).contains(&steps), "250 ms at 60 Hz, not {steps}");
    assert_eq!(
        clock.dropped() - before.dropped(),
        Duration::from_millis(9_750)
    );
    // Paused time does not count as dropped.
    app.pause();
    app.update();
    assert_eq!(app.clock().dropped(), clock.dropped());
    log.is_silent();
}
