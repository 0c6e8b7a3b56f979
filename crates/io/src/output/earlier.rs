//! Whether a folder may be replaced: only where a run wrote it, and only what that run wrote.
//!
//! Its summary says what that was, with digests of the scenario and the tables. The report and the pictures follow from these and are not
//! compared.

use std::path::Path;

use serde::Deserialize;

use super::comparison::DOCUMENT;
use super::error::OutputError;
use super::folder::SEAL;
use super::inputs::file_digest;
use super::journal::JOURNAL;
use super::summary::TableFile;
use super::{SHAPES, journal};
use crate::files::{MOST_BYTES, read_text};
use crate::shapes::Shapes;

/// The files that nothing else holds.
const OWN: [&str; 6] =
    ["scenario.toml", "trajectory.parquet", "trajectory.csv", "packets.csv", "phases.csv", "holds.csv"];

/// The part of a summary that matters here, whatever its format.
#[derive(Deserialize)]
struct Earlier {
    #[serde(rename = "format")]
    _format: u32,
    scenario: Scenario,
    #[serde(default)]
    tables: Vec<TableFile>,
}

#[derive(Deserialize)]
struct Scenario {
    digest_blake3: String,
}

/// Refuses a folder that no comparison wrote.
pub(super) fn is_comparison(folder: &Path) -> Result<(), OutputError> {
    /// The part of the document that matters here, whatever its format.
    #[derive(Deserialize)]
    struct Document {
        #[serde(rename = "format")]
        _format: u32,
        #[serde(rename = "rows")]
        _rows: Vec<serde::de::IgnoredAny>,
    }
    let document = read_text(&folder.join(DOCUMENT)).ok();
    match document.and_then(|text| serde_json::from_str::<Document>(&text).ok()) {
        Some(_) => Ok(()),
        None => Err(OutputError::NotOfAComparison { path: folder.to_owned() }),
    }
}

/// Refuses a folder that must be kept.
pub(super) fn may_be_replaced(folder: &Path) -> Result<(), OutputError> {
    let summary = read_text(&folder.join(SEAL)).ok();
    let Some(earlier) = summary.and_then(|text| serde_json::from_str::<Earlier>(&text).ok()) else {
        let holds = |name: &str| folder.join(name).symlink_metadata().is_ok();
        // A run that ended while it gave its files their names took the old summary away and left the new one; one that was killed before
        // left its journal.
        if !holds(SEAL) && (holds(".summary.json.partial") || holds(JOURNAL)) {
            return Ok(());
        }
        return Err(OutputError::NotOfARun { path: folder.to_owned() });
    };
    // Neither has a digest in the summary; what a run wrote under these names is known by its form.
    let shapes = folder.join(SHAPES);
    let is_shapes = || read_text(&shapes).is_ok_and(|text| serde_json::from_str::<Shapes>(&text).is_ok());
    if shapes.is_file() && !is_shapes() {
        return Err(OutputError::Changed { path: shapes });
    }
    let rows = folder.join(JOURNAL);
    if rows.is_file() && !journal::is_one(&rows) {
        return Err(OutputError::Changed { path: rows });
    }
    for name in OWN {
        let path = folder.join(name);
        if path.symlink_metadata().is_err() {
            continue;
        }
        let table = earlier.tables.iter().find(|table| table.file == name);
        let written = match table {
            _ if name == OWN[0] => Some(&earlier.scenario.digest_blake3),
            table => table.map(|table| &table.digest_blake3),
        };
        // Something long is not read only to find out that it is longer than what was written.
        let length = path.metadata().map_or(0, |found| found.len());
        let most = if name == OWN[0] { Some(MOST_BYTES) } else { None };
        let is_other = table.and_then(|table| table.bytes).is_some_and(|bytes| bytes != length)
            || most.is_some_and(|most| length > most);
        if is_other || written.is_none() || file_digest(&path).ok().as_ref() != written {
            return Err(OutputError::Changed { path });
        }
    }
    Ok(())
}
