//! `time.record_at` → [`RecordAt`].

use forwardstep_sim::RecordAt;

use super::at::At;
use super::control_file::ControlFile;
use super::fault::{Fault, between, fault};
use super::file::{RecordAtFile, TimeFile};
use super::inputs::InputFolder;
use super::system_problem::SystemProblem;
use super::table::{over_time, rising, table_text};

/// When rows are recorded; samples are those of `control`.
pub(super) fn record_at(
    time: &TimeFile,
    control: Option<&ControlFile>,
    folder: &mut InputFolder,
) -> Result<RecordAt, Fault> {
    let Some(stated) = &time.record_at else { return Ok(RecordAt::Intervals) };
    if let Some(every) = &time.record_every_s {
        return Err(fault(every, SystemProblem::RowsTwice));
    }
    match &stated.value {
        RecordAtFile::Samples => match control {
            Some(control) => Ok(RecordAt::Rate { hz: control.sample_hz.value }),
            None => Err(fault(stated, SystemProblem::NoSamples)),
        },
        RecordAtFile::TimesS(times) => {
            rising("times_s", &times.value)?;
            on_run("times_s", &times.value, time.end_s.value)
        }
        RecordAtFile::Csv(csv) => {
            let source = table_text(&csv.file, folder)?;
            let (times, _) = over_time(&source, &[])?;
            on_run("t_s", &times, time.end_s.value).map_err(|fault| fault.within(&source))
        }
    }
}

/// Times from the start to the end of the run.
fn on_run(key: &'static str, times: &[At<f64>], end_s: f64) -> Result<RecordAt, Fault> {
    let times_s: Result<Vec<f64>, Fault> = times.iter().map(|time| between(key, time, 0.0, end_s)).collect();
    Ok(RecordAt::Times(times_s?.into()))
}
