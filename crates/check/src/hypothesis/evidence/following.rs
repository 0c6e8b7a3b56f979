//! Evidence of what follows a leader.

use forwardstep_core::reference::Choice;

use crate::hypothesis::{Answer, Rigour};

/// What was found of the design that follows a leader.
#[derive(Clone, Debug, PartialEq)]
pub enum FollowingEvidence {
    /// γ beside what it must exceed.
    Gain {
        /// γ.
        gamma: f64,
        /// The largest value seen by sampling the run.
        seen: f64,
        /// A bound up to the end of the run; infinite where none was found.
        on_run: f64,
        /// A bound for ever; infinite where none was found.
        for_ever: f64,
        /// The end of the run, s.
        end_s: f64,
    },
    /// γ beside what drives an agent that leads, which only the run knows.
    GainOverAgent {
        /// γ.
        gamma: f64,
    },
    /// How a value of the sign is chosen.
    Sign {
        /// How.
        choice: Choice,
        /// How often, s; `None` at every sample.
        period_s: Option<f64>,
    },
    /// α, β and γ belong to the design.
    Shared {
        /// Whether (119) starts from estimates of zero, from which it converges slowly.
        slow: bool,
    },
    /// The paper names the design and does not print it.
    NotPrinted,
    /// k λ exceeds this.
    CouplingExceeds {
        /// The bound.
        least: f64,
    },
    /// k λ could not be shown to exceed this.
    CouplingNotShown {
        /// The bound.
        least: f64,
    },
    /// p² + β p + α has no real roots.
    ComplexRoots,
    /// The Laplacian is not constant, since the graph switches.
    GraphSwitches,
    /// The Laplacian is not constant, since a weight varies.
    WeightVaries,
}

impl FollowingEvidence {
    pub(in crate::hypothesis) fn answer(&self) -> Answer {
        match self {
            FollowingEvidence::Gain { gamma, seen, on_run, for_ever, .. } => {
                if seen >= gamma {
                    Answer::Violated
                } else if for_ever < gamma {
                    Answer::Holds
                } else if on_run < gamma {
                    Answer::HoldsOnHorizon
                } else {
                    Answer::NotShown
                }
            }
            FollowingEvidence::GainOverAgent { .. } => Answer::Watched,
            FollowingEvidence::Sign { choice, .. } => match choice {
                Choice::Implicit => Answer::Holds,
                Choice::Explicit | Choice::Layer { .. } => Answer::NotCovered,
            },
            FollowingEvidence::Shared { .. } | FollowingEvidence::CouplingExceeds { .. } => Answer::Holds,
            FollowingEvidence::CouplingNotShown { .. } => Answer::NotShown,
            FollowingEvidence::NotPrinted
            | FollowingEvidence::ComplexRoots
            | FollowingEvidence::GraphSwitches
            | FollowingEvidence::WeightVaries => Answer::NotCovered,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            FollowingEvidence::Gain { .. } => match self.answer() {
                Answer::Holds | Answer::HoldsOnHorizon => Rigour::Enclosed,
                Answer::Violated | Answer::NotShown | Answer::NotCovered | Answer::Watched => Rigour::Sampled,
            },
            FollowingEvidence::GainOverAgent { .. } => Rigour::Watched,
            FollowingEvidence::CouplingExceeds { .. } => Rigour::Enclosed,
            FollowingEvidence::CouplingNotShown { .. } => Rigour::Computed,
            FollowingEvidence::Sign { .. }
            | FollowingEvidence::Shared { .. }
            | FollowingEvidence::NotPrinted
            | FollowingEvidence::ComplexRoots
            | FollowingEvidence::GraphSwitches
            | FollowingEvidence::WeightVaries => Rigour::Exact,
        }
    }
}
