//! From the folder of a run back to a [`RunRecord`], without simulating again.
//!
//! What a report shows comes from four places: the signals from the table; the setup from `scenario.toml` and the copies of
//! the files that it names; how the run ended, what it cost and its notices from `summary.json`; metrics, verdicts and
//! whether the goal was met are worked out again. In a folder that is unchanged all of it is what it was.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use forwardstep_check::{Practical, Report};
use forwardstep_sim::recorded_columns;
use forwardstep_sim::recording::{Ending, Outcome, Recording, Signal};
use forwardstep_sim::setup::Setup;
use serde::Deserialize;

use super::error::OutputError;
use super::folder::RunFolder;
use super::journal::JOURNAL;
use super::metrics::Metrics;
use super::record::{GoalOutcome, RunRecord};
use super::remark::Remark;
use super::restore_error::{RestoreError, SummaryError, TableError};
use super::restore_journal;
use super::summary::{FORMAT, Summary, Verdicts};
use super::table::NamedColumns;
use super::{CSV, PARQUET, SHAPES, csv, inputs, names, stored_table};
use crate::SourceText;
use crate::files::{MOST_BYTES, ReadError, open_file, read_text};
use crate::scenario::kinds::Kinds;
use crate::scenario::{Inputs, Scenario, upgrade};
use crate::shapes::Shapes;

/// Signals of format 1 and what their columns are called now.
const SIGNALS: [(&str, &str); 2] = [("sign", "selection"), ("omega_wanted", "omega_commanded")];
pub(super) const SCENARIO: &str = "scenario.toml";
pub(super) const SUMMARY: &str = "summary.json";
/// A sign, seventeen digits, a point, an exponent and a comma take 25 bytes at most; a share of what Parquet says of its pages is added.
const MOST_BYTES_OF_A_NUMBER: u64 = 64;
/// Rows may go on to so many times the end of the scenario as it is now.
const FARTHEST: f64 = 1e4;

/// A run that was read back from its folder.
#[derive(Debug)]
pub struct SavedRun {
    path: PathBuf,
    /// Where it may be written to.
    folder: Option<RunFolder>,
    saved: Saved,
}

/// What a folder holds.
#[derive(Debug)]
pub(super) struct Saved {
    pub(super) scenario: Scenario,
    /// The scenario as it stands in the folder.
    pub(super) text: String,
    pub(super) summary: Summary,
    pub(super) outcome: Outcome,
    pub(super) remarks: Vec<Remark>,
    /// So many bytes of the journal were left out, if that is where it is from.
    pub(super) left_out: Option<u64>,
    pub(super) shapes: Option<Shapes>,
}

