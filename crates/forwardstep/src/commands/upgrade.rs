//! `forwardstep upgrade`

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

use forwardstep::io::scenario::{open_text, upgrade as converted};
use forwardstep::io::shown;
use thiserror::Error;

use crate::arguments::UpgradeOptions;
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// Why a file was not converted.
#[derive(Debug, Error)]
enum UpgradeError {
    #[error("`--out` names one file, but several are to be converted")]
    OneFile,
    #[error("cannot read `{}`: {reason}", shown(path))]
    Read { path: PathBuf, reason: std::io::Error },
    #[error("cannot write `{}`: {reason}", shown(path))]
    Write { path: PathBuf, reason: std::io::Error },
}

fn refused(error: UpgradeError) -> Status {
    complain(&Plain::new(error))
}

/// Converts files to the format that is read now, each by itself.
pub(crate) fn upgrade(options: &UpgradeOptions, console: &mut Console) -> Status {
    if options.out.is_some() && options.files.len() > 1 {
        return refused(UpgradeError::OneFile);
    }
    let failed = options.files.iter().filter_map(|file| one(file, options, console).err());
    failed.fold(Status::Fine, |_, status| status)
}

fn one(path: &Path, options: &UpgradeOptions, console: &mut Console) -> Result<(), Status> {
    let unread = |reason| refused(UpgradeError::Read { path: path.to_owned(), reason });
    // What is clearly no scenario, such as a key, is not quoted.
    let source = open_text(path).map_err(|error| complain(&error))?;
    let upgraded = converted(&source).map_err(|error| complain(&error))?;
    let to = match &options.out {
        _ if options.stdout => None,
        Some(out) => Some(out.clone()),
        None if upgraded.moved.is_empty() => None,
        // The file itself, not a link to it.
        None => Some(fs::canonicalize(path).map_err(unread)?),
    };
    if let Some(to) = to {
        replace(&to, &upgraded.text).map_err(|reason| refused(UpgradeError::Write { path: to, reason }))?;
    }
    let mut say = |line: String| if options.stdout { remark(line) } else { console.line(line) };
    if upgraded.moved.is_empty() {
        say(format!("{} is of the present format", shown(path)));
    }
    for moved in &upgraded.moved {
        say(format!("{}:{}: {} → {}", shown(path), moved.line, moved.from, moved.to));
    }
    if options.stdout {
        console.verbatim(upgraded.text);
    }
    Ok(())
}

/// Puts `text` in place of the file at `path`, whole or not at all.
fn replace(path: &Path, text: &str) -> std::io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let partial = path.with_file_name(format!(".{name}.partial"));
    let written = File::create(&partial).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        if let Ok(before) = fs::metadata(path) {
            file.set_permissions(before.permissions())?;
        }
        file.sync_all()
    });
    let replaced = written.and_then(|()| fs::rename(&partial, path));
    if replaced.is_err() {
        drop(fs::remove_file(&partial));
    }
    replaced
}
