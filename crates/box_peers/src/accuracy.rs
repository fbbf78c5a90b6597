//! Attitude and energy of free tumbles against the reference, over time.

use std::path::Path;

use box_scenarios::StateError;
use box_scenarios::oracle::Case;
use serde::Serialize;

use crate::engine::{Body, Engine, FINE_BODIES, Place, Spec};

/// The reference trajectories of free motion, including symmetric bodies.
const CASES: [&str; 5] = [
    "pub01_free_asymmetric",
    "pub03_symmetric_prolate",
    "pub04_thin_plate",
    "pub05_needle",
    "pub06_cube",
];
/// Steps per second.
const RATES: [u32; 3] = [30, 60, 120];
/// Number of samples per run.
const LOOKS: u32 = 30;

/// Errors of one engine in one case over time.
#[derive(Debug, Serialize)]
pub struct Accuracy {
    engine: &'static str,
    case: String,
    rate_hz: u32,
    /// Time \[s\], attitude error \[rad\], and signed energy error relative to the initial energy.
    points: Vec<(f64, f64, f64)>,
}

/// Measures every engine in every case at every rate.
///
/// # Errors
/// A case cannot be read, or an engine rejects it.
pub fn measure(engines: &[Box<dyn Engine>]) -> Result<Vec<Accuracy>, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/oracle");
    let mut all = Vec::new();
    for name in CASES {
        let case = Case::load(&folder.join(format!("{name}.json"))).map_err(|e| e.to_string())?;
        for rate in RATES {
            // Additional threads do not change the error of a single body, and there is no floor.
            let alone = |e: &&Box<dyn Engine>| {
                e.is_timed(Place::Free, FINE_BODIES) && !e.id().ends_with("-parallel")
            };
            for engine in engines.iter().filter(alone) {
                let points = follow(engine.as_ref(), &case, rate)?;
                all.push(Accuracy {
                    engine: engine.id(),
                    case: name.to_owned(),
                    rate_hz: rate,
                    points,
                });
            }
        }
    }
    Ok(all)
}

fn follow(engine: &dyn Engine, case: &Case, rate: u32) -> Result<Vec<(f64, f64, f64)>, String> {
    let setup = &case.setup;
    let body = Body {
        shape: setup.body,
        start: setup.initial,
    };
    let mut world = engine.build(&Spec {
        rate,
        gravity: 0.0,
        floor: false,
        bodies: &[body],
    })?;
    // The closed form, which the tests compare with the file. It is available at any time, including that of a clock
    // with whole nanoseconds or single precision.
    let solution = setup.reference();
    let energy = setup.initial.rotational_energy(&setup.body);
    let steps = (setup.duration * f64::from(rate)).round() as u32;
    let every = (steps / LOOKS).max(1);
    let mut points = Vec::new();
    for k in 1..=steps {
        world.step();
        if k % every != 0 {
            continue;
        }
        let t = world.time();
        let state = world.state(0);
        let reference = solution
            .at(t)
            .ok_or_else(|| format!("{}: no reference at {t} s", case.name))?;
        let attitude = StateError::between(&state, &reference).attitude;
        let change = state.rotational_energy(&setup.body) / energy - 1.0;
        // JSON has no infinity, so a lost run gets the largest possible error.
        let finite = |x: f64, or: f64| rounded(if x.is_finite() { x } else { or });
        points.push((
            rounded(t),
            finite(attitude, std::f64::consts::PI),
            finite(change, 1e9),
        ));
    }
    Ok(points)
}

/// Rounds to six digits, which suffice for a plot.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}
