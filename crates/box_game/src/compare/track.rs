//! What is measured of one trajectory, the hero's or a lane's, step by step.

use box_physics::prelude::{BodyState, Integrator};
use box_scenarios::StateError;

use super::ledger::Ledger;
use super::series::{Quantity, Sample, Series};
use crate::compare::lane::{Lane, Law};

/// The present figures of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The newest moment.
    pub sample: Sample,
    /// Largest distance so far \[m\] and angle \[°\] from the reference.
    pub worst: (f64, f64),
    /// Energies \[J\]: of translation, of rotation, potential.
    pub energies: [f64; 3],
}

impl Default for Measured {
    fn default() -> Self {
        let values = [f64::NAN; Quantity::ALL.len()];
        Self {
            sample: Sample { t: 0.0, values },
            worst: (0.0, 0.0),
            energies: [0.0; 3],
        }
    }
}

/// Books and past of one trajectory.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// The balance of energy and momentum.
    pub ledger: Ledger,
    /// The past.
    pub series: Series,
    /// The present.
    pub now: Measured,
    /// When it was given up \[s\].
    pub diverged: Option<f64>,
}

/// The two ends of a step as the reference sees it, for the error of the step alone.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceStep {
    /// At the beginning, after the inputs there.
    pub from: BodyState,
    /// At the end.
    pub to: BodyState,
}

impl Track {
    /// At the start.
    pub fn new(law: &Law, state: &BodyState, t: f64) -> Self {
        let mut track = Self {
            ledger: Ledger::new(law, state),
            ..Self::default()
        };
        track.observe(law, state, t, Some(state), None);
        track
    }

    /// New books from `state`; the past stays.
    pub(crate) fn reopen(&mut self, law: &Law, state: &BodyState, t: f64) {
        self.ledger = Ledger::new(law, state);
        self.now = Measured::default();
        self.diverged = None;
        self.observe(law, state, t, Some(state), None);
    }

    /// Looks at the state after a step that ends at `t` \[s\]; `local` is the error of that step alone.
    pub fn observe(
        &mut self,
        law: &Law,
        state: &BodyState,
        t: f64,
        reference: Option<&BodyState>,
        local: Option<StateError>,
    ) {
        let unknown = StateError {
            position: f64::NAN,
            attitude: f64::NAN,
            ..StateError::default()
        };
        let error = reference.map_or(unknown, |r| StateError::between(state, r));
        let local = local.unwrap_or(unknown);
        let left = self.ledger.residual(law, state);
        let sample = Sample {
            t,
            values: [
                error.position,
                error.attitude.to_degrees(),
                local.position,
                local.attitude.to_degrees(),
                left.energy,
                left.momentum,
                left.direction,
            ],
        };
        let (position, attitude) = self.now.worst;
        let kinetic = state.translational_energy(&law.body);
        let rotational = state.rotational_energy(&law.body);
        self.now = Measured {
            sample,
            // `max` passes over NaN.
            worst: (
                position.max(error.position),
                attitude.max(error.attitude.to_degrees()),
            ),
            energies: [
                kinetic,
                rotational,
                law.energy(state) - kinetic - rotational,
            ],
        };
        self.series.push(sample);
    }
}

/// The error of one step alone: from the reference's state at its beginning, against the reference at
/// its end.
pub fn local_error(
    integrator: Integrator,
    law: &Law,
    reference: &ReferenceStep,
    h: f64,
) -> StateError {
    let mut one = Lane::new(reference.from, integrator);
    one.step(law, h);
    StateError::between(&one.state, &reference.to)
}
