//! What can go wrong while results are written.

use crate::shown;
use crate::wording::for_shell;
use std::borrow::Cow;
use std::io;
use std::path::PathBuf;

/// Something could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The folder holds files already and was not to be replaced.
    #[error("{} already exists and is not empty", shown(path))]
    FolderNotEmpty {
        /// The folder.
        path: PathBuf,
        /// Whether what it holds may be replaced by who asks for that.
        replaceable: bool,
        /// Whether it holds the rows of a run that was cut off, of which nothing else is written yet.
        cut_off: bool,
    },
    /// The folder was to be replaced, and no run wrote it.
    #[error("{} was not written by a run, and stays as it is", shown(path))]
    NotOfARun {
        /// The folder.
        path: PathBuf,
    },
    /// The folder was to be replaced, and no comparison wrote it.
    #[error("{} was not written by `compare`, and stays as it is", shown(path))]
    NotOfAComparison {
        /// The folder.
        path: PathBuf,
    },
    /// The folder was to be replaced, and holds what no run can write again.
    #[error("{} is not as the run in that folder wrote it, and stays as it is", shown(path))]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// There is a file where the folder should be.
    #[error("{} exists and is not a folder", shown(path))]
    NotAFolder {
        /// The file.
        path: PathBuf,
    },
    /// Another run writes into the folder.
    #[error("another run is writing to {}", shown(path))]
    FolderInUse {
        /// The folder.
        path: PathBuf,
    },
    /// The folder was renamed or removed since, and another has its name.
    #[error("{} is another folder by now: that of this run was renamed or removed while it went on{}", shown(path), is_now(now.as_deref()))]
    Elsewhere {
        /// What it was called.
        path: PathBuf,
        /// What it is called now, where the system tells.
        now: Option<PathBuf>,
    },
    /// Something stands where a file of the run or a folder for some has to be.
    #[error("{} is {found}, where a run has to write", shown(path))]
    InTheWay {
        /// What stands there.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// The operating system refused.
    #[error("could not {action} {}: {source}", shown(path))]
    Io {
        /// What was tried.
        action: Action,
        /// With which file or folder.
        path: PathBuf,
        /// The reason.
        source: io::Error,
    },
    /// A table or plot could not be encoded.
    #[error("could not encode {}: {reason}", shown(path))]
    Encode {
        /// The file.
        path: PathBuf,
        /// The reason the encoder gave.
        reason: EncodeError,
    },
}

/// Why an encoder failed.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// The Parquet table.
    #[error(transparent)]
    Parquet(#[from] parquet::errors::ParquetError),
    /// A JSON document.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A plot; the drawing library's own words.
    #[error("drawing failed: {0}")]
    Plot(String),
}

/// What was tried with a file or folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Action {
    /// Make a folder.
    CreateFolder,
    /// List a folder.
    ReadFolder,
    /// Find out whether files can be written into a folder.
    WriteInto,
    /// Open a new file.
    CreateFile,
    /// Write to a file, or bring what was written to the disk.
    WriteFile,
    /// Give a finished file its final name.
    RenameFile,
    /// Remove a file of an earlier run.
    RemoveFile,
}

impl std::fmt::Display for Action {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Action::CreateFolder => "create the folder",
            Action::ReadFolder => "look into the folder",
            Action::WriteInto => "write into the folder",
            Action::CreateFile => "create",
            Action::WriteFile => "write",
            Action::RenameFile => "finish",
            Action::RemoveFile => "replace",
        })
    }
}

/// Where a folder is, at the end of a sentence.
fn is_now(folder: Option<&std::path::Path>) -> String {
    folder.map_or_else(String::new, |folder| format!(" and is {} now", shown(folder)))
}

impl OutputError {
    /// What the user can do about it.
    pub fn help(&self) -> Option<Cow<'static, str>> {
        if let OutputError::FolderNotEmpty { path, cut_off: true, .. } = self {
            let folder = for_shell(&shown(path).to_string());
            return Some(Cow::Owned(format!(
                "the run in it was cut off: `forwardstep report {folder}` writes the files of what it computed; or choose another folder with --out"
            )));
        }
        self.plain_help().map(Cow::Borrowed)
    }

    fn plain_help(&self) -> Option<&'static str> {
        const AMID: [Action; 4] = [Action::CreateFile, Action::WriteFile, Action::RenameFile, Action::RemoveFile];
        match self {
            OutputError::FolderNotEmpty { replaceable: true, .. } => {
                Some("choose another folder, or replace the files of the earlier run with --force")
            }
            OutputError::FolderNotEmpty { .. } => Some("choose another folder"),
            OutputError::NotOfARun { .. } => {
                Some("choose another folder: --force replaces only what an earlier run wrote")
            }
            OutputError::NotOfAComparison { .. } => {
                Some("choose another folder with --out: --force replaces only what an earlier comparison wrote")
            }
            OutputError::Changed { .. } => {
                Some("move it elsewhere if you need it, or remove it, or choose another folder")
            }
            OutputError::NotAFolder { .. } => Some("choose another folder"),
            OutputError::FolderInUse { .. } => Some("wait until it has ended, or choose another folder with --out"),
            OutputError::Elsewhere { now: Some(_), .. } => Some(
                "nothing was written there: what this run kept is in `rows.journal` in its folder, and `forwardstep report` of that writes the \
                 files from it",
            ),
            OutputError::Elsewhere { now: None, .. } => Some(
                "nothing was written there: if the folder was renamed, `forwardstep report` of it under its new name writes the files",
            ),
            OutputError::InTheWay { .. } => Some("move it elsewhere, or choose another folder"),
            OutputError::Io { action, source, .. } => match source.kind() {
                io::ErrorKind::PermissionDenied => Some("choose a folder you may write to"),
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                    Some("free some space on the disk, or choose a folder on another one")
                }
                io::ErrorKind::FileTooLarge => {
                    Some("raise the limit on the size of files (`ulimit -f`), or record fewer rows")
                }
                io::ErrorKind::ReadOnlyFilesystem => {
                    Some("choose a folder on a disk that can be written to, such as with --out")
                }
                // The folder could be written to before.
                _ if AMID.contains(action) => {
                    Some("look whether the disk is sound and still there, or choose a folder on another one")
                }
                _ if *action == Action::CreateFolder => {
                    Some("choose another folder, or look whether the disk is sound and still there")
                }
                _ => None,
            },
            OutputError::Encode { .. } => None,
        }
    }
}
