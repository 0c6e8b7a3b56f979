//! Files that a command writes where the user says: what somebody else wrote there is never lost.

use std::fs::{self, File};
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use forwardstep::io::output::digest;
use forwardstep::io::shown;

use crate::console::Plain;

/// What the last line of a scenario begins with that a command saved, before the digest of all above.
const DIGEST: &str = "# as saved: ";

/// A scenario that is to be saved, with a last line by which it is known again.
pub(super) fn with_digest(text: &str) -> String {
    format!("{text}{DIGEST}{}\n", digest(text))
}

/// Whether a file is as a command saved it, without an edit since.
pub(super) fn is_unedited(file: BufReader<File>) -> bool {
    const MOST_BYTES: u64 = 1 << 26;
    let mut text = String::new();
    file.take(MOST_BYTES).read_to_string(&mut text).is_ok()
        && text.rfind(DIGEST).is_some_and(|at| text == with_digest(&text[..at]))
}

/// Writes a file into a folder, which is made if it is not there, unless somebody else's stands there under that name.
pub(super) fn write_into(folder: &Path, name: &str, text: &str) -> Result<PathBuf, Plain<String>> {
    fs::create_dir_all(folder).map_err(|error| not_into(folder, &error))?;
    let path = folder.join(name);
    may_replace(&path, is_unedited)?;
    write(&path, &with_digest(text))?;
    Ok(path)
}

/// Checks that this folder is there and can be written to, or can be made. Asked before work that may have nothing to write.
pub(super) fn check_folder(path: &Path) -> Result<(), Plain<String>> {
    let from_here = Path::new(".").join(path);
    let Some(there) = from_here.ancestors().find(|above| above.symlink_metadata().is_ok()) else { return Ok(()) };
    let named = there.strip_prefix(".").ok().filter(|below| !below.as_os_str().is_empty()).unwrap_or(there);
    if !there.is_dir() {
        let said = format!("`{}` is no folder", shown(named));
        return Err(Plain::with_help(said, Some("name a folder, or one that is not there yet")));
    }
    // What a folder allows is known for certain by trying.
    let probe = there.join(format!(".forwardstep-{}", std::process::id()));
    File::create_new(&probe).and_then(|_| fs::remove_file(&probe)).map_err(|error| {
        let said = format!("`{}` cannot be written to: {error}", shown(named));
        Plain::with_help(said, Some("name another folder"))
    })
}

/// Checks that `path` can be written: nothing is there, or what `is_own` knows as written by this command before. Asked before the
/// work, so that none is lost.
pub(super) fn may_replace(path: &Path, is_own: impl Fn(BufReader<File>) -> bool) -> Result<(), Plain<String>> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        let (folder, path, exists) = (shown(folder), shown(path), folder.exists());
        let (said, help) = match exists {
            true => (format!("`{folder}` exists and is no folder to write `{path}` into"), "name a folder"),
            false => (format!("there is no folder `{folder}` to write `{path}` into"), "make it first"),
        };
        return Err(Plain::with_help(said, Some(help)));
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(Plain::with_help(format!("`{}` is a folder", shown(path)), Some("name a file in it")))
        }
        Ok(found) if found.is_file() && found.len() > 0 => {
            if File::open(path).is_ok_and(|file| is_own(BufReader::new(file))) {
                return Ok(());
            }
            let said = format!("`{}` already exists, and this command did not write it", shown(path));
            Err(Plain::with_help(said, Some("choose another name; the file would be overwritten")))
        }
        // What is written into a pipe waits for its reader.
        Ok(_) if is_unread(path) => Err(Plain::with_help(
            format!("`{}` is a pipe that no program reads", shown(path)),
            Some("start its reader first, or name a file"),
        )),
        // A terminal, a pipe, or nothing.
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            let partial = partial(path);
            File::create(&partial).and_then(|_| fs::remove_file(&partial)).map_err(|error| refused(path, &error))
        }
        Err(error) => Err(refused(path, &error)),
    }
}

#[cfg(unix)]
fn is_unread(path: &Path) -> bool {
    use rustix::fs::{Mode, OFlags, open};
    use std::os::unix::fs::FileTypeExt;

    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo())
        && open(path, flags, Mode::empty()).is_err_and(|error| error == rustix::io::Errno::NXIO)
}

#[cfg(not(unix))]
fn is_unread(_: &Path) -> bool {
    false
}

fn not_into(folder: &Path, error: &io::Error) -> Plain<String> {
    let help = match error.kind() {
        ErrorKind::ReadOnlyFilesystem | ErrorKind::PermissionDenied => Some("name a folder that you may write to"),
        ErrorKind::StorageFull => Some("make room, or name a folder on another disk"),
        _ => None,
    };
    Plain::with_help(format!("cannot write into `{}`: {error}", shown(folder)), help)
}

/// What to do where a file cannot be written.
pub(crate) fn help_for(kind: ErrorKind) -> Option<&'static str> {
    match kind {
        ErrorKind::ReadOnlyFilesystem | ErrorKind::PermissionDenied => {
            Some("name a file in a folder that you may write to")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Some("make room, or name a file on another disk"),
        ErrorKind::FileTooLarge => Some("raise the limit on the size of files (`ulimit -f`)"),
        _ => None,
    }
}

fn refused(path: &Path, error: &io::Error) -> Plain<String> {
    Plain::with_help(format!("cannot write `{}`: {error}", shown(path)), help_for(error.kind()))
}

/// Another name beside it, which no other program that runs now has.
fn partial(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.partial", std::process::id()))
}

/// Writes it, whole or not at all: what was there before stays where that fails.
pub(super) fn write(path: &Path, text: &str) -> Result<(), Plain<String>> {
    let written = match fs::metadata(path) {
        // A terminal or a pipe has no other name, and keeps nothing.
        Ok(found) if !found.is_file() => fs::write(path, text),
        // The file itself, not a link to it.
        Ok(found) => fs::canonicalize(path).and_then(|path| put(&path, text, Some(found.permissions()))),
        Err(_) => put(path, text, None),
    };
    written.map_err(|error| refused(path, &error))
}

/// Under another name first.
fn put(path: &Path, text: &str, permissions: Option<fs::Permissions>) -> io::Result<()> {
    let partial = partial(path);
    let written = File::create(&partial).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        permissions.map_or(Ok(()), |permissions| file.set_permissions(permissions))?;
        file.sync_all()
    });
    let replaced = written.and_then(|()| fs::rename(&partial, path));
    if replaced.is_err() {
        drop(fs::remove_file(&partial));
    }
    replaced
}
