//! The box itself: size, mass, inertia and the constants that the integrators precompute.

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::DVec3;

use crate::error::InvalidValue;
use crate::rotation::SplitFrame;

const SIZE_LIMITS: (f64, f64) = (1e-6, 1e6);
const MASS_LIMITS: (f64, f64) = (1e-12, 1e12);
/// Limits of a moment \[kg m²\]. Solid boxes within the limits above have moments from 6e-25 to 7e23 kg m².
const INERTIA_LIMITS: (f64, f64) = (1e-25, 1e25);
/// Largest allowed ratio of the largest moment to the smallest. A needle of 1e-6 by 1e6 m has 5e23.
const INERTIA_RATIO: f64 = 1e25;

/// A rigid box: the component that makes an entity a simulated body.
///
/// The box axes are the principal axes, so the inertia is a diagonal. The other components of a body
/// ([`BodyState`](crate::state::BodyState), `Transform`, …) are required components.
///
/// ```
/// use box_physics::prelude::*;
/// let brick = RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)?;
/// // I_x = m/3 (h_y² + h_z²)
/// assert_eq!(brick.inertia().x, 0.078_125);
/// # Ok::<(), InvalidValue>(())
/// ```
///
/// You can replace the component while the body moves. Position, velocity and *angular momentum* stay the
/// same, so a box that becomes larger turns more slowly. `Transform::scale` only scales the rendered mesh.
///
/// The type is opaque to reflection, because its numbers depend on one another. With the feature `serde` it
/// is serialized as `half_extents`, `mass` and `inertia`, and checked on loading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(opaque),
    reflect(Component, Default, Clone, PartialEq, Debug)
)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "serialized::BoxFields", into = "serialized::BoxFields")
)]
#[cfg_attr(
    all(feature = "bevy", feature = "serde"),
    reflect(Serialize, Deserialize)
)]
pub struct RigidBox {
    half_extents: DVec3,
    mass: f64,
    inverse_mass: f64,
    inertia: DVec3,
    inverse_inertia: DVec3,
    splitting: Splitting,
}

impl RigidBox {
    /// Creates a solid box of uniform density.
    ///
    /// `half_extents` \[m\] are the distances from the center to the faces, each between 1e-6 and 1e6. `mass` \[kg\] is
    /// between 1e-12 and 1e12.
    ///
    /// # Errors
    /// [`InvalidValue`] names the first field out of range.
    pub fn new(half_extents: impl Into<DVec3>, mass: f64) -> Result<Self, InvalidValue> {
        let h = half_extents.into();
        for (field, value) in [
            ("half_extents.x", h.x),
            ("half_extents.y", h.y),
            ("half_extents.z", h.z),
        ] {
            let allowed = "finite and between 1e-6 and 1e6 m";
            InvalidValue::check_between(SIZE_LIMITS, field, value, allowed)?;
        }
        let allowed = "finite and between 1e-12 and 1e12 kg";
        InvalidValue::check_between(MASS_LIMITS, "mass", mass, allowed)?;
        // Solid cuboid: I_x = m/3 (h_y² + h_z²), cyclic.
        let squares = h * h;
        let inertia = (mass / 3.0)
            * DVec3::new(
                squares.y + squares.z,
                squares.z + squares.x,
                squares.x + squares.y,
            );
        Ok(Self::from_parts(h, mass, inertia))
    }

    /// Creates a solid cube of mass `mass` \[kg\] with edges of length `edge` \[m\], twice the half-extent.
    ///
    /// # Errors
    /// The same as [`RigidBox::new`].
    pub fn cube(edge: f64, mass: f64) -> Result<Self, InvalidValue> {
        Self::new(DVec3::splat(0.5 * edge), mass)
    }

