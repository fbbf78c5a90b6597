//! Properties of an integrator: the only place for its name, order, cost, stable range and conserved
//! quantities. The menu, the report and the documentation read them here, and the tests check them.

use core::fmt;

/// The parts of the force model, each with a separate order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Uniform acceleration: the parabola.
    Gravity,
    /// Force −c₁ v.
    LinearDrag,
    /// Force −k₂ |v| v.
    QuadraticDrag,
    /// The gyroscopic term: free rotation of an asymmetric body.
    Rotation,
    /// Torque that depends on the attitude or is constant in some axes.
    Torque,
    /// Spring at a body point.
    Spring,
    /// Torque −γ L.
    AngularDamping,
    /// Torque −c_ω ω.
    AngularDrag,
}

impl Channel {
    /// All channels.
    pub const ALL: [Self; 8] = [
        Self::Gravity,
        Self::LinearDrag,
        Self::QuadraticDrag,
        Self::Rotation,
        Self::Torque,
        Self::Spring,
        Self::AngularDamping,
        Self::AngularDrag,
    ];

    /// Name of the channel, for headings.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::LinearDrag => "linear drag",
            Self::QuadraticDrag => "quadratic drag",
            Self::Rotation => "rotation",
            Self::Torque => "torque",
            Self::Spring => "spring",
            Self::AngularDamping => "angular damping",
            Self::AngularDrag => "angular drag",
        }
    }
}

/// Order of convergence of the global error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// No truncation error, only rounding.
    Exact,
    /// Error ∝ hᵖ.
    Of(u8),
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact"),
            Self::Of(p) => write!(f, "{p}"),
        }
    }
}

/// The order per channel of the force model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orders {
    /// [`Channel::Gravity`], in the position.
    pub gravity: Order,
    /// [`Channel::LinearDrag`], in the position.
    pub linear_drag: Order,
    /// [`Channel::QuadraticDrag`], in the position.
    pub quadratic_drag: Order,
    /// [`Channel::Rotation`], in the attitude.
    pub rotation: Order,
    /// [`Channel::Torque`], in the attitude.
    pub torque: Order,
    /// [`Channel::Spring`], in position and attitude.
    pub spring: Order,
    /// [`Channel::AngularDamping`], in the attitude, beyond the error of the rotation itself.
    pub angular_damping: Order,
    /// [`Channel::AngularDrag`], in the attitude.
    pub angular_drag: Order,
}

impl Orders {
    /// The same order in every channel.
    pub const fn all(p: u8) -> Self {
        let p = Order::Of(p);
        Self {
            gravity: p,
            linear_drag: p,
            quadratic_drag: p,
            rotation: p,
            torque: p,
            spring: p,
            angular_damping: p,
            angular_drag: p,
        }
    }

    /// The order in one channel.
    pub const fn of(&self, channel: Channel) -> Order {
        match channel {
            Channel::Gravity => self.gravity,
            Channel::LinearDrag => self.linear_drag,
            Channel::QuadraticDrag => self.quadratic_drag,
            Channel::Rotation => self.rotation,
            Channel::Torque => self.torque,
            Channel::Spring => self.spring,
            Channel::AngularDamping => self.angular_damping,
            Channel::AngularDrag => self.angular_drag,
        }
    }
}

/// Range of step sizes in which an integrator stays bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Bounded at every step.
    None,
    /// Bounded up to this value of the dimensionless step.
    Below(f64),
    /// Not bounded at any step: the amplitude grows slowly or quickly.
    AlwaysGrows,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("any step"),
            Self::Below(x) => write!(f, "< {x}"),
            Self::AlwaysGrows => f.write_str("always grows"),
        }
    }
}

/// Stable ranges in four dimensionless steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// |ω| h of a free tumbling body.
    pub rotation: Limit,
    /// c₁ h / m of linear drag.
    pub drag: Limit,
    /// d h / m of a damper at the center of mass.
    pub damper: Limit,
    /// √(k/m) h of an undamped spring at the center of mass. A spring at a corner also turns the box. There
    /// the iteration of an implicit integrator may fail at extreme stiffness, which is counted.
    pub oscillator: Limit,
}

