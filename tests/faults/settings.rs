//! Plugins in the wrong order, settings out of range, constants and floors that change in motion.

use bevy::ecs::component::Mutable;
use bevy::ecs::system::Command;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::prelude::*;

use super::{Log, Play, app, assert_shown_sanely, brick, tumbling};

/// Two plugins of a game both need the physics: the second is ignored with one message, and a tick is still
/// one step.
#[test]
fn a_duplicate_plugin_is_ignored() {
    let log = Log::start();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        PhysicsPlugins::default(),
        PhysicsPlugins::in_schedule(Update),
        FloorPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::FixedTimesteps(1))
    .insert_resource(Floor::default());
    log.says_once("added twice");
    let entity = app.spawn((brick(), tumbling()));
    app.play(10);
    assert_eq!(app.clock().steps(), 9);
    let mut once = self::app();
    once.insert_resource(Time::<Fixed>::default())
        .insert_resource(Floor::default());
    let alone = once.spawn((brick(), tumbling()));
    once.play(9);
    assert_eq!(app.state(entity), once.state(alone));
    log.is_silent();
}

/// Removed settings are restored with one message each, and the simulation continues.
#[test]
fn a_removed_setting_is_restored() {
    let log = Log::start();
    #[rustfmt::skip]
    let removals: [(&str, fn(&mut World)); 5] = [
        ("WorldGravity", |w| { w.remove_resource::<WorldGravity>(); }),
        ("GlobalIntegrator", |w| { w.remove_resource::<GlobalIntegrator>(); }),
        ("PhysicsClock", |w| { w.remove_resource::<PhysicsClock>(); }),
        ("PhysicsThreads", |w| { w.remove_resource::<PhysicsThreads>(); }),
        ("ContactSettings", |w| { w.remove_resource::<ContactSettings>(); }),
    ];
    for (name, remove) in removals {
        let mut app = app();
        let entity = app.spawn((brick(), tumbling()));
        app.play(3);
        remove(app.world_mut());
        let before = app.state(entity);
        app.play(3);
        log.says_once(name);
        assert_ne!(app.state(entity), before);
        remove(app.world_mut());
        StepPhysics(1).apply(app.world_mut());
        log.says_once(name);
    }
}

#[test]
fn settings_and_bodies_before_the_plugin_are_kept() {
    #[derive(Resource, Default)]
    struct Calls(u32);
    let log = Log::start();
    let mut app = App::new();
    app.init_resource::<Calls>()
        .add_systems(
            PhysicsSchedule,
            (|mut calls: ResMut<Calls>| calls.0 += 1).in_set(PhysicsSystems::Last),
        )
        .insert_resource(Floor::default())
        .insert_resource(GlobalIntegrator(Integrator::Rk4));
    let entity = app.spawn((brick(), BodyState::at(DVec3::Y * 0.3)));
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.play(100);
    assert!(app.world().resource::<Calls>().0 >= 99);
    assert_eq!(
        *app.world().resource::<GlobalIntegrator>(),
        GlobalIntegrator(Integrator::Rk4)
    );
    // The body has fallen to the floor and rests there.
    assert!((app.state(entity).position.y - 0.25).abs() < 1e-9);
    assert!(app.world().get::<WorldAabb>(entity).is_some());
    let late = app.spawn((brick(), tumbling()));
    app.play(2);
    assert!(app.world().get::<WorldAabb>(late).is_some());
    log.take();
}

#[test]
fn invalid_settings_stop_the_clock_until_corrected() {
    let log = Log::start();
    fn set<R: Resource<Mutability = Mutable>>(app: &mut App, set: fn(&mut R)) {
        set(&mut app.world_mut().resource_mut::<R>());
    }
    #[rustfmt::skip]
    let faults: [(&str, fn(&mut App)); 8] = [
        ("WorldGravity.y", |app| set::<WorldGravity>(app, |gravity| gravity.0.y = f64::NAN)),
        ("Floor.height", |app| set::<Floor>(app, |floor| floor.height = f64::NAN)),
        ("Floor.restitution", |app| set::<Floor>(app, |floor| floor.restitution = 1.5)),
        ("Floor.friction", |app| set::<Floor>(app, |floor| floor.friction = -0.1)),
        ("ContactSettings.tolerance", |app| set::<ContactSettings>(app, |s| s.tolerance = 0.0)),
        ("ContactSettings.restitution_threshold", |app| {
            set::<ContactSettings>(app, |s| s.restitution_threshold = f64::NAN);
        }),
        ("ContactSettings.max_impacts", |app| set::<ContactSettings>(app, |s| s.max_impacts = 0)),
        ("PhysicsClock.substeps", |app| set::<PhysicsClock>(app, |clock| clock.substeps = 1_000_000)),
    ];
    for (field, spoil) in faults {
        let mut app = app();
        app.insert_resource(Floor::default());
        let entity = app.spawn((brick(), tumbling()));
        for _ in 0..2 {
            app.play(3);
            let steps = |app: &App| app.clock().steps();
            let before = (app.state(entity), steps(&app));
            log.is_silent();
            spoil(&mut app);
            app.play(5);
            log.says_once(field);
            let fault = app.clock().fault();
            assert_eq!(fault.map(|f| f.field), Some(field));
            assert_eq!((app.state(entity), steps(&app)), before);
            // After the correction, the simulation continues.
            app.insert_resource(WorldGravity::default())
                .insert_resource(Floor::default())
                .insert_resource(ContactSettings::default());
            app.world_mut().resource_mut::<PhysicsClock>().substeps = 1;
            app.update();
            assert_ne!(app.state(entity), before.0, "{field}");
            assert_eq!(app.clock().fault(), None);
        }
    }
}

#[test]
fn constants_that_change_in_motion() {
    let log = Log::start();
    for &integrator in Integrator::ALL {
        let mut app = app();
        app.insert_resource(Floor::default())
            .insert_resource(GlobalIntegrator(integrator));
        let flying = app.spawn((brick(), tumbling()));
        let lying = BodyState::at(DVec3::Y * 0.25);
        let lying = app.spawn((brick(), lying));
        app.play(30);
        let before = app.state(flying);
        let larger = RigidBox::new(DVec3::new(0.6, 0.9, 0.4), 30.0).expect("valid");
        for entity in [flying, lying] {
            app.entity(entity).insert(larger);
        }
        // The momenta stay the same; the angular velocity follows from the new inertia.
        assert_eq!(app.state(flying), before);
        app.play(30);
        assert_shown_sanely(&mut app);
        // It was inside the floor: penetration recovery moves it out without a jump.
        let up = app.state(lying);
        assert!((up.position.y - 0.9).abs() < 1e-9, "{integrator}: {up:?}");
        assert!(up.velocity.length() < 1e-9, "{integrator}: {up:?}");
        // Changes of all other settings at run time.
        app.insert_resource(WorldGravity(DVec3::new(1.0, -3.0, 0.0)))
            .insert_resource(Floor::new(0.5, 1.0, 0.0).expect("valid"));
        app.world_mut().resource_mut::<PhysicsClock>().substeps = 7;
        app.entity(flying)
            .insert((LinearDrag(1.0), AngularDrag(0.1)));
        app.play(30);
        assert_shown_sanely(&mut app);
    }
    log.is_silent();
}
