//! Contact memory of a body, and the contact report of a step.

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::{DMat3, DQuat, DVec3};

use super::geometry::{Corners, each};
use super::{Floor, FloorContext};
use crate::body::RigidBox;
use crate::force::{Dissipation, ForceModel, Wrench, wrench_of};
use crate::integrators::IntegratorMemory;
use crate::state::BodyState;

/// Contact memory of a body between steps: the touching corners, and the inputs with which it came to rest. A box rests
/// only as long as pose, velocities, body, floor and forces equal these bit for bit. An empty memory is always valid.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::floor::ContactState;
/// use box_physics::prelude::*;
/// /// Returns `true` when the throw is over.
/// fn all_rest(dice: Query<(&BodyState, &ContactState)>) -> bool {
///     dice.iter().all(|(state, contact)| contact.is_resting(state))
/// }
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "bevy",
    derive(Component, Reflect),
    reflect(opaque),
    reflect(Component, Default, Clone, PartialEq, Debug)
)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    all(feature = "bevy", feature = "serde"),
    reflect(Serialize, Deserialize)
)]
pub struct ContactState {
    pub(super) touching: u8,
    pub(super) rest: Option<Rest>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) spare: Spare,
}

/// Integrator memories for trial segments, reused for their allocations.
#[derive(Debug, Default)]
pub(super) struct Spare(pub(super) [IntegratorMemory; 2]);

impl Clone for Spare {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for Spare {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The inputs with which the box came to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rest {
    pub(super) position: DVec3,
    rotation: DQuat,
    half_extents: DVec3,
    mass: f64,
    acceleration: DVec3,
    /// A moving floor carries the box through the air.
    dissipation: Dissipation,
    wrench: Wrench,
    floor: Floor,
    /// For several planes, or for one other than the floor: a fingerprint of all planes, or of the supporting ones, and
    /// the normal for the report.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) planes: Option<(u64, DVec3)>,
    /// Height of the center over the floor \[m\].
    above: f64,
    /// The floor's force at each corner \[N\], for the report.
    pub(super) reaction: [f64; 8],
}

impl Rest {
    #[inline]
    fn is_of(&self, state: &BodyState) -> bool {
        self.position == state.position
            && self.rotation == state.rotation
            && state.velocity == self.floor.velocity
            && state.angular_momentum == DVec3::ZERO
    }
}

impl ContactState {
    /// Corners that touched the floor at the end of the last step; bit k is corner k.
    pub fn touching(&self) -> u8 {
        self.touching
    }

    /// Returns `true` if the last step left the box at rest in `state`. Writing another state makes this `false` at once.
    pub fn is_resting(&self, state: &BodyState) -> bool {
        self.rest.as_ref().is_some_and(|rest| rest.is_of(state))
    }

    /// Returns `true` if the box still rests, because no input has changed.
    #[inline]
    pub(super) fn still_rests<F: ForceModel>(
        &self,
        context: &FloorContext<'_, F>,
        planes: Option<u64>,
        state: &BodyState,
    ) -> bool {
        let (body, force) = (context.body, context.force);
        let Some(rest) = &self.rest else {
            return false;
        };
        rest.is_of(state)
            && rest.acceleration == force.acceleration()
            && rest.dissipation == force.dissipation()
            && rest.floor == *context.floor
            && rest.planes.map(|(fingerprint, _)| fingerprint) == planes
            && rest.half_extents == body.half_extents()
            && rest.mass == body.mass()
            && rest.wrench == wrench_of(body, state, force)
    }

    /// Moves a box at rest with the floor for `h` \[s\]. Its height over the floor is constant to the last bit.
    #[inline]
    pub(super) fn ride(&mut self, state: &mut BodyState, h: f64) {
        let Some(rest) = &mut self.rest else { return };
        if rest.floor.velocity != DVec3::ZERO && h > 0.0 && h.is_finite() {
            rest.floor.advance(h);
            state.position += rest.floor.velocity * h;
            state.position.y = rest.floor.height + rest.above;
            rest.position = state.position;
        }
    }

