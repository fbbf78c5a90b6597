//! What goes wrong in other people's games: nothing panics, neighbours do not notice, and what happened is
//! said once, not every frame.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

use bevy::ecs::message::Messages;
use bevy::math::bounding::Aabb3d;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use box_physics::floor::ContactState;
use box_physics::prelude::*;

/// Everything that the library logged since the guard was taken. Tests that take it run one at a time.
struct Log(MutexGuard<'static, ()>);

static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
static LINES: Mutex<Vec<String>> = Mutex::new(Vec::new());

struct Collector;

impl log::Log for Collector {
    fn enabled(&self, _: &log::Metadata) -> bool {
        true
    }
    fn log(&self, record: &log::Record) {
        if record.level() <= log::Level::Warn && record.target().starts_with("box_physics") {
            let line = record.args().to_string();
            LINES
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
                .push(line);
        }
    }
    fn flush(&self) {}
}

impl Log {
    fn start() -> Self {
        let guard = ONE_AT_A_TIME
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        // A second call fails, and that is all right.
        let _ = log::set_logger(&Collector);
        log::set_max_level(log::LevelFilter::Warn);
        let log = Self(guard);
        log.take();
        log
    }

    fn take(&self) -> Vec<String> {
        let () = *self.0;
        std::mem::take(
            &mut *LINES
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner),
        )
    }

    /// There is one line since the last look, and it says this.
    #[track_caller]
    fn says_once(&self, words: &str) {
        let lines = self.take();
        assert_eq!(lines.len(), 1, "{lines:#?}");
        assert!(lines[0].contains(words), "{lines:#?} lacks '{words}'");
    }

    #[track_caller]
    fn is_silent(&self) {
        let lines = self.take();
        assert!(lines.is_empty(), "{lines:#?}");
    }
}

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(Time::<Fixed>::from_hz(60.0))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    app.update();
    app
}

fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

fn tumbling() -> BodyState {
    BodyState::at(DVec3::new(0.1, 50.0, 0.2))
        .with_velocity(DVec3::new(1.0, 2.0, 3.0))
        .with_angular_velocity(&brick(), DVec3::new(1.5, 2.5, 1.0))
}

fn state(app: &App, entity: Entity) -> BodyState {
    *app.world().get::<BodyState>(entity).expect("a body")
}

fn run(app: &mut App, updates: u32) {
    for _ in 0..updates {
        app.update();
    }
}

#[track_caller]
fn assert_shown_sanely(app: &mut App) {
    let mut all = app.world_mut().query::<(&Transform, &BodyState)>();
    for (transform, state) in all.iter(app.world()) {
        assert!(transform.translation.is_finite() && transform.rotation.is_finite());
        assert!(state.is_sound());
    }
}

#[test]
fn bodies_that_go_between_message_and_step() {
    let log = Log::start();
    let mut app = app();
    for _ in 0..5 {
        let gone = app.world_mut().spawn((brick(), tumbling())).id();
        app.world_mut()
            .write_message(ApplyImpulse::centre(gone, DVec3::X));
        app.world_mut().despawn(gone);
        app.update();
    }
    log.says_once("is no body (any more)");
}

#[test]
fn bodies_that_go_while_the_step_runs() {
    let log = Log::start();
    for set in [
        PhysicsSystems::First,
        PhysicsSystems::Impulses,
        PhysicsSystems::Forces,
        PhysicsSystems::Integrate,
        PhysicsSystems::Contact,
        PhysicsSystems::Refit,
        PhysicsSystems::Writeback,
        PhysicsSystems::Last,
    ] {
        let mut app = app();
        app.insert_resource(Floor::default());
        // Bodies that are just being quarantined go as well.
        app.add_systems(
            PhysicsSchedule,
            (|bodies: Query<Entity, With<GravityScale>>, mut commands: Commands| {
                for entity in &bodies {
                    commands.entity(entity).despawn();
                }
            })
            .in_set(set),
        );
        for _ in 0..3 {
            let lying = BodyState::at(DVec3::Y * 0.25);
            for state in [tumbling(), lying] {
                for scale in [1.0, f64::NAN] {
                    app.world_mut()
                        .spawn((brick(), state, ReportContacts, GravityScale(scale)));
                }
            }
            let stays = app.world_mut().spawn((brick(), tumbling())).id();
            run(&mut app, 3);
            assert!(state(&app, stays).is_sound());
        }
        let mut doomed = app.world_mut().query::<&GravityScale>();
        assert_eq!(doomed.iter(app.world()).count(), 0);
    }
    log.take();
}

