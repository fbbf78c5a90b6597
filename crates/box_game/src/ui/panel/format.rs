//! Conversion of numbers to text, always with four significant digits, and of text to numbers.

/// Four significant digits without trailing zeros: `9.81`, `0.01667`, `1.2e-5`. Thousands are grouped; scientific
/// notation is used if shorter.
pub(super) fn number(value: f64) -> String {
    let plain = quantity(value);
    let scientific = trimmed(&format!("{value:.3e}"));
    let large = value.is_finite() && value.abs() >= 99_999.5;
    if large && scientific.len() < plain.chars().count() {
        scientific
    } else {
        trimmed(&plain)
    }
}

/// Removes zeros at the end of the fraction.
fn trimmed(text: &str) -> String {
    let (mantissa, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    let mantissa = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    format!("{mantissa}{exponent}")
}

/// Four significant digits with trailing zeros, so that a changing value keeps its width.
pub(super) fn quantity(value: f64) -> String {
    match value.abs() {
        f64::INFINITY => if value > 0.0 { "∞" } else { "−∞" }.to_owned(),
        0.0 => "0.000".to_owned(),
        _ if value.is_nan() => "not a number".to_owned(),
        size if !(1e-3..999_999.5).contains(&size) => format!("{value:.3e}"),
        size if size >= 9999.5 => {
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", grouped(size.round() as u64))
        }
        size => {
            // log10 of 1e-3…1e4 is −3…4: decimals 0…6.
            let decimals = (3.0 - size.log10().floor()).clamp(0.0, 6.0) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// A step size as `1/60 s` if it is such a fraction, else as `0.0167 s`.
pub(super) fn step_size(dt: f64) -> String {
    let hertz = (1.0 / dt).round();
    // Bevy's clock counts whole nanoseconds: a sixtieth is 16 666 667 of them, 2e-8 too many.
    if hertz >= 2.0 && hertz.is_finite() && (dt * hertz - 1.0).abs() < 1e-6 {
        format!("1/{hertz} s")
    } else {
        format!("{} s", number(dt))
    }
}

/// Parses a typed number: `0.5`, `0,5`, `1/60`, `1e-3`, a number with a unit, and `60 Hz` for a period. `None` for
/// anything else, and for infinities and NaN.
pub(super) fn parse(text: &str) -> Option<f64> {
    let text = text.replace(',', ".").replace('−', "-");
    let text = text.replace('\u{a0}', "");
    let lower = text.trim().to_ascii_lowercase();
    let fraction = |(over, under): &(&str, &str)| {
        let digits = under.trim_start();
        let number = digits.starts_with(|c: char| c.is_ascii_digit() || c == '.');
        number && over.trim().parse::<f64>().is_ok()
    };
    let value = if let Some(hertz) = lower.strip_suffix("hz") {
        1.0 / plain(hertz)?
    } else if let Some((over, under)) = text.split_once('/').filter(fraction) {
        plain(over)? / plain(under)?
    } else {
        plain(&text)?
    };
    value.is_finite().then_some(value)
}

/// Parses a number with an optional unit: "1e3" is a number, "5 m/s²" is a number and its unit.
fn plain(text: &str) -> Option<f64> {
    let text = text.trim();
    let number = |k: usize| text.get(..k)?.trim_end().parse().ok();
    let number = |k: usize| number(k).filter(|v: &f64| v.is_finite());
    let end = (1..=text.len()).rev().find(|&k| number(k).is_some())?;
    let unit = text[end..].trim();
    let more = unit.starts_with(|c: char| c.is_ascii_digit() || "+-./*^".contains(c));
    number(end).filter(|_| !more)
}

/// Formats `1482` as `1 482`, with a narrow no-break space.
pub(crate) fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits() {
        for (value, wide, narrow) in [
            (0.0, "0.000", "0"),
            (9.81, "9.810", "9.81"),
            (-9.81, "-9.810", "-9.81"),
            (1.0, "1.000", "1"),
            (10_000.0, "10\u{a0}000", "10\u{a0}000"),
            (9_999.7, "10\u{a0}000", "10\u{a0}000"),
            (-99_999.0, "-99\u{a0}999", "-99\u{a0}999"),
            (123_456.0, "123\u{a0}456", "123\u{a0}456"),
            (100_000.0, "100\u{a0}000", "1e5"),
            (1_234_567.0, "1.235e6", "1.235e6"),
            (0.001, "0.001000", "0.001"),
            (2e-5, "2.000e-5", "2e-5"),
            (1.0 / 60.0, "0.01667", "0.01667"),
            (1.234567e-7, "1.235e-7", "1.235e-7"),
            (f64::INFINITY, "∞", "∞"),
            (f64::NAN, "not a number", "not a number"),
        ] {
            assert_eq!(
                (quantity(value).as_str(), number(value).as_str()),
                (wide, narrow)
            );
        }
    }

    #[test]
    fn step_sizes() {
        for (dt, text) in [
            (1.0 / 60.0, "1/60 s"),
            (0.0167, "0.0167 s"),
            (0.5, "1/2 s"),
            (0.0, "0 s"),
            (f64::NAN, "not a number s"),
        ] {
            assert_eq!(step_size(dt), text);
        }
    }

    #[test]
    fn what_people_type() {
        for (text, value) in [
            ("0.5", Some(0.5)),
            (" 0,5 ", Some(0.5)),
            ("1e-3", Some(1e-3)),
            ("−2", Some(-2.0)),
            ("9.81 m/s²", Some(9.81)),
            ("12\u{a0}345", Some(12_345.0)),
            ("3 N s", Some(3.0)),
            ("1/64", Some(1.0 / 64.0)),
            ("1/64 s", Some(1.0 / 64.0)),
            ("50hz", Some(0.02)),
            ("50 Hz", Some(0.02)),
            ("1/0", None),
            ("0 Hz", None),
            ("inf", None),
            ("NaN", None),
            ("", None),
            ("box", None),
            ("1.2.3", None),
        ] {
            assert_eq!(parse(text), value, "{text}");
        }
    }

    #[test]
    fn thousands_stand_apart() {
        let counts = [7, 1_482, 1_234_567].map(grouped);
        assert_eq!(counts, ["7", "1\u{a0}482", "1\u{a0}234\u{a0}567"]);
    }
}
