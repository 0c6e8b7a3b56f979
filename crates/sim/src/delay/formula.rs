//! A delay that is a formula in t, shown not to be negative up to the end of the run.

use forwardstep_core::expression::Interval;

use super::{Arrivals, Basis, DelayFunction, DelayPiece, Known, Refuted, Unknown};
use crate::formula::BoundedFormula;
use crate::quantity::{QuantityError, Sign};

impl DelayFunction for BoundedFormula {
    fn words(&self) -> &'static str {
        "a formula"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        self.stays("formula_s", Sign::NotNegative)
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let kinks_s = self.kinks_s();
        let index = index.min(kinks_s.len() as u64);
        let kink_s = |k: u64| kinks_s.get(k as usize).copied();
        let start_s = index.checked_sub(1).and_then(kink_s).unwrap_or(0.0);
        DelayPiece::new(index, start_s, kink_s(index).unwrap_or(f64::INFINITY))
    }

    fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
        self.value(t_s)
    }

    /// On a bounded time a continuous formula is bounded and uniformly continuous; what it does later is asked of all time.
    fn known(&self) -> Known {
        let (on_run, for_ever) = (self.within(), self.for_ever());
        let enclosed = Known {
            until_s: Some(self.until_s()),
            basis: Basis::Enclosure,
            ..Known::by_rule([on_run.low, on_run.high])
        };
        let refuted = if for_ever.reaches.low < 0.0 {
            Some(Refuted::Negative(self.seen_outside(Interval { low: 0.0, high: f64::INFINITY })))
        } else if for_ever.reaches.high == f64::INFINITY {
            // Twice what the run has, so that it cannot be taken for what the run has.
            let twice = 2.0 * on_run.high.max(0.5);
            let witness = self.seen_outside(Interval { low: f64::NEG_INFINITY, high: twice });
            Some(Refuted::Unbounded { witness, steep: self.is_steep(1.0) })
        } else {
            None
        };
        let unknown = if for_ever.within.is_finite() && for_ever.within.low < 0.0 && for_ever.uniform {
            Some(Unknown::FormulaSign)
        } else if !(for_ever.within.low >= 0.0 && for_ever.within.high.is_finite()) {
            Some(if self.is_steep(on_run.high) { Unknown::FormulaSteep } else { Unknown::FormulaBound })
        } else if !for_ever.uniform {
            Some(Unknown::FormulaContinuity)
        } else {
            return Known { bound_s: for_ever.within.high, ..enclosed };
        };
        Known { unknown, refuted, ..enclosed }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.enclosed(|[low, high]| self.formula().enclose(Interval { low, high }));
    }
}

impl BoundedFormula {
    /// Whether an end at `most` is not shown to make it uniformly continuous and bounded.
    fn is_steep(&self, most: f64) -> bool {
        let ended = self.formula().clone().larger(0.0).smaller(most).for_ever();
        !(ended.uniform && ended.within.is_finite())
    }
}
