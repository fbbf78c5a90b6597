//! Figures of the dissertation's claims.

use box_physics::integrators::Integrator;
use box_scenarios::dissertation::Stepper;
use box_scenarios::statistics::Quantiles;
use box_scenarios::style::{Dash, Marker};

use super::claims::{self, Tumble};
use super::cycle::{CONTENDERS, Cycles};
use crate::context::Stop;
use crate::document::Figure;
use crate::plot::{Axis, Line, Plot, Point, plain};

pub(super) const CYCLES: &str = "dissertation-cycles";
pub(super) const AMPLIFICATION: &str = "dissertation-amplification";
pub(super) const FALL: &str = "dissertation-fall";
pub(super) const ATTITUDE: &str = "dissertation-attitude";
pub(super) const ENERGY: &str = "dissertation-energy";

/// Number of points of a long line; each is the median of a bucket.
const BUCKETS: usize = 120;

fn finish(id: &str, caption: &str, plot: &Plot) -> Result<Figure, Stop> {
    Ok(Figure {
        id: id.to_owned(),
        caption: caption.to_owned(),
        svg: plot.svg().map_err(Stop::Internal)?,
        digest: false,
    })
}

/// A line of a stepper of the dissertation, in gray or black because it is not in the list of integrators.
fn theirs(label: &str, dash: Dash, marker: Marker, points: Vec<Option<Point>>) -> Line {
    Line {
        label: label.to_owned(),
        style: plain(dash, marker),
        points,
        markers: true,
    }
}

/// Time per cycle over the run.
pub(super) fn cycles(run: &Cycles) -> Result<Figure, Stop> {
    let line = |k: usize| -> Line {
        let times = &run.times[k];
        let bucket = times.len().div_ceil(BUCKETS).max(1);
        let points = times.chunks(bucket).enumerate().map(|(b, chunk)| {
            let median = Quantiles::of(chunk.iter().copied()).median();
            let t = (b as f64 + 0.5) * bucket as f64 * run.h;
            Some(Point::new(t, median))
        });
        let points: Vec<_> = points.collect();
        let label = CONTENDERS[k].to_owned();
        let line = match k {
            0 => theirs(&label, Dash::Dotted, Marker::Plus, points),
            1 => Line::of(Integrator::Heun2012, label, points),
            2 => theirs(&label, Dash::Solid, Marker::Plus, points),
            3 => Line::of(Integrator::Split, label, points),
            _ => Line::of(Integrator::Rk4, label, points),
        };
        line.unmarked()
    };
    let plot = Plot {
        title: format!("Time of an integration cycle over a run, dt = {} s", run.h),
        x: Axis::linear("time of the run [s]"),
        y: Axis::log("time per cycle [ns]"),
        lines: (0..CONTENDERS.len()).map(line).collect(),
    };
    finish(
        CYCLES,
        "The figure of 2012, repeated: the time of each integration cycle of one box over a run, including reading the clock (medians of neighboring cycles). The times of this library include contact located in time; bounces appear as peaks.",
        &plot,
    )
}

/// Factor by which one step under drag multiplies the velocity.
pub(super) fn amplification() -> Result<Figure, Stop> {
    let numbers: Vec<f64> = (0..=60).map(|k| f64::from(k) * 0.1).collect();
    let ours = |s: Integrator| {
        let points = numbers
            .iter()
            .map(|&z| Some(Point::new(z, claims::amplification(s, z))));
        Line::of(s, s.to_string(), points.collect()).unmarked()
    };
    let every_fifth = numbers.iter().step_by(5);
    let own =
        every_fifth.map(|&z| Some(Point::new(z, claims::amplification_2012(Stepper::Heun, z))));
    let mut lines: Vec<Line> = [
        Integrator::Heun2012,
        Integrator::ExplicitEuler,
        Integrator::Rk4,
        Integrator::BackwardEuler,
        Integrator::ImplicitMidpoint,
        Integrator::Split,
    ]
    .map(ours)
    .into();
    lines.push(theirs(
        "2012-heun, called implicit Euler",
        Dash::Dotted,
        Marker::Circle,
        own.collect(),
    ));
    let limit = vec![Some(Point::new(0.0, 1.0)), Some(Point::new(6.0, 1.0))];
    lines.push(theirs("stable below this", Dash::Dashed, Marker::Plus, limit).unmarked());
    let plot = Plot {
        title: "Velocity after one step under drag".to_owned(),
        x: Axis::linear("c·dt/m"),
        y: Axis::log("|v after / v before|").within(1e-3, 60.0),
        lines,
    };
    finish(
        AMPLIFICATION,
        "Above the dashed line, drag increases the velocity, which is impossible. What the dissertation calls implicit Euler crosses it at c·dt/m = 2, like explicit Euler; RK4 crosses it at 2.785, backward Euler and implicit midpoint never. split follows the exact exponential.",
        &plot,
    )
}

