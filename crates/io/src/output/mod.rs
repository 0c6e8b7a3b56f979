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
//! | `phases.csv` | when each phase began, where phases are drawn; `switching.log` replays it |
//! | `holds.csv` | when each value of every random hold began, where there are some; `delay.hold_log` replays it |
//! | `rows.journal` | the rows of a run that is still going on, or was cut off: [`journal`] |
//! | `summary.json` | [`summary::Summary`]: verdicts, metrics, how it ended |
//! | `shapes.json` | what the robots look like, when asked for |
//! | `report.html` | one self-contained page that opens offline |
//! | `plots/*.svg` | positions, torques, estimates and disagreement, one panel per joint |
//! | `scenario.toml` | the text the run was made from |
//! | `inputs/` | the files that this text names, so that the folder holds all that went into the run |
//! | `inputs/manifest.json` | which of them stands for which name in the text; `run` takes the folder, wherever it is |
//!
//! [`SavedRun`] reads such a folder back, and writes the report and the plots anew from its tables.
//!
//! A run that broke down or was interrupted is written the same way, with the reason in front. Everything but the
//! `timings` object of `summary.json` is the same for the same run, bit for bit.

mod certificate;
mod claim;
mod comparison;
mod conclusion;
mod csv;
mod decimate;
mod digital;
mod disagreement;
mod disk;
mod draws;
mod earlier;
mod ending;
mod error;
mod explanation;
mod findings;
mod folder;
pub mod formula;
mod growing;
mod guarantee;
mod how;
mod injected;
mod inputs;
pub mod journal;
mod leader;
mod loads;
mod metrics;
pub mod names;
mod number;
mod packets;
mod palette;
mod parquet;
mod plots;
mod practical;
mod prediction;
mod record;
mod remark;
mod report;
mod residuals;
mod restore;
mod restore_error;
mod restore_journal;
mod sampling_limit;
mod smoothness;
mod staging;
mod stored_table;
pub mod summary;
mod table;
mod text;
mod timeline;
mod trend;
mod verdicts;

use std::collections::HashSet;
use std::path::PathBuf;

pub use certificate::{CERTIFICATE_FORMAT, certificate_document, is_certificate};
pub use comparison::{COMPARISON_FORMAT, Compared, ComparedCell, ComparedRow, ComparedRun, Comparison, RowGroup};
pub use conclusion::Conclusion;
pub use digital::{DigitalCost, Figures, continuous_twin};
pub use disk::{Disk, DiskFile};
pub use ending::{ending_sentence, stiff_words};
pub use error::{Action, EncodeError, OutputError};
pub use explanation::{EXPLANATION_FORMAT, TextLine, explanation_document, explanation_latex, explanation_lines};
pub use findings::{Checked, FINDINGS_FORMAT, Findings, PredictedAgreement};
pub use folder::RunFolder;
pub use guarantee::{Guarantee, GuaranteeFound, GuaranteedClass, GuaranteedFall, GuaranteedRepeat};
pub use injected::{FirstInjection, Injected, InjectedCourse};
pub use inputs::digest;
pub use journal::{Journal, JournalError};
pub use loads::Load;
pub use metrics::{
    Absence, Agreement, BALANCE_FLOOR_J, BalanceResidual, Disagreement, DisagreementSeries, Gap, LimitKind,
    LimitReached, Metrics, Peak, Speed, coarse_rows,
};
pub use packets::Link;
pub use plots::{plot_filters, plot_orders};
pub use practical::{PracticalVerdict, PracticalVerdicts, Watched, WatchedLoad, WatchedMargin, WatchedPower};
pub use prediction::{CourseFound, PredictedCourse, PredictedRate, PredictedTorque, Predictions};
pub use record::{GoalOutcome, RunRecord};
pub use remark::Remark;
pub use residuals::{residual_document, residual_lines};
pub use restore::SavedRun;
pub use restore_error::{RestoreError, SummaryError, TableError};
pub use sampling_limit::{Accepted, Deployment, LimitRemark, Measuring, Rule, SamplingLimit, Trial};
pub use smoothness::{
    FilteredInput, LargestInputJump, NothingSaid, SMOOTHNESS_FORMAT, SmoothInput, SmoothOrder, SmoothScenario,
    SmoothnessDocument, SmoothnessFound,
};
use staging::{Staging, Written};
pub use stored_table::ParquetProblem;