#[test]
fn components_that_are_removed_in_flight() {
    let log = Log::start();
    let removals: [(&str, fn(&mut EntityWorldMut)); 5] = [
        ("", |e| {
            e.remove::<ContactState>();
        }),
        ("", |e| {
            e.remove::<WorldAabb>();
        }),
        ("put back", |e| {
            e.remove::<BodyState>();
        }),
        ("put back", |e| {
            e.remove::<SchemeMemory>();
        }),
        ("put back", |e| {
            e.remove::<Transform>();
        }),
    ];
    for (words, remove) in removals {
        for with_floor in [false, true] {
            let mut app = app();
            if with_floor {
                app.insert_resource(Floor::default());
            }
            let entity = app.world_mut().spawn((brick(), tumbling())).id();
            run(&mut app, 10);
            for _ in 0..3 {
                remove(&mut app.world_mut().entity_mut(entity));
                app.update();
                let one = state(&app, entity);
                app.update();
                assert_ne!(state(&app, entity), one, "it goes on: {words}");
            }
            assert!(app.world().get::<ContactState>(entity).is_some());
            assert!(app.world().get::<WorldAabb>(entity).is_some());
            if words.is_empty() {
                log.is_silent();
            } else {
                log.says_once(words);
            }
        }
    }
    // A state that is lost begins again where the body is shown.
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    run(&mut app, 10);
    let shown = *app.world().get::<Transform>(entity).expect("required");
    app.world_mut().entity_mut(entity).remove::<BodyState>();
    app.update();
    let after = state(&app, entity).position.as_vec3();
    assert!((after - shown.translation).length() < 0.01, "{after}");
    log.take();
}

#[test]
fn without_its_rigid_box_a_body_is_left_alone() {
    let log = Log::start();
    let mut app = app();
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    run(&mut app, 10);
    app.world_mut().entity_mut(entity).remove::<RigidBox>();
    let mine = Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.3));
    *app.world_mut().get_mut(entity).expect("stays") = mine;
    let frozen = state(&app, entity);
    run(&mut app, 10);
    assert_eq!(state(&app, entity), frozen);
    assert_eq!(*app.world().get::<Transform>(entity).expect("stays"), mine);
    app.world_mut().entity_mut(entity).insert(brick());
    app.update();
    assert!((state(&app, entity).position - DVec3::new(1.0, 2.0, 3.0)).length() < 0.1);
    log.is_silent();
}

#[test]
fn a_duplicate_plugin_is_named() {
    let _log = Log::start();
    let panic = catch_unwind(AssertUnwindSafe(|| {
        App::new().add_plugins((
            MinimalPlugins,
            PhysicsPlugins::default(),
            PhysicsPlugins::default(),
        ));
    }))
    .expect_err("Bevy refuses a plugin that is there already");
    let text = panic.downcast_ref::<String>().expect("a formatted message");
    assert!(text.contains("PhysicsPlugin"), "{text}");
}

