//! What is known of a delay beyond the run that is computed: evidence for a theorem that wants delays bounded for ever.
//!
//! Every kind answers for itself, and the match has no arm for the rest: a new kind does not compile without an answer.
//! A link that holds packets has T = t − s between arrivals: slope one on every piece, one modulus of continuity for all
//! of them.

use forwardstep_core::expression::Interval;

use super::Delay;
use crate::formula::BoundedFormula;

/// A bound of a delay, how far it reaches and what it rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// T does not exceed this, s.
    pub bound_s: f64,
    /// Why the bound, or the uniform continuity of T, is known up to the end of the run only; `None` when it is for ever.
    pub unknown: Option<Unknown>,
    /// What the bound rests on.
    pub basis: Basis,
    /// Whether T grows like t from one jump to the next, since the newest packet is held.
    pub holds_packets: bool,
}

/// What is not known of a delay beyond the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Interval arithmetic found no bound of a formula for all time.
    FormulaBound,
    /// A formula may change faster and faster.
    FormulaContinuity,
    /// Any number of packets may be lost one after another.
    PacketsInARow,
    /// Packets are replayed from a log.
    LaterPackets,
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
}

impl Delay {
    /// What is known of T beyond the run.
    pub fn known(&self) -> Known {
        let rule = Known { bound_s: self.max_s(), unknown: None, basis: Basis::Rule, holds_packets: false };
        match self {
            Delay::Constant { .. }
            | Delay::Sinusoid { .. }
            | Delay::PiecewiseConstant { .. }
            | Delay::SawTooth { .. } => rule,
            // Its values are drawn between two bounds, for ever.
            Delay::RandomHold(_) => rule,
            Delay::Formula(formula) => of_formula(formula),
            Delay::Packets(trace) => {
                let numbers = |unknown| Known { unknown: Some(unknown), basis: Basis::Numbers, ..rule };
                let known = match trace.link() {
                    Some(link) if link.bound_s().is_finite() => Known { bound_s: link.bound_s(), ..rule },
                    Some(_) => numbers(Unknown::PacketsInARow),
                    None => numbers(Unknown::LaterPackets),
                };
                Known { holds_packets: true, ..known }
            }
        }
    }
}

/// On a bounded time a continuous formula is uniformly continuous; for ever it may swing faster and faster.
fn of_formula(formula: &BoundedFormula) -> Known {
    let Interval { low, high } = formula.for_ever();
    let on_run = |unknown| Known {
        bound_s: formula.within().high,
        unknown: Some(unknown),
        basis: Basis::Enclosure,
        holds_packets: false,
    };
    if !(low >= 0.0 && high.is_finite()) {
        on_run(Unknown::FormulaBound)
    } else if !formula.formula().is_uniformly_continuous() {
        on_run(Unknown::FormulaContinuity)
    } else {
        Known { bound_s: high, unknown: None, basis: Basis::Enclosure, holds_packets: false }
    }
}
