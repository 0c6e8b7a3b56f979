//! Evidence of delays, weights and couplings.

use forwardstep_sim::delay::{Basis, DelayFault, Unknown};

use super::holds;
use crate::hypothesis::{Answer, Rigour};

/// What was found of the links.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkEvidence {
    /// How long delays can be.
    Delays {
        /// None is longer, s.
        bound_s: f64,
        /// Why that, or their uniform continuity, is not known for ever; empty when it is.
        unknown: Vec<Unknown>,
        /// The end of the run, s.
        end_s: f64,
        /// What the bound rests on, the weakest if there are several.
        basis: Basis,
        /// Whether some links hold packets, whose delay grows like t between arrivals.
        holds_packets: bool,
    },
    /// A delay from outside is not what its author says.
    RefutedDelay {
        /// What it is called.
        words: &'static str,
        /// What was found.
        fault: DelayFault,
    },
    /// How old messages become, and how old they may be.
    Ages {
        /// None is known to become older, s; `None` where that is not known.
        bound_s: Option<f64>,
        /// The time-out, s.
        timeout_s: f64,
        /// What the bound rests on, the weakest if there are several.
        basis: Basis,
    },
    /// No link has a delay.
    Prompt,
    /// Some have, where there must be none.
    Late {
        /// The longest, s.
        bound_s: f64,
    },
    /// Where weights stay.
    Weights {
        /// None is smaller.
        low: f64,
        /// None is larger.
        high: f64,
        /// Until when that is shown, s; `None` for ever.
        until_s: Option<f64>,
        /// Whether they are bounded for ever, so that only their uniform continuity is not known.
        bounded_for_ever: bool,
    },
    /// A nonlinear coupling out of the list, all of which are odd, continuous and in the sector.
    Coupling {
        /// The limit or scale, in the units of the axes.
        size: f64,
    },
}

impl LinkEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            LinkEvidence::Delays { basis: Basis::Declared, .. } => Answer::NotShown,
            LinkEvidence::RefutedDelay { .. } => Answer::Violated,
            LinkEvidence::Delays { unknown, .. } => holds(unknown.is_empty()),
            LinkEvidence::Weights { until_s, .. } => holds(until_s.is_none()),
            LinkEvidence::Ages { bound_s: Some(bound_s), timeout_s, .. } if bound_s <= timeout_s => Answer::Holds,
            LinkEvidence::Ages { .. } => Answer::NotShown,
            LinkEvidence::Prompt | LinkEvidence::Coupling { .. } => Answer::Holds,
            LinkEvidence::Late { .. } => Answer::NotCovered,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            LinkEvidence::Delays { basis, .. } | LinkEvidence::Ages { basis, .. } => match basis {
                Basis::Rule => Rigour::Exact,
                Basis::Enclosure => Rigour::Enclosed,
                Basis::Numbers => Rigour::Given,
                Basis::Declared => Rigour::Declared,
            },
            LinkEvidence::RefutedDelay { .. } => Rigour::Sampled,
            LinkEvidence::Weights { .. } => Rigour::Enclosed,
            LinkEvidence::Prompt | LinkEvidence::Late { .. } | LinkEvidence::Coupling { .. } => Rigour::Exact,
        }
    }
}
