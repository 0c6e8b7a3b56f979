//! `forwardstep report`

use std::path::Path;

use forwardstep::io::output::SavedRun;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shown;

use super::promise::promise;
use super::run::refused;
use crate::console::{Console, complain, remark};
use crate::status::Status;

/// Builds the report and the plots of a run anew from its tables.
pub(crate) fn report(folder: &Path, kinds: &Kinds, console: &mut Console) -> Status {
    finish(folder, kinds, console).unwrap_or_else(|status| status)
}

fn finish(folder: &Path, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let run = SavedRun::open_with(folder, kinds).map_err(|error| complain(&error))?;
    let promise = promise(run.setup());
    let remarks = run.remarks(&promise.report, env!("CARGO_PKG_VERSION"));
    for sentence in &remarks {
        remark(format_args!("note: {sentence}"));
    }
    let record = run.record(&promise.report, promise.value().map(<[f64]>::to_vec), &remarks);
    let files = run.write_report(&record).map_err(refused)?;
    for file in files {
        console.line(shown(&file));
    }
    Ok(Status::Fine)
}
