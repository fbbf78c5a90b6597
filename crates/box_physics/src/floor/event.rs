//! When the first corner touches: the scheme itself is re-run over part of the step, so its order
//! survives the event (Hairer, Nørsett, Wanner, *Solving ODEs I*, II.6).

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
    pub(super) fn run<T>(&self, mut motion: impl FnMut(f64) -> (T, [f64; 8])) -> Reached<T> {
        let mut used = 0;
        let mut sample = |tau: f64| {
            used += 1;
            let (motion, height) = motion(tau);
            (
                Sample {
                    tau,
                    motion,
                    height,
                },
                used,
            )
        };
        let (mut end, _) = sample(self.time);
        let (mut low, mut low_height) = (0.0, self.start);
        if self.lowest(&end.height) < -self.tolerance {
            end = self.locate(low, self.lowest(&low_height), end, &mut |t| sample(t).0);
        }
        let mut stride = self.time;
        let mut capped = false;
        while !self.clear(&low_height, &end.height, end.tau - low) {
            stride = stride.min(0.5 * (end.tau - low));
            let (try_it, used) = sample(low + stride);
            if used > self.budget {
                capped = true;
                break;
            }
            if self.lowest(&try_it.height) < -self.tolerance {
                end = self.locate(low, self.lowest(&low_height), try_it, &mut |t| sample(t).0);
            } else if self.clear(&low_height, &try_it.height, stride) {
                (low, low_height) = (try_it.tau, try_it.height);
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
    /// it) by the ITP method (Oliveira, Takahashi, ACM TOMS 47 (2021) 5): as fast as the secant, as
    /// safe as bisection.
    fn locate<T>(
        &self,
        mut low: f64,
        mut low_value: f64,
        mut high: Sample<T>,
        sample: &mut impl FnMut(f64) -> Sample<T>,
    ) -> Sample<T> {
        // A corner that has just left the floor has height 0 at `low`: look for it in the air.
        let mut halvings = 0;
        while low_value <= self.tolerance && halvings < 100 {
            let middle = sample(low + 0.5 * (high.tau - low));
            let value = self.lowest(&middle.height);
            halvings += 1;
            if value > self.tolerance {
                (low, low_value) = (middle.tau, value);
            } else if value < -self.tolerance {
                high = middle;
            } else {
                return middle;
            }
        }
        let mut high_value = self.lowest(&high.height);
        let width = high.tau - low;
        let k1 = 0.2 / width;
        // Bisection alone would need this many steps to the last bit; ITP takes at most one more.
        let mut allowed = width;
        for _ in 0..120 {
            let gap = high.tau - low;
            if gap <= 2.0 * f64::EPSILON * high.tau {
                break;
            }
            let middle = 0.5 * (low + high.tau);
            let secant = (low_value * high.tau - high_value * low) / (low_value - high_value);
            let toward = if secant <= middle { 1.0 } else { -1.0 };
            let delta = (k1 * gap * gap).min((middle - secant).abs());
            let truncated = secant + toward * delta;
            let radius = (allowed - 0.5 * gap).max(0.0);
            let mut tau = if (truncated - middle).abs() <= radius {
                truncated
            } else {
                middle - toward * radius
            };
            if !(tau > low && tau < high.tau) {
                tau = middle;
            }
            allowed *= 0.5;
            let here = sample(tau);
            let value = self.lowest(&here.height);
            if value.abs() <= self.tolerance {
                return here;
            }
            if value > 0.0 {
                (low, low_value) = (tau, value);
            } else {
                (high, high_value) = (here, value);
            }
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(start: f64, time: f64, curvature: f64) -> Search {
        Search {
            watch: 1,
            start: [start; 8],
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
        let reached = search(1.0, 1.0, 0.0).run(|t| {
            evaluations += 1;
            ((), [1.0 - 4.905 * t * t; 8])
        });
        assert!((reached.tau - (1.0_f64 / 4.905).sqrt()).abs() < 1e-12);
        assert!(evaluations <= 12, "{evaluations}");
    }

    #[test]
    fn a_dip_between_two_good_ends_is_found() {
        // A corner of radius 1 turns at 40 rad/s: it is high at both ends and below in between.
        let height = |t: f64| 0.9 + libm::cos(40.0 * t);
        let time = core::f64::consts::TAU / 40.0;
        let reached = search(height(0.0), time, 1600.0).run(|t| ((), [height(t); 8]));
        assert!((reached.tau - libm::acos(-0.9) / 40.0).abs() < 1e-12 && !reached.capped);
    }

    #[test]
    fn a_start_on_the_floor_is_not_a_touch() {
        let height = |t: f64| t - 4.0 * t * t;
        let reached = search(0.0, 1.0, 0.0).run(|t| ((), [height(t); 8]));
        assert!((reached.tau - 0.25).abs() < 1e-12);
        let reached = search(0.0, 0.2, 0.0).run(|t| ((), [height(t); 8]));
        assert_eq!(reached.tau, 0.2);
    }
}
