//! An owned, serializable force model, as scenes and files store it.

use box_physics::body::RigidBox;
use box_physics::error::InvalidValue;
use box_physics::force::{Dissipation, Forces, Frame, PointForce, Spring};
use glam::DVec3;
use serde::{Deserialize, Deserializer, Serialize};

use crate::limits::{self, MAX_ITEMS};

/// The owned counterpart of [`Forces`]: every term of the force model; 0 or empty means absent.
///
/// ```
/// use box_physics::prelude::*;
/// use box_scenarios::ForceSet;
/// let set = ForceSet { force: DVec3::X * 6.0, ..ForceSet::gravity(9.81) };
/// set.validate()?;
/// let body = RigidBox::cube(1.0, 2.0)?;
/// assert_eq!(set.forces(&body).acceleration, DVec3::new(3.0, -9.81, 0.0));
/// # Ok::<(), InvalidValue>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ForceSet {
    /// Gravity [m/s²], world axes.
    #[serde(deserialize_with = "limits::vector")]
    pub gravity: DVec3,
    /// Constant force at the center of mass \[N\], world axes.
    #[serde(deserialize_with = "limits::vector")]
    pub force: DVec3,
    /// c₁ [N s/m], ≥ 0: force −c₁ v.
    #[serde(deserialize_with = "limits::coefficient")]
    pub linear_drag: f64,
    /// k₂ [N s²/m²], ≥ 0: force −k₂ |v| v.
    #[serde(deserialize_with = "limits::coefficient")]
    pub quadratic_drag: f64,
    /// γ [1/s], ≥ 0: torque −γ L.
    #[serde(deserialize_with = "limits::coefficient")]
    pub angular_damping: f64,
    /// c_ω \[N m s\], ≥ 0: torque −c_ω ω.
    #[serde(deserialize_with = "limits::coefficient")]
    pub angular_drag: f64,
    /// Constant torque in body axes \[N m\].
    #[serde(deserialize_with = "limits::vector")]
    pub body_torque: DVec3,
    /// Constant torque in world axes \[N m\].
    #[serde(deserialize_with = "limits::vector")]
    pub world_torque: DVec3,
    /// Forces at body points.
    #[serde(deserialize_with = "points")]
    pub point_forces: Vec<PointForce>,
    /// Springs at body points.
    #[serde(deserialize_with = "springs")]
    pub springs: Vec<Spring>,
}

impl ForceSet {
    /// No forces.
    pub fn none() -> Self {
        Self::default()
    }

    /// Gravity alone, `g` [m/s²] downward (−y).
    pub fn gravity(g: f64) -> Self {
        Self {
            gravity: DVec3::new(0.0, -g, 0.0),
            ..Self::default()
        }
    }

    /// Adds a magnetic-like dipole `moment` (body axes) in a uniform `field` (world axes) with the torque (R µ) × B \[N
    /// m\]. It consists of the force B at the body point µ and −B at the center, a pure couple.
    #[must_use]
    pub fn with_dipole(mut self, moment: DVec3, field: DVec3) -> Self {
        let at = |body_point, force| PointForce {
            body_point,
            force,
            frame: Frame::World,
        };
        self.point_forces.push(at(moment, field));
        self.point_forces.push(at(DVec3::ZERO, -field));
        self
    }

    /// Adds a spring of zero natural length from `body_point` (body axes \[m\]) to `anchor` (world \[m\]) with
    /// `stiffness` [N/m] and `damping` [N s/m].
    #[must_use]
    pub fn with_spring(
        mut self,
        body_point: DVec3,
        anchor: DVec3,
        stiffness: f64,
        damping: f64,
    ) -> Self {
        self.springs.push(Spring {
            body_point,
            anchor,
            stiffness,
            damping,
        });
        self
    }

