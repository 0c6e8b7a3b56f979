//! How a run ended, in `summary.json`: written, and read back.

use forwardstep_sim::recording::{Breakdown, BreakdownCause, Ending, GainRates, Recording, Stiffness};
use forwardstep_sim::setup::Setup;
use forwardstep_sim::state_entries;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ending::ending_sentence;
use super::{names, number};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct How {
    /// `completed`, `interrupted`, `cut_off` or `broke_down`.
    pub kind: EndingKind,
    /// The simulated time that was reached, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub t_s: f64,
    /// The horizon, s.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub end_s: f64,
    /// The ending in one sentence.
    pub sentence: String,
    /// What broke down, if anything did.
    pub breakdown: Option<BrokenSignal>,
}

/// The four endings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EndingKind {
    /// The horizon was reached.
    Completed,
    /// Stopped from outside.
    Interrupted,
    /// The program ended before the run did; the rows come from its journal.
    CutOff,
    /// Stopped because of what happened inside.
    BrokeDown,
}

/// The signal that broke a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BrokenSignal {
    /// The agent.
    pub agent: usize,
    /// The signal's column in the tables.
    pub column: String,
    /// Why.
    pub cause: Cause,
}

/// How fast a closed loop was that broke down, 1/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rates {
    /// Its fastest rate.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub fastest_per_s: f64,
    /// K/λ_min(M) of the agent, where it is a robot under (6)–(7).
    pub damping_per_s: Option<f64>,
    /// D/λ_min(M) of the agent, where D is the viscous damping of the robot itself.
    #[serde(default)]
    pub viscous_per_s: Option<f64>,
    /// √(Γ‖Y‖²/λ_min(M)) of the agent, where it adapts besides.
    pub adaptation_per_s: Option<f64>,
}

impl Rates {
    fn of(stiffness: Stiffness) -> Self {
        let Stiffness { rate_per_s, gains } = stiffness;
        Rates {
            fastest_per_s: rate_per_s,
            damping_per_s: gains.map(|gains| gains.damping_per_s),
            viscous_per_s: gains.map(|gains| gains.viscous_per_s),
            adaptation_per_s: gains.and_then(|gains| gains.adaptation_per_s),
        }
    }

    fn restore(self) -> Stiffness {
        let Rates { fastest_per_s, damping_per_s, viscous_per_s, adaptation_per_s } = self;
        let viscous_per_s = viscous_per_s.unwrap_or(0.0);
        let gains = damping_per_s.map(|damping_per_s| GainRates { damping_per_s, viscous_per_s, adaptation_per_s });
        Stiffness { rate_per_s: fastest_per_s, gains }
    }
}

/// Why a run broke down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// A number was no longer finite.
    NotFinite,
    /// The error control asked for a step under the floor.
    StepUnderFloor {
        /// The step asked for, s.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        step_s: f64,
        /// How fast the closed loop was.
        #[serde(default)]
        stiffness: Option<Rates>,
    },
    /// What is sent within the longest delay exceeded the memory budget.
    MemoryFull {
        /// The mean step since the longest delay ago, s.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        step_s: f64,
        /// The budget that steps like these would need.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        need_bytes: f64,
        /// How fast the closed loop was.
        stiffness: Option<Rates>,
    },
    /// A delay from outside was not what its author says.
    Delay {
        /// Index of the delay.
        delay: usize,
        /// When, s.
        at_s: f64,
    },
    /// Under digital control a velocity grew so far that steps no longer reached the next sample.
    RanAway {
        /// The velocity, rad/s or m/s.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        value: f64,
        /// Steps since the last sample.
        steps: u64,
    },
    /// What the law divides by came too close to zero.
    Vanished {
        /// Its value.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        value: f64,
        /// How close it may come.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        floor: f64,
    },
    /// An enforced position limit was left.
    PositionLimit {
        /// The position, rad or m.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        value: f64,
        /// The limits.
        #[serde(deserialize_with = "number::pair_or_nan")]
        #[schemars(with = "[Option<f64>; 2]")]
        limits: [f64; 2],
    },
}

