//! From the folder of a run back to a [`RunRecord`], without simulating again.
//!
//! What a report shows comes from four places: the signals from the table; the setup from `scenario.toml` and the copies of
//! the files that it names; how the run ended, what it cost and its notices from `summary.json`; metrics, verdicts and
//! whether the goal was met are worked out again. In a folder that is unchanged all of it is what it was.

use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};

use forwardstep_check::Report;
use forwardstep_sim::recorded_columns;
use forwardstep_sim::recording::{Outcome, Recording, Signal};
use forwardstep_sim::setup::Setup;
use serde::Deserialize;

use super::error::OutputError;
use super::folder::RunFolder;
use super::metrics::Metrics;
use super::record::{GoalOutcome, RunRecord};
use super::restore_error::{RestoreError, SummaryError, TableError};
use super::summary::{FORMAT, Summary, Verdicts};
use super::table::NamedColumns;
use super::{CSV, PARQUET, csv, inputs, names, stored_table};
use crate::SourceText;
use crate::files::{MOST_BYTES, ReadError, open_file, read_text};
use crate::scenario::kinds::Kinds;
use crate::scenario::{Inputs, Scenario, upgrade};

/// Signals of format 1 and what their columns are called now.
const SIGNALS: [(&str, &str); 2] = [("sign", "selection"), ("omega_wanted", "omega_commanded")];
const SCENARIO: &str = "scenario.toml";
const SUMMARY: &str = "summary.json";
/// A sign, seventeen digits, a point, an exponent and a comma take 25 bytes at most; a share of what Parquet says of its pages is added.
const MOST_BYTES_OF_A_NUMBER: u64 = 64;

/// A run that was read back from its folder.
#[derive(Debug)]
pub struct SavedRun {
    folder: RunFolder,
    scenario: Scenario,
    /// The scenario as it stands in the folder.
    text: String,
    summary: Summary,
    outcome: Outcome,
    remarks: Vec<Remark>,
}

/// What is no longer as it was at the time of the run.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Remark {
    /// `scenario.toml` says something else, apart from its title.
    ScenarioChanged,
    /// A file that the scenario names says something else, or was not among them.
    InputChanged {
        /// The name in the scenario.
        name: String,
    },
    /// The table was read from CSV that the run did not write.
    OtherCsv,
    /// The tables lack columns that a run would record now.
    ColumnsMissing {
        /// One of them.
        first: String,
        /// How many they are.
        count: usize,
    },
    /// The verdicts are others than those given before the run.
    VerdictsDiffer,
    /// The run was written in an earlier format.
    Upgraded,
    /// Another version simulated.
    OtherVersion {
        /// The version that simulated.
        simulated: String,
        /// This one.
        now: String,
    },
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Remark::ScenarioChanged => f.write_str(
                "scenario.toml was changed after the run; the signals are those of the run, verdicts and limits those of the \
                 changed scenario",
            ),
            Remark::InputChanged { name } => write!(
                f,
                "`{name}`, which the scenario names, is not what it was at the time of the run; the signals are those of the \
                 run, verdicts and limits follow the file"
            ),
            Remark::OtherCsv => write!(f, "{CSV} is not as the run wrote it; its numbers are shown as they are"),
            Remark::ColumnsMissing { first, count: 1 } => write!(f, "the tables have no column `{first}`"),
            Remark::ColumnsMissing { first, count } => {
                write!(f, "the tables have no column `{first}` and lack {} more", count - 1)
            }
            Remark::VerdictsDiffer => {
                f.write_str("the verdicts were worked out anew and are not those given before the run, which summary.json has")
            }
            Remark::Upgraded => f.write_str(
                "the run was written in an earlier format; it is shown under the names that `forwardstep upgrade` gives",
            ),
            Remark::OtherVersion { simulated, now } => {
                write!(f, "simulated by forwardstep {simulated}; this page was made by forwardstep {now}")
            }
        }
    }
}

impl SavedRun {
    /// Reads the run in the folder `path`: its scenario with the copies of the files that it names, its summary, and its
    /// table, `trajectory.parquet` or, where there is none, `trajectory.csv`. As long as this lives, no run gets the folder.
    ///
    /// # Errors
    /// [`RestoreError`] with the file and what is wrong with it.
    pub fn open(path: &Path) -> Result<SavedRun, RestoreError> {
        SavedRun::open_with(path, &Kinds::shipped())
    }

