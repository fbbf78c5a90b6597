//! Cost per body and step: in free flight, landing, and at rest.

use std::time::{Duration, Instant};

use bevy::app::App;
use box_bench::measure::Cost;
use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::engine::{Body, Engine, FRICTION, Place, RESTITUTION, Spec};
use crate::in_bevy;

/// Number of bodies, and number of samples with these bodies.
const SIZES: [(usize, usize); 3] = [(100, 9), (1000, 9), (10_000, 5)];
/// Steps per second; number of warm-up steps; number of timed steps.
const RATE: u32 = 60;
const WARM_UP: usize = 10;
const TIMED: usize = 120;
/// Distance between boxes \[m\].
const SPACING: f64 = 3.0;

impl Place {
    const fn id(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Landing => "landing",
            Self::Resting => "resting",
        }
    }
}

/// Cost of one engine in one situation with one number of bodies.
#[derive(Debug, Serialize)]
pub struct CostRow {
    engine: &'static str,
    place: &'static str,
    bodies: usize,
    ns_per_body_step_min: f64,
    ns_per_body_step_median: f64,
    ns_per_body_step_p95: f64,
    /// Cost of the physics alone, without the rest of the app; only for engines in Bevy.
    physics_ns_per_body_step_min: Option<f64>,
    physics_ns_per_body_step_median: Option<f64>,
}

/// Times every engine in turns. Also returns notes for the reader.
///
/// # Errors
/// An error message of an engine.
pub fn measure(
    engines: &[Box<dyn Engine>],
    quick: bool,
) -> Result<(Vec<CostRow>, Vec<String>), String> {
    let mut rows = Vec::new();
    for place in [Place::Free, Place::Landing, Place::Resting] {
        for (n, samples) in SIZES {
            if quick && n > SIZES[0].0 {
                continue;
            }
            let bodies = boxes(n, place);
            let spec = Spec {
                rate: RATE,
                gravity: 9.81,
                floor: place != Place::Free,
                bodies: &bodies,
            };
            let engines: Vec<_> = engines.iter().filter(|e| e.is_timed(place, n)).collect();
            let mut times = vec![Vec::new(); engines.len()];
            let mut alone = vec![Vec::new(); engines.len()];
            for _ in 0..if quick { 1 } else { samples } {
                let each = engines.iter().zip(&mut times).zip(&mut alone);
                for ((engine, times), alone) in each {
                    let (whole, physics) = run(engine.as_ref(), &spec)?;
                    times.push(whole);
                    alone.extend(physics);
                }
            }
            for ((engine, times), alone) in engines.iter().zip(&times).zip(&alone) {
                let cost = Cost::of(times);
                let alone = (!alone.is_empty()).then(|| Cost::of(alone));
                rows.push(CostRow {
                    engine: engine.id(),
                    place: place.id(),
                    bodies: n,
                    ns_per_body_step_min: cost.min,
                    ns_per_body_step_median: cost.median,
                    ns_per_body_step_p95: cost.p95,
                    physics_ns_per_body_step_min: alone.map(|cost| cost.min),
                    physics_ns_per_body_step_median: alone.map(|cost| cost.median),
                });
            }
        }
    }
    let (update, post_update) = empty_update();
    let notes = vec![
        format!(
            "Cost: {TIMED} steps of 1/{RATE} s after {WARM_UP} of warm-up, a new world for each of {} to {} samples, engines in turns; \
             free: the boxes tumble and fall; landing: they drop tumbling from half a meter, bounce and settle (friction {FRICTION}, restitution {RESTITUTION} in every \
             engine); resting: they lie on the floor from the start \
             (who puts boxes to sleep by default, does so).",
            SIZES[2].1, SIZES[0].1
        ),
        format!(
            "Of the engines in Bevy the whole `App::update` is timed: a body's `GlobalTransform`, and an update of the same app \
             without any physics, {:.1} µs, are part of their cost. *Physics alone* is their share of it, in which each plugin does \
             everything that it does in a step, `Transform` included: `FixedPhysics` of ours; `FixedPostUpdate` of Avian, which takes \
             {:.1} µs without any physics, for Bevy's own system in it.",
            update * 1e-3,
            post_update * 1e-3
        ),
    ];
    Ok((rows, notes))
}

/// Cost of one run [ns per body and step]: of the whole, and of the physics alone if it is a part.
fn run(engine: &dyn Engine, spec: &Spec) -> Result<(f64, Option<f64>), String> {
    let mut world = engine.build(spec)?;
    for _ in 0..WARM_UP {
        world.step();
    }
    let before = world.physics_time();
    let clock = Instant::now();
    for _ in 0..TIMED {
        world.step();
    }
    let elapsed = clock.elapsed();
    let physics = world.physics_time().zip(before);
    let state = world.state(spec.bodies.len() / 2);
    if !state.is_finite() {
        return Err(format!("{}: a box is lost", engine.id()));
    }
    let per_step = |time: Duration| time.as_nanos() as f64 / (TIMED * spec.bodies.len()) as f64;
    let physics = physics.map(|(after, before)| per_step(after - before));
    Ok((per_step(elapsed), physics))
}

/// Median time of an update without physics, and of `FixedPostUpdate` in it \[ns\].
fn empty_update() -> (f64, f64) {
    let mut app: App = in_bevy::app(RATE, in_bevy::clock_fixed_post_update);
    let times: Vec<(f64, f64)> = (0..1000)
        .map(|_| {
            let (before, clock) = (in_bevy::physics_time(&app), Instant::now());
            app.update();
            let part = in_bevy::physics_time(&app) - before;
            (clock.elapsed().as_nanos() as f64, part.as_nanos() as f64)
        })
        .collect();
    let (whole, part): (Vec<f64>, Vec<f64>) = times.into_iter().unzip();
    (Cost::of(&whole).median, Cost::of(&part).median)
}

/// Boxes on a grid, with different attitudes and spins, or flat on the floor.
fn boxes(n: usize, place: Place) -> Vec<Body> {
    let shape = RigidBox::new(DVec3::new(0.5, 0.25, 0.375), 3.0)
        .expect("half-extents and mass are positive");
    let side = (n as f64).sqrt().ceil() as usize;
    let height = match place {
        Place::Free => 500.0,
        Place::Landing => 1.25,
        Place::Resting => shape.half_extents().y,
    };
    let one = |k: usize| {
        let a = k as f64;
        let (row, column) = ((k / side) as f64, (k % side) as f64);
        let middle = side as f64 / 2.0;
        let at = DVec3::new(
            SPACING * (column - middle),
            height,
            SPACING * (row - middle),
        );
        let turn = DQuat::from_xyzw(a.sin(), (1.7 * a).cos(), (2.3 * a).sin(), 1.1).normalize();
        let spin = DVec3::new((3.1 * a).sin(), (0.7 * a).cos(), (1.3 * a).sin()) * 2.0;
        if place == Place::Resting {
            let start = BodyState::at(at);
            return Body { shape, start };
        }
        Body {
            shape,
            start: BodyState::at_pose(at, turn).with_angular_velocity(&shape, spin),
        }
    };
    (0..n).map(one).collect()
}
