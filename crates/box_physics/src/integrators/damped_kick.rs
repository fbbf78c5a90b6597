//! The wrench at a fixed pose together with all linear damping: dampers, drag, angular damping and angular
//! drag.

use glam::DVec3;

use crate::body::RigidBox;
use crate::force::{Damping, Dissipation, ForceModel};
use crate::state::BodyState;

/// A complex number, (real, imaginary).
type Complex = (f64, f64);

/// Moves the velocities y = (v, ω) in body axes by y' = −G y + g over `h` \[s\], at a fixed pose:
///
/// ```text
/// M y' = −C y + f,    G = M⁻¹C, g = M⁻¹f;   C the coefficients of all linear damping, f wrench and weight
/// y ← e(Z) y + h φ(Z) g + (1 − e(Z)) y*,    Z = hG,  e(z) = 1/(1 + z + z²/2),  φ(z) = (1 − e(z))/z = (1 + z/2)/(1 + z + z²/2)
/// ```
///
/// e is the Padé approximant (0, 2) of e^{−z}: order 2, positive and decreasing for every z ≥ 0, so a mode is
/// neither reversed nor amplified. It is L-stable, and y = G⁻¹g is a fixed point: the body ends at its
/// terminal velocity. Both functions have the poles −1 ± i, so the sum is the real part of one complex
/// solution,
///
/// ```text
/// y⁺ = Re [(Z + 1 − i)⁻¹ (h g − i (2 y + h g))],
/// ```
///
/// of M (1 − i) + hC. This matrix is symmetric with a definite real part for h > 0, so elimination needs no
/// pivots. y* follows from the [`curvature`] of the points' paths; its weight preserves the order.
pub(super) fn damped_kick<F: ForceModel>(
    body: &RigidBox,
    state: &mut BodyState,
    force: &F,
    h: f64,
) {
    let inverse = state.rotation.inverse();
    let w = force.elastic_wrench(body, state);
    let d = force.dissipation();
    let a = d.blown(force.acceleration(), d.linear_drag * body.inverse_mass());
    let weight = inverse * (w.force + body.mass() * a);
    let mass = six(DVec3::splat(body.mass()), body.inertia());
    let f = six(weight, w.torque);
    let y = six(inverse * state.velocity, state.body_angular_velocity(body));
    let c = coefficients(body, &d, &force.damping());
    let resolvent = Resolvent::new(&mass, &c, h);
    let mut y = resolvent.real(|i| (h * f[i], -(2.0 * mass[i] * y[i] + h * f[i])));
    // h φ(Z) M⁻¹ f: once for the force that cancels the curvature, once more for the weight 1 − e(Z).
    let f = curvature(body, force, DVec3::new(y[3], y[4], y[5]), h);
    let terminal = resolvent.real(|i| (h * f[i], -h * f[i]));
    let f = c.map(|row| (0..6).map(|k| row[k] * terminal[k]).sum::<f64>());
    let weighted = resolvent.real(|i| (h * f[i], -h * f[i]));
    for (y, shift) in y.iter_mut().zip(weighted) {
        *y += shift;
    }
    state.velocity = state.rotation * DVec3::new(y[0], y[1], y[2]);
    state.angular_momentum = body.inertia() * DVec3::new(y[3], y[4], y[5]);
}

/// Applies only the dampers of `force` over `h` \[s\]: y ← e(Z) y.
pub(super) fn damp<F: ForceModel>(body: &RigidBox, state: &mut BodyState, force: &F, h: f64) {
    let mass = six(DVec3::splat(body.mass()), body.inertia());
    let inverse = state.rotation.inverse();
    let y = six(inverse * state.velocity, state.body_angular_velocity(body));
    let c = coefficients(body, &Dissipation::NONE, &force.damping());
    let y = Resolvent::new(&mass, &c, h).real(|i| (0.0, -2.0 * mass[i] * y[i]));
    state.velocity = state.rotation * DVec3::new(y[0], y[1], y[2]);
    state.angular_momentum = body.inertia() * DVec3::new(y[3], y[4], y[5]);
}

