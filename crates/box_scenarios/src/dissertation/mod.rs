//! The dissertation's demo of 2012 as it computed: its three integrators, its pushes and its contact.
//!
//! This is a reproduction, separate from the integrators of `box_physics`. Nearly every line of it is physically wrong;
//! its purpose is to show by how much. Source: V. Stojanovic, *Evaluation of Numerical Integration Methods for
//! Simulation of Simple 3D Rigid Body Motion Within a Game Environment*, 2012 (text and listing). One cycle of the
//! demo, of length h \[s\]:
//!
//! ```text
//! v, x      by the integrator, with the acceleration a left by the last push
//! x        += h · (0, −9.81, 0)           gravity is added to the position: a speed, not an acceleration
//! ω        += α / 60                      for any h; no gyroscopic term
//! q         ← q ∘ Rx(h ωx) ∘ Ry(h ωy) ∘ Rz(h ωz)          three successive rotations
//! v, ω     *= 1 − 0.005 · (1000 h)        damping per millisecond
//! contact   bounding box against the plane: see [`contact`]
//! ```
//!
//! The simplest interpretation is used for details that the text does not specify:
//!
//! - The acceleration is constant, so k₁ = k₂ = k₃ = k₄ and the three integrators give the same velocity to
//!   rounding. [`Demo::drag`] (0 in the demo) adds the −c v of the text's analysis.
//! - The acceleration of a push persists until the next push *replaces* it: if it ended by itself, there would
//!   be nothing to replace. Because of the damping, the earlier motion is gone after a few tenths of a second.
//! - Explicit Euler moves the position by the old velocity, as in textbooks; Heun and RK4 by the new one.
//! - The three rotations are about the box's own axes, in the order x, y, z, by the angles h·ω.
//! - The inertia is 0.83 m (a² + b²) with half-extents for a and b: the listing's sizes are not those of the
//!   box, and this is the most common mistake.
//! - The contact moves the box half of the way out of the floor per cycle ([`LERP`]).

use box_physics::aabb::world_half_extents;
use box_physics::body::RigidBox;
use box_physics::math::sin_cos;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

/// Displacement per second that the demo adds to the position \[m/s\]: the value of an acceleration, used as a
/// velocity.
pub const FALL: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// Factor in I = factor · m (a² + b²), used in place of 1/12 for a box.
pub const INERTIA_FACTOR: f64 = 0.83;

/// Time by which a cycle multiplies the angular acceleration \[s\], for any length of the cycle.
pub const SPIN_STEP: f64 = 1.0 / 60.0;

/// Loss of velocity and spin per **millisecond** of the cycle \[1/ms\].
pub const DAMPING_PER_MS: f64 = 0.005;

/// Fraction of the penetration depth by which the contact lifts the box per cycle, 0 to 1.
pub const LERP: f64 = 0.5;

/// The integrators of the demo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stepper {
    /// x += h v, v += h f(v).
    ExplicitEuler,
    /// The text's implicit Euler: k₁ = f(v), k₂ = f(v + h k₁), v += h/2 (k₁ + k₂), x += h v_new. It is actually Heun's
    /// explicit method.
    #[default]
    Heun,
    /// The four classical stages for v; x += h v_new.
    Rk4,
}

impl Stepper {
    /// All three integrators.
    pub const ALL: [Self; 3] = [Self::ExplicitEuler, Self::Heun, Self::Rk4];

    /// Identifier on the command line.
    pub const fn id(self) -> &'static str {
        match self {
            Self::ExplicitEuler => "2012-explicit-euler",
            Self::Heun => "2012-heun",
            Self::Rk4 => "2012-rk4",
        }
    }

    /// Display name, with the correct name of the method.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ExplicitEuler => "Explicit Euler (2012)",
            Self::Heun => "Heun, called implicit Euler (2012)",
            Self::Rk4 => "RK4 (2012)",
        }
    }

    /// The error of the integrator, in one sentence.
    pub const fn fault(self) -> &'static str {
        match self {
            Self::ExplicitEuler => {
                "First order, and the spin is not integrated at all: ω grows by α/60 per step at any step size."
            }
            Self::Heun => {
                "Called implicit, but explicit: stable only for c·dt/m ≤ 2, like Euler; and x += h·v_new reduces its order from 2 to 1."
            }
            Self::Rk4 => {
                "Four evaluations of a constant acceleration; x += h·v_new reduces it to first order."
            }
        }
    }

    /// Evaluations of f per cycle.
    pub const fn evaluations(self) -> u32 {
        match self {
            Self::ExplicitEuler => 1,
            Self::Heun => 2,
            Self::Rk4 => 4,
        }
    }

    /// Velocity and displacement after `h` \[s\] from `v` \[m/s\] under the acceleration `f(v)` [m/s²].
    #[inline]
    pub fn advance(self, v: DVec3, h: f64, f: impl Fn(DVec3) -> DVec3) -> (DVec3, DVec3) {
        match self {
            Self::ExplicitEuler => (v + h * f(v), h * v),
            Self::Heun => {
                let k1 = f(v);
                let k2 = f(v + h * k1);
                let new = v + (0.5 * h) * (k1 + k2);
                (new, h * new)
            }
            Self::Rk4 => {
                let k1 = f(v);
                let k2 = f(v + (0.5 * h) * k1);
                let k3 = f(v + (0.5 * h) * k2);
                let k4 = f(v + h * k3);
                let new = v + (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4);
                (new, h * new)
            }
        }
    }
}

