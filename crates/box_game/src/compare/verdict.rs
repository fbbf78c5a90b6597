//! Verdicts: a few words about each trajectory, and one sentence about all of them.

use std::fmt;

use box_scenarios::Status;

use super::Quantity;
use super::series::{VISIBLE_ANGLE, VISIBLE_DISTANCE};
use super::view::{CompareView, TrajectoryView};
use crate::ui::panel::format::grouped;

/// Smallest visible lateness \[s\].
pub(crate) const VISIBLE_LATENESS: f64 = 0.1;
/// Smallest relative energy drift that is mentioned.
const VISIBLE_ENERGY: f64 = 0.01;
/// Errors below this value are rounding errors.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Quality of a trajectory, by its largest errors so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Quality {
    Right,
    /// The flip with this number, from 1, was late by this time \[s\]; early if negative.
    Late(usize, f64),
    /// Largest angle to the reference \[°\].
    Turned(f64),
    /// Largest distance from the reference \[m\].
    Away(f64),
    /// Diverged at this time \[s\].
    Exploded(f64),
}

impl Quality {
    /// Returns the quality for the largest distance \[m\] and angle \[°\] so far, the lateness of a flip, and the
    /// status. If `attitude`, a visible angle takes precedence over the distance.
    pub(crate) fn of(
        (distance, angle): (f64, f64),
        late: Option<(usize, f64)>,
        status: Status,
        attitude: bool,
    ) -> Self {
        match (status, late) {
            (Status::Diverged(d), _) => Self::Exploded(d.t),
            (_, Some((n, late))) if late.abs() > VISIBLE_LATENESS => Self::Late(n, late),
            _ if attitude && angle > VISIBLE_ANGLE => Self::Turned(angle),
            _ if distance > VISIBLE_DISTANCE => Self::Away(distance),
            _ if angle > VISIBLE_ANGLE => Self::Turned(angle),
            _ => Self::Right,
        }
    }

    /// Magnitude of the error: 0 if right, 1 at the limit of visibility.
    pub(crate) fn severity(self) -> f64 {
        match self {
            Self::Right => 0.0,
            Self::Late(_, late) => late.abs() / VISIBLE_LATENESS,
            Self::Turned(angle) => angle / VISIBLE_ANGLE,
            Self::Away(distance) => distance / VISIBLE_DISTANCE,
            Self::Exploded(_) => f64::INFINITY,
        }
    }

    /// A symbol for the quality.
    pub(crate) const fn sign(self) -> &'static str {
        match self {
            Self::Right => "✔",
            Self::Late(..) => "⏰",
            Self::Turned(_) | Self::Away(_) => "≠",
            Self::Exploded(_) => "✖",
        }
    }
}

/// `flip 2 late by 0.40 s`, `88° off`, `diverged at 1.5 s`.
impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Right => f.write_str("accurate"),
            Self::Late(n, late) => {
                let word = if late > 0.0 { "late" } else { "early" };
                write!(f, "flip {n} {word} by {:.2} s", late.abs())
            }
            Self::Turned(angle) => write!(f, "{}° off", short(angle)),
            Self::Away(distance) if distance < 1.0 => {
                write!(f, "{} cm off", short(100.0 * distance))
            }
            Self::Away(distance) => write!(f, "{} m off", short(distance)),
            Self::Exploded(t) => write!(f, "diverged at {t:.1} s"),
        }
    }
}

/// Formats a value with two significant digits, for labels.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    match size {
        _ if !value.is_finite() => "–".to_owned(),
        _ if size < ROUNDING => "0".to_owned(),
        _ if !(1e-3..1e5).contains(&size) => format!("{value:.0e}"),
        _ if size >= 1e4 => {
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", grouped(1000 * (size / 1e3).round() as u64))
        }
        _ => {
            let decimals = (1.0 - size.log10().floor()).clamp(0.0, 4.0) as usize;
            format!("{value:.decimals$}")
        }
    }
}

impl TrajectoryView {
    /// Returns the quality; `attitude` as in [`Quality::of`].
    pub(crate) fn quality(&self, attitude: bool) -> Quality {
        Quality::of(self.worst, self.late, self.status, attitude)
    }
}

