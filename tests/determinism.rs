//! The same bits in every run, debug and release, on every machine, with any number of threads, in any order
//! of insertion, and with or without the optional parts.

use bevy::app::TaskPoolOptions;
use bevy::prelude::*;
use bevy::tasks::ComputeTaskPool;
use bevy::time::TimeUpdateStrategy;
use box_physics::digest::{fingerprint, state_digest};
use box_physics::floor::{ContactState, FloorContext};
use box_physics::force::Forces;
use box_physics::prelude::*;
// In a browser engine the tests run under its runner.
#[cfg(target_family = "wasm")]
use wasm_bindgen_test::wasm_bindgen_test as test;

const H: f64 = 1.0 / 64.0;
/// Number of threads of the physics. The pools belong to the process; half of their threads are for other work.
const MAX_THREADS: usize = 8;

/// The stored digests, equal on every machine. A changed digest is a changed result and belongs in the
/// changelog.
fn stored_digests() -> Vec<(Integrator, u64)> {
    // Included in the program, because a browser and an emulated machine have no files.
    let text = include_str!("expected/digests.csv");
    let row = |line: &str| {
        let (id, digest) = line.split_once(',')?;
        Some((id.parse().ok()?, u64::from_str_radix(digest, 16).ok()?))
    };
    let rows = text.lines().skip(1);
    rows.map(|line| row(line).unwrap_or_else(|| panic!("'{line}' is no digest")))
        .collect()
}

fn brick() -> RigidBox {
    RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
}

/// Numbers in [0, 1) that are the same on every machine: multiples of the golden ratio.
fn spread(k: u32) -> f64 {
    (f64::from(k) * 0.618_033_988_749_894_9).fract()
}

fn start(k: u32) -> BodyState {
    let s = |n: u32| 2.0 * spread(7 * k + n) - 1.0;
    BodyState::at_pose(
        DVec3::new(3.0 * f64::from(k), 0.6 + spread(k), s(1)),
        DQuat::from_xyzw(s(2), s(3), s(4), 1.0),
    )
    .with_velocity(DVec3::new(s(5), s(6), 2.0 * s(7)))
    .with_angular_velocity(&brick(), 1.5 * DVec3::new(s(3), s(5), s(1)))
}

/// Every third body has drag, every other third hangs on a damped spring; all are over a floor.
fn springs(k: u32) -> [Spring; 1] {
    [Spring {
        body_point: DVec3::new(0.5, 0.25, 0.125),
        anchor: DVec3::new(3.0 * f64::from(k), 2.0, 0.0),
        stiffness: 30.0,
        damping: 0.3,
    }]
}

fn dissipation(k: u32) -> Dissipation {
    if k % 3 == 1 {
        Dissipation {
            linear_drag: 0.2,
            quadratic_drag: 0.05,
            angular_damping: 0.1,
            angular_drag: 0.01,
            ..Dissipation::NONE
        }
    } else {
        Dissipation::NONE
    }
}

/// Body `k` after `steps` steps in the core alone.
fn core(integrator: Integrator, k: u32, steps: u32) -> BodyState {
    let (mut state, mut memory) = (start(k), IntegratorMemory::default());
    let mut contact = ContactState::default();
    let springs = springs(k);
    let law = Forces {
        acceleration: DVec3::new(0.0, -9.81, 0.0),
        dissipation: dissipation(k),
        springs: if k % 3 == 2 { &springs } else { &[] },
        ..Forces::default()
    };
    let context = FloorContext {
        floor: &Floor::default(),
        settings: &ContactSettings::default(),
        body: &brick(),
        force: &law,
    };
    for _ in 0..steps {
        integrator.step_on_floor(&context, &mut state, H, &mut memory, &mut contact, None);
    }
    state
}

#[test]
fn every_integrator_finds_the_stored_bits() {
    let stored = stored_digests();
    let wrong: Vec<String> = Integrator::ALL
        .iter()
        .map(|&i| (i, fingerprint(i), stored.iter().find(|(of, _)| *of == i)))
        .filter(|(_, found, stored)| stored.is_none_or(|(_, digest)| digest != found))
        .map(|(i, found, stored)| match stored {
            Some((_, digest)) => format!("{i}: {digest:016x} is stored, {found:016x} was found"),
            None => format!("{i}: {found:016x} was found, none is stored"),
        })
        .collect();
    assert!(
        wrong.is_empty(),
        "{}\nif this is intended: cargo box-report bless",
        wrong.join("\n")
    );
    assert_eq!(
        stored.len(),
        Integrator::ALL.len(),
        "digests without an integrator"
    );
}

