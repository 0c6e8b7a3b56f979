//! What a run leaves on disk: a folder with tables, a summary, an interactive report and plots.
//!
//! A [`RunRecord`] gathers everything known about a finished run, [`Metrics::of`] reduces it to a few numbers, and
//! [`write_run`] puts both into a [`RunFolder`]:
//!
//! | file | content |
//! |---|---|
//! | `trajectory.parquet` | every recorded signal, one column each ([`names`] says how they are called) |
//! | `trajectory.csv` | the same numbers with all their digits, when asked for |
//! | `packets.csv` | every packet of every link, where links carry packets; `delay.log` replays it |
//! | `summary.json` | [`summary::Summary`]: verdicts, metrics, how it ended |
//! | `report.html` | one self-contained page that opens offline |
//! | `plots/*.svg` | positions, torques, estimates and disagreement, one panel per joint |
//! | `scenario.toml` | the text the run was made from |
//!
//! A run that broke down or was interrupted is written the same way, with the reason in front. Everything but the
//! `timings` object of `summary.json` is the same for the same run, bit for bit.

mod csv;
mod decimate;
mod error;
mod folder;
mod metrics;
pub mod names;
mod packets;
mod palette;
mod parquet;
mod plots;
mod record;
mod report;
pub mod summary;
mod table;
mod timeline;

use std::path::PathBuf;

pub use error::{Action, EncodeError, OutputError};
pub use folder::RunFolder;
pub use metrics::{
    Absence, Agreement, Disagreement, DisagreementSeries, LEDGER_FLOOR_J, LedgerError, LimitKind, LimitReached,
    Metrics, Peak, Speed,
};
pub use packets::Link;
pub use record::{Goal, GoalOutcome, RunRecord, ending_sentence};

/// What to write besides the files that are always written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Also `trajectory.csv`.
    pub csv: bool,
}

/// Writes everything about a run and returns the files written, `summary.json` last.
///
/// Files appear under their names only when all of them are complete, and `summary.json` after all others: a folder that
/// has one holds one whole run.
///
/// # Errors
/// [`OutputError`] with the file and what was tried; an unfinished run leaves no files behind, and does not harm those
/// of an earlier one unless it fails while renaming.
pub fn write_run(folder: &RunFolder, record: &RunRecord<'_>, options: Options) -> Result<Vec<PathBuf>, OutputError> {
    let recording = &record.outcome.recording;
    let goal = record.goal.map(|outcome| outcome.goal);
    let metrics = Metrics::of(record.setup, recording, record.predicted_agreement.as_deref(), goal);
    let mut staging = folder.stage();
    staging.write("scenario.toml", |out| Ok(std::io::Write::write_all(out, record.scenario_text.as_bytes())?))?;
    staging.write("trajectory.parquet", |out| Ok(parquet::write(out, record)?))?;
    if options.csv {
        staging.write("trajectory.csv", |out| Ok(csv::write(out, record.setup, recording)?))?;
    }
    if !packets::links(&record.setup.network).is_empty() {
        staging.write("packets.csv", |out| Ok(packets::write(out, record.setup)?))?;
    }
    staging
        .write("report.html", |out| Ok(std::io::Write::write_all(out, report::page(record, &metrics).as_bytes())?))?;
    let plots = plots::Plots::of(record);
    let mut plot = |name, svg: Result<String, EncodeError>| {
        staging.write(name, |out| Ok(std::io::Write::write_all(out, svg?.as_bytes())?))
    };
    plot("plots/positions.svg", plots.positions())?;
    plot("plots/torques.svg", plots.torques())?;
    plot("plots/estimates.svg", plots.estimates())?;
    plot("plots/disagreement.svg", plots.disagreement())?;
    staging.write("summary.json", |out| Ok(summary::Summary::of(record, &metrics).write(out)?))?;
    staging.publish()
}
