//! Text files, and what stands beside them.

use std::fmt;
use std::fs::{File, FileType, OpenOptions};
use std::io::{ErrorKind, Read};
use std::path::Path;

use thiserror::Error;

use crate::foreign::{Foreign, foreign_bytes, foreign_text};

/// Files larger than this are not read.
pub(crate) const MOST_BYTES: u64 = 1 << 26;

/// The same of scenarios.
const MOST_BYTES_OF_A_SCENARIO: u64 = 1 << 24;

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
    /// It is neither a file nor a folder, and might give bytes for ever, or none.
    #[error("it is {0}, and no file")]
    NotAFile(Special),
    /// It is clearly meant for something else; nothing of it is quoted.
    #[error("it holds {0}")]
    Foreign(Foreign),
    /// It is larger than anything that is meant to be read.
    #[error("it is larger than {} MiB", MOST_BYTES >> 20)]
    TooLarge,
    /// It is larger than any scenario: all of its mistakes would be collected at once.
    #[error("it is larger than {} MiB, as no scenario is", MOST_BYTES_OF_A_SCENARIO >> 20)]
    LargeScenario,
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

/// What has a name among files and is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Special {
    /// A pipe.
    Pipe,
    /// A socket.
    Socket,
    /// A device.
    Device,
    /// A stream that blocks until data arrives.
    Waits,
    /// Something that this system does not tell.
    Other,
}

impl fmt::Display for Special {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Special::Pipe => "a pipe",
            Special::Socket => "a socket",
            Special::Device => "a device",
            Special::Waits => "something that waits for more",
            Special::Other => "something special",
        })
    }
}

impl Special {
    #[cfg(unix)]
    fn of(kind: FileType) -> Special {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            Special::Pipe
        } else if kind.is_socket() {
            Special::Socket
        } else if kind.is_char_device() || kind.is_block_device() {
            Special::Device
        } else {
            Special::Other
        }
    }

    #[cfg(not(unix))]
    fn of(_: FileType) -> Special {
        Special::Other
    }
}

impl From<std::io::Error> for ReadError {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => ReadError::Missing,
            ErrorKind::IsADirectory => ReadError::Folder,
            ErrorKind::WouldBlock => ReadError::NotAFile(Special::Waits),
            kind => ReadError::Refused(kind),
        }
    }
}

impl ReadError {
    /// What the user can do about it, apart from naming another file.
    pub(crate) fn help(self) -> Option<&'static str> {
        match self {
            ReadError::NotUtf8 { .. } => Some("save it as UTF-8"),
            ReadError::NotAFile(_) => Some("save what it gives as a file, and name that"),
            ReadError::Refused(ErrorKind::PermissionDenied) => Some("ask for the right to read it, or name a copy"),
            _ => None,
        }
    }
}

/// Opens a file, and nothing else: who opens a pipe for reading waits until somebody writes.
pub(crate) fn open_file(path: &Path) -> Result<File, ReadError> {
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(ReadError::Folder);
    }
    if !kind.is_file() {
        return Err(ReadError::NotAFile(Special::of(kind)));
    }
    match without_waiting(OpenOptions::new().read(true)).open(path) {
        // Somebody holds a lease on it, and gives it up in time.
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(File::open(path)?),
        opened => Ok(opened?),
    }
}

/// What says that it is a file may wait for data all the same, as the log of the kernel does.
#[cfg(unix)]
fn without_waiting(options: &mut OpenOptions) -> &mut OpenOptions {
    use std::os::unix::fs::OpenOptionsExt;
    options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed())
}

#[cfg(not(unix))]
fn without_waiting(options: &mut OpenOptions) -> &mut OpenOptions {
    options
}

/// Reads a text file of reasonable size.
pub(crate) fn read_text(path: &Path) -> Result<String, ReadError> {
    let mut bytes = Vec::new();
    open_file(path)?.take(MOST_BYTES + 1).read_to_end(&mut bytes)?;
    text_of(bytes)
}

/// Reads a scenario.
pub(crate) fn read_scenario_text(path: &Path) -> Result<String, ReadError> {
    let text = read_text(path)?;
    if text.len() as u64 > MOST_BYTES_OF_A_SCENARIO { Err(ReadError::LargeScenario) } else { Ok(text) }
}

/// The text that these bytes are, if they are of reasonable size.
pub(crate) fn text_of(bytes: Vec<u8>) -> Result<String, ReadError> {
    if bytes.len() as u64 > MOST_BYTES {
        return Err(ReadError::TooLarge);
    }
    if let Some(foreign) = foreign_bytes(&bytes) {
        return Err(ReadError::Foreign(foreign));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let (sound, rest) = error.as_bytes().split_at(error.utf8_error().valid_up_to());
        let before = String::from_utf8_lossy(sound);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        ReadError::NotUtf8 {
            byte: rest.first().copied().unwrap_or_default(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
        }
    })?;
    match foreign_text(&text) {
        Some(foreign) => Err(ReadError::Foreign(foreign)),
        None => Ok(text),
    }
}

/// Whether a file of this name ends in `.extension`.
pub(crate) fn has_extension(name: &str, extension: &str) -> bool {
    Path::new(name).extension().is_some_and(|found| found == extension)
}

/// Other files beside `path` that end in `.extension`.
pub(crate) fn neighbours(path: &Path, extension: &str) -> Vec<String> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names
        .filter(|name| has_extension(name, extension))
        .filter(|name| path.file_name().is_none_or(|own| own != name.as_str()))
        .collect();
    names.sort();
    names
}
