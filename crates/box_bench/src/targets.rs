//! Performance targets, as ratios of costs measured in the same run.

use crate::rows::Row;

/// Time of a step of a game at 60 Hz \[ns\].
const FRAME: f64 = 1e9 / 60.0;

/// A target for a ratio.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Description of the measured ratio.
    pub what: String,
    /// The target.
    pub aim: Aim,
    /// The measured value.
    pub measured: f64,
}

/// Bound of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// At most this value.
    AtMost(f64),
    /// At least this value.
    AtLeast(f64),
}

impl Target {
    /// Returns `true` if the measurement meets the target.
    pub fn is_met(&self) -> bool {
        match self.aim {
            Aim::AtMost(most) => self.measured <= most,
            Aim::AtLeast(least) => self.measured >= least,
        }
    }
}

/// The targets that can be computed from `rows`.
pub fn targets(rows: &[Row]) -> Vec<Target> {
    let found = Found(rows);
    let mut targets = Vec::new();
    let mut add = |what: String, aim: Aim, measured: Option<f64>| {
        targets.extend(measured.map(|measured| Target {
            what,
            aim,
            measured,
        }));
    };
    let ratio = |a: Option<f64>, b: Option<f64>| Some(a? / b?);
    let sizes = found.sizes();
    for &n in sizes.iter().filter(|&&n| n >= 1000) {
        add(
            format!("plugin to bare loop, free flight, {n} bodies, one thread"),
            Aim::AtMost(1.3),
            ratio(found.flight(n, 1), found.step("bare loop", n, 1)),
        );
    }
    for &n in sizes.iter().filter(|&&n| n > 1000) {
        let (compute, memory) = (found.flight(1000, 1), found.step("memory", n, 1));
        let bound = compute.zip(memory).map(|(a, b)| a.max(b));
        add(
            format!(
                "free flight, {n} bodies, one thread, to the larger of the cost at 1000 and of the memory"
            ),
            Aim::AtMost(1.3),
            ratio(found.flight(n, 1), bound),
        );
    }
    for &n in sizes.iter().filter(|&&n| n == 100_000) {
        add(
            format!("one thread to two, free flight, {n} bodies"),
            Aim::AtLeast(1.7),
            ratio(found.flight(n, 1), found.flight(n, 2)),
        );
    }
    for &n in sizes.iter().filter(|&&n| n == 100 || n == 10_000) {
        add(
            format!("`split` to `semi-implicit-euler`, many at a time, {n} bodies"),
            Aim::AtMost(1.5),
            ratio(
                found.kernel("split", n),
                found.kernel("semi-implicit-euler", n),
            ),
        );
    }
    add(
        "flying low over the floor to free flight, one box".to_owned(),
        Aim::AtMost(1.5),
        ratio(
            found.of("contact", "flying low", "split", 1, 1),
            found.of("kernels", "plain", "split", 1, 1),
        ),
    );
    let allocations = |threads| {
        let of = rows.iter().filter(move |r| r.threads == threads);
        of.filter_map(|r| r.allocations)
    };
    add(
        "allocations of a step on one thread, at most".to_owned(),
        Aim::AtMost(0.0),
        allocations(1).reduce(f64::max),
    );
    targets
}

/// A sentence about the cost of a million falling boxes, if measured.
pub fn million(rows: &[Row]) -> Option<String> {
    let found = Found(rows);
    let per_step = |threads| {
        let cost = found.step("falling", 1_000_000, threads)?;
        Some(cost * 1e6)
    };
    let (one, two) = (per_step(1)?, per_step(2)?);
    let verdict = if two < FRAME {
        "in real time, on two threads".to_owned()
    } else {
        let most = 1e6 * FRAME / two;
        format!("not in real time: {most:.0} boxes are the limit on two threads")
    };
    Some(format!(
        "A million falling boxes take {:.1} ms a step on one thread and {:.1} ms on two; at 60 Hz a step has {:.1} ms: \
         {verdict}.\n",
        one * 1e-6,
        two * 1e-6,
        FRAME * 1e-6
    ))
}

/// Costs by name \[ns\].
struct Found<'a>(&'a [Row]);

impl Found<'_> {
    fn sizes(&self) -> Vec<usize> {
        let mut sizes: Vec<_> = self.0.iter().map(|r| r.bodies).collect();
        sizes.sort_unstable();
        sizes.dedup();
        sizes
    }

    fn of(
        &self,
        suite: &str,
        name: &str,
        integrator: &str,
        n: usize,
        threads: usize,
    ) -> Option<f64> {
        let mut rows = self.0.iter();
        let row = rows.find(|r| {
            (r.suite, r.name.as_str(), r.integrator) == (suite, name, integrator)
                && (r.bodies, r.threads) == (n, threads)
        });
        row.map(|r| r.cost.min)
    }

    fn step(&self, name: &str, n: usize, threads: usize) -> Option<f64> {
        self.of("step", name, "split", n, threads)
    }

    fn flight(&self, n: usize, threads: usize) -> Option<f64> {
        self.step("free flight", n, threads)
    }

    fn kernel(&self, integrator: &str, n: usize) -> Option<f64> {
        self.of("kernels", "many at a time", integrator, n, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Cost;

    fn row(name: &str, bodies: usize, threads: usize, ns: f64) -> Row {
        Row {
            suite: "step",
            name: name.to_owned(),
            integrator: "split",
            bodies,
            threads,
            cost: Cost::of(&[ns]),
            to_bare: None,
            to_memory: None,
            allocations: Some(0.0),
        }
    }

    #[test]
    fn targets_are_ratios_of_the_rows_and_say_what_is_not_met() {
        let rows = [
            row("bare loop", 1000, 1, 20.0),
            row("free flight", 1000, 1, 25.0),
            row("bare loop", 100_000, 1, 30.0),
            row("memory", 100_000, 1, 30.0),
            row("free flight", 100_000, 1, 45.0),
            row("free flight", 100_000, 2, 25.0),
        ];
        let found = targets(&rows);
        let met: Vec<_> = found.iter().map(|t| (t.measured, t.is_met())).collect();
        assert_eq!(
            met,
            [
                (1.25, true),
                (1.5, false),
                (1.5, false),
                (1.8, true),
                (0.0, true)
            ]
        );
        assert!(targets(&[]).is_empty());
    }

    #[test]
    fn a_million_in_words() {
        assert_eq!(million(&[]), None);
        let words = |two| {
            let rows = [
                row("falling", 1_000_000, 1, 40.0),
                row("falling", 1_000_000, 2, two),
            ];
            million(&rows).expect("measured")
        };
        assert!(words(15.0).contains("15.0 ms on two") && words(15.0).contains("in real time, on"));
        assert!(words(25.0).contains("666667 boxes are the limit"));
    }
}
