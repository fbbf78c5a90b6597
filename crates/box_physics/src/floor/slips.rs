//! When the slips of held corners vanish: a segment of sustained motion ends there.

use glam::DVec3;

/// A slip that is less than this part of what it was has stopped.
pub(super) const STOPPED: f64 = 1e-6;
/// One that is this much larger than what is left of its part along its old way has not stopped but turned.
const TURNING: f64 = 10.0;

/// What becomes of the slips of a segment, by corner index; NaN where it is not so.
#[derive(Clone, Copy)]
pub(super) struct Slips<const N: usize = 8> {
    /// Of a corner that slips on: its slip at the end along its slip at the start, in parts of that.
    left: [f64; N],
    /// Of one that slips at the start and has no mean slip: the part of its friction that this takes.
    used: [f64; N],
}

impl<const N: usize> Slips<N> {
    pub(super) const NONE: Self = Self {
        left: [f64::NAN; N],
        used: [f64::NAN; N],
    };

    /// Corner `k` has no mean slip, by this part of its friction.
    pub(super) fn sticks(&mut self, k: usize, used: f64) {
        self.used[k] = used.min(1.0);
    }

    /// Corner `k` ends with `slip`, `along` that from which it started with `speed` [m/s].
    pub(super) fn slides(&mut self, k: usize, slip: DVec3, along: f64, speed: f64) {
        let across = (slip.length_squared() - along * along).max(0.0).sqrt();
        if across < TURNING * along.abs() || across <= STOPPED * speed {
            self.left[k] = along / speed;
        }
    }

    /// Whether corner `k` ends slipping the other way.
    pub(super) fn reversed(&self, k: usize) -> bool {
        self.left[k] < 0.0
    }

    /// When in the segment, which takes `tau` \[s\], the first slip vanishes, if one does; `before` is what became
    /// of them in the segment that was tried before, and its time.
    ///
    /// What is left of a slip is the parabola through what is known of it: 1 at the start, here, and before. A
    /// corner that has no mean slip is turned round, which takes twice the friction that stops it: with all of
    /// its friction it would take the time T = ½ used τ. Of used, a part that does not depend on τ may be
    /// needed to hold the corner, so that with two segments used = a + (1 − a) 2T/τ tells T.
    pub(super) fn first_stop(&self, tau: f64, before: Option<&(f64, Self)>) -> Option<f64> {
        let mut first: Option<f64> = None;
        let mut found = |time: f64| first = Some(first.map_or(time, |t| t.min(time)));
        for k in 0..N {
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
