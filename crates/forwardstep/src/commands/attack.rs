//! `forwardstep attack`

use std::fs;
use std::time::Duration;

use super::stop::Stop;
use crate::arguments::AttackOptions;
use crate::console::{BAD, Console, DIM, GOOD, Plain, complain};
use crate::falsify::Attack;
use crate::status::Status;

/// Searches for delays and schedules under which a design does worst.
pub(crate) fn attack(options: &AttackOptions, console: &mut Console) -> Status {
    let stop = Stop::listen();
    let limit = Duration::try_from_secs_f64(options.seconds).unwrap_or(Duration::MAX);
    let target = options.target.target();
    let attack = Attack { target, pieces: options.pieces, seed: options.seed, limit };
    let Some(found) = attack.search(&|| stop.asked().is_some()) else {
        console.line("nothing could be tried in this time");
        return stop.asked().unwrap_or(Status::Missed);
    };
    let inside = target.is_inside();
    let refuted = inside && found.left > 1.0 + 1e-6;
    let percent = 100.0 * found.left;
    console.line(format_args!("{} scenarios tried, with at most {} pieces", found.tried, options.pieces));
    if inside {
        let style = if refuted { BAD } else { GOOD };
        let agents = found.case.starts.len();
        console.line(format_args!(
            "  {style}worst{style:#}: {percent:.3} % of the disagreement of {agents} agents is left after {} s",
            found.case.end_s
        ));
    } else if found.left > target.fails() {
        console.line(format_args!("  {BAD}fails{BAD:#}: {percent:.3} % of what there was at the start is left"));
    } else {
        console.line(format_args!("  nothing fails; the worst leaves {percent:.3} % of what there was at the start"));
    }
    let broken: Vec<&str> = found.broken.iter().map(|id| id.name()).collect();
    let words = if broken.is_empty() { "none".to_owned() } else { broken.join(", ") };
    console.line(format_args!("  hypotheses that do not hold for it: {words}"));
    let text = format!("# {percent:.3} % is left; hypotheses that do not hold: {words}\n{}", found.case);
    if let Err(error) = fs::write(&options.out, text) {
        return complain(&Plain::new(error));
    }
    console.line(format_args!("  {DIM}saved: {}{DIM:#}", options.out.display()));
    stop.asked().unwrap_or(if refuted { Status::Missed } else { Status::Fine })
}
