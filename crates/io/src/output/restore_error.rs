//! Why a report cannot be built anew from the folder of a run.

use std::borrow::Cow;
use std::fmt;
use std::io::ErrorKind;
use std::path::PathBuf;

use forwardstep_sim::SetupError;
use miette::Diagnostic;
use thiserror::Error;

use super::comparison;
use super::error::OutputError;
use super::folder::RunFolder;
use super::journal::JournalError;
use super::stored_table::ParquetProblem;
use super::summary::FORMAT;
use crate::files::ReadError;
use crate::scenario::ScenarioError;
use crate::shown;
use crate::shown::one_line;

/// A folder that no report can be built from.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// There is nothing.
    #[error("there is no folder `{}`", shown(path))]
    NoFolder {
        /// What was asked for.
        path: PathBuf,
        /// A folder of a run that may have been meant.
        meant: Option<PathBuf>,
    },
    /// It is a file.
    #[error("`{}` is not a folder", shown(path))]
    NotAFolder {
        /// The file.
        path: PathBuf,
        /// The folder of a run that it is in.
        meant: Option<PathBuf>,
    },
    /// It lacks a file that every run writes.
    #[error("`{}` holds no whole run: there is no {missing} in it", shown(path))]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// The file, or the files of which one is needed.
        missing: &'static str,
    },
    /// A file of it cannot be read.
    #[error("cannot read `{}`: {reason}", shown(path))]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: ReadError,
    },
    /// Its summary is not one.
    #[error("`{}`: {}", shown(path), one_line(reason))]
    Summary {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: SummaryError,
    },
    /// The journal of the run that was cut off cannot be used.
    #[error("`{}`: {}", shown(path), one_line(reason))]
    Journal {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: JournalError,
    },
    /// Its scenario has a mistake.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// Its scenario cannot be simulated.
    #[error("`{}`: {}", shown(path), one_line(reason))]
    Setup {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: Box<SetupError>,
    },
    /// Its table cannot be used.
    #[error("`{}`: {}", shown(path), one_line(reason))]
    Table {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: TableError,
        /// Whether the scenario, or a file that it names, says something else than at the time of the run.
        scenario_changed: bool,
    },
    /// It cannot be written to.
    #[error(transparent)]
    Folder(#[from] OutputError),
}

/// What is wrong with a `summary.json`.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SummaryError {
    /// It is not what a run writes.
    #[error("not a summary as runs write it: {}", one_line(.0))]
    Unreadable(#[from] serde_json::Error),
    /// A later version wrote it.
    #[error("its format is {found}, and this version of forwardstep reads formats up to {FORMAT}")]
    Newer {
        /// Its format.
        found: u32,
    },
    /// The copy of an input stands outside of the folder.
    #[error("it says that the copy of an input is `{}`, which is not in `inputs/`", shown(file))]
    Copy {
        /// The name it gives.
        file: String,
    },
    /// It says that something broke down which the scenario does not have.
    #[error("it says that {} broke down, and the scenario has no such signal", shown(column))]
    Breakdown {
        /// The signal, or what there is instead.
        column: String,
    },
}

/// What is wrong with a table.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TableError {
    /// It is not the file that the run wrote.
    #[error("it was changed or damaged since the run: its digest is no longer the one in summary.json")]
    Digest,
    /// Parquet that cannot be read.
    #[error(transparent)]
    Parquet(#[from] ParquetProblem),
    /// CSV that cannot be read.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A column holds something else than numbers.
    #[error("the column `{}` does not hold a number in every row", shown(column))]
    NotNumbers {
        /// Its name.
        column: String,
    },
    /// A field is no number.
    #[error("line {line}: `{}` in the column `{}` is no number", shown(found), shown(column))]
    NotANumber {
        /// Its line, from one.
        line: u64,
        /// Its column.
        column: String,
        /// What it is.
        found: String,
    },
    /// Two columns have one name.
    #[error("there are two columns `{}`", shown(column))]
    ColumnTwice {
        /// The name.
        column: String,
    },
    /// A column that no run of the scenario has.
    #[error("no run of the scenario records the column `{}`", shown(column))]
    UnknownColumn {
        /// Its name.
        column: String,
    },
    /// A column that every run has is not there.
    #[error("there is no column `{}`", shown(column))]
    MissingColumn {
        /// Its name.
        column: String,
    },
    /// It cannot be what the run wrote.
    #[error("it is much larger than the {written} rows that the run wrote can be")]
    TooLarge {
        /// How many rows the run wrote.
        written: usize,
    },
    /// Rows were lost, or came from elsewhere.
    #[error("it has {found} rows, and the run wrote {written}")]
    Rows {
        /// How many there are.
        found: usize,
        /// How many there should be.
        written: usize,
    },
    /// Time goes on far behind the end that the scenario states, or for ever.
    #[error("its last row is at t = {t_s} s, and the scenario ends at {end_s} s")]
    Beyond {
        /// The last time, s.
        t_s: f64,
        /// Where the scenario ends, s.
        end_s: f64,
    },
    /// Time goes back, or is no number.
    #[error("time does not rise at row {row}")]
    Times {
        /// The row, from one.
        row: usize,
    },
}

