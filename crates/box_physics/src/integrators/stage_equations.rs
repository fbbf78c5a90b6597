//! Stage equations of the implicit integrators for a given wrench: a formula for the velocity and one scalar equation
//! for the angular velocity. They have a root at any step, and the solver always finds it.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// Maximum number of evaluations of the scalar equation: bisection alone needs 53 to reach rounding.
const SCALAR_ITERATIONS: u32 = 80;

/// The velocities that solve the stage equations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    /// v [m/s], world axes.
    pub(super) velocity: DVec3,
    /// ω [rad/s], body axes.
    pub(super) omega: DVec3,
    /// Number of evaluations: of the wrench if present, otherwise of the scalar equation.
    pub(super) evaluations: u32,
    /// `true` if the tolerance was met within the maximum number of iterations.
    pub(super) converged: bool,
}

/// The stage equations without the wrench.
pub(super) struct Equations {
    velocity: DVec3,
    pub(super) acceleration: DVec3,
    momentum: DVec3,
    tau: f64,
    /// A = τ k₂/m and B = 1 + τ c₁/m of (B + A|v|) v = b, with v and b relative to the air.
    drag: (f64, f64),
    /// [m/s]
    wind: DVec3,
    /// `D_i = I_i (1 + τγ) + τ c_ω`, all positive.
    diagonal: DVec3,
    /// `κ_i = τ (I_j − I_k)/D_i`, i j k in cyclic order.
    coupling: DVec3,
    /// The axis whose ω is the scalar unknown.
    axis: usize,
    /// ω at the start, for the first guess.
    pub(super) omega: DVec3,
}

impl Equations {
    #[inline(always)]
    pub(super) fn new<F: ForceModel>(
        body: &RigidBox,
        start: &BodyState,
        force: &F,
        tau: f64,
    ) -> Option<Self> {
        let d = force.dissipation();
        let inertia = body.inertia();
        let (mut drag, mut diagonal) = ((0.0, 1.0), inertia);
        if d != Dissipation::NONE {
            let rate = tau * body.inverse_mass();
            drag = (rate * d.quadratic_drag, 1.0 + rate * d.linear_drag);
            diagonal = inertia * (1.0 + tau * d.angular_damping) + tau * d.angular_drag;
        }
        let i = inertia;
        let coupling = tau * DVec3::new(i.y - i.z, i.z - i.x, i.x - i.y) / diagonal;
        (drag.1 > 0.0 && diagonal.min_element() > 0.0).then_some(Self {
            velocity: start.velocity,
            acceleration: force.acceleration(),
            momentum: start.angular_momentum,
            tau,
            drag,
            wind: d.wind,
            diagonal,
            coupling,
            axis: body.splitting().frame.outer(),
            omega: start.body_angular_velocity(body),
        })
    }

    /// Solves the stage for the given wrench: `velocity` = τF/m [m/s], `momentum` = τT \[N m s\].
    #[inline(always)]
    pub(super) fn solve_for(&self, velocity: DVec3, momentum: DVec3) -> Option<Stage> {
        let b = self.velocity + self.tau * self.acceleration + velocity;
        let velocity = if self.wind == DVec3::ZERO {
            self.velocity_of(b)?
        } else {
            self.wind + self.velocity_of(b - self.wind)?
        };
        let (omega, evaluations, converged) = self.omega_of(self.momentum + momentum);
        (velocity.is_finite() && omega.is_finite()).then_some(Stage {
            velocity,
            omega,
            evaluations,
            converged,
        })
    }

    /// Solves (B + A|v|) v = b: v is parallel to b, and A|v|² + B|v| = |b| gives v = 2b/(B + √(B² + 4A|b|)).
    #[inline(always)]
    fn velocity_of(&self, b: DVec3) -> Option<DVec3> {
        let (quadratic, linear) = self.drag;
        if quadratic == 0.0 {
            return Some(if linear == 1.0 { b } else { b / linear });
        }
        let discriminant = linear * linear + 4.0 * quadratic * b.length();
        (discriminant >= 0.0).then(|| b * (2.0 / (linear + discriminant.sqrt())))
    }

