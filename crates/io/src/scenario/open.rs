//! From what a user types to a scenario, and the text files that a scenario names.

use std::path::{Path, PathBuf};

use miette::Diagnostic;
use thiserror::Error;

use super::kinds::Kinds;
use super::run_folder::{self, JOURNAL};
use super::shipped::{SHIPPED_SCENARIOS, shipped_scenario};
use super::{Scenario, ScenarioError};
use crate::SourceText;
use crate::files::{ReadError, neighbours, read_scenario_text};
use crate::shown;
use crate::shown::one_line;
use crate::wording::{choose, for_shell};

/// Why there is no scenario to run.
#[derive(Clone, Debug, Error)]
pub enum OpenError {
    /// Neither a shipped scenario nor a file.
    #[error("there is no scenario `{}`", shown(name))]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A file that cannot be read.
    #[error("cannot read `{}`: {reason}", shown(path))]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: ReadError,
    },
    /// The folder of a run whose list of copies is none.
    #[error("`{}` is no list of copies as runs write it: {}", shown(path), one_line(reason))]
    Manifest {
        /// The list.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file with a mistake.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

impl Diagnostic for OpenError {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        match self {
            OpenError::Unknown { name } => {
                let file = format!("{name}.toml");
                if !name.is_empty() && Path::new(&file).is_file() {
                    return Some(Box::new(format!("did you mean the file `{}`?", shown(&file))));
                }
                let shipped: Vec<&str> = SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name).collect();
                let text = choose(name, "shipped scenarios are", &shipped);
                Some(Box::new(format!("{text}; for a file of your own give its path, such as `my-network.toml`")))
            }
            OpenError::File { path, reason: ReadError::Missing } if path.is_symlink() => {
                Some(Box::new("it is a link to something that is not there"))
            }
            OpenError::File { path, reason: ReadError::Folder } if path.join(JOURNAL).exists() => {
                let folder = for_shell(&shown(path).to_string());
                Some(Box::new(format!(
                    "it is the folder of a run that was cut off: `forwardstep report {folder}` first writes all its files, the scenario among them"
                )))
            }
            OpenError::File { path, reason: ReadError::Folder } if path.join(run_folder::SCENARIO).is_file() => {
                Some(Box::new(format!("give the scenario in it, `{}`", shown(&path.join(run_folder::SCENARIO)))))
            }
            OpenError::File { path, reason: ReadError::Folder } => {
                let known = neighbours(&path.join(run_folder::SCENARIO), "toml");
                let text = match known.is_empty() {
                    true => "give a scenario file, or the folder of a run, which holds `scenario.toml`".to_owned(),
                    false => choose("", "name a file in it: there are", &known),
                };
                Some(Box::new(text))
            }
            OpenError::File { path, reason: ReadError::Missing } => {
                let known = neighbours(path, "toml");
                let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
                (!known.is_empty()).then(|| Box::new(choose(name, "in that folder:", &known)) as Box<_>)
            }
            OpenError::File { reason, .. } => reason.help().map(|help| Box::new(help) as Box<_>),
            OpenError::Manifest { .. } => Some(Box::new("restore it from a copy, or run the original scenario again")),
            OpenError::Scenario(error) => error.help(),
        }
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        match self {
            OpenError::Scenario(error) => error.source_code(),
            _ => None,
        }
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        match self {
            OpenError::Scenario(error) => error.related(),
            _ => None,
        }
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        match self {
            OpenError::Scenario(error) => error.labels(),
            _ => None,
        }
    }
}

/// Opens the shipped scenario of this name, else the file at this path, or what was run in the folder at this path. A path with a folder, such as `./six-arms`, is
/// always a file.
///
/// # Errors
/// [`OpenError`] when there is no such scenario, or it cannot be read or has a mistake.
pub fn open_scenario(name_or_path: &str) -> Result<Scenario, OpenError> {
    Kinds::shipped().open_scenario(name_or_path)
}

impl Kinds {
    /// [`open_scenario`] with these kinds.
    ///
    /// # Errors
    /// As of [`open_scenario`].
    pub fn open_scenario(&self, name_or_path: &str) -> Result<Scenario, OpenError> {
        open(name_or_path, self)
    }
}

/// The text of the file at this path, unless it is clearly something else than a scenario.
///
/// # Errors
/// [`OpenError`] when it cannot be read.
pub fn open_text(path: &Path) -> Result<SourceText, OpenError> {
    let text = read_scenario_text(path).map_err(|reason| OpenError::File { path: path.to_owned(), reason })?;
    Ok(SourceText::new(path.display().to_string(), text))
}

/// Whether a run began in this folder of a run and has not ended: its rows are younger than the summary, if there is one.
fn has_newer_rows(folder: &Path) -> bool {
    let changed = |name: &str| folder.join(name).metadata().and_then(|found| found.modified()).ok();
    changed(JOURNAL).is_some_and(|rows| changed("summary.json").is_none_or(|summary| rows > summary))
}

fn open(name_or_path: &str, kinds: &Kinds) -> Result<Scenario, OpenError> {
    if let Some(shipped) = shipped_scenario(name_or_path) {
        let source = SourceText::new(shipped.name, shipped.text);
        return Ok(kinds.read_scenario(shipped.name, &source, None)?);
    }
    let path = Path::new(name_or_path);
    if run_folder::is_run_folder(path) {
        // The scenario in it may be that of the run before.
        if has_newer_rows(path) {
            return Err(OpenError::File { path: path.to_owned(), reason: ReadError::Folder });
        }
        return run_folder::open(path, kinds);
    }
    let text = read_scenario_text(path).map_err(|reason| {
        let looks_like_a_name = path.extension().is_none() && path.components().count() <= 1;
        if reason == ReadError::Missing && looks_like_a_name {
            OpenError::Unknown { name: name_or_path.to_owned() }
        } else {
            OpenError::File { path: path.to_owned(), reason }
        }
    })?;
    let name = path.file_stem().map_or_else(|| "scenario".into(), |stem| stem.to_string_lossy());
    Ok(kinds.read_scenario(&name, &SourceText::new(name_or_path, text), path.parent())?)
}
