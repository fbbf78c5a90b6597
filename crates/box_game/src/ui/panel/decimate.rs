//! Fewer points for the same picture: minimum and maximum of fixed buckets.
//!
//! A bucket is an interval [k·w, (k+1)·w) of the x axis. Its width w is a power of two, so the buckets of a growing
//! line are fixed and old points do not jump. When the line exceeds its budget, the width doubles and buckets merge in
//! pairs.

/// Maximum number of points per line in a plot of the drawer's width.
pub(super) const MAX_POINTS: usize = 1000;
/// Maximum number of points per line if several plots are side by side.
pub(crate) const NARROW: usize = 500;

/// At most `most` points (10 or more) that look like `points`, whose x must not decrease. A non-finite stretch becomes
/// one gap; see [`segments`].
pub(crate) fn decimate(most: usize, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= most {
        return points.to_vec();
    }
    let mut xs = points.iter().map(|p| p[0]).filter(|x| x.is_finite());
    let Some(first) = xs.next() else {
        return Vec::new();
    };
    let last = xs.next_back().unwrap_or(first);
    // Each bucket has at most a minimum, a maximum and a gap, and the range may start inside one.
    let buckets = (most / 3 - 2) as f64;
    // Rounded up to a power of two; a line of zero width has one bucket.
    let width = ((last - first) / buckets).max(1e-300).log2().ceil().exp2();
    // Rounds toward zero, which is cheaper than down: the two buckets next to x = 0 are merged.
    let bucket = |x: f64| (x / width) as i64;
    points
        .chunk_by(|[a, _], [b, _]| bucket(*a) == bucket(*b) || !(a + b).is_finite())
        .flat_map(extremes)
        .collect()
}

/// The lowest, the highest and the first gap of some points, in their order.
fn extremes(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    let finite = |k: &usize| points[*k].iter().all(|v| v.is_finite());
    let by_height = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
    let places = || (0..points.len()).filter(finite);
    let mut found = [
        places().min_by(by_height),
        places().max_by(by_height),
        (0..points.len()).find(|k| !finite(k)),
    ];
    found.sort_unstable();
    let [a, b, c] = found;
    let found = [a, b.filter(|_| a != b), c.filter(|_| c != b)];
    found.into_iter().flatten().map(move |k| points[k])
}

/// The stretches of a line between its gaps.
pub(super) fn segments(points: &[[f64; 2]]) -> impl Iterator<Item = &[[f64; 2]]> {
    points
        .split(|[x, y]| !x.is_finite() || !y.is_finite())
        .filter(|stretch| !stretch.is_empty())
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
        assert_eq!(decimate(MAX_POINTS, &points), points);
        assert!(decimate(MAX_POINTS, &[]).is_empty());
    }

    #[test]
    fn long_lines_keep_their_extremes_order_and_budget() {
        for n in [1001, 3000, 10_000, 36_000, 65_537] {
            let points = wave(n);
            let fewer = decimate(MAX_POINTS, &points);
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

    /// With fixed buckets, a growing line does not change its past while the width is constant.
    #[test]
    fn a_growing_line_stands_still() {
        let points = wave(6000);
        let (early, late) = (
            decimate(MAX_POINTS, &points[..5500]),
            decimate(MAX_POINTS, &points),
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
        let fewer = decimate(MAX_POINTS, &points);
        assert!(fewer.len() <= MAX_POINTS);
        assert_eq!(segments(&fewer).count(), 4);
        assert!(segments(&fewer).flatten().flatten().all(|v| v.is_finite()));
        assert_eq!(segments(&[[0.0, f64::NAN]; 3]).count(), 0);
        let fewer = |change: fn(&[f64; 2]) -> [f64; 2]| {
            let changed: Vec<_> = points.iter().map(change).collect();
            decimate(MAX_POINTS, &changed).len()
        };
        assert!(fewer(|p| [p[0], f64::NAN]) <= MAX_POINTS);
        assert_eq!(fewer(|_| [f64::NAN; 2]), 0);
        assert_eq!(fewer(|p| [3.0, p[1]]), 3);
    }
}
