//! Errors of a file of reference states.

use std::path::PathBuf;

/// An error in a reference file. It names the file, and the field and its value if applicable.
#[derive(Debug, thiserror::Error)]
pub enum OracleError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file is not JSON; for example, a number is NaN or exceeds the range of f64.
    #[error("{}: not valid JSON: {source}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line, column and cause.
        source: serde_json::Error,
    },
    /// A field is missing.
    #[error("{}: {field} is missing", file.display())]
    Missing {
        /// The file.
        file: PathBuf,
        /// Path to the field, for example `forces.zero_length_spring.k`.
        field: String,
    },
    /// An unknown key in an object that must not contain any.
    #[error("{}: unknown key {field}; allowed here: {allowed}", file.display())]
    UnknownKey {
        /// The file.
        file: PathBuf,
        /// Path to the key.
        field: String,
        /// The known keys.
        allowed: String,
    },
    /// A value out of its range.
    #[error("{}: {field} must be {allowed}, but is {value}", file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// Path to the field.
        field: String,
        /// The allowed values.
        allowed: String,
        /// The value.
        value: String,
    },
}
