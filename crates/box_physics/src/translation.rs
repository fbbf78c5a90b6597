//! Exact sub-flows of the center of mass: gravity with linear drag, and quadratic drag alone.

use glam::DVec3;

use crate::math::Exponential;
use crate::state::BodyState;

/// Solves v' = a − (c/m) v over `h` \[s\] exactly: x += hφ₁v + h²φ₂a, v ← e^{−ζ}v + hφ₁a with ζ = (c/m)h.
/// `rate` is c/m [1/s]; 0 gives the exact parabola.
#[inline(always)]
pub fn exponential_step(state: &mut BodyState, acceleration: DVec3, rate: f64, h: f64) {
    if rate == 0.0 {
        state.position += h * (state.velocity + (0.5 * h) * acceleration);
        state.velocity += h * acceleration;
    } else {
        let e = Exponential::new(rate * h);
        state.position += h * (e.phi1 * state.velocity + (h * e.phi2) * acceleration);
        state.velocity = e.decay * state.velocity + (h * e.phi1) * acceleration;
    }
}

/// Solves v' = −(k/m)|v|v over `h` \[s\] exactly: v/(1 + (k/m)|v|h). `rate` is k/m [1/m]. The velocity never
/// reverses, at any speed and step. The position is unchanged (in a splitting, the other part moves it).
#[inline(always)]
pub fn quadratic_drag_flow(velocity: DVec3, rate: f64, h: f64) -> DVec3 {
    velocity / (1.0 + rate * velocity.length() * h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabola() {
        let mut s = BodyState::at(DVec3::ZERO).with_velocity(DVec3::new(3.0, 9.0, 0.0));
        let g = DVec3::new(0.0, -9.81, 0.0);
        for _ in 0..240 {
            exponential_step(&mut s, g, 0.0, 1.0 / 60.0);
        }
        let exact = DVec3::new(12.0, 9.0 * 4.0 - 0.5 * 9.81 * 16.0, 0.0);
        assert!((s.position - exact).length() < 2e-13);
    }

    #[test]
    fn linear_drag_approaches_the_terminal_velocity_for_any_rate() {
        let g = DVec3::new(0.0, -9.81, 0.0);
        for rate in [1e-9, 1e-3, 0.5, 1e3, 1e6] {
            let mut s = BodyState::default().with_velocity(DVec3::new(20.0, 0.0, 0.0));
            let (n, h) = (120, 1.0 / 60.0);
            for _ in 0..n {
                exponential_step(&mut s, g, rate, h);
            }
            let e = Exponential::new(rate * h * f64::from(n));
            let t = h * f64::from(n);
            let x = t * (e.phi1 * DVec3::new(20.0, 0.0, 0.0) + t * e.phi2 * g);
            assert!(
                (s.position - x).length() < 1e-12 * x.length(),
                "rate {rate}"
            );
        }
    }

    #[test]
    fn quadratic_drag_is_a_flow_and_never_reverses() {
        let v = DVec3::new(3.0, -4.0, 12.0);
        let twice = quadratic_drag_flow(quadratic_drag_flow(v, 0.1, 0.3), 0.1, 0.7);
        assert!((twice - quadratic_drag_flow(v, 0.1, 1.0)).length() < 1e-15 * v.length());
        let fast = quadratic_drag_flow(DVec3::X * 1e4, 10.0, 100.0);
        assert!(fast.x > 0.0 && fast.x < 1.1e-3);
        assert_eq!(quadratic_drag_flow(DVec3::ZERO, 1.0, 1.0), DVec3::ZERO);
    }
}
