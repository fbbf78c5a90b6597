//! When the first corner touches: the scheme itself is re-run over part of the step, so its order
//! survives the event (Hairer, Nørsett, Wanner, *Solving ODEs I*, II.6).
//!
//! Where to look is told by the polynomial through what is known of a corner's height: its height and its
//! velocity at the start, which every scheme keeps exactly as its time goes to zero, and its height after
//! each of the last pieces tried. Two or three pieces bring it to 1e-12 of the scene; a bracket guards it.

use super::geometry::has;

/// The end of a piece of motion: either all the time there was, or a touch.
pub(super) struct Reached<T> {
    /// How long \[s\].
    pub(super) tau: f64,
    /// What the motion gave there.
    pub(super) motion: T,
    /// Whether the dip test ran out of evaluations.
    pub(super) capped: bool,
}

/// What the search needs to know.
pub(super) struct Search {
    /// The corners to watch.
    pub(super) watch: u8,
    /// Their heights at the start \[m\].
    pub(super) start: [f64; 8],
    /// Their velocities upwards at the start [m/s].
    pub(super) rate: [f64; 8],
    /// The time there is \[s\].
    pub(super) time: f64,
    /// A bound of every corner's upward acceleration [m/s²].
    pub(super) curvature: f64,
    /// |c| at which a corner touches \[m\].
    pub(super) tolerance: f64,
    /// A dip no deeper than this is none \[m\].
    pub(super) dip: f64,
    /// How many evaluations the search may take.
    pub(super) budget: u32,
}

struct Sample<T> {
    tau: f64,
    motion: T,
    height: [f64; 8],
}

/// What was tried last: how long, and the heights there.
#[derive(Clone, Copy)]
struct Known {
    tau: f64,
    height: [f64; 8],
}

/// Samples that the polynomial goes through, besides the start.
const NODES: usize = 3;
/// Evaluations in which the bracket must have halved, or the next one halves it.
const PATIENCE: u32 = 3;

/// The motion as the search sees it: every sample taken is remembered for the polynomial.
struct Track<M> {
    motion: M,
    used: u32,
    /// The last ones, the newest first.
    known: [Known; NODES],
}

impl<T, M: FnMut(f64) -> (T, [f64; 8])> Track<M> {
    fn sample(&mut self, tau: f64) -> Sample<T> {
        let (motion, height) = (self.motion)(tau);
        self.used += 1;
        self.known.copy_within(0..NODES - 1, 1);
        self.known[0] = Known { tau, height };
        Sample {
            tau,
            motion,
            height,
        }
    }

    /// Those of `known` that are, at different times.
    fn nodes(&self) -> &[Known] {
        &self.known[..NODES.min(self.used as usize)]
    }
}

impl Search {
    fn lowest(&self, height: &[f64; 8]) -> f64 {
        (0..8)
            .filter(|&k| has(self.watch, k))
            .fold(f64::INFINITY, |a, k| a.min(height[k]))
    }

    /// No watched corner can have been below the floor between two samples: a dip between heights
    /// c₀ and c₁ needs an upward acceleration; the parabola of curvature M that just touches zero
    /// has √c₀ + √c₁ = τ√(M/2). The deepest there can be has Mτ²/8.
    fn clear(&self, from: &[f64; 8], to: &[f64; 8], tau: f64) -> bool {
        if self.curvature * tau * tau <= 8.0 * self.dip {
            return true;
        }
        let needed = tau * (0.5 * self.curvature).sqrt();
        (0..8)
            .filter(|&k| has(self.watch, k))
            .all(|k| from[k].max(0.0).sqrt() + to[k].max(0.0).sqrt() >= needed)
    }

    /// The first touch of a watched corner, or the whole time. `motion(τ)` gives the motion over τ
    /// and the heights there.
    pub(super) fn run<T>(&self, motion: impl FnMut(f64) -> (T, [f64; 8])) -> Reached<T> {
        let start = Known {
            tau: 0.0,
            height: self.start,
        };
        let mut track = Track {
            motion,
            used: 0,
            known: [start; NODES],
        };
        let mut end = track.sample(self.time);
        let mut low = start;
        if self.lowest(&end.height) < -self.tolerance {
            end = self.locate(&low, end, &mut track);
        }
        let mut stride = self.time;
        let mut capped = false;
        while !self.clear(&low.height, &end.height, end.tau - low.tau) {
            stride = stride.min(0.5 * (end.tau - low.tau));
            if track.used >= self.budget {
                capped = true;
                break;
            }
            let try_it = track.sample(low.tau + stride);
            if self.lowest(&try_it.height) < -self.tolerance {
                end = self.locate(&low, try_it, &mut track);
            } else if self.clear(&low.height, &try_it.height, stride) {
                low = track.known[0];
                stride *= 2.0;
            } else {
                stride *= 0.5;
            }
        }
        Reached {
            tau: end.tau,
            motion: end.motion,
            capped,
        }
    }

