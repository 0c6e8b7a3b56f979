//! Whether a folder may be replaced: only where a run wrote it, and only what that run wrote.
//!
//! Its summary says what that was, with digests of the scenario, its inputs and the tables; where a run was cut off, its journal does. The
//! report and the pictures follow from these and are not compared.

use std::path::Path;

use serde::Deserialize;

use super::comparison::DOCUMENT;
use super::error::OutputError;
use super::folder::{FILES, NEW_SEAL, OLD_SEAL, SEAL};
use super::growing::PAGE;
use super::inputs::{self, file_digest, is_copy};
use super::journal::{Head, JOURNAL};
use super::summary::{Input, TableFile};
use super::{SHAPES, journal};
use crate::SourceText;
use crate::files::{MOST_BYTES, read_text};
use crate::scenario::InputFile;
use crate::scenario::run_folder::{MANIFEST, Manifest, SCENARIO};
use crate::shapes::Shapes;

const PLOTS: &str = "plots/";

/// The part of a summary that matters here, whatever its format.
#[derive(Debug, Deserialize)]
struct Earlier {
    #[serde(rename = "format")]
    _format: u32,
    scenario: Scenario,
    #[serde(default)]
    tables: Vec<TableFile>,
    #[serde(default)]
    inputs: Vec<Input>,
}

#[derive(Debug, Deserialize)]
struct Scenario {
    digest_blake3: String,
}

/// Refuses a folder that no comparison wrote. One that was interrupted left nothing but folders of its runs.
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
        None if holds_only_runs(folder) => Ok(()),
        None => Err(OutputError::NotOfAComparison { path: folder.to_owned() }),
    }
}

/// Whether everything in a folder is a folder that a run wrote or was about to.
fn holds_only_runs(folder: &Path) -> bool {
    let Ok(entries) = folder.read_dir() else { return false };
    let is_one = |path: &Path| {
        let is_folder = path.symlink_metadata().is_ok_and(|about| about.is_dir());
        is_folder
            && (Left::of(path).is_of_a_run(path) || path.read_dir().is_ok_and(|mut inside| inside.next().is_none()))
    };
    entries.into_iter().all(|entry| entry.is_ok_and(|entry| is_one(&entry.path())))
}

/// Refuses a folder that must be kept: one that no run wrote, and one in which a file of a run's name is not as that run wrote it.
pub(super) fn may_be_replaced(folder: &Path) -> Result<(), OutputError> {
    let left = Left::of(folder);
    if !left.is_of_a_run(folder) {
        return Err(OutputError::NotOfARun { path: folder.to_owned() });
    }
    left.names().iter().try_for_each(|name| left.allows(folder, name, None))
}

/// By what the files of earlier runs are known in a folder.
#[derive(Debug, Default)]
pub(super) struct Left {
    /// The summary of the run there; where one was interrupted while it gave its files their names, its own and that which it was to replace.
    summaries: Vec<Earlier>,
    /// The journal of a run that was cut off: it wrote no other file but its page. What would be written from it may stand there, too.
    journal: Vec<Input>,
}

/// A file that was or will be written.
#[derive(Clone, Copy)]
pub(super) struct Known<'k> {
    pub(super) digest_blake3: &'k str,
    /// Its length, where that is known.
    pub(super) bytes: Option<u64>,
}

impl Left {
    pub(super) fn of(folder: &Path) -> Left {
        let summary = |name: &str| {
            let text = read_text(&folder.join(name)).ok();
            text.and_then(|text| serde_json::from_str::<Earlier>(&text).ok())
        };
        let summaries = [SEAL, NEW_SEAL, OLD_SEAL].into_iter().filter_map(summary).collect();
        let journal = journal::head(&folder.join(JOURNAL)).map(|head| inputs_of(&head)).unwrap_or_default();
        Left { summaries, journal }
    }

    /// Whether a run wrote the folder. What stands in the place of a summary and is none is somebody else's.
    fn is_of_a_run(&self, folder: &Path) -> bool {
        match folder.join(SEAL).symlink_metadata() {
            Ok(_) => read_text(&folder.join(SEAL)).is_ok_and(|text| is_summary(&text)),
            Err(_) => !(self.summaries.is_empty() && self.journal.is_empty()),
        }
    }

