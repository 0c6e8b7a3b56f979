//! `forwardstep run`

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use forwardstep::check::{self, InjectionWatch};
use forwardstep::io::output::{
    self, DigitalCost, GoalOutcome, Injected, InjectedCourse, Journal, Metrics, OutputError, Predictions, RunFolder,
    RunRecord, continuous_twin, ending_sentence,
};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::shapes::Shapes;
use forwardstep::io::shown;
use forwardstep::sim::{
    Ending, Observers, Outcome, Progress, Recording, Statistics, Watch, recorded_columns, simulate, simulate_with,
};

use super::growing::followed;
use super::patience::{LOOKING, Patience};
use super::progress::Bar;
use super::promise::{Promise, predictions, predicts_quickly, promise, show, show_predictions};
use super::stop::Stop;
use super::summary::summary;
use crate::arguments::{RunOptions, Writing};
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// Shapes that are left out are named as many.
const MOST_LEFT_OUT: usize = 5;

/// Simulates a scenario, writes its folder and prints a summary.
pub(crate) fn run(options: &RunOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let patience = Patience::with(LOOKING);
    let scenario = kinds.open_scenario(&options.scenario).map_err(|error| complain(&error))?;
    scenario.check_recording().map_err(|error| complain(&error))?;
    let promise = promise(&scenario.setup);
    drop(patience);
    let path = options.out.clone().unwrap_or_else(|| Path::new("forwardstep-runs").join(&scenario.name));
    // Only now: until there is something to keep, Ctrl-C just ends the program.
    let stop = Stop::listen();
    let writing = options.writing;
    Job { scenario: &scenario, promise: &promise, path: &path, writing, kinds, stop: &stop }.execute(console)
}

/// A scenario that was read and is to be run, and into which folder.
pub(super) struct Job<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) promise: &'a Promise,
    pub(super) path: &'a Path,
    pub(super) writing: Writing,
    pub(super) kinds: &'a Kinds,
    pub(super) stop: &'a Stop,
}

impl Job<'_> {
    /// Simulates it, writes its folder and says so.
    pub(super) fn execute(&self, console: &mut Console) -> Result<Status, Status> {
        let Job { scenario, promise, path, writing, stop, .. } = *self;
        let setup = &scenario.setup;
        // Before the run, so that no work is lost to a folder that cannot be written to.
        // What an earlier run wrote is read for that, which takes long where it is large.
        let folder = stop.at_once(|| RunFolder::create(path, writing.force)).map_err(refused)?;
        show(scenario, promise, console);
        let prediction = self.predicted(console);
        console.line("");
        let shapes = writing.meshes.then(|| self.drawn());

        let started = Instant::now();
        let mut balances = if writing.balance { InjectionWatch::of(setup) } else { None };
        if writing.balance && balances.is_none() {
            remark("--balance says nothing here: no controller samples, or no V of their laws is known.");
        }
        let nothing = nothing_yet(scenario)?;
        let mut start = record(scenario, promise, &nothing, None);
        start.prediction = prediction.clone();
        let mut journal = Journal::new(&folder, start, || started.elapsed());
        let mut outcome = self.simulated(&folder, &mut journal, balances.as_mut())?;
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
        let compared = self.compared(&outcome);
        let cut_short = compared.as_ref().is_some_and(|compared| compared.cut_short);
        let took = compared.as_ref().map(|compared| compared.took);
        record.digital = compared.and_then(|compared| compared.cost);
        let files = output::write_run(&folder, &record, output::Options { csv: writing.csv })
            .map_err(|error| kept_if_journaled(refused(error), &folder))?;
        if outcome.ending != Ending::Completed {
            remark(ending_sentence(setup, &outcome.ending));
        }
        if cut_short {
            let whole = if outcome.ending == Ending::Completed { "; the run itself is complete" } else { "" };
            remark(format_args!("Interrupted while comparing with continuous time{whole}."));
        }
        console.text(summary(&record, &metrics, &promise.known_value(), took, path, &files));
        let missed = goal.is_some_and(|goal| !goal.met);
        Ok(status(&outcome.ending, lost, missed, cut_short, stop.asked()))
    }

    /// What is predicted, where that is asked for or takes no time to speak of.
    fn predicted(&self, console: &mut Console) -> Option<Predictions> {
        let (setup, thorough) = (&self.scenario.setup, self.writing.predict);
        let predicts = thorough || predicts_quickly(setup);
        let mut bar = Bar::new();
        let mut seen = |progress| watch(&mut bar, self.stop, progress);
        let prediction = if predicts { predictions(setup, thorough, &mut seen) } else { None };
        bar.clear();
        match &prediction {
            Some(prediction) => show_predictions(setup, prediction, console),
            None if predicts || check::ideal(setup).is_err() => {}
            None => console
                .line("No prediction: it would take a large part of the run's time. Use --predict to get one anyway."),
        }
        prediction
    }

    /// What robots look like; what is left out of that is said.
    fn drawn(&self) -> Shapes {
        // Meshes may be large, and nothing is there to be kept.
        let (shapes, left_out) = self.stop.at_once(|| Shapes::read(&self.scenario.models));
        let left_out = alike(&left_out);
        left_out.iter().take(MOST_LEFT_OUT).for_each(|why| remark(format_args!("Not drawn: {}", shown(why.as_str()))));
        if let Some(more @ 1..) = left_out.len().checked_sub(MOST_LEFT_OUT) {
            remark(format_args!("and without {more} more"));
        }
        shapes
    }

    fn simulated(
        &self,
        folder: &RunFolder,
        journal: &mut Journal<'_>,
        balances: Option<&mut InjectionWatch>,
    ) -> Result<Outcome, Status> {
        let mut bar = Bar::new();
        let mut observer = |progress| watch(&mut bar, self.stop, progress);
        let balance = balances.map(|balances| balances as &mut dyn Watch);
        if self.writing.follow {
            let page = self.path.join("report.html");
            remark(format_args!("The page grows while the run goes on, from its first second on: {}", shown(&page)));
        }
        let outcome = followed(self.writing.follow, folder, self.kinds, self.promise, || {
            simulate_with(
                &self.scenario.setup,
                &mut observer,
                Observers { inside: balance, rows: Some(journal), ..Observers::default() },
            )
        });
        bar.clear();
        outcome.map_err(|error| complain(&Plain::new(error)))
    }

    /// Simulates the same in continuous time, as far as the run came. Whoever does not want to wait for it may interrupt: the run
    /// itself is kept.
    fn compared(&self, outcome: &Outcome) -> Option<Compared> {
        let setup = &self.scenario.setup;
        if setup.control.is_none() || matches!(outcome.ending, Ending::Interrupted { .. }) {
            return None;
        }
        let started = Instant::now();
        let mut bar = Bar::named("the same in continuous time");
        let until_s = outcome.recording.t_s.last().copied().filter(|last| *last > 0.0);
        let twin = until_s.and_then(|until_s| {
            simulate(&continuous_twin(setup, until_s), &mut |progress| watch(&mut bar, self.stop, progress)).ok()
        });
        bar.clear();
        let cut_short = twin.as_ref().is_some_and(|twin| matches!(twin.ending, Ending::Interrupted { .. }));
        let cost = twin.and_then(|twin| DigitalCost::of(setup, outcome, &twin, self.scenario.goal));
        Some(Compared { cost, cut_short, took: started.elapsed() })
    }
}

