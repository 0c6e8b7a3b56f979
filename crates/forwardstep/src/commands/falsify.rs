//! `forwardstep falsify`

use forwardstep::io::shown;
use std::time::{Duration, Instant};

use super::replace;
use super::stop::Stop;
use crate::arguments::FalsifyOptions;
use crate::console::{BAD, Console, DIM, GOOD, complain};
use crate::falsify::{Case, Failure, Tally};
use crate::status::Status;

/// Cases that are listed.
const LISTED: usize = 20;

/// Draws scenarios and tries to refute what is claimed of them.
pub(crate) fn falsify(options: &FalsifyOptions, console: &mut Console) -> Result<Status, Status> {
    replace::check_folder(&options.out).map_err(|refused| complain(&refused))?;
    let stop = Stop::listen();
    let started = Instant::now();
    let limit =
        options.seconds.map_or(Duration::MAX, |seconds| Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX));
    let (mut tally, mut saved) = (Tally::default(), 0);
    for number in numbers(options) {
        if started.elapsed() >= limit || stop.asked().is_some() {
            break;
        }
        tally.add(Case::draw(options.seed, number));
        for (case, failure) in &tally.failed[saved..] {
            console.line(format_args!("{BAD}refuted{BAD:#}: case {}: {failure}", case.number));
            save(options, case, failure, console)?;
        }
        saved = tally.failed.len();
    }
    summary(&tally, options.seed, console);
    Ok(stop.asked().unwrap_or(if tally.failed.is_empty() { Status::Fine } else { Status::Missed }))
}

/// The numbers of the cases: the last there is counts as any other, and nothing comes behind it.
fn numbers(options: &FalsifyOptions) -> impl Iterator<Item = u64> {
    let from = options.from;
    (0..options.cases).map_while(move |k| from.checked_add(k))
}

fn save(options: &FalsifyOptions, case: &Case, failure: &Failure, console: &mut Console) -> Result<(), Status> {
    // Every seed draws another case of the same number.
    let name = format!("refuted-{}-{}.toml", options.seed, case.number);
    let path = replace::write_into(&options.out, &name, &format!("# {failure}\n{case}"));
    let path = path.map_err(|refused| complain(&refused))?;
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Started at the last number, it tried nothing and said that all was well.
    #[test]
    fn regress_the_last_case_is_tried() {
        let options = |from, cases| FalsifyOptions { cases, from, seed: 1, seconds: None, out: "refuted".into() };
        assert!(numbers(&options(u64::MAX, 10)).eq([u64::MAX]));
        assert!(numbers(&options(u64::MAX - 1, 10)).eq([u64::MAX - 1, u64::MAX]));
        assert!(numbers(&options(4, 2)).eq([4, 5]));
    }

    /// What a second seed refuted took the place of what the first had.
    #[test]
    fn regress_what_is_refuted_by_another_seed_is_kept_beside() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("refuted");
        let save = |seed: u64, failure: &str| {
            let options = FalsifyOptions { cases: 1, from: 4, seed, seconds: None, out: out.clone() };
            let failure = Failure::BrokeDown(failure.to_owned());
            save(&options, &Case::draw(seed, 4), &failure, &mut Console::muted())
        };
        let text = |seed: u64| std::fs::read_to_string(out.join(format!("refuted-{seed}-4.toml"))).unwrap();
        assert_eq!((save(1, "first"), save(2, "second")), (Ok(()), Ok(())));
        assert!(text(1).contains(": first\n") && text(2).contains(": second\n"));
        // What it wrote itself is written anew, and nothing that somebody edited.
        assert_eq!(save(1, "again"), Ok(()));
        assert!(text(1).contains(": again\n"));
        std::fs::write(out.join("refuted-1-4.toml"), text(1).replace("again", "mine")).unwrap();
        assert_eq!(save(1, "third"), Err(Status::BadInput));
        assert!(text(1).contains(": mine\n"));
    }
}
