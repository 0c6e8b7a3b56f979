//! Files under temporary names, which get their own when all of them are complete.

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

use super::disk::DiskFile;
use super::earlier::{Known, Left};
use super::error::{Action, EncodeError, OutputError};
use super::folder::{OLD_SEAL, RunFolder, SEAL, io_error, unlinked};
use super::journal::JOURNAL;

/// Files written under temporary names; those that were not [published](Staging::publish) vanish when this is dropped.
pub(crate) struct Staging<'f> {
    folder: &'f RunFolder,
    names: Vec<String>,
    /// What was written under them.
    written: Vec<Written>,
    /// By what the files are known that will be replaced.
    left: Option<Left>,
    /// Whether the seal of an earlier run is gone. If files do not all get their names then, the new seal under its temporary name says that what
    /// stands there is a run's.
    seal_removed: bool,
}

impl<'f> Staging<'f> {
    pub(super) fn new(folder: &'f RunFolder, left: Option<Left>) -> Self {
        Staging { folder, names: Vec::new(), written: Vec::new(), left, seal_removed: false }
    }

    /// Writes one file under its temporary name, to the disk.
    pub(crate) fn write(
        &mut self,
        name: &str,
        fill: impl FnOnce(&mut StagedFile) -> Result<(), FillError>,
    ) -> Result<Written, OutputError> {
        self.folder.ready()?;
        let (disk, path) = (self.folder.disk(), self.folder.path().join(name));
        unlinked(self.folder.path(), name)?;
        let partial = self.folder.partial(name);
        if let Some(parent) = partial.parent() {
            disk.create_folders(parent).map_err(io_error(Action::CreateFolder, parent))?;
        }
        let _ = disk.remove_file(&partial); // of a writer that was killed
        let file = disk.create_file(&partial).map_err(io_error(Action::CreateFile, &path))?;
        self.names.push(name.to_owned());
        let mut staged = StagedFile::new(file);
        let filled = fill(&mut staged).and_then(|()| staged.finish().map_err(FillError::Io));
        let failed = |error| match (staged.failure.take(), error) {
            (Some(source), _) | (None, FillError::Io(source)) => {
                OutputError::Io { action: Action::WriteFile, path, source }
            }
            (None, FillError::Encode(reason)) => OutputError::Encode { path, reason },
        };
        match filled {
            Ok(()) => {
                let written = Written { digest: staged.digest.finalize(), bytes: staged.digest.count() };
                self.written.push(written);
                Ok(written)
            }
            Err(error) => Err(failed(error)),
        }
    }

    /// Writes a text.
    pub(crate) fn write_text(&mut self, name: &str, text: &str) -> Result<Written, OutputError> {
        self.write(name, |out| Ok(out.write_all(text.as_bytes())?))
    }

