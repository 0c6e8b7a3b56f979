//! What a run leaves behind: columns of numbers, how it ended, and what it cost.

use std::time::Duration;

pub use forwardstep_core::signal::{OwnSignal, Signal};

/// The tables of a run, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Time of every row, s.
    pub t_s: Vec<f64>,
    /// One column per agent, signal and axis, in that order.
    pub columns: Vec<Column>,
}

/// One recorded signal of one agent on one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Index of the agent.
    pub agent: usize,
    /// What is recorded.
    pub signal: Signal,
    /// Axis, or index of the parameter for [`Signal::Estimate`]; zero for [`Signal::Lyapunov`] and
    /// [`Signal::Dissipation`].
    pub axis: usize,
    /// One value per row.
    pub values: Vec<f64>,
}

/// A finished, broken or interrupted run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Everything recorded until the end.
    pub recording: Recording,
    /// How it ended.
    pub ending: Ending,
    /// What it cost.
    pub statistics: Statistics,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The horizon was reached.
    Completed,
    /// The observer asked to stop.
    Interrupted {
        /// Simulated time, s.
        t_s: f64,
    },
    /// Something went wrong that no smaller step could mend.
    BrokeDown(Breakdown),
}

/// When, who and what broke a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Breakdown {
    /// Simulated time, s.
    pub t_s: f64,
    /// Index of the agent.
    pub agent: usize,
    /// The signal that gave way.
    pub signal: Signal,
    /// Its axis.
    pub axis: usize,
    /// What happened to it.
    pub cause: BreakdownCause,
}

/// What went wrong with a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BreakdownCause {
    /// It is no longer a finite number.
    NotFinite,
    /// The error control asked for a step under the floor because of it.
    StepUnderFloor {
        /// The step asked for, s.
        step_s: f64,
    },
    /// Under digital control it moves so fast that this many steps did not reach the next sample: nothing holds it any more.
    RanAway {
        /// Its velocity, rad/s or m/s.
        value: f64,
        /// Steps since the last sample.
        steps: u64,
    },
    /// It came so close to zero that the law, which divides by it, means nothing any more.
    Vanished {
        /// Where it was.
        value: f64,
        /// How close it may come.
        floor: f64,
    },
    /// It left the limits that the scenario asked to enforce.
    PositionLimit {
        /// Where it was, rad or m.
        value: f64,
        /// The limits.
        limits: [f64; 2],
    },
}

/// Work done by the integrator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: u64,
    /// Steps rejected by the error control.
    pub rejected: u64,
    /// Evaluations of the closed loop.
    pub evaluations: u64,
    /// Steps that ended on a break-point.
    pub break_points: u64,
    /// The largest rest of the inclusions that set-valued signs solve, where they are solved for, in the unit of what the
    /// sign is taken of.
    pub sign_residual: Option<f64>,
    /// Time spent.
    pub wall: Duration,
}

/// How far a run has come, for progress displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub t_s: f64,
    /// The horizon, s.
    pub end_s: f64,
}
