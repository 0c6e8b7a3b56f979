//! The page of a run that goes on, written while the rest of its folder is.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::error::{Action, OutputError};
use super::folder::{RunFolder, io_error};
use super::journal::JOURNAL;
use super::record::RunRecord;
use super::restore::SavedRun;
use super::{metrics, report};

/// Its name.
pub(super) const PAGE: &str = "report.html";

/// Whether a file is what is left of a page whose writer was killed.
pub(super) fn is_partial(name: &str) -> bool {
    name.strip_prefix(".report.html.").and_then(|rest| rest.strip_suffix(".partial")).is_some()
}

impl SavedRun {
    /// Writes `report.html` into `folder`, which may be that of the run, as the page of a run that goes on: it says until when it shows
    /// the run, and a browser loads it `again` after about so long. Nothing else is written, and no claim is needed: the page appears when
    /// it is whole, and the run writes its own over it when it has ended.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried.
    pub fn write_growing_page(
        &self,
        folder: &Path,
        record: &RunRecord<'_>,
        again: Duration,
    ) -> Result<PathBuf, OutputError> {
        let page = report::page(record, &metrics(record), Some(again));
        let path = folder.join(PAGE);
        // The run has the usual temporary name, and several may follow it.
        let partial = folder.join(format!(".{PAGE}.{}.partial", std::process::id()));
        let written = fs::write(&partial, page).map_err(io_error(Action::WriteFile, &path)).and_then(|()| {
            // A run that has ended since wrote its own.
            let is_over = self.is_in(folder) && !folder.join(JOURNAL).exists();
            if is_over { Ok(()) } else { fs::rename(&partial, &path).map_err(io_error(Action::RenameFile, &path)) }
        });
        // Where it has its name, nothing is there any more.
        let _ = fs::remove_file(&partial);
        written.map(|()| path)
    }

    /// The same by the run itself, whose folder it is.
    ///
    /// # Errors
    /// [`OutputError`] with the file and what was tried.
    pub fn write_own_growing_page(
        &self,
        folder: &RunFolder,
        record: &RunRecord<'_>,
        again: Duration,
    ) -> Result<PathBuf, OutputError> {
        let mut staging = folder.stage();
        staging.write_text(PAGE, &report::page(record, &metrics(record), Some(again)))?;
        staging.replace()?;
        Ok(folder.path().join(PAGE))
    }
}
