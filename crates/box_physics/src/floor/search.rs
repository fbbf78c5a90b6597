//! Search for the first touch of a corner. The integrator itself is re-run over part of the step, so its order survives
//! the event (Hairer, Nørsett, Wanner, *Solving ODEs I*, II.6).
//!
//! The next trial is the root of a polynomial through the known heights of a corner. It uses height and velocity at the
//! start, the heights of the last trials and, for the first guess in flight, the velocity at the end. Two or three
//! trials reach 1e-12 of the scene, within a bracket.

use super::geometry::each;

/// Inputs of the search for `N` heights: the corners over one plane or several.
pub(super) struct Search<const N: usize> {
    /// The watched corners.
    pub(super) watch: u64,
    /// Heights of the corners at the start \[m\].
    pub(super) start: [f64; N],
    /// Upward velocities of the corners at the start [m/s].
    pub(super) rate: [f64; N],
    /// Upward velocities at the end of the whole time; NaN if unknown.
    pub(super) end_rate: [f64; N],
    /// The whole time \[s\].
    pub(super) time: f64,
    /// Upper bound of every corner's upward acceleration [m/s²].
    pub(super) curvature: f64,
    /// Largest height of a touching corner \[m\].
    pub(super) tolerance: f64,
    /// Smallest depth of a dip that counts \[m\].
    pub(super) dip: f64,
    /// Bound of the corners' heights \[m\].
    pub(super) highest: f64,
    /// Maximum number of evaluations.
    pub(super) budget: u32,
}

/// Length of a trial segment, and the heights at its end.
#[derive(Clone, Copy)]
struct Sample<const N: usize> {
    tau: f64,
    height: [f64; N],
}

/// Samples of the polynomial, besides the start.
const NODES: usize = 3;
/// Evaluations within which the bracket must halve; otherwise the next one bisects.
const PATIENCE: usize = 3;
/// Number of such failures after which every evaluation bisects: a jump has no polynomial.
const LEAPS: u32 = 2;
/// Maximum number of evaluations between a good and a bad end: a jump takes up to 53 bisections.
const LONGEST: usize = 64 + 4 * PATIENCE;

/// The motion with its last samples, and the best segment so far.
struct Track<'a, T, M, const N: usize> {
    motion: M,
    /// The motion to the earliest touch so far, or over the whole time.
    best: &'a mut T,
    /// The motion of the last sample, if that is not `best`.
    last: &'a mut T,
    used: u32,
    /// The last samples, the newest first.
    known: [Sample<N>; NODES],
}

impl<T, M: FnMut(f64, &mut T) -> [f64; N], const N: usize> Track<'_, T, M, N> {
    fn sample(&mut self, tau: f64) -> Sample<N> {
        let height = (self.motion)(tau, self.last);
        self.add(Sample { tau, height })
    }

    fn add(&mut self, sample: Sample<N>) -> Sample<N> {
        self.used += 1;
        self.known.copy_within(0..NODES - 1, 1);
        self.known[0] = sample;
        sample
    }

    /// Makes the last sample the best.
    fn keep(&mut self) {
        core::mem::swap(&mut self.best, &mut self.last);
    }

    /// The samples that exist.
    fn nodes(&self) -> &[Sample<N>] {
        &self.known[..NODES.min(self.used as usize)]
    }
}

impl<const N: usize> Search<N> {
    fn lowest(&self, height: &[f64; N]) -> f64 {
        each(self.watch).fold(f64::INFINITY, |a, k| a.min(height[k]))
    }

    /// Returns `true` if no watched corner can have been below the floor between two samples. A dip between the heights c₀
    /// and c₁ needs an upward acceleration. The parabola of curvature M that just touches zero has √c₀ + √c₁ = τ√(M/2),
    /// and c₀ + c₁ = τ²M/2 is more. The depth is at most Mτ²/8.
    fn clear(&self, from: &[f64; N], to: &[f64; N], tau: f64) -> bool {
        let square = 0.5 * self.curvature * tau * tau;
        if square <= 4.0 * self.dip {
            return true;
        }
        each(self.watch).all(|k| {
            let (from, to) = (from[k].max(0.0), to[k].max(0.0));
            from + to >= square || from.sqrt() + to.sqrt() >= tau * (0.5 * self.curvature).sqrt()
        })
    }

    /// Returns `true` if the motion over the whole time, which ends at these heights, touches nothing.
    pub(super) fn is_over(&self, height: &[f64; N]) -> bool {
        self.lowest(height) >= -self.tolerance && self.clear(&self.start, height, self.time)
    }

    /// Returns `true` if the search for dips over `tau` would exceed the budget for any heights in between. Each clear
    /// stretch of τ has 2√c ≥ τ√(M/2) for its higher end c. There are therefore at least τ√(M/2)/2√c stretches.
    fn is_hopeless(&self, tau: f64) -> bool {
        let stretch = 2.0 * self.highest.max(0.0).sqrt();
        tau * (0.5 * self.curvature).sqrt() > f64::from(self.budget) * stretch
    }

