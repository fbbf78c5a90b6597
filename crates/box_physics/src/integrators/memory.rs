//! Memory of an integrator about a body between steps.

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

/// An integrator's memory of one body. Most integrators need none and never access it. The library checks it:
/// it discards the memory unless state, body and forces match the last step of the integrator bit for bit.
/// Teleports, impulses and live switching therefore need no notice. An empty memory is always valid.
///
/// To try several steps from one state, copy the memory into a scratch one with
/// [`clone_from`](Clone::clone_from), which reuses the allocation of the scratch.
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
/// // To go back and continue to the last bit, keep both.
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

/// The memory of the integrator `S` about the body that it steps.
///
/// It is present only if body, state and forces match the last step of `S` bit for bit. The integrator itself
/// compares the step size. A step that neither recalls nor stores leaves the memory unchanged and valid for
/// its state.
pub struct MemorySlot<'a, S: Integrate> {
    /// `None` if nothing can be stored.
    memory: Option<&'a mut IntegratorMemory>,
    holds: bool,
    used: bool,
    integrator: PhantomData<S>,
}

impl<S: Integrate> MemorySlot<'_, S> {
    /// A slot that stays empty, for integrators without a memory.
    #[inline(always)]
    pub(super) const fn none() -> Self {
        Self {
            memory: None,
            holds: false,
            used: false,
            integrator: PhantomData,
        }
    }

    /// Memory of the last step, if this step follows it.
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

    /// Stores `memory` until the next step. An integrator that is not on the list of
    /// [`Integrator`](super::Integrator) cannot store it, so every step is its first.
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

