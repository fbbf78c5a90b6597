//! What a scene may ask for: everything that a person would want, and nothing that takes for ever.

use box_physics::body::RigidBox;
use box_physics::error::InvalidValue;
use box_physics::integrators::Integrator;
use glam::DVec3;

use super::form::SceneForm;
use crate::setup::Setup;
use crate::view::SceneView;

/// The longest scene \[s\].
pub const LONGEST: f64 = 600.0;

/// The most radians that the fastest motion of a scene may take in its duration: a reference solution costs
/// some microseconds a radian, and is computed when the scene starts.
pub const MOST_TURNS: f64 = 2e4;

/// The largest number of any kind, in its SI unit.
const LARGEST: f64 = 1e6;
/// Limits of the half-extents \[m\] and the mass \[kg\].
const SIZES: (f64, f64) = (1e-3, 1e3);
const MASSES: (f64, f64) = (1e-3, 1e6);
/// The most springs, forces at points, impulses.
const MANY: usize = 64;
/// The longest text [characters].
const LONG: usize = 400;

/// A value that is not allowed, and where it stands: `forces.springs.stiffness`.
#[derive(Debug, PartialEq)]
pub(super) struct BadValue {
    pub(super) field: String,
    /// What is wrong, to follow the field's name.
    pub(super) reason: String,
    /// The value, if it is a number: which of several springs is meant.
    pub(super) value: Option<f64>,
}

impl BadValue {
    pub(super) fn new(field: impl Into<String>, reason: impl Into<String>) -> Self {
        Self {
            field: field.into(),
            reason: reason.into(),
            value: None,
        }
    }

    /// A complaint of the library about a value inside `parent`.
    pub(super) fn of(parent: &str, error: &InvalidValue) -> Self {
        let dot = if parent.is_empty() { "" } else { "." };
        Self {
            field: format!("{parent}{dot}{}", error.field),
            reason: format!("must be {}, but is {}", error.allowed, error.value),
            value: Some(error.value),
        }
    }

    fn number(field: &str, value: f64, allowed: &str) -> Self {
        Self {
            field: field.to_owned(),
            reason: format!("must be {allowed}, but is {value}"),
            value: Some(value),
        }
    }
}

pub(super) fn texts(form: &SceneForm) -> Result<(), BadValue> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if form.id.is_empty() || form.id.len() > 40 || !form.id.chars().all(plain) {
        return Err(BadValue::new(
            "id",
            "must be 1 to 40 lower-case letters, digits and hyphens",
        ));
    }
    if form.title.trim().is_empty() {
        return Err(BadValue::new("title", "must not be empty"));
    }
    for (field, text) in [("title", &form.title), ("lesson", &form.lesson)]
        .into_iter()
        .chain(form.hints.iter().map(|hint| ("hints", hint)))
    {
        if text.chars().count() > LONG || text.chars().any(char::is_control) {
            return Err(BadValue::new(
                field,
                format!("must be one line of at most {LONG} characters"),
            ));
        }
    }
    if form.hints.len() > 2 {
        return Err(BadValue::new("hints", "has room for two"));
    }
    for name in &form.recommended {
        if let Err(error) = name.parse::<Integrator>() {
            return Err(BadValue::new("recommended", error.to_string()));
        }
    }
    if form.recommended.len() > Integrator::ALL.len() {
        return Err(BadValue::new("recommended", "names an integrator twice"));
    }
    if !(1..=10_000).contains(&form.boxes) {
        let (boxes, allowed) = (f64::from(form.boxes), "between 1 and 10000");
        return Err(BadValue::number("boxes", boxes, allowed));
    }
    Ok(())
}

pub(super) fn size(half_extents: DVec3, mass: f64) -> Result<(), BadValue> {
    for h in half_extents.to_array() {
        if !(SIZES.0..=SIZES.1).contains(&h) {
            return Err(BadValue::number(
                "body.half_extents",
                h,
                "between 0.001 and 1000 m",
            ));
        }
    }
    if !(MASSES.0..=MASSES.1).contains(&mass) {
        return Err(BadValue::number(
            "body.mass",
            mass,
            "between 0.001 and 1e6 kg",
        ));
    }
    Ok(())
}

pub(super) fn view(view: &SceneView) -> Result<(), BadValue> {
    if !(-85.0..=85.0).contains(&view.pitch) {
        return Err(BadValue::number(
            "view.pitch",
            view.pitch,
            "between -85 and 85 degrees",
        ));
    }
    if !(-360.0..=360.0).contains(&view.yaw) {
        return Err(BadValue::number(
            "view.yaw",
            view.yaw,
            "between -360 and 360 degrees",
        ));
    }
    if let Some(distance) = view.distance.filter(|d| !(0.01..=1e4).contains(d)) {
        return Err(BadValue::number(
            "view.distance",
            distance,
            "between 0.01 and 10000 m",
        ));
    }
    within("view.target", view.target.unwrap_or_default())
}

/// A vector of numbers that a scene may have.
fn within(field: &str, v: DVec3) -> Result<(), BadValue> {
    match v
        .to_array()
        .into_iter()
        .find(|c| c.is_nan() || c.abs() > LARGEST)
    {
        None => Ok(()),
        Some(value) => Err(BadValue::number(field, value, "between -1e6 and 1e6")),
    }
}

