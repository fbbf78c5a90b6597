//! Fewer points for the same picture: minimum and maximum of buckets that stand still.
//!
//! A bucket is a stretch [k·w, (k+1)·w) of the x axis. Its width w is a power of two, so while a live
//! line grows the buckets stay where they are and old points do not dance; when the line outgrows its
//! budget the width doubles and buckets merge in pairs.

/// Most points of one line of a plot as wide as the drawer.
pub(super) const MAX_POINTS: usize = 1000;
/// The same where several plots stand side by side.
pub(crate) const NARROW: usize = 500;

/// At most [`MAX_POINTS`] points that look like `points`; see [`decimate_to`].
pub(super) fn decimate(
    points: impl DoubleEndedIterator<Item = [f64; 2]> + ExactSizeIterator + Clone,
) -> Vec<[f64; 2]> {
    decimate_to(MAX_POINTS, points)
}

/// At most `most` points (10 or more) that look like `points`, which must not go back in x. Points that
/// are not finite become one gap `[x, NaN]`; see [`segments`].
pub(crate) fn decimate_to(
    most: usize,
    points: impl DoubleEndedIterator<Item = [f64; 2]> + ExactSizeIterator + Clone,
) -> Vec<[f64; 2]> {
    if points.len() <= most {
        return points.collect();
    }
    let xs = || points.clone().map(|p| p[0]);
    let (Some(first), Some(last)) = (
        xs().find(|x| x.is_finite()),
        xs().rev().find(|x| x.is_finite()),
    ) else {
        return Vec::new();
    };
    // Rounded up to a power of two; a line of no width has one bucket.
    // Each gives at most a minimum, a maximum and a gap, and the range may start inside one.
    let buckets = (most / 3 - 2) as f64;
    let width = ((last - first) / buckets).max(1e-300).log2().ceil().exp2();
    let per_width = 1.0 / width;
    let mut out = Vec::with_capacity(most);
    let mut bucket = Bucket::default();
    let mut place = None;
    for (k, [x, y]) in points.enumerate() {
        if !x.is_finite() {
            bucket.gap.get_or_insert((k, [last, f64::NAN]));
            continue;
        }
        // Towards zero, which is cheaper than down: the two buckets beside x = 0 are one.
        let here = Some((x * per_width) as i64);
        if here != place {
            bucket.flush(&mut out);
            place = here;
        }
        bucket.push(k, [x, y]);
    }
    bucket.flush(&mut out);
    out
}

/// The stretches of a line between its gaps.
pub(super) fn segments(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points
        .split(|[x, y]| !x.is_finite() || !y.is_finite())
        .filter(|stretch| !stretch.is_empty())
}

/// A staircase: each value holds until the next.
pub(super) fn staircase(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut out: Vec<[f64; 2]> = Vec::new();
    for [x, y] in points {
        if let Some(&[_, held]) = out.last() {
            out.push([x, held]);
        }
        out.push([x, y]);
    }
    out
}

/// The extreme points of one bucket with their places in the line.
#[derive(Default)]
struct Bucket {
    low: Option<(usize, [f64; 2])>,
    high: Option<(usize, [f64; 2])>,
    gap: Option<(usize, [f64; 2])>,
}

impl Bucket {
    fn push(&mut self, k: usize, point: [f64; 2]) {
        if !point[1].is_finite() {
            self.gap.get_or_insert((k, [point[0], f64::NAN]));
            return;
        }
        if self.low.is_none_or(|(_, low)| point[1] < low[1]) {
            self.low = Some((k, point));
        }
        if self.high.is_none_or(|(_, high)| point[1] >= high[1]) {
            self.high = Some((k, point));
        }
    }

    /// Its points in the order of the line.
    fn flush(&mut self, out: &mut Vec<[f64; 2]>) {
        let mut found = [self.low.take(), self.high.take(), self.gap.take()];
        found.sort_by_key(|point| point.map_or(usize::MAX, |(k, _)| k));
        let mut previous = None;
        for (k, point) in found.into_iter().flatten() {
            if previous != Some(k) {
                out.push(point);
                previous = Some(k);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize) -> Vec<[f64; 2]> {
        (0..n)
            .map(|k| {
                let x = k as f64 / 60.0;
                [x, (x * 7.0).sin() + 0.01 * x]
            })
            .collect()
    }

    #[test]
    fn short_lines_are_untouched() {
        let points = wave(MAX_POINTS);
        assert_eq!(decimate(points.iter().copied()), points);
        assert!(decimate(std::iter::empty()).is_empty());
    }

    #[test]
    fn long_lines_keep_their_extremes_order_and_budget() {
        for n in [1001, 3000, 10_000, 36_000, 65_537] {
            let points = wave(n);
            let fewer = decimate(points.iter().copied());
            assert!(
                fewer.len() <= MAX_POINTS && fewer.len() > 300,
                "{n}: {}",
                fewer.len()
            );
            assert!(fewer.is_sorted_by(|a, b| a[0] < b[0]));
            assert!(fewer.iter().all(|p| points.contains(p)));
            let range = |p: &[[f64; 2]]| {
                p.iter()
                    .fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[1]), h.max(p[1])))
            };
            assert_eq!(range(&fewer), range(&points));
        }
    }

    /// The point of fixed buckets: while the width holds, a growing line does not move its past.
    #[test]
    fn a_growing_line_stands_still() {
        let points = wave(6000);
        let (early, late) = (
            decimate(points[..5500].iter().copied()),
            decimate(points.iter().copied()),
        );
        let settled = early.len() - 2;
        assert_eq!(early[..settled], late[..settled]);
    }

    #[test]
    fn gaps_survive_and_split() {
        let mut points = wave(10_000);
        points[5000][1] = f64::NAN;
        points[7000][1] = f64::INFINITY;
        points[8000][0] = f64::NAN;
        let fewer = decimate(points.iter().copied());
        assert!(fewer.len() <= MAX_POINTS);
        assert_eq!(segments(&fewer).count(), 4);
        assert!(segments(&fewer).flatten().flatten().all(|v| v.is_finite()));
        assert_eq!(segments(&[[0.0, f64::NAN]; 3]).count(), 0);
        assert!(decimate(points.iter().map(|p| [p[0], f64::NAN])).len() <= MAX_POINTS);
        assert!(decimate(points.iter().map(|_| [f64::NAN; 2])).is_empty());
        assert_eq!(decimate(points.iter().map(|p| [3.0, p[1]])).len(), 3);
    }

    #[test]
    fn stairs() {
        assert_eq!(
            staircase([[0.0, 1.0], [1.0, 5.0], [2.0, 2.0]].into_iter()),
            [[0.0, 1.0], [1.0, 1.0], [1.0, 5.0], [2.0, 5.0], [2.0, 2.0]]
        );
        assert!(staircase(std::iter::empty()).is_empty());
    }
}
