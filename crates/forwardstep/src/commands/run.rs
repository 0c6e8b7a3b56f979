//! `forwardstep run`

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use forwardstep::check::{self, InjectionWatch};
use forwardstep::io::output::{
    self, DigitalCost, GoalOutcome, Injected, InjectedCourse, Journal, Metrics, OutputError, RunFolder, RunRecord,
    continuous_twin, ending_sentence,
};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shapes::Shapes;
use forwardstep::io::shown;
use forwardstep::sim::{
    Ending, Outcome, Progress, Recording, Statistics, Watch, recorded_columns, simulate, simulate_into,
};

use super::growing::followed;
use super::patience::{LOOKING, Patience};
use super::progress::Bar;
use super::promise::{Promise, predictions, predicts_quickly, promise, show, show_predictions};
use super::stop::Stop;
use super::summary::summary;
use crate::arguments::RunOptions;
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// Shapes that are left out are named as many.
const MOST_LEFT_OUT: usize = 5;

/// Simulates a scenario, writes its folder and prints a summary.
pub(crate) fn run(options: &RunOptions, kinds: &Kinds, console: &mut Console) -> Status {
    finish(options, kinds, console).unwrap_or_else(|status| status)
}

fn finish(options: &RunOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let patience = Patience::with(LOOKING);
    let scenario = kinds.open_scenario(&options.scenario).map_err(|error| complain(&error))?;
    scenario.check_recording().map_err(|error| complain(&error))?;
    let promise = promise(&scenario.setup);
    drop(patience);
    let path = options.out.clone().unwrap_or_else(|| Path::new("forwardstep-runs").join(&scenario.name));
    // Only now: until there is something to keep, Ctrl-C just ends the program.
    let stop = Stop::listen();
    execute(&scenario, &promise, &path, options, kinds, &stop, console)
}

/// Simulates a scenario that was read, into the folder `path`, and says so.
pub(super) fn execute(
    scenario: &Scenario,
    promise: &Promise,
    path: &Path,
    options: &RunOptions,
    kinds: &Kinds,
    stop: &Stop,
    console: &mut Console,
) -> Result<Status, Status> {
    // Before the run, so that no work is lost to a folder that cannot be written to.
    // What an earlier run wrote is read for that, which takes long where it is large.
    let folder = stop.at_once(|| RunFolder::create(path, options.force)).map_err(refused)?;
    show(scenario, promise, console);
    let (setup, mut bar) = (&scenario.setup, Bar::new());
    let predicts = options.predict || predicts_quickly(setup);
    let thorough = options.predict;
    let mut seen = |progress| watch(&mut bar, stop, progress);
    let prediction = if predicts { predictions(setup, thorough, &mut seen) } else { None };
    bar.clear();
    match &prediction {
        Some(prediction) => show_predictions(setup, prediction, console),
        None if predicts || check::ideal(setup).is_err() => {}
        None => console
            .line("No prediction: it would take a large part of the run's time. Use --predict to get one anyway."),
    }
    console.line("");

    let shapes = options.meshes.then(|| {
        let (shapes, left_out) = Shapes::read(&scenario.models);
        let left_out = alike(&left_out);
        left_out.iter().take(MOST_LEFT_OUT).for_each(|why| remark(format_args!("Not drawn: {}", shown(why.as_str()))));
        if let Some(more @ 1..) = left_out.len().checked_sub(MOST_LEFT_OUT) {
            remark(format_args!("and without {more} more"));
        }
        shapes
    });

    let mut bar = Bar::new();
    let started = Instant::now();
    let mut balances = if options.balance { InjectionWatch::of(setup) } else { None };
    let mut observer = |progress| watch(&mut bar, stop, progress);
    let nothing = nothing_yet(scenario)?;
    let mut start = record(scenario, promise, &nothing, None);
    start.prediction = prediction.clone();
    let mut journal = Journal::new(&folder, start, || started.elapsed());
    let balance = balances.as_mut().map(|balances| balances as &mut dyn Watch);
    if options.follow {
        let page = path.join("report.html");
        remark(format_args!("The page grows while the run goes on, from its first second on: {}", shown(&page)));
    }
    let outcome = followed(options.follow, &folder, kinds, promise, || {
        simulate_into(setup, &mut observer, balance, &mut journal)
    });
    bar.clear();
    let mut outcome = outcome.map_err(|error| complain(&Plain::new(error)))?;
    outcome.statistics.wall = Some(started.elapsed());

    let metrics = Metrics::of(setup, &outcome.recording, promise.value(), scenario.goal);
    let goal = scenario.goal.map(|goal| GoalOutcome { goal, met: goal.is_met(setup, &outcome, &metrics) });
    let mut record = record(scenario, promise, &outcome, goal);
    record.prediction = prediction;
    record.shapes = shapes.as_ref();
    record.injected = balances.iter().flat_map(InjectionWatch::balances).map(|own| Injected::from(&own)).collect();
    record.injected_course = balances.as_ref().and_then(|balances| InjectedCourse::of(&balances.course()));
    let lost = journal.failure().is_some();
    if let Some(error) = journal.failure() {
        remark(format_args!("{error}; the run was stopped, since its rows could no longer be kept"));
        error.help().into_iter().for_each(remark);
    }
    journal.end(&record, metrics.clone());
    let mut compared = None;
    if setup.control.is_some() && !matches!(outcome.ending, Ending::Interrupted { .. }) {
        let started = Instant::now();
        record.digital = digital_cost(scenario, &outcome, stop);
        compared = Some(started.elapsed());
    }
    let files = output::write_run(&folder, &record, output::Options { csv: options.csv })
        .map_err(|error| kept_if_journaled(refused(error), &folder))?;
    if outcome.ending != Ending::Completed {
        remark(ending_sentence(setup, &outcome.ending));
    }
    let cut_short = stop.asked().filter(|_| !matches!(outcome.ending, Ending::Interrupted { .. }));
    if cut_short.is_some() {
        remark("Interrupted while comparing with continuous time; the run itself is complete.");
    }
    console.text(summary(&record, &metrics, &promise.known_value(), compared, path, &files));
    Ok(match outcome.ending {
        Ending::BrokeDown(_) => Status::BrokeDown,
        _ if cut_short.is_some() => cut_short.unwrap_or(Status::Interrupted),
        _ if lost => Status::BadInput,
        Ending::Interrupted { .. } | Ending::CutOff { .. } => stop.asked().unwrap_or(Status::Interrupted),
        Ending::Completed if goal.is_some_and(|goal| !goal.met) => Status::Missed,
        Ending::Completed => Status::Fine,
    })
}

