//! What is to be said of a run that was read back from its folder.

use std::fmt;

use super::CSV;
use super::journal::JOURNAL;
use crate::shown;

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
    /// The run was not finished; its rows come from its journal.
    FromJournal {
        /// How many they are.
        rows: usize,
        /// Whether it was cut off, rather than ended in order before its tables were whole.
        cut_off: bool,
    },
    /// Behind what holds the journal is damaged, or its last frame was not written to the end.
    JournalDamaged {
        /// How much was left out.
        bytes: u64,
    },
    /// The run is still going on.
    StillRunning,
    /// The table was read from CSV that the run did not write.
    OtherCsv,
    /// The tables lack columns that a run would record now.
    ColumnsMissing {
        /// One of them.
        first: String,
        /// How many they are.
        count: usize,
    },
    /// What the robots look like cannot be read.
    ShapesDamaged,
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
                "`{}`, which the scenario names, is not what it was at the time of the run; the signals are those of the \
                 run, verdicts and limits follow the file",
                shown(name)
            ),
            Remark::FromJournal { rows, cut_off: true } => write!(
                f,
                "the run was cut off; {rows} rows come from {JOURNAL}, to which a run adds its rows every second, and what the run cost is \
                 not known"
            ),
            Remark::FromJournal { rows, cut_off: false } => {
                write!(f, "the run ended before its tables were written; {rows} rows come from {JOURNAL}")
            }
            Remark::JournalDamaged { bytes } => {
                write!(
                    f,
                    "the last {bytes} bytes of {JOURNAL} are left out: they begin with what is damaged or was not written to its end, and what \
                     stands behind that is not trusted"
                )
            }
            Remark::StillRunning => f.write_str("the run is still going on; this is what its journal has until now"),
            Remark::OtherCsv => write!(f, "{CSV} is not as the run wrote it; its numbers are shown as they are"),
            Remark::ColumnsMissing { first, count: 1 } => write!(f, "the tables have no column `{}`", shown(first)),
            Remark::ColumnsMissing { first, count } => {
                write!(f, "the tables have no column `{}` and lack {} more", shown(first), count - 1)
            }
            Remark::ShapesDamaged => {
                f.write_str("shapes.json, which says what the robots look like, cannot be read; they are drawn as capsules")
            }
            Remark::VerdictsDiffer => {
                f.write_str("the verdicts were worked out anew and are not those given before the run, which summary.json has")
            }
            Remark::Upgraded => f.write_str(
                "the run was written in an earlier format; it is shown under the names that `forwardstep upgrade` gives",
            ),
            Remark::OtherVersion { simulated, now } => {
                write!(f, "simulated by forwardstep {}; this page was made by forwardstep {now}", shown(simulated))
            }
        }
    }
}
