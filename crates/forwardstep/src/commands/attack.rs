//! `forwardstep attack`

use std::time::Duration;

use clap::ValueEnum;
use forwardstep::check::Id;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shown;
use forwardstep::sim::quantity::with_power;

use super::replace;
use super::stop::Stop;
use crate::arguments::AttackOptions;
use crate::console::{BAD, Console, DIM, GOOD, Plain, complain, remark};
use crate::falsify::{Attack, GROWS, NoAttack, OwnAttack, OwnFound, Target};
use crate::status::Status;

/// What the first line of a file says that is saved, between a number and names.
const LEFT: &str = " % is left; hypotheses that do not hold: ";

/// Searches for delays and schedules under which a design, or a scenario, does worst.
pub(crate) fn attack(options: &AttackOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    replace::may_replace(&options.out, replace::is_unedited).map_err(|refused| complain(&refused))?;
    let stop = Stop::listen();
    match Target::from_str(&options.what, false).ok() {
        Some(target) => design(target, options, &stop, console),
        None => scenario(options, kinds, &stop, console),
    }
}

fn limit(options: &AttackOptions) -> Duration {
    Duration::try_from_secs_f64(options.seconds).unwrap_or(Duration::MAX)
}

fn design(target: Target, options: &AttackOptions, stop: &Stop, console: &mut Console) -> Result<Status, Status> {
    let limit = limit(options);
    let attack = Attack { target, pieces: options.pieces as usize, seed: options.seed, limit };
    let Some(found) = attack.search(&|| stop.asked().is_some()) else {
        console.line("nothing could be tried in this time");
        return Ok(stop.asked().unwrap_or(Status::Missed));
    };
    let inside = target.is_inside();
    let refuted = inside && found.left > 1.0 + 1e-6;
    let percent = percent(found.left);
    console.line(format_args!("{} scenarios tried, with at most {}", found.tried, in_pieces(attack.pieces)));
    if inside {
        let style = if refuted { BAD } else { GOOD };
        let agents = found.case.starts.len();
        console.line(format_args!(
            "  {style}worst{style:#}: {percent} % of the disagreement of {agents} agents is left after {} s",
            found.case.end_s
        ));
    } else if found.left > target.fails() {
        console.line(format_args!("  {BAD}fails{BAD:#}: {percent} % of what there was at the start is left"));
    } else {
        console.line(format_args!("  nothing fails; the worst leaves {percent} % of what there was at the start"));
    }
    let words = listed(&found.broken);
    console.line(format_args!("  hypotheses that do not hold for it: {words}"));
    let text = format!("# {percent}{LEFT}{words}\n{}", found.case);
    saved(options, &text, console)?;
    Ok(stop.asked().unwrap_or(if refuted { Status::Missed } else { Status::Fine }))
}

/// A scenario of the user's own, within the delays and schedules that it allows.
fn scenario(options: &AttackOptions, kinds: &Kinds, stop: &Stop, console: &mut Console) -> Result<Status, Status> {
    let scenario = kinds.open_scenario(&options.what).map_err(|error| {
        let status = complain(&error);
        if !options.what.contains(['.', '/']) {
            let designs: Vec<String> = Target::value_variants().iter().filter_map(named).collect();
            remark(format_args!("or one of the designs that come with `attack`: {}", designs.join(", ")));
        }
        status
    })?;
    let (pieces, seed, limit) = (options.pieces as usize, options.seed, limit(options));
    let attack = OwnAttack { scenario: &scenario, kinds, pieces, seed, limit };
    let failed = |error| complain(&Plain::new(format!("`{}` cannot be attacked: {error}", options.what)));
    let OwnFound { text, files, worst, stated, broken, tried } = match attack.search(&|| stop.asked().is_some()) {
        Ok(found) => found,
        Err(NoAttack::Stopped) => {
            console.line(NoAttack::Stopped);
            return Ok(stop.asked().unwrap_or(Status::Interrupted));
        }
        Err(error) => return Err(failed(error)),
    };
    let grows = worst.grew || (!worst.of_interval && worst.part > GROWS);
    let [part, before] = [worst.part, stated.part].map(percent);
    let of = if worst.of_interval { "interval of all cascaded variables" } else { "disagreement" };
    let end_s = scenario.setup.time.end_s;
    console.line(format_args!("{tried} networks tried, with at most {}", in_pieces(pieces)));
    let style = if grows { BAD } else { GOOD };
    let word = if grows { "grows" } else { "worst" };
    console.line(format_args!(
        "  {style}{word}{style:#}: {part} % of the {of} is left after {end_s} s without tracking errors; as stated it is {before} %"
    ));
    let words = listed(&broken);
    console.line(format_args!("  hypotheses that do not hold for it: {words}"));
    if !files.is_empty() {
        console.line(format_args!("  {DIM}what is saved names files of the scenario: {}{DIM:#}", files.join(", ")));
    }
    saved(options, &format!("# {part}{LEFT}{words}\n{text}"), console)?;
    // That the interval never grows is what the proofs say.
    Ok(stop.asked().unwrap_or(if worst.grew { Status::Missed } else { Status::Fine }))
}

fn named(target: &Target) -> Option<String> {
    Some(target.to_possible_value()?.get_name().to_owned())
}

fn in_pieces(pieces: usize) -> String {
    format!("{pieces} {}", if pieces == 1 { "piece" } else { "pieces" })
}

/// A part in percent, with digits that say something whatever its size.
fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    if percent == 0.0 || (1e-2..1e6).contains(&percent) {
        format!("{percent:.3}")
    } else {
        with_power(&format!("{percent:.3e}"))
    }
}

fn listed(broken: &[Id]) -> String {
    let names: Vec<&str> = broken.iter().map(|id| id.name()).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn saved(options: &AttackOptions, text: &str, console: &mut Console) -> Result<(), Status> {
    replace::write(&options.out, &replace::with_digest(text)).map_err(|refused| complain(&refused))?;
    console.line(format_args!("  {DIM}saved: {}{DIM:#}", shown(&options.out)));
    Ok(())
}
