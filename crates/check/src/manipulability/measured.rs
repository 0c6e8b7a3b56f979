//! The same measured: by pushing, from recordings.

use std::ops::ControlFlow;

use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::{Ending, Method, Outcome, Progress, Setup, SetupError, Signal, simulate};
use thiserror::Error;

use super::{Manipulability, NoManipulability, at_agreement};

/// Who is pushed, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Index of the agent.
    pub agent: usize,
    /// Index of the axis.
    pub axis: usize,
    /// The torque, N m or N. The transfer is that of small ones, unless the robots are point masses.
    pub torque: f64,
    /// How long the push that ends lasts, s.
    pub for_s: f64,
}

/// What pushes did to the value agreed upon, on the axis pushed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// How far the push that ended displaced it, per impulse, (rad or m)/(N m s or N s).
    pub by_impulse: f64,
    /// How fast it moved at the end under a constant torque, per torque, (rad or m)/s/(N m or N).
    pub drift: f64,
    /// How far it had moved by then, per torque, (rad or m)/(N m or N).
    pub by_constant: f64,
}

/// Why nothing was measured.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NotMeasured {
    /// There is no value agreed upon, or the push has no bearing on it.
    #[error(transparent)]
    Transfer(#[from] NoManipulability),
    /// The setup has no meaning.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A run did not come to its end.
    #[error("the run that is pushed ends early; push less")]
    Early,
}

/// Pushes a network that rests where all agree without s, with estimates that are right. The runs last as long as those of `setup`; `observer`
/// as that of [`simulate`].
///
/// # Errors
/// [`NotMeasured`].
pub fn measure(
    setup: &Setup,
    trial: Trial,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Measured, NotMeasured> {
    let influence = Manipulability::of(setup, trial.agent, trial.axis)?.influence().to_vec();
    let mut pushed = |until_s: f64| -> Result<[f64; 2], NotMeasured> {
        let mut setup = at_rest(setup, trial.agent);
        let rest: f64 = setup.agents.iter().zip(&influence).map(|(own, u)| u * own.start.q[trial.axis]).sum();
        let own = &mut setup.agents[trial.agent];
        let torque = |axis| Function::Constant(if axis == trial.axis { trial.torque } else { 0.0 });
        let effect = Effect::Torque(Course::Each((0..own.robot.axes.len()).map(torque).collect()));
        own.pushes = vec![Push { effect, from_s: 0.0, until_s }];
        let outcome = simulate(&setup, observer)?;
        if outcome.ending != Ending::Completed {
            return Err(NotMeasured::Early);
        }
        let mean = |signal| mean(&outcome, &influence, signal, trial.axis);
        Ok([mean(Signal::Position) - rest, mean(Signal::Velocity)])
    };
    let [displaced, _] = pushed(trial.for_s)?;
    let [moved, speed] = pushed(f64::INFINITY)?;
    Ok(Measured {
        by_impulse: displaced / (trial.torque * trial.for_s),
        drift: speed / trial.torque,
        by_constant: moved / trial.torque,
    })
}

/// Everybody at rest in agreement, in a run that shows what small pushes do.
fn at_rest(setup: &Setup, agent: usize) -> Setup {
    let mut rest = at_agreement(setup, agent);
    rest.time.record_every_s = rest.time.end_s;
    rest.solver.balance = false;
    // Far below what small pushes do.
    rest.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-13 };
    rest
}

/// Σ uᵢ of a signal at the last row.
fn mean(outcome: &Outcome, influence: &[f64], signal: Signal, axis: usize) -> f64 {
    let columns = outcome.recording.columns.iter().filter(|column| column.signal == signal && column.axis == axis);
    let last = columns.filter_map(|column| Some((column.agent, *column.values.last()?)));
    last.map(|(agent, value)| influence.get(agent).unwrap_or(&0.0) * value).sum()
}
