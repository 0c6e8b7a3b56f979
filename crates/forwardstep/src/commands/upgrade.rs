//! `forwardstep upgrade`

use std::fs;
use std::path::Path;

use forwardstep::io::scenario::{open_text, upgrade as converted};
use forwardstep::io::shown;
use thiserror::Error;

use super::replace;
use crate::arguments::UpgradeOptions;
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// Why a file was not converted.
#[derive(Debug, Error)]
enum UpgradeError {
    #[error("`{option}` is for one file, but several are to be converted")]
    OneFile {
        /// What was asked for.
        option: &'static str,
    },
}

fn refused(error: UpgradeError) -> Status {
    complain(&Plain::new(error))
}

/// Converts files to the format that is read now, each by itself.
pub(crate) fn upgrade(options: &UpgradeOptions, console: &mut Console) -> Status {
    let of_one = [(options.out.is_some(), "--out"), (options.stdout, "--stdout")];
    if let Some((_, option)) = of_one.into_iter().find(|(is_asked, _)| *is_asked && options.files.len() > 1) {
        return refused(UpgradeError::OneFile { option });
    }
    let failed = options.files.iter().filter_map(|file| one(file, options, console).err());
    failed.fold(Status::Fine, |_, status| status)
}

fn one(path: &Path, options: &UpgradeOptions, console: &mut Console) -> Result<(), Status> {
    // What is clearly no scenario, such as a key, is not quoted.
    let source = open_text(path).map_err(|error| complain(&error))?;
    let upgraded = converted(&source).map_err(|error| complain(&error))?;
    let to = match &options.out {
        _ if options.stdout => None,
        Some(out) => Some(out.as_path()),
        None if upgraded.moved.is_empty() => None,
        None => Some(path),
    };
    if let Some(to) = to {
        // What is there under another name than that of the file itself is somebody's.
        let is_itself = |_| fs::canonicalize(to).ok() == fs::canonicalize(path).ok();
        replace::may_replace(to, is_itself).map_err(|refused| complain(&refused))?;
        replace::write(to, &upgraded.text).map_err(|refused| complain(&refused))?;
    }
    let mut say = |line: String| if options.stdout { remark(line) } else { console.line(line) };
    if upgraded.moved.is_empty() {
        say(format!("{} is of the present format", shown(path)));
    }
    for moved in &upgraded.moved {
        say(format!("{}:{}: {} → {}", shown(path), moved.line, moved.from, moved.to));
    }
    if options.stdout {
        console.file(&upgraded.text);
    }
    Ok(())
}
