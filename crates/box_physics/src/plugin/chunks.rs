//! Splitting the columns of a table into chunks for the threads.

use core::ops::Range;

use super::components::BodyIntegrator;
use crate::integrators::Integrator;

/// Columns of equal length: slices, tuples of them, and `None` for a column that the table does not have.
pub(crate) trait Columns: Sized {
    /// Splits the columns into the rows before `row` and the rest.
    fn cut(self, row: usize) -> (Self, Self);

    /// The rows of `range`.
    fn rows(self, range: Range<usize>) -> Self {
        self.cut(range.end).0.cut(range.start).1
    }

    /// Splits the rows of `range` into chunks of `size` rows (the last may be shorter), each with the index of its
    /// first row.
    fn chunks(self, range: Range<usize>, size: usize) -> Chunks<Self> {
        Chunks {
            columns: Some(self.rows(range.clone())),
            range,
            size: size.max(1),
        }
    }
}

impl<T> Columns for &[T] {
    fn cut(self, row: usize) -> (Self, Self) {
        self.split_at(row)
    }
}

impl<T> Columns for &mut [T] {
    fn cut(self, row: usize) -> (Self, Self) {
        self.split_at_mut(row)
    }
}

impl<C: Columns> Columns for Option<C> {
    fn cut(self, row: usize) -> (Self, Self) {
        self.map(|column| column.cut(row)).unzip()
    }
}

macro_rules! tuples {
    ($(($($Column:ident $column:ident),+))+) => {$(
        impl<$($Column: Columns),+> Columns for ($($Column,)+) {
            fn cut(self, row: usize) -> (Self, Self) {
                let ($($column,)+) = self;
                $(let $column = $column.cut(row);)+
                (($($column.0,)+), ($($column.1,)+))
            }
        }
    )+};
}

tuples! {
    (A a, B b, C c, D d)
    (A a, B b, C c, D d, E e)
    (A a, B b, C c, D d, E e, F f)
    (A a, B b, C c, D d, E e, F f, G g)
    (A a, B b, C c, D d, E e, F f, G g, H h)
}

/// Iterator over the chunks of [`Columns::chunks`], usable from both ends.
pub(crate) struct Chunks<C> {
    columns: Option<C>,
    /// The remaining rows.
    range: Range<usize>,
    size: usize,
}

impl<C: Columns> Iterator for Chunks<C> {
    type Item = (usize, C);

    fn next(&mut self) -> Option<(usize, C)> {
        if self.range.is_empty() {
            return None;
        }
        let first = self.range.start;
        let count = self.size.min(self.range.len());
        let (next, rest) = self.columns.take()?.cut(count);
        self.columns = Some(rest);
        self.range.start += count;
        Some((first, next))
    }
}

impl<C: Columns> DoubleEndedIterator for Chunks<C> {
    fn next_back(&mut self) -> Option<(usize, C)> {
        let last = self.range.len().checked_sub(1)? / self.size * self.size;
        let (rest, next) = self.columns.take()?.cut(last);
        self.columns = Some(rest);
        self.range.end = self.range.start + last;
        Some((self.range.end, next))
    }
}

/// Maximal runs of rows with the same integrator. Without a column of own integrators this is the whole table.
pub(crate) fn integrator_runs(
    global: Integrator,
    own: Option<&[BodyIntegrator]>,
    rows: usize,
) -> impl Iterator<Item = (Integrator, Range<usize>)> {
    let mut start = 0;
    core::iter::from_fn(move || {
        if start >= rows {
            return None;
        }
        let begin = start;
        let Some(own) = own else {
            start = rows;
            return Some((global, begin..rows));
        };
        let chosen = own[begin].0;
        start = (begin..rows).find(|&i| own[i].0 != chosen).unwrap_or(rows);
        Some((chosen, begin..start))
    })
}

/// Maximal runs of consecutive rows below `rows` for which `wanted` holds.
pub(crate) fn runs_of(
    rows: usize,
    wanted: impl Fn(usize) -> bool,
) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    core::iter::from_fn(move || {
        let start = (next..rows).find(|&i| wanted(i))?;
        next = (start..rows).find(|&i| !wanted(i)).unwrap_or(rows);
        Some(start..next)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From either end, the chunks cover every row once and have the requested size except for the last. All columns
    /// are split in the same way.
    #[test]
    fn chunks_cover_the_range_once_from_both_ends() {
        let (names, mut numbers): (Vec<_>, Vec<_>) = (0..20).map(|i| (i, i)).unzip();
        for from_the_end in [false, true] {
            let columns = (&*names, &mut *numbers, None::<&[u8]>, &*names);
            let mut chunks = columns.chunks(3..19, 5);
            let mut found = Vec::new();
            while let Some((first, (names, numbers, absent, _))) = if from_the_end {
                chunks.next_back()
            } else {
                chunks.next()
            } {
                assert_eq!((names[0], numbers[0]), (first, first));
                assert_eq!((names.len(), absent), (numbers.len(), None));
                found.push((first, names.len()));
            }
            found.sort_unstable();
            assert_eq!(found, [(3, 5), (8, 5), (13, 5), (18, 1)]);
        }
        let none = (&*names, &*names, &*names, &*names).chunks(4..4, 5);
        assert_eq!(none.count(), 0);
    }

    #[test]
    fn runs_cover_the_table_once_and_in_order() {
        let whole: Vec<_> = integrator_runs(Integrator::Rk4, None, 5).collect();
        assert_eq!(whole, [(Integrator::Rk4, 0..5)]);
        assert_eq!(integrator_runs(Integrator::Rk4, None, 0).count(), 0);
        let [a, b] = [Integrator::Split, Integrator::ExplicitEuler].map(BodyIntegrator);
        let own = [a, a, b, a];
        let parts: Vec<_> = integrator_runs(Integrator::Rk4, Some(&own), 4).collect();
        assert_eq!(parts, [(a.0, 0..2), (b.0, 2..3), (a.0, 3..4)]);
        let odd: Vec<_> = runs_of(7, |i| i % 4 > 1).collect();
        assert_eq!(odd, [2..4, 6..7]);
        assert_eq!(runs_of(3, |_| true).next(), Some(0..3));
        assert_eq!(runs_of(3, |_| false).count(), 0);
    }
}
