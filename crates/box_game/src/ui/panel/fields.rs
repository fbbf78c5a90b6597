//! What can be set by a number: its name, unit, range, and what it is.

/// One number of the side panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Field {
    /// Name on the panel; no two fields share one.
    pub label: &'static str,
    /// Unit, or nothing.
    pub unit: &'static str,
    /// What it is, for the tooltip.
    pub hint: &'static str,
    /// Ends of the slider.
    pub slider: (f64, f64),
    /// What may be typed: the limits of [`Action`](crate::action::Action), and finite ones where it
    /// gives none, so that nothing overflows.
    pub hard: (f64, f64),
    /// Whether the slider is logarithmic.
    pub logarithmic: bool,
    /// Whether it is a count.
    pub integer: bool,
    /// Whether a change restarts the scene; sent when the mouse lets go.
    pub restarts: bool,
}

impl Field {
    /// The nearest allowed value; `None` for NaN.
    pub(super) fn allowed(&self, value: f64) -> Option<f64> {
        if value.is_nan() {
            return None;
        }
        let value = value.clamp(self.hard.0, self.hard.1);
        Some(if self.integer { value.round() } else { value })
    }

    /// As screen readers and tests call its slider: `Gravity [m/s²]`.
    pub(super) fn slider_name(&self) -> String {
        if self.unit.is_empty() {
            self.label.to_owned()
        } else {
            format!("{} [{}]", self.label, self.unit)
        }
    }

    /// As screen readers and tests call its number: `Gravity value [m/s²]`.
    pub(super) fn value_name(&self) -> String {
        if self.unit.is_empty() {
            format!("{} value", self.label)
        } else {
            format!("{} value [{}]", self.label, self.unit)
        }
    }
}

/// A plain field with a linear slider; the constants below change what differs.
const PLAIN: Field = Field {
    label: "",
    unit: "",
    hint: "",
    slider: (0.0, 1.0),
    hard: (0.0, 1e6),
    logarithmic: false,
    integer: false,
    restarts: false,
};

pub(super) const STEP: Field = Field {
    label: "dt",
    unit: "s",
    hint: "Step size. Type 0.01, 1/60 or 60 Hz.",
    slider: (1.0 / 1920.0, 0.5),
    hard: (1.0 / 1920.0, 0.5),
    logarithmic: true,
    ..PLAIN
};
pub(super) const SUBSTEPS: Field = Field {
    label: "Substeps",
    hint: "Each step is taken in this many equal parts.",
    slider: (1.0, 64.0),
    hard: (1.0, 64.0),
    logarithmic: true,
    integer: true,
    ..PLAIN
};
pub(super) const GRAVITY: Field = Field {
    label: "Gravity",
    unit: "m/s²",
    hint: "Acceleration downwards.",
    slider: (0.0, 30.0),
    hard: (-1e4, 1e4),
    ..PLAIN
};
pub(super) const RESTITUTION: Field = Field {
    label: "Restitution",
    hint: "Speed after a bounce over speed before it: 0 stays down, 1 bounces for ever.",
    hard: (0.0, 1.0),
    ..PLAIN
};
pub(super) const FRICTION: Field = Field {
    label: "Friction",
    hint: "Coulomb's coefficient of the floor.",
    slider: (0.0, 2.0),
    hard: (0.0, 1e3),
    ..PLAIN
};
pub(super) const LINEAR_DRAG: Field = Field {
    label: "Linear drag",
    unit: "N s/m",
    hint: "Force against the velocity, c₁ v.",
    slider: (0.0, 100.0),
    logarithmic: true,
    ..PLAIN
};
pub(super) const ANGULAR_DAMPING: Field = Field {
    label: "Ang. damping",
    unit: "1/s",
    hint: "Torque against the angular momentum, γ L.",
    slider: (0.0, 10.0),
    logarithmic: true,
    ..PLAIN
};
/// Half-extents along x, y, z.
pub(super) const HALF_EXTENTS: [Field; 3] = [
    half_extent(
        "Half-size x",
        "Half the length of the box along its own x axis.",
    ),
    half_extent(
        "Half-size y",
        "Half the length of the box along its own y axis.",
    ),
    half_extent(
        "Half-size z",
        "Half the length of the box along its own z axis.",
    ),
];
pub(super) const MASS: Field = Field {
    label: "Mass",
    unit: "kg",
    hint: "Mass of the box, evenly spread.",
    slider: (0.1, 100.0),
    hard: (1e-6, 1e6),
    logarithmic: true,
    restarts: true,
    ..PLAIN
};
pub(super) const IMPULSE: Field = Field {
    label: "Strength",
    unit: "N s",
    hint: "Impulse of one push.",
    slider: (0.01, 100.0),
    logarithmic: true,
    ..PLAIN
};
pub(super) const BOXES: Field = Field {
    label: "Boxes",
    hint: "Number of boxes: more work makes the timing steadier.",
    slider: (1.0, 10_000.0),
    hard: (1.0, 10_000.0),
    logarithmic: true,
    integer: true,
    restarts: true,
    ..PLAIN
};

const fn half_extent(label: &'static str, hint: &'static str) -> Field {
    Field {
        label,
        hint,
        unit: "m",
        slider: (0.05, 5.0),
        hard: (1e-3, 1e3),
        logarithmic: true,
        restarts: true,
        ..PLAIN
    }
}

/// Step sizes by one click \[Hz\].
pub(super) const RATES: [u32; 4] = [30, 60, 120, 240];

/// Target speeds, slowest first: what "slower" and "faster" step through; 1 is real time.
pub const SPEEDS: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_sane() {
        let mut fields = vec![
            STEP,
            SUBSTEPS,
            GRAVITY,
            RESTITUTION,
            FRICTION,
            LINEAR_DRAG,
            ANGULAR_DAMPING,
            MASS,
            IMPULSE,
            BOXES,
        ];
        fields.extend(HALF_EXTENTS);
        for (k, field) in fields.iter().enumerate() {
            assert!(
                field.hard.0 <= field.slider.0 && field.slider.1 <= field.hard.1,
                "{field:?}"
            );
            assert!(field.hint.ends_with('.'));
            assert!(fields[..k].iter().all(|other| other.label != field.label));
            for bad in [f64::NEG_INFINITY, f64::INFINITY, -1e300, 1e300, 0.0] {
                let value = field.allowed(bad).expect("only NaN has no neighbor");
                assert!(value.is_finite() && value >= field.hard.0 && value <= field.hard.1);
            }
            assert_eq!(field.allowed(f64::NAN), None);
        }
        assert_eq!(SUBSTEPS.allowed(2.6), Some(3.0));
        assert!(SPEEDS.is_sorted() && SPEEDS.contains(&1.0));
    }
}
