//! The error that constructors return for an invalid value.

/// A value outside its documented range, with the field, the value and the allowed range.
///
/// ```
/// use box_physics::prelude::*;
/// let error = RigidBox::new(DVec3::new(0.5, -1.0, 0.5), 2.0).unwrap_err();
/// assert_eq!(error.to_string(), "half_extents.y must be finite and between 1e-6 and 1e6 m, but is -1");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InvalidValue {
    /// Name of the field as the caller knows it.
    pub field: &'static str,
    /// The given value.
    pub value: f64,
    /// The allowed range, in words and with its unit.
    pub allowed: &'static str,
}

impl core::fmt::Display for InvalidValue {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "{} must be {}, but is {}",
            self.field, self.allowed, self.value
        )
    }
}

impl core::error::Error for InvalidValue {}

impl InvalidValue {
    /// Returns an error with these fields unless `ok`.
    pub(crate) fn check(
        ok: bool,
        field: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        let error = Self {
            field,
            value,
            allowed,
        };
        ok.then_some(()).ok_or(error)
    }

    /// Accepts a value between the two limits.
    pub(crate) fn check_between(
        (low, high): (f64, f64),
        field: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), Self> {
        Self::check((low..=high).contains(&value), field, value, allowed)
    }

    /// Accepts a finite value ≥ 0, for coefficients.
    pub(crate) fn check_coefficient(field: &'static str, value: f64) -> Result<(), Self> {
        Self::check_between((0.0, f64::MAX), field, value, "finite and not negative")
    }
}
