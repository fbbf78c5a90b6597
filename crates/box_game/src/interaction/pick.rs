//! Intersection of a ray with the box, in f64 and with the body's geometry instead of its mesh.

use box_physics::prelude::{BodyState, DVec3, RigidBox};

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// The point, body axes from the center \[m\].
    pub point: DVec3,
    /// Outward normal of the face, body axes.
    pub normal: DVec3,
}

/// The first point of `body` at `state` on the ray from `origin` \[m\] along `direction`. `None` if the ray misses,
/// starts inside or has no direction. The slab method (Kay and Kajiya 1986) in body axes: the ray is inside the box
/// where it is inside all three pairs of planes.
pub(crate) fn hit(
    body: &RigidBox,
    state: &BodyState,
    origin: DVec3,
    direction: DVec3,
) -> Option<Hit> {
    let to_body = state.rotation.inverse();
    let from = to_body * (origin - state.position);
    let along = to_body * direction;
    let half = body.half_extents();
    // The parameters at which the ray crosses each plane; infinite for a parallel plane.
    let (low, high) = ((-half - from) / along, (half - from) / along);
    let (enter, leave) = (low.min(high), low.max(high));
    let axis = enter.max_position();
    let (enter, leave) = (enter[axis], leave.min_element());
    let met = enter >= 0.0 && enter <= leave && enter.is_finite();
    met.then(|| Hit {
        point: (from + enter * along).clamp(-half, half),
        normal: -along[axis].signum() * DVec3::AXES[axis],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use box_physics::prelude::DQuat;

    fn body() -> RigidBox {
        RigidBox::new(DVec3::new(0.5, 0.25, 0.125), 3.0).expect("valid")
    }

    #[test]
    fn faces_edges_and_misses() {
        let (body, state) = (body(), BodyState::at(DVec3::new(1.0, 2.0, 3.0)));
        let look = |from: DVec3, along: DVec3| hit(&body, &state, state.position + from, along);
        let front = look(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z).expect("in front");
        assert_eq!(front.normal, DVec3::Z);
        assert!((front.point - DVec3::new(0.1, 0.2, 0.125)).length() < 1e-12);
        for (from, along, why) in [
            (DVec3::new(0.6, 0.0, 5.0), DVec3::NEG_Z, "beside"),
            (DVec3::Z * 5.0, DVec3::Z, "behind"),
            (DVec3::ZERO, DVec3::Z, "inside"),
            (DVec3::Z * 5.0, DVec3::ZERO, "nowhere"),
        ] {
            assert_eq!(look(from, along), None, "{why}");
        }
    }

    #[test]
    fn a_turned_box_is_met_in_its_own_axes() {
        let quarter = DQuat::from_xyzw(0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt());
        let state = BodyState::at_pose(DVec3::ZERO, quarter);
        // The long side is now upright: x of the body is y of the world.
        let met = hit(&body(), &state, DVec3::Y * 3.0, DVec3::NEG_Y).expect("from above");
        assert_eq!(met.normal, DVec3::X);
        assert!((met.point - DVec3::X * 0.5).length() < 1e-12);
    }
}
