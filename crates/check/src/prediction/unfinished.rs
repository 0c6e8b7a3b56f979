//! A simulation of the reference dynamics alone, to its end.

use std::ops::ControlFlow;

use forwardstep_sim::{
    Ending, Observers, Outcome, Progress, Recording, Setup, SetupError, TimeSpan, simulate, simulate_with,
};
use thiserror::Error;

/// Why the reference dynamics alone were not simulated to the end.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unfinished {
    /// The setup has no meaning.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// They could not be integrated.
    #[error("the reference dynamics alone break down at {t_s} s")]
    BrokeDown {
        /// When, s.
        t_s: f64,
    },
    /// It is more work than was allowed.
    #[error(
        "simulating the reference dynamics alone is more work than is spent on a prediction, which came to {t_s:.3} s of {end_s} s; \
         `check --predict --thorough` and `run --predict` go on"
    )]
    TooMuchWork {
        /// How far it came, s.
        t_s: f64,
        /// How far it was to come, s.
        end_s: f64,
    },
    /// The observer asked to stop.
    #[error("the prediction was interrupted")]
    Interrupted,
}

/// What a simulation of `ideal` records, whose agents may have told something else before t = 0; with so much work left, which is counted.
pub(super) fn completed(
    ideal: &Setup,
    before: Option<&[Vec<f64>]>,
    work: &mut f64,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Recording, Unfinished> {
    let (outcome, reached_s) = simulated(ideal, before, work, observer)?;
    match outcome.ending {
        Ending::Completed => Ok(outcome.recording),
        Ending::Interrupted { .. } | Ending::CutOff { .. } if *work < 0.0 => {
            Err(Unfinished::TooMuchWork { t_s: reached_s, end_s: ideal.time.end_s })
        }
        Ending::Interrupted { .. } | Ending::CutOff { .. } => Err(Unfinished::Interrupted),
        Ending::BrokeDown(breakdown) => Err(Unfinished::BrokeDown { t_s: breakdown.t_s }),
    }
}

/// The same however it ends, and how far it came, s.
pub(super) fn simulated(
    ideal: &Setup,
    before: Option<&[Vec<f64>]>,
    work: &mut f64,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<(Outcome, f64), SetupError> {
    let (per_step, mut reached_s) = (step_work(ideal), 0.0);
    let mut counting = |progress: Progress| {
        *work -= per_step;
        reached_s = progress.t_s;
        if *work < 0.0 { ControlFlow::Break(()) } else { observer(progress) }
    };
    let mut run = |ideal: &Setup| match before {
        Some(before) => {
            simulate_with(ideal, &mut counting, Observers { told_before: Some(before), ..Observers::default() })
        }
        None => simulate(ideal, &mut counting),
    };
    let outcome = match run(ideal) {
        Err(SetupError::RecordingTooLarge { least_s: Some(least_s), .. }) => run(&fewer_rows(ideal, least_s)),
        outcome => outcome,
    }?;
    Ok((outcome, reached_s))
}

/// A run of a setup as it is, as far as it may go; `None` where it has no meaning, or takes more than so much work.
pub(crate) fn trial(setup: &Setup, mut work: f64) -> Option<Outcome> {
    let (outcome, _) = simulated(setup, None, &mut work, &mut |_| ControlFlow::Continue(())).ok()?;
    (!matches!(outcome.ending, Ending::Interrupted { .. } | Ending::CutOff { .. })).then_some(outcome)
}

/// A quarter of the rows that would fit into memory, where those that were asked for do not.
fn fewer_rows(ideal: &Setup, least_s: f64) -> Setup {
    Setup { time: TimeSpan { record_every_s: 4.0 * least_s, ..ideal.time.clone() }, ..ideal.clone() }
}

/// What a step takes, in nanoseconds, roughly: itself, seven evaluations of all states and of all that is heard, and the pieces of a delay among which
/// an arrival is looked for.
fn step_work(ideal: &Setup) -> f64 {
    let agents = ideal.agents.iter();
    let states: usize = agents.map(|agent| agent.robot.axes.len() * (agent.roots_per_s.len() + 2)).sum();
    let axes = ideal.agents.first().map_or(0, |agent| agent.robot.axes.len());
    let links = ideal.network.schedule.graphs.iter().map(Vec::len).max().unwrap_or(0) * axes;
    let pieces = |index: usize| {
        let delay = &ideal.network.delays[index];
        // The first may be cut by the start.
        let first = delay.first_piece();
        let next = if first.end_s.is_finite() { delay.next_piece(first) } else { first };
        let longest_s = (first.end_s - first.start_s).max(next.end_s - next.start_s);
        let pieces = (delay.max_s() / longest_s).min(1e4);
        if delay.is_constant() || !pieces.is_finite() { 0.0 } else { pieces }
    };
    let searched = ideal.network.used_delays().map(pieces).fold(0.0, f64::max);
    5e3 + 7.0 * (20.0 * states as f64 + links as f64) + 200.0 * searched
}