impl RestoreError {
    fn advice(&self) -> Option<String> {
        const AGAIN: &str = "run the scenario again";
        Some(match self {
            RestoreError::NoFolder { meant: Some(meant), .. } | RestoreError::NotAFolder { meant: Some(meant), .. } => {
                format!("did you mean `{}`?", shown(meant))
            }
            RestoreError::NoFolder { .. } | RestoreError::NotAFolder { .. } => {
                "give the folder of a run, such as `forwardstep-runs/six-arms`".into()
            }
            RestoreError::NotARun { path, .. } if path.join(comparison::PAGE).is_file() => {
                "it is a comparison: give one of the runs that it compares".into()
            }
            RestoreError::NotARun { path, .. } if RunFolder::is_in_use(path) == Some(true) => {
                "a run is writing to it and has no rows yet: wait a second, or use `--follow`".into()
            }
            RestoreError::NotARun { missing: "summary.json", .. } => {
                format!("it is written last: the run was not finished, or the file was removed; {AGAIN}")
            }
            RestoreError::NotARun { .. } => format!("restore it from a copy, or {AGAIN}"),
            RestoreError::File { reason: ReadError::Refused(ErrorKind::PermissionDenied), .. } => {
                "make it readable for yourself".into()
            }
            RestoreError::File { reason, .. } => match reason.help() {
                Some(help) => help.into(),
                None => format!("restore it from a copy, or {AGAIN}"),
            },
            RestoreError::Journal { reason: JournalError::Newer { .. }, .. }
            | RestoreError::Summary { reason: SummaryError::Newer { .. }, .. } => {
                "use the version that wrote it, or a later one".into()
            }
            RestoreError::Summary { .. } | RestoreError::Setup { .. } => format!("restore it from a copy, or {AGAIN}"),
            RestoreError::Table { reason, scenario_changed, .. } => match reason {
                TableError::UnknownColumn { .. } | TableError::MissingColumn { .. } if *scenario_changed => {
                    format!("the scenario was changed since the run: undo the change, or {AGAIN}")
                }
                TableError::Digest => {
                    format!("restore it from a copy, or remove it if trajectory.csv is whole, or {AGAIN}")
                }
                _ => format!("restore it from a copy, or {AGAIN}"),
            },
            RestoreError::Journal { .. } => format!("restore it from a copy, or {AGAIN}"),
            RestoreError::Folder(OutputError::FolderInUse { .. }) => {
                "wait until it has ended, or see what it has until now in another folder with --out".into()
            }
            RestoreError::Folder(OutputError::Io { source, .. }) if source.kind() == ErrorKind::PermissionDenied => {
                "make the folder writable for yourself, or copy it to where you may write".into()
            }
            RestoreError::Folder(error) => return error.help().map(Cow::into_owned),
            RestoreError::Scenario(_) => return None,
        })
    }
}

impl Diagnostic for RestoreError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        match self {
            RestoreError::Scenario(error) => error.help(),
            _ => self.advice().map(|text| Box::new(text) as Box<_>),
        }
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        match self {
            RestoreError::Scenario(error) => error.source_code(),
            _ => None,
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        match self {
            RestoreError::Scenario(error) => error.labels(),
            _ => None,
        }
    }
}
