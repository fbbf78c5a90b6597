//! When the first corner touches: the integrator itself is re-run over part of the step, so its order
//! survives the event (Hairer, Nørsett, Wanner, *Solving ODEs I*, II.6).
//!
//! Where to look is told by the polynomial through what is known of a corner's height: its height and its
//! velocity at the start, which every integrator keeps exactly as its time goes to zero, its height after each of the
//! last segments tried, and, for the first guess in flight, its velocity at the end of the whole. Two or three segments
//! bring it to 1e-12 of the scene; a bracket guards it.

/// What the search needs to know, of `N` heights: those of the corners over one plane or several.
pub(super) struct Search<const N: usize> {
    /// The corners to watch.
    pub(super) watch: u64,
    /// Their heights at the start \[m\].
    pub(super) start: [f64; N],
    /// Their velocities upwards at the start [m/s].
    pub(super) rate: [f64; N],
    /// The same at the end of the motion over the whole time; NaN if it is not known.
    pub(super) end_rate: [f64; N],
    /// The time there is \[s\].
    pub(super) time: f64,
    /// A bound of every corner's upward acceleration [m/s²].
    pub(super) curvature: f64,
    /// |c| at which a corner touches \[m\].
    pub(super) tolerance: f64,
    /// A dip no deeper than this does not count \[m\].
    pub(super) dip: f64,
    /// No corner comes higher than this over the floor \[m\].
    pub(super) highest: f64,
    /// How many evaluations the search may take.
    pub(super) budget: u32,
}

/// A segment that was tried: how long, and the heights there.
#[derive(Clone, Copy)]
struct Sample<const N: usize> {
    tau: f64,
    height: [f64; N],
}

/// Samples that the polynomial goes through, besides the start.
const NODES: usize = 3;
/// Evaluations in which the bracket must have halved, or the next one halves it.
const PATIENCE: usize = 3;
/// How often that may fail before every segment halves the bracket: what jumps has no polynomial.
const LEAPS: u32 = 2;
/// The most evaluations of one search between a good and a bad end: a jump takes up to 53 halvings. What is
/// found then is below the floor by no more than the jump.
const LONGEST: usize = 64 + 4 * PATIENCE;

/// The motion as the search sees it: every sample is remembered for the polynomial, and the best so far is kept
/// while the next is tried.
struct Track<'a, T, M, const N: usize> {
    motion: M,
    /// The motion to the earliest touch found so far, or else over the whole time.
    best: &'a mut T,
    /// The motion of the last sample, where that is not the best.
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

    /// The last sample is the best.
    fn keep(&mut self) {
        core::mem::swap(&mut self.best, &mut self.last);
    }

    /// Those of `known` that are, at different times.
    fn nodes(&self) -> &[Sample<N>] {
        &self.known[..NODES.min(self.used as usize)]
    }
}

impl<const N: usize> Search<N> {
    /// The places that are watched.
    fn watched(&self) -> impl Iterator<Item = usize> + use<N> {
        let watch = self.watch;
        (0..N).filter(move |k| watch >> k & 1 == 1)
    }

    fn lowest(&self, height: &[f64; N]) -> f64 {
        self.watched().fold(f64::INFINITY, |a, k| a.min(height[k]))
    }

    /// No watched corner can have been below the floor between two samples: a dip between heights
    /// c₀ and c₁ needs an upward acceleration; the parabola of curvature M that just touches zero
    /// has √c₀ + √c₁ = τ√(M/2), which c₀ + c₁ = τ²M/2 exceeds. The deepest there can be has Mτ²/8.
    fn clear(&self, from: &[f64; N], to: &[f64; N], tau: f64) -> bool {
        let square = 0.5 * self.curvature * tau * tau;
        if square <= 4.0 * self.dip {
            return true;
        }
        self.watched().all(|k| {
            let (from, to) = (from[k].max(0.0), to[k].max(0.0));
            from + to >= square || from.sqrt() + to.sqrt() >= tau * (0.5 * self.curvature).sqrt()
        })
    }

    /// Whether the motion over the whole time, which ends at these heights, touches nothing.
    pub(super) fn is_over(&self, height: &[f64; N]) -> bool {
        self.lowest(height) >= -self.tolerance && self.clear(&self.start, height, self.time)
    }

    /// Whether looking for dips over so long would take more than the whole budget, however high the corners
    /// are in between: each stretch of τ that is clear has 2√c ≥ τ√(M/2) for its higher end c, so that there are
    /// at least τ√(M/2)/2√c of them.
    fn is_hopeless(&self, tau: f64) -> bool {
        let stretch = 2.0 * self.highest.max(0.0).sqrt();
        tau * (0.5 * self.curvature).sqrt() > f64::from(self.budget) * stretch
    }

    /// The first touch of a watched corner, or the whole time. `motion(τ, segment)` makes the motion over τ and
    /// gives the heights there; `whole` is the one over the whole time, with its heights; `other` is overwritten. Returns
    /// the time \[s\], the motion up to there, and whether the dip test ran out of evaluations.
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

    /// A root of the lowest watched height between `low` (at or above the floor) and `high` (below
    /// it): the roots of polynomials, and bisection where they do not converge.
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
                // Neighboring numbers, which next to zero are far apart for their size.
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

    /// The earliest root, between `low` and `high`, of the polynomials of the corners that are below the
    /// floor at `high`; infinity if there is none.
    fn first_root(&self, low: f64, high: &Sample<N>, nodes: &[Sample<N>]) -> f64 {
        let mut first = f64::INFINITY;
        for k in self.watched().filter(|&k| high.height[k] < 0.0) {
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
            // A corner that is just leaving the floor is to come back, not to be found there.
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
    /// The root between `low` and `high` by Newton's method from `high`, inside a bracket. With c₀ = 0, of
    /// c(t)/t.
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
            // The step after it would be the square of this one.
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
