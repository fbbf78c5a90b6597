//! Surface of a body: friction and restitution, combined with those of the floor by Avian's rules.

use super::Floor;
#[cfg(feature = "bevy")]
use crate::ecs::*;
use crate::error::InvalidValue;

/// Rule for combining the coefficients of body and floor. The body's rule applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CoefficientCombine {
    /// (a + b)/2
    #[default]
    Average,
    /// √(ab)
    GeometricMean,
    /// The smaller one.
    Min,
    /// ab
    Multiply,
    /// The larger one.
    Max,
}

impl CoefficientCombine {
    /// Combines two coefficients.
    pub fn mix(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Average => 0.5 * (a + b),
            Self::GeometricMean => (a * b).sqrt(),
            Self::Min => a.min(b),
            Self::Multiply => a * b,
            Self::Max => a.max(b),
        }
    }
}

/// Friction of a body, combined with the floor's. Without it the floor's friction applies.
///
/// ```
/// use box_physics::prelude::*;
/// let rubber = Friction::new(1.2)?.with_combine_rule(CoefficientCombine::Max);
/// // Harder to move than to keep moving.
/// let wood = Friction::new(0.3)?.with_static_coefficient(0.5)?;
/// let floor = Floor::default().against(Some(&rubber), None);
/// assert_eq!(floor.friction, 1.2);
/// # Ok::<(), InvalidValue>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Friction {
    /// Coefficient of kinetic friction, ≥ 0. Default 0.5.
    pub dynamic_coefficient: f64,
    /// Coefficient of static friction; a value below the dynamic one counts as equal to it. Default 0.5.
    pub static_coefficient: f64,
    /// Rule for both coefficients.
    pub combine_rule: CoefficientCombine,
}

impl Default for Friction {
    /// The friction of the default [`Floor`].
    fn default() -> Self {
        Self {
            dynamic_coefficient: 0.5,
            static_coefficient: 0.5,
            combine_rule: CoefficientCombine::Average,
        }
    }
}

impl Friction {
    /// Creates friction with the same coefficient for both kinds, averaged with the floor's.
    ///
    /// # Errors
    /// [`InvalidValue`] if it is negative or not finite.
    pub fn new(coefficient: f64) -> Result<Self, InvalidValue> {
        let friction = Self {
            dynamic_coefficient: coefficient,
            static_coefficient: coefficient,
            ..Self::default()
        };
        friction.validate().map(|()| friction)
    }

    /// Sets the static coefficient.
    ///
    /// # Errors
    /// [`InvalidValue`] if it is negative or not finite.
    pub fn with_static_coefficient(self, static_coefficient: f64) -> Result<Self, InvalidValue> {
        let friction = Self {
            static_coefficient,
            ..self
        };
        friction.validate().map(|()| friction)
    }

    /// Sets the rule.
    pub fn with_combine_rule(self, combine_rule: CoefficientCombine) -> Self {
        Self {
            combine_rule,
            ..self
        }
    }

    /// Checks the fields.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        InvalidValue::check_coefficient("dynamic_coefficient", self.dynamic_coefficient)?;
        InvalidValue::check_coefficient("static_coefficient", self.static_coefficient)
    }
}

/// Restitution of a body, combined with the floor's. Without it the floor's restitution applies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(Component, Default, Clone, PartialEq)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Restitution {
    /// 0 to 1. Default 0.3.
    pub coefficient: f64,
    /// Rule for the coefficient.
    pub combine_rule: CoefficientCombine,
}

impl Default for Restitution {
    /// The restitution of the default [`Floor`].
    fn default() -> Self {
        Self {
            coefficient: 0.3,
            combine_rule: CoefficientCombine::Average,
        }
    }
}

impl Restitution {
    /// Creates restitution that is averaged with the floor's.
    ///
    /// # Errors
    /// [`InvalidValue`] if it is not between 0 and 1.
    pub fn new(coefficient: f64) -> Result<Self, InvalidValue> {
        let restitution = Self {
            coefficient,
            ..Self::default()
        };
        restitution.validate().map(|()| restitution)
    }

    /// Sets the rule.
    pub fn with_combine_rule(self, combine_rule: CoefficientCombine) -> Self {
        Self {
            combine_rule,
            ..self
        }
    }

    /// Checks the coefficient.
    ///
    /// # Errors
    /// [`InvalidValue`] if it is not between 0 and 1.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        let e = self.coefficient;
        InvalidValue::check_between((0.0, 1.0), "coefficient", e, "between 0 and 1")
    }
}

impl Floor {
    /// Combines the floor with the surface of a body. An invalid coefficient counts as absent.
    pub fn against(
        mut self,
        friction: Option<&Friction>,
        restitution: Option<&Restitution>,
    ) -> Self {
        if let Some(own) = friction.filter(|own| own.validate().is_ok()) {
            let mix = |a, b| own.combine_rule.mix(a, b);
            let holds = self.grip();
            self.friction = mix(self.friction, own.dynamic_coefficient);
            let holds = mix(holds, own.static_coefficient);
            self.static_friction = (holds > self.friction).then_some(holds);
        }
        if let Some(own) = restitution.filter(|own| own.validate().is_ok()) {
            self.restitution = own.combine_rule.mix(self.restitution, own.coefficient);
        }
        self
    }
}

#[cfg(test)]
mod tests;