    /// [`SavedRun::open`] of a run whose scenario names robots and laws of `kinds`.
    ///
    /// # Errors
    /// As of [`SavedRun::open`].
    pub fn open_with(path: &Path, kinds: &Kinds) -> Result<SavedRun, RestoreError> {
        match path.metadata().map_err(ReadError::from) {
            Ok(found) if found.is_dir() => {}
            Ok(_) => {
                let meant = path.parent().filter(|parent| is_run(parent)).map(Path::to_owned);
                return Err(RestoreError::NotAFolder { path: path.to_owned(), meant });
            }
            Err(ReadError::Missing) => {
                let meant = Some(Path::new("forwardstep-runs").join(path)).filter(|meant| is_run(meant));
                return Err(RestoreError::NoFolder { path: path.to_owned(), meant });
            }
            Err(reason) => return Err(RestoreError::File { path: path.to_owned(), reason }),
        }
        let (summary, text) = (text_of(path, SUMMARY)?, text_of(path, SCENARIO)?);
        let summary =
            parse_summary(&summary).map_err(|reason| RestoreError::Summary { path: path.join(SUMMARY), reason })?;
        let folder = RunFolder::open(path)?;
        let (scenario, upgraded) = scenario(path, &text, &summary, kinds)?;
        let mut remarks = changes(&scenario, &text, &summary);
        remarks.extend(upgraded.then_some(Remark::Upgraded));
        let recording = recording(path, &scenario.setup, &summary, &mut remarks)?;
        let ending = summary.ending.restore(&scenario.setup, &recording).ok_or_else(|| {
            let broken = summary.ending.breakdown.as_ref();
            let column = broken.map_or_else(|| "nothing".to_owned(), |broken| format!("`{}`", broken.column));
            RestoreError::Summary { path: path.join(SUMMARY), reason: SummaryError::Breakdown { column } }
        })?;
        let outcome = Outcome { recording, ending, statistics: summary.statistics() };
        Ok(SavedRun { folder, scenario, text, summary, outcome, remarks })
    }

    /// What was simulated, as the scenario says now.
    pub fn setup(&self) -> &Setup {
        &self.scenario.setup
    }

    /// What is not as it was at the time of the run, given the verdicts of today and the `version` that asks.
    pub fn remarks(&self, verdicts: &Report, version: &str) -> Vec<Remark> {
        let mut remarks = self.remarks.clone();
        if !self.summary.verdicts.agree_with(&Verdicts::of(verdicts)) {
            remarks.push(Remark::VerdictsDiffer);
        }
        if version != self.summary.version {
            let (simulated, now) = (self.summary.version.clone(), version.to_owned());
            remarks.push(Remark::OtherVersion { simulated, now });
        }
        remarks
    }

    /// The record of the run. `verdicts` and the prediction are those of [`Self::setup`]; `remarks` join the notices.
    pub fn record<'a>(
        &'a self,
        verdicts: &'a Report,
        predicted_agreement: Option<Vec<f64>>,
        remarks: &[Remark],
    ) -> RunRecord<'a> {
        let (scenario, summary, outcome) = (&self.scenario, &self.summary, &self.outcome);
        let setup = &scenario.setup;
        let metrics = Metrics::of(setup, &outcome.recording, predicted_agreement.as_deref(), scenario.goal);
        let goal = scenario.goal.map(|goal| GoalOutcome { goal, met: goal.is_met(setup, outcome, &metrics) });
        RunRecord {
            title: &scenario.title,
            scenario_name: &scenario.name,
            scenario_text: &self.text,
            inputs: &scenario.inputs,
            version: &summary.version,
            setup,
            outcome,
            verdicts,
            predicted_agreement,
            prediction: summary.prediction.clone(),
            goal,
            digital: summary.digital.clone(),
            injected: summary.injected.clone(),
            notices: summary.notices.iter().cloned().chain(remarks.iter().map(Remark::to_string)).collect(),
        }
    }

    /// Writes `report.html` and `plots/*.svg` anew and leaves everything else in the folder as it is; the files written.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried. A failure harms no file that was there.
    pub fn write_report(&self, record: &RunRecord<'_>) -> Result<Vec<PathBuf>, OutputError> {
        super::write_report(&self.folder, record)
    }
}

