//! What the contact remembers of a body, and what it reports.

#[cfg(feature = "bevy")]
use crate::ecs::*;
use glam::{DQuat, DVec3};

use super::geometry::{Corner3, Corners, has};
use super::{Floor, FloorContext};
use crate::body::RigidBox;
use crate::force::{ForceModel, Wrench};
use crate::integrators::IntegratorMemory;
use crate::state::BodyState;

/// What the contact remembers of one body between steps: which corners touch, and for which state and
/// forces it was found to lie still. It is checked, not trusted: a box lies still only as long as pose,
/// velocities, body, floor and forces are bit for bit what they were. Empty is always valid.
///
/// ```
/// use bevy::prelude::*;
/// use box_physics::floor::ContactState;
/// use box_physics::prelude::*;
/// /// The dice are cast when all of them rest.
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

/// Integrator memories for segments that are tried: kept for what they have allocated, not for what they say.
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

/// For what the box was found to lie still.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Rest {
    position: DVec3,
    rotation: DQuat,
    half_extents: DVec3,
    mass: f64,
    acceleration: DVec3,
    wrench: Wrench,
    floor: Floor,
    /// The floor's force at each corner \[N\], for the report.
    pub(super) reaction: [f64; 8],
}

impl Rest {
    #[inline]
    fn is_of(&self, state: &BodyState) -> bool {
        self.position == state.position
            && self.rotation == state.rotation
            && state.velocity == DVec3::ZERO
            && state.angular_momentum == DVec3::ZERO
    }
}

impl ContactState {
    /// The corners that touched the floor at the end of the last step; bit k is corner k.
    pub fn touching(&self) -> u8 {
        self.touching
    }

    /// Whether `state` is the one in which the last step left the box at rest. `false` as soon as
    /// another state is written: no step has to come in between.
    pub fn is_resting(&self, state: &BodyState) -> bool {
        self.rest.as_ref().is_some_and(|rest| rest.is_of(state))
    }

    /// Whether it still does: nothing is different.
    #[inline]
    pub(super) fn still_rests<F: ForceModel>(
        &self,
        context: &FloorContext<'_, F>,
        state: &BodyState,
    ) -> bool {
        let (body, force) = (context.body, context.force);
        let Some(rest) = &self.rest else {
            return false;
        };
        rest.is_of(state)
            && rest.acceleration == force.acceleration()
            && rest.floor == *context.floor
            && rest.half_extents == body.half_extents()
            && rest.mass == body.mass()
            && rest.wrench == wrench(body, state, force)
    }

    /// Remembers that the box lies still; `impulse` over `tau` \[s\] held it.
    pub(super) fn establish_rest<F: ForceModel>(
        &mut self,
        context: &FloorContext<'_, F>,
        state: &BodyState,
        impulse: &Corner3,
        tau: f64,
    ) {
        let (body, force) = (context.body, context.force);
        self.rest = Some(Rest {
            position: state.position,
            rotation: state.rotation,
            half_extents: body.half_extents(),
            mass: body.mass(),
            acceleration: force.acceleration(),
            wrench: wrench(body, state, force),
            floor: *context.floor,
            reaction: impulse.map(|p| p.y / tau),
        });
    }
}

/// The wrench that acts, zero where the force model has none: to lose one is a change as well.
#[inline]
fn wrench<F: ForceModel>(body: &RigidBox, state: &BodyState, force: &F) -> Wrench {
    if force.has_wrench() {
        force.wrench(body, state)
    } else {
        Wrench::ZERO
    }
}

/// Where in its life a contact is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Clone, PartialEq))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactPhase {
    /// The corner did not touch before this step.
    Began,
    /// It touched before and touches now.
    Persists,
    /// It touched, and no longer does.
    Ended,
}

/// One corner's contact in one step. A corner that comes and goes within a step is reported twice:
/// began with its impulse, ended with none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Clone, PartialEq))]
pub struct ContactPoint {
    /// Corner index; bits as in [`crate::aabb::corners`].
    pub corner: u8,
    /// Where the floor last acted on it, in the world \[m\].
    pub point: DVec3,
    /// Impulse along the normal over this step \[N s\].
    pub normal_impulse: f64,
    /// Where in its life the contact is.
    pub phase: ContactPhase,
}

/// What happened at each corner during one step.
pub(super) struct ContactImpulses {
    impulse: [f64; 8],
    point: Corner3,
}

impl ContactImpulses {
    pub(super) fn new() -> Self {
        Self {
            impulse: [0.0; 8],
            point: [DVec3::NAN; 8],
        }
    }

    /// Adds impulses at the corners of `state`.
    pub(super) fn add(&mut self, state: &BodyState, lever: &Corner3, impulse: &Corner3) {
        for k in 0..8 {
            if impulse[k].y != 0.0 {
                self.impulse[k] += impulse[k].y;
                self.point[k] = state.position + lever[k];
            }
        }
    }

    /// Adds what forces \[N\] at the corners of `state` make in the time `h` \[s\].
    pub(super) fn hold<F>(
        &mut self,
        context: &FloorContext<'_, F>,
        state: &BodyState,
        h: f64,
        load: &[f64; 8],
    ) {
        let corners = Corners::at(context.floor, context.body, state);
        self.add(state, &corners.lever, &load.map(|f| DVec3::Y * (f * h)));
    }

    /// Reports the step.
    pub(super) fn report(
        &self,
        points: &mut Vec<ContactPoint>,
        state: &BodyState,
        lever: &Corner3,
        before: u8,
        now: u8,
    ) {
        for k in 0..8 {
            let hit = self.impulse[k] != 0.0;
            let point = if hit && !has(now, k) {
                self.point[k]
            } else {
                state.position + lever[k]
            };
            let mut push = |phase, normal_impulse| {
                points.push(ContactPoint {
                    corner: k as u8,
                    point,
                    normal_impulse,
                    phase,
                });
            };
            match (has(before, k), has(now, k)) {
                (true, true) => push(ContactPhase::Persists, self.impulse[k]),
                (true, false) => push(ContactPhase::Ended, self.impulse[k]),
                (false, true) => push(ContactPhase::Began, self.impulse[k]),
                (false, false) if hit => {
                    push(ContactPhase::Began, self.impulse[k]);
                    push(ContactPhase::Ended, 0.0);
                }
                (false, false) => {}
            }
        }
    }
}
