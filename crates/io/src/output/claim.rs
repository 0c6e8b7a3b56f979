//! Who has the folder of a run: a lock on it, and whether its path still leads there.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use super::error::OutputError;

/// Between attempts to lock a folder.
const PAUSES: [Duration; 4] =
    [Duration::from_millis(2), Duration::from_millis(10), Duration::from_millis(40), Duration::from_millis(100)];

/// Where a folder is that was locked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stands {
    /// Where it was, as far as the system tells.
    Here,
    /// Under another name, if anywhere; nothing is where it was.
    Gone,
    /// Under another name, if anywhere; something else is where it was.
    Elsewhere,
}

/// A folder that no other run gets. A lock is on what was opened and not on its name: a folder that is renamed keeps it, and another may get
/// the name meanwhile.
#[derive(Debug)]
pub(super) struct Claim {
    /// Held open for its lock, which ends with the process at the latest.
    lock: Mutex<Option<File>>,
}

impl Claim {
    /// Of nothing yet.
    pub(super) fn none() -> Claim {
        Claim { lock: Mutex::new(None) }
    }

    /// Keeps other runs out of `path`. Who only looks whether a folder is in use has it for a moment, and so has who is ending: that is
    /// waited for.
    pub(super) fn of(path: &Path) -> Result<Claim, OutputError> {
        Ok(Claim { lock: Mutex::new(lock(path)?) })
    }

    /// Whether another has `path` now; nothing where the system cannot tell.
    pub(super) fn is_taken(path: &Path) -> Option<bool> {
        match try_lock(path) {
            Ok(lock) => lock.map(|_| false),
            Err(_) => Some(true),
        }
    }

    /// Takes the folder that was made where this one was.
    pub(super) fn renew(&self, path: &Path) -> Result<(), OutputError> {
        *self.held() = lock(path)?;
        Ok(())
    }

    /// Where the folder is that was at `path`.
    pub(super) fn stands(&self, path: &Path) -> Stands {
        let held = self.held();
        let Some(ours) = held.as_ref().and_then(|folder| folder.metadata().ok()) else { return Stands::Here };
        match fs::metadata(path) {
            Ok(found) if is_same(&ours, &found) => Stands::Here,
            Ok(_) => Stands::Elsewhere,
            // A link to nowhere is something.
            Err(error) if error.kind() == io::ErrorKind::NotFound && fs::symlink_metadata(path).is_err() => {
                Stands::Gone
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Stands::Elsewhere,
            // Whatever fails next says why.
            Err(_) => Stands::Here,
        }
    }

    /// What the folder is called now, where the system tells.
    pub(super) fn now(&self) -> Option<PathBuf> {
        self.held().as_ref().and_then(name_of)
    }

    fn held(&self) -> MutexGuard<'_, Option<File>> {
        // Nothing that is done with it leaves it half changed.
        self.lock.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(unix)]
fn is_same(one: &fs::Metadata, other: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// A folder that is held open cannot be renamed there.
#[cfg(not(unix))]
fn is_same(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    true
}

#[cfg(unix)]
fn name_of(folder: &File) -> Option<PathBuf> {
    use std::os::fd::AsRawFd;
    use std::os::unix::fs::MetadataExt;
    let name = fs::read_link(format!("/proc/self/fd/{}", folder.as_raw_fd())).ok()?;
    // What was removed has its old name with a remark.
    let is_there = folder.metadata().ok()?.nlink() > 0 && name.is_dir();
    is_there.then_some(name)
}

#[cfg(not(unix))]
fn name_of(_: &File) -> Option<PathBuf> {
    None
}

fn lock(path: &Path) -> Result<Option<File>, OutputError> {
    for pause in PAUSES {
        match try_lock(path) {
            Err(_) => thread::sleep(pause),
            locked => return locked,
        }
    }
    try_lock(path)
}

/// Systems and disks that cannot lock a folder go without.
fn try_lock(path: &Path) -> Result<Option<File>, OutputError> {
    let Ok(folder) = File::open(path) else { return Ok(None) };
    match folder.try_lock() {
        Ok(()) => Ok(Some(folder)),
        Err(TryLockError::WouldBlock) => Err(OutputError::FolderInUse { path: path.to_owned() }),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}