/// Headline: the worst integrator with its error, and the best one with its error and relative cost.
pub(crate) fn headline(view: &CompareView) -> String {
    let quality = |t: &TrajectoryView| t.quality(view.attitude);
    let by_severity = |a: &&TrajectoryView, b: &&TrajectoryView| {
        let [a, b] = [a, b].map(|t| quality(t).severity());
        a.total_cmp(&b)
    };
    let all = || view.trajectories.iter();
    let (Some(best), Some(worst)) = (all().min_by(by_severity), all().max_by(by_severity)) else {
        return String::new();
    };
    let name = |t: &TrajectoryView| t.integrator.name();
    if quality(worst) == Quality::Right {
        return match view.trajectories.len() {
            1 => format!("{} matches the reference so far.", name(best)),
            n => format!("All {n} integrators match the reference so far."),
        };
    }
    let drift = worst.get(Quantity::Energy);
    let energy = if drift.abs() > VISIBLE_ENERGY && drift.abs() < 100.0 && !worst.diverged() {
        let sign = if drift > 0.0 { '+' } else { '−' };
        format!(", energy {sign}{} %", short(100.0 * drift.abs()))
    } else {
        String::new()
    };
    let first = format!("{}: {}{energy}.", name(worst), quality(worst));
    if best.integrator == worst.integrator {
        return first;
    }
    let price = match (best.cost_per_second(), worst.cost_per_second()) {
        (Some(a), Some(b)) if (0.8..=1.25).contains(&(a / b)) => ", at the same cost".to_owned(),
        (Some(a), Some(b)) => format!(", at {}× the cost", short(a / b)),
        _ => String::new(),
    };
    let (distance, angle) = best.worst;
    let error = match quality(best) {
        Quality::Right if angle.max(distance) < ROUNDING => "accurate to rounding".to_owned(),
        Quality::Right if view.attitude => format!("accurate to {}°", short(angle)),
        Quality::Right => format!("accurate to {} m", short(distance)),
        other => other.to_string(),
    };
    format!("{first} {}: {error}{price}.", name(best))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ui::panel::sample_view;
    use box_bench::measure::Cost;

    #[test]
    fn a_word_for_every_quality() {
        let of = |worst, late, attitude| Quality::of(worst, late, Status::Ok, attitude).to_string();
        assert_eq!(of((0.0, 0.1), None, true), "accurate");
        assert_eq!(of((0.0, 88.2), None, true), "88° off");
        assert_eq!(of((0.35, 88.2), None, false), "35 cm off");
        assert_eq!(of((3.51, 0.0), None, false), "3.5 m off");
        assert_eq!(
            of((0.0, 140.0), Some((2, 0.4)), true),
            "flip 2 late by 0.40 s"
        );
        let early = of((0.0, 140.0), Some((1, -0.4)), true);
        assert_eq!(early, "flip 1 early by 0.40 s");
    }

    #[test]
    fn two_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1e-12, "0"),
            (2.34e-5, "2e-5"),
            (0.0123, "0.012"),
            (0.345, "0.34"),
            (3.45, "3.5"),
            (34.5, "34"),
            (345.0, "345"),
            (-28_696.0, "-29\u{a0}000"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(short(value), text, "{value}");
        }
    }

    /// The headline names the worst and the best integrator, and follows the measurements.
    #[test]
    fn the_sentence_changes_with_what_happens() {
        let mut view = sample_view().compare;
        for t in &mut view.trajectories {
            t.worst = (0.0, 1e-13);
        }
        let all = "All 3 integrators match the reference so far.";
        assert_eq!(headline(&view), all);
        let euler = view.trajectories.last_mut().expect("three");
        euler.worst = (0.0, 88.0);
        euler.now[Quantity::Energy as usize] = 0.33;
        assert_eq!(
            headline(&view),
            "Semi-implicit Euler: 88° off, energy +33 %. Split: accurate to rounding, at the same cost."
        );
        view.trajectories[2].cost = Some(Cost::of(&[20.0]));
        view.trajectories[2].late = Some((2, 0.4));
        assert_eq!(
            headline(&view),
            "Semi-implicit Euler: flip 2 late by 0.40 s, energy +33 %. Split: accurate to rounding, at 2.5× the cost."
        );
        view.trajectories[2].status = Status::Diverged(box_scenarios::Divergence {
            t: 1.5,
            reason: box_scenarios::Reason::Energy,
        });
        assert!(headline(&view).starts_with("Semi-implicit Euler: diverged at 1.5 s. Split"));
        view.trajectories.clear();
        assert_eq!(headline(&view), "");
    }
}