impl SavedRun {
    /// Reads the run in the folder `path`: its scenario with the copies of the files that it names, its summary, and its
    /// table, `trajectory.parquet` or, where there is none, `trajectory.csv`; or, where it was cut off, its journal. As long as this
    /// lives, no run gets the folder.
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
        let saved = Saved::read(path, kinds, &mut |path| RunFolder::open(path).map(Some))?;
        Ok(SavedRun { path: path.to_owned(), folder: saved.1, saved: saved.0 })
    }

    /// [`SavedRun::open_with`] without a claim on the folder, which need not be writable and may be that of a run that goes on.
    ///
    /// # Errors
    /// As of [`SavedRun::open`].
    pub fn look_with(path: &Path, kinds: &Kinds) -> Result<SavedRun, RestoreError> {
        // Who has claimed the folder themselves knows that no other has. A run that ends meanwhile was going on.
        let in_use = RunFolder::is_in_use(path) == Some(true);
        let (mut saved, folder) = Saved::read(path, kinds, &mut |_| Ok(None))?;
        if in_use && matches!(saved.outcome.ending, Ending::CutOff { .. }) && saved.left_out.is_some() {
            // It is not cut off, and what it is about to write is not damaged.
            let is_of_its_end = |r: &Remark| matches!(r, Remark::FromJournal { .. } | Remark::JournalDamaged { .. });
            saved.remarks.retain(|remark| !is_of_its_end(remark));
            saved.remarks.push(Remark::StillRunning);
        }
        Ok(SavedRun { path: path.to_owned(), folder, saved })
    }

    /// What was simulated, as the scenario says now.
    pub fn setup(&self) -> &Setup {
        &self.saved.scenario.setup
    }

    /// What is not as it was at the time of the run, given the verdicts of today and the `version` that asks.
    pub fn remarks(&self, verdicts: &Report, version: &str) -> Vec<Remark> {
        let mut remarks = self.saved.remarks.clone();
        if !self.saved.summary.verdicts.agree_with(&Verdicts::of(verdicts)) {
            remarks.push(Remark::VerdictsDiffer);
        }
        if version != self.saved.summary.version {
            let (simulated, now) = (self.saved.summary.version.clone(), version.to_owned());
            remarks.push(Remark::OtherVersion { simulated, now });
        }
        remarks
    }

    /// The record of the run. `verdicts` and the prediction are those of [`Self::setup`]; `remarks` join the notices.
    pub fn record<'a>(
        &'a self,
        verdicts: &'a Report,
        practical: Practical,
        predicted_agreement: Option<Vec<f64>>,
        remarks: &[Remark],
    ) -> RunRecord<'a> {
        let Saved { scenario, summary, outcome, text, .. } = &self.saved;
        let setup = &scenario.setup;
        let metrics = Metrics::of(setup, &outcome.recording, predicted_agreement.as_deref(), scenario.goal);
        let goal = scenario.goal.map(|goal| GoalOutcome { goal, met: goal.is_met(setup, outcome, &metrics) });
        RunRecord {
            title: &scenario.title,
            scenario_name: &scenario.name,
            scenario_text: text,
            inputs: &scenario.inputs,
            version: &summary.version,
            setup,
            outcome,
            verdicts,
            practical,
            predicted_agreement,
            prediction: summary.prediction.clone(),
            goal,
            digital: summary.digital.clone(),
            injected: summary.injected.clone(),
            injected_course: summary.injected_course.clone(),
            notices: summary.notices.iter().cloned().chain(remarks.iter().map(Remark::to_string)).collect(),
            shapes: self.saved.shapes.as_ref(),
        }
    }

    /// How the run ended, if it was not finished: if its rows come from its journal.
    pub fn unfinished(&self) -> Option<&Ending> {
        self.saved.left_out.is_some().then_some(&self.saved.outcome.ending)
    }

    /// Whether it was read from this folder.
    pub(super) fn is_in(&self, folder: &Path) -> bool {
        self.path == folder
    }

    /// Whether a run was writing it when it was looked at, so that more will come.
    pub fn goes_on(&self) -> bool {
        self.saved.remarks.contains(&Remark::StillRunning)
    }

    /// Writes everything about the run into another folder; the files written.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried.
    pub fn write_into(&self, folder: &RunFolder, record: &RunRecord<'_>) -> Result<Vec<PathBuf>, OutputError> {
        super::write_run(folder, record, super::Options::default())
    }

    /// Writes `report.html` and `plots/*.svg` anew and leaves everything else in the folder as it is; the files written. A run that
    /// was cut off gets all its files, and its journal goes, unless a part of it could not be read.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried. A failure harms no file that was there.
    pub fn write_report(&self, record: &RunRecord<'_>) -> Result<Vec<PathBuf>, OutputError> {
        let opened;
        let folder = match &self.folder {
            Some(folder) => folder,
            None => {
                opened = RunFolder::open(&self.path)?;
                &opened
            }
        };
        match self.saved.left_out {
            None => super::write_report(folder, record),
            Some(left_out) => super::write_all(folder, record, super::Options::default(), left_out > 0),
        }
    }
}