/// Free fall: error after one second against the step.
pub(super) fn fall() -> Result<Figure, Stop> {
    let steps: Vec<f64> = [25, 50, 100, 200, 400, 800, 1600]
        .map(|n| 1.0 / f64::from(n))
        .into();
    let line = |s: Integrator| {
        let points = steps
            .iter()
            .map(|&h| Some(Point::new(h, claims::fall_error(s, h))));
        Line::of(s, s.to_string(), points.collect())
    };
    let mut lines: Vec<Line> = [
        Integrator::Heun2012,
        Integrator::SemiImplicitEuler,
        Integrator::Rk4,
        Integrator::Split,
    ]
    .map(line)
    .into();
    for (stepper, label, marker) in [
        (Stepper::Heun, "2012-heun", Marker::Circle),
        (Stepper::Rk4, "2012-rk4", Marker::Square),
    ] {
        let points = steps
            .iter()
            .map(|&h| Some(Point::new(h, claims::fall_error_2012(stepper, h))));
        lines.push(theirs(label, Dash::Dotted, marker, points.collect()));
    }
    let whole = steps
        .iter()
        .map(|&h| Some(Point::new(h, claims::demo_fall_error(h))));
    lines.push(theirs(
        "2012 demo: g added to x",
        Dash::Dashed,
        Marker::Cross,
        whole.collect(),
    ));
    let plot = Plot {
        title: "One second of free fall: position error against step size".to_owned(),
        x: Axis::log("dt [s]"),
        y: Axis::log("position error after 1 s [m]").within(1e-16, 100.0),
        lines,
    };
    finish(
        FALL,
        "x += dt·v_new reduces any integrator to order 1, with an error of ½·g·dt·t: the Heun and RK4 of 2012 coincide with semi-implicit Euler. A correct RK4 and split are exact to rounding. The demo itself adds g to the position and is off by 4.9 m at any step size.",
        &plot,
    )
}

/// The free tumble with several integrators at 60 Hz, and in the demo.
pub(super) struct Tumbles {
    integrators: Vec<(Integrator, Tumble)>,
    pub(super) demo: Tumble,
    pub(super) undamped: Tumble,
}

/// Step of the tumbles \[s\].
const H: f64 = 1.0 / 60.0;

impl Tumbles {
    pub(super) fn measure() -> Result<Self, String> {
        let integrators = [
            Integrator::Split,
            Integrator::Rk4,
            Integrator::ImplicitMidpoint,
            Integrator::Midpoint,
            Integrator::BackwardEuler,
            Integrator::Heun2012,
            Integrator::ExplicitEuler,
        ];
        let measured = integrators.map(|s| claims::tumble(s, H).map(|t| (s, t)));
        Ok(Self {
            integrators: measured.into_iter().collect::<Result<_, _>>()?,
            demo: claims::tumble_2012(H, true)?,
            undamped: claims::tumble_2012(H, false)?,
        })
    }

    pub(super) fn of(&self, integrator: Integrator) -> Option<&Tumble> {
        let found = self.integrators.iter().find(|(s, _)| *s == integrator);
        found.map(|(_, t)| t)
    }

    fn lines(&self, y: fn(&(f64, f64, f64)) -> f64) -> Vec<Line> {
        // Every third step: 20 per second.
        let points = |t: &Tumble| -> Vec<_> {
            let thinned = t.points.iter().step_by(3);
            thinned.map(|p| Some(Point::new(p.0, y(p)))).collect()
        };
        let ours = self
            .integrators
            .iter()
            .map(|(s, t)| Line::of(*s, s.to_string(), points(t)));
        let mut lines: Vec<Line> = ours.collect();
        for (label, dash, t) in [
            ("2012 demo", Dash::Solid, &self.demo),
            ("2012 demo without damping", Dash::Dotted, &self.undamped),
        ] {
            lines.push(theirs(label, dash, Marker::Plus, points(t)));
        }
        lines.into_iter().map(Line::unmarked).collect()
    }

    pub(super) fn attitude(&self) -> Result<Figure, Stop> {
        let plot = Plot {
            title: "Free tumble at 60 Hz: attitude error over time".to_owned(),
            x: Axis::linear("time [s]"),
            y: Axis::log("attitude error [rad]").within(1e-10, 10.0),
            lines: self.lines(|p| p.1),
        };
        finish(
            ATTITUDE,
            "An ordinary box tumbles freely. The demo of 2012 has no gyroscopic term and rotates about three axes in succession: its attitude is wrong within the first second.",
            &plot,
        )
    }

    pub(super) fn energy(&self) -> Result<Figure, Stop> {
        let plot = Plot {
            title: "Free tumble at 60 Hz: energy over time".to_owned(),
            x: Axis::linear("time [s]"),
            y: Axis::linear("energy over initial energy").within(0.0, 1.5),
            lines: self.lines(|p| p.2),
        };
        finish(
            ENERGY,
            "The energy of a free tumble is constant. Explicit Euler gains energy; backward Euler loses a quarter of it in ten seconds. Implicit midpoint, RK4 and split conserve it (their lines coincide at 1).",
            &plot,
        )
    }
}