/// What the library asks of a setup, and the limits of a file.
pub(super) fn setup(setup: &Setup) -> Result<(), BadValue> {
    let f = &setup.forces;
    f.validate().map_err(|e| BadValue::of("forces", &e))?;
    if !(setup.duration > 0.0 && setup.duration <= LONGEST) {
        let allowed = "above 0 and at most 600 s";
        return Err(BadValue::number("duration", setup.duration, allowed));
    }
    for (field, v) in [
        ("start.position", setup.initial.position),
        ("start.velocity", setup.initial.velocity),
        ("start.angular_momentum", setup.initial.angular_momentum),
        ("forces.gravity", f.gravity),
        ("forces.force", f.force),
        ("forces.body_torque", f.body_torque),
        ("forces.world_torque", f.world_torque),
        (
            "forces.linear_drag",
            DVec3::new(f.linear_drag, f.quadratic_drag, f.angular_drag),
        ),
        ("forces.angular_damping", DVec3::X * f.angular_damping),
    ] {
        within(field, v)?;
    }
    for p in &f.point_forces {
        within("forces.point_forces.body_point", p.body_point)?;
        within("forces.point_forces.force", p.force)?;
    }
    for s in &f.springs {
        within("forces.springs.body_point", s.body_point)?;
        within("forces.springs.anchor", s.anchor)?;
        within("forces.springs.stiffness", DVec3::X * s.stiffness)?;
        within("forces.springs.damping", DVec3::X * s.damping)?;
    }
    for i in &setup.impulses {
        within("impulses.impulse", i.impulse)?;
        within("impulses.body_point", i.body_point)?;
    }
    for (field, count) in [
        ("forces.springs", f.springs.len()),
        ("forces.point_forces", f.point_forces.len()),
        ("impulses", setup.impulses.len()),
    ] {
        if count > MANY {
            return Err(BadValue::new(field, format!("has room for {MANY}")));
        }
    }
    if let Some(floor) = &setup.floor {
        within("floor.height", DVec3::Y * floor.height)?;
        within("floor.friction", DVec3::X * floor.friction)?;
    }
    setup.validate().map_err(|e| BadValue::of("", &e))?;
    let turns = fastest(setup) * setup.duration;
    if turns.is_nan() || turns > MOST_TURNS {
        return Err(BadValue::new(
            "duration",
            format!(
                "times the fastest rate of the motion is {turns:.3e} rad, and {MOST_TURNS:e} are allowed: shorten it, or make spin, springs and drag weaker"
            ),
        ));
    }
    Ok(())
}

/// A bound on the rates of the motion [rad/s]: spin, springs, drag, and what the forces and impulses can
/// make of them in the scene's time.
fn fastest(setup: &Setup) -> f64 {
    let (body, f) = (&setup.body, &setup.forces);
    let (mass, least) = (body.mass(), body.inertia().min_element());
    let arm = |r: DVec3| 1.0 / mass + r.length_squared() / least;
    let spring_rate = f
        .springs
        .iter()
        .map(|s| (s.stiffness * arm(s.body_point)).sqrt() + s.damping * arm(s.body_point))
        .sum::<f64>();
    // A torque τ turns a body by at most √(τ/I) radians a second per radian; over the time T it adds τT/I.
    let torque = f.body_torque.length()
        + f.world_torque.length()
        + f.point_forces
            .iter()
            .map(|p| p.force.length() * p.body_point.length())
            .sum::<f64>();
    let kicks = setup.impulses.iter();
    let kick = kicks.map(|i| i.impulse.length() * i.body_point.length());
    let spin = initial_spin(body, setup) + kick.sum::<f64>() / least + torque_spin(torque, setup);
    let pull: f64 = f
        .springs
        .iter()
        .map(|s| s.stiffness * (setup.initial.position - s.anchor).length())
        .sum();
    let speed = setup.initial.velocity.length()
        + setup
            .impulses
            .iter()
            .map(|i| i.impulse.length())
            .sum::<f64>()
            / mass
        + (f.acceleration(body).length() + pull / mass) * setup.duration;
    // Linear drag and damping alone have closed forms; with anything else they count.
    let drag = f.linear_drag / mass + f.angular_damping + f.angular_drag / least;
    let closed = !f.has_wrench() && f.quadratic_drag == 0.0 && f.angular_drag == 0.0;
    let drag = if closed { 0.0 } else { drag };
    spin + spring_rate + drag + f.quadratic_drag * speed / mass
}

fn initial_spin(body: &RigidBox, setup: &Setup) -> f64 {
    (body.inverse_inertia() * setup.initial.angular_momentum).length()
}

/// What a constant torque can add to the spin in the scene's time, or, if it swings the body instead,
/// its rate: the smaller of both would do; the larger is safe only where it is affordable, so the swing
/// is counted in full and the growth up to the limit.
fn torque_spin(torque: f64, setup: &Setup) -> f64 {
    let per_inertia = torque / setup.body.inertia().min_element();
    per_inertia
        .sqrt()
        .max(per_inertia * setup.duration.min(1.0))
}
