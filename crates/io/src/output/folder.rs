//! The folder of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::claim::{Claim, Stands};
use super::comparison::{DOCUMENT, PAGE};
use super::disk::{Disk, SystemDisk};
use super::earlier::Left;
use super::error::{Action, OutputError};
use super::journal::{self, JOURNAL};
use super::staging::Staging;
use super::{earlier, growing};
use crate::scenario::inputs::INPUTS;
use crate::scenario::run_folder::MANIFEST;

/// The file whose presence says that a folder is complete: it is taken away first and gets its name last.
pub(super) const SEAL: &str = "summary.json";
/// That of a run which gives its files their names.
pub(super) const NEW_SEAL: &str = ".summary.json.partial";
/// That of the run which it replaces, until it has.
pub(super) const OLD_SEAL: &str = ".summary.json.replaced";

/// Every file that a run may write, but for the copies of its inputs.
pub(crate) const FILES: [&str; 14] = [
    "scenario.toml",
    MANIFEST,
    "trajectory.parquet",
    "trajectory.csv",
    "packets.csv",
    "phases.csv",
    "holds.csv",
    "shapes.json",
    "report.html",
    "plots/positions.svg",
    "plots/torques.svg",
    "plots/estimates.svg",
    "plots/disagreement.svg",
    SEAL,
];

/// A folder that is there, can be written to, and holds nothing that must be kept under the names of a run's files.
///
/// As long as this lives, no other run gets the folder. Folders that were made for it and are still empty when it is
/// dropped vanish.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Folders that were made, innermost first.
    made: Vec<PathBuf>,
    claim: Claim,
    disk: Arc<dyn Disk>,
}

impl RunFolder {
    /// Prepares `path` for a run, before the run, so that hours of work are not lost to a folder that cannot be written.
    ///
    /// Missing folders are created, parents too. A folder that holds anything is refused unless `force`; then one that
    /// a run wrote is taken, unless its scenario or a table was changed since. What that run wrote will be replaced, and everything
    /// else stays as it is. Remains of a writer that was killed do not count.
    ///
    /// # Errors
    /// [`OutputError`] when the folder is not empty or must be kept, is a file, is being written by another run, or cannot be created or
    /// written to.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<RunFolder, OutputError> {
        RunFolder::create_on(Arc::new(SystemDisk), path, force)
    }

    /// The same; what is written goes through `disk`.
    ///
    /// # Errors
    /// As of [`RunFolder::create`].
    pub fn create_on(disk: Arc<dyn Disk>, path: impl Into<PathBuf>, force: bool) -> Result<RunFolder, OutputError> {
        RunFolder::create_unless(disk, path.into(), force, earlier::may_be_replaced)
    }

    /// The same for a comparison of runs, whose own folders may lie in it; with `force` one of an earlier comparison is taken.
    ///
    /// # Errors
    /// As of [`RunFolder::create`].
    pub fn create_for_comparison(path: impl Into<PathBuf>, force: bool) -> Result<RunFolder, OutputError> {
        RunFolder::create_unless(Arc::new(SystemDisk), path.into(), force, earlier::is_comparison)
    }

    fn create_unless(
        disk: Arc<dyn Disk>,
        path: PathBuf,
        force: bool,
        may_be_replaced: fn(&Path) -> Result<(), OutputError>,
    ) -> Result<RunFolder, OutputError> {
        let mut folder = RunFolder { path, made: Vec::new(), claim: Claim::none(), disk };
        let path = &folder.path;
        match fs::metadata(path) {
            Ok(meta) if !meta.is_dir() => return Err(OutputError::NotAFolder { path: path.clone() }),
            Ok(_) => {}
            // A link to nowhere.
            Err(_) if fs::symlink_metadata(path).is_ok() => return Err(OutputError::NotAFolder { path: path.clone() }),
            Err(_) => {
                folder.made = missing_folders(path);
                fs::create_dir_all(path).map_err(io_error(Action::CreateFolder, path))?;
            }
        }
        folder.claim = Claim::of(path)?;
        let is_empty = is_empty(path, false)?;
        if !is_empty && !force {
            let replaceable = may_be_replaced(path).is_ok();
            // A run that ended keeps what its tables have not beside them.
            let cut_off = !path.join(SEAL).exists() && journal::head(&path.join(JOURNAL)).is_some();
            return Err(OutputError::FolderNotEmpty { path: path.clone(), replaceable, cut_off });
        }
        in_the_way(path, FILES.into_iter().chain([JOURNAL, PAGE, DOCUMENT]))?;
        if !is_empty {
            may_be_replaced(path)?;
        }
        folder.probe()?;
        Ok(folder)
    }

    /// Prepares a folder that is there for files that are written anew.
    ///
    /// # Errors
    /// [`OutputError`] when it is no folder, is being written by a run, or cannot be written to.
    pub fn open(path: impl Into<PathBuf>) -> Result<RunFolder, OutputError> {
        let path = path.into();
        if !path.is_dir() {
            return Err(OutputError::NotAFolder { path });
        }
        let folder = RunFolder { claim: Claim::of(&path)?, path, made: Vec::new(), disk: Arc::new(SystemDisk) };
        in_the_way(
            &folder.path,
            FILES.into_iter().filter(|name| name.starts_with("plots/") || *name == "report.html"),
        )?;
        folder.probe()?;
        Ok(folder)
    }

    /// Finds out whether files can be written.
    fn probe(&self) -> Result<(), OutputError> {
        let probe = self.path.join(".forwardstep.partial");
        let _ = self.disk.remove_file(&probe); // of a writer that was killed
        self.disk.create_file(&probe).map_err(io_error(Action::WriteInto, &self.path))?;
        self.disk.remove_file(&probe).map_err(io_error(Action::WriteInto, &self.path))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where a run that writes into `path` keeps its rows until it has ended.
    pub fn journal_in(path: &Path) -> PathBuf {
        path.join(JOURNAL)
    }

    pub(super) fn disk(&self) -> &dyn Disk {
        &*self.disk
    }

    /// Whether a run writes into `path` now; nothing where the system cannot tell.
    pub fn is_in_use(path: &Path) -> Option<bool> {
        Claim::is_taken(path)
    }

    /// Whether its path leads to another folder by now. Nothing may be written or removed there: it may be that of another run.
    pub fn is_elsewhere(&self) -> bool {
        self.claim.stands(&self.path) == Stands::Elsewhere
    }

    /// Refuses when its path leads to another folder by now. One that was taken away altogether is made anew: who tidies up during a run
    /// of hours must not lose it.
    pub(super) fn ready(&self) -> Result<(), OutputError> {
        match self.claim.stands(&self.path) {
            Stands::Here => Ok(()),
            Stands::Elsewhere => Err(OutputError::Elsewhere { path: self.path.clone(), now: self.claim.now() }),
            Stands::Gone => {
                self.disk.create_folders(&self.path).map_err(io_error(Action::CreateFolder, &self.path))?;
                self.claim.renew(&self.path)
            }
        }
    }

    /// Starts to write files into it.
    pub(crate) fn stage(&self) -> Staging<'_> {
        Staging::new(self, None)
    }

    /// Starts to write all files of a run, in the place of those of an earlier one.
    pub(crate) fn stage_run(&self) -> Staging<'_> {
        // Before the seal that tells of them is written anew.
        Staging::new(self, Some(Left::of(&self.path)))
    }

    /// Removes the folders between this one and a file of it that are empty.
    pub(super) fn remove_empty_above(&self, name: &str) {
        for above in Path::new(name).ancestors().skip(1).filter(|above| !above.as_os_str().is_empty()) {
            let _ = fs::remove_dir(self.path.join(above)); // only succeeds when it is empty
        }
    }

    pub(super) fn partial(&self, name: &str) -> PathBuf {
        let (folder, file) = name.rsplit_once('/').map_or(("", name), |(folder, file)| (folder, file));
        self.path.join(folder).join(format!(".{file}.partial"))
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        // An empty folder under its name may be that of a run which has just begun.
        if self.is_elsewhere() {
            return;
        }
        for folder in &self.made {
            let _ = fs::remove_dir(folder); // only succeeds when it is empty
        }
    }
}

