//! End of the slips of held corners, which ends a segment of sustained motion.

use glam::DVec3;

use super::geometry::each;

/// Fraction of its start value below which a slip has stopped.
pub(super) const STOPPED: f64 = 1e-6;
/// Slip distance, relative to the size of the box, below which a corner sticks at once.
pub(super) const NEGLIGIBLE: f64 = 1e-8;
/// A slip whose part across its old direction exceeds this multiple of the part along it has turned, not stopped.
const TURNING: f64 = 10.0;

/// Slips at the end of a segment, by corner index; NaN if not applicable.
#[derive(Clone, Copy)]
pub(super) struct Slips<const N: usize = 8> {
    /// For a corner that still slips: the component of its end slip along its start slip, relative to the latter.
    left: [f64; N],
    /// For a corner that slips at the start and has no mean slip: the used fraction of its friction.
    used: [f64; N],
}

impl<const N: usize> Slips<N> {
    pub(super) const NONE: Self = Self {
        left: [f64::NAN; N],
        used: [f64::NAN; N],
    };

    /// Records that corner `k` has no mean slip and uses this fraction of its friction, 0 to 1.
    pub(super) fn sticks(&mut self, k: usize, used: f64) {
        self.used[k] = used;
    }

    /// Records the end slip of corner `k`, its component `along` the start slip, and the `speed` of the latter [m/s].
    pub(super) fn slides(&mut self, k: usize, slip: DVec3, along: f64, speed: f64) {
        let across = (slip.length_squared() - along * along).max(0.0).sqrt();
        if across < TURNING * along.abs() || across <= STOPPED * speed {
            self.left[k] = along / speed;
        }
    }

    /// Returns `true` if the slip of corner `k` has reversed.
    pub(super) fn reversed(&self, k: usize) -> bool {
        self.left[k] < 0.0
    }

    /// Time at which the first slip of the corners `held` vanishes in a segment of `tau` \[s\], if one does. `before`
    /// are the previous trial's time and slips.
    ///
    /// The slip is interpolated by the parabola through 1 at the start, this trial and the previous one. A corner
    /// without mean slip reverses, which takes twice the friction that stops it. With its full friction it would stop
    /// after T = ½ used τ. A part a of `used`, independent of τ, may hold the corner. Two trials give T from used = a +
    /// (1 − a) 2T/τ.
    pub(super) fn first_stop(
        &self,
        held: u64,
        tau: f64,
        before: Option<&(f64, Self)>,
    ) -> Option<f64> {
        let mut first: Option<f64> = None;
        let mut found = |time: f64| first = Some(first.map_or(time, |t| t.min(time)));
        for k in each(held) {
            let (left, used) = (self.left[k], self.used[k]);
            if used.is_finite() {
                let last = before.filter(|(_, b)| b.used[k] < used);
                let held = last.map_or(0.0, |(time, b)| {
                    let share = (used - b.used[k]) / (1.0 / tau - 1.0 / time);
                    (used - share / tau).clamp(0.0, used)
                });
                found(0.5 * tau * (used - held) / (1.0 - held).max(1e-3));
                continue;
            }
            let mean = (left - 1.0) / tau;
            let mut bend = 0.0;
            let mut passed = left < -STOPPED;
            if let Some((time, b)) = before
                && b.left[k].is_finite()
            {
                bend = (mean - (b.left[k] - 1.0) / time) / (tau - time);
                passed |= b.left[k] < 0.0 && left > STOPPED;
            }
            if passed {
                // 1 + rate t + bend t² = 0
                let rate = mean - bend * tau;
                found(2.0 / ((rate * rate - 4.0 * bend).max(0.0).sqrt() - rate));
            }
        }
        first
    }
}