/// `value` as a `T`, if `S` and `Owner` are the same integrator and therefore the same type.
#[inline(always)]
pub(super) fn same<S: 'static, Owner: 'static, T: 'static>(value: &mut dyn Any) -> Option<&mut T> {
    if TypeId::of::<S>() == TypeId::of::<Owner>() {
        value.downcast_mut()
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::slope::Slope;
    use super::*;
    use crate::force::{Forces, Frame, Gravity, PointForce, Spring, Wrench};
    use crate::integrators::{Integrator, Order};
    use glam::DQuat;

    #[test]
    fn a_scratch_copy_keeps_its_allocation() {
        let (body, mut state) = (RigidBox::default(), BodyState::default());
        let (mut memory, mut scratch) = (IntegratorMemory::default(), IntegratorMemory::default());
        let law = Gravity(DVec3::NEG_Y);
        let address = |m: &IntegratorMemory| m.kept.as_deref().map(core::ptr::from_ref);
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        scratch.clone_from(&memory);
        let (first, own) = (address(&scratch), address(&memory));
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        assert!(scratch != memory);
        scratch.clone_from(&memory);
        assert!(scratch == memory && address(&scratch) == first && first.is_some());
        // An event also overwrites in place.
        state.velocity = DVec3::X;
        Integrator::Exact.step(&body, &mut state, &law, 0.1, &mut memory);
        assert_eq!(address(&memory), own);
    }

    /// A method with a memory: an integrator, or a faulty one of these tests.
    trait Steps {
        type Memory: Default;
        fn step<F: ForceModel>(
            &self,
            body: &RigidBox,
            state: &mut BodyState,
            force: &F,
            h: f64,
            memory: &mut Self::Memory,
        );
        /// Maximum difference that a change of the step may cause: rounding, for closed forms.
        fn slack(&self, force: &Forces) -> f64;
    }

    impl Steps for Integrator {
        type Memory = IntegratorMemory;

        fn step<F: ForceModel>(
            &self,
            body: &RigidBox,
            state: &mut BodyState,
            force: &F,
            h: f64,
            memory: &mut IntegratorMemory,
        ) {
            Self::step(*self, body, state, force, h, memory);
        }

        fn slack(&self, force: &Forces) -> f64 {
            let o = self.info().orders;
            let exact = [o.gravity, o.linear_drag, o.rotation, o.angular_damping]
                .iter()
                .all(|&order| order == Order::Exact);
            if exact && !force.has_wrench() {
                1e-13
            } else {
                0.0
            }
        }
    }

    /// Inputs of a step.
    #[derive(Clone, PartialEq)]
    struct Scene {
        body: RigidBox,
        state: BodyState,
        forces: Forces<'static>,
        points: Vec<PointForce>,
        springs: Vec<Spring>,
        h: f64,
    }

    impl Scene {
        fn free() -> Self {
            let body = super::super::testing::brick();
            Self {
                state: BodyState::at_pose(
                    DVec3::new(0.5, 1.0, -0.5),
                    DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7),
                )
                .with_velocity(DVec3::new(1.0, 2.0, -1.0))
                .with_body_angular_velocity(&body, DVec3::new(1.5, 2.5, 1.0)),
                body,
                forces: Forces {
                    acceleration: DVec3::NEG_Y * 9.81,
                    ..super::super::testing::drag(0.5, 0.25)
                },
                points: Vec::new(),
                springs: Vec::new(),
                h: 1.0 / 60.0,
            }
        }

        fn forced() -> Self {
            let mut scene = Self::free();
            scene.forces.body_torque = DVec3::new(0.1, 0.2, 0.3);
            scene.forces.world_torque = DVec3::new(0.3, 0.2, 0.1);
            scene.points = vec![PointForce {
                body_point: DVec3::X,
                force: DVec3::Y,
                frame: Frame::Body,
            }];
            scene.springs = vec![Spring {
                body_point: DVec3::new(0.5, 0.25, 0.125),
                anchor: DVec3::Y,
                stiffness: 20.0,
                damping: 0.5,
            }];
            scene
        }

        fn step<S: Steps>(&mut self, stepper: &S, memory: &mut S::Memory) {
            let law = Forces {
                point_forces: &self.points,
                springs: &self.springs,
                ..self.forces
            };
            stepper.step(&self.body, &mut self.state, &law, self.h, memory);
        }
    }

    type Change = (&'static str, fn(&mut Scene));

    const CHANGES: &[Change] = &[
        ("state: position", |s| s.state.position.x += 0.125),
        ("state: attitude", |s| s.state.rotation = -s.state.rotation),
        ("state: velocity", |s| s.state.velocity.y += 0.125),
        ("state: momentum", |s| s.state.angular_momentum *= 1.5),
        ("body: size", |s| {
            s.body = RigidBox::new(s.body.half_extents() * 2.0, s.body.mass()).expect("valid");
        }),
        ("body: inertia", |s| {
            s.body = s.body.with_inertia(s.body.inertia() * 2.0).expect("valid");
        }),
        ("force: gravity", |s| s.forces.acceleration.x = 1.0),
        ("force: drag", |s| s.forces.dissipation.linear_drag += 1.0),
        ("force: quadratic drag", |s| {
            s.forces.dissipation.quadratic_drag += 1.0;
        }),
        ("force: damping", |s| {
            s.forces.dissipation.angular_damping += 1.0;
        }),
        ("force: angular drag", |s| {
            s.forces.dissipation.angular_drag += 1.0;
        }),
        ("force: body torque", |s| s.forces.body_torque.x += 1.0),
        ("force: world torque", |s| s.forces.world_torque.x += 1.0),
        ("force: two signs", |s| {
            s.forces.body_torque.x *= -1.0;
            s.forces.body_torque.y *= -1.0;
        }),
        ("force: points", |s| {
            s.points.iter_mut().for_each(|p| p.body_point.y += 0.5);
        }),
        ("force: frame", |s| {
            s.points.iter_mut().for_each(|p| p.frame = Frame::World);
        }),
        ("force: anchor", |s| {
            s.springs.iter_mut().for_each(|p| p.anchor.x += 1.0);
        }),
        ("force: stiffness", |s| {
            s.springs.iter_mut().for_each(|p| p.stiffness *= 2.0);
        }),
        ("force: damper", |s| {
            s.springs.iter_mut().for_each(|p| p.damping *= 2.0);
        }),
        ("force: no springs", |s| s.springs.clear()),
        ("step: shorter", |s| s.h *= 0.5),
        ("step: backwards", |s| s.h = -s.h),
    ];

    fn distance(a: &BodyState, b: &BodyState) -> f64 {
        (a.position - b.position)
            .length()
            .max((a.velocity - b.velocity).length())
            .max((a.angular_momentum - b.angular_momentum).length())
            .max((a.rotation - b.rotation).length())
    }

    /// After a change of state, body, forces or step size, a step with the memory must equal the step from an
    /// empty memory.
    fn honest<S: Steps>(stepper: &S) -> Result<(), String> {
        for scene in [Scene::free(), Scene::forced()] {
            for (what, change) in CHANGES {
                let (mut scene, mut memory) = (scene.clone(), S::Memory::default());
                for _ in 0..3 {
                    scene.step(stepper, &mut memory);
                }
                let before = scene.clone();
                change(&mut scene);
                if scene == before {
                    continue; // There is no such force in this scene.
                }
                let mut from_empty = scene.clone();
                scene.step(stepper, &mut memory);
                from_empty.step(stepper, &mut S::Memory::default());
                let off = distance(&scene.state, &from_empty.state);
                let slack = if what.starts_with("step") {
                    stepper.slack(&scene.forces)
                } else {
                    0.0
                };
                if off.is_nan() || off > slack {
                    return Err(format!(
                        "after a change of {what} the next step differs by {off:e} from one with an empty memory \
                         (allowed: {slack:e}); compare what the memory depends on, and start again where it changed"
                    ));
                }
            }
        }
        Ok(())
    }

    #[test]
    fn memories_change_no_result() {
        for i in Integrator::ALL {
            honest(i).unwrap_or_else(|error| panic!("{i}: {error}"));
        }
    }

    /// A model that does not report whether it has changed.
    struct Motor(f64);

    impl ForceModel for Motor {
        fn acceleration(&self) -> DVec3 {
            DVec3::ZERO
        }

        fn has_wrench(&self) -> bool {
            true
        }

        fn wrench(&self, _: &RigidBox, _: &BodyState) -> Wrench {
            Wrench {
                torque: DVec3::Z * self.0,
                ..Wrench::ZERO
            }
        }
    }

    #[test]
    fn a_model_without_a_fingerprint_always_counts_as_changed() {
        for i in Integrator::ALL {
            let Scene { body, state, .. } = Scene::free();
            let (mut a, mut memory) = (state, IntegratorMemory::default());
            i.step(&body, &mut a, &Motor(1.0), 0.1, &mut memory);
            let mut b = a;
            i.step(&body, &mut a, &Motor(9.0), 0.1, &mut memory);
            i.step(
                &body,
                &mut b,
                &Motor(9.0),
                0.1,
                &mut IntegratorMemory::default(),
            );
            assert_eq!(a, b, "{i}");
        }
    }

    /// A two-step method that ignores one of the inputs of its memory.
    struct Careless(&'static str);

    #[derive(Clone, Copy, PartialEq)]
    struct Key {
        state: BodyState,
        body: RigidBox,
        force: (DVec3, Dissipation, Option<u64>),
        step: f64,
    }

    impl Steps for Careless {
        type Memory = Option<(Key, Slope)>;

        fn step<F: ForceModel>(
            &self,
            body: &RigidBox,
            state: &mut BodyState,
            force: &F,
            h: f64,
            memory: &mut Self::Memory,
        ) {
            let now = Key {
                state: *state,
                body: *body,
                force: (
                    force.acceleration(),
                    force.dissipation(),
                    force.wrench_fingerprint(),
                ),
                step: h,
            };
            let holds = |then: &Key| {
                (self.0 == "state" || then.state == now.state)
                    && (self.0 == "body" || then.body == now.body)
                    && (self.0 == "force" || then.force == now.force)
                    && (self.0 == "step" || then.step == now.step)
            };
            let slope = Slope::at(body, state, force);
            let before = match memory {
                Some((then, before)) if holds(then) => *before,
                _ => slope,
            };
            *state = before.from(&slope.from(state, 1.5 * h), -0.5 * h);
            *memory = Some((
                Key {
                    state: *state,
                    ..now
                },
                slope,
            ));
        }

        fn slack(&self, _: &Forces) -> f64 {
            0.0
        }
    }

    #[test]
    fn a_faulty_memory_is_detected() {
        assert_eq!(honest(&Careless("nothing")), Ok(()));
        for ignored in ["state", "body", "force", "step"] {
            let error = honest(&Careless(ignored)).expect_err(ignored);
            assert!(error.contains(&format!("a change of {ignored}")), "{error}");
        }
    }
}
