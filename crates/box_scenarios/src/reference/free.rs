//! Free rotation in closed form, also with the damping torque −γL, which only rescales time.
//!
//! The angular momentum follows Jacobi's elliptic functions (Landau, Lifshitz, *Mechanics*, §37). The attitude is a
//! frame attached to it, rotated about the constant world momentum by an elliptic integral of the third kind in
//! Carlson's form. (The integrator `exact` uses theta functions, an independent method for the same motion.)

use box_physics::body::RigidBox;
use box_physics::rotation::exponential_map;
use box_physics::state::BodyState;
use glam::{DMat3, DQuat, DVec3};

use super::jacobi::Elliptic;
use super::turn;

/// The rotation of a body from a given start, for all times.
#[derive(Clone, Debug)]
pub struct FreeMotion {
    rotation: DQuat,
    momentum: DVec3,
    /// γ [1/s]
    damping: f64,
    branch: Branch,
}

#[derive(Clone, Debug)]
enum Branch {
    /// Sphere, rest, or spin about a principal axis: constant body angular velocity.
    Steady { spin: DVec3 },
    /// Two moments equal in floating point.
    Symmetric {
        axis: DVec3,
        inverse: f64,
        rate: f64,
    },
    /// Three different moments.
    General(Box<General>),
}

impl FreeMotion {
    /// The motion from `start` with the torque −γL, `damping` = γ [1/s] ≥ 0.
    pub fn new(body: &RigidBox, start: &BodyState, damping: f64) -> Self {
        Self {
            rotation: start.rotation,
            momentum: start.angular_momentum,
            damping,
            branch: Branch::new(body, start.angular_momentum),
        }
    }

    /// Attitude and body angular momentum [kg m²/s] after `t` \[s\].
    pub fn at(&self, t: f64) -> (DQuat, DVec3) {
        // With L_w = e^{−γt} L_w(0), Euler's equations become those of the free motion in the time s = (1 − e^{−γt})/γ,
        // because they are quadratic in L.
        let (s, decay) = if self.damping == 0.0 {
            (t, 1.0)
        } else {
            let z = self.damping * t;
            (-libm::expm1(-z) / self.damping, libm::exp(-z))
        };
        let (turn, l) = match &self.branch {
            Branch::Steady { spin } => (exponential_map(*spin * s), self.momentum),
            Branch::Symmetric {
                axis,
                inverse,
                rate,
            } => {
                // q(t) = exp(t L/I₁) ∘ exp(t (1/I₃ − 1/I₁) L₃ e₃), both from the start's body axes.
                let spin = turn(*axis, rate * s);
                let precession = exponential_map(self.momentum * (inverse * s));
                (precession * spin, spin.inverse() * self.momentum)
            }
            Branch::General(g) => g.at(s),
        };
        ((self.rotation * turn).normalize(), l * decay)
    }

    pub(super) fn write(&self, t: f64, state: &mut BodyState) {
        (state.rotation, state.angular_momentum) = self.at(t);
    }
}

impl Branch {
    fn new(body: &RigidBox, l: DVec3) -> Self {
        let (i, j) = (body.inertia().to_array(), body.inverse_inertia());
        let moving = l.to_array().iter().filter(|c| **c != 0.0).count();
        if moving <= 1 || (i[0] == i[1] && i[1] == i[2]) {
            return Self::Steady { spin: j * l };
        }
        for axis in 0..3 {
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            if i[one] == i[other] {
                return Self::Symmetric {
                    axis: DVec3::AXES[axis],
                    inverse: j[one],
                    rate: (i[one] - i[axis]) / (i[one] * i[axis]) * l[axis],
                };
            }
        }
        Self::General(Box::new(General::new(i, l)))
    }
}

/// Three different moments. Axes (a, b, c): L circulates about c, and b is the middle axis.
#[derive(Clone, Debug)]
struct General {
    /// Body to (a, b, c) axes.
    to_abc: DMat3,
    magnitude: f64,
    inertia: DVec3,
    amplitude: DVec3,
    /// Signs of L_b and L_c in the formulas (of L_a too on the separatrix).
    sign: DVec3,
    /// du/dt [1/s]
    rate: f64,
    u0: f64,
    /// `None` on the separatrix.
    elliptic: Option<Elliptic>,
    /// The frame about L at the start, and the precession angle there.
    frame0: DMat3,
    phase0: f64,
}