/// Behavior of the energy of a free tumbling body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnergyBehavior {
    /// Constant to rounding.
    Exact,
    /// Oscillates within a band ∝ hᵖ without drift.
    Bounded,
    /// Decreases.
    Dissipates,
    /// Increases.
    Gains,
    /// Decreases or increases slowly, depending on the motion.
    Drifts,
}

impl fmt::Display for EnergyBehavior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Bounded => "bounded",
            Self::Dissipates => "dissipates",
            Self::Gains => "gains",
            Self::Drifts => "drifts",
        })
    }
}

/// Quantities of a free tumbling body that an integrator conserves, to rounding unless stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conserved {
    /// Behavior of the energy.
    pub energy: EnergyBehavior,
    /// |L|, the magnitude of the angular momentum.
    pub momentum_magnitude: bool,
    /// L in world axes, magnitude and direction.
    pub momentum: bool,
    /// n steps forward and n backward return to the start.
    pub reversible: bool,
}

impl Conserved {
    /// Neither conserves angular momentum nor is reversible; the energy behaves as given.
    pub const fn nothing_else(energy: EnergyBehavior) -> Self {
        Self {
            energy,
            momentum_magnitude: false,
            momentum: false,
            reversible: false,
        }
    }

    /// Conserves angular momentum and is reversible; the energy behaves as given.
    pub const fn all_else(energy: EnergyBehavior) -> Self {
        Self {
            energy,
            momentum_magnitude: true,
            momentum: true,
            reversible: true,
        }
    }
}

/// Force evaluations per step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Evaluations {
    /// With uniform gravity and dissipation only.
    pub free: u32,
    /// With a state-dependent force.
    pub forced: u32,
    /// Maximum number of additional evaluations in a step without a complete memory, that is, at the start and after an
    /// external change.
    pub starting: u32,
    /// `true` if the integrator iterates; both numbers are then per iteration.
    pub per_iteration: bool,
}

impl Evaluations {
    /// An integrator with a fixed number of evaluations.
    pub const fn fixed(free: u32, forced: u32) -> Self {
        Self {
            free,
            forced,
            starting: 0,
            per_iteration: false,
        }
    }

    /// Sets the number of additional evaluations of starting steps.
    #[must_use]
    pub const fn starting(self, starting: u32) -> Self {
        Self { starting, ..self }
    }

    /// An integrator that iterates to convergence.
    pub const fn per_iteration(free: u32, forced: u32) -> Self {
        Self {
            free,
            forced,
            starting: 0,
            per_iteration: true,
        }
    }
}

impl fmt::Display for Evaluations {
    /// Format: `1 · 2` (free, forced), or `1 · 2 per iteration`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} · {}", self.free, self.forced)?;
        if self.per_iteration {
            f.write_str(" per iteration")?;
        }
        Ok(())
    }
}

/// Sections of the menu, in menu order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MenuGroup {
    /// Developed for this library.
    Ours,
    /// From textbooks on ordinary differential equations and mechanics.
    Textbook,
    /// From game engines and simulators.
    Engines,
    /// From the dissertation of 2012.
    Dissertation2012,
}

impl MenuGroup {
    /// Heading of the group.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ours => "box_physics",
            Self::Textbook => "Textbook",
            Self::Engines => "Game engines",
            Self::Dissertation2012 => "2012",
        }
    }
}

/// All properties of an integrator.
///
/// ```
/// use box_physics::prelude::*;
/// use box_physics::integrators::EnergyBehavior;
/// let keeps_energy: Vec<&str> = Integrator::ALL
///     .iter()
///     .map(|i| i.info())
///     .filter(|info| info.conserved.energy == EnergyBehavior::Exact)
///     .map(|info| info.id)
///     .collect();
/// assert_eq!(keeps_energy, ["split", "exact", "dmv6", "implicit-midpoint"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegratorInfo {
    /// Identifier on the command line and in files: lower case with hyphens.
    pub id: &'static str,
    /// Display name.
    pub name: &'static str,
    /// Section of the menu.
    pub group: MenuGroup,
    /// One sentence for a tooltip.
    pub summary: &'static str,
    /// Author, year and equation.
    pub source: &'static str,
    /// Order of convergence per channel.
    pub orders: Orders,
    /// Force evaluations per step.
    pub evaluations: Evaluations,
    /// Stable ranges.
    pub stability: Stability,
    /// Conserved quantities.
    pub conserved: Conserved,
}
