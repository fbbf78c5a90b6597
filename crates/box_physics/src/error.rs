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
        let Self {
            field,
            value,
            allowed,
        } = self;
        write!(f, "{field} must be {allowed}, but is {value}")
    }
}

impl core::error::Error for InvalidValue {}

impl InvalidValue {
    /// Returns `Ok(value)` if `ok`, otherwise an error with these fields.
    pub(crate) fn check(
        ok: bool,
        field: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<f64, Self> {
        if ok {
            Ok(value)
        } else {
            Err(Self {
                field,
                value,
                allowed,
            })
        }
    }

    /// Accepts a finite value ≥ 0, for coefficients.
    pub(crate) fn check_coefficient(field: &'static str, value: f64) -> Result<f64, Self> {
        Self::check(
            value.is_finite() && value >= 0.0,
            field,
            value,
            "finite and not negative",
        )
    }
}
