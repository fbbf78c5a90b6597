//! What is wrong with a scene file, and where.

use std::path::{Path, PathBuf};

use ron::error::{Error as RonError, SpannedError};

/// A scene file that cannot be used. Shown as `file:line:column: field: what is wrong`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}:{line}:{column}: {}{message}", file.display(), of(field))]
pub struct SceneFileError {
    /// The file.
    pub file: PathBuf,
    /// From 1; 0 if it is about the file as a whole.
    pub line: usize,
    /// From 1, in characters; 0 if it is about the file as a whole.
    pub column: usize,
    /// The field, with those round it: `body.mass`. Empty where there is none.
    pub field: String,
    /// What is wrong with it.
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
    /// About the file as a whole.
    pub(super) fn whole(file: &Path, message: String) -> Self {
        Self {
            file: file.to_owned(),
            line: 0,
            column: 0,
            field: String::new(),
            message,
        }
    }

    /// After the text `before`.
    pub(super) fn after(file: &Path, before: &str, message: String) -> Self {
        let line = before.rsplit('\n').next().unwrap_or_default();
        Self {
            line: before.matches('\n').count() + 1,
            column: line.chars().count() + 1,
            ..Self::whole(file, message)
        }
    }

    /// About the scene as a whole.
    pub(super) fn scene(file: &Path, message: String) -> Self {
        Self::after(file, "", message)
    }

    /// What the parser or a check of a value says, and in which field.
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
