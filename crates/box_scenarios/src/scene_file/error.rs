//! Errors of a scene file with their location.

use std::path::{Path, PathBuf};

use ron::error::{Error as RonError, SpannedError};

/// A scene file that cannot be used. Shown as `file:line:column: field: what is wrong`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}:{line}:{column}: {}{message}", file.display(), of(field))]
pub struct SceneFileError {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1; 0 for errors about the whole file.
    pub line: usize,
    /// Column in characters, from 1; 0 for errors about the whole file.
    pub column: usize,
    /// Path to the field, for example `body.mass`; empty if there is none.
    pub field: String,
    /// Description of the error.
    pub message: String,
}

fn of(field: &str) -> String {
    if field.is_empty() {
        String::new()
    } else {
        format!("{field}: ")
    }
}

impl SceneFileError {
    /// An error about the whole file.
    pub(super) fn whole(file: &Path, message: String) -> Self {
        Self {
            file: file.to_owned(),
            line: 0,
            column: 0,
            field: String::new(),
            message,
        }
    }

    /// An error located after the text `before`.
    pub(super) fn after(file: &Path, before: &str, message: String) -> Self {
        let line = before.rsplit('\n').next().unwrap_or_default();
        Self {
            line: before.matches('\n').count() + 1,
            column: line.chars().count() + 1,
            ..Self::whole(file, message)
        }
    }

    /// An error about the whole scene.
    pub(super) fn scene(file: &Path, message: String) -> Self {
        Self::after(file, "", message)
    }

    /// An error of the parser or of a value check, with its field.
    pub(super) fn value(file: &Path, error: &SpannedError, path: &str) -> Self {
        let inside = path.trim_end_matches('?').trim_matches('.');
        let field = match &error.code {
            RonError::MissingStructField { field, .. } => Some((*field).to_owned()),
            _ => None,
        };
        let names = [Some(inside.to_owned()), field];
        let names: Vec<String> = names
            .into_iter()
            .flatten()
            .filter(|n| !n.is_empty())
            .collect();
        Self {
            line: error.span.start.line,
            column: error.span.start.col,
            field: names.join("."),
            ..Self::whole(file, error.code.to_string())
        }
    }
}
