//! A value of a JSON file with its path, for error messages.

use std::path::Path;

use box_physics::error::InvalidValue;
use glam::DVec3;
use serde_json::{Map, Value};

use super::OracleError;

/// A value and its path in the file.
pub(super) struct Field<'a> {
    file: &'a Path,
    path: String,
    value: &'a Value,
}

impl<'a> Field<'a> {
    pub(super) fn root(file: &'a Path, value: &'a Value) -> Self {
        Self {
            file,
            path: String::new(),
            value,
        }
    }

    fn named(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    /// Creates an error about this value.
    pub(super) fn error(&self, allowed: impl Into<String>) -> OracleError {
        let text = self.value.to_string();
        // Truncated, because a whole object would obscure the message.
        let value = match text.char_indices().nth(80) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text,
        };
        OracleError::Invalid {
            file: self.file.to_owned(),
            field: if self.path.is_empty() {
                "the file"
            } else {
                &self.path
            }
            .to_owned(),
            allowed: allowed.into(),
            value,
        }
    }

    /// Converts an error of a constructor of `box_physics` about a field of this object.
    pub(super) fn invalid(&self, e: &InvalidValue) -> OracleError {
        OracleError::Invalid {
            file: self.file.to_owned(),
            field: self.named(e.field),
            allowed: e.allowed.to_owned(),
            value: e.value.to_string(),
        }
    }

    pub(super) fn object(&self) -> Result<&'a Map<String, Value>, OracleError> {
        self.value
            .as_object()
            .ok_or_else(|| self.error("an object"))
    }

    /// The value under `key`; `null` counts as absent.
    pub(super) fn get(&self, key: &str) -> Result<Option<Field<'a>>, OracleError> {
        let value = self.object()?.get(key).filter(|v| !v.is_null());
        Ok(value.map(|value| Field {
            file: self.file,
            path: self.named(key),
            value,
        }))
    }

    pub(super) fn require(&self, key: &str) -> Result<Field<'a>, OracleError> {
        self.get(key)?.ok_or_else(|| OracleError::Missing {
            file: self.file.to_owned(),
            field: self.named(key),
        })
    }

    /// Rejects every key that is not among `allowed`.
    pub(super) fn only(&self, allowed: &[&str]) -> Result<(), OracleError> {
        match self
            .object()?
            .keys()
            .find(|k| !allowed.contains(&k.as_str()))
        {
            None => Ok(()),
            Some(key) => Err(OracleError::UnknownKey {
                file: self.file.to_owned(),
                field: self.named(key),
                allowed: allowed.join(", "),
            }),
        }
    }

    /// The elements of a list.
    pub(super) fn list(&self) -> Result<Vec<Field<'a>>, OracleError> {
        let list = self.value.as_array().ok_or_else(|| self.error("a list"))?;
        let element = |(k, value)| Field {
            file: self.file,
            path: format!("{}[{k}]", self.path),
            value,
        };
        Ok(list.iter().enumerate().map(element).collect())
    }

    pub(super) fn text(&self) -> Result<&'a str, OracleError> {
        let text = self.value.as_str().filter(|t| !t.trim().is_empty());
        text.ok_or_else(|| self.error("a nonempty string"))
    }

    /// Reads a finite number.
    pub(super) fn number(&self) -> Result<f64, OracleError> {
        let number = self.value.as_f64().filter(|x| x.is_finite());
        number.ok_or_else(|| self.error("a finite number"))
    }

    /// Reads a finite number ≥ 0.
    pub(super) fn coefficient(&self) -> Result<f64, OracleError> {
        let x = self.number()?;
        if x >= 0.0 {
            Ok(x)
        } else {
            Err(self.error("not negative"))
        }
    }

    /// Reads a list of exactly `N` finite numbers.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], OracleError> {
        let wrong = || self.error(format!("a list of {N} finite numbers"));
        let list = self
            .value
            .as_array()
            .filter(|l| l.len() == N)
            .ok_or_else(wrong)?;
        let mut out = [0.0; N];
        for (x, v) in out.iter_mut().zip(list) {
            *x = v.as_f64().filter(|x| x.is_finite()).ok_or_else(wrong)?;
        }
        Ok(out)
    }

    pub(super) fn vector(&self) -> Result<DVec3, OracleError> {
        self.numbers().map(DVec3::from_array)
    }
}
