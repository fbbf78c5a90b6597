//! Flips of a box about its middle axis: the moments at which its spin axis reverses. The body component of the angular
//! momentum along that axis then changes its sign, at any attitude.

use box_physics::prelude::BodyState;
use box_scenarios::Model;

/// Fraction of |L| along one axis at the start above which that axis is watched.
const SPINS_ABOUT: f64 = 0.8;
/// Fraction of |L| beyond which a flip is complete; a wobble at the equator thus counts as one flip.
const THROUGH: f64 = 0.2;
/// Maximum number of flips kept: an hour of a box that flips every few seconds.
const MAX_FLIPS: usize = 1000;

/// The flips of one trajectory.
#[derive(Clone, Debug, Default)]
pub struct Flips {
    /// The watched axis, and the sign of L along it at the start.
    axis: Option<(usize, f64)>,
    /// The last sample: time \[s\] and L along the axis.
    last: (f64, f64),
    /// Time of the last change of sign \[s\]. That flip may be incomplete.
    crossed: f64,
    times: Vec<f64>,
}

impl Flips {
    /// Watches the axis about which the box spins in `state`; none over a floor, under a torque or at rest.
    pub fn new(model: &Model, state: &BodyState, t: f64) -> Self {
        let l = state.angular_momentum;
        let free = model.floor().is_none() && model.is_uniform_acceleration();
        let axis = (0..3)
            .find(|&k| free && l[k].abs() > SPINS_ABOUT * l.length())
            .map(|k| (k, l[k].signum()));
        Self {
            axis,
            last: (t, axis.map_or(0.0, |(k, _)| l[k])),
            crossed: t,
            times: Vec::new(),
        }
    }

    /// The watched axis, 0 to 2.
    pub fn axis(&self) -> Option<usize> {
        self.axis.map(|(k, _)| k)
    }

    /// Times of the flips \[s\], oldest first.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Records that the trajectory is in `state` at `t` \[s\].
    pub fn observe(&mut self, state: &BodyState, t: f64) {
        let Some((k, sign)) = self.axis else {
            return;
        };
        let (before, now) = (self.last, state.angular_momentum[k]);
        self.last = (t, now);
        if before.1 * now < 0.0 {
            let share = before.1 / (before.1 - now);
            self.crossed = before.0 + share * (t - before.0);
        }
        let even = self.times.len().is_multiple_of(2);
        let side = if even { sign } else { -sign };
        let through = -now * side > THROUGH * state.angular_momentum.length();
        if through && self.times.len() < MAX_FLIPS {
            self.times.push(self.crossed);
        }
    }

    /// Removes flips after `t` \[s\].
    pub fn rewind(&mut self, t: f64) {
        self.times.retain(|&flip| flip <= t);
        self.last = (t, 0.0);
    }
}

/// Largest lateness (> 0) or earliness (< 0) so far of the flips in `own` relative to `reference` at `now` \[s\], with
/// the number of that flip, from 1. `None` without any flip.
pub fn lateness(own: &[f64], reference: &[f64], now: f64) -> Option<(usize, f64)> {
    let both = own.iter().zip(reference).map(|(a, b)| a - b);
    // The first flip that only one of them has made is late or early by at least the time since then.
    let common = own.len().min(reference.len());
    let pending = match (own.get(common), reference.get(common)) {
        (None, Some(due)) => Some(now - due),
        (Some(made), None) => Some(made - now),
        _ => None,
    };
    both.chain(pending)
        .enumerate()
        .map(|(k, late)| (k + 1, late))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::Integrator;
    use box_scenarios::{Driver, Scenario};

    /// Flips about the middle axis are half the period of the motion apart. They are equal under two exact integrators,
    /// and late or early under one that changes the energy.
    #[test]
    fn flips_are_seen_when_they_happen() {
        let setup = Scenario::find("dzhanibekov").expect("a scene").setup;
        let model = Model::of(&setup);
        let flips = |integrator, h: f64| {
            let mut driver = Driver::new(setup.initial, integrator);
            let mut flips = Flips::new(&model, &setup.initial, 0.0);
            while driver.time < 12.0 {
                driver.step(&model, h);
                flips.observe(&driver.state, driver.time);
            }
            flips
        };
        let coarse = flips(Integrator::Exact, 1.0 / 60.0);
        let fine = flips(Integrator::Exact, 1.0 / 480.0);
        let (a, b) = (coarse.times(), fine.times());
        assert!(a.len() >= 3 && a.len() == b.len(), "{a:?} {b:?}");
        assert!(lateness(a, b, 12.0).expect("flips").1.abs() < 1e-3);
        let mut spacing = a.windows(2).map(|w| w[1] - w[0]);
        assert!(spacing.all(|s| (s - (a[1] - a[0])).abs() < 1e-2), "{a:?}");
        let euler = flips(Integrator::SemiImplicitEuler, 1.0 / 60.0);
        assert!(lateness(euler.times(), a, 12.0).expect("flips").1.abs() > 0.02);
        let mut back = coarse.clone();
        back.rewind(a[1]);
        assert_eq!(back.times().len(), 2);
    }

    #[test]
    fn a_flip_that_is_due_is_late_until_it_comes() {
        assert_eq!(lateness(&[], &[], 5.0), None);
        assert_eq!(lateness(&[], &[4.0], 5.0), Some((1, 1.0)));
        assert_eq!(lateness(&[4.5], &[4.0], 5.0), Some((1, 0.5)));
        assert_eq!(lateness(&[4.0, 4.75], &[4.0], 5.0), Some((2, -0.25)));
    }

    /// Over a floor or on a spring, a box turns back and forth, so no axis is watched.
    #[test]
    fn over_a_floor_there_are_no_flips() {
        for scene in ["bounce", "stiff-spring"] {
            let setup = Scenario::find(scene).expect("a scene").setup;
            let flips = Flips::new(&Model::of(&setup), &setup.initial, 0.0);
            assert_eq!(flips.axis(), None);
        }
    }
}