    /// Gives all files their names, the seal last, and removes those of an earlier run that this one did not write; where somebody else's is in
    /// the way, nothing is changed. The journal goes when all of them would survive a power cut, unless it `keeps` something that they have not.
    pub(crate) fn publish(mut self, keeps: bool) -> Result<Vec<PathBuf>, OutputError> {
        let folder = self.folder;
        folder.ready()?;
        let left = self.left.take().unwrap_or_default();
        let earlier = left.names();
        for name in &earlier {
            unlinked(folder.path(), name)?;
        }
        self.refuse_foreign_files(&left, &earlier)?;
        let disk = folder.disk();
        let remove = |name: &str| {
            let path = folder.path().join(name);
            match disk.remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    Err(io_error(Action::RemoveFile, &path)(error))
                }
                _ => Ok(()),
            }
        };
        let [seal, old_seal] = [SEAL, OLD_SEAL].map(|name| folder.path().join(name));
        if seal.symlink_metadata().is_ok() {
            disk.rename(&seal, &old_seal).map_err(io_error(Action::RenameFile, &seal))?;
        }
        self.seal_removed = true;
        let is_old = |name: &&String| *name != JOURNAL && !self.names.contains(name);
        for name in earlier.iter().filter(is_old) {
            remove(name)?;
            let _ = disk.remove_file(&folder.partial(name)); // of a writer that was killed
            folder.remove_empty_above(name);
        }
        let published = self.name_all()?;
        // Where they stay, readers see by the seal that it is over.
        let _ = disk.remove_file(&old_seal);
        if !keeps && folder.path().join(JOURNAL).exists() {
            let synced = disk.sync_folder(folder.path());
            let _ = synced.and_then(|()| disk.remove_file(&folder.path().join(JOURNAL)));
        }
        Ok(published)
    }

    /// Refuses where a file would be lost that neither an earlier run wrote nor this one writes as it is.
    fn refuse_foreign_files(&self, left: &Left, earlier: &[String]) -> Result<(), OutputError> {
        let path = self.folder.path();
        let old = earlier.iter().filter(|name| *name != JOURNAL && !self.names.contains(name));
        old.map(String::as_str).try_for_each(|name| left.allows(path, name, None))?;
        self.names.iter().zip(&self.written).try_for_each(|(name, written)| {
            let digest = written.digest.to_hex();
            left.allows(path, name, Some(Known { digest_blake3: digest.as_str(), bytes: Some(written.bytes) }))
        })
    }

    /// Gives all files their names and leaves everything else in the folder as it is.
    pub(crate) fn replace(self) -> Result<Vec<PathBuf>, OutputError> {
        self.name_all()
    }

    fn name_all(self) -> Result<Vec<PathBuf>, OutputError> {
        let folder = self.folder;
        let mut published = Vec::new();
        let (seal, others): (Vec<_>, Vec<_>) = self.names.iter().partition(|name| *name == SEAL);
        for name in others.into_iter().chain(seal) {
            folder.ready()?;
            let path = folder.path().join(name);
            folder.disk().rename(&folder.partial(name), &path).map_err(io_error(Action::RenameFile, &path))?;
            published.push(path);
        }
        Ok(published)
    }
}

impl Drop for Staging<'_> {
    fn drop(&mut self) {
        if self.folder.is_elsewhere() {
            return;
        }
        for name in self.names.iter().filter(|name| !(self.seal_removed && *name == SEAL)) {
            let _ = self.folder.disk().remove_file(&self.folder.partial(name));
            self.folder.remove_empty_above(name);
        }
    }
}

/// What was written.
#[derive(Clone, Copy)]
pub(crate) struct Written {
    pub(crate) digest: blake3::Hash,
    pub(crate) bytes: u64,
}

/// Why a file could not be filled.
pub(crate) enum FillError {
    Io(io::Error),
    Encode(EncodeError),
}

impl From<io::Error> for FillError {
    fn from(error: io::Error) -> Self {
        FillError::Io(error)
    }
}

impl<E: Into<EncodeError>> From<E> for FillError {
    fn from(error: E) -> Self {
        FillError::Encode(error.into())
    }
}

/// A file under its temporary name, which remembers the system's refusal whatever an encoder makes of it.
pub(crate) struct StagedFile {
    file: BufWriter<Box<dyn DiskFile>>,
    failure: Option<io::Error>,
    /// Of what was written so far.
    digest: blake3::Hasher,
}

impl StagedFile {
    fn new(file: Box<dyn DiskFile>) -> Self {
        StagedFile { file: BufWriter::with_capacity(1 << 16, file), failure: None, digest: blake3::Hasher::new() }
    }

    fn finish(&mut self) -> io::Result<()> {
        self.flush()?;
        let synced = self.file.get_mut().sync();
        self.watch(synced)
    }

    fn watch<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result {
            let copy = match error.raw_os_error() {
                Some(code) => io::Error::from_raw_os_error(code),
                None => io::Error::new(error.kind(), error.to_string()),
            };
            self.failure.get_or_insert(copy);
        }
        result
    }
}

impl Write for StagedFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let result = self.file.write(buffer);
        if let Some(written) = result.as_ref().ok().and_then(|written| buffer.get(..*written)) {
            self.digest.update(written);
        }
        self.watch(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.file.flush();
        self.watch(result)
    }
}