    /// The names of all files that a run writes, and of the copies of inputs that are known here.
    pub(super) fn names(&self) -> Vec<String> {
        let copies = self.summaries.iter().flat_map(|summary| &summary.inputs).chain(&self.journal);
        let copies = copies.map(|input| &input.file).filter(|file| is_copy(file)).cloned();
        let mut names: Vec<String> =
            FILES.into_iter().map(str::to_owned).chain(copies).chain([JOURNAL.into()]).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Refuses a file that is neither as an earlier run wrote it nor as it is `staged` now. Pages, and pictures where a run was whole, follow from
    /// the tables and are not compared; shapes and journals are known by their form.
    pub(super) fn allows(&self, folder: &Path, name: &str, staged: Option<Known<'_>>) -> Result<(), OutputError> {
        let path = folder.join(name);
        let Ok(about) = path.symlink_metadata() else { return Ok(()) };
        let was_whole = !self.summaries.is_empty();
        let has_form = match name {
            PAGE => true,
            SEAL => read_text(&path).is_ok_and(|text| is_summary(&text)),
            MANIFEST => self.summaries.iter().any(|summary| summary.has_list(&path)),
            SHAPES => was_whole && read_text(&path).is_ok_and(|text| serde_json::from_str::<Shapes>(&text).is_ok()),
            JOURNAL => !about.is_file() || journal::is_one(&path),
            _ => was_whole && name.starts_with(PLOTS),
        };
        if has_form || self.known(name).chain(staged).any(|known| known.is_of(&path)) {
            return Ok(());
        }
        Err(OutputError::Changed { path })
    }

    /// What is known to have been written under this name.
    fn known<'k>(&'k self, name: &'k str) -> impl Iterator<Item = Known<'k>> {
        let of_summary = move |summary: &'k Earlier| {
            let scenario =
                (name == SCENARIO).then_some(Known { digest_blake3: &summary.scenario.digest_blake3, bytes: None });
            let tables = summary.tables.iter().filter(move |table| table.file == name);
            let tables = tables.map(|table| Known { digest_blake3: &table.digest_blake3, bytes: table.bytes });
            scenario.into_iter().chain(tables).chain(copies(&summary.inputs, name))
        };
        self.summaries.iter().flat_map(of_summary).chain(copies(&self.journal, name))
    }
}

fn copies<'k>(inputs: &'k [Input], name: &'k str) -> impl Iterator<Item = Known<'k>> {
    let own = inputs.iter().filter(move |input| input.file == name);
    own.map(|input| Known { digest_blake3: &input.digest_blake3, bytes: None })
}

impl Known<'_> {
    /// Whether the file at `path` is this one. Something long is not read only to find out that it is longer.
    fn is_of(&self, path: &Path) -> bool {
        let length = path.metadata().map_or(0, |found| found.len());
        let may_be = self.bytes.map_or(length <= MOST_BYTES, |bytes| bytes == length);
        may_be && file_digest(path).is_ok_and(|digest| digest == self.digest_blake3)
    }
}

/// The scenario and the copies of inputs that a run with this head writes.
fn inputs_of(head: &Head) -> Vec<Input> {
    let texts = head.inputs.iter();
    let files: Vec<InputFile> =
        texts.map(|(name, text)| InputFile { name: name.clone(), source: SourceText::new(name, text) }).collect();
    let digest_blake3 = head.summary.scenario.digest_blake3.clone();
    let scenario = Input { name: String::new(), file: SCENARIO.into(), digest_blake3 };
    inputs::copies(&files).into_iter().map(|(input, _)| input).chain([scenario]).collect()
}

fn is_summary(text: &str) -> bool {
    serde_json::from_str::<Earlier>(text).is_ok()
}

impl Earlier {
    /// Whether the list of copies at `path` is that of this run.
    fn has_list(&self, path: &Path) -> bool {
        let Ok(text) = read_text(path) else { return false };
        let Ok(listed) = serde_json::from_str::<Manifest>(&text) else { return false };
        let own = self.inputs.iter().map(|input| (&input.name, &input.file));
        own.eq(listed.files.iter().map(|copied| (&copied.name, &copied.file)))
    }
}
