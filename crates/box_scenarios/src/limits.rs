//! Ranges of the numbers in a file, checked while reading. Types read from files use these functions in
//! `deserialize_with`, so that an error has the location of the value.

use core::ops::RangeInclusive;

use box_physics::error::InvalidValue;
use glam::DVec3;
use serde::de::{Deserialize, Deserializer, Error};

/// Largest absolute value of any number in a file, in its SI unit.
const LARGEST: f64 = 1e6;

/// Maximum number of springs, point forces or impulses in a file.
pub(crate) const MAX_ITEMS: usize = 64;

/// A range and its description.
type Range = (RangeInclusive<f64>, &'static str);

/// Any number in a file.
pub(crate) const ANY: Range = (-LARGEST..=LARGEST, "between -1e6 and 1e6");
/// A coefficient of a force or of friction.
pub(crate) const COEFFICIENT: Range = (0.0..=LARGEST, "between 0 and 1e6");

/// A type without limits of its own. Its numbers are checked when a file is read.
pub(crate) trait Limited {
    /// Checks every number.
    fn check(&self) -> Result<(), InvalidValue>;
}

/// Checks the numbers of a field.
pub(crate) fn check(
    field: &'static str,
    numbers: &[f64],
    (range, allowed): Range,
) -> Result<(), InvalidValue> {
    match numbers.iter().copied().find(|n| !range.contains(n)) {
        None => Ok(()),
        Some(value) => Err(InvalidValue {
            field,
            value,
            allowed,
        }),
    }
}

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
    number(from, COEFFICIENT.0, COEFFICIENT.1)
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

/// Reads a list of at most [`MAX_ITEMS`] elements and checks each, so that an error names it.
pub(crate) fn items<'de, D: Deserializer<'de>, T: Deserialize<'de> + Limited>(
    from: D,
) -> Result<Vec<T>, D::Error> {
    let items: Vec<Item<T>> = at_most(from, MAX_ITEMS)?;
    Ok(items.into_iter().map(|item| item.0).collect())
}

struct Item<T>(T);

impl<'de, T: Deserialize<'de> + Limited> Deserialize<'de> for Item<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let item = T::deserialize(from)?;
        item.check().map_err(D::Error::custom)?;
        Ok(Self(item))
    }
}
