//! A globalized quasi-Newton solver for six equations z = f(z). The implicit integrators use it for forces
//! that depend on the end of the step.

/// Maximum number of iterations. A stiff spring needs about ten, a soft one four.
const ITERATIONS: u32 = 30;
/// Smallest fraction of a Newton step that is tried.
const SMALLEST_STEP: f64 = 1.0 / 64.0;
/// The Jacobian is kept while each iteration reduces the correction at least by this factor.
const KEEP_BELOW: f64 = 0.1;
/// Step of the forward differences relative to the scale of the unknowns: √ε, where truncation and rounding errors are
/// about equal.
const DIFFERENCE: f64 = 1.5e-8;

/// Six unknowns or equations.
pub(super) type Six = [f64; 6];

/// Scales of the unknowns and of their rounding, in the units of the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    /// Size of the other terms in the equations. Convergence is a correction below 2e-15 of it (and of the unknowns),
    /// or below 1e-9 of it once the corrections no longer decrease.
    pub(super) size: f64,
    /// Unavoidable rounding error. Convergence is also a correction below a tenth of it, or below 100 times it once the
    /// corrections no longer decrease.
    pub(super) rounding: f64,
    /// A change that is small but above rounding. Together with `size`, it gives the scale of the differences.
    pub(super) small: f64,
}

impl Scales {
    fn tight(&self, z: &Six) -> f64 {
        2e-15 * (self.size + norm(z)) + 0.1 * self.rounding
    }

    fn loose(&self, z: &Six) -> f64 {
        1e-9 * (self.size + norm(z)) + 100.0 * self.rounding
    }
}

/// Result of the iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub(super) z: Six,
    /// Evaluations of f.
    pub(super) evaluations: u32,
    /// `true` if the tolerance was met within the maximum number of iterations.
    pub(super) converged: bool,
}

/// Solves z = f(z), starting from `z`.
///
/// With A ≈ 1 − f' and r = z − f(z), the correction is δ = A⁻¹ r. A starts as the identity, so for a weak coupling this
/// is a plain fixed-point iteration with one evaluation per iteration. If the next correction (with the same A) is not
/// at least ten times smaller, A is recomputed by six forward differences.
///
/// With a new A the step is halved until the next correction is smaller by the factor 1 − λ/2. This is Deuflhard's
/// natural monotonicity test (Newton Methods for Nonlinear Problems, 2004, §3.3). It does not depend on the scaling of
/// the equations, so stiff and soft directions may be mixed.
pub(super) fn fixed_point(mut z: Six, scales: Scales, mut f: impl FnMut(&Six) -> Six) -> Root {
    let mut evaluations = 1;
    let mut residual = difference(&z, &f(&z));
    let mut lu: Option<Lu> = None;
    let mut fresh = false;
    let mut previous = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let delta = solve(&lu, residual);
        let size = norm(&delta);
        let settled = size <= scales.loose(&z);
        if size <= scales.tight(&z) || (settled && size > 0.5 * previous) {
            return Root {
                z: difference(&z, &delta),
                evaluations,
                converged: true,
            };
        }
        let mut fraction = 1.0;
        let accepted = loop {
            let mut trial = z;
            for k in 0..6 {
                trial[k] -= fraction * delta[k];
            }
            let next = difference(&trial, &f(&trial));
            evaluations += 1;
            let contraction = norm(&solve(&lu, next)) / size;
            if contraction <= if fresh { 1.0 - 0.5 * fraction } else { 0.5 } {
                break Some((trial, next, contraction));
            }
            fraction *= 0.5;
            if !fresh || fraction < SMALLEST_STEP {
                break None;
            }
        };
        let refresh = match accepted {
            Some((trial, next, contraction)) => {
                (z, residual, previous) = (trial, next, size);
                contraction > KEEP_BELOW && !settled
            }
            None if fresh => break,
            None => true,
        };
        fresh = refresh;
        if refresh {
            lu = Lu::new(jacobian(&z, &residual, &scales, &mut f));
            evaluations += 6;
            previous = f64::INFINITY;
            if lu.is_none() {
                break;
            }
        }
    }
    Root {
        z,
        evaluations,
        converged: false,
    }
}

fn difference(a: &Six, b: &Six) -> Six {
    core::array::from_fn(|k| a[k] - b[k])
}

fn norm(a: &Six) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn solve(lu: &Option<Lu>, r: Six) -> Six {
    match lu {
        Some(lu) => lu.solve(r),
        None => r,
    }
}

