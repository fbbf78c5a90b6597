//! A face that slides without turning: the commonest sustained contact, in closed form.

use glam::{DMat3, DVec3};

use super::super::geometry::{Corner3, DelassusOperator};

/// If all corners have the same b and keep the same w, then w = b + (α/m) P with the resultant P of the
/// impulses: P_n = −b_n m/α, and P_t = −µP_n t̂ along b_t (if that does not stop them). What
/// remains is to share P among the corners without a torque: p_k = p_k s, s = n − µt̂,
///
/// ```text
/// Σ p_k = P_n,   Σ p_k (r_k × s) = 0
/// ```
///
/// with the smallest p_k, by the 3×3 normal equations in the plane perpendicular to s. `false` if the
/// corners do not move alike, do not span a face, or one would have to pull: then the box turns.
pub(super) fn solve(
    operator: &DelassusOperator,
    b: &Corner3,
    alpha: f64,
    friction: f64,
    target: f64,
    p: &mut Corner3,
) -> bool {
    let n = operator.count;
    if n < 3 || b[1..n].iter().any(|u| (*u - b[0]).length() > target) {
        return false;
    }
    let slip = (b[0].x * b[0].x + b[0].z * b[0].z).sqrt();
    let normal = -b[0].y / (alpha * operator.inverse_mass());
    let t = if slip > 0.0 {
        DVec3::new(b[0].x / slip, 0.0, b[0].z / slip)
    } else {
        DVec3::X
    };
    // Would friction stop it? Then it sticks, if it can without tipping: not for us to say.
    let drag = if slip > 0.0 { friction } else { 0.0 };
    if alpha * operator.inverse_mass() * drag * normal > slip {
        return false;
    }
    let s = DVec3::Y - drag * t;
    let across = DVec3::new(-t.z, 0.0, t.x);
    let along = s.cross(across);
    let mut arms = [DVec3::ZERO; 8];
    for i in 0..n {
        let arm = operator.lever[i].cross(s);
        arms[i] = DVec3::new(1.0, arm.dot(across), arm.dot(along));
    }
    // Opposite corners are neighbors: in pairs their arms cancel to the bit.
    let mut gram = DMat3::ZERO;
    for pair in arms[..n].chunks(2) {
        let mut sum = DMat3::ZERO;
        for a in pair {
            sum += DMat3::from_cols(*a * a.x, *a * a.y, *a * a.z);
        }
        gram += sum;
    }
    let size = gram.x_axis.x * gram.y_axis.y * gram.z_axis.z;
    if gram.determinant() <= 1e-10 * size {
        return false;
    }
    let shares = gram.inverse() * (DVec3::X * normal);
    for i in 0..n {
        let share = shares.dot(arms[i]);
        if share < 0.0 {
            return false;
        }
        p[i] = s * share;
    }
    true
}
