//! Reads `forces`, `contact` and `events`. They determine the motion, so unknown keys are rejected.

use glam::DVec3;

use super::OracleError;
use super::field::Field;
use crate::forces::ForceSet;
use crate::setup::{FloorSpec, TimedImpulse};

/// Reads the force model; `None` yields an empty one.
pub(super) fn read_forces(f: Option<Field>) -> Result<ForceSet, OracleError> {
    let Some(f) = f else {
        return Ok(ForceSet::none());
    };
    f.only(&[
        "gravity",
        "linear_drag_c",
        "quadratic_drag_k",
        "angular_damping_rate",
        "angular_drag_c",
        "constant_body_torque",
        "dipole",
        "zero_length_spring",
    ])?;
    let vector = |key| f.get(key)?.map_or(Ok(DVec3::ZERO), |v| v.vector());
    let coefficient = |key| f.get(key)?.map_or(Ok(0.0), |v| v.coefficient());
    let mut set = ForceSet {
        gravity: vector("gravity")?,
        linear_drag: coefficient("linear_drag_c")?,
        quadratic_drag: coefficient("quadratic_drag_k")?,
        angular_damping: coefficient("angular_damping_rate")?,
        angular_drag: coefficient("angular_drag_c")?,
        body_torque: vector("constant_body_torque")?,
        ..ForceSet::none()
    };
    if let Some(d) = f.get("dipole")? {
        d.only(&["moment_body", "field_world"])?;
        let moment = d.require("moment_body")?.vector()?;
        set = set.with_dipole(moment, d.require("field_world")?.vector()?);
    }
    if let Some(s) = f.get("zero_length_spring")? {
        s.only(&["k", "body_point", "anchor"])?;
        set = set.with_spring(
            s.require("body_point")?.vector()?,
            s.require("anchor")?.vector()?,
            s.require("k")?.coefficient()?,
            0.0,
        );
    }
    Ok(set)
}

/// Reads the floor y = 0 of a contact case.
pub(super) fn read_contact(root: &Field, kind: &str) -> Result<Option<FloorSpec>, OracleError> {
    let contact = if kind == "contact" {
        Some(root.require("contact")?)
    } else {
        root.get("contact")?
    };
    let Some(c) = contact else {
        return Ok(None);
    };
    c.only(&["restitution", "friction"])?;
    let e = c.require("restitution")?;
    let floor = FloorSpec::at_zero(e.number()?, c.require("friction")?.coefficient()?);
    match floor.validate() {
        Ok(()) => Ok(Some(floor)),
        Err(_) => Err(e.error("between 0 and 1")),
    }
}

/// Reads impulses and sorts them by time; impulses at the same time keep the order of the file.
pub(super) fn read_events(f: Option<Field>) -> Result<Vec<TimedImpulse>, OracleError> {
    let Some(f) = f else {
        return Ok(Vec::new());
    };
    let mut events = Vec::new();
    for e in f.list()? {
        e.only(&["t", "impulse_world", "body_point"])?;
        events.push(TimedImpulse {
            t: e.require("t")?.coefficient()?,
            impulse: e.require("impulse_world")?.vector()?,
            body_point: e.require("body_point")?.vector()?,
        });
    }
    events.sort_by(|a, b| a.t.total_cmp(&b.t));
    Ok(events)
}
