//! What a run leaves behind: columns of numbers, how it ended, and what it cost.

use std::time::Duration;

use forwardstep_core::agent::Inbox;
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

/// What the controller of one agent took and gave at one sample: all that it takes to step it again elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct SampleTaken<'a> {
    /// Index of the agent.
    pub agent: usize,
    /// Number of the sample, from zero.
    pub sample: u64,
    /// Its time, s.
    pub now_s: f64,
    /// What was measured, noise and rounding included, as [`forwardstep_core::sampled::Sampled::measures`] has it.
    pub measured: &'a [f64],
    /// What was sent.
    pub message: &'a [f64],
    /// What was heard.
    pub inbox: Inbox<'a>,
    /// What was commanded, before the actuators round it; not-a-number where the step failed.
    pub command: &'a [f64],
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
    /// Whoever simulated ended before the run did, and these rows were kept elsewhere. No simulation says so of itself.
    CutOff {
        /// Time of the last row that was kept, s.
        t_s: f64,
    },
    /// Something went wrong that no smaller step could mend.
    BrokeDown(Breakdown),
}

impl Ending {
    /// When a run ended before its horizon, s.
    pub fn before_horizon_s(&self) -> Option<f64> {
        match self {
            Ending::Completed => None,
            Ending::Interrupted { t_s } | Ending::CutOff { t_s } => Some(*t_s),
            Ending::BrokeDown(breakdown) => Some(breakdown.t_s),
        }
    }
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
        /// Whether that is because the closed loop is stiff; `None` where it cannot be told.
        stiffness: Option<Stiffness>,
    },
    /// What is sent within the longest delay exceeds [`crate::Solver::memory_budget_bytes`], because steps are so short. The
    /// signal is the one with the largest estimated error or, with steps of a given length, the one that moves fastest.
    MemoryFull {
        /// The mean step since the longest delay ago, s.
        step_s: f64,
        /// The budget that steps like these would need.
        need_bytes: f64,
        /// Whether that is because the closed loop is stiff; `None` where it cannot be told.
        stiffness: Option<Stiffness>,
    },
    /// A delay from outside is not what its author says, so that nothing is known of what is heard.
    Delay {
        /// Index of the delay.
        delay: usize,
        /// When it is outside the bounds that are declared, s.
        at_s: f64,
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

/// How fast a closed loop is, and the gains of the agent that broke it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// The size of the largest eigenvalue of the Jacobian of the closed loop, with late messages held, 1/s. It is estimated by
    /// power iterations, to within a factor of about two.
    pub rate_per_s: f64,
    /// The rates of its gains, where the agent is a robot under (6)–(7) in continuous time.
    pub gains: Option<GainRates>,
}

impl Stiffness {
    /// Whether this is why steps are as short as `step_s`: a method that is explicit takes steps of about one to three over the
    /// rate, and shorter ones only while that motion is still seen.
    pub fn explains(&self, step_s: f64) -> bool {
        self.rate_per_s * step_s > 0.05
    }

    /// Whether steps as long as `step_s` would be unstable: that of the method of order five ends at 3.3 over the rate.
    pub fn forbids(&self, step_s: f64) -> bool {
        self.rate_per_s * step_s > 3.3
    }
}

/// The rates that the gains of (6)–(7) give to one robot, 1/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainRates {
    /// λ_max(M⁻¹K), which is K/λ_min(M) where K is a number.
    pub damping_per_s: f64,
    /// λ_max(M⁻¹D), where D is the viscous damping of the robot itself; 0 without.
    pub viscous_per_s: f64,
    /// √λ_max(M⁻¹YΓYᵀ), the frequency at which s and the estimate turn into each other; `None` when nothing is adapted.
    pub adaptation_per_s: Option<f64>,
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
    /// What drove an agent that leads the others.
    pub drive: Option<Drive>,
    /// Steps of sampled controllers that failed, so that a safe command stood.
    pub failed_steps: u64,
    /// Commands that limits changed; `None` when control is continuous.
    pub clipped: Option<ClippedSamples>,
    /// Time spent, if whoever ran it measured it: nothing in the library reads a clock.
    pub wall: Option<Duration>,
}

/// How many commands of sampled controllers limits changed, on one axis or more. Without any the run is that without limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClippedSamples {
    /// Samples of all agents.
    pub samples: u64,
    /// Of these, at so many a torque was beyond its limit.
    pub torque: u64,
    /// At so many it would have changed faster than it may.
    pub rate: u64,
}

/// What drives an agent that leads away from those that follow it: ξ̇₀, or d³q₀ for a swarm. γ must exceed it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Its largest size at the end of any step, on any axis. Third derivatives are differences from step to step.
    pub peak: f64,
    /// When that was, s.
    pub peak_s: f64,
    /// When it was γ or more for the last time, s; `None` for never.
    pub exceeds_until_s: Option<f64>,
}

/// How far a run has come, for progress displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time, s.
    pub t_s: f64,
    /// The horizon, s.
    pub end_s: f64,
}