impl How {
    pub(super) fn of(setup: &Setup, ending: &Ending) -> How {
        let (kind, t_s, breakdown) = match ending {
            Ending::Completed => (EndingKind::Completed, setup.time.end_s, None),
            Ending::Interrupted { t_s } => (EndingKind::Interrupted, *t_s, None),
            Ending::CutOff { t_s } => (EndingKind::CutOff, *t_s, None),
            Ending::BrokeDown(breakdown) => {
                let cause = match breakdown.cause {
                    BreakdownCause::NotFinite => Cause::NotFinite,
                    BreakdownCause::StepUnderFloor { step_s, stiffness } => {
                        Cause::StepUnderFloor { step_s, stiffness: stiffness.map(Rates::of) }
                    }
                    BreakdownCause::MemoryFull { step_s, need_bytes, stiffness } => {
                        Cause::MemoryFull { step_s, need_bytes, stiffness: stiffness.map(Rates::of) }
                    }
                    BreakdownCause::Delay { delay, at_s } => Cause::Delay { delay, at_s },
                    BreakdownCause::RanAway { value, steps } => Cause::RanAway { value, steps },
                    BreakdownCause::Vanished { value, floor } => Cause::Vanished { value, floor },
                    BreakdownCause::PositionLimit { value, limits } => Cause::PositionLimit { value, limits },
                };
                let column = names::column_name(setup, breakdown.agent, breakdown.signal, breakdown.axis);
                let broken = BrokenSignal { agent: breakdown.agent, column, cause };
                (EndingKind::BrokeDown, breakdown.t_s, Some(broken))
            }
        };
        How { kind, t_s, end_s: setup.time.end_s, sentence: ending_sentence(setup, ending), breakdown }
    }

    /// The ending again; nothing when `setup` has no signal of the name that broke down. `recording` is that of the run.
    pub(crate) fn restore(&self, setup: &Setup, recording: &Recording) -> Option<Ending> {
        let t_s = self.t_s;
        Some(match (self.kind, &self.breakdown) {
            (EndingKind::Completed, _) => Ending::Completed,
            (EndingKind::Interrupted, _) => Ending::Interrupted { t_s },
            (EndingKind::CutOff, _) => Ending::CutOff { t_s },
            (EndingKind::BrokeDown, None) => return None,
            (EndingKind::BrokeDown, Some(BrokenSignal { agent, column, cause })) => {
                let is_it = |signal, axis| names::column_name(setup, *agent, signal, axis) == *column;
                let recorded = recording.columns.iter().find(|c| c.agent == *agent && is_it(c.signal, c.axis));
                let (signal, axis) = match recorded {
                    Some(column) => (column.signal, column.axis),
                    // What a law from outside does not show is in no table.
                    None => (state_entries(setup).ok()?.into_iter())
                        .find(|(of, signal, axis)| of == agent && is_it(*signal, *axis))
                        .map(|(_, signal, axis)| (signal, axis))?,
                };
                let cause = match *cause {
                    Cause::NotFinite => BreakdownCause::NotFinite,
                    Cause::StepUnderFloor { step_s, stiffness } => {
                        BreakdownCause::StepUnderFloor { step_s, stiffness: stiffness.map(Rates::restore) }
                    }
                    Cause::MemoryFull { step_s, need_bytes, stiffness } => {
                        BreakdownCause::MemoryFull { step_s, need_bytes, stiffness: stiffness.map(Rates::restore) }
                    }
                    Cause::Delay { delay, at_s } => BreakdownCause::Delay { delay, at_s },
                    Cause::RanAway { value, steps } => BreakdownCause::RanAway { value, steps },
                    Cause::Vanished { value, floor } => BreakdownCause::Vanished { value, floor },
                    Cause::PositionLimit { value, limits } => {
                        // JSON has no infinity. The table has, and ends with the row that broke the run.
                        let last = recorded.and_then(|column| column.values.last()).copied().unwrap_or(f64::NAN);
                        BreakdownCause::PositionLimit { value: if value.is_finite() { value } else { last }, limits }
                    }
                };
                Ending::BrokeDown(Breakdown { t_s, agent: *agent, signal, axis, cause })
            }
        })
    }
}