    /// The force model for the integrators, for `body`, whose mass converts the constant force to an acceleration.
    pub fn forces(&self, body: &RigidBox) -> Forces<'_> {
        Forces {
            acceleration: self.acceleration(body),
            dissipation: self.dissipation(),
            body_torque: self.body_torque,
            world_torque: self.world_torque,
            point_forces: &self.point_forces,
            springs: &self.springs,
        }
    }

    /// Gravity plus constant force divided by mass [m/s²], world axes.
    pub fn acceleration(&self, body: &RigidBox) -> DVec3 {
        self.gravity + self.force * body.inverse_mass()
    }

    /// The four dissipative coefficients.
    pub fn dissipation(&self) -> Dissipation {
        Dissipation {
            linear_drag: self.linear_drag,
            quadratic_drag: self.quadratic_drag,
            angular_damping: self.angular_damping,
            angular_drag: self.angular_drag,
            ..Dissipation::NONE
        }
    }

    /// Returns `true` if a torque or a state-dependent force acts (the integrators' wrench).
    pub fn has_wrench(&self) -> bool {
        self.body_torque != DVec3::ZERO
            || self.world_torque != DVec3::ZERO
            || !self.point_forces.is_empty()
            || !self.springs.is_empty()
    }

    /// Returns `true` if only gravity acts. The plugin's table then has no force components, and its loop is compiled
    /// for that case.
    pub fn is_gravity_alone(&self) -> bool {
        !self.has_wrench() && self.dissipation() == Dissipation::NONE && self.force == DVec3::ZERO
    }

    /// Checks that every number is finite and every coefficient ≥ 0.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first invalid field.
    pub fn validate(&self) -> Result<(), InvalidValue> {
        for (field, v) in [
            ("gravity", self.gravity),
            ("force", self.force),
            ("body_torque", self.body_torque),
            ("world_torque", self.world_torque),
        ] {
            finite(field, v)?;
        }
        for (field, value) in [
            ("linear_drag", self.linear_drag),
            ("quadratic_drag", self.quadratic_drag),
            ("angular_damping", self.angular_damping),
            ("angular_drag", self.angular_drag),
        ] {
            coefficient(field, value)?;
        }
        for p in &self.point_forces {
            finite("point_forces.body_point", p.body_point)?;
            finite("point_forces.force", p.force)?;
        }
        for s in &self.springs {
            finite("springs.body_point", s.body_point)?;
            finite("springs.anchor", s.anchor)?;
            coefficient("springs.stiffness", s.stiffness)?;
            coefficient("springs.damping", s.damping)?;
        }
        Ok(())
    }
}

fn finite(field: &'static str, v: DVec3) -> Result<(), InvalidValue> {
    match v.to_array().into_iter().find(|c| !c.is_finite()) {
        None => Ok(()),
        Some(value) => Err(InvalidValue {
            field,
            value,
            allowed: "finite",
        }),
    }
}

pub(crate) fn coefficient(field: &'static str, value: f64) -> Result<(), InvalidValue> {
    if value.is_finite() && value >= 0.0 {
        Ok(())
    } else {
        Err(InvalidValue {
            field,
            value,
            allowed: "finite and not negative",
        })
    }
}

// The fields of the force types of `box_physics` with limits, so that an error has the location of the value.

#[derive(Deserialize)]
#[serde(remote = "PointForce", rename = "PointForce", deny_unknown_fields)]
struct PointFields {
    #[serde(deserialize_with = "limits::vector")]
    body_point: DVec3,
    #[serde(deserialize_with = "limits::vector")]
    force: DVec3,
    #[serde(default)]
    frame: Frame,
}

#[derive(Deserialize)]
#[serde(remote = "Spring", rename = "Spring", deny_unknown_fields)]
struct SpringFields {
    #[serde(deserialize_with = "limits::vector")]
    body_point: DVec3,
    #[serde(deserialize_with = "limits::vector")]
    anchor: DVec3,
    #[serde(deserialize_with = "limits::coefficient")]
    stiffness: f64,
    #[serde(default, deserialize_with = "limits::coefficient")]
    damping: f64,
}

fn points<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<PointForce>, D::Error> {
    #[derive(Deserialize)]
    #[serde(transparent)]
    struct Item(#[serde(deserialize_with = "PointFields::deserialize")] PointForce);
    let items = limits::at_most(from, MAX_ITEMS)?;
    Ok(items.into_iter().map(|Item(force)| force).collect())
}

fn springs<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Spring>, D::Error> {
    #[derive(Deserialize)]
    #[serde(transparent)]
    struct Item(#[serde(deserialize_with = "SpringFields::deserialize")] Spring);
    let items = limits::at_most(from, MAX_ITEMS)?;
    Ok(items.into_iter().map(|Item(spring)| spring).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn everything() -> ForceSet {
        ForceSet {
            force: DVec3::new(1.0, 2.0, 3.0),
            linear_drag: 0.1,
            quadratic_drag: 0.2,
            angular_damping: 0.3,
            angular_drag: 0.4,
            body_torque: DVec3::X,
            world_torque: DVec3::Y,
            ..ForceSet::gravity(9.81)
        }
        .with_dipole(DVec3::X, DVec3::Y)
        .with_spring(DVec3::Z, DVec3::ONE, 5.0, 0.5)
    }

    #[test]
    fn round_trip_through_text() {
        let set = everything();
        set.validate().expect("valid");
        let text = serde_json::to_string(&set).expect("plain data");
        assert_eq!(
            serde_json::from_str::<ForceSet>(&text).expect("own text"),
            set
        );
        assert_eq!(
            serde_json::from_str::<ForceSet>("{}").expect("all optional"),
            ForceSet::none()
        );
        assert!(serde_json::from_str::<ForceSet>(r#"{"drag": 1}"#).is_err());
    }

    #[test]
    fn bad_values_are_named() {
        let mut set = everything();
        set.springs[0].stiffness = -1.0;
        assert_eq!(
            set.validate().expect_err("bad").to_string(),
            "springs.stiffness must be finite and not negative, but is -1"
        );
        set = everything();
        set.gravity.y = f64::NAN;
        assert_eq!(set.validate().expect_err("bad").field, "gravity");
    }
}
