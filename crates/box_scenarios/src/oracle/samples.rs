//! The reference states of a file.

use box_physics::body::RigidBox;
use box_physics::state::BodyState;

use super::field::Field;
use super::{OracleError, Sample, rotation, to_body};

/// Reads all samples; their times must increase.
pub(super) fn read(f: &Field, body: &RigidBox) -> Result<Vec<Sample>, OracleError> {
    let mut samples: Vec<Sample> = Vec::new();
    for s in f.list()? {
        let time = s.require("t")?;
        let t = time.coefficient()?;
        if let Some(before) = samples.last().filter(|before| t <= before.t) {
            return Err(time.error(format!("later than the previous sample ({})", before.t)));
        }
        samples.push(read_one(&s, body, t)?);
    }
    if samples.is_empty() {
        return Err(f.error("a list with at least one sample"));
    }
    Ok(samples)
}

fn read_one(s: &Field, body: &RigidBox, t: f64) -> Result<Sample, OracleError> {
    let mut state = BodyState::at_pose(
        s.require("position")?.vector()?,
        rotation(&s.require("quaternion_xyzw")?)?,
    )
    .with_velocity(s.require("velocity")?.vector()?)
    .with_angular_velocity(body, s.require("angular_velocity_world")?.vector()?);
    if let Some(l) = s.get("angular_momentum_world")? {
        state.angular_momentum = to_body(state.rotation, l.vector()?);
    }
    let energy = s.get("energy")?.map(|e| e.number()).transpose()?;
    Ok(Sample { t, state, energy })
}