/// 1 − f' by forward differences; `residual` is z − f(z).
fn jacobian(z: &Six, residual: &Six, scales: &Scales, f: &mut impl FnMut(&Six) -> Six) -> [Six; 6] {
    let step = DIFFERENCE * (scales.size + scales.small + norm(z));
    let mut rows = [[0.0; 6]; 6];
    for column in 0..6 {
        let mut shifted = *z;
        shifted[column] += step;
        let step = shifted[column] - z[column]; // as rounded
        let moved = difference(&shifted, &f(&shifted));
        for row in 0..6 {
            rows[row][column] = (moved[row] - residual[row]) / step;
        }
    }
    rows
}

/// LU decomposition with row exchanges (Doolittle, partial pivoting).
#[derive(Clone, Copy, Debug)]
struct Lu {
    rows: [Six; 6],
    order: [usize; 6],
}

impl Lu {
    /// Returns `None` for a singular or non-finite matrix.
    fn new(mut rows: [Six; 6]) -> Option<Self> {
        let mut order = [0, 1, 2, 3, 4, 5];
        for k in 0..6 {
            let mut pivot = k;
            for i in k + 1..6 {
                if rows[i][k].abs() > rows[pivot][k].abs() {
                    pivot = i;
                }
            }
            let size = rows[pivot][k].abs();
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            rows.swap(k, pivot);
            order.swap(k, pivot);
            let upper = rows[k];
            for row in &mut rows[k + 1..] {
                let factor = row[k] / upper[k];
                row[k] = factor;
                for (entry, above) in row.iter_mut().zip(upper).skip(k + 1) {
                    *entry -= factor * above;
                }
            }
        }
        Some(Self { rows, order })
    }

    fn solve(&self, r: Six) -> Six {
        let mut x: Six = core::array::from_fn(|k| r[self.order[k]]);
        for i in 1..6 {
            for j in 0..i {
                x[i] -= self.rows[i][j] * x[j];
            }
        }
        for i in (0..6).rev() {
            for j in i + 1..6 {
                x[i] -= self.rows[i][j] * x[j];
            }
            x[i] /= self.rows[i][i];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: Scales = Scales {
        size: 1.0,
        rounding: 0.0,
        small: 0.0,
    };

    #[test]
    fn triangles_solve_what_they_factor() {
        let matrix: [Six; 6] = core::array::from_fn(|i| {
            core::array::from_fn(|j| libm::sin(((i + 1) * (j + 2) * (j + 2)) as f64))
        });
        let x = [1.0, -2.0, 0.5, 3.0, 0.0, 7.0];
        let r = core::array::from_fn(|i| (0..6).map(|j| matrix[i][j] * x[j]).sum());
        let y = Lu::new(matrix).expect("regular").solve(r);
        assert!(norm(&difference(&x, &y)) < 1e-13);
        assert!(Lu::new([[1.0; 6]; 6]).is_none());
        assert!(Lu::new([[f64::NAN; 6]; 6]).is_none());
    }

    /// A weak coupling needs only fixed-point iterations; a strong linear one needs one Jacobian.
    #[test]
    fn linear_equations() {
        let root = |slope: f64| fixed_point([0.0; 6], SCALES, |z| z.map(|z| 1.0 + slope * z));
        let soft = root(1e-3);
        assert!(soft.converged && soft.evaluations <= 7);
        assert!((soft.z[3] - 1.0 / (1.0 - 1e-3)).abs() < 1e-15);
        let stiff = root(-1e6);
        assert!(stiff.converged && stiff.evaluations <= 14, "{stiff:?}");
        assert!((stiff.z[3] * (1.0 + 1e6) - 1.0).abs() < 1e-12);
    }

    /// z = b − k atan(z) from a distant start: full Newton steps diverge, halved steps converge.
    #[test]
    fn globalised() {
        let f = |z: &Six| z.map(|z| -1e4 * libm::atan(z));
        let root = fixed_point([20.0; 6], SCALES, f);
        assert!(root.converged && norm(&root.z) < 1e-14, "{root:?}");
    }

    #[test]
    fn failure_is_reported() {
        let root = fixed_point([0.0; 6], SCALES, |z| z.map(|z| z + 1.0));
        assert!(!root.converged);
        let root = fixed_point([0.0; 6], SCALES, |z| z.map(|_| f64::NAN));
        assert!(!root.converged);
    }
}
