//! `forwardstep report --follow`

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use forwardstep::io::output::{RunFolder, SavedRun};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shown;
use forwardstep::sim::Ending;

use super::promise::{Promise, promise};
use super::report::finish;
use super::run::refused;
use super::stop::Stop;
use crate::console::{Console, complain, remark};
use crate::status::Status;

/// As often a run writes its journal.
const EVERY: Duration = Duration::from_secs(1);
/// Reading and drawing take this share of the time at most, one in so many.
const SHARE: u32 = 4;
/// Where the system cannot tell whether a run writes, one whose journal has not grown for so long has ended.
const PATIENCE: Duration = Duration::from_secs(60);
/// Files may vanish and be replaced between two looks at them, but not so many times.
const MOST_FAILURES: u32 = 10;

/// Writes the page of a run anew while it goes on, and all that `report` writes when it has ended.
pub(crate) fn follow(folder: &Path, out: Option<&Path>, kinds: &Kinds, console: &mut Console) -> Status {
    watch(folder, out, kinds, console).unwrap_or_else(|status| status)
}

fn watch(folder: &Path, out: Option<&Path>, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let stop = Stop::listen();
    let elsewhere = out.map(|out| RunFolder::create(out, false)).transpose().map_err(refused)?;
    let mut journal = Growth::new(folder);
    let mut drawn = Drawn::default();
    while journal.goes_on() {
        let began = Instant::now();
        drawn.draw(folder, out.unwrap_or(folder), kinds, console)?;
        let pause = EVERY.max((SHARE - 1) * began.elapsed());
        while began.elapsed() < pause {
            if let Some(status) = stop.asked() {
                return Ok(status);
            }
            sleep(EVERY / 20);
        }
    }
    finish(folder, elsewhere.map(|elsewhere| move || Ok(elsewhere)), kinds, console)
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
        let length = self.folder.join("rows.journal").metadata().ok().map(|about| about.len());
        if length != self.length {
            (self.length, self.grew) = (length, Instant::now());
        }
        let grows = || length.is_some() && self.grew.elapsed() < PATIENCE;
        self.folder.is_dir() && RunFolder::is_in_use(self.folder).unwrap_or_else(grows)
    }
}

/// What was drawn so far.
#[derive(Default)]
struct Drawn {
    /// Of the setup that the run has, which does not change.
    promise: Option<Promise>,
    rows: usize,
    failures: u32,
}

impl Drawn {
    /// Draws the page, if there are rows that it does not show.
    fn draw(&mut self, folder: &Path, into: &Path, kinds: &Kinds, console: &mut Console) -> Result<(), Status> {
        let run = match SavedRun::look_with(folder, kinds) {
            Ok(run) if matches!(run.unfinished(), Some(Ending::CutOff { .. })) => run,
            // The first second is not over, or the tables are being written.
            Ok(_) => return Ok(()),
            Err(_) if !folder.join("rows.journal").exists() => return Ok(()),
            Err(_) if self.failures < MOST_FAILURES => {
                self.failures += 1;
                return Ok(());
            }
            Err(error) => return Err(complain(&error)),
        };
        self.failures = 0;
        let promise = self.promise.get_or_insert_with(|| promise(run.setup()));
        let remarks = run.remarks(&promise.report, env!("CARGO_PKG_VERSION"));
        let record = run.record(&promise.report, promise.value().map(<[f64]>::to_vec), &remarks);
        let rows = record.outcome.recording.t_s.len();
        if rows <= self.rows {
            return Ok(());
        }
        let page = run.write_growing_page(into, &record).map_err(refused)?;
        if self.rows == 0 {
            console.line(shown(&page));
            remark("The run goes on, and this page grows until it has ended; Ctrl-C leaves it as it is.");
        }
        self.rows = rows;
        Ok(())
    }
}
