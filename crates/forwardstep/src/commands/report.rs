//! `forwardstep report`

use std::path::Path;

use forwardstep::io::output::{OutputError, RunFolder, SavedRun, ending_sentence};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shown;

use super::promise::promise;
use super::run::refused;
use crate::console::{Console, complain, remark};
use crate::status::Status;

/// Builds the report and the plots of a run anew from its tables, or all of it elsewhere.
pub(crate) fn report(
    folder: &Path,
    out: Option<&Path>,
    kinds: &Kinds,
    console: &mut Console,
) -> Result<Status, Status> {
    finish(folder, out.map(|out| move || elsewhere(out)), kinds, console)
}

/// Another folder for all that is written of a run. Nothing replaces what it holds, so that no `--force` is offered.
pub(super) fn elsewhere(out: &Path) -> Result<RunFolder, OutputError> {
    match RunFolder::create(out, false) {
        Err(OutputError::FolderNotEmpty { path, .. }) => {
            Err(OutputError::FolderNotEmpty { path, replaceable: false, cut_off: false })
        }
        made => made,
    }
}

/// The same into the folder that `into` prepares, if there is one, when the run was read.
pub(super) fn finish(
    folder: &Path,
    into: Option<impl FnOnce() -> Result<RunFolder, OutputError>>,
    kinds: &Kinds,
    console: &mut Console,
) -> Result<Status, Status> {
    let run = match into {
        Some(_) => SavedRun::look_with(folder, kinds),
        None => SavedRun::open_with(folder, kinds),
    }
    .map_err(|error| complain(&error))?;
    if let Some(ending) = run.unfinished().filter(|_| !run.goes_on()) {
        remark(ending_sentence(run.setup(), ending));
    }
    let promise = promise(run.setup());
    let remarks = promise.remarks(&run);
    for sentence in &remarks {
        remark(format_args!("note: {sentence}"));
    }
    let record = promise.record(&run, &remarks);
    let files = match into {
        Some(into) => into().and_then(|elsewhere| run.write_into(&elsewhere, &record)),
        None => run.write_report(&record),
    }
    .map_err(refused)?;
    for file in files {
        console.whole(shown(&file));
    }
    Ok(Status::Fine)
}
