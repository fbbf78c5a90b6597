//! The families of motion for which the report compares integrators. Each has a setup, a reference and the errors that
//! distinguish integrators there.

mod list;

use std::sync::OnceLock;

use box_physics::integrators::Integrator;
use box_physics::state::BodyState;

use crate::driver::Totals;
use crate::metrics::{Errors, StateError, error_scale};
use crate::reference::ReferenceKind;
use crate::run::{Plan, run_plan};
use crate::setup::Setup;
use crate::simulate::{Compared, Comparison, Expected, compare};

/// An error that can be plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Metric {
    /// Distance of the center of mass from that of the reference \[m\].
    Position,
    /// Angle between the attitude and that of the reference \[rad\].
    Attitude,
    /// Deviation from a constant energy, relative to its initial value.
    Energy,
}

impl Metric {
    /// Identifier in files, lower case.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Attitude => "attitude",
            Self::Energy => "energy",
        }
    }

    /// Title of an axis, with the unit.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Position => "largest position error [m]",
            Self::Attitude => "largest attitude error [rad]",
            Self::Energy => "largest energy error, relative",
        }
    }

    /// The unit: m, rad, or empty.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Position => "m",
            Self::Attitude => "rad",
            Self::Energy => "",
        }
    }
}

/// A kind of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Identifier: lower case with hyphens.
    pub id: &'static str,
    /// Title, used as a heading.
    pub title: &'static str,
    /// Description of the motion, in one sentence.
    pub what: &'static str,
    /// Body, start, forces, floor, duration.
    pub setup: Setup,
    /// The errors that differ between integrators here; the first is the main one.
    pub metrics: &'static [Metric],
    /// Time for which a player might watch it \[s\]: up to its end, at most one minute.
    pub watch: f64,
}

/// The reference states at the ticks of a clock.
#[derive(Clone, Debug)]
pub struct ReferenceTable {
    /// Time between two states \[s\].
    interval: f64,
    /// States after 1, 2, … intervals.
    states: Vec<BodyState>,
    /// Source of the states, in words.
    pub source: String,
}

/// One run against its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FamilyRun {
    /// Largest errors over the ticks; the energy error is relative. `None` if the run failed: diverged, not finite or
    /// invalid.
    pub errors: Option<Errors>,
    /// Steps and evaluations.
    pub totals: Totals,
}

impl FamilyRun {
    /// The error in `metric`, if the run did not fail.
    pub fn error(&self, metric: Metric) -> Option<f64> {
        self.errors.map(|e| match metric {
            Metric::Position => e.position,
            Metric::Attitude => e.attitude,
            Metric::Energy => e.energy,
        })
    }
}

/// Steps of the fine reference per interval, for setups without another reference.
const FINE: u64 = 128 * 64;

