//! Differences between a computed state and the reference.

use box_physics::state::BodyState;
use glam::DVec3;

use crate::setup::Setup;
use crate::status::Reason;

/// Difference between two states at one time. All values are ≥ 0, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateError {
    /// |Δx| \[m\].
    pub position: f64,
    /// |Δv| [m/s].
    pub velocity: f64,
    /// Angle of the rotation between the attitudes \[rad\], 0 to π, as 2·atan2(|vec|, |w|).
    pub attitude: f64,
    /// |ΔL|, vectors in world axes [kg m²/s].
    pub angular_momentum: f64,
}

impl StateError {
    /// The error of a state that is not finite or missing.
    pub const INFINITE: Self = Self {
        position: f64::INFINITY,
        velocity: f64::INFINITY,
        attitude: f64::INFINITY,
        angular_momentum: f64::INFINITY,
    };

    /// The error of `state` relative to `reference`; infinite if `state` is not finite.
    pub fn between(state: &BodyState, reference: &BodyState) -> Self {
        if !state.is_finite() {
            return Self::INFINITE;
        }
        let momentum = state.angular_momentum_world() - reference.angular_momentum_world();
        Self {
            position: (state.position - reference.position).length(),
            velocity: (state.velocity - reference.velocity).length(),
            attitude: state.attitude_difference(reference),
            angular_momentum: momentum.length(),
        }
    }
}

/// The largest errors over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// |Δx| \[m\].
    pub position: f64,
    /// |Δv| [m/s].
    pub velocity: f64,
    /// Attitude \[rad\].
    pub attitude: f64,
    /// |ΔL| in world axes [kg m²/s].
    pub angular_momentum: f64,
    /// |E − E_expected| \[J\]; see [`Errors::include_energy`].
    pub energy: f64,
}

impl Errors {
    /// Includes the error at another time.
    pub fn include(&mut self, e: &StateError) {
        self.position = self.position.max(e.position);
        self.velocity = self.velocity.max(e.velocity);
        self.attitude = self.attitude.max(e.attitude);
        self.angular_momentum = self.angular_momentum.max(e.angular_momentum);
    }

    /// Includes the error of an energy \[J\] relative to its expected value \[J\].
    pub fn include_energy(&mut self, energy: f64, expected: f64) {
        let error = (energy - expected).abs();
        self.energy = if error.is_nan() {
            f64::INFINITY
        } else {
            self.energy.max(error)
        };
    }
}

/// Scale of an error: the magnitude at the start or, if that is 0, another one. If both are 0 the scale is 1, and the
/// error is absolute.
pub fn error_scale(initial: f64, other: f64) -> f64 {
    let scales = [initial.abs(), other];
    scales.into_iter().find(|&x| x > 0.0).unwrap_or(1.0)
}

/// Number of the 13 components of two states that differ in any bit.
pub(crate) fn differing_numbers(a: &BodyState, b: &BodyState) -> usize {
    let numbers = |s: &BodyState| s.to_array().map(f64::to_bits);
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.filter(|(a, b)| a != b).count()
}

/// Limits that distinguish a diverged run from an inaccurate one. A state is diverged if it is not finite, or more than
/// a thousand times faster than the reference has been so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedLimits {
    speed: f64,
    momentum: f64,
}

/// Factor by which a run may exceed the reference's largest speed and angular momentum. It is far above every
/// legitimate error and far below overflow.
const MAX_SPEED_RATIO: f64 = 1e3;

impl SpeedLimits {
    /// The limits of a run of `setup`, before its reference is known. If nothing moves, the size of the box and the
    /// speed that gravity gives in one second set the scale.
    pub fn of(setup: &Setup) -> Self {
        let (body, start) = (&setup.body, &setup.initial);
        let speed = setup.forces.acceleration(body).length() + body.radius();
        let momentum = body.inertia().dot(DVec3::ONE) + start.angular_momentum.length();
        let mut limits = Self {
            speed: speed + start.velocity.length(),
            momentum,
        };
        limits.include(start);
        limits
    }

    /// Includes a state of the reference.
    pub fn include(&mut self, reference: &BodyState) {
        let (v, l) = (reference.velocity, reference.angular_momentum);
        self.speed = self.speed.max(MAX_SPEED_RATIO * v.length());
        self.momentum = self.momentum.max(MAX_SPEED_RATIO * l.length());
    }

    /// The limit that `state` exceeds, if any.
    pub fn exceeded(&self, state: &BodyState) -> Option<Reason> {
        let within = state.velocity.length() <= self.speed
            && state.angular_momentum.length() <= self.momentum;
        match (state.is_finite(), within) {
            (false, _) => Some(Reason::Invalid),
            (true, false) => Some(Reason::Speed),
            (true, true) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn nothing_is_lost_in_a_maximum() {
        let reference = BodyState::at(DVec3::ONE);
        let mut bad = reference;
        bad.velocity.x = f64::NAN;
        let mut errors = Errors::default();
        errors.include(&StateError::between(&bad, &reference));
        errors.include(&StateError::between(&reference, &reference));
        errors.include_energy(f64::NAN, 1.0);
        errors.include_energy(1.0, 1.0);
        assert_eq!(errors.position, f64::INFINITY);
        assert_eq!(errors.energy, f64::INFINITY);
        let limits = SpeedLimits::of(&Scenario::default().setup);
        assert_eq!(limits.exceeded(&bad), Some(Reason::Invalid));
        assert_eq!(limits.exceeded(&reference), None);
        bad.velocity.x = 1e5;
        assert_eq!(limits.exceeded(&bad), Some(Reason::Speed));
    }

    #[test]
    fn scales_fall_back() {
        assert_eq!(error_scale(-2.0, 1.0), 2.0);
        assert_eq!(error_scale(0.0, 3.0), 3.0);
        assert_eq!(error_scale(0.0, 0.0), 1.0);
        assert_eq!(error_scale(0.0, 4.0), 4.0);
    }
}