impl Saved {
    /// Reads the folder `path`; `claim` is asked for it as soon as there is something to read.
    fn read(
        path: &Path,
        kinds: &Kinds,
        claim: &mut dyn FnMut(&Path) -> Result<Option<RunFolder>, OutputError>,
    ) -> Result<(Saved, Option<RunFolder>), RestoreError> {
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
        if path.join(JOURNAL).exists() {
            let folder = claim(path)?;
            if let Some(saved) = restore_journal::saved(path, kinds)? {
                return Ok((saved, folder));
            }
            drop(folder);
        }
        let (summary, text) = (text_of(path, SUMMARY)?, text_of(path, SCENARIO)?);
        let summary =
            parse_summary(&summary).map_err(|reason| RestoreError::Summary { path: path.join(SUMMARY), reason })?;
        let folder = claim(path)?;
        let copies = copies(path, &summary);
        let inputs = copies.iter().fold(Inputs::from(Some(path)), |inputs, (name, path)| inputs.file_at(name, path));
        let read = scenario(path, &text, &summary.scenario.name, inputs, kinds);
        let (scenario, upgraded) = read.map_err(|error| {
            // A copy that is gone is not the scenario's mistake.
            let mut lost =
                copies.into_iter().filter_map(|(_, path)| read_text(&path).err().map(|reason| (path, reason)));
            let gone = matches!(error, RestoreError::Scenario(_)).then(|| lost.next()).flatten();
            gone.map_or(error, |(path, reason)| RestoreError::File { path, reason })
        })?;
        let mut remarks = changes(&scenario, &text, &summary);
        remarks.extend(upgraded.then_some(Remark::Upgraded));
        let recording = recording(path, &scenario.setup, &summary, &mut remarks)?;
        let ending = summary.ending.restore(&scenario.setup, &recording).ok_or_else(|| {
            let broken = summary.ending.breakdown.as_ref();
            let column = broken.map_or_else(|| "nothing".to_owned(), |broken| format!("`{}`", broken.column));
            RestoreError::Summary { path: path.join(SUMMARY), reason: SummaryError::Breakdown { column } }
        })?;
        let outcome = Outcome { recording, ending, statistics: summary.statistics() };
        let shapes = shapes(path, &mut remarks);
        Ok((Saved { scenario, text, summary, outcome, remarks, left_out: None, shapes }, folder))
    }
}

/// What the robots look like, if the run kept that. Without it they are drawn as capsules.
pub(super) fn shapes(folder: &Path, remarks: &mut Vec<Remark>) -> Option<Shapes> {
    let path = folder.join(SHAPES);
    if !path.exists() {
        return None;
    }
    let shapes: Option<Shapes> = read_text(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
    let sound = shapes.filter(Shapes::is_sound);
    if sound.is_none() {
        remarks.push(Remark::ShapesDamaged);
    }
    sound
}

fn is_run(path: &Path) -> bool {
    path.join(SUMMARY).is_file() || path.join(JOURNAL).is_file()
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
    #[serde(expecting = "an object that states its `format`")]
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

/// The files that the scenario names, by name, and where their copies are.
fn copies(folder: &Path, summary: &Summary) -> Vec<(String, PathBuf)> {
    summary.inputs.iter().map(|input| (input.name.clone(), folder.join(&input.file))).collect()
}

/// The scenario; and whether it was upgraded.
pub(super) fn scenario(
    folder: &Path,
    text: &str,
    name: &str,
    inputs: Inputs,
    kinds: &Kinds,
) -> Result<(Scenario, bool), RestoreError> {
    let source = SourceText::new(folder.join(SCENARIO).display().to_string(), text);
    let upgraded = upgrade(&source)?;
    let source = SourceText::new(source.name(), upgraded.text);
    let scenario = kinds.read_scenario(name, &source, inputs)?;
    Ok((scenario, !upgraded.moved.is_empty()))
}

/// What scenario and inputs say now and did not say then.
pub(super) fn changes(scenario: &Scenario, text: &str, summary: &Summary) -> Vec<Remark> {
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
pub(super) fn assign(
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
    // A scenario may have been shortened since; what takes its time by how far rows go would not come to an end.
    let end_s = setup.time.end_s;
    if let Some(t_s) = expected.t_s.last().copied().filter(|last| *last > FARTHEST * end_s) {
        return Err(TableError::Beyond { t_s, end_s });
    }
    let (recorded, leads) = header[1..].split_at(expected.columns.len());
    let mut missing = Vec::new();
    for (column, name) in expected.columns.iter_mut().zip(recorded) {
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
    // What leads is worked out again.
    for name in leads {
        found.remove(name);
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