    /// Solves `ω_i = w_i + κ_i ω_j ω_k` with w = P/D, P = L₀ + τT.
    ///
    /// Let i be the axis of the smallest or the largest moment. Then `κ_j κ_k ≤ 0`, and for a given `y = ω_i`
    /// the other two equations are linear with determinant `n = 1 − κ_j κ_k y² ≥ 1`:
    ///
    /// `p = ω_j = (w_j + κ_j y w_k)/n`, `r = ω_k = (w_k + κ_k y w_j)/n`.
    ///
    /// The remaining equation is `g(y) = y − w_i − κ_i p r = 0`. Because `Σ D_i κ_i = 0`, the products cancel
    /// in `D_i y g(y) = Σ D (ω − w/2)² − ¼ Σ D w²`. This is not negative once `|y − w_i/2| ≥ ½Y` with
    /// `Y² = Σ D w²/D_i`. So g changes sign on the interval `[(w_i − Y)/2, (w_i + Y)/2]`: there is a root at
    /// any step, and a bracketed Newton iteration always finds it. Below |ω|h = 2 the root is unique.
    #[inline(always)]
    fn omega_of(&self, momentum: DVec3) -> (DVec3, u32, bool) {
        let (i, j, k) = (self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3);
        let w = (momentum / self.diagonal).to_array();
        let kappa = self.coupling.to_array();
        let d = self.diagonal.to_array();
        let product = kappa[j] * kappa[k];
        let rest = (d[j] * w[j] * w[j] + d[k] * w[k] * w[k]) / d[i];
        let reach = (w[i] * w[i] + rest).sqrt();
        let (mut low, mut high) = (0.5 * (w[i] - reach), 0.5 * (w[i] + reach));
        // First guess: one explicit step.
        let start = self.omega.to_array();
        let mut y = (w[i] + kappa[i] * start[j] * start[k]).max(low).min(high);
        let (mut p, mut r) = (w[j], w[k]);
        for evaluation in 1..=SCALAR_ITERATIONS {
            let n = 1.0 / (1.0 - product * y * y);
            p = (w[j] + kappa[j] * y * w[k]) * n;
            r = (w[k] + kappa[k] * y * w[j]) * n;
            let bend = kappa[i] * p * r;
            let g = (y - w[i]) - bend;
            let noise = 2.0 * f64::EPSILON * (y.abs() + w[i].abs() + bend.abs());
            if g.abs() <= noise {
                return (on_axes(i, y, p, r), evaluation, true);
            }
            if g > 0.0 {
                high = y;
            } else {
                low = y;
            }
            let dp = (kappa[j] * w[k] + 2.0 * product * y * p) * n;
            let dr = (kappa[k] * w[j] + 2.0 * product * y * r) * n;
            let newton = y - g / (1.0 - kappa[i] * (dp * r + p * dr));
            let next = if newton > low && newton < high {
                newton
            } else {
                0.5 * (low + high)
            };
            if next == y || high - low <= f64::EPSILON * reach {
                return (on_axes(i, y, p, r), evaluation, true);
            }
            y = next;
        }
        (on_axes(i, y, p, r), SCALAR_ITERATIONS, false)
    }
}

#[inline(always)]
fn on_axes(axis: usize, y: f64, p: f64, r: f64) -> DVec3 {
    match axis {
        0 => DVec3::new(y, p, r),
        1 => DVec3::new(r, y, p),
        _ => DVec3::new(p, r, y),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::force::Forces;

    fn free_stage(body: &RigidBox, start: &BodyState, law: &Forces, tau: f64) -> Option<Stage> {
        Equations::new(body, start, law, tau)?.solve_for(DVec3::ZERO, DVec3::ZERO)
    }

    /// Boxes from needles to plates, steps up to |ω|h = 1000, with and without dissipation. Both equations hold to
    /// rounding, and every iteration converges.
    #[test]
    fn free_equations_are_always_solved() {
        let mut seed = 1_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1_u32 << 23) - 1.0
        };
        for n in 0..3000 {
            let size = DVec3::from_array(core::array::from_fn(|_| libm::exp(3.0 * random())));
            let body = RigidBox::new(size, 2.0).expect("valid");
            let mut vector = || DVec3::new(random(), random(), random());
            let start = BodyState::default()
                .with_velocity(10.0 * vector())
                .with_body_angular_velocity(&body, vector());
            let tau = libm::exp(f64::from(n % 10) - 2.2);
            let on = f64::from(n % 2);
            let d = Dissipation {
                linear_drag: on,
                quadratic_drag: 3.0 * on,
                angular_damping: 0.01 * on,
                angular_drag: 0.02 * on,
                ..Dissipation::NONE
            };
            let g = DVec3::NEG_Y * 9.81;
            let law = Forces {
                acceleration: g,
                dissipation: d,
                ..Default::default()
            };
            let stage = free_stage(&body, &start, &law, tau).expect("a solution");
            assert!(stage.converged);
            let (v, w) = (stage.velocity, stage.omega);
            let slope = g - (d.linear_drag + d.quadratic_drag * v.length()) * v / 2.0;
            let error = v - start.velocity - tau * slope;
            assert!(
                error.length() < 1e-13 * (start.velocity.length() + tau * 20.0),
                "n = {n}"
            );
            let l = body.inertia() * w;
            let terms = [l.cross(w), -d.angular_damping * l, -d.angular_drag * w];
            let error = l - start.angular_momentum - tau * (terms[0] + terms[1] + terms[2]);
            let size = l.length() + tau * terms.iter().map(|t| t.length()).sum::<f64>();
            assert!(error.length() < 1e-12 * size, "n = {n}: {error} of {size}");
        }
    }

    #[test]
    fn negative_steps_may_have_no_solution() {
        let body = RigidBox::default();
        let start = BodyState::default().with_velocity(DVec3::X * 10.0);
        let solvable = |linear_drag, quadratic_drag, tau| {
            let dissipation = Dissipation {
                linear_drag,
                quadratic_drag,
                ..Dissipation::NONE
            };
            let law = Forces {
                dissipation,
                ..Default::default()
            };
            free_stage(&body, &start, &law, tau).is_some()
        };
        assert!(solvable(1.0, 1.0, 1.0) && solvable(1.0, 0.0, -0.5) && solvable(0.0, 0.1, -0.2));
        assert!(!solvable(1.0, 0.0, -1.0) && !solvable(0.0, 0.1, -0.3));
    }
}
