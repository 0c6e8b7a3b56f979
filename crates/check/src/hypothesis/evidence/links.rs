//! Evidence of delays, weights and couplings.

use forwardstep_sim::delay::{Basis, DelayFault, Refuted, Unknown};
use forwardstep_sim::formula::Witness;

use crate::hypothesis::{Answer, Rigour};

/// What was found of the links.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkEvidence {
    /// How long delays can be.
    Delays {
        /// None is longer, s.
        bound_s: f64,
        /// No message becomes older on the run, of links whose packets are known no longer than that, s; zero where there are none.
        oldest_s: f64,
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
    /// A delay is not bounded for ever, or is none.
    RefutedBound(Refuted),
    /// How old messages become, and how old they may be.
    Ages {
        /// None is known to become older, s; `None` where that is not known.
        bound_s: Option<f64>,
        /// Whether that is not above the time-out, in exact arithmetic.
        in_time: bool,
        /// The time-out, s.
        timeout_s: f64,
        /// What the bound rests on, the weakest if there are several.
        basis: Basis,
        /// A link over which all that is heard is older.
        too_old: Option<TooOld>,
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
    /// A weight is not bounded, or not away from zero, for ever.
    RefutedWeight {
        /// How.
        fault: WeightFault,
        /// A value of it that shows it, if one was found.
        witness: Option<Witness>,
    },
    /// No weight changes with time.
    ConstantWeights,
    /// A weight changes with time, where a law is realised by its integral.
    VaryingWeights {
        /// None is smaller.
        low: f64,
        /// None is larger.
        high: f64,
        /// Whether that matters for how far agents stay behind alone.
        lags: bool,
    },
    /// A nonlinear coupling out of the list, all of which are odd, continuous and in the sector.
    Coupling {
        /// The limit or scale, in the units of the axes.
        size: f64,
    },
}

/// A link that is there again and again and over which nothing that is heard counts.
#[derive(Clone, Debug, PartialEq)]
pub struct TooOld {
    /// Name of the sender.
    pub from: String,
    /// Name of the receiver.
    pub to: String,
    /// Nothing is younger, s.
    pub least_s: f64,
}

/// What a weight does that it must not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightFault {
    /// It tends to zero, or comes to it.
    Fades,
    /// It becomes negative.
    Negative,
    /// It exceeds every bound.
    Grows,
}

/// Whether more can be known of a delay than the run shows.
fn beyond_the_run(unknown: Unknown) -> bool {
    match unknown {
        Unknown::FormulaSign
        | Unknown::FormulaBound
        | Unknown::FormulaSteep
        | Unknown::FormulaContinuity
        | Unknown::NothingArrived => true,
        Unknown::PacketsInARow | Unknown::LaterPackets | Unknown::LaterHolds => false,
    }
}

impl LinkEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            LinkEvidence::Delays { basis: Basis::Declared, .. } => Answer::NotShown,
            LinkEvidence::RefutedDelay { .. } | LinkEvidence::RefutedBound(_) | LinkEvidence::RefutedWeight { .. } => {
                Answer::Violated
            }
            LinkEvidence::Ages { too_old: Some(_), .. } => Answer::Violated,
            LinkEvidence::Delays { unknown, .. } if unknown.is_empty() => Answer::Holds,
            LinkEvidence::Delays { unknown, .. } if unknown.iter().any(|one| beyond_the_run(*one)) => Answer::NotShown,
            // An age as large as the run is bounded by that alone.
            LinkEvidence::Delays { oldest_s, end_s, .. } if 2.0 * oldest_s > *end_s => Answer::NotShown,
            LinkEvidence::Delays { .. } => Answer::HoldsOnHorizon,
            LinkEvidence::Weights { until_s: None, .. } => Answer::Holds,
            LinkEvidence::Weights { until_s: Some(_), .. } => Answer::NotShown,
            LinkEvidence::Ages { in_time: true, .. } => Answer::Holds,
            LinkEvidence::Ages { .. } => Answer::NotShown,
            LinkEvidence::Prompt | LinkEvidence::Coupling { .. } | LinkEvidence::ConstantWeights => Answer::Holds,
            LinkEvidence::Late { .. } | LinkEvidence::VaryingWeights { .. } => Answer::NotCovered,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            LinkEvidence::Ages { too_old: Some(_), .. } => Rigour::Exact,
            LinkEvidence::Delays { basis, .. } | LinkEvidence::Ages { basis, .. } => match basis {
                Basis::Rule => Rigour::Exact,
                Basis::Enclosure => Rigour::Enclosed,
                Basis::Numbers => Rigour::Given,
                Basis::Declared => Rigour::Declared,
            },
            LinkEvidence::RefutedDelay { .. } => Rigour::Sampled,
            LinkEvidence::RefutedBound(Refuted::EveryPacketLost) => Rigour::Exact,
            LinkEvidence::RefutedBound(Refuted::Unbounded { .. } | Refuted::Negative(_))
            | LinkEvidence::RefutedWeight { .. }
            | LinkEvidence::VaryingWeights { .. }
            | LinkEvidence::Weights { .. } => Rigour::Enclosed,
            LinkEvidence::ConstantWeights => Rigour::Exact,
            LinkEvidence::Prompt | LinkEvidence::Late { .. } | LinkEvidence::Coupling { .. } => Rigour::Exact,
        }
    }
}
