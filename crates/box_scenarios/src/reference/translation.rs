//! Motion of the center of mass in closed form.

use box_physics::state::BodyState;
use glam::DVec3;

use crate::forces::ForceSet;
use crate::setup::Setup;

/// φ₁ = (1 − e^{−z})/z and φ₂ = (1 − φ₁)/z for z ≥ 0, including 0.
pub(super) fn phi(z: f64) -> (f64, f64) {
    if z < 0.5 {
        // φ₂ = Σ (−z)ᵏ/(k+2)!, thirteen terms: 0.5¹³/15! < 1e-16.
        let (mut term, mut phi2) = (0.5, 0.0);
        for k in 0..13 {
            phi2 += term;
            term *= -z / f64::from(k + 3);
        }
        (1.0 - z * phi2, phi2)
    } else {
        let phi1 = -libm::expm1(-z) / z;
        (phi1, (1.0 - phi1) / z)
    }
}

/// Returns `true` if the wrench consists only of undamped springs at the center of mass.
pub(super) fn springs_at_center(f: &ForceSet) -> bool {
    f.body_torque == DVec3::ZERO
        && f.world_torque == DVec3::ZERO
        && f.point_forces.is_empty()
        && !f.springs.is_empty()
        && f.springs
            .iter()
            .all(|s| s.body_point == DVec3::ZERO && s.damping == 0.0)
}

/// A path in closed form.
#[derive(Clone, Debug)]
pub(super) enum Translation {
    /// v' = a − c v
    Linear {
        x: DVec3,
        v: DVec3,
        a: DVec3,
        rate: f64,
    },
    /// x'' = −Ω² (x − center)
    Oscillator {
        x: DVec3,
        v: DVec3,
        center: DVec3,
        frequency: f64,
    },
    /// Along one line: s'' = a − κ |s'| s' in the direction of a (or of v, if a = 0).
    Straight {
        x: DVec3,
        along: DVec3,
        speed: f64,
        a: f64,
        kappa: f64,
    },
}

impl Translation {
    pub(super) fn of(setup: &Setup, start: &BodyState) -> Option<Self> {
        let (body, f) = (&setup.body, &setup.forces);
        let (x, v, a) = (start.position, start.velocity, f.acceleration(body));
        if springs_at_center(f) {
            if f.linear_drag != 0.0 || f.quadratic_drag != 0.0 {
                return None;
            }
            let k: f64 = f.springs.iter().map(|s| s.stiffness).sum();
            if k <= 0.0 {
                return None;
            }
            let pull: DVec3 = f.springs.iter().map(|s| s.stiffness * s.anchor).sum();
            return Some(Self::Oscillator {
                x,
                v,
                center: (pull + body.mass() * a) / k,
                frequency: (k / body.mass()).sqrt(),
            });
        }
        if !f.point_forces.is_empty() || !f.springs.is_empty() {
            return None;
        }
        if f.quadratic_drag == 0.0 {
            return Some(Self::Linear {
                x,
                v,
                a,
                rate: f.linear_drag * body.inverse_mass(),
            });
        }
        let line = if a == DVec3::ZERO { v } else { a };
        let along = line.normalize_or_zero();
        if f.linear_drag != 0.0 || v.cross(along) != DVec3::ZERO {
            return None;
        }
        Some(Self::Straight {
            x,
            along,
            speed: v.dot(along),
            a: a.length(),
            kappa: f.quadratic_drag * body.inverse_mass(),
        })
    }

    /// Position \[m\] and velocity [m/s] after `t` \[s\].
    pub(super) fn at(&self, t: f64) -> (DVec3, DVec3) {
        match *self {
            Self::Linear { x, v, a, rate } => {
                let (phi1, phi2) = phi(rate * t);
                (
                    x + t * (phi1 * v + t * phi2 * a),
                    libm::exp(-rate * t) * v + t * phi1 * a,
                )
            }
            Self::Oscillator {
                x,
                v,
                center,
                frequency,
            } => {
                let (s, c) = libm::sincos(frequency * t);
                let r = x - center;
                (
                    center + c * r + s / frequency * v,
                    c * v - s * frequency * r,
                )
            }
            Self::Straight {
                x,
                along,
                speed,
                a,
                kappa,
            } => {
                let (s, v) = straight(t, speed, a, kappa);
                (x + along * s, along * v)
            }
        }
    }
}

