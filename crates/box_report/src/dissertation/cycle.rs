//! The experiment of the dissertation: the time of each integration cycle over a run of one box, and the share of the
//! processor time.

use std::time::Instant;

use box_bench::measure::Cost;
use box_physics::body::RigidBox;
use box_physics::integrators::Integrator;
use box_physics::state::BodyState;
use box_scenarios::dissertation::{Demo, State, Stepper};
use box_scenarios::statistics::Quantiles;
use box_scenarios::{Driver, FloorSpec, ForceSet, Model, Setup};
use glam::DVec3;
use serde::Serialize;

/// The steps of the dissertation \[s\], from smallest to largest.
pub(super) const STEPS: [f64; 3] = [0.005, 0.0075, 0.01];
/// Duration of a run \[s\]: in full, and with `--quick`.
const RUN: (f64, f64) = (30.0, 3.0);
/// Time between pushes \[s\]; they go along each axis in turn.
const PUSH_EVERY: f64 = 2.0;
/// Impulse of a push on the mass of 1 kg \[N s\].
const PUSH: f64 = 3.0;

/// The contenders, in the order of [`Cycles::times`].
pub(super) const CONTENDERS: [&str; 5] = [
    "reading the clock only",
    "2012-heun, called implicit Euler",
    "2012-rk4",
    "split, with exact contact",
    "rk4, with exact contact",
];

/// The times of all cycles of a run.
pub(super) struct Cycles {
    pub(super) h: f64,
    /// Time of each cycle \[ns\], one list per contender.
    pub(super) times: Vec<Vec<f64>>,
}

/// A line of the CSV file.
#[derive(Serialize)]
pub(super) struct Row {
    dt_s: f64,
    contender: &'static str,
    cycles: usize,
    ns_min: f64,
    ns_median: f64,
    ns_p95: f64,
    /// Median without the time for reading the clock.
    ns_net: f64,
    /// `ns_net` divided by the step.
    processor_share: f64,
}

impl Cycles {
    /// Minimum, median and other statistics of one contender.
    pub(super) fn cost(&self, contender: usize) -> Cost {
        Cost::of(&self.times[contender])
    }

    /// Time of a cycle without reading the clock \[ns\].
    pub(super) fn net(&self, contender: usize) -> f64 {
        (self.middle(contender) - self.middle(0)).max(0.0)
    }

    /// The interquartile mean, because a clock with a resolution of tens of nanoseconds gives no finer median.
    fn middle(&self, contender: usize) -> f64 {
        Quantiles::of(self.times[contender].iter().copied()).middle()
    }

    pub(super) fn rows(&self) -> Vec<Row> {
        let row = |(k, name): (usize, &&'static str)| {
            let c = self.cost(k);
            Row {
                dt_s: self.h,
                contender: name,
                cycles: self.times[k].len(),
                ns_min: c.min,
                ns_median: c.median,
                ns_p95: c.p95,
                ns_net: self.net(k),
                processor_share: self.net(k) * 1e-9 / self.h,
            }
        };
        CONTENDERS.iter().enumerate().map(row).collect()
    }
}

/// Runs all contenders side by side, cycle by cycle, and times each cycle separately, as the dissertation did.
pub(super) fn run(h: f64, quick: bool) -> Cycles {
    let body = RigidBox::default();
    let start = BodyState::at(DVec3::Y * 4.5);
    let demo = Demo::of(&body, Some(0.0));
    let mut theirs = [State::new(&body, &start); 2];
    let setup = Setup::new(body, start, ForceSet::gravity(9.81), RUN.0);
    let model = Model::of(&setup.with_floor(FloorSpec::at_zero(0.5, 0.0)));
    let mut ours = [Integrator::Split, Integrator::Rk4].map(|i| Driver::new(start, i));
    let n = (if quick { RUN.1 } else { RUN.0 } / h).round() as usize;
    let every = (PUSH_EVERY / h).round() as usize;
    let mut times = vec![Vec::with_capacity(n); CONTENDERS.len()];
    let timed = |work: &mut dyn FnMut()| {
        let clock = Instant::now();
        work();
        clock.elapsed().as_nanos() as f64
    };
    for k in 0..n {
        if k % every == every / 2 {
            let axis = [DVec3::X, DVec3::Y, DVec3::Z][(k / every) % 3];
            let impulse = axis * PUSH * body.mass();
            for s in &mut theirs {
                demo.push(s, Demo::force_for(impulse), DVec3::ZERO);
            }
            for o in &mut ours {
                o.state
                    .apply_impulse_at_body_point(&body, impulse, DVec3::ZERO);
            }
        }
        let [heun, rk4] = &mut theirs;
        let [split, proper] = &mut ours;
        times[0].push(timed(&mut || {}));
        times[1].push(timed(&mut || demo.cycle(Stepper::Heun, heun, h)));
        times[2].push(timed(&mut || demo.cycle(Stepper::Rk4, rk4, h)));
        times[3].push(timed(&mut || {
            split.step(&model, h);
        }));
        times[4].push(timed(&mut || {
            proper.step(&model, h);
        }));
    }
    std::hint::black_box((theirs, &ours[0].state, &ours[1].state));
    Cycles { h, times }
}