fn six(a: DVec3, b: DVec3) -> [f64; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

/// The wrench of all dampers at the point velocities −½h (α×r + ω×(ω×r)). A damped point that is at rest
/// after the kick stays at rest only for an instant. Until the next kick it moves on a curve, by ½h² times
/// its acceleration in the drift. This wrench cancels that motion.
fn curvature<F: ForceModel>(body: &RigidBox, force: &F, omega: DVec3, h: f64) -> [f64; 6] {
    let dampers = force.damping();
    let (s, p) = (dampers.moment, dampers.second);
    let alpha = body.inverse_inertia() * (body.inertia() * omega).cross(omega);
    let moved = alpha.cross(s) + omega.cross(omega.cross(s));
    let turned = p * alpha + omega.cross(p * omega);
    six(-0.5 * h * moved, -0.5 * h * turned)
}

/// C of `−C (v, ω)`, body axes: dampers at points r, each d JᵀJ with J = (1, −[r]×), plus the dissipation of
/// the body.
fn coefficients(body: &RigidBox, own: &Dissipation, dampers: &Damping) -> [[f64; 6]; 6] {
    let (s, p) = (dampers.moment, dampers.second);
    let mut c = [[0.0; 6]; 6];
    let cross = [[0.0, s.z, -s.y], [-s.z, 0.0, s.x], [s.y, -s.x, 0.0]];
    for i in 0..3 {
        c[i][i] = own.linear_drag + dampers.total;
        for j in 0..3 {
            c[i][3 + j] = cross[i][j];
            c[3 + j][i] = cross[i][j];
            c[3 + i][3 + j] = p.col(j)[i];
        }
        c[3 + i][3 + i] += own.angular_damping * body.inertia()[i] + own.angular_drag;
    }
    c
}

/// (M (1 − i) + hC)⁻¹, eliminated without pivoting.
struct Resolvent {
    rows: [[Complex; 6]; 6],
}

impl Resolvent {
    fn new(mass: &[f64; 6], c: &[[f64; 6]; 6], h: f64) -> Self {
        let mut rows = c.map(|row| row.map(|c| (h * c, 0.0)));
        for (k, m) in mass.iter().enumerate() {
            rows[k][k].0 += m;
            rows[k][k].1 -= m;
        }
        for k in 0..6 {
            for i in k + 1..6 {
                let factor = over(rows[i][k], rows[k][k]);
                let (above, below) = rows.split_at_mut(i);
                for (left, pivot) in below[0].iter_mut().zip(&above[k]).skip(k + 1) {
                    *left = minus(*left, times(factor, *pivot));
                }
                rows[i][k] = factor;
            }
        }
        Self { rows }
    }

    /// The real part of the solution for the right-hand side `b`.
    fn real(&self, b: impl Fn(usize) -> Complex) -> [f64; 6] {
        let a = &self.rows;
        let mut x: [Complex; 6] = core::array::from_fn(b);
        for k in 0..6 {
            for j in 0..k {
                x[k] = minus(x[k], times(a[k][j], x[j]));
            }
        }
        for k in (0..6).rev() {
            for j in k + 1..6 {
                x[k] = minus(x[k], times(a[k][j], x[j]));
            }
            x[k] = over(x[k], a[k][k]);
        }
        x.map(|(real, _)| real)
    }
}

fn times((a, b): Complex, (c, d): Complex) -> Complex {
    (a * c - b * d, a * d + b * c)
}

fn minus((a, b): Complex, (c, d): Complex) -> Complex {
    (a - c, b - d)
}

fn over(x: Complex, (c, d): Complex) -> Complex {
    let r = 1.0 / (c * c + d * d);
    let (re, im) = times(x, (c, -d));
    (re * r, im * r)
}

#[cfg(test)]
mod tests;
