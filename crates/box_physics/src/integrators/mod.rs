//! The numerical integrators. **An integrator is one file and one line in the list below**; the menu, the
//! report, the benchmarks and the convergence tests follow from the list.
//!
//! To add one, write `my_integrator.rs` in this directory with a unit type, its formula and source, an
//! [`impl Integrate`](Integrate) and its tests. Add `MyIntegrator = my_integrator,` to `integrators!`. The
//! tests then check the claims of its [`IntegratorInfo`]. `ARCHITECTURE.md` has the steps and a model of each
//! kind.

mod batch;
mod damped_kick;
mod extrapolation;
mod flows;
mod forced;
mod implicit_stage;
mod info;
mod memory;
mod newton;
mod slope;
mod stage_equations;
#[cfg(test)]
mod testing;
mod trajectory;

pub use batch::{GravityField, Group};
pub use forced::ForcedGroup;
pub use info::{
    Channel, Conserved, EnergyBehavior, Evaluations, IntegratorInfo, Limit, MenuGroup, Order,
    Orders, Stability,
};
pub use memory::{IntegratorMemory, MemorySlot, Remember};

pub(crate) use flows::impulse_step;

#[cfg(feature = "bevy")]
use crate::ecs::*;
use core::fmt;
use core::str::FromStr;

use crate::body::RigidBox;
use crate::force::ForceModel;
use crate::math::{AnyArgument, Trigonometry};
use crate::state::BodyState;

/// A numerical integrator for translation and rotation.
///
/// One function, [`advance`](Self::advance), serves both a single body and several bodies in SIMD lanes.
pub trait Integrate: Sized + 'static {
    /// Name, order, cost and properties.
    const INFO: IntegratorInfo;

    /// `true` if a step in free flight branches on a number, iterates, or uses a memory.
    ///
    /// Integrators without branches step two or four bodies at a time. Selecting one of two numbers is not a branch.
    /// Neither is a condition that [`Gravity`](crate::force::Gravity) decides at compile time, such as
    /// [`ForceModel::has_wrench`].
    const BRANCHES: bool = false;

    /// Memory of a body between steps; `()` for none.
    type Memory: Remember;

    /// `true` if a step with its memory and a step of another length follow different motions, as in multistep methods.
    /// A step that may meet the floor then starts without the memory, so that an impact is located on one motion.
    const MULTISTEP: bool = false;

    /// Advances `state` by `h` ≠ 0 \[s\] under `force`. A negative `h` runs a reversible integrator backward;
    /// for other integrators it is an ordinary step.
    ///
    /// Take sines and cosines from `trigonometry`, which branches for one body but not for many. Mark this function and
    /// its callees `#[inline(always)]`, because a loop that contains a call is not vectorized.
    fn advance<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        memory: &mut MemorySlot<'_, Self>,
        trigonometry: &mut impl Trigonometry,
    ) -> StepOutcome;

    /// Advances `state` by `h` \[s\] under `force`. `h` = 0 leaves every bit unchanged.
    #[inline(always)]
    fn step<F: ForceModel>(
        body: &RigidBox,
        state: &mut BodyState,
        force: &F,
        h: f64,
        memory: &mut IntegratorMemory,
    ) -> StepOutcome {
        if h == 0.0 {
            return StepOutcome::default();
        }
        if size_of::<Self::Memory>() == 0 || !Self::remembers(force) {
            let mut none = MemorySlot::none();
            return Self::advance(body, state, force, h, &mut none, &mut AnyArgument);
        }
        memory.during(body, state, force, |state, slot| {
            Self::advance(body, state, force, h, slot, &mut AnyArgument)
        })
    }

    /// Returns `false` if a step under `force` does not use its memory. The memory is then neither read nor changed.
    #[inline(always)]
    fn remembers<F: ForceModel>(_force: &F) -> bool {
        true
    }

    /// Steps the bodies of `group` in free flight: several at a time unless the integrator branches. Each result has
    /// the bits of [`Integrate::step`] under [`Gravity`](crate::force::Gravity).
    fn step_group(group: &mut Group<'_>, h: f64) -> StepOutcome {
        const {
            let plain = size_of::<Self::Memory>() == 0 && !Self::INFO.evaluations.per_iteration;
            assert!(
                Self::BRANCHES || plain,
                "an integrator that iterates or remembers has branches: add `const BRANCHES: bool = true;`"
            );
        }
        if Self::BRANCHES {
            group.one_by_one::<Self>(h)
        } else {
            group.in_lanes::<Self>(h)
        }
    }

    /// `true` if [`step_forced`](Self::step_forced) is faster than stepping the bodies one by one.
    const FORCED_IN_LANES: bool = false;

    /// Steps the bodies of `group`, each under its own forces. Each result has the bits of [`Integrate::step`].
    fn step_forced<F: ForceModel>(group: &mut ForcedGroup<'_, F>, h: f64) -> StepOutcome {
        group.one_by_one::<Self>(0..group.forces.len(), h)
    }
}