/// Why shapes are left out, those of one reason as one.
fn alike(left_out: &[String]) -> Vec<String> {
    let mut all: Vec<(&str, &str, usize)> = Vec::new();
    for why in left_out {
        // Behind the name of the mesh.
        let reason = why.rsplit_once("`: ").map_or(why.as_str(), |(_, reason)| reason);
        match all.iter_mut().find(|(_, known, _)| *known == reason) {
            Some((_, _, more)) => *more += 1,
            None => all.push((why, reason, 0)),
        }
    }
    let told = all.into_iter().map(|(first, _, more)| match more {
        0 => first.to_owned(),
        more => format!("{first} (and {more} more)"),
    });
    told.collect()
}

/// The outcome before the first step.
fn nothing_yet(scenario: &Scenario) -> Result<Outcome, Status> {
    let columns = recorded_columns(&scenario.setup).map_err(|error| complain(&Plain::new(error)))?;
    let recording = Recording { t_s: Vec::new(), columns };
    Ok(Outcome { recording, ending: Ending::Interrupted { t_s: 0.0 }, statistics: Statistics::default() })
}

/// Shows how far it is, and stops when it is asked to.
fn watch(bar: &mut Bar, stop: &Stop, progress: Progress) -> ControlFlow<()> {
    bar.update(progress);
    if stop.asked().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn record<'a>(
    scenario: &'a Scenario,
    promise: &'a Promise,
    outcome: &'a Outcome,
    goal: Option<GoalOutcome>,
) -> RunRecord<'a> {
    RunRecord {
        title: &scenario.title,
        scenario_name: &scenario.name,
        scenario_text: scenario.source.text(),
        inputs: &scenario.inputs,
        version: env!("CARGO_PKG_VERSION"),
        setup: &scenario.setup,
        outcome,
        verdicts: &promise.report,
        predicted_agreement: promise.value().map(<[f64]>::to_vec),
        prediction: None,
        goal,
        digital: None,
        injected: Vec::new(),
        injected_course: None,
        notices: scenario.notices.iter().map(ToString::to_string).collect(),
        shapes: None,
    }
}

/// Simulates the same in continuous time, as far as the run came. Whoever does not want to wait for it may interrupt: the run
/// itself is kept.
fn digital_cost(scenario: &Scenario, outcome: &Outcome, stop: &Stop) -> Option<DigitalCost> {
    let mut bar = Bar::named("the same in continuous time");
    let until_s = outcome.recording.t_s.last().copied().filter(|last| *last > 0.0)?;
    let twin = simulate(&continuous_twin(&scenario.setup, until_s), &mut |progress| watch(&mut bar, stop, progress));
    bar.clear();
    DigitalCost::of(&scenario.setup, outcome, &twin.ok()?, scenario.goal)
}

/// Says where the rows are of a run whose files could not be written.
fn kept_if_journaled(status: Status, folder: &RunFolder) -> Status {
    let path = folder.path();
    // What another folder under its name keeps is another run's.
    if !folder.is_elsewhere() && path.join("rows.journal").is_file() {
        remark(format_args!(
            "What was computed until about a second before is in {folder}/rows.journal: `forwardstep report {folder}` writes the files \
             from it when it can, and `--out` writes them elsewhere.",
            folder = shown(path)
        ));
    }
    status
}

pub(super) fn refused(error: OutputError) -> Status {
    let help = error.help();
    complain(&Plain::with_help(error, help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_that_are_left_out_for_one_reason_are_told_once() {
        let why =
            ["a.urdf: the mesh `b.stl`: gone", "a.urdf: the mesh `c.stl`: gone", "a.urdf: it says nothing of shapes"];
        let told = alike(&why.map(str::to_owned));
        assert_eq!(told, ["a.urdf: the mesh `b.stl`: gone (and 1 more)", why[2]]);
    }
}
