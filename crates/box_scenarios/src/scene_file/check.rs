//! Limits of a scene file: wide enough for users, narrow enough to be computed in seconds.

use core::fmt::Display;

use box_physics::body::RigidBox;
use box_physics::integrators::Integrator;
use glam::{DQuat, DVec3};
use serde::de::{Deserialize, Deserializer, Error};

use crate::limits;
use crate::setup::Setup;

/// Maximum duration of a scene \[s\].
pub const MAX_DURATION: f64 = 600.0;

/// Maximum duration of a scene times the fastest rate of its motion \[rad\]. A reference solution costs some
/// microseconds per radian, and is computed when the scene starts.
pub const MAX_TURNS: f64 = 2e4;

/// Maximum length of a text [characters].
const MAX_TEXT_LENGTH: usize = 400;

fn refused<T, E: Error>(reason: impl Display) -> Result<T, E> {
    Err(E::custom(reason))
}

pub(super) fn id<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let id = String::deserialize(from)?;
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if id.is_empty() || id.len() > 40 || !id.chars().all(plain) {
        return refused("must be 1 to 40 lower-case letters, digits and hyphens");
    }
    Ok(id)
}

pub(super) fn title<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    let title = line(from)?;
    if title.trim().is_empty() {
        return refused("must not be empty");
    }
    Ok(title)
}

pub(super) fn line<'de, D: Deserializer<'de>>(from: D) -> Result<String, D::Error> {
    Line::deserialize(from).map(|line| line.0)
}

/// A text on one line.
struct Line(String);

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let text = String::deserialize(from)?;
        if text.chars().count() > MAX_TEXT_LENGTH || text.chars().any(char::is_control) {
            return refused(format_args!(
                "must be one line of at most {MAX_TEXT_LENGTH} characters"
            ));
        }
        Ok(Self(text))
    }
}

pub(super) fn hints<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    let hints: Vec<Line> = limits::at_most(from, 2)?;
    Ok(hints.into_iter().map(|line| line.0).collect())
}

/// The id of an existing integrator.
struct Known(String);

impl<'de> Deserialize<'de> for Known {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let id = String::deserialize(from)?;
        match id.parse::<Integrator>() {
            Ok(_) => Ok(Self(id)),
            Err(error) => refused(error),
        }
    }
}

pub(super) fn recommended<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<String>, D::Error> {
    let ids: Vec<Known> = limits::at_most(from, Integrator::ALL.len())?;
    Ok(ids.into_iter().map(|id| id.0).collect())
}

pub(super) fn boxes<'de, D: Deserializer<'de>>(from: D) -> Result<u32, D::Error> {
    match u32::deserialize(from)? {
        boxes @ 1..=10_000 => Ok(boxes),
        boxes => refused(format_args!("must be between 1 and 10000, but is {boxes}")),
    }
}

pub(super) fn duration<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    limits::number(
        from,
        f64::MIN_POSITIVE..=MAX_DURATION,
        "above 0 and at most 600 s",
    )
}

pub(super) fn half_extents<'de, D: Deserializer<'de>>(from: D) -> Result<DVec3, D::Error> {
    let allowed = "between 0.0001 and 1000 m";
    limits::within(DVec3::deserialize(from)?, 1e-4..=1e3, allowed)
}

pub(super) fn mass<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    limits::number(from, 1e-6..=1e6, "between 1e-6 and 1e6 kg")
}

/// Reads an attitude; a unit quaternion keeps its bits.
pub(super) fn rotation<'de, D: Deserializer<'de>>(from: D) -> Result<DQuat, D::Error> {
    let rotation = DQuat::deserialize(from)?;
    let norm = rotation.length();
    if !(norm.is_finite() && (0.5..2.0).contains(&norm)) {
        return refused("must be a quaternion (x, y, z, w) of length 1");
    }
    Ok(if (norm - 1.0).abs() < 1e-12 {
        rotation
    } else {
        rotation / norm
    })
}

/// Checks the conditions between the parts of a setup.
///
/// # Errors
/// A description of the violated condition.
pub(super) fn setup(setup: &Setup) -> Result<(), String> {
    setup.validate().map_err(|e| e.to_string())?;
    let turns = fastest(setup) * setup.duration;
    if turns.is_nan() || turns > MAX_TURNS {
        return Err(format!(
            "duration times the fastest rate of the motion is {turns:.3e} rad (allowed: up to {MAX_TURNS:e}); reduce the duration, spin, springs or drag"
        ));
    }
    Ok(())
}

/// An upper bound on the rates of the motion [rad/s]: spin, springs and drag, and the changes by forces and impulses
/// during the scene.
fn fastest(setup: &Setup) -> f64 {
    let (body, f) = (&setup.body, &setup.forces);
    let (mass, least) = (body.mass(), body.inertia().min_element());
    let arm = |r: DVec3| 1.0 / mass + r.length_squared() / least;
    let spring_rate = f
        .springs
        .iter()
        .map(|s| (s.stiffness * arm(s.body_point)).sqrt() + s.damping * arm(s.body_point))
        .sum::<f64>();
    // A torque τ turns a body at most at the rate √(τ/I); over the time T it adds τT/I to the spin.
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
    // Linear drag and damping alone have closed forms; they count only together with other forces.
    let drag = f.linear_drag / mass + f.angular_damping + f.angular_drag / least;
    let closed = !f.has_wrench() && f.quadratic_drag == 0.0 && f.angular_drag == 0.0;
    let drag = if closed { 0.0 } else { drag };
    spin + spring_rate + drag + f.quadratic_drag * speed / mass
}

fn initial_spin(body: &RigidBox, setup: &Setup) -> f64 {
    (body.inverse_inertia() * setup.initial.angular_momentum).length()
}

/// Bound on the rate due to a constant torque: the rate √(τ/I) of a swing, or the spin that it adds within 1 s,
/// whichever is larger. Counting the added spin over the whole duration would be safe but too strict.
fn torque_spin(torque: f64, setup: &Setup) -> f64 {
    let per_inertia = torque / setup.body.inertia().min_element();
    per_inertia
        .sqrt()
        .max(per_inertia * setup.duration.min(1.0))
}