use crate::scenario::run_folder::{Copied, MANIFEST, Manifest};

const PARQUET: &str = "trajectory.parquet";
const SHAPES: &str = "shapes.json";
const CSV: &str = "trajectory.csv";

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
    write_all(folder, record, options, false)
}

/// The same; the journal in the folder stays where it `keeps` what could not be read.
fn write_all(
    folder: &RunFolder,
    record: &RunRecord<'_>,
    options: Options,
    keeps: bool,
) -> Result<Vec<PathBuf>, OutputError> {
    let recording = &record.outcome.recording;
    let metrics = metrics(record);
    let mut staging = folder.stage_run();
    staging.write_text("scenario.toml", record.scenario_text)?;
    let mut copied = HashSet::new();
    let mut listed = Vec::new();
    for (input, text) in inputs::copies(record.inputs) {
        listed.push(Copied { name: input.name, file: input.file.clone() });
        if !copied.contains(&input.file) {
            staging.write_text(&input.file, text)?;
            copied.insert(input.file);
        }
    }
    if !listed.is_empty() {
        let listed = serde_json::to_string_pretty(&Manifest::new(listed));
        staging.write(MANIFEST, |out| Ok(std::io::Write::write_all(out, listed?.as_bytes())?))?;
    }
    let mut tables = Vec::new();
    let mut table = |file: &str, Written { digest, bytes }: Written| {
        let digest_blake3 = digest.to_hex().to_string();
        tables.push(summary::TableFile { file: file.into(), digest_blake3, bytes: Some(bytes) });
    };
    table(PARQUET, staging.write(PARQUET, |out| Ok(parquet::write(out, record)?))?);
    if options.csv {
        table(CSV, staging.write(CSV, |out| Ok(csv::write(out, record.setup, recording)?))?);
    }
    if !packets::links(&record.setup.network).is_empty() {
        table(
            "packets.csv",
            staging.write("packets.csv", |out| Ok(packets::write(out, record.setup, &record.outcome.ending)?))?,
        );
    }
    if draws::draws_phases(&record.setup.network) {
        table("phases.csv", staging.write("phases.csv", |out| Ok(draws::write_phases(out, record.setup)?))?);
    }
    if !draws::holds(&record.setup.network).is_empty() {
        table("holds.csv", staging.write("holds.csv", |out| Ok(draws::write_holds(out, record.setup)?))?);
    }
    if let Some(shapes) = record.shapes {
        let text = serde_json::to_string(shapes);
        staging.write(SHAPES, |out| Ok(std::io::Write::write_all(out, text?.as_bytes())?))?;
    }
    write_pictures(&mut staging, record, &metrics)?;
    staging.write("summary.json", |out| Ok(summary::Summary::of(record, metrics, tables).write(out)?))?;
    staging.publish(keeps)
}

/// Writes what is drawn from the tables, `report.html` and `plots/*.svg`, anew into a folder of a run, and leaves everything
/// else in it as it is. Returns the files written.
pub(crate) fn write_report(folder: &RunFolder, record: &RunRecord<'_>) -> Result<Vec<PathBuf>, OutputError> {
    let mut staging = folder.stage();
    write_pictures(&mut staging, record, &metrics(record))?;
    staging.replace()
}

fn metrics(record: &RunRecord<'_>) -> Metrics {
    let goal = record.goal.map(|outcome| outcome.goal);
    Metrics::of(record.setup, &record.outcome.recording, record.predicted_agreement.as_deref(), goal)
}

fn write_pictures(staging: &mut Staging<'_>, record: &RunRecord<'_>, metrics: &Metrics) -> Result<(), OutputError> {
    staging.write_text("report.html", &report::page(record, metrics, None))?;
    let plots = plots::Plots::of(record);
    let mut plot = |name, svg: Result<String, EncodeError>| {
        staging.write(name, |out| Ok(std::io::Write::write_all(out, svg?.as_bytes())?))
    };
    plot("plots/positions.svg", plots.positions())?;
    plot("plots/torques.svg", plots.torques())?;
    plot("plots/estimates.svg", plots.estimates())?;
    plot("plots/disagreement.svg", plots.disagreement())?;
    Ok(())
}
