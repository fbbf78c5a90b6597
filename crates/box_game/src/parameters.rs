//! All numeric settings in one table: names, unit, range and effect. Panel, undo, command line, scripts and the copied
//! command line use it.

use box_physics::prelude::{DVec3, RigidBox};
use box_scenarios::Scenario;
use serde::{Deserialize, Serialize};

/// Speeds of the ladder [simulated seconds per second]; 1 is real time.
pub const SPEEDS: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0];

/// Smallest and largest scale of the panel.
pub const UI_SCALES: (f32, f32) = (0.75, 2.0);

/// A numeric setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Step size dt \[s\].
    Step,
    /// Number of equal parts of a step.
    Substeps,
    /// Gravity, downward [m/s²].
    Gravity,
    /// Restitution of the floor.
    Restitution,
    /// Energy limit of an impact, by its number in [`Info::choices`].
    RestitutionLaw,
    /// Friction of the floor.
    Friction,
    /// Linear drag c₁ [N s/m].
    LinearDrag,
    /// Angular damping γ [1/s].
    AngularDamping,
    /// Half-extent along x \[m\].
    HalfX,
    /// Half-extent along y \[m\].
    HalfY,
    /// Half-extent along z \[m\].
    HalfZ,
    /// Mass \[kg\].
    Mass,
    /// Strength of a push \[N s\].
    Impulse,
    /// Number of boxes.
    Boxes,
}

/// Time at which a new value takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// From the next step on; the motion up to then is unchanged.
    Clock,
    /// From the next step on; the scene's reference no longer applies.
    Live,
    /// The scene restarts.
    Restart,
    /// The motion does not change.
    None,
}

/// The row of a parameter in the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Info {
    /// Name on the command line and in logs.
    pub id: &'static str,
    /// Name on the panel.
    pub label: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Tooltip.
    pub hint: &'static str,
    /// Range of the slider.
    pub slider: (f64, f64),
    /// Smallest and largest value allowed.
    pub range: (f64, f64),
    /// `true` if the slider is logarithmic.
    pub logarithmic: bool,
    /// `true` if the value is a whole number.
    pub integer: bool,
    /// Time at which a new value takes effect.
    pub effect: Effect,
    /// Names of the values 0, 1, …, for a choice instead of a number.
    pub choices: &'static [&'static str],
}

impl Info {
    /// A number from 0 to 1 that takes effect live.
    const LIVE: Self = Self {
        id: "",
        label: "",
        unit: "",
        hint: "",
        slider: (0.0, 1.0),
        range: (0.0, 1.0),
        logarithmic: false,
        integer: false,
        effect: Effect::Live,
        choices: &[],
    };

    /// A half-extent of the box.
    const HALF: Self = Self {
        unit: "m",
        slider: (0.0025, 5.0),
        range: (1e-4, 1e3),
        logarithmic: true,
        effect: Effect::Restart,
        ..Self::LIVE
    };
}

impl Parameter {
    /// Every parameter, in the order of the panel.
    pub const ALL: [Self; 14] = [
        Self::Step,
        Self::Substeps,
        Self::Gravity,
        Self::Restitution,
        Self::RestitutionLaw,
        Self::Friction,
        Self::LinearDrag,
        Self::AngularDamping,
        Self::HalfX,
        Self::HalfY,
        Self::HalfZ,
        Self::Mass,
        Self::Impulse,
        Self::Boxes,
    ];

