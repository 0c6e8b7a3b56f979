//! The folder of a run as a scenario: `scenario.toml` with the copies of the files that it names, wherever the folder stands now.
//!
//! `inputs/manifest.json` says which copy stands for which name. Names that it does not have are looked for as beside any scenario.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Scenario;
use super::inputs::{INPUTS, Inputs, plain_name};
use super::kinds::Kinds;
use super::open::OpenError;
use crate::SourceText;
use crate::files::{ReadError, read_text};

/// The scenario's text in such a folder.
pub(crate) const SCENARIO: &str = "scenario.toml";
/// The rows of a run that goes on, or was cut off.
pub(crate) const JOURNAL: &str = "rows.journal";
/// Where the copies are listed.
pub(crate) const MANIFEST: &str = "inputs/manifest.json";
/// The format of the list.
const FORMAT: u32 = 1;

/// Which copy stands for which name.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Manifest {
    format: u32,
    pub(crate) files: Vec<Copied>,
}

/// A file that a scenario names, copied.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Copied {
    /// Its name in the scenario.
    pub(crate) name: String,
    /// Its copy in the folder of the run.
    pub(crate) file: String,
}

impl Manifest {
    #[cfg_attr(not(feature = "report"), expect(dead_code, reason = "only runs write it"))]
    pub(crate) fn new(files: Vec<Copied>) -> Self {
        Manifest { format: FORMAT, files }
    }
}

/// Whether a copy may have this name. A list may have been edited, and must not lead out of its folder.
pub(crate) fn is_copy(file: &str) -> bool {
    plain_name(file).is_some_and(|plain| plain == file && plain.starts_with(&format!("{INPUTS}/")))
}

/// Whether a path is a folder with a scenario, or with something else in its place, which is then named.
pub(super) fn is_run_folder(path: &Path) -> bool {
    path.join(SCENARIO).symlink_metadata().is_ok()
}

/// Reads the scenario of a run's folder.
pub(super) fn open(folder: &Path, kinds: &Kinds) -> Result<Scenario, OpenError> {
    let text_of = |path: PathBuf| match read_text(&path) {
        Ok(text) => Ok(text),
        Err(reason) => Err(OpenError::File { path, reason }),
    };
    let text = text_of(folder.join(SCENARIO))?;
    let mut inputs = Inputs::from(Some(folder));
    match text_of(folder.join(MANIFEST)) {
        Ok(list) => {
            let wrong = |reason: String| OpenError::Manifest { path: folder.join(MANIFEST), reason };
            let list: Manifest = serde_json::from_str(&list).map_err(|error| wrong(error.to_string()))?;
            if list.format != FORMAT {
                return Err(wrong(format!(
                    "its format is {}, and this version of forwardstep reads {FORMAT}",
                    list.format
                )));
            }
            for Copied { name, file } in list.files {
                if !is_copy(&file) {
                    return Err(wrong(format!(
                        "it says that the copy of an input is `{file}`, which is not in `{INPUTS}/`"
                    )));
                }
                inputs = inputs.file_at(&name, folder.join(file));
            }
        }
        // No files, or a run of before.
        Err(OpenError::File { reason: ReadError::Missing, .. }) => {}
        Err(error) => return Err(error),
    }
    // `.` has no name of its own.
    let named =
        folder.file_name().map(ToOwned::to_owned).or_else(|| Some(folder.canonicalize().ok()?.file_name()?.to_owned()));
    let name = named.map_or_else(|| "scenario".to_owned(), |name| name.to_string_lossy().into_owned());
    let source = SourceText::new(folder.join(SCENARIO).display().to_string(), text);
    Ok(kinds.read_scenario(&name, &source, inputs)?)
}
