//! Bodies and starts shared by several scenes.

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::DVec3;

/// Gravitational acceleration of the scenes [m/s²].
pub const GRAVITY: f64 = 9.81;

/// A solid box of half-extents `half` \[m\] and `mass` \[kg\], both known to be valid.
pub(super) fn solid(half: [f64; 3], mass: f64) -> RigidBox {
    RigidBox::new(DVec3::from_array(half), mass)
        .expect("the numbers of a built-in scene are valid: a test builds every one")
}

/// The box with three different moments that most scenes use: edges of 1, 0.5 and 0.25 m, 3 kg.
pub(super) fn brick() -> RigidBox {
    solid([0.5, 0.25, 0.125], 3.0)
}

/// A state at `position` \[m\] with body angular velocity `spin` [rad/s].
pub(super) fn spinning(body: &RigidBox, position: [f64; 3], spin: [f64; 3]) -> BodyState {
    BodyState::at(DVec3::from_array(position))
        .with_body_angular_velocity(body, DVec3::from_array(spin))
}
