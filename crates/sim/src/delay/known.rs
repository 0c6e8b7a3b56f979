//! What is known of a delay: on the run that is computed, and beyond it, as evidence for a theorem that wants delays bounded
//! for ever.
//!
//! Every kind answers for itself. What a kind from outside answers is declared by its author, whatever it says.
//! A link that holds packets has T = t − s between arrivals: slope one on every piece, one modulus of continuity for all
//! of them.

use crate::formula::Witness;

/// Bounds of a delay, how far they reach and what they rest on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// The least and the largest value until [`until_s`](Self::until_s), s.
    pub within_s: [f64; 2],
    /// Until when T is known, s; `None` for ever.
    pub until_s: Option<f64>,
    /// T does not exceed this for ever, or up to the end of the run if there is something `unknown`, s.
    pub bound_s: f64,
    /// Why the bound, or the uniform continuity of T, is known up to the end of the run only; `None` when it is for ever.
    pub unknown: Option<Unknown>,
    /// What the bound rests on.
    pub basis: Basis,
    /// What shows that T is no delay that is bounded for ever.
    pub refuted: Option<Refuted>,
    /// Whether T grows like t from one jump to the next, since the newest packet is held.
    pub holds_packets: bool,
}

/// What is not known of a delay beyond the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Interval arithmetic bounds a formula for all time, but does not tell that it stays above zero.
    FormulaSign,
    /// Interval arithmetic found no bound of a formula for all time.
    FormulaBound,
    /// The same, and no end of it is shown to be uniformly continuous.
    FormulaSteep,
    /// A formula may change faster and faster.
    FormulaContinuity,
    /// Any number of packets may be lost one after another.
    PacketsInARow,
    /// Packets are replayed from a log.
    LaterPackets,
    /// Values are replayed from a log.
    LaterHolds,
    /// No packet that was drawn or logged arrives until the end of the run.
    NothingArrived,
}

/// Why a delay is not one that is bounded for ever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refuted {
    /// It exceeds every bound.
    Unbounded {
        /// A value beyond all of the run.
        witness: Option<Witness>,
        /// Whether an end of it is not shown to make it uniformly continuous, since its slope may have no bound either.
        steep: bool,
    },
    /// It becomes negative after the run: messages from the future.
    Negative(Option<Witness>),
    /// A link loses every packet.
    EveryPacketLost,
}

/// What a bound rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// The parameters of a rule that every value obeys.
    Rule,
    /// Interval arithmetic.
    Enclosure,
    /// The numbers that were drawn or logged for this run.
    Numbers,
    /// What its author says.
    Declared,
}

/// How far a value may be outside its declared bounds by rounding, as a part of the largest.
const ROUNDING: f64 = 1e-9;

impl Known {
    /// What the author of a delay answers for: all of its values, for ever, are between these, in s.
    pub fn declared(within_s: [f64; 2]) -> Known {
        Known { basis: Basis::Declared, ..Known::by_rule(within_s) }
    }

    /// What follows from the parameters of a rule.
    pub(super) fn by_rule(within_s: [f64; 2]) -> Known {
        let bound_s = within_s[1];
        Known {
            within_s,
            until_s: None,
            bound_s,
            unknown: None,
            basis: Basis::Rule,
            refuted: None,
            holds_packets: false,
        }
    }

    /// The value if it is within the bounds, taken to the bound where only rounding leads outside, else not a number.
    pub(super) fn confirmed(&self, value_s: f64) -> f64 {
        let [low, high] = self.within_s;
        let slack = ROUNDING * high;
        // Not f64::clamp, which wants bounds that bound something.
        if value_s >= low - slack && value_s <= high + slack { value_s.max(low).min(high) } else { f64::NAN }
    }
}
