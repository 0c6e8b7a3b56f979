//! Whether a folder may be replaced: only where a run wrote it, and only what that run wrote.
//!
//! Its summary says what that was, with digests of the scenario, its inputs and the tables; where a run was cut off, its journal does. The
//! report and the pictures follow from these and are not compared.

use std::path::Path;

use serde::Deserialize;

use super::comparison::DOCUMENT;
use super::error::OutputError;
use super::folder::SEAL;
use super::inputs::{self, file_digest, is_copy};
use super::journal::{Head, JOURNAL};
use super::summary::{Input, TableFile};
use super::{SHAPES, journal};
use crate::SourceText;
use crate::files::{MOST_BYTES, read_text};
use crate::scenario::InputFile;
use crate::scenario::run_folder::{MANIFEST, Manifest};
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
    #[serde(default)]
    inputs: Vec<Input>,
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

/// Refuses a folder that must be kept: one that no run wrote, and one with a file under the name of a run's that this run did not write, or
/// not so.
pub(super) fn may_be_replaced(folder: &Path) -> Result<(), OutputError> {
    let summary = |name: &str| {
        let text = read_text(&folder.join(name)).ok();
        text.and_then(|text| serde_json::from_str::<Earlier>(&text).ok())
    };
    if let Some(earlier) = summary(SEAL) {
        return earlier.is_unchanged(folder);
    }
    if folder.join(SEAL).symlink_metadata().is_err() {
        // A run that ended while it gave its files their names took the old summary away and left the new one.
        if summary(".summary.json.partial").is_some() {
            return Ok(());
        }
        // One that was killed before has a journal, and nothing else.
        if let Some(head) = journal::head(&folder.join(JOURNAL)) {
            return is_alone(folder, &head);
        }
    }
    Err(OutputError::NotOfARun { path: folder.to_owned() })
}

/// Refuses where a file differs from what was written under its name, if anything was.
fn compare(folder: &Path, name: &str, written: Option<&String>) -> Result<(), OutputError> {
    let path = folder.join(name);
    match path.symlink_metadata() {
        Ok(_) if written.is_none() || file_digest(&path).ok().as_ref() != written => Err(OutputError::Changed { path }),
        _ => Ok(()),
    }
}

/// Refuses where a file stands beside the journal of a run that was cut off which that run did not write: it wrote none yet, but for its page.
/// What is as the run would write it may go.
fn is_alone(folder: &Path, head: &Head) -> Result<(), OutputError> {
    compare(folder, OWN[0], Some(&head.summary.scenario.digest_blake3))?;
    OWN[1..].iter().chain(&[SHAPES, MANIFEST]).try_for_each(|name| compare(folder, name, None))?;
    let inputs =
        head.inputs.iter().map(|(name, text)| InputFile { name: name.clone(), source: SourceText::new(name, text) });
    let inputs: Vec<InputFile> = inputs.collect();
    let copies = inputs::copies(&inputs).into_iter();
    copies.map(|(input, _)| input).try_for_each(|input| compare(folder, &input.file, Some(&input.digest_blake3)))
}

impl Earlier {
    /// Refuses where a file is not as the run wrote it.
    fn is_unchanged(&self, folder: &Path) -> Result<(), OutputError> {
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
            let table = self.tables.iter().find(|table| table.file == name);
            let written = match table {
                _ if name == OWN[0] => Some(&self.scenario.digest_blake3),
                table => table.map(|table| &table.digest_blake3),
            };
            // Something long is not read only to find out that it is longer than what was written.
            let length = path.metadata().map_or(0, |found| found.len());
            let most = if name == OWN[0] { Some(MOST_BYTES) } else { None };
            let is_other = table.and_then(|table| table.bytes).is_some_and(|bytes| bytes != length)
                || most.is_some_and(|most| length > most);
            compare(folder, name, written.filter(|_| !is_other))?;
        }
        let mut copies = self.inputs.iter().filter(|input| is_copy(&input.file));
        copies.try_for_each(|input| compare(folder, &input.file, Some(&input.digest_blake3)))?;
        let list = folder.join(MANIFEST);
        let is_own = || {
            let listed = serde_json::from_str::<Manifest>(&read_text(&list).ok()?).ok()?.files;
            let own = self.inputs.iter().map(|input| (&input.name, &input.file));
            Some(own.eq(listed.iter().map(|copied| (&copied.name, &copied.file))))
        };
        if list.symlink_metadata().is_ok() && is_own() != Some(true) {
            return Err(OutputError::Changed { path: list });
        }
        Ok(())
    }
}