/// Solves s'' = a − κ|s'|s' from s = 0, s' = `v`, with a ≥ 0. Returns distance \[m\] and speed [m/s] after `t`. With
/// the terminal speed u = √(a/κ) and the rate r = √(aκ):
/// - backward (v < 0), until it reverses: s' = −u tan(θ₀ − rt), θ₀ = atan(−v/u), s = −(1/κ) ln of the ratio of cosines;
/// - forward below u: s' = u tanh(rt + atanh(v/u)); above: coth; in both, with T = tanh rt,
///   s' = u (v + uT)/(u + vT) and s = (1/κ) ln(cosh rt + (v/u) sinh rt).
fn straight(t: f64, v: f64, a: f64, kappa: f64) -> (f64, f64) {
    if a == 0.0 {
        // v ≥ 0 along its own direction.
        let z = kappa * v * t;
        return (libm::log1p(z) / kappa, v / (1.0 + z));
    }
    let (u, r) = ((a / kappa).sqrt(), (a * kappa).sqrt());
    if v < 0.0 {
        let start = libm::atan(-v / u);
        let turn = start / r;
        // cos θ₀ = 1/√(1 + (v/u)²)
        let height = 0.5 * libm::log1p((v / u) * (v / u)) / kappa;
        if t < turn {
            let angle = start - r * t;
            return (
                -(height + libm::log(libm::cos(angle)) / kappa),
                -u * libm::tan(angle),
            );
        }
        let (s, w) = straight(t - turn, 0.0, a, kappa);
        return (s - height, w);
    }
    let z = r * t;
    let (w, tanh) = (v / u, libm::tanh(z));
    // ln(cosh z + w sinh z) = z + ln((1+w)/2 + (1−w)/2 e^{−2z}) = z + ln1p((1−w)/2 (e^{−2z} − 1))
    let way = (z + libm::log1p(0.5 * (1.0 - w) * libm::expm1(-2.0 * z))) / kappa;
    (way, u * (w + tanh) / (1.0 + w * tanh))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phi_functions_join_smoothly() {
        let (below, above) = (phi(0.5 - 1e-15), phi(0.5));
        assert!((below.0 - above.0).abs() < 1e-14 && (below.1 - above.1).abs() < 1e-14);
        assert_eq!(phi(0.0), (1.0, 0.5));
        assert!((phi(1e-12).0 - (1.0 - 5e-13)).abs() < 1e-16);
    }

    /// s' is the derivative of s, and s'' satisfies the equation of motion, on every branch.
    #[test]
    fn quadratic_drag_obeys_its_equation() {
        for (v, a) in [
            (0.0, 9.81),
            (30.0, 9.81),
            (1e3, 9.81),
            (-45.0, 9.81),
            (7.0, 0.0),
        ] {
            let (kappa, d) = (1.0 / 48.0, 1e-4);
            for t in [0.3, 1.0, 2.2, 6.0] {
                let at = |t| straight(t, v, a, kappa);
                let ((s0, v0), (_, v1), (s2, v2)) = (at(t - d), at(t), at(t + d));
                assert!(((s2 - s0) / (2.0 * d) - v1).abs() < 1e-6 * v1.abs().max(1.0));
                let law = a - kappa * v1.abs() * v1;
                assert!(
                    ((v2 - v0) / (2.0 * d) - law).abs() < 1e-5 * law.abs().max(1.0),
                    "{v} {t}"
                );
            }
            assert!((straight(1e-9, v, a, kappa).1 - v).abs() < 1e-4 * v.abs().max(1.0));
        }
    }
}