    /// The parameter's row.
    #[rustfmt::skip]
    pub const fn info(self) -> Info {
        const STEP: (f64, f64) = (1.0 / 1920.0, 0.5);
        const PARTS: (f64, f64) = (1.0, 64.0);
        const LIVE: Info = Info::LIVE;
        match self {
            Self::Step => Info {
                id: "dt", label: "dt", unit: "s", hint: "Step size. Type 0.01, 1/60 or 60 Hz.",
                slider: STEP, range: STEP, logarithmic: true, effect: Effect::Clock, ..LIVE },
            Self::Substeps => Info {
                id: "substeps", label: "Substeps", hint: "Number of equal parts per step.",
                slider: PARTS, range: PARTS, logarithmic: true, integer: true, effect: Effect::Clock, ..LIVE },
            Self::Gravity => Info {
                id: "gravity", label: "Gravity", unit: "m/s²", hint: "Downward acceleration.",
                slider: (0.0, 30.0), range: (-1e4, 1e4), ..LIVE },
            Self::Restitution => Info {
                id: "restitution", label: "Restitution",
                hint: "Ratio of the speeds after and before a bounce: 0 never bounces, 1 bounces forever.", ..LIVE },
            Self::RestitutionLaw => Info {
                id: "restitution-law", label: "Impact law", integer: true, choices: &["Energetic", "Newton"],
                hint: "Energetic: an impact returns at most e² of the energy. Newton: the normal speed of each \
                    corner is reversed and multiplied by e.", ..LIVE },
            Self::Friction => Info {
                id: "friction", label: "Friction", hint: "Coulomb friction coefficient of the floor.",
                slider: (0.0, 2.0), range: (0.0, 1e3), ..LIVE },
            Self::LinearDrag => Info {
                id: "linear-drag", label: "Linear drag", unit: "N s/m", hint: "Force opposite to the velocity, c₁ v.",
                slider: (0.0, 100.0), range: (0.0, 1e6), logarithmic: true, ..LIVE },
            Self::AngularDamping => Info {
                id: "angular-damping", label: "Ang. damping", unit: "1/s",
                hint: "Torque opposite to the angular momentum, γ L.",
                slider: (0.0, 10.0), range: (0.0, 1e6), logarithmic: true, ..LIVE },
            Self::HalfX => Info {
                id: "half-x", label: "Half-size x", hint: "Half-extent along the body x axis.", ..Info::HALF },
            Self::HalfY => Info {
                id: "half-y", label: "Half-size y", hint: "Half-extent along the body y axis.", ..Info::HALF },
            Self::HalfZ => Info {
                id: "half-z", label: "Half-size z", hint: "Half-extent along the body z axis.", ..Info::HALF },
            Self::Mass => Info {
                id: "mass", label: "Mass", unit: "kg", hint: "Mass of the box, uniformly distributed.",
                slider: (0.0005, 100.0), range: (1e-6, 1e6), logarithmic: true, effect: Effect::Restart, ..LIVE },
            Self::Impulse => Info {
                id: "impulse", label: "Strength", unit: "N s", hint: "Impulse of one push.",
                slider: (0.01, 100.0), range: (0.0, 1e6), logarithmic: true, effect: Effect::None, ..LIVE },
            Self::Boxes => Info {
                id: "boxes", label: "Boxes", hint: "Number of boxes. More boxes give steadier timings.",
                slider: (1.0, 1e4), range: (1.0, 1e5), logarithmic: true, integer: true,
                effect: Effect::Restart, ..LIVE },
        }
    }

    /// The nearest allowed value; `None` for NaN.
    pub fn nearest(self, value: f64) -> Option<f64> {
        let info = self.info();
        let value = value.clamp(info.range.0, info.range.1);
        let value = if info.integer { value.round() } else { value };
        (!value.is_nan()).then_some(value)
    }

    /// Parses a typed value: a number, or the name of a choice in any case.
    pub fn parse(self, text: &str) -> Option<f64> {
        let text = text.trim();
        let mut choices = self.info().choices.iter();
        let named = choices.position(|c| c.eq_ignore_ascii_case(text));
        let value = named.map_or_else(|| text.parse().ok(), |k| Some(k as f64));
        value.filter(|v: &f64| v.is_finite())
    }

    /// A value with its name and unit: `gravity 1.62 m/s²`, `restitution-law Newton`.
    pub fn describe(self, value: f64) -> String {
        let info = self.info();
        if let (Some(choice), true) = (info.choices.get(value as usize), value.fract() == 0.0) {
            return format!("{} {choice}", info.id);
        }
        let text = format!("{} {value} {}", info.id, info.unit);
        text.trim_end().to_owned()
    }
}

