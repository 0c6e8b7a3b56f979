//! From what a user types to a scenario, and the text files that a scenario names.

use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use thiserror::Error;

use super::shipped::{SHIPPED_SCENARIOS, shipped_scenario};
use super::{Scenario, ScenarioError, read_scenario};
use crate::SourceText;
use crate::wording::choose;

/// Why there is no scenario to run.
#[derive(Clone, Debug, Error)]
pub enum OpenError {
    /// Neither a shipped scenario nor a file.
    #[error("there is no scenario `{name}`")]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// A file that cannot be read.
    #[error("cannot read `{}`: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: ReadError,
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
                    return Some(Box::new(format!("did you mean the file `{file}`?")));
                }
                let shipped: Vec<&str> = SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name).collect();
                let text = choose(name, "shipped scenarios are", &shipped);
                Some(Box::new(format!("{text}; for a file of your own give its path, such as `my-fleet.toml`")))
            }
            OpenError::File { path, reason: ReadError::Missing } => {
                let known = neighbours(path, "toml");
                let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
                (!known.is_empty()).then(|| Box::new(choose(name, "in that folder:", &known)) as Box<_>)
            }
            OpenError::File { reason, .. } => reason.help().map(|help| Box::new(help) as Box<_>),
            OpenError::Scenario(error) => error.help(),
        }
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        match self {
            OpenError::Scenario(error) => error.source_code(),
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

/// Opens the shipped scenario of this name, else the file at this path. A path with a folder, such as `./six-arms`, is
/// always a file.
///
/// # Errors
/// [`OpenError`] when there is no such scenario, or it cannot be read or has a mistake.
pub fn open_scenario(name_or_path: &str) -> Result<Scenario, OpenError> {
    if let Some(shipped) = shipped_scenario(name_or_path) {
        let source = SourceText::new(shipped.name, shipped.text);
        return Ok(read_scenario(shipped.name, &source, None)?);
    }
    let path = Path::new(name_or_path);
    let text = read_text(path).map_err(|reason| {
        let looks_like_a_name = path.extension().is_none() && path.components().count() <= 1;
        if reason == ReadError::Missing && looks_like_a_name {
            OpenError::Unknown { name: name_or_path.to_owned() }
        } else {
            OpenError::File { path: path.to_owned(), reason }
        }
    })?;
    let name = path.file_stem().map_or_else(|| "scenario".into(), |stem| stem.to_string_lossy());
    Ok(read_scenario(&name, &SourceText::new(name_or_path, text), path.parent())?)
}

/// Files larger than this are not read.
const MOST_BYTES: u64 = 1 << 26;

/// Why a text file cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// There is none of that name.
    #[error("there is no such file")]
    Missing,
    /// It is a folder.
    #[error("it is a folder")]
    Folder,
    /// It is larger than anything that is meant to be read.
    #[error("it is larger than {} MiB", MOST_BYTES >> 20)]
    TooLarge,
    /// It holds something else than UTF-8.
    #[error("it is no UTF-8 text: byte {byte:#04x} in line {line}, column {column}")]
    NotUtf8 {
        /// The first byte that is wrong.
        byte: u8,
        /// Its line, from one.
        line: usize,
        /// Its column in characters, from one.
        column: usize,
    },
    /// The operating system refused.
    #[error("{0}")]
    Refused(ErrorKind),
}

impl From<std::io::Error> for ReadError {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => ReadError::Missing,
            ErrorKind::IsADirectory => ReadError::Folder,
            kind => ReadError::Refused(kind),
        }
    }
}

impl ReadError {
    /// What the user can do about it, apart from naming another file.
    pub(super) fn help(self) -> Option<&'static str> {
        matches!(self, ReadError::NotUtf8 { .. }).then_some("save it as UTF-8")
    }
}

/// Reads a text file of reasonable size.
pub(super) fn read_text(path: &Path) -> Result<String, ReadError> {
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(ReadError::TooLarge);
    }
    String::from_utf8(bytes).map_err(|error| {
        let (sound, rest) = error.as_bytes().split_at(error.utf8_error().valid_up_to());
        let before = String::from_utf8_lossy(sound);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        ReadError::NotUtf8 {
            byte: rest.first().copied().unwrap_or_default(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
        }
    })
}

/// Other files beside `path` that end in `.extension`.
pub(super) fn neighbours(path: &Path, extension: &str) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names
        .filter(|name| Path::new(name).extension().is_some_and(|found| found == extension))
        .filter(|name| path.file_name().is_none_or(|own| own != name.as_str()))
        .collect();
    names.sort();
    names
}