/// The box of the demo and the constants of its force model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demo {
    /// Mass \[kg\]; the demo's cube has 10.
    pub mass: f64,
    /// Half-extents \[m\].
    pub half_extents: DVec3,
    /// c/m in f(v) = a − (c/m) v [1/s]; 0 in the demo, although its text analyzes the other case.
    pub drag: f64,
    /// Height of the floor \[m\], or `None` for no floor.
    pub floor: Option<f64>,
}

impl Default for Demo {
    /// The cube of the demo: edge 1 m, 10 kg, over the plane y = 0.
    fn default() -> Self {
        Self {
            mass: 10.0,
            half_extents: DVec3::splat(0.5),
            drag: 0.0,
            floor: Some(0.0),
        }
    }
}

impl Demo {
    /// The demo's force model for a box of this library, with the floor at `floor` \[m\].
    pub fn of(body: &RigidBox, floor: Option<f64>) -> Self {
        Self {
            mass: body.mass(),
            half_extents: body.half_extents(),
            drag: 0.0,
            floor,
        }
    }

    /// Moments of inertia by which the demo divides a torque [kg m²].
    pub fn inertia(&self) -> DVec3 {
        let s = self.half_extents * self.half_extents;
        INERTIA_FACTOR * self.mass * DVec3::new(s.y + s.z, s.z + s.x, s.x + s.y)
    }

    /// Runs one cycle of `h` \[s\] with `stepper`, including contact.
    pub fn cycle(&self, stepper: Stepper, state: &mut State, h: f64) {
        let (a, drag) = (state.acceleration, self.drag);
        let (velocity, displacement) = stepper.advance(state.velocity, h, |v| a - drag * v);
        state.velocity = velocity;
        state.position += displacement + h * FALL;
        state.spin += SPIN_STEP * state.angular_acceleration;
        state.rotation = (state.rotation * three_turns(h * state.spin)).normalize();
        let kept = damping(h);
        state.velocity *= kept;
        state.spin *= kept;
        if let Some(height) = self.floor {
            contact(state, self.half_extents, height);
        }
    }

    /// Applies a push. The accelerations of the last push are **replaced** by those of `force` \[N\] (world axes) at
    /// the body point `at` \[m\] (body axes).
    pub fn push(&self, state: &mut State, force: DVec3, at: DVec3) {
        state.acceleration = force / self.mass;
        let torque = at.cross(state.rotation.inverse() * force);
        state.angular_acceleration = torque / self.inertia();
    }

    /// The force \[N\] whose push ends, damped, in the velocity that the impulse `impulse` \[N s\] would give in this
    /// library. In the limit of short cycles the damping rate is 5 1/s.
    pub fn force_for(impulse: DVec3) -> DVec3 {
        impulse * (DAMPING_PER_MS * 1000.0)
    }
}

/// State of the demo's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Center \[m\].
    pub position: DVec3,
    /// Attitude, body to world.
    pub rotation: DQuat,
    /// Velocity [m/s], world axes.
    pub velocity: DVec3,
    /// Angular velocity [rad/s], body axes.
    pub spin: DVec3,
    /// Acceleration left by the last push [m/s²], world axes.
    pub acceleration: DVec3,
    /// Angular acceleration left by the last push [rad/s²], body axes.
    pub angular_acceleration: DVec3,
}

impl State {
    /// Converts a state of this library, without accelerations.
    pub fn new(body: &RigidBox, state: &BodyState) -> Self {
        Self {
            position: state.position,
            rotation: state.rotation,
            velocity: state.velocity,
            spin: state.body_angular_velocity(body),
            acceleration: DVec3::ZERO,
            angular_acceleration: DVec3::ZERO,
        }
    }

    /// Converts to a state of this library, for display and measurement.
    pub fn body_state(&self, body: &RigidBox) -> BodyState {
        BodyState::at_pose(self.position, self.rotation)
            .with_velocity(self.velocity)
            .with_body_angular_velocity(body, self.spin)
    }
}

/// Factor by which a cycle of `h` \[s\] multiplies velocity and spin: 1 − 0.005·(1000 h). It is negative above 0.2 s
/// and below −1 above 0.4 s, where the motion grows without limit.
pub fn damping(h: f64) -> f64 {
    1.0 - DAMPING_PER_MS * (1000.0 * h)
}

/// The demo's contact. It is a separate function because it uses neither velocity nor mass.
///
/// The bounding box of the cube, refitted to its attitude (half-height |R|·h, exact), is compared with the plane y =
/// `height` \[m\]. If it penetrates, the center moves by linear interpolation ([`LERP`]) toward the position in which
/// the bounding box stands on the plane, and a fall stops (v_y ≥ 0). There is no bounce, no friction and no torque: a
/// tilted cube stands on its corner. Since gravity moves the position every cycle, a cube at rest stands 9.81 h (1 −
/// LERP)/LERP deep in the floor.
pub fn contact(state: &mut State, half_extents: DVec3, height: f64) {
    let half_height = world_half_extents(state.rotation, half_extents).y;
    let standing = height + half_height;
    if state.position.y < standing {
        state.position.y += LERP * (standing - state.position.y);
        state.velocity.y = state.velocity.y.max(0.0);
    }
}

/// Rotations about x, y and z, one after the other, by these angles \[rad\].
fn three_turns(angles: DVec3) -> DQuat {
    let about = |axis: DVec3, angle: f64| {
        let (s, c) = sin_cos(0.5 * angle);
        DQuat::from_xyzw(s * axis.x, s * axis.y, s * axis.z, c)
    };
    about(DVec3::X, angles.x) * about(DVec3::Y, angles.y) * about(DVec3::Z, angles.z)
}

#[cfg(test)]
mod tests;
