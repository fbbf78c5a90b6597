//! Parsing of step sizes.

/// Parses a step size \[s\] from `60hz` (a rate), `1/60` (a fraction) or `0.0166` (seconds, with or without `s`).
///
/// # Errors
/// A message with the allowed forms, if the text is none of these or the step is not finite and positive.
///
/// ```
/// use box_scenarios::parse_step;
/// assert_eq!(parse_step("60hz"), Ok(1.0 / 60.0));
/// assert!(parse_step("fast").is_err());
/// ```
pub fn parse_step(text: &str) -> Result<f64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let number = |t: &str| t.trim().parse::<f64>().ok();
    let seconds = if let Some(rate) = lower.strip_suffix("hz") {
        number(rate).map(|r| 1.0 / r)
    } else if let Some((above, below)) = lower.split_once('/') {
        number(above).zip(number(below)).map(|(a, b)| a / b)
    } else {
        number(lower.strip_suffix('s').unwrap_or(&lower))
    };
    seconds
        .filter(|s| s.is_finite() && *s > 0.0)
        .ok_or_else(|| {
            format!(
                "allowed: a finite positive rate (60hz), fraction (1/60) or number of seconds (0.0166); given: '{text}'"
            )
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_in_every_spelling() {
        assert_eq!(parse_step("60hz"), Ok(1.0 / 60.0));
        assert_eq!(parse_step(" 60 Hz"), Ok(1.0 / 60.0));
        assert_eq!(parse_step("1/60"), Ok(1.0 / 60.0));
        assert_eq!(parse_step("0.0166"), Ok(0.0166));
        assert_eq!(parse_step("1e-3s"), Ok(1e-3));
        for bad in [
            "", "fast", "0", "-1/60", "0hz", "1/0", "nan", "infhz", "1//2",
        ] {
            assert!(parse_step(bad).is_err_and(|e| e.contains(bad)), "{bad}");
        }
    }
}
