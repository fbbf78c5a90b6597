//! Measurements of one trajectory (main box or comparison), step by step.

use box_physics::prelude::BodyState;

use box_scenarios::{Balance, Model, StateError};

use super::flips::Flips;
use super::series::{Quantity, Sample, Series};

/// Current measurements of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The newest sample.
    pub sample: Sample,
    /// Largest distance so far \[m\] and angle \[°\] from the reference.
    pub worst: (f64, f64),
    /// Translational, rotational and potential energy \[J\].
    pub energies: [f64; 3],
    /// Residual of the balance of the angular momentum vector, relative to its scale.
    pub momentum: f64,
}

impl Default for Measured {
    fn default() -> Self {
        let values = [f64::NAN; Quantity::ALL.len()];
        Self {
            sample: Sample { t: 0.0, values },
            worst: (0.0, 0.0),
            energies: [0.0; 3],
            momentum: f64::NAN,
        }
    }
}

/// Past and current measurements of one trajectory.
#[derive(Clone, Debug, Default)]
pub struct Track {
    /// Time series of the past.
    pub series: Series,
    /// Current measurements.
    pub now: Measured,
    /// Flips of the trajectory.
    pub flips: Flips,
}

impl Track {
    /// Creates a track that starts at `t` \[s\] in `state`.
    pub fn new(model: &Model, balance: &Balance, state: &BodyState, t: f64) -> Self {
        let mut track = Self::default();
        track.reopen(model, balance, state, t);
        track
    }

    /// Continues the trajectory from `state` with a new balance, and keeps the past.
    pub(crate) fn reopen(&mut self, model: &Model, balance: &Balance, state: &BodyState, t: f64) {
        self.now = Measured::default();
        self.flips = Flips::new(model, state, t);
        self.observe((model, balance), state, t, Some(state), None);
    }

    /// Removes the measurements after `t` \[s\].
    pub(crate) fn rewind(&mut self, t: f64) {
        self.series.rewind(t);
        self.flips.rewind(t);
    }

    /// Measures the state after a step that ends at `t` \[s\]; `local` is the error of that step alone.
    pub fn observe(
        &mut self,
        (law, balance): (&Model, &Balance),
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
        let left = balance.residual(law, state);
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
        let translation = state.translational_energy(&law.body);
        let rotation = state.rotational_energy(&law.body);
        let potential = law.energy(state) - translation - rotation;
        self.now = Measured {
            sample,
            // `max` passes over NaN.
            worst: (
                position.max(error.position),
                attitude.max(error.attitude.to_degrees()),
            ),
            energies: [translation, rotation, potential],
            momentum: left.vector,
        };
        self.flips.observe(state, t);
        self.series.push(sample);
    }
}