    /// Reports a step of `h` \[s\] at rest.
    pub(super) fn report_rest(
        &self,
        body: &RigidBox,
        state: &BodyState,
        h: f64,
        report: Option<&mut ContactReport>,
    ) {
        let (Some(report), Some(rest)) = (report, &self.rest) else {
            return;
        };
        let corners = Corners::turned(body, DMat3::from_quat(state.rotation));
        let point = |k| state.position + corners.lever(k);
        report.normal = rest.planes.map_or(DVec3::Y, |(_, normal)| normal);
        report.hold(point, h, &rest.reaction);
        report.end(point, self.touching);
    }

    /// Stores that the box is at rest at the end of a step of `h` \[s\], with these forces \[N\] at its corners.
    pub(super) fn establish_rest<F: ForceModel>(
        &mut self,
        context: &FloorContext<'_, F>,
        planes: Option<(u64, DVec3)>,
        state: &BodyState,
        h: f64,
        reaction: [f64; 8],
    ) {
        let (body, force) = (context.body, context.force);
        let mut floor = *context.floor;
        floor.advance(h);
        self.rest = Some(Rest {
            position: state.position,
            rotation: state.rotation,
            half_extents: body.half_extents(),
            mass: body.mass(),
            acceleration: force.acceleration(),
            dissipation: force.dissipation(),
            wrench: wrench_of(body, state, force),
            floor,
            planes,
            above: state.position.y - floor.height,
            reaction,
        });
    }
}

/// Contact of a body with the floor or planes in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
pub struct ContactReport {
    /// Corners at which the floor acted, or which touch it at the end; bit k is corner k of [`crate::aabb::corners`].
    pub corners: u8,
    /// Last point of contact of each of these corners in the world \[m\].
    pub points: [DVec3; 8],
    /// Impulse along the normal at each corner \[N s\], ≥ 0; the sum for a corner that touches several planes.
    pub normal_impulses: [f64; 8],
    /// The unit normal: +y at the floor. For several planes, the direction of the sum of their impulses.
    pub normal: DVec3,
    /// Friction impulse on the body \[N s\], world axes; 0 for a box at rest.
    pub tangential_impulse: DVec3,
    /// Largest normal speed at which a corner hit the surface [m/s]; 0 without an impact.
    pub approach_speed: f64,
    /// Time of the first impact since the beginning of the step \[s\]; 0 without an impact.
    pub impact_time: f64,
}

impl Default for ContactReport {
    fn default() -> Self {
        Self {
            corners: 0,
            points: [DVec3::ZERO; 8],
            normal_impulses: [0.0; 8],
            normal: DVec3::Y,
            tangential_impulse: DVec3::ZERO,
            approach_speed: 0.0,
            impact_time: 0.0,
        }
    }
}

impl ContactReport {
    /// Impulse along the normal on the body \[N s\], ≥ 0.
    pub fn normal_impulse(&self) -> f64 {
        self.normal_impulses.iter().sum()
    }

    /// The center of the contact in the world \[m\]: the mean of its points, weighted by their impulses.
    pub fn point(&self) -> DVec3 {
        let total = self.normal_impulse();
        let weight = |k: usize| match total {
            0.0 => f64::from(self.corners >> k & 1) / f64::from(self.corners.count_ones().max(1)),
            total => self.normal_impulses[k] / total,
        };
        (0..8).map(|k| self.points[k] * weight(k)).sum()
    }

    /// Records an impact at `time` \[s\] in the step, with this normal speed [m/s].
    pub(super) fn strike(&mut self, time: f64, speed: f64) {
        if self.approach_speed == 0.0 {
            self.impact_time = time;
        }
        self.approach_speed = self.approach_speed.max(speed);
    }

    /// Adds a normal impulse at corner `k`, which is at `point`.
    pub(super) fn push(&mut self, k: usize, point: DVec3, impulse: f64) {
        self.normal_impulses[k] += impulse;
        self.points[k] = point;
        self.corners |= 1 << k;
    }

    /// Adds the impulses of forces \[N\] at the corners over `h` \[s\].
    pub(super) fn hold(&mut self, point: impl Fn(usize) -> DVec3, h: f64, load: &[f64; 8]) {
        for k in (0..8).filter(|&k| load[k] != 0.0) {
            self.push(k, point(k), load[k] * h);
        }
    }

    /// Ends the step with these corners touching.
    pub(super) fn end(&mut self, point: impl Fn(usize) -> DVec3, touching: u8) {
        self.corners |= touching;
        for k in each(touching.into()) {
            self.points[k] = point(k);
        }
    }
}