#[test]
fn without_a_clock_it_says_so() {
    let log = Log::start();
    let mut app = App::new();
    app.add_plugins((TaskPoolPlugin::default(), PhysicsPlugins::default()));
    let entity = app.world_mut().spawn((brick(), tumbling())).id();
    run(&mut app, 5);
    assert_eq!(state(&app, entity), tumbling());
    log.says_once("TimePlugin");
    app.world_mut().commands().queue(StepPhysics(1));
    app.world_mut().flush();
    log.says_once("Time<Fixed>");
    // In a schedule of its own the same.
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        PhysicsPlugins::in_schedule(Update),
    ));
    run(&mut app, 5);
    log.says_once("TimePlugin");
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
            app.world_mut()
                .spawn((brick(), tumbling(), QuadraticDrag(0.1)));
            app.world_mut().spawn((brick(), tumbling()));
            app.world_mut()
                .spawn((brick(), BodyState::at(DVec3::Y * 0.25)));
            for _ in 0..3 {
                app.world_mut().commands().queue(StepPhysics(1));
                app.world_mut().flush();
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
    let before = *app.world().resource::<PhysicsClock>();
    app.update();
    let clock = *app.world().resource::<PhysicsClock>();
    let steps = clock.steps() - before.steps();
    assert!((14..=16).contains(&steps), "250 ms at 60 Hz, not {steps}");
    assert_eq!(
        clock.dropped() - before.dropped(),
        Duration::from_millis(9_750)
    );
    // Paused time is not lost.
    app.world_mut().resource_mut::<PhysicsClock>().paused = true;
    app.update();
    assert_eq!(
        app.world().resource::<PhysicsClock>().dropped(),
        clock.dropped()
    );
    log.is_silent();
}

type Poison = fn(&mut EntityWorldMut);
const NAN: DVec3 = DVec3::NAN;