    /// Finds the first touch of a watched corner. `motion(τ, segment)` computes the motion over τ and returns the
    /// heights. `whole` and `height` are those over the whole time; `other` is overwritten. Returns the time \[s\] of
    /// the touch (or the whole time), the motion up to it, and `true` if the budget was exceeded.
    pub(super) fn run<'a, T>(
        &self,
        whole: &'a mut T,
        height: [f64; N],
        other: &'a mut T,
        motion: impl FnMut(f64, &mut T) -> [f64; N],
    ) -> (f64, &'a mut T, bool) {
        let mut low = Sample {
            tau: 0.0,
            height: self.start,
        };
        let mut track = Track {
            motion,
            best: whole,
            last: other,
            used: 0,
            known: [low; NODES],
        };
        let tau = self.time;
        let mut end = track.add(Sample { tau, height });
        if self.lowest(&height) < -self.tolerance {
            end = self.locate(low.tau, end, &mut track);
        }
        let mut stride = tau;
        let mut capped = self.is_hopeless(end.tau);
        while !capped && !self.clear(&low.height, &end.height, end.tau - low.tau) {
            stride = stride.min(0.5 * (end.tau - low.tau));
            if track.used >= self.budget {
                capped = true;
                break;
            }
            let try_it = track.sample(low.tau + stride);
            if self.lowest(&try_it.height) < -self.tolerance {
                track.keep();
                end = self.locate(low.tau, try_it, &mut track);
            } else if self.clear(&low.height, &try_it.height, stride) {
                low = try_it;
                stride *= 2.0;
            } else {
                stride *= 0.5;
            }
        }
        (end.tau, track.best, capped)
    }

    /// A root of the lowest watched height between `low` (not below the floor) and `high` (below it), by roots of
    /// polynomials, or by bisection if they do not converge.
    fn locate<T>(
        &self,
        mut low: f64,
        mut high: Sample<N>,
        track: &mut Track<T, impl FnMut(f64, &mut T) -> [f64; N], N>,
    ) -> Sample<N> {
        let mut widths = [f64::INFINITY; PATIENCE];
        let mut slow = 0;
        for i in 0..LONGEST {
            let gap = high.tau - low;
            if gap <= 2.0 * f64::EPSILON * high.tau {
                break;
            }
            let stuck = gap > 0.5 * core::mem::replace(&mut widths[i % PATIENCE], gap);
            slow += u32::from(stuck);
            let mut tau = if stuck || slow > LEAPS {
                f64::NAN
            } else {
                self.first_root(low, &high, track.nodes())
            };
            if !(tau > low && tau < high.tau) {
                tau = low + 0.5 * gap;
                // The bracket contains no further number.
                if !(tau > low && tau < high.tau) {
                    break;
                }
            }
            let here = track.sample(tau);
            let value = self.lowest(&here.height);
            if value > self.tolerance {
                low = tau;
                continue;
            }
            track.keep();
            high = here;
            if value >= -self.tolerance {
                break;
            }
        }
        high
    }

    /// The earliest root between `low` and `high` of the polynomials of corners below the floor at `high`; infinity if
    /// they have no root there.
    fn first_root(&self, low: f64, high: &Sample<N>, nodes: &[Sample<N>]) -> f64 {
        let mut first = f64::INFINITY;
        for k in each(self.watch).filter(|&k| high.height[k] < 0.0) {
            let polynomial = self.polynomial(k, nodes);
            if first == f64::INFINITY {
                first = polynomial.root(low, high.tau);
            } else if polynomial.at(first).0 < 0.0 {
                first = polynomial.root(low, first);
            }
        }
        first
    }

    fn polynomial(&self, k: usize, nodes: &[Sample<N>]) -> Polynomial {
        let (mut tau, mut value) = ([0.0; NODES], [0.0; NODES]);
        for (i, node) in nodes.iter().enumerate() {
            tau[i] = node.tau;
            let mean = (node.height[k] - self.start[k]) / node.tau;
            value[i] = (mean - self.rate[k]) / node.tau;
        }
        if nodes.len() == 1 && tau[0] == self.time && self.end_rate[k].is_finite() {
            // The same node again, with the slope of r there.
            let change = (self.end_rate[k] - self.rate[k]) / tau[0];
            (tau[1], value[1]) = (tau[0], (change - 2.0 * value[0]) / tau[0]);
        }
        for order in 1..nodes.len() {
            for i in (order..nodes.len()).rev() {
                value[i] = (value[i] - value[i - 1]) / (tau[i] - tau[i - order]);
            }
        }
        Polynomial {
            // For a corner that leaves the floor, its return counts, not the start.
            start: if self.start[k] <= 2.0 * self.tolerance {
                0.0
            } else {
                self.start[k]
            },
            rate: self.rate[k],
            tau,
            difference: value,
        }
    }
}

/// c(t) = c₀ + ċ₀ t + t² r(t), r by Newton's divided differences.
struct Polynomial {
    start: f64,
    rate: f64,
    tau: [f64; NODES],
    difference: [f64; NODES],
}

impl Polynomial {
    /// The root of c(t), or of c(t)/t if c₀ = 0, by a bracketed Newton's method from `high`.
    fn root(&self, mut low: f64, mut high: f64) -> f64 {
        let mut t = high;
        for _ in 0..40 {
            let (value, slope) = self.at(t);
            if value > 0.0 {
                low = t;
            } else {
                high = t;
            }
            let step = -value / slope;
            let mut next = t + step;
            // Quadratic convergence: the next step would be negligible.
            let last = step.abs() <= 1e-8 * t;
            if !(next > low && next < high) {
                next = if last { t } else { 0.5 * (low + high) };
            }
            t = next;
            if last {
                break;
            }
        }
        t
    }

    /// c and ċ; with c₀ = 0, c/t and its derivative.
    #[inline]
    fn at(&self, t: f64) -> (f64, f64) {
        let (mut r, mut slope) = (0.0, 0.0);
        for i in (0..NODES).rev() {
            slope = slope * (t - self.tau[i]) + r;
            r = r * (t - self.tau[i]) + self.difference[i];
        }
        if self.start == 0.0 {
            (self.rate + t * r, r + t * slope)
        } else {
            (
                self.start + t * (self.rate + t * r),
                self.rate + t * (2.0 * r + t * slope),
            )
        }
    }
}

#[cfg(test)]
mod tests;
