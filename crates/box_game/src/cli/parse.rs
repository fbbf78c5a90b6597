//! Values of options: each parser names what is allowed.

use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;

use super::Setting;
use crate::action::Plot;
use crate::parameters::{Parameter, SPEEDS, UI_SCALES};
use crate::platform;
use crate::scene::library;

/// Reads a step size and checks its range.
pub(super) fn step(text: &str) -> Result<f64, String> {
    let (low, high) = Parameter::Step.info().range;
    let step = box_scenarios::parse_step(text)?;
    let within = (low..=high).contains(&step).then_some(step);
    within.ok_or_else(|| format!("allowed: {low:.5} to {high} s; given: {step} s"))
}

pub(super) fn scene(text: &str) -> Result<String, String> {
    let scene = library::open(text)?;
    Ok(match library::file_path(text) {
        Some(_) => text.to_owned(),
        None => scene.id.to_owned(),
    })
}

pub(super) fn plot(text: &str) -> Result<Plot, String> {
    Plot::ALL
        .into_iter()
        .find(|(_, name)| name.eq_ignore_ascii_case(text.trim()))
        .map(|(plot, _)| plot)
        .ok_or_else(|| format!("allowed: {}", Plot::ALL.map(|(_, name)| name).join(", ")))
}

pub(super) fn duration(text: &str) -> Result<f64, String> {
    match text.trim().trim_end_matches('s').parse::<f64>() {
        Ok(s) if s > 0.0 && s <= 1e6 => Ok(s),
        _ => Err("allowed: seconds, above 0 and up to 1e6".to_owned()),
    }
}

pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let pixels = |t: &str| t.parse().ok().filter(|n| (320..=7680).contains(n));
    text.split_once(['x', 'X', '×'])
        .and_then(|(w, h)| pixels(w).zip(pixels(h)))
        .ok_or_else(|| "allowed: WIDTHxHEIGHT, each 320 to 7680, such as 1920x1080".to_owned())
}

pub(super) fn speed(text: &str) -> Result<f64, String> {
    within(text, (SPEEDS[0], SPEEDS[SPEEDS.len() - 1]))
}

pub(super) fn scale(text: &str) -> Result<f32, String> {
    within(text, UI_SCALES)
}

fn within<T: FromStr + PartialOrd + Display>(text: &str, range: (T, T)) -> Result<T, String> {
    let (low, high) = range;
    let number = text.trim().parse().ok();
    number
        .filter(|number| (&low..=&high).contains(&number))
        .ok_or_else(|| format!("allowed: {low} to {high}"))
}

pub(super) fn setting(text: &str) -> Result<Setting, String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("allowed: NAME=VALUE, such as gravity=1.62")?;
    let number = |t: &str| {
        let number = t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        number.ok_or_else(|| format!("'{t}' is not a number"))
    };
    if name.trim() == "half-extents" {
        let sizes: Vec<f64> = value.split(',').map(number).collect::<Result<_, _>>()?;
        if sizes.len() != 3 {
            return Err("half-extents: allowed: three numbers, such as 0.5,0.25,0.125".to_owned());
        }
        let axes = [Parameter::HalfX, Parameter::HalfY, Parameter::HalfZ];
        return Ok(Setting(axes.into_iter().zip(sizes).collect()));
    }
    let ids = Parameter::ALL.map(|p| p.info().id);
    let known = ids.iter().position(|id| *id == name.trim());
    let parameter = known
        .map(|k| Parameter::ALL[k])
        .ok_or_else(|| format!("unknown parameter '{name}'; allowed: {}", ids.join(", ")))?;
    let value = parameter
        .parse(value)
        .ok_or_else(|| match parameter.info().choices {
            [] => format!("'{value}' is not a number"),
            choices => format!("{name} {value}: allowed: {}", choices.join(", ")),
        })?;
    Ok(Setting(vec![(parameter, value)]))
}

pub(super) fn png(text: &str) -> Result<PathBuf, String> {
    platform::with_extension(text, "png")
        .ok_or_else(|| "allowed: a file name that ends in .png".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests only the range; [`box_scenarios::parse_step`] reads the text.
    #[test]
    fn steps_have_a_range() {
        assert_eq!(step("1920 Hz"), Ok(1.0 / 1920.0));
        for bad in ["0.6", "5000hz"] {
            assert!(
                step(bad).is_err_and(|said| said.contains("allowed")),
                "{bad}"
            );
        }
    }
}
