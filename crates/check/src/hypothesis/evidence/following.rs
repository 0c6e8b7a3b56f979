//! Evidence of what follows a leader.

use forwardstep_core::reference::Choice;
use forwardstep_sim::formula::Witness;

use crate::hypothesis::{Answer, Named, Rigour};

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
        /// When it certainly reaches γ, and its value then.
        reached: Option<Witness>,
        /// Whether it exceeds every bound.
        unbounded: bool,
        /// The end of the run, s.
        end_s: f64,
    },
    /// γ beside what drives an agent that leads, which only the run knows.
    GainOverAgent {
        /// γ.
        gamma: f64,
    },
    /// γ beside what drives an agent that leads where it keeps to a target, again and again.
    GainOverTarget {
        /// γ.
        gamma: f64,
        /// Who leads.
        leader: Named,
        /// When its target reaches γ, and its value then.
        reached: Witness,
        /// The largest value seen by sampling it.
        seen: f64,
        /// Whether nothing keeps it from its target for good.
        arrives: bool,
    },
    /// How a value of the sign is chosen.
    Sign {
        /// How.
        choice: Choice,
        /// Whether sampled controllers do it, at every sample.
        sampled: bool,
        /// Whether it reads motions that show what it did only later: torques come late, or velocities are filtered.
        lags: bool,
        /// How often, s.
        period_s: f64,
        /// How fast q_i − q_0 follows what the sign brings to zero: α of (110), else the mean of the two roots, 1/s;
        /// larger for complex ones, whose response swings.
        rate_per_s: f64,
        /// About what stays of q_i − q_0, in units of the axes; infinite where no bound of ξ̇₀ is known, or the sign lags.
        left: f64,
        /// How far a leader whose motion is given moves on this run, or agents start away from it, whichever is more; else infinity.
        scale: f64,
        /// The end of the run, s.
        end_s: f64,
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
        /// A k that is enough; none where no k is, over this graph.
        enough: Option<f64>,
    },
    /// p² + β p + α has no real roots.
    ComplexRoots,
    /// The Laplacian is not constant, since the graph switches.
    GraphSwitches,
    /// The Laplacian is not constant, since a weight varies.
    WeightVaries,
}

/// A sign is called set-valued up to this period, as a part of the time in which q_i − q_0 follows it: what stays is about this
/// part of the largest excursion that a leader can make at the same ξ̇₀.
pub(in crate::hypothesis) const MOST_HELD: f64 = 0.01;
/// Nor where what stays is more than this part of how far the leader moves, or agents start away from it.
pub(in crate::hypothesis) const MOST_LEFT: f64 = 0.01;

impl FollowingEvidence {
    pub(in crate::hypothesis) fn answer(&self) -> Answer {
        match self {
            FollowingEvidence::Gain { reached: Some(_), .. } | FollowingEvidence::Gain { unbounded: true, .. } => {
                Answer::Violated
            }
            FollowingEvidence::Gain { gamma, for_ever, .. } if for_ever < gamma => Answer::Holds,
            FollowingEvidence::Gain { .. } => Answer::NotShown,
            FollowingEvidence::GainOverAgent { .. } => Answer::Watched,
            // It has no witness: it fails once the leader has arrived, which is promised and not shown.
            FollowingEvidence::GainOverTarget { .. } => Answer::NotShown,
            FollowingEvidence::Sign { choice, lags, period_s, rate_per_s, left, scale, end_s, .. } => match choice {
                Choice::Implicit if *lags => Answer::NotCovered,
                Choice::Implicit if period_s * rate_per_s > MOST_HELD || period_s >= end_s => Answer::NotCovered,
                // Where no bound is known nothing is shown of the gain either.
                Choice::Implicit if left.is_finite() && *left > MOST_LEFT * scale => Answer::NotCovered,
                Choice::Implicit => Answer::Holds,
                Choice::Explicit | Choice::Layer { .. } => Answer::NotCovered,
            },
            FollowingEvidence::Shared { .. } | FollowingEvidence::CouplingExceeds { .. } => Answer::Holds,
            FollowingEvidence::CouplingNotShown { .. } | FollowingEvidence::ComplexRoots => Answer::NotShown,
            FollowingEvidence::NotPrinted | FollowingEvidence::GraphSwitches | FollowingEvidence::WeightVaries => {
                Answer::NotCovered
            }
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            FollowingEvidence::Gain { .. } => match self.answer() {
                Answer::Holds | Answer::Violated => Rigour::Enclosed,
                Answer::HoldsOnHorizon | Answer::NotShown | Answer::NotCovered | Answer::Watched => Rigour::Sampled,
            },
            FollowingEvidence::GainOverAgent { .. } => Rigour::Watched,
            FollowingEvidence::GainOverTarget { .. } | FollowingEvidence::CouplingExceeds { .. } => Rigour::Enclosed,
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
