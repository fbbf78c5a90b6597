//! Scene files in RON, documented in `assets/scenes/example.ron`.
//!
//! [`load`] reads a scene and [`to_ron`] writes it; a written scene reads back bit for bit. Every error names file,
//! line, column and field. No file can make the reader panic or hang: its size is limited to [`MAX_BYTES`], and the
//! values of a scene are limited ([`MAX_DURATION`], [`MAX_TURNS`]; errors state the other ranges).
//!
//! ```
//! use box_scenarios::{Scenario, scene_file};
//! let scene = Scenario::find("bounce")?;
//! let text = scene_file::to_ron(&scene);
//! assert_eq!(scene_file::parse("bounce.ron".as_ref(), &text)?, scene);
//! let error = scene_file::parse("x.ron".as_ref(), "(\n  duration: -1,\n)").unwrap_err();
//! assert!(error.to_string().starts_with("x.ron:"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod check;
mod error;
mod form;
mod intern;

use std::io::Read as _;
use std::path::Path;

use ron::de::Deserializer;
use ron::extensions::Extensions;
use ron::options::Options;
use ron::ser::PrettyConfig;

use crate::scenario::Scenario;
pub use check::{MAX_DURATION, MAX_TURNS};
pub use error::SceneFileError;
use form::SceneForm;

/// Maximum file size \[bytes\].
pub const MAX_BYTES: u64 = 256 * 1024;

/// Reads the scene in `path`.
///
/// # Errors
/// [`SceneFileError`] if it cannot be read or is not a scene.
pub fn load(path: &Path) -> Result<Scenario, SceneFileError> {
    let unreadable = |reason: String| SceneFileError::whole(path, reason);
    let file = std::fs::File::open(path).map_err(|e| unreadable(e.to_string()))?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| unreadable(e.to_string()))?;
    from_bytes(path, &bytes)
}

/// Reads the scene in `bytes`; `file` is only used in errors.
///
/// # Errors
/// The same as [`load`].
pub fn from_bytes(file: &Path, bytes: &[u8]) -> Result<Scenario, SceneFileError> {
    if bytes.len() as u64 > MAX_BYTES {
        let text = format!("the file is too long (allowed: up to {MAX_BYTES} bytes)");
        return Err(SceneFileError::whole(file, text));
    }
    match core::str::from_utf8(bytes) {
        Ok(text) => parse(file, text),
        Err(error) => {
            let good = bytes.get(..error.valid_up_to()).unwrap_or_default();
            let good = core::str::from_utf8(good).unwrap_or_default();
            let message = "not UTF-8 text".to_owned();
            Err(SceneFileError::after(file, good, message))
        }
    }
}

/// Reads the scene in `text`; `file` is only used in errors.
///
/// # Errors
/// The same as [`load`].
pub fn parse(file: &Path, text: &str) -> Result<Scenario, SceneFileError> {
    let mut reader = Deserializer::from_str_with_options(text, &options())
        .map_err(|error| SceneFileError::value(file, &error, ""))?;
    let form: Result<SceneForm, _> = serde_path_to_error::deserialize(&mut reader);
    let form = form.map_err(|error| {
        let path = error.path().to_string();
        SceneFileError::value(file, &reader.span_error(error.into_inner()), &path)
    })?;
    reader
        .end()
        .map_err(|error| SceneFileError::value(file, &reader.span_error(error), ""))?;
    form.into_scenario()
        .map_err(|reason| SceneFileError::scene(file, reason))
}

/// Writes `scene` as the text of a scene file.
pub fn to_ron(scene: &Scenario) -> String {
    let pretty = PrettyConfig::new()
        .depth_limit(3)
        .indentor("    ")
        .compact_arrays(true);
    options()
        .to_string_pretty(&SceneForm::of(scene), pretty)
        .map(|text| text + "\n")
        .unwrap_or_else(|error| unreachable!("a scene is plain data, but: {error}"))
}

/// Accepts `floor: (…)` without `Some`.
fn options() -> Options {
    Options::default().with_default_extension(Extensions::IMPLICIT_SOME)
}

#[cfg(test)]
mod tests;