/// The value of every parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// Step size dt \[s\].
    pub step: f64,
    /// Number of equal parts of a step.
    pub substeps: f64,
    /// Gravity, downward [m/s²].
    pub gravity: f64,
    /// Restitution of the floor; `None` without a floor.
    pub restitution: Option<f64>,
    /// Restitution law, 0 or 1; `None` without a floor.
    pub restitution_law: Option<f64>,
    /// Friction of the floor; `None` without a floor.
    pub friction: Option<f64>,
    /// Linear drag c₁ [N s/m].
    pub linear_drag: f64,
    /// Angular damping γ [1/s].
    pub angular_damping: f64,
    /// Half-extents of the box \[m\].
    pub half_extents: DVec3,
    /// Mass \[kg\].
    pub mass: f64,
    /// Strength of a push \[N s\].
    pub impulse: f64,
    /// Number of boxes.
    pub boxes: f64,
}

impl Parameters {
    /// The default values of a scene, at 60 steps per second.
    pub fn of(scenario: &Scenario) -> Self {
        let setup = &scenario.setup;
        Self {
            step: 1.0 / 60.0,
            substeps: 1.0,
            gravity: -setup.forces.gravity.y,
            restitution: setup.floor.map(|f| f.restitution),
            restitution_law: setup.floor.map(|f| f64::from(f.restitution_law as u8)),
            friction: setup.floor.map(|f| f.friction),
            linear_drag: setup.forces.linear_drag,
            angular_damping: setup.forces.angular_damping,
            half_extents: setup.body.half_extents(),
            mass: setup.body.mass(),
            // A push changes the velocity by 1 m/s.
            impulse: setup.body.mass(),
            boxes: f64::from(scenario.boxes),
        }
    }

    /// Number of boxes.
    pub fn boxes(&self) -> u32 {
        self.boxes as u32
    }

    /// Substeps per step.
    pub fn substeps(&self) -> u32 {
        self.substeps as u32
    }

    fn slot(&mut self, parameter: Parameter) -> Option<&mut f64> {
        Some(match parameter {
            Parameter::Step => &mut self.step,
            Parameter::Substeps => &mut self.substeps,
            Parameter::Gravity => &mut self.gravity,
            Parameter::Restitution => self.restitution.as_mut()?,
            Parameter::RestitutionLaw => self.restitution_law.as_mut()?,
            Parameter::Friction => self.friction.as_mut()?,
            Parameter::LinearDrag => &mut self.linear_drag,
            Parameter::AngularDamping => &mut self.angular_damping,
            Parameter::HalfX => &mut self.half_extents.x,
            Parameter::HalfY => &mut self.half_extents.y,
            Parameter::HalfZ => &mut self.half_extents.z,
            Parameter::Mass => &mut self.mass,
            Parameter::Impulse => &mut self.impulse,
            Parameter::Boxes => &mut self.boxes,
        })
    }

    /// The value of a parameter; `None` if the scene does not have it.
    pub fn get(mut self, parameter: Parameter) -> Option<f64> {
        self.slot(parameter).copied()
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// A sentence with the name, the value and the allowed range.
    pub fn set(&mut self, parameter: Parameter, value: f64) -> Result<(), String> {
        let info = parameter.info();
        let mut new = *self;
        let Some(slot) = new.slot(parameter) else {
            return Err(format!("{}: this scene has no floor", info.id));
        };
        let (low, high) = info.range;
        if parameter.nearest(value) != Some(value) {
            let whole = ["", "whole numbers from "][usize::from(info.integer)];
            let allowed = format!("{whole}{low} to {high} {}", info.unit);
            let value = parameter.describe(value);
            return Err(format!("{value}: allowed: {}", allowed.trim_end()));
        }
        *slot = value;
        RigidBox::new(new.half_extents, new.mass)
            .map_err(|error| format!("{}: {error}", parameter.describe(value)))?;
        *self = new;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