/// Position of a body in the scene, independent of the order of spawning.
#[derive(Component, Clone, Copy)]
struct Place(u32);

/// State of a body, with its displayed transform and bounding box.
type Found = (BodyState, Transform, Option<WorldAabb>);

struct Variant {
    bodies: u32,
    steps: u32,
    integrator: Integrator,
    threads: usize,
    order: fn(u32, u32) -> u32,
    parts: bool,
    /// An additional component on every n-th body: other tables, the same bodies.
    table_every: u32,
}

impl Variant {
    fn plain(integrator: Integrator) -> Self {
        Self {
            bodies: 12,
            steps: 60,
            integrator,
            threads: 1,
            order: |k, _| k,
            parts: true,
            table_every: u32::MAX,
        }
    }

    /// The bodies in order of position.
    fn run(&self) -> Vec<Found> {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins.set(TaskPoolPlugin {
            task_pool_options: TaskPoolOptions::with_num_threads(2 * MAX_THREADS),
        }));
        if self.parts {
            app.add_plugins(PhysicsPlugins::default());
        } else {
            app.add_plugins((PhysicsPlugin::default(), FloorPlugin));
        }
        app.insert_resource(Floor::default())
            .insert_resource(GlobalIntegrator(self.integrator))
            // Every available thread gets bodies, even if they are few.
            .insert_resource(PhysicsThreads {
                max_threads: self.threads,
                bodies_per_thread: 1,
            })
            .insert_resource(Time::<Fixed>::from_seconds(H))
            .insert_resource(TimeUpdateStrategy::FixedTimesteps(1));
        app.update();
        for k in (0..self.bodies).map(|k| (self.order)(k, self.bodies)) {
            let mut body = app.world_mut().spawn((Place(k), brick(), start(k)));
            let d = dissipation(k);
            if d != Dissipation::NONE {
                body.insert((
                    LinearDrag(d.linear_drag),
                    QuadraticDrag(d.quadratic_drag),
                    AngularDamping(d.angular_damping),
                    AngularDrag(d.angular_drag),
                ));
            }
            if k % 3 == 2 {
                body.insert(Springs(springs(k).to_vec()));
            }
            if k % self.table_every == 0 {
                body.insert((ReportContacts, Name::new("in another table")));
            }
        }
        for _ in 0..self.steps {
            app.update();
        }
        let mut all =
            (app.world_mut()).query::<(&Place, &BodyState, &Transform, Option<&WorldAabb>)>();
        let mut found: Vec<(u32, Found)> = (all.iter(app.world()))
            .map(|(place, state, shown, aabb)| (place.0, (*state, *shown, aabb.copied())))
            .collect();
        found.sort_by_key(|(place, _)| *place);
        found.into_iter().map(|(_, body)| body).collect()
    }
}

#[test]
fn the_plugin_equals_the_core_for_any_order_tables_and_parts() {
    #[rustfmt::skip]
    let variants: [(&str, fn(&mut Variant)); 6] = [
        ("once", |_| ()),
        ("again", |_| ()),
        ("backwards", |v| v.order = |k, n| n - 1 - k),
        ("shuffled", |v| v.order = |k, n| k * 5 % n),
        ("without AABBs and timings", |v| v.parts = false),
        ("in several tables", |v| v.table_every = 2),
    ];
    for &integrator in Integrator::ALL {
        let plain = Variant::plain(integrator);
        let expected = (0..plain.bodies).map(|k| core(integrator, k, plain.steps));
        let expected: Vec<_> = expected.collect();
        for (what, change) in variants {
            let mut variant = Variant::plain(integrator);
            change(&mut variant);
            for (k, ((a, ..), b)) in variant.run().iter().zip(&expected).enumerate() {
                assert_eq!(
                    state_digest([a]),
                    state_digest([b]),
                    "{integrator}, {what}, body {k}: {a:?}, {b:?}"
                );
            }
        }
    }
}

#[test]
fn any_number_of_threads() {
    // Three tables, each divided into four chunks (of 512 bodies).
    const BODIES: u32 = 3 * 4 * 512;
    let run = |threads| {
        let variant = Variant {
            bodies: BODIES,
            steps: 20,
            threads,
            ..Variant::plain(Integrator::Split)
        };
        let found = variant.run();
        (state_digest(found.iter().map(|(state, ..)| state)), found)
    };
    let one = run(1);
    // A browser always has one thread.
    let pool = ComputeTaskPool::get().thread_num();
    assert!(
        pool + 1 >= MAX_THREADS || cfg!(target_family = "wasm"),
        "{pool}"
    );
    for threads in [2, 3, MAX_THREADS] {
        assert!(run(threads) == one, "{threads} threads");
    }
}
