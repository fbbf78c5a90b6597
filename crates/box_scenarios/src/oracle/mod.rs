//! Reference trajectories from files, in the format of `tests/oracle/README.md`.
//!
//! One JSON file is one case. Everything that determines the motion is checked: an unknown key under `forces`, `events`
//! or `contact` is an error that names it, so that a case never runs under a different force model. Other keys
//! (`description`, `reference`, …) are ignored.

mod error;
mod field;
mod force_model;
mod measure;
mod samples;

use std::io::{Error, ErrorKind, Read as _};
use std::path::{Path, PathBuf};

use box_physics::body::RigidBox;
use box_physics::state::BodyState;
use glam::{DQuat, DVec3};

pub use error::OracleError;
use field::Field;
pub use measure::{Limits, MAX_ERRORS, Measurement, Outcome};

use crate::setup::Setup;

/// A reference trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Name of the case.
    pub name: String,
    /// Kind of motion, as stated in the file.
    pub kind: String,
    /// The file.
    pub file: PathBuf,
    /// Body, start, forces, floor, impulses; the duration is the time of the last sample.
    pub setup: Setup,
    /// The reference, in order of time.
    pub samples: Vec<Sample>,
}

/// A reference state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time \[s\]; at the time of an impulse, just before it.
    pub t: f64,
    /// The state.
    pub state: BodyState,
    /// Kinetic plus potential energy \[J\], if the file prescribes it.
    pub energy: Option<f64>,
}

/// Maximum file size. The largest of our files has a thousandth of it.
const MAX_BYTES: u64 = 32 << 20;

impl Case {
    /// Reads one file.
    ///
    /// # Errors
    /// [`OracleError`] names the file, the field and its value.
    pub fn load(file: &Path) -> Result<Self, OracleError> {
        let failed = |source| OracleError::Read {
            file: file.to_owned(),
            source,
        };
        let mut bytes = Vec::new();
        let opened = std::fs::File::open(file).map_err(failed)?;
        (opened.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(failed)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(failed(ErrorKind::FileTooLarge.into()));
        }
        let text =
            String::from_utf8(bytes).map_err(|e| failed(Error::new(ErrorKind::InvalidData, e)))?;
        Self::parse(file, &text)
    }

    /// Parses the case in `text`; `file` is only used in errors.
    ///
    /// # Errors
    /// The same as [`Case::load`].
    pub fn parse(file: &Path, text: &str) -> Result<Self, OracleError> {
        let json = serde_json::from_str(text).map_err(|source| OracleError::Syntax {
            file: file.to_owned(),
            source,
        })?;
        let root = Field::root(file, &json);
        root.object()?;
        let body = read_body(&root.require("body")?)?;
        let initial = read_initial(&root.require("initial")?, &body)?;
        let kind = root.require("kind")?.text()?.to_owned();
        let floor = force_model::read_contact(&root, &kind)?;
        let samples = samples::read(&root.require("samples")?, &body)?;
        let duration = samples.last().map_or(0.0, |s| s.t);
        Ok(Self {
            name: root.require("name")?.text()?.to_owned(),
            kind,
            file: file.to_owned(),
            setup: Setup {
                forces: force_model::read_forces(root.get("forces")?)?,
                floor,
                impulses: force_model::read_events(root.get("events")?)?,
                body,
                initial,
                duration,
            },
            samples,
        })
    }

    /// Loads every `*.json` file of `folder`, sorted by file name. Each may fail separately.
    ///
    /// # Errors
    /// [`OracleError::Read`] if the folder cannot be listed.
    pub fn load_folder(folder: &Path) -> Result<Vec<Result<Self, OracleError>>, OracleError> {
        let failed = |source| OracleError::Read {
            file: folder.to_owned(),
            source,
        };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.is_file()
                && path
                    .extension()
                    .is_some_and(|e| e.eq_ignore_ascii_case("json"))
            {
                files.push(path);
            }
        }
        files.sort();
        Ok(files.iter().map(|f| Self::load(f)).collect())
    }

    /// Expected energy of a sample \[J\], with the zero level of [`Setup::energy`]: the prescribed energy, or the
    /// initial one if it is conserved. `None` if neither is known.
    pub fn expected_energy(&self, sample: &Sample) -> Option<f64> {
        let own = self.setup.energy(&self.setup.initial);
        match sample.energy {
            // A file may use a different zero level for the potential. Its first value reveals it, if that is the
            // initial energy.
            Some(energy) => Some(match self.samples.first() {
                Some(Sample {
                    t: 0.0,
                    energy: Some(first),
                    ..
                }) => own + (energy - first),
                _ => energy,
            }),
            None => self.setup.conserves_energy().then_some(own),
        }
    }
}

fn read_body(f: &Field) -> Result<RigidBox, OracleError> {
    let (half, mass) = (f.require("half_extents")?, f.require("mass")?);
    let invalid = |e| f.invalid(&e);
    let solid = RigidBox::new(half.vector()?, mass.number()?).map_err(invalid)?;
    match f.get("inertia_diag_body")? {
        Some(i) => solid.with_inertia(i.vector()?).map_err(|e| i.invalid(&e)),
        None => Ok(solid),
    }
}

fn read_initial(f: &Field, body: &RigidBox) -> Result<BodyState, OracleError> {
    let state = BodyState::at_pose(
        f.require("position")?.vector()?,
        rotation(&f.require("quaternion_xyzw")?)?,
    )
    .with_velocity(f.require("velocity")?.vector()?);
    Ok(match f.get("angular_velocity_body")? {
        Some(local) => state.with_body_angular_velocity(body, local.vector()?),
        None => state.with_angular_velocity(body, f.require("angular_velocity_world")?.vector()?),
    })
}

/// Reads a quaternion x, y, z, w whose length is not zero.
fn rotation(f: &Field) -> Result<DQuat, OracleError> {
    let q = DQuat::from_array(f.numbers()?);
    // A quaternion far from unit length is not a rounded rotation, and its meaning is unknown. The square of the length
    // must neither vanish nor overflow.
    let length = q.length();
    if length.is_finite() && length > 1e-6 {
        Ok(q)
    } else {
        Err(f.error("a nonzero quaternion"))
    }
}

/// Converts a world vector to body axes.
fn to_body(rotation: DQuat, world: DVec3) -> DVec3 {
    rotation.inverse() * world
}
