//! Reading and writing files, with errors that contain the path.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::context::Stop;

fn failed(path: &Path) -> impl FnOnce(std::io::Error) -> Stop + '_ {
    |source| Stop::File {
        path: path.to_owned(),
        source,
    }
}

/// Creates `path` and its parent folders, and checks that files can be written there.
pub(crate) fn create_folder(path: &Path) -> Result<(), Stop> {
    std::fs::create_dir_all(path).map_err(failed(path))?;
    let probe = path.join(".box_report");
    std::fs::write(&probe, "").map_err(failed(path))?;
    std::fs::remove_file(&probe).map_err(failed(path))
}

/// Writes `text` to `path`.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Stop> {
    std::fs::write(path, text).map_err(failed(path))
}

/// Reads a text file.
pub(crate) fn read(path: &Path) -> Result<String, Stop> {
    std::fs::read_to_string(path).map_err(failed(path))
}

/// Writes `rows` to `path` as CSV; the header contains the field names.
pub(crate) fn write_csv<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), Stop> {
    let text = csv_text(rows).map_err(failed(path))?;
    write(path, &text)
}

/// Converts `rows` to CSV.
pub(crate) fn csv_text<R: Serialize>(rows: &[R]) -> Result<String, std::io::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner().map_err(|e| e.into_error())?;
    String::from_utf8(bytes).map_err(std::io::Error::other)
}

/// Parses the rows of a CSV text.
///
/// # Errors
/// A description of the error in the text.
pub(crate) fn parse_csv<R: DeserializeOwned>(text: &str) -> Result<Vec<R>, String> {
    csv::Reader::from_reader(text.as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())
}
