//! From the journal of a run that was cut off back to a [`super::SavedRun`].

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use forwardstep_sim::recorded_columns;
use forwardstep_sim::recording::{Ending, Outcome, Recording};

use super::inputs;
use super::journal::{self, JOURNAL, ReadJournal};
use super::remark::Remark;
use super::restore::{SCENARIO, SUMMARY, Saved, assign, changes, scenario};
use super::restore_error::{RestoreError, SummaryError};
use crate::files::ReadError;
use crate::scenario::Inputs;
use crate::scenario::kinds::Kinds;

/// The run in the journal of a folder; nothing where there is none, or where it is over and the tables hold more.
pub(super) fn saved(folder: &Path, kinds: &Kinds) -> Result<Option<Saved>, RestoreError> {
    let path = folder.join(JOURNAL);
    let summary = inputs::file_digest(&folder.join(SUMMARY)).ok();
    // What is no file, a pipe for one, is not opened.
    let Some(about) = path.metadata().ok().filter(|about| about.is_file()) else { return Ok(None) };
    let file = match File::open(&path) {
        Ok(file) => BufReader::new(file),
        Err(_) if summary.is_some() => return Ok(None),
        Err(error) => return Err(RestoreError::File { path, reason: ReadError::from(error) }),
    };
    match journal::read(file, about.len()) {
        // The summary is that of an earlier run, which this one was to replace.
        Ok(read) if summary.is_none() || summary == read.head.replaces_blake3 => {
            restored(folder, read, kinds).map(Some)
        }
        Ok(_) => Ok(None),
        Err(_) if summary.is_some() => Ok(None),
        Err(reason) => Err(RestoreError::Journal { path, reason }),
    }
}

fn restored(folder: &Path, read: ReadJournal, kinds: &Kinds) -> Result<Saved, RestoreError> {
    let ReadJournal { head, columns, end, left_out } = read;
    let path = folder.join(JOURNAL);
    let texts = head.inputs.iter();
    let inputs = texts.fold(Inputs::default(), |inputs, (name, text)| inputs.file(name, text.as_bytes()));
    let cut_off = end.is_none();
    let mut summary = end.unwrap_or(head.summary);
    let (scenario, _) = scenario(folder, &head.scenario, &summary.scenario.name, inputs, kinds)?;
    let mut remarks = changes(&scenario, &head.scenario, &summary);
    let setup = &scenario.setup;
    let expected = recorded_columns(setup)
        .map_err(|reason| RestoreError::Setup { path: folder.join(SCENARIO), reason: Box::new(reason) })?;
    let scenario_changed = !remarks.is_empty();
    let expected = Recording { t_s: Vec::new(), columns: expected };
    let recording = assign(setup, expected, columns, &mut remarks).map_err(|reason| RestoreError::Table {
        path: path.clone(),
        reason,
        scenario_changed,
    })?;
    let rows = recording.t_s.len();
    remarks.push(Remark::FromJournal { rows, cut_off });
    if left_out > 0 {
        remarks.push(Remark::JournalDamaged { bytes: left_out });
    }
    let ending = if cut_off {
        let t_s = recording.t_s.last().copied().unwrap_or(0.0);
        // Work that was done since is not known.
        summary.timings.wall_s = f64::NAN;
        Ending::CutOff { t_s }
    } else {
        let damaged = || SummaryError::Breakdown { column: "something".into() };
        (summary.ending.restore(setup, &recording)).ok_or_else(|| RestoreError::Summary { path, reason: damaged() })?
    };
    let statistics = summary.statistics();
    let outcome = Outcome { recording, ending, statistics };
    Ok(Saved { scenario, text: head.scenario, summary, outcome, remarks, left_out: Some(left_out), shapes: None })
}
