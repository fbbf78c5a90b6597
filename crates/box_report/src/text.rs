//! Numbers formatted for readers.

/// Formats an error with two digits, such as `6.2e-3`; 0 is `0`.
pub(crate) fn error(x: f64) -> String {
    if x == 0.0 {
        "0".to_owned()
    } else if x.is_finite() && (0.01..1000.0).contains(&x.abs()) {
        significant(x, 2)
    } else {
        format!("{x:.1e}")
    }
}

/// Formats `x` with `digits` significant digits and without an exponent.
pub(crate) fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    // Round first, so that 9.96 becomes 10 and not 10.0.
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().unwrap_or(x);
    let before = rounded.abs().log10().floor() as i32 + 1;
    let after = (digits as i32 - before).max(0) as usize;
    format!("{rounded:.after$}")
}

/// Formats a step \[s\] as `1/60`, or with three digits if it is not one over an integer.
pub(crate) fn step(dt: f64) -> String {
    let rate = 1.0 / dt;
    if (rate - rate.round()).abs() < 1e-6 * rate && rate >= 1.0 {
        format!("1/{}", rate.round())
    } else {
        significant(dt, 3)
    }
}

/// Formats a relative error as a signed percentage. Values below 1e-12 are rounding errors and become 0 %.
pub(crate) fn percent(x: f64) -> String {
    if x.abs() < 1e-12 {
        return "0 %".to_owned();
    }
    let sign = if x < 0.0 { '−' } else { '+' };
    format!("{sign}{} %", significant(100.0 * x.abs(), 2))
}

/// Formats a duration \[ns\] with a suitable unit.
pub(crate) fn time(ns: f64) -> String {
    match ns {
        _ if ns < 1e3 => format!("{} ns", significant(ns, 3)),
        _ if ns < 1e6 => format!("{} µs", significant(ns / 1e3, 3)),
        _ => format!("{} ms", significant(ns / 1e6, 3)),
    }
}

/// Joins items to a list in a sentence: `a`, `b` and `c`.
pub(crate) fn list(items: &[String]) -> String {
    match items {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Splits the heading of a table, such as `scene | cost`, into its columns.
pub(crate) fn columns(heading: &str) -> Vec<String> {
    heading.split(" | ").map(str::to_owned).collect()
}

/// Formats `x` as inline code.
pub(crate) fn code(x: impl core::fmt::Display) -> String {
    format!("`{x}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(error(6.21e-3), "6.2e-3");
        assert_eq!(error(0.5712), "0.57");
        assert_eq!(error(3.0), "3.0");
        assert_eq!(error(997.0), "1000");
        assert_eq!(error(0.0), "0");
        assert_eq!(percent(-3.5e-3), "−0.35 %");
        assert_eq!(percent(2.3e-15), "0 %");
        assert_eq!(step(1.0 / 1920.0), "1/1920");
        assert_eq!(step(0.3), "0.300");
        assert_eq!(time(58.31), "58.3 ns");
        assert_eq!(time(1200.0), "1.20 µs");
        assert_eq!(list(&["a".into(), "b".into(), "c".into()]), "a, b and c");
    }
}
