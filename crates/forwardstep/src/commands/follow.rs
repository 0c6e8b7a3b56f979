//! `forwardstep report --follow`

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use forwardstep::io::output::RunFolder;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shown;

use super::growing::{Failure, Pages, Place};
use super::report::{elsewhere, finish};
use super::run::refused;
use super::stop::Stop;
use crate::console::{Console, complain, remark};
use crate::status::Status;

/// Reading and drawing take this share of the time at most, one in so many.
const SHARE: u32 = 4;
/// A run locks its folder within this time of creating it.
const FIRST: Duration = Duration::from_secs(2);
/// Where the system cannot tell whether a run writes, one whose journal has not grown for so long has ended.
const PATIENCE: Duration = Duration::from_secs(60);
/// Whoever asks it to stop does not wait for long.
const TICK: Duration = Duration::from_millis(50);

/// Writes the page of a run anew while it goes on, and all that `report` writes when it has ended.
pub(crate) fn follow(
    folder: &Path,
    out: Option<&Path>,
    kinds: &Kinds,
    console: &mut Console,
) -> Result<Status, Status> {
    let stop = Stop::listen();
    let into = out.map(elsewhere).transpose().map_err(refused)?;
    let mut journal = Growth::new(folder);
    let mut pages = Pages::new(folder, Place::Folder(out.unwrap_or(folder)), kinds, None, SHARE);
    let mut told = false;
    while journal.goes_on() {
        let page = pages.draw().map_err(|failure| match failure {
            Failure::Unreadable(error) => complain(&error),
            Failure::Unwritten(error) => refused(error),
        })?;
        if let Some(page) = page.filter(|_| !told) {
            console.whole(shown(&page));
            remark("The run goes on, and this page grows until it has ended; Ctrl-C leaves it as it is.");
            told = true;
        }
        let waits = Instant::now();
        while waits.elapsed() < pages.pause() {
            if let Some(status) = stop.asked() {
                return Ok(status);
            }
            sleep(TICK);
        }
    }
    finish(folder, into.map(|into| move || Ok(into)), kinds, console)
}

/// Whether a run goes on.
struct Growth<'f> {
    folder: &'f Path,
    length: Option<u64>,
    grew: Instant,
}

impl<'f> Growth<'f> {
    fn new(folder: &'f Path) -> Self {
        Growth { folder, length: None, grew: Instant::now() }
    }

    fn goes_on(&mut self) -> bool {
        let length = RunFolder::journal_in(self.folder).metadata().ok().map(|about| about.len());
        if length != self.length {
            (self.length, self.grew) = (length, Instant::now());
        }
        let grows = || length.is_some() && self.grew.elapsed() < PATIENCE;
        self.folder.is_dir() && (RunFolder::is_in_use(self.folder).unwrap_or_else(grows) || self.begins())
    }

    /// Whether the folder may be that of a run which has just made it, and has not claimed it yet.
    fn begins(&self) -> bool {
        let is_empty = || self.folder.read_dir().is_ok_and(|mut entries| entries.next().is_none());
        self.grew.elapsed() < FIRST && is_empty()
    }
}
