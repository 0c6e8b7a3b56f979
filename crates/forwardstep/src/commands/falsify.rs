//! `forwardstep falsify`

use forwardstep::io::shown;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use super::stop::Stop;
use crate::arguments::FalsifyOptions;
use crate::console::{BAD, Console, DIM, GOOD, Plain, complain};
use crate::falsify::{Case, Failure, Tally};
use crate::status::Status;

/// Cases that are listed.
const LISTED: usize = 20;

/// Draws scenarios and tries to refute what is claimed of them.
pub(crate) fn falsify(options: &FalsifyOptions, console: &mut Console) -> Status {
    let stop = Stop::listen();
    let started = Instant::now();
    let limit =
        options.seconds.map_or(Duration::MAX, |seconds| Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
    let (mut tally, mut saved) = (Tally::default(), 0);
    for number in options.from..options.from.saturating_add(options.cases) {
        if started.elapsed() >= limit || stop.asked().is_some() {
            break;
        }
        tally.add(Case::draw(options.seed, number));
        for (case, failure) in &tally.failed[saved..] {
            console.line(format_args!("{BAD}refuted{BAD:#}: case {}: {failure}", case.number));
            if let Err(status) = save(&options.out, case, failure, console) {
                return status;
            }
        }
        saved = tally.failed.len();
    }
    summary(&tally, options.seed, console);
    stop.asked().unwrap_or(if tally.failed.is_empty() { Status::Fine } else { Status::Missed })
}

fn save(folder: &Path, case: &Case, failure: &Failure, console: &mut Console) -> Result<(), Status> {
    let path = folder.join(format!("refuted-{}.toml", case.number));
    let written = fs::create_dir_all(folder).and_then(|()| fs::write(&path, format!("# {failure}\n{case}")));
    written.map_err(|error| complain(&Plain::new(error)))?;
    console.line(format_args!("  {DIM}saved, as small as it still fails: {}{DIM:#}", shown(&path)));
    Ok(())
}

fn summary(tally: &Tally, seed: u64, console: &mut Console) {
    console.line(format_args!("{} cases of seed {seed}", tally.cases()));
    let lines = [
        (tally.kept + tally.shrank, "without tracking errors, whose spread never grew"),
        (tally.shrank, "of these, whose spread shrank at least by what is guaranteed"),
        (tally.fell, "closed loops whose balance holds and whose error falls"),
        (tally.reached, "of these, that came to the value that is predicted for certain"),
        (tally.balanced, "closed loops whose balance holds, of which nothing more is promised"),
        (tally.undecided.len() as u64, "undecided: the error had not fallen over 16 times the horizon"),
    ];
    for (count, words) in lines {
        console.line(format_args!("  {count:6}  {words}"));
    }
    for case in tally.undecided.iter().take(LISTED) {
        console.line(format_args!("          {DIM}undecided: case {}{DIM:#}", case.number));
    }
    if let more @ 1.. = tally.undecided.len().saturating_sub(LISTED) {
        console.line(format_args!("          {DIM}and {more} more{DIM:#}"));
    }
    for (reason, count) in &tally.silent {
        console.line(format_args!("  {count:6}  {DIM}nothing to say: {reason}{DIM:#}"));
    }
    let (style, count) = if tally.failed.is_empty() { (GOOD, 0) } else { (BAD, tally.failed.len()) };
    console.line(format_args!("  {style}{count:6}  refuted{style:#}"));
}