    /// Replaces the principal inertia \[kg m²\], for hollow or weighted boxes.
    ///
    /// # Errors
    /// [`InvalidValue`] if a moment is not between 1e-25 and 1e25 kg m², or is less than 1e-25 of the
    /// largest. Also if a moment exceeds the sum of the other two by more than rounding, which no
    /// distribution of mass can have.
    pub fn with_inertia(self, inertia: impl Into<DVec3>) -> Result<Self, InvalidValue> {
        let i = inertia.into();
        for (field, value, others) in [
            ("inertia.x", i.x, i.y + i.z),
            ("inertia.y", i.y, i.z + i.x),
            ("inertia.z", i.z, i.x + i.y),
        ] {
            let allowed = "finite and between 1e-25 and 1e25 kg m²";
            InvalidValue::check_between(INERTIA_LIMITS, field, value, allowed)?;
            let ok = i.max_element() <= INERTIA_RATIO * value;
            InvalidValue::check(ok, field, value, "at least 1e-25 of the largest moment")?;
            let allowed = "at most the sum of the other two moments";
            InvalidValue::check(value <= others * (1.0 + 1e-9), field, value, allowed)?;
        }
        Ok(Self::from_parts(self.half_extents, self.mass, i))
    }

    fn from_parts(half_extents: DVec3, mass: f64, inertia: DVec3) -> Self {
        let inverse_inertia = inertia.recip();
        Self {
            half_extents,
            mass,
            inverse_mass: 1.0 / mass,
            inertia,
            inverse_inertia,
            splitting: Splitting::new(inertia, inverse_inertia),
        }
    }

    /// Distance from the center to each face \[m\].
    pub fn half_extents(&self) -> DVec3 {
        self.half_extents
    }

    /// Mass \[kg\].
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// 1/mass [1/kg].
    pub fn inverse_mass(&self) -> f64 {
        self.inverse_mass
    }

    /// Principal moments of inertia about the body axes \[kg m²\].
    pub fn inertia(&self) -> DVec3 {
        self.inertia
    }

    /// Reciprocals of the principal moments [1/(kg m²)].
    pub fn inverse_inertia(&self) -> DVec3 {
        self.inverse_inertia
    }

    /// Distance from the center to a corner \[m\]: the radius of the bounding sphere.
    pub fn radius(&self) -> f64 {
        self.half_extents.length()
    }

    /// The splitting of the free rotation into planar rotations.
    pub(crate) fn splitting(&self) -> &Splitting {
        &self.splitting
    }
}

impl Default for RigidBox {
    /// A solid cube of 1 m and 1 kg.
    fn default() -> Self {
        let inertia = DVec3::splat(1.0 / 6.0);
        Self::from_parts(DVec3::splat(0.5), 1.0, inertia)
    }
}

#[cfg(feature = "serde")]
mod serialized {
    //! Serialized fields of a box, without those that are computed from them. Loading applies the checks of the
    //! constructors.

    use glam::DVec3;

    use super::RigidBox;
    use crate::error::InvalidValue;

    #[derive(serde::Serialize, serde::Deserialize)]
    #[serde(rename = "RigidBox", deny_unknown_fields)]
    pub(super) struct BoxFields {
        half_extents: DVec3,
        mass: f64,
        /// The inertia of a solid box if absent.
        #[serde(default)]
        inertia: Option<DVec3>,
    }

    impl From<RigidBox> for BoxFields {
        fn from(body: RigidBox) -> Self {
            Self {
                half_extents: body.half_extents,
                mass: body.mass,
                inertia: Some(body.inertia),
            }
        }
    }

    impl TryFrom<BoxFields> for RigidBox {
        type Error = InvalidValue;

        fn try_from(fields: BoxFields) -> Result<Self, InvalidValue> {
            let solid = Self::new(fields.half_extents, fields.mass)?;
            fields
                .inertia
                .map_or(Ok(solid), |inertia| solid.with_inertia(inertia))
        }
    }
}

