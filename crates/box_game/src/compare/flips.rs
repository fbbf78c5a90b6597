//! Flips of a box about its middle axis: the moments at which the axis it spins about turns over. The body
//! component of the angular momentum along that axis changes its sign there, which no display angle can hide.

use box_physics::prelude::BodyState;
use box_scenarios::Model;

/// Share of |L| along one axis at the start that makes it the axis to watch.
const SPINS_ABOUT: f64 = 0.8;
/// A flip counts once the axis is this far through (share of |L|): a wobble at the equator is one flip.
const THROUGH: f64 = 0.2;
/// Flips kept at most: an hour of a box that turns over every few seconds.
const MAX_FLIPS: usize = 1000;

/// The flips of one trajectory.
#[derive(Clone, Debug, Default)]
pub struct Flips {
    /// Axis that is watched, and the sign of L along it at the start.
    axis: Option<(usize, f64)>,
    /// The last sample: time \[s\], L along the axis.
    last: (f64, f64),
    /// The newest change of sign \[s\], which need not be through yet.
    crossed: f64,
    times: Vec<f64>,
}

impl Flips {
    /// Watches the axis that the box spins about in `state`; none over a floor, under a torque or at rest.
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

    /// The axis that is watched, 0 to 2.
    pub fn axis(&self) -> Option<usize> {
        self.axis.map(|(k, _)| k)
    }

    /// Times of the flips \[s\], oldest first.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The trajectory is in `state` at `t` \[s\].
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

    /// Forgets what was after `t` \[s\].
    pub fn rewind(&mut self, t: f64) {
        self.times.retain(|&flip| flip <= t);
        self.last = (t, 0.0);
    }
}

/// By how much the flips in `own` are late (> 0) or early (< 0) against `reference` at `now` \[s\], and which
/// flip that is, from 1: the largest so far. `None` without any flip.
pub fn lateness(own: &[f64], reference: &[f64], now: f64) -> Option<(usize, f64)> {
    let both = own.iter().zip(reference).map(|(a, b)| a - b);
    // The first flip that only one of them has made is late or early by at least the time since.
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

    /// The flip about the middle axis: half the period of the motion apart, alike under two exact integrators,
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

    /// Over a floor or on a spring a box turns back and forth: there is no axis to watch.
    #[test]
    fn over_a_floor_there_are_no_flips() {
        for scene in ["bounce", "stiff-spring"] {
            let setup = Scenario::find(scene).expect("a scene").setup;
            let flips = Flips::new(&Model::of(&setup), &setup.initial, 0.0);
            assert_eq!(flips.axis(), None);
        }
    }
}