/// What the comparison with continuous time gave.
struct Compared {
    cost: Option<DigitalCost>,
    /// Whether it was interrupted.
    cut_short: bool,
    took: Duration,
}

/// How a run ends the program: rows may be `lost`, its goal `missed`, its comparison with continuous time `cut_short`, and somebody may have
/// `asked` it to stop. Who asks when the last step is made, or while files are written, gets a run that is whole.
fn status(ending: &Ending, lost: bool, missed: bool, cut_short: bool, asked: Option<Status>) -> Status {
    let interrupted = asked.unwrap_or(Status::Interrupted);
    match ending {
        Ending::BrokeDown(_) => Status::BrokeDown,
        _ if cut_short => interrupted,
        _ if lost => Status::BadInput,
        Ending::Interrupted { .. } | Ending::CutOff { .. } => interrupted,
        Ending::Completed if missed => Status::Missed,
        Ending::Completed => Status::Fine,
    }
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
    stop.flow()
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
        practical: promise.practical.clone(),
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

/// Says where the rows are of a run whose files could not be written.
fn kept_if_journaled(status: Status, folder: &RunFolder) -> Status {
    let path = folder.path();
    // What another folder under its name keeps is another run's.
    if !folder.is_elsewhere() && RunFolder::journal_in(path).is_file() {
        remark(format_args!(
            "What was computed until about a second before is in {}: `forwardstep report {}` writes the files \
             from it when it can, and `--out` writes them elsewhere.",
            shown(&RunFolder::journal_in(path)),
            shown(path)
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

    /// A stop while files were written made a run that was whole an interrupted one, and hid its missed goal.
    #[test]
    fn regress_a_run_that_is_whole_is_not_interrupted_by_who_comes_late() {
        let (completed, interrupted) = (Ending::Completed, Ending::Interrupted { t_s: 1.0 });
        for asked in [None, Some(Status::Interrupted), Some(Status::Terminated)] {
            let stopped = asked.unwrap_or(Status::Interrupted);
            for (ending, lost, missed, cut_short, wanted) in [
                (&completed, false, false, false, Status::Fine),
                (&completed, false, true, false, Status::Missed),
                (&completed, true, true, false, Status::BadInput),
                (&completed, false, true, true, stopped),
                (&interrupted, false, true, false, stopped),
                (&interrupted, true, false, false, Status::BadInput),
                (&Ending::CutOff { t_s: 1.0 }, false, false, false, stopped),
            ] {
                let found = status(ending, lost, missed, cut_short, asked);
                assert_eq!(found, wanted, "{ending:?} {lost} {missed} {cut_short} {asked:?}");
            }
        }
    }

    #[test]
    fn shapes_that_are_left_out_for_one_reason_are_told_once() {
        let why =
            ["a.urdf: the mesh `b.stl`: gone", "a.urdf: the mesh `c.stl`: gone", "a.urdf: it says nothing of shapes"];
        let told = alike(&why.map(str::to_owned));
        assert_eq!(told, ["a.urdf: the mesh `b.stl`: gone (and 1 more)", why[2]]);
    }
}