/// Axes and coefficients of the splitting of the free rotation: two planar rotations and an exact rotation (Fassò
/// 2003).
///
/// H = |L|²/2I_r + ½(J_a−J_r) L_a² + ½(J_c−J_r) L_c², J = 1/I. The first term is a Casimir times a constant, so its
/// flow commutes with the other two. r is the axis of the middle moment. The outer axis a (two half steps) is the one
/// with the larger |J_a − J_r|. This rule minimizes the leading error term |αβ|(|α|/24 + |β|/12) over all choices
/// (checked numerically for 20 000 random boxes).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Splitting {
    /// The axis rotated by two half steps, and the axis rotated by one whole step between them.
    pub(crate) frame: SplitFrame,
    /// J_r = 1/I_r of the reference (middle) axis.
    pub(crate) reference: f64,
    /// α = J_outer − J_r
    pub(crate) alpha: f64,
    /// β = J_inner − J_r
    pub(crate) beta: f64,
}

impl Splitting {
    fn new(inertia: DVec3, inverse: DVec3) -> Self {
        let (i, j) = (inertia.to_array(), inverse.to_array());
        let mut axes = [0_usize, 1, 2];
        axes.sort_by(|&a, &b| i[a].total_cmp(&i[b]));
        let [low, middle, high] = axes;
        // J_a − J_r = (I_r − I_a)/(I_a I_r): no cancellation of reciprocals.
        let difference = |a: usize| (i[middle] - i[a]) * (j[a] * j[middle]);
        let (outer, inner) = if difference(low).abs() >= difference(high).abs() {
            (low, high)
        } else {
            (high, low)
        };
        Self {
            frame: SplitFrame::new(outer, inner),
            reference: j[middle],
            alpha: difference(outer),
            beta: difference(inner),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solid_cuboid_inertia() {
        let body = RigidBox::new(DVec3::new(1.0, 2.0, 3.0), 6.0).expect("valid");
        assert_eq!(body.inertia(), DVec3::new(26.0, 20.0, 10.0));
        assert_eq!(body.inverse_mass(), 1.0 / 6.0);
        assert_eq!(
            RigidBox::cube(1.0, 1.0).expect("valid"),
            RigidBox::default()
        );
    }

    #[test]
    fn bad_values_are_named() {
        let message = |h: DVec3, m| RigidBox::new(h, m).unwrap_err().to_string();
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
            assert!(message(DVec3::new(1.0, 1.0, bad), 1.0).starts_with("half_extents.z must be"));
            assert!(message(DVec3::new(bad, 1.0, 1.0), 1.0).contains(&format!("but is {bad}")));
        }
        for bad in [0.0, -2.0, f64::NAN, f64::NEG_INFINITY, 1e13] {
            assert!(message(DVec3::ONE, bad).starts_with("mass must be"));
        }
        let cube = RigidBox::default();
        assert!(cube.with_inertia(DVec3::new(1.0, 1.0, 2.1)).is_err());
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320, 1e-26, 1e26] {
            let error = cube.with_inertia(DVec3::new(bad, 1.0, 1.0)).unwrap_err();
            assert!(
                error.to_string().starts_with("inertia.x must be"),
                "{error}"
            );
        }
        let error = cube.with_inertia(DVec3::new(1e-3, 1e23, 1e23)).unwrap_err();
        assert!(error.to_string().contains("at least 1e-25 of the largest"));
        assert_eq!(
            cube.with_inertia(DVec3::ONE).expect("valid").inertia(),
            DVec3::ONE
        );
    }

    #[test]
    fn split_axes_follow_the_rule() {
        // Box 4:2:1: I_x < I_y < I_z, J decreases. The outer axis is x, which has the larger gap.
        let s = *RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0)
            .expect("valid")
            .splitting();
        assert_eq!(s.frame, SplitFrame::new(0, 2));
        assert!(s.alpha > 0.0 && s.beta < 0.0 && s.alpha.abs() >= s.beta.abs());
        // Nothing is left to split for a cube, and only one term for a square bar.
        let s = *RigidBox::default().splitting();
        assert_eq!((s.alpha, s.beta), (0.0, 0.0));
        let s = *RigidBox::new(DVec3::new(0.25, 0.5, 0.25), 6.0)
            .expect("valid")
            .splitting();
        assert_eq!((s.frame.outer(), s.beta), (1, 0.0));
    }
}