    /// A root of the lowest watched height between `low` (at or above the floor) and `high` (below
    /// it): the roots of polynomials, and bisection where they do not converge.
    fn locate<T>(
        &self,
        low: &Known,
        mut high: Sample<T>,
        track: &mut Track<impl FnMut(f64) -> (T, [f64; 8])>,
    ) -> Sample<T> {
        let mut low = low.tau;
        let mut widths = [f64::INFINITY; PATIENCE as usize];
        for i in 0.. {
            let gap = high.tau - low;
            if gap <= 2.0 * f64::EPSILON * high.tau {
                break;
            }
            let slow = gap > 0.5 * core::mem::replace(&mut widths[i % widths.len()], gap);
            let mut tau = if slow {
                f64::NAN
            } else {
                self.first_root(low, &high, track.nodes())
            };
            if !(tau > low && tau < high.tau) {
                tau = low + 0.5 * gap;
            }
            let here = track.sample(tau);
            let value = self.lowest(&here.height);
            if value.abs() <= self.tolerance {
                return here;
            }
            if value > 0.0 {
                low = tau;
            } else {
                high = here;
            }
        }
        high
    }

    /// The earliest root, between `low` and `high`, of the polynomials of the corners that are below the
    /// floor at `high`; infinity if there is none.
    fn first_root<T>(&self, low: f64, high: &Sample<T>, nodes: &[Known]) -> f64 {
        (0..8)
            .filter(|&k| has(self.watch, k) && high.height[k] < 0.0)
            .map(|k| self.polynomial(k, nodes).root(low, high.tau))
            .fold(f64::INFINITY, f64::min)
    }

    fn polynomial(&self, k: usize, nodes: &[Known]) -> Polynomial {
        let (mut tau, mut value) = ([0.0; NODES], [0.0; NODES]);
        for (i, node) in nodes.iter().enumerate() {
            tau[i] = node.tau;
            let mean = (node.height[k] - self.start[k]) / node.tau;
            value[i] = (mean - self.rate[k]) / node.tau;
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
            if !(next > low && next < high) {
                next = 0.5 * (low + high);
            }
            if step.abs() <= 1e-15 * t {
                return t;
            }
            t = next;
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
mod tests {
    use super::*;

    fn search(start: f64, rate: f64, time: f64, curvature: f64) -> Search {
        Search {
            watch: 1,
            start: [start; 8],
            rate: [rate; 8],
            time,
            curvature,
            tolerance: 1e-12,
            dip: 1e-9,
            budget: 2000,
        }
    }

    #[test]
    fn the_first_root_is_found_sharply_and_cheaply() {
        let mut evaluations = 0;
        let reached = search(1.0, 0.0, 1.0, 0.0).run(|t| {
            evaluations += 1;
            ((), [1.0 - 4.905 * t * t; 8])
        });
        assert!((reached.tau - (1.0_f64 / 4.905).sqrt()).abs() < 1e-12);
        assert!(evaluations <= 3, "{evaluations}");
    }

    #[test]
    fn a_dip_between_two_good_ends_is_found() {
        // A corner of radius 1 turns at 40 rad/s: it is high at both ends and below in between.
        let height = |t: f64| 0.9 + libm::cos(40.0 * t);
        let time = core::f64::consts::TAU / 40.0;
        let reached = search(height(0.0), 0.0, time, 1600.0).run(|t| ((), [height(t); 8]));
        assert!((reached.tau - libm::acos(-0.9) / 40.0).abs() < 1e-12 && !reached.capped);
    }

    #[test]
    fn a_start_on_the_floor_is_not_a_touch() {
        let height = |t: f64| t - 4.0 * t * t;
        let reached = search(0.0, 1.0, 1.0, 0.0).run(|t| ((), [height(t); 8]));
        assert!((reached.tau - 0.25).abs() < 1e-12);
        let reached = search(0.0, 1.0, 0.2, 0.0).run(|t| ((), [height(t); 8]));
        assert_eq!(reached.tau, 0.2);
    }
}