impl General {
    fn new(i: [f64; 3], l: DVec3) -> Self {
        let mut order = [0_usize, 1, 2];
        order.sort_by(|&p, &q| i[p].total_cmp(&i[q]));
        let [low, mid, high] = order;
        // D = L² − 2T I_mid, without cancellation.
        let d = l[low] * l[low] * (i[low] - i[mid]) / i[low]
            + l[high] * l[high] * (i[high] - i[mid]) / i[high];
        let (a, c) = if d > 0.0 { (low, high) } else { (high, low) };
        // Makes (a, b, c) right-handed by reversing a if necessary.
        let mut rows = [DVec3::AXES[a], DVec3::AXES[mid], DVec3::AXES[c]];
        if rows[0].cross(rows[1]).dot(rows[2]) < 0.0 {
            rows[0] = -rows[0];
        }
        let to_abc = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
        let (la, lb, lc) = (to_abc * l).into();
        let (ia, ib, ic) = (i[a], i[mid], i[c]);
        let amplitude = DVec3::new(
            (la * la + lb * lb * (ia * (ib - ic)) / (ib * (ia - ic))).sqrt(),
            (lb * lb + la * la * (ib * (ia - ic)) / (ia * (ib - ic))).sqrt(),
            (lc * lc + lb * lb * (ic * (ia - ib)) / (ib * (ia - ic))).sqrt(),
        );
        let rate = amplitude.z / ic * ((ib - ic) * (ia - ic) / (ia * ib)).sqrt();
        let sc = 1.0_f64.copysign(lc);
        let handed = -1.0_f64.copysign(ib - ic); // −sgn(1/I_c − 1/I_b)
        let mut g = Self {
            to_abc,
            magnitude: l.length(),
            inertia: DVec3::new(ia, ib, ic),
            amplitude,
            sign: DVec3::new(1.0, handed * sc, sc),
            rate,
            u0: 0.0,
            elliptic: None,
            frame0: DMat3::IDENTITY,
            phase0: 0.0,
        };
        if d == 0.0 {
            let sa = 1.0_f64.copysign(la);
            g.sign = DVec3::new(sa, handed * sa * sc, sc);
            g.u0 = libm::asinh(g.sign.y * lb / amplitude.y * (amplitude.x / la.abs()));
        } else {
            // 1 − m, from the D that selected the branch: positive whenever D ≠ 0.
            let m1 = d.abs() * ic / ((ic - ib).abs() * amplitude.z * amplitude.z);
            let e = Elliptic::new(m1.min(1.0));
            g.u0 = e.first_integral(g.sign.y * lb / amplitude.y, la / amplitude.x);
            g.elliptic = Some(e);
        }
        g.frame0 = g.frame(g.momentum(g.u0));
        g.phase0 = g.precession(g.u0);
        g
    }

    /// L in (a, b, c) axes.
    fn momentum(&self, u: f64) -> DVec3 {
        let shape = match &self.elliptic {
            Some(e) => {
                let (j, _) = e.at(u);
                DVec3::new(j.cn, j.sn, j.dn)
            }
            None => DVec3::new(1.0 / libm::cosh(u), libm::tanh(u), 1.0 / libm::cosh(u)),
        };
        self.sign * self.amplitude * shape
    }

    /// Rows e₁ = e_c×L/|e_c×L|, e₂ = e₃×e₁, e₃ = L/|L|.
    fn frame(&self, l: DVec3) -> DMat3 {
        let e3 = l / l.length();
        let flat = (l.x * l.x + l.y * l.y).sqrt();
        let e1 = DVec3::new(-l.y, l.x, 0.0) / flat;
        DMat3::from_cols(e1, e3.cross(e1), e3).transpose()
    }

    /// The precession angle without |L| t/I_b: with φ' = |L| (L_a²/I_a + L_b²/I_b)/(L_a² + L_b²) = |L|/I_b + |L|(1/I_a
    /// − 1/I_b) L_a²/(L_a² + L_b²).
    fn precession(&self, u: f64) -> f64 {
        let DVec3 { x: ia, y: ib, .. } = self.inertia;
        let factor = self.magnitude * (ib - ia) / (ia * ib) / self.rate;
        let p = (self.amplitude.y / self.amplitude.x).powi(2);
        match &self.elliptic {
            Some(e) => factor * e.third_integral(u, p),
            // ∫ du/(1 + p sinh²u) on the separatrix, where p = A_b²/A_a² > 1, is atan(√(p−1) tanh u)/√(p−1).
            None => {
                let w = (p - 1.0).sqrt();
                factor * libm::atan(w * libm::tanh(u)) / w
            }
        }
    }