fn poisons() -> Vec<(&'static str, Poison)> {
    fn poison<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        e: &mut EntityWorldMut,
        f: fn(&mut C),
    ) {
        f(&mut e.get_mut::<C>().expect("there"));
    }
    vec![
        ("position", |e| {
            poison::<BodyState>(e, |s| s.position.y = f64::NAN);
        }),
        ("rotation", |e| {
            poison::<BodyState>(e, |s| s.rotation.w = f64::INFINITY);
        }),
        ("rotation of length 0", |e| {
            poison::<BodyState>(e, |s| s.rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        }),
        ("velocity", |e| poison::<BodyState>(e, |s| s.velocity = NAN)),
        ("momentum", |e| {
            poison::<BodyState>(e, |s| s.angular_momentum.x = f64::NEG_INFINITY);
        }),
        ("everything", |e| {
            poison::<BodyState>(e, |s| {
                *s = BodyState {
                    position: NAN,
                    rotation: DQuat::NAN,
                    velocity: NAN,
                    angular_momentum: NAN,
                };
            });
        }),
        ("translation", |e| {
            poison::<Transform>(e, |t| t.translation = Vec3::NAN);
        }),
        ("quaternion", |e| {
            poison::<Transform>(e, |t| t.rotation = Quat::from_xyzw(0.0, f32::NAN, 0.0, 1.0));
        }),
        ("quaternion of length 0", |e| {
            poison::<Transform>(e, |t| t.rotation = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        }),
        ("GravityScale", |e| {
            e.insert(GravityScale(f64::NAN));
        }),
        ("LinearDrag", |e| {
            e.insert(LinearDrag(f64::NAN));
        }),
        ("LinearDrag infinite", |e| {
            e.insert(LinearDrag(f64::INFINITY));
        }),
        ("QuadraticDrag", |e| {
            e.insert(QuadraticDrag(f64::NAN));
        }),
        ("AngularDamping", |e| {
            e.insert(AngularDamping(f64::NAN));
        }),
        ("AngularDrag", |e| {
            e.insert(AngularDrag(f64::NAN));
        }),
        ("force", |e| {
            e.insert(ExternalForce {
                force: NAN,
                torque: DVec3::ZERO,
            });
        }),
        ("torque", |e| {
            e.insert(ExternalForce {
                force: DVec3::ZERO,
                torque: NAN,
            });
        }),
        ("BodyTorque", |e| {
            e.insert(BodyTorque(NAN));
        }),
        ("PointForces", |e| {
            e.insert(PointForces(vec![PointForce {
                body_point: NAN,
                force: DVec3::X,
                frame: Frame::World,
            }]));
        }),
        ("Springs", |e| {
            e.insert(Springs(vec![Spring {
                body_point: DVec3::X,
                anchor: DVec3::ZERO,
                stiffness: f64::NAN,
                damping: 1.0,
            }]));
        }),
        ("damper", |e| {
            e.insert(Springs(vec![Spring {
                body_point: DVec3::X,
                anchor: DVec3::ZERO,
                stiffness: 1.0,
                damping: f64::NAN,
            }]));
        }),
        ("WorldAabb", |e| {
            e.insert(WorldAabb(Aabb3d {
                min: Vec3::NAN.into(),
                max: Vec3::NAN.into(),
            }));
        }),
    ]
}

#[test]
fn nan_in_every_component() {
    let log = Log::start();
    for integrator in [
        Integrator::Split,
        Integrator::Exact,
        Integrator::Rk4,
        Integrator::BackwardEuler,
    ] {
        for with_floor in [false, true] {
            let poisoned = |poison: Option<Poison>| {
                let mut app = app();
                app.insert_resource(GlobalIntegrator(integrator));
                if with_floor {
                    app.insert_resource(Floor::default());
                }
                let ids = [tumbling(), BodyState::at(DVec3::Y * 0.3), tumbling()]
                    .map(|start| app.world_mut().spawn((brick(), start)).id());
                run(&mut app, 3);
                if let Some(poison) = poison {
                    poison(&mut app.world_mut().entity_mut(ids[1]));
                }
                run(&mut app, 20);
                assert_shown_sanely(&mut app);
                let aabb = app.world().get::<WorldAabb>(ids[1]).expect("required").0;
                assert!(aabb.min.is_finite() && aabb.max.is_finite());
                [state(&app, ids[0]), state(&app, ids[2])]
            };
            let clean = poisoned(None);
            log.is_silent();
            for (name, poison) in poisons() {
                assert_eq!(poisoned(Some(poison)), clean, "{name}: neighbours notice");
                let lines = log.take();
                assert!(lines.len() <= 1, "{name}: {lines:#?}");
                // An infinite drag is a wall to a scheme that takes drag exactly, and a resting box
                // feels none of the drags.
                if !matches!(name, "WorldAabb" | "LinearDrag infinite") && !with_floor {
                    assert_eq!(lines.len(), 1, "{integrator}, {name}: said nothing");
                }
            }
        }
    }
}

#[test]
fn a_body_that_begins_as_nonsense() {
    let log = Log::start();
    for transform in [
        Transform::from_xyz(1.0, 2.0, 3.0),
        Transform::from_xyz(f32::NAN, 2.0, 3.0),
    ] {
        let mut app = app();
        let bad = BodyState {
            position: NAN,
            ..tumbling()
        };
        let entity = app.world_mut().spawn((brick(), bad, transform)).id();
        run(&mut app, 3);
        assert_shown_sanely(&mut app);
        let expected = transform.translation.is_finite();
        let expected = if expected {
            transform.translation
        } else {
            Vec3::ZERO
        };
        assert_eq!(state(&app, entity).position.as_vec3(), expected);
        assert!(app.world().get::<Quarantined>(entity).is_some());
        let lines = log.take();
        assert!((1..=2).contains(&lines.len()), "{lines:#?}");
        assert!(
            lines.iter().any(|l| l.contains("is quarantined")),
            "{lines:#?}"
        );
        // Nobody can make a quarantined body show nonsense.
        *app.world_mut().get_mut(entity).expect("a body") = bad;
        run(&mut app, 3);
        assert_shown_sanely(&mut app);
        log.is_silent();
    }
}

#[test]
fn a_thousand_quarantines_are_one_line() {
    let log = Log::start();
    let mut app = app();
    for _ in 0..1000 {
        app.world_mut()
            .spawn((brick(), tumbling(), GravityScale(f64::NAN)));
    }
    app.update();
    log.says_once("999 more with it");
    let told: Vec<_> = app
        .world_mut()
        .resource_mut::<Messages<BodyQuarantined>>()
        .drain()
        .collect();
    assert_eq!(told.len(), 1000);
    assert!(told.iter().all(|m| m.cause == QuarantineCause::Step));
    run(&mut app, 3);
    log.is_silent();
}

#[test]
fn settings_out_of_range_stop_the_clock_until_they_are_put_right() {
    let log = Log::start();
    let bad_floor = |f: fn(&mut Floor)| {
        let mut floor = Floor::default();
        f(&mut floor);
        floor
    };
    let faults: Vec<(&str, Box<dyn Fn(&mut App)>)> = vec![
        (
            "WorldGravity.y",
            Box::new(|app| {
                app.insert_resource(WorldGravity(DVec3::new(0.0, f64::NAN, 0.0)));
            }),
        ),
        (
            "height",
            Box::new(move |app| {
                app.insert_resource(bad_floor(|f| f.height = f64::NAN));
            }),
        ),
        (
            "restitution",
            Box::new(move |app| {
                app.insert_resource(bad_floor(|f| f.restitution = 1.5));
            }),
        ),
        (
            "friction",
            Box::new(move |app| {
                app.insert_resource(bad_floor(|f| f.friction = -0.1));
            }),
        ),
        (
            "tolerance",
            Box::new(|app| {
                app.world_mut().resource_mut::<ContactSettings>().tolerance = 0.0;
            }),
        ),
        (
            "restitution_threshold",
            Box::new(|app| {
                app.world_mut()
                    .resource_mut::<ContactSettings>()
                    .restitution_threshold = f64::NAN;
            }),
        ),
        (
            "PhysicsClock.substeps",
            Box::new(|app| app.world_mut().resource_mut::<PhysicsClock>().substeps = 1_000_000),
        ),
    ];
    for (field, spoil) in faults {
        let mut app = app();
        app.insert_resource(Floor::default());
        let entity = app.world_mut().spawn((brick(), tumbling())).id();
        for _ in 0..2 {
            run(&mut app, 3);
            let steps = |app: &App| app.world().resource::<PhysicsClock>().steps();
            let before = (state(&app, entity), steps(&app));
            log.is_silent();
            spoil(&mut app);
            run(&mut app, 5);
            log.says_once(field);
            let fault = app.world().resource::<PhysicsClock>().fault();
            assert_eq!(fault.map(|f| f.field), Some(field));
            assert_eq!((state(&app, entity), steps(&app)), before);
            // Put right, it goes on.
            app.insert_resource(WorldGravity::default())
                .insert_resource(Floor::default())
                .insert_resource(ContactSettings::default());
            app.world_mut().resource_mut::<PhysicsClock>().substeps = 1;
            app.update();
            assert_ne!(state(&app, entity), before.0, "{field}");
            assert_eq!(app.world().resource::<PhysicsClock>().fault(), None);
        }
    }
}

#[test]
fn parents_that_displace_their_bodies_are_reported_once() {
    let log = Log::start();
    let spawn_under = |app: &mut App, parent: Entity| {
        let child = app.world_mut().spawn((brick(), tumbling())).id();
        app.world_mut().entity_mut(parent).add_child(child);
        child
    };
    // At the origin, unturned, unscaled: a folder, and nothing to say.
    let mut app = app();
    let parent = app.world_mut().spawn(Transform::IDENTITY).id();
    spawn_under(&mut app, parent);
    run(&mut app, 5);
    log.is_silent();
    // … until it moves.
    *app.world_mut().get_mut(parent).expect("spawned") = Transform::from_xyz(1.0, 0.0, 0.0);
    run(&mut app, 5);
    log.says_once("top of the hierarchy");
    // A scaled grandparent.
    let mut app = self::app();
    let grandparent = app
        .world_mut()
        .spawn(Transform::from_scale(Vec3::splat(2.0)))
        .id();
    let parent = app.world_mut().spawn(Transform::IDENTITY).id();
    app.world_mut().entity_mut(grandparent).add_child(parent);
    let child = spawn_under(&mut app, parent);
    run(&mut app, 5);
    log.says_once(&grandparent.to_string());
    // It is simulated in world coordinates all the same.
    let mut expected = tumbling();
    let mut memory = SchemeMemory::default();
    let h = Time::<Fixed>::from_hz(60.0).timestep().as_secs_f64();
    for _ in 0..5 {
        let gravity = Gravity(DVec3::new(0.0, -9.81, 0.0));
        Integrator::Split.step(&brick(), &mut expected, &gravity, h, &mut memory);
    }
    assert_eq!(state(&app, child), expected);
    // A body below a body.
    let mut app = self::app();
    let parent = app.world_mut().spawn((brick(), BodyState::default())).id();
    spawn_under(&mut app, parent);
    run(&mut app, 5);
    log.says_once("top of the hierarchy");
}

#[test]
fn constants_that_change_in_motion() {
    let log = Log::start();
    for &integrator in Integrator::ALL {
        let mut app = app();
        app.insert_resource(Floor::default())
            .insert_resource(GlobalIntegrator(integrator));
        let flying = app.world_mut().spawn((brick(), tumbling())).id();
        let lying = BodyState::at(DVec3::Y * 0.25);
        let lying = app.world_mut().spawn((brick(), lying)).id();
        run(&mut app, 30);
        let before = state(&app, flying);
        let larger = RigidBox::new(DVec3::new(0.6, 0.9, 0.4), 30.0).expect("valid");
        for entity in [flying, lying] {
            app.world_mut().entity_mut(entity).insert(larger);
        }
        // The numbers of the motion stay; the angular velocity follows from the new inertia.
        assert_eq!(state(&app, flying), before);
        run(&mut app, 30);
        assert_shown_sanely(&mut app);
        // It was in the floor: it is lifted out, and not shot out.
        let up = state(&app, lying);
        assert!((up.position.y - 0.9).abs() < 1e-9, "{integrator}: {up:?}");
        assert!(up.velocity.length() < 1e-9, "{integrator}: {up:?}");
        // Hot changes of everything else.
        app.insert_resource(WorldGravity(DVec3::new(1.0, -3.0, 0.0)))
            .insert_resource(Floor::new(0.5, 1.0, 0.0).expect("valid"));
        app.world_mut().resource_mut::<PhysicsClock>().substeps = 7;
        app.world_mut()
            .entity_mut(flying)
            .insert((LinearDrag(1.0), AngularDrag(0.1)));
        run(&mut app, 30);
        assert_shown_sanely(&mut app);
    }
    log.is_silent();
}

#[test]
fn what_comes_before_the_plugin_is_not_lost() {
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
    let entity = app
        .world_mut()
        .spawn((brick(), BodyState::at(DVec3::Y * 0.3)))
        .id();
    app.add_plugins((MinimalPlugins, PhysicsPlugins::default()))
        .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
    run(&mut app, 100);
    assert!(app.world().resource::<Calls>().0 >= 99);
    assert_eq!(
        *app.world().resource::<GlobalIntegrator>(),
        GlobalIntegrator(Integrator::Rk4)
    );
    // It fell on the floor and lies there.
    assert!((state(&app, entity).position.y - 0.25).abs() < 1e-9);
    assert!(app.world().get::<WorldAabb>(entity).is_some());
    let late = app.world_mut().spawn((brick(), tumbling())).id();
    run(&mut app, 2);
    assert!(app.world().get::<WorldAabb>(late).is_some());
    log.take();
}

#[test]
fn a_floor_that_goes_ends_its_contacts() {
    let log = Log::start();
    let mut app = app();
    app.insert_resource(Floor::default());
    let lying = BodyState::at(DVec3::Y * 0.25);
    let entity = app.world_mut().spawn((brick(), lying, ReportContacts)).id();
    run(&mut app, 5);
    let contact = |app: &App| {
        app.world()
            .get::<ContactState>(entity)
            .expect("there")
            .clone()
    };
    assert_eq!(contact(&app).touching().count_ones(), 4);
    app.world_mut()
        .resource_mut::<Messages<FloorContact>>()
        .clear();
    app.world_mut().remove_resource::<Floor>();
    app.update();
    let ended = app
        .world_mut()
        .resource_mut::<Messages<FloorContact>>()
        .drain()
        .filter(|c| c.phase == ContactPhase::Ended)
        .count();
    assert_eq!(ended, 4);
    run(&mut app, 2);
    assert_eq!(contact(&app), ContactState::default());
    assert!(state(&app, entity).velocity.y < 0.0, "it falls");
    app.insert_resource(Floor {
        height: -1.0,
        ..Floor::default()
    });
    run(&mut app, 200);
    assert!((state(&app, entity).position.y + 0.75).abs() < 1e-9);
    log.is_silent();
}