impl Family {
    /// Every family.
    pub fn all() -> &'static [Self] {
        static ALL: OnceLock<Vec<Family>> = OnceLock::new();
        ALL.get_or_init(list::families)
    }

    /// The reference states at 1, 2, … times `interval` \[s\] up to `duration` \[s\].
    ///
    /// # Errors
    /// A sentence, if there is no reference.
    pub fn reference(&self, interval: f64, duration: f64) -> Result<ReferenceTable, String> {
        let samples = (duration / interval).round() as u64;
        let setup = Setup {
            duration: samples as f64 * interval,
            ..self.setup.clone()
        };
        let reference = setup.reference();
        if reference.kind() == ReferenceKind::None {
            return self.fine(interval, samples);
        }
        let at = |k: u64| reference.at(k as f64 * interval);
        let states: Option<Vec<_>> = (1..=samples).map(at).collect();
        let source = match reference.kind() {
            ReferenceKind::Numerical { agreement } => {
                format!(
                    "Dormand–Prince order 8; half the step agrees to {}",
                    short(agreement)
                )
            }
            _ => reference.description().to_owned(),
        };
        Ok(ReferenceTable {
            interval,
            states: states.ok_or_else(|| format!("{}: the reference ends too early", self.id))?,
            source,
        })
    }

    /// Computes a reference with the integrator that is exact between events, at a step 64 times smaller than the
    /// finest in use. Halving the step must not change the result.
    fn fine(&self, interval: f64, samples: u64) -> Result<ReferenceTable, String> {
        let run = |stride: u64| {
            let mut states = Vec::new();
            let plan = Plan::clock(interval / stride as f64, stride, samples);
            run_plan(&self.setup, Integrator::Exact, &plan, |_, state| {
                states.push(*state);
                true
            });
            states
        };
        let (states, halved) = (run(FINE), run(2 * FINE));
        let agreement = states
            .iter()
            .zip(&halved)
            .map(|(a, b)| {
                let e = StateError::between(a, b);
                e.position.max(e.attitude)
            })
            .fold(0.0, f64::max);
        if states.len() as u64 != samples || agreement > 1e-6 {
            return Err(format!(
                "{}: fine steps do not agree with finer ones ({agreement:e})",
                self.id
            ));
        }
        Ok(ReferenceTable {
            interval,
            states,
            source: format!(
                "exact between impacts, steps 64 times finer than the finest; half the step agrees to {}",
                short(agreement)
            ),
        })
    }

    /// Runs `integrator` over the whole `reference`, with `divisor` steps per interval.
    pub fn run(
        &self,
        reference: &ReferenceTable,
        integrator: Integrator,
        divisor: u64,
    ) -> FamilyRun {
        let (setup, start) = (&self.setup, &self.setup.initial);
        let run = self.compare(reference, integrator, divisor, |_| true);
        let mut errors = run.errors;
        errors.energy /= error_scale(setup.energy(start), start.kinetic_energy(&setup.body));
        FamilyRun {
            errors: (run.diverged.is_none()).then_some(errors),
            totals: run.totals,
        }
    }

    fn compare(
        &self,
        reference: &ReferenceTable,
        integrator: Integrator,
        divisor: u64,
        look: impl FnMut(&Compared) -> bool,
    ) -> Comparison {
        let energy = self.setup.conserved_energy();
        let mut states = reference.states.iter();
        let expected = |_| Expected {
            state: states.next().copied(),
            energy,
        };
        let plan = reference.plan(divisor);
        compare(&self.setup, integrator, &plan, expected, look)
    }

    /// The first time \[s\] at which the error of `integrator` exceeds `attitude` \[rad\] or `position` \[m\], and
    /// which of them it exceeds. `None` if neither happens before the reference ends. A failed run exceeds both.
    pub fn first_passing(
        &self,
        reference: &ReferenceTable,
        integrator: Integrator,
        divisor: u64,
        attitude: f64,
        position: f64,
    ) -> Option<(f64, Metric)> {
        let mut found = None;
        // Checks every step, so the reference must be as fine as the run.
        let run = self.compare(reference, integrator, divisor, |sample| {
            let e = sample.error.unwrap_or_default();
            if e.attitude > attitude {
                found = Some((sample.t, Metric::Attitude));
            } else if e.position > position {
                found = Some((sample.t, Metric::Position));
            }
            found.is_none()
        });
        found.or_else(|| run.diverged.map(|d| (d.t, Metric::Attitude)))
    }
}

impl ReferenceTable {
    fn plan(&self, divisor: u64) -> Plan {
        let samples = self.states.len() as u64;
        Plan::clock(self.interval / divisor as f64, divisor, samples)
    }

    /// Returns only every `k`-th state, for a run with longer steps.
    #[must_use]
    pub fn every(&self, k: usize) -> Self {
        Self {
            interval: self.interval * k as f64,
            states: self.states.iter().copied().skip(k - 1).step_by(k).collect(),
            source: self.source.clone(),
        }
    }

    /// The states, after 1, 2, … intervals.
    pub fn states(&self) -> &[BodyState] {
        &self.states
    }

    /// Time between two states \[s\].
    pub fn interval(&self) -> f64 {
        self.interval
    }
}

fn short(x: f64) -> String {
    format!("{x:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::integrators::Integrator;

    #[test]
    fn every_family_has_an_answer_and_converges_to_it() {
        for f in Family::all() {
            f.setup.validate().expect(f.id);
            let reference = f.reference(1.0 / 15.0, f.setup.duration).expect(f.id);
            let duration = reference.states.len() as f64 / 15.0;
            assert!((duration - f.setup.duration).abs() < 1e-9, "{}", f.id);
            for &m in f.metrics {
                let error = |divisor| f.run(&reference, Integrator::Split4, divisor).error(m);
                let fine = error(64).expect(f.id);
                assert!(fine < 1e-4, "{} {}: {fine:e}", f.id, m.id());
                let coarse = error(4).expect(f.id);
                assert!(fine < 1e-7 || fine < coarse / 30.0, "{}: {coarse:e}", f.id);
            }
        }
    }

    #[test]
    fn a_lost_run_is_seen_at_once_and_a_good_one_never() {
        let needle = &Family::all()[3];
        let reference = needle.reference(1.0 / 60.0, 5.0).expect("free motion");
        let passing = |i| needle.first_passing(&reference, i, 1, 0.0175, 0.01);
        assert_eq!(passing(Integrator::Exact), None);
        let (t, m) = passing(Integrator::SemiImplicitEuler).expect("lost");
        assert!(t < 1.0 && m == Metric::Attitude, "{t}");
        let failed = needle.run(&reference, Integrator::SemiImplicitEuler, 1);
        assert!(failed.errors.is_none());
        let slow = reference.every(2);
        assert_eq!(slow.states().len(), 150);
        assert_eq!(slow.states()[0], reference.states()[1]);
    }
}
