//! Per-body memory of an integrator between steps.

use core::any::{Any, TypeId};
use core::fmt::Debug;
use core::marker::PhantomData;

use glam::DVec3;

use super::{Content, Integrate};
use crate::body::RigidBox;
#[cfg(feature = "bevy")]
use crate::ecs::*;
use crate::force::{Dissipation, ForceModel};
use crate::state::BodyState;

/// An integrator's memory of one body.
///
/// Most integrators need none and never access it. The library keeps it consistent: it discards the memory unless
/// state, body and forces match the last step of the integrator bit for bit. Teleports, impulses and a change of
/// integrator therefore need no notification. An empty memory is always valid.
///
/// To try several steps from one state, copy the memory into a scratch memory with [`clone_from`](Clone::clone_from),
/// which reuses the allocation of the scratch memory.
///
/// ```
/// use box_physics::force::Gravity;
/// use box_physics::prelude::*;
/// let (body, weight) = (RigidBox::default(), Gravity(DVec3::new(0.0, -9.81, 0.0)));
/// let mut state = BodyState::default().with_angular_velocity(&body, DVec3::new(1.0, 2.0, 3.0));
/// let mut memory = IntegratorMemory::default();
/// let mut step = |state: &mut BodyState, memory: &mut IntegratorMemory| {
///     Integrator::Exact.step(&body, state, &weight, 1.0 / 60.0, memory);
/// };
/// step(&mut state, &mut memory);
/// // To rewind and continue bit for bit, keep both.
/// let kept = (state, memory.clone());
/// step(&mut state, &mut memory);
/// let (mut again, mut memory) = kept;
/// step(&mut again, &mut memory);
/// assert_eq!(again, state);
/// ```
#[derive(Debug, Default, PartialEq)]
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
pub struct IntegratorMemory {
    /// Allocated when an integrator first stores a memory of the body, then overwritten in place.
    kept: Option<Box<Kept>>,
}

impl Clone for IntegratorMemory {
    fn clone(&self) -> Self {
        Self {
            kept: self.kept.clone(),
        }
    }

    fn clone_from(&mut self, source: &Self) {
        self.kept.clone_from(&source.kept);
    }
}

impl IntegratorMemory {
    /// Makes the memory invalid. Its allocation stays.
    pub(crate) fn invalidate(&mut self) {
        if let Some(kept) = &mut self.kept {
            kept.situation = None;
        }
    }

    /// The stored memory of `S`, valid or not.
    #[cfg(test)]
    pub(super) fn peek<S: Integrate>(&self) -> Option<S::Memory> {
        let mut content = self.kept.as_ref()?.content.clone();
        content.of::<S>().cloned()
    }

    /// Runs `step`, one step of `S`, with the memory of `S` about the body.
    #[inline(always)]
    pub(super) fn during<S: Integrate, F: ForceModel, R>(
        &mut self,
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        step: impl FnOnce(&mut BodyState, &mut MemorySlot<'_, S>) -> R,
    ) -> R {
        let situation = Situation::of(body, force);
        let holds = self.kept.as_ref().is_some_and(|kept| {
            kept.last == *state && kept.situation == situation && situation.is_some()
        });
        let mut slot = MemorySlot {
            memory: Some(self),
            holds,
            used: false,
            integrator: PhantomData,
        };
        let outcome = step(state, &mut slot);
        if slot.used
            && let Some(kept) = &mut self.kept
        {
            if !holds {
                kept.situation = situation;
            }
            kept.last = *state;
        }
        outcome
    }
}

/// A memory and the situation for which it is valid.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Kept {
    /// `None` for forces without a fingerprint: then the memory is never valid.
    situation: Option<Situation>,
    /// The state after the step.
    last: BodyState,
    content: Content,
}

/// Inputs of a step besides the state and the step size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Situation {
    half_extents: DVec3,
    mass: f64,
    inertia: DVec3,
    acceleration: DVec3,
    dissipation: Dissipation,
    wrench: u64,
}

impl Situation {
    #[inline(always)]
    fn of<F: ForceModel>(body: &RigidBox, force: &F) -> Option<Self> {
        Some(Self {
            half_extents: body.half_extents(),
            mass: body.mass(),
            inertia: body.inertia(),
            acceleration: force.acceleration(),
            dissipation: force.dissipation(),
            wrench: force.wrench_fingerprint()?,
        })
    }
}

/// The memory that integrator `S` has of the body.
///
/// It is present only if body, state and forces match the last step of `S` bit for bit. The integrator itself must
/// compare the step size. A step that neither recalls nor stores leaves the memory unchanged and valid for its state.
pub struct MemorySlot<'a, S: Integrate> {
    /// `None` if nothing can be stored.
    memory: Option<&'a mut IntegratorMemory>,
    holds: bool,
    used: bool,
    integrator: PhantomData<S>,
}

impl<S: Integrate> MemorySlot<'_, S> {
    /// An empty slot, for integrators without a memory.
    #[inline(always)]
    pub(super) const fn none() -> Self {
        Self {
            memory: None,
            holds: false,
            used: false,
            integrator: PhantomData,
        }
    }

    /// The memory of the last step, if this step continues it.
    #[inline(always)]
    pub fn recall(&mut self) -> Option<&mut S::Memory> {
        if !self.holds {
            return None;
        }
        let kept = self.memory.as_mut()?.kept.as_mut()?;
        let memory = kept.content.of::<S>();
        self.used |= memory.is_some();
        memory
    }

    /// Stores `memory` for the next step. An integrator that is not on the list of [`Integrator`](super::Integrator)
    /// cannot store it, so each of its steps is a first step.
    #[inline(always)]
    pub fn store(&mut self, memory: S::Memory) {
        let (Some(slot), Some(content)) = (&mut self.memory, Content::new::<S>(memory)) else {
            return;
        };
        match &mut slot.kept {
            Some(kept) => kept.content = content,
            none => {
                *none = Some(Box::new(Kept {
                    situation: None,
                    last: BodyState::default(),
                    content,
                }));
            }
        }
        (self.holds, self.used) = (true, true);
    }
}

/// Requirements for a memory: plain values that can be copied, compared and, with the feature `serde`,
/// serialized.
pub trait Remember: Saved + Clone + Debug + PartialEq + Send + Sync + 'static {}

impl<T: Saved + Clone + Debug + PartialEq + Send + Sync + 'static> Remember for T {}

/// Serializable with the feature `serde`; without it, no requirement.
#[cfg(feature = "serde")]
pub trait Saved: serde::Serialize + serde::de::DeserializeOwned {}
#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> Saved for T {}

/// Serializable with the feature `serde`; without it, no requirement.
#[cfg(not(feature = "serde"))]
pub trait Saved {}
#[cfg(not(feature = "serde"))]
impl<T> Saved for T {}

/// Returns `value` as a `T`, if `S` and `Owner` are the same integrator, so that the types coincide.
#[inline(always)]
pub(super) fn same<S: 'static, Owner: 'static, T: 'static>(value: &mut dyn Any) -> Option<&mut T> {
    if TypeId::of::<S>() == TypeId::of::<Owner>() {
        value.downcast_mut()
    } else {
        None
    }
}

#[cfg(test)]
mod tests;