fn is_run(path: &Path) -> bool {
    path.join(SUMMARY).is_file()
}

fn text_of(folder: &Path, name: &'static str) -> Result<String, RestoreError> {
    let path = folder.join(name);
    read_text(&path).map_err(|reason| match reason {
        ReadError::Missing => RestoreError::NotARun { path: folder.to_owned(), missing: name },
        reason => RestoreError::File { path, reason },
    })
}

fn parse_summary(text: &str) -> Result<Summary, SummaryError> {
    /// What all formats have.
    #[derive(Deserialize)]
    struct AnyFormat {
        format: u32,
    }
    let AnyFormat { format } = serde_json::from_str(text)?;
    if format > FORMAT {
        return Err(SummaryError::Newer { found: format });
    }
    let mut summary: Summary = serde_json::from_str(text)?;
    if let Some(broken) = summary.ending.breakdown.as_mut().filter(|_| format == 1) {
        broken.column = column_of_now(&broken.column);
    }
    match summary.inputs.iter().find(|input| !inputs::is_copy(&input.file)) {
        Some(input) => Err(SummaryError::Copy { file: input.file.clone() }),
        None => Ok(summary),
    }
}

/// The scenario, with the files that it names read from their copies; and whether it was upgraded.
fn scenario(folder: &Path, text: &str, summary: &Summary, kinds: &Kinds) -> Result<(Scenario, bool), RestoreError> {
    let source = SourceText::new(folder.join(SCENARIO).display().to_string(), text);
    let upgraded = upgrade(&source)?;
    let source = SourceText::new(source.name(), upgraded.text);
    let copies: Vec<(String, PathBuf)> =
        summary.inputs.iter().map(|input| (input.name.clone(), folder.join(&input.file))).collect();
    let inputs = copies.iter().fold(Inputs::from(Some(folder)), |inputs, (name, path)| inputs.file_at(name, path));
    let read = kinds.read_scenario(&summary.scenario.name, &source, inputs);
    let scenario = read.map_err(|error| {
        // A copy that is gone is not the scenario's mistake.
        let lost = copies.into_iter().find_map(|(_, path)| read_text(&path).err().map(|reason| (path, reason)));
        lost.map_or_else(|| error.into(), |(path, reason)| RestoreError::File { path, reason })
    })?;
    Ok((scenario, !upgraded.moved.is_empty()))
}

/// What scenario and inputs say now and did not say then.
fn changes(scenario: &Scenario, text: &str, summary: &Summary) -> Vec<Remark> {
    let then = &summary.scenario;
    let same = blake3::hash(text.as_bytes()).to_hex().as_str() == then.digest_blake3
        || then.content_digest_blake3.is_some() && inputs::content_digest(text) == then.content_digest_blake3;
    let mut remarks = if same { Vec::new() } else { vec![Remark::ScenarioChanged] };
    for input in &scenario.inputs {
        let digest = blake3::hash(input.source.text().as_bytes()).to_hex();
        if !summary.inputs.iter().any(|then| then.name == input.name && then.digest_blake3 == digest.as_str()) {
            remarks.push(Remark::InputChanged { name: input.name.clone() });
        }
    }
    remarks
}

