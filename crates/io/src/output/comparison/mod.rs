//! Runs side by side: one table of what was promised, predicted and observed, which the terminal, programs and a page share.
//!
//! A cell is words with, where it is one number, that number and its unit; where a run has nothing to say, the reason. Numbers are not
//! taken relative to each other: runs may be of different robots, and a row whose units differ says so.

mod cells;
mod rows;
mod words;

use std::path::{Path, PathBuf};

use forwardstep_check::smoothness::Smoothness;
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};

use super::error::OutputError;
use super::folder::RunFolder;
use super::record::RunRecord;
use super::report::side_by_side;
use rows::Subject;

/// The format of this document; it grows when fields change their meaning or vanish, not when some are added.
pub const COMPARISON_FORMAT: u32 = 1;
/// The page.
pub(super) const PAGE: &str = "compare.html";
/// The document, whose presence says that a folder is one of a comparison.
pub(super) const DOCUMENT: &str = "compare.json";
/// What stands where there is nothing to say.
const NONE: &str = "—";

/// Runs side by side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "forwardstep compare")]
pub struct Comparison {
    /// The format of this document, a number that grows when fields change their meaning or vanish.
    pub format: u32,
    /// The version of forwardstep.
    pub version: String,
    /// The runs, in the order asked for, which is that of the cells of every row.
    pub runs: Vec<ComparedRun>,
    /// The rows of the table.
    pub rows: Vec<ComparedRow>,
}

/// One of the runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedRun {
    /// What it is called here: the name of its folder or scenario, numbered where several have the same.
    pub name: String,
    /// The title of its scenario.
    pub title: String,
    /// The folder of the run.
    pub folder: String,
    /// What is not as it was at the time of the run.
    pub notices: Vec<String>,
}

/// Which part of the table a row is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RowGroup {
    /// What was simulated.
    Simulated,
    /// What the theorem promises.
    Promised,
    /// What is predicted for s ≡ 0.
    Predicted,
    /// What happened.
    Observed,
}

impl RowGroup {
    /// All, in order.
    pub const ALL: [RowGroup; 4] = [RowGroup::Simulated, RowGroup::Promised, RowGroup::Predicted, RowGroup::Observed];

    /// Its heading.
    pub fn words(self) -> &'static str {
        match self {
            RowGroup::Simulated => "Simulated",
            RowGroup::Promised => "Promised",
            RowGroup::Predicted => "Predicted for s ≡ 0",
            RowGroup::Observed => "Observed",
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedRow {
    /// Its stable name, for example `settled_s`.
    pub key: String,
    /// The part of the table.
    pub group: RowGroup,
    /// What it is called for people.
    pub name: String,
    /// Whether it is the same in all runs.
    pub same: bool,
    /// Why cells should not be compared as numbers: their units differ.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// One for each run.
    pub cells: Vec<ComparedCell>,
}

/// What one run says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ComparedCell {
    /// For people, with the unit; `—` where there is nothing to say.
    pub words: String,
    /// The number, where it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Its unit; absent for pure numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Why there is nothing to say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub because: Option<String>,
}

/// A run that is to be compared.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'a> {
    /// What it is called.
    pub name: &'a str,
    /// Its folder.
    pub folder: &'a Path,
    /// What is known of it.
    pub record: &'a RunRecord<'a>,
    /// How its inputs jump, or why that is not known.
    pub jumps: Result<&'a Smoothness, &'a str>,
    /// What is not as it was at the time of the run.
    pub notices: &'a [String],
}

impl Comparison {
    /// The table of these runs.
    pub fn of(runs: &[Compared<'_>], version: &str) -> Comparison {
        let subjects: Vec<Subject<'_>> = runs.iter().map(Subject::new).collect();
        let run = |run: &Compared<'_>| ComparedRun {
            name: run.name.to_owned(),
            title: run.record.title.to_owned(),
            folder: run.folder.display().to_string(),
            notices: run.notices.to_vec(),
        };
        Comparison {
            format: COMPARISON_FORMAT,
            version: version.to_owned(),
            runs: runs.iter().map(run).collect(),
            rows: rows::all(&subjects),
        }
    }

    /// Whether the runs are the same in all that is compared.
    pub fn is_same(&self) -> bool {
        self.rows.iter().all(|row| row.same)
    }

    /// It as indented JSON.
    ///
    /// # Errors
    /// Those of `serde_json`, which has none for a document of this form.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self)
    }

    /// The JSON schema of this document.
    pub fn schema() -> Schema {
        schema_for!(Comparison)
    }

    /// Writes `compare.html` and `compare.json`; the files written.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried. A failure harms no file that was there.
    pub fn write(&self, folder: &RunFolder, runs: &[Compared<'_>]) -> Result<Vec<PathBuf>, OutputError> {
        let mut staging = folder.stage();
        staging.write_text(PAGE, &side_by_side(self, runs))?;
        staging.write(DOCUMENT, |out| Ok(std::io::Write::write_all(out, (self.to_json()? + "\n").as_bytes())?))?;
        staging.replace()
    }
}
