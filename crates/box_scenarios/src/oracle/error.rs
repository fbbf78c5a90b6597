//! What can be wrong with a file of reference states.

use std::path::PathBuf;

/// A file that cannot be used; names the file, and the field and its value where there is one.
#[derive(Debug, thiserror::Error)]
pub enum OracleError {
    /// It cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Read {
        /// Which.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not JSON (so a number is NaN or beyond f64, for instance).
    #[error("{}: not valid JSON: {source}", file.display())]
    Syntax {
        /// Which.
        file: PathBuf,
        /// Line, column, and what is wrong there.
        source: serde_json::Error,
    },
    /// A field is missing.
    #[error("{}: {field} is missing", file.display())]
    Missing {
        /// Which file.
        file: PathBuf,
        /// Path to the field, as in `forces.zero_length_spring.k`.
        field: String,
    },
    /// A key that the format does not have, where nothing may be ignored.
    #[error("{}: unknown key {field}; allowed here: {allowed}", file.display())]
    UnknownKey {
        /// Which file.
        file: PathBuf,
        /// Path to the key.
        field: String,
        /// The keys that there are.
        allowed: String,
    },
    /// A value that cannot be.
    #[error("{}: {field} must be {allowed}, but is {value}", file.display())]
    Invalid {
        /// Which file.
        file: PathBuf,
        /// Path to the field.
        field: String,
        /// The allowed values.
        allowed: String,
        /// The value.
        value: String,
    },
}