    /// The rotation since the start, and L, in body axes.
    fn at(&self, t: f64) -> (DQuat, DVec3) {
        let u = self.rate * t + self.u0;
        let l = self.momentum(u);
        let phi = self.magnitude * t / self.inertia.y + (self.precession(u) - self.phase0);
        // R(t) = R(0) Pᵀ B(0)ᵀ R_z(φ) B(t) P
        let before = DQuat::from_mat3(&(self.frame0 * self.to_abc)).inverse();
        let after = DQuat::from_mat3(&(self.frame(l) * self.to_abc));
        let turn = before * turn(DVec3::Z, phi) * after;
        (turn, self.to_abc.transpose() * l)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::ForceSet;
    use crate::reference::numerical::Numerical;
    use crate::setup::Setup;

    fn check(half: DVec3, spin: DVec3, bound: f64) {
        let body = RigidBox::new(half, 3.0).expect("valid");
        let start = BodyState::at_pose(DVec3::ZERO, DQuat::from_xyzw(0.1, -0.5, 0.3, 0.8))
            .with_body_angular_velocity(&body, spin);
        let motion = FreeMotion::new(&body, &start, 0.0);
        let setup = Setup::new(body, start, ForceSet::none(), 10.0);
        let reference = Numerical::new(&setup, &start, 10.0).expect("smooth");
        for k in 0..=20 {
            let t = 0.5 * f64::from(k);
            let expected = reference.at(t).expect("inside");
            let mut state = start;
            motion.write(t, &mut state);
            let error = state.attitude_difference(&expected);
            assert!(error < bound, "{half} {spin}: {error:e} rad at {t} s");
            let dl = (state.angular_momentum - expected.angular_momentum).length();
            assert!(
                dl <= bound * start.angular_momentum.length(),
                "{half} {spin}: L {dl:e} at {t} s"
            );
        }
    }

    #[test]
    fn every_order_of_axes_and_sign_agrees_with_quadrature() {
        let sides = [0.5, 0.25, 0.125];
        for p in [
            [0, 1, 2],
            [1, 2, 0],
            [2, 0, 1],
            [0, 2, 1],
            [2, 1, 0],
            [1, 0, 2],
        ] {
            let half = DVec3::from_array(p.map(|k| sides[k]));
            for signs in 0..8_u32 {
                let sign = |k: u32| if signs >> k & 1 == 1 { -1.0 } else { 1.0 };
                let s = DVec3::new(sign(0), sign(1), sign(2));
                check(half, s * DVec3::new(1.5, 2.5, 1.0), 1e-11);
                check(half, s * DVec3::new(0.5, 1.0, 4.0), 1e-11);
            }
        }
    }

    #[test]
    fn degenerate_shapes_are_continuous() {
        for gap in [0.0, 1e-14, 1e-12, 1e-9, 1e-4] {
            check(
                DVec3::new(0.25, 0.5, 0.25 * (1.0 + gap)),
                DVec3::new(2.0, 6.0, 0.3),
                2e-11,
            );
            check(
                DVec3::new(0.5, 0.125 * (1.0 + gap), 0.5),
                DVec3::new(2.0, 6.0, 0.3),
                2e-11,
            );
            check(
                DVec3::new(0.5, 0.5 * (1.0 + gap), 0.5 * (1.0 - gap)),
                DVec3::new(2.0, 6.0, 0.3),
                2e-11,
            );
        }
        check(DVec3::new(0.5, 0.25, 0.125), DVec3::Y * 8.0, 1e-9);
        check(DVec3::new(0.5, 0.25, 0.125), DVec3::ZERO, 1e-15);
    }

    /// Dyadic moments and an L with D = 0 exactly: L_lo²(I_lo−I_mid)/I_lo = −L_hi²(I_hi−I_mid)/I_hi.
    #[test]
    fn on_the_separatrix() {
        let body = RigidBox::default()
            .with_inertia(DVec3::new(0.5, 1.0, 1.0 + 1.0 / 3.0))
            .expect("a body");
        let i = body.inertia();
        for s in 0..8_u32 {
            let sign = |k: u32| if s >> k & 1 == 1 { -1.0 } else { 1.0 };
            let l = DVec3::new(sign(0) * 0.5, sign(1) * 2.0, sign(2));
            let start = BodyState {
                angular_momentum: l,
                ..BodyState::default()
            };
            let d = l.x * l.x * (i.x - i.y) / i.x + l.z * l.z * (i.z - i.y) / i.z;
            assert!(d.abs() < 1e-15, "{d:e}");
            let setup = Setup::new(body, start, ForceSet::none(), 3.0);
            let reference = Numerical::new(&setup, &start, 3.0).expect("smooth");
            let motion = FreeMotion::new(&body, &start, 0.0);
            for k in 0..=12 {
                let t = 0.25 * f64::from(k);
                let mut state = start;
                motion.write(t, &mut state);
                let error = state.attitude_difference(&reference.at(t).expect("inside"));
                assert!(error < 1e-10, "{l}: {error:e} at {t} s");
            }
        }
    }
}
