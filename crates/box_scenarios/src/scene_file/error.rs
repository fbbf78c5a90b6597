//! What is wrong with a scene file, and where.

use std::path::{Path, PathBuf};

use ron::error::{Error as RonError, SpannedError};

use super::check::BadValue;
use super::place;

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

    /// At byte `offset` of `text`.
    pub(super) fn at(file: &Path, text: &str, offset: usize, message: String) -> Self {
        let (line, column) = place::line_and_column(text, offset);
        Self {
            line,
            column,
            ..Self::whole(file, message)
        }
    }

    /// What the parser says.
    pub(super) fn syntax(file: &Path, text: &str, error: &SpannedError) -> Self {
        let start = error.span.start;
        let offset = place::offset(text, start.line, start.col);
        let field = match &error.code {
            RonError::MissingStructField { field, .. } => (*field).to_owned(),
            RonError::NoSuchStructField { found, .. } => found.clone(),
            _ => place::field_at(text, offset),
        };
        Self {
            line: start.line,
            column: start.col,
            field,
            ..Self::whole(file, error.code.to_string())
        }
    }

    /// A value that reads well and is not allowed.
    pub(super) fn value(file: &Path, text: &str, bad: &BadValue) -> Self {
        let offset = place::value_of(text, &bad.field, bad.value).unwrap_or(0);
        Self {
            field: bad.field.clone(),
            ..Self::at(file, text, offset, bad.reason.clone())
        }
    }
}