/// Cost of a step, and its fallbacks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "bevy", derive(Reflect), reflect(Default, Clone, PartialEq))]
pub struct StepOutcome {
    /// Evaluations of the force model.
    pub evaluations: u64,
    /// Steps taken by `split` because the integrator was not applicable.
    pub fallbacks: u64,
    /// Iterations that reached their maximum number instead of their tolerance.
    pub unconverged: u64,
}

impl StepOutcome {
    /// The outcome of an ordinary step with `evaluations` force evaluations.
    #[inline(always)]
    pub const fn plain(evaluations: u32) -> Self {
        Self {
            evaluations: evaluations as u64,
            fallbacks: 0,
            unconverged: 0,
        }
    }
}

/// The sum of `count` equal outcomes.
impl core::ops::Mul<u64> for StepOutcome {
    type Output = Self;

    #[inline(always)]
    fn mul(self, count: u64) -> Self {
        Self {
            evaluations: self.evaluations * count,
            fallbacks: self.fallbacks * count,
            unconverged: self.unconverged * count,
        }
    }
}

impl core::ops::AddAssign for StepOutcome {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.evaluations += other.evaluations;
        self.fallbacks += other.fallbacks;
        self.unconverged += other.unconverged;
    }
}

/// Code that is generic over the integrator; see [`Integrator::dispatch`].
pub trait IntegratorVisitor {
    /// Result of the visit.
    type Output;
    /// Runs with the integrator as a type, so that the inner loop is compiled for it.
    fn visit<S: Integrate>(self) -> Self::Output;
}

