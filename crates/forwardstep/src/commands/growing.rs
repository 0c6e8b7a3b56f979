//! The page of a run that goes on, again and again: by the run itself (`run --follow`), or by who follows it (`report --follow`).
//!
//! Either reads the journal as anybody could, so that what is drawn changes nothing of what is computed. The longer that takes,
//! the longer it waits.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use forwardstep::io::output::{OutputError, RestoreError, RunFolder, SavedRun};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::Ending;

use super::promise::{Promise, promise};
use crate::console::remark;

/// As often a run writes its journal.
const EVERY: Duration = Duration::from_secs(1);
/// A run draws its own page for one part in so many of its time.
const OWN_SHARE: u32 = 25;
/// Files may vanish and be replaced between two looks at them, but not so many times.
const MOST_FAILURES: u32 = 10;

/// Where pages are written.
pub(super) enum Place<'p> {
    /// Whoever else writes there.
    Folder(&'p Path),
    /// By the run that has it.
    Own(&'p RunFolder),
}

/// Why there is no page.
pub(super) enum Failure {
    /// What the run left cannot be read.
    Unreadable(RestoreError),
    /// The page cannot be written.
    Unwritten(OutputError),
}

/// The pages of one run.
pub(super) struct Pages<'p> {
    folder: &'p Path,
    into: Place<'p>,
    kinds: &'p Kinds,
    /// Of the setup that the run has, which does not change.
    given: Option<&'p Promise>,
    own: Option<Promise>,
    share: u32,
    /// How long the last look at the run took.
    took: Duration,
    journal_bytes: u64,
    rows: usize,
    failures: u32,
}

impl<'p> Pages<'p> {
    /// Pages of the run in `folder`, which take one part in `share` of the time.
    pub(super) fn new(
        folder: &'p Path,
        into: Place<'p>,
        kinds: &'p Kinds,
        given: Option<&'p Promise>,
        share: u32,
    ) -> Self {
        Pages {
            folder,
            into,
            kinds,
            given,
            own: None,
            share,
            took: Duration::ZERO,
            journal_bytes: 0,
            rows: 0,
            failures: 0,
        }
    }

    /// How long to wait for the next.
    pub(super) fn pause(&self) -> Duration {
        EVERY.max((self.share - 1) * self.took)
    }

    /// Draws the page, if there are rows that the last one does not show; where it is then.
    pub(super) fn draw(&mut self) -> Result<Option<PathBuf>, Failure> {
        let began = Instant::now();
        let page = self.draw_newer();
        self.took = began.elapsed();
        page
    }

    fn draw_newer(&mut self) -> Result<Option<PathBuf>, Failure> {
        let journal = RunFolder::journal_in(self.folder);
        let journal_bytes = journal.metadata().map_or(0, |about| about.len());
        if journal_bytes == self.journal_bytes {
            return Ok(None);
        }
        let run = match SavedRun::look_with(self.folder, self.kinds) {
            Ok(run) if matches!(run.unfinished(), Some(Ending::CutOff { .. })) => run,
            // The first second is not over, or the tables are being written.
            Ok(_) => return Ok(None),
            Err(_) if !journal.exists() => return Ok(None),
            Err(_) if self.failures < MOST_FAILURES => {
                self.failures += 1;
                return Ok(None);
            }
            Err(error) => return Err(Failure::Unreadable(error)),
        };
        (self.failures, self.journal_bytes) = (0, journal_bytes);
        let again = self.pause();
        let promise = match self.given {
            Some(promise) => promise,
            None => self.own.get_or_insert_with(|| promise(run.setup())),
        };
        let record = promise.record(&run, &promise.remarks(&run));
        let rows = record.outcome.recording.t_s.len();
        if rows <= self.rows {
            return Ok(None);
        }
        self.rows = rows;
        let page = match self.into {
            Place::Folder(folder) => run.write_growing_page(folder, &record, again),
            Place::Own(folder) => run.write_own_growing_page(folder, &record, again),
        };
        page.map(Some).map_err(Failure::Unwritten)
    }
}

/// Does the `work` of the run in `folder`, and draws its page beside that if it is to be followed. The last page is whole, and no other
/// comes, when this returns.
pub(super) fn followed<T>(
    follow: bool,
    folder: &RunFolder,
    kinds: &Kinds,
    promise: &Promise,
    work: impl FnOnce() -> T,
) -> T {
    if !follow {
        return work();
    }
    let (done, failure) = thread::scope(|scope| {
        let (ends, ended) = channel();
        let pages = Pages::new(folder.path(), Place::Own(folder), kinds, Some(promise), OWN_SHARE);
        let drawing = thread::Builder::new().spawn_scoped(scope, move || draw_until(pages, &ended));
        let done = work();
        drop(ends);
        let failure = match drawing {
            Ok(drawing) => drawing.join().ok().and_then(Result::err).map(|failure| match failure {
                Failure::Unreadable(error) => error.to_string(),
                Failure::Unwritten(error) => error.to_string(),
            }),
            Err(error) => Some(error.to_string()),
        };
        (done, failure)
    });
    if let Some(why) = failure {
        remark(format_args!("The page did not grow any more while the run went on: {why}"));
    }
    done
}

/// Draws pages until the other end is dropped, or one fails.
fn draw_until(mut pages: Pages<'_>, ended: &Receiver<()>) -> Result<(), Failure> {
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(pages.pause()) {
        pages.draw()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longer_a_page_takes_the_longer_it_waits() {
        let kinds = Kinds::shipped();
        let mut pages = Pages::new(Path::new("run"), Place::Folder(Path::new("run")), &kinds, None, OWN_SHARE);
        assert_eq!(pages.pause(), EVERY);
        for took_s in [0.01, 0.5, 30.0] {
            pages.took = Duration::from_secs_f64(took_s);
            let share = took_s / (pages.took + pages.pause()).as_secs_f64();
            assert!(share < 0.05 && pages.pause() >= EVERY, "{share}");
        }
    }
}