/// The table, in the order in which a run records.
fn recording(
    folder: &Path,
    setup: &Setup,
    summary: &Summary,
    remarks: &mut Vec<Remark>,
) -> Result<Recording, RestoreError> {
    let columns = recorded_columns(setup)
        .map_err(|reason| RestoreError::Setup { path: folder.join(SCENARIO), reason: Box::new(reason) })?;
    let scenario_changed = !remarks.is_empty();
    let name = [PARQUET, CSV].into_iter().find(|name| folder.join(name).exists()).ok_or_else(|| {
        RestoreError::NotARun { path: folder.to_owned(), missing: "trajectory.parquet or trajectory.csv" }
    })?;
    let path = folder.join(name);
    let unreadable = |reason: ReadError| RestoreError::File { path: path.clone(), reason };
    let unusable = |reason| RestoreError::Table { path: path.clone(), reason, scenario_changed };
    let file = open_file(&path).map_err(unreadable)?;
    // Neither Parquet nor CSV takes more for a number, and no text in the table is longer than the scenario may be.
    let most = (summary.metrics.rows as u64 + 1)
        .saturating_mul(columns.len() as u64 + 1)
        .saturating_mul(MOST_BYTES_OF_A_NUMBER);
    if file.metadata().map_err(|error| unreadable(error.into()))?.len() > most.saturating_add(MOST_BYTES) {
        return Err(unusable(TableError::TooLarge { written: summary.metrics.rows }));
    }
    let digest = inputs::file_digest(&path).map_err(unreadable)?;
    let as_written = summary.tables.iter().any(|table| table.file == name && table.digest_blake3 == digest);
    let table = if name == PARQUET {
        if as_written { stored_table::read(file) } else { Err(TableError::Digest) }
    } else {
        if !as_written {
            remarks.push(Remark::OtherCsv);
        }
        csv::read(file)
    };
    let expected = Recording { t_s: Vec::new(), columns };
    let table = table.map(|mut table| {
        if summary.format == 1 {
            table.iter_mut().for_each(|(name, _)| *name = column_of_now(name));
        }
        table
    });
    let recording = table.and_then(|table| assign(setup, expected, table, remarks)).map_err(unusable)?;
    let (found, written) = (recording.t_s.len(), summary.metrics.rows);
    if found != written {
        return Err(unusable(TableError::Rows { found, written }));
    }
    Ok(recording)
}

/// Fills the columns that a run records from those of a table that have their names.
fn assign(
    setup: &Setup,
    mut expected: Recording,
    table: NamedColumns,
    remarks: &mut Vec<Remark>,
) -> Result<Recording, TableError> {
    let mut found = HashMap::with_capacity(table.len());
    let mut order = Vec::with_capacity(table.len());
    for (name, values) in table {
        order.push(name.clone());
        if found.insert(name.clone(), values).is_some() {
            return Err(TableError::ColumnTwice { column: name });
        }
    }
    let header = names::table_header(setup, &expected);
    expected.t_s = found.remove(&header[0]).ok_or_else(|| TableError::MissingColumn { column: header[0].clone() })?;
    let rises = |pair: &[f64]| pair[0] <= pair[1];
    if let Some(row) = expected.t_s.windows(2).position(|pair| !rises(pair)) {
        return Err(TableError::Times { row: row + 2 });
    }
    if !expected.t_s.first().is_none_or(|first| first.is_finite()) {
        return Err(TableError::Times { row: 1 });
    }
    let mut missing = Vec::new();
    for (column, name) in expected.columns.iter_mut().zip(&header[1..]) {
        match found.remove(name) {
            Some(values) if values.len() == expected.t_s.len() => column.values = values,
            Some(_) => return Err(TableError::NotNumbers { column: name.clone() }),
            // Without positions there is nothing to show; other signals an earlier version may not have recorded.
            None if column.signal == Signal::Position => {
                return Err(TableError::MissingColumn { column: name.clone() });
            }
            None => missing.push((column.agent, column.signal, column.axis, name)),
        }
    }
    if let Some(column) = order.into_iter().find(|name| found.contains_key(name)) {
        return Err(TableError::UnknownColumn { column });
    }
    if let Some((.., first)) = missing.first() {
        remarks.push(Remark::ColumnsMissing { first: (*first).clone(), count: missing.len() });
        expected.columns.retain(|c| !missing.iter().any(|m| (m.0, m.1, m.2) == (c.agent, c.signal, c.axis)));
    }
    Ok(expected)
}

/// What a column of a table of format 1 is called now.
fn column_of_now(name: &str) -> String {
    let mut parts: Vec<&str> = name.splitn(3, '.').collect();
    if let [_, signal, ..] = parts.as_mut_slice()
        && let Some((_, new)) = SIGNALS.iter().find(|(old, _)| old == signal)
    {
        *signal = new;
    }
    parts.join(".")
}