macro_rules! integrators {
    ($($(#[$attribute:meta])* $name:ident = $module:ident,)+) => {
        $(mod $module;)+
        $(pub use $module::$name;)+

        /// A choice of integrator. The variants are in menu order.
        ///
        /// ```
        /// use box_physics::force::Gravity;
        /// use box_physics::prelude::*;
        /// // The names for a menu; parsing an id; a description.
        /// let menu: Vec<&str> = Integrator::ALL.iter().map(|i| i.name()).collect();
        /// assert_eq!(menu[..2], ["Split", "Exact"]);
        /// let typed: Integrator = "rk4".parse()?;
        /// assert_eq!(typed, Integrator::Rk4);
        /// assert!("leapfrog".parse::<Integrator>().is_err());
        /// println!("{typed}: {}", typed.info().summary);
        /// // One step of one body, without an App.
        /// let (body, mut memory) = (RigidBox::default(), IntegratorMemory::default());
        /// let mut state = BodyState::default();
        /// let weight = Gravity(DVec3::new(0.0, -9.81, 0.0));
        /// let outcome = typed.step(&body, &mut state, &weight, 1.0 / 60.0, &mut memory);
        /// assert_eq!(outcome.evaluations, 4);
        /// # Ok::<(), box_physics::integrators::UnknownIntegrator>(())
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[cfg_attr(feature = "bevy", derive(Reflect, VariantDefaults), reflect(Default, Clone, PartialEq, Hash))]
        pub enum Integrator {
            $($(#[$attribute])* #[doc = concat!("[`", stringify!($name), "`](struct@", stringify!($name), ")")] $name,)+
        }

        /// The memory of one integrator.
        #[derive(Clone, Debug, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[expect(clippy::large_enum_variant, reason = "it is only ever stored in a box")]
        enum Content {
            $($name(<$name as Integrate>::Memory),)+
        }

        impl Content {
            /// The memory of `S`, if this variant belongs to `S`.
            #[inline(always)]
            fn of<S: Integrate>(&mut self) -> Option<&mut S::Memory> {
                match self {
                    $(Self::$name(memory) => memory::same::<S, $name, _>(memory),)+
                }
            }

            /// Returns `None` if `S` is not on the list.
            #[inline(always)]
            fn new<S: Integrate>(memory: S::Memory) -> Option<Self> {
                let mut memory = Some(memory);
                $(if let Some(memory) = memory::same::<S, $name, Option<_>>(&mut memory) {
                    return memory.take().map(Self::$name);
                })+
                None
            }
        }

        impl Integrator {
            /// All integrators, in menu order.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// Name, order, cost and properties of the integrator.
            pub const fn info(self) -> &'static IntegratorInfo {
                match self {
                    $(Self::$name => const { &<$name as Integrate>::INFO },)+
                }
            }

            /// Calls the visitor with the chosen integrator as a type: one match per loop, not per body.
            #[inline]
            pub fn dispatch<V: IntegratorVisitor>(self, visitor: V) -> V::Output {
                match self {
                    $(Self::$name => visitor.visit::<$name>(),)+
                }
            }

            /// Advances one body by one step of the chosen integrator; see [`Integrate::step`].
            #[inline]
            pub fn step<F: ForceModel>(
                self,
                body: &RigidBox,
                state: &mut BodyState,
                force: &F,
                h: f64,
                memory: &mut IntegratorMemory,
            ) -> StepOutcome {
                match self {
                    $(Self::$name => $name::step(body, state, force, h, memory),)+
                }
            }
        }
    };
}

integrators! {
    #[default]
    Split = split,
    Exact = exact,
    Split4 = split4,
    Dmv6 = dmv6,
    SymmetricTop = symmetric_top,
    Rk4 = rk4,
    ImplicitMidpoint = implicit_midpoint,
    VelocityVerlet = velocity_verlet,
    Midpoint = midpoint,
    BackwardEuler = backward_euler,
    ExplicitEuler = explicit_euler,
    SemiImplicitEuler = semi_implicit_euler,
    EngineRescaled = engine_rescaled,
    EngineNewton = engine_newton,
    Avian993 = avian_993,
    AdamsBashforth2 = adams_bashforth_2,
    Buss = buss,
    BussAugmented = buss_augmented,
    Heun2012 = heun_2012,
}

impl Integrator {
    /// Identifier on the command line and in files: `split`, `rk4`, …
    pub const fn id(self) -> &'static str {
        self.info().id
    }

    /// Display name.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// Position in the menu, from 0.
    pub const fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for Integrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.id())
    }
}

/// Error for an unknown integrator id; the message lists the valid ids.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownIntegrator {
    /// The given text.
    pub given: String,
}

impl fmt::Display for UnknownIntegrator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ids: Vec<_> = Integrator::ALL.iter().map(|i| i.id()).collect();
        write!(
            f,
            "unknown integrator '{}'; allowed: {}",
            self.given,
            ids.join(", ")
        )
    }
}

impl core::error::Error for UnknownIntegrator {}

impl FromStr for Integrator {
    type Err = UnknownIntegrator;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .iter()
            .copied()
            .find(|i| i.id().eq_ignore_ascii_case(text.trim()))
            .ok_or_else(|| UnknownIntegrator {
                given: text.to_owned(),
            })
    }
}

/// Serialized as its id.
#[cfg(feature = "serde")]
impl serde::Serialize for Integrator {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Integrator {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let id = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        id.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests;