/// The folders on the way to `path` that do not exist yet, innermost first.
fn missing_folders(path: &Path) -> Vec<PathBuf> {
    let named = path.ancestors().filter(|folder| !folder.as_os_str().is_empty());
    named.take_while(|folder| !folder.exists()).map(Path::to_owned).collect()
}

/// Nothing but leftovers under temporary names, and the folders for plots and inputs if they hold nothing else either. Inputs
/// may have any name, so among them whatever is named like a temporary file is one.
fn is_empty(path: &Path, among_inputs: bool) -> Result<bool, OutputError> {
    let entries = fs::read_dir(path).map_err(io_error(Action::ReadFolder, path))?;
    for entry in entries {
        let entry = entry.map_err(io_error(Action::ReadFolder, path))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let holds_inputs = among_inputs || name == INPUTS;
        if (name == "plots" || holds_inputs) && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            if !is_empty(&entry.path(), holds_inputs)? {
                return Ok(false);
            }
            continue;
        }
        let is_leftover = name == ".forwardstep.partial"
            || name == OLD_SEAL
            || name == format!(".{JOURNAL}.partial")
            || growing::is_partial(&name)
            || [PAGE, DOCUMENT].iter().any(|file| name == format!(".{file}.partial"))
            || FILES.iter().filter_map(|f| f.rsplit('/').next()).any(|f| name == format!(".{f}.partial"))
            || among_inputs && name.starts_with('.') && name.ends_with(".partial");
        if !is_leftover {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Refuses where something stands under the names of files that no file can take the place of, so that the run does not fail at its end:
/// folders, and files where a folder has to be.
fn in_the_way<'n>(path: &Path, names: impl Iterator<Item = &'n str>) -> Result<(), OutputError> {
    let way = |path: PathBuf, found: &'static str| Err(OutputError::InTheWay { path, found });
    for name in names {
        let (above, file) = name.rsplit_once('/').map_or(("", name), |(above, file)| (above, file));
        unlinked(path, name)?;
        let above = path.join(above);
        if above.metadata().map_or_else(|_| above.is_symlink(), |found| !found.is_dir()) {
            return way(above, "no folder");
        }
        for name in [file.to_owned(), format!(".{file}.partial")] {
            let file = above.join(name);
            // The file takes the place of a link, not of what that leads to.
            if file.symlink_metadata().is_ok_and(|found| found.is_dir()) {
                return way(file, "a folder");
            }
        }
    }
    Ok(())
}

/// Refuses where a folder on the way to a file of a run is a link: what it leads to is not the run's.
pub(super) fn unlinked(path: &Path, name: &str) -> Result<(), OutputError> {
    let above = Path::new(name).ancestors().skip(1).filter(|above| !above.as_os_str().is_empty());
    match above.map(|above| path.join(above)).find(|above| above.is_symlink()) {
        Some(path) => Err(OutputError::InTheWay { path, found: "a link to another folder" }),
        None => Ok(()),
    }
}

pub(super) fn io_error(action: Action, path: &Path) -> impl FnOnce(io::Error) -> OutputError {
    let path = path.to_owned();
    move |source| OutputError::Io { action, path, source }
}
