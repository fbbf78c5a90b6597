//! Ranges of the numbers in a file, checked while reading. Types read from files use these functions in
//! `deserialize_with`, so that an error has the location of the value.

use core::ops::RangeInclusive;

use glam::DVec3;
use serde::de::{Deserialize, Deserializer, Error};

/// Largest absolute value of any number in a file, in its SI unit.
const LARGEST: f64 = 1e6;

/// Maximum number of springs, point forces or impulses in a file.
pub(crate) const MAX_ITEMS: usize = 64;

/// Range of any number in a file, and its description.
const ANY: (RangeInclusive<f64>, &str) = (-LARGEST..=LARGEST, "between -1e6 and 1e6");

/// Reads a number within `range`; `allowed` describes the range in the error.
pub(crate) fn number<'de, D: Deserializer<'de>>(
    from: D,
    range: RangeInclusive<f64>,
    allowed: &str,
) -> Result<f64, D::Error> {
    let value = f64::deserialize(from)?;
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(D::Error::custom(format_args!(
            "must be {allowed}, but is {value}"
        )))
    }
}

/// Reads any number that a file may contain.
pub(crate) fn any<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, ANY.0, ANY.1)
}

/// Reads a coefficient of a force or of friction.
pub(crate) fn coefficient<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, 0.0..=LARGEST, "between 0 and 1e6")
}

/// Reads a fraction, 0 to 1.
pub(crate) fn share<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    number(from, 0.0..=1.0, "between 0 and 1")
}

/// Reads a vector.
pub(crate) fn vector<'de, D: Deserializer<'de>>(from: D) -> Result<DVec3, D::Error> {
    within(DVec3::deserialize(from)?, ANY.0, ANY.1)
}

/// Reads an optional vector.
pub(crate) fn optional_vector<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<DVec3>, D::Error> {
    Option::<DVec3>::deserialize(from)?
        .map(|v| within(v, ANY.0, ANY.1))
        .transpose()
}

/// Returns `v` if each component is within `range`; `allowed` describes the range in the error.
pub(crate) fn within<E: Error>(
    v: DVec3,
    range: RangeInclusive<f64>,
    allowed: &str,
) -> Result<DVec3, E> {
    match v.to_array().into_iter().find(|c| !range.contains(c)) {
        None => Ok(v),
        Some(value) => Err(E::custom(format_args!("must be {allowed}, but is {value}"))),
    }
}

/// Reads a list of at most `most` elements.
pub(crate) fn at_most<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    from: D,
    most: usize,
) -> Result<Vec<T>, D::Error> {
    let list = Vec::deserialize(from)?;
    if list.len() <= most {
        Ok(list)
    } else {
        Err(D::Error::custom(format_args!("allowed: at most {most}")))
    }
}
