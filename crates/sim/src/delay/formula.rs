//! A delay that is a formula in t, shown not to be negative up to the end of the run.

use forwardstep_core::expression::Interval;

use super::{Arrivals, Basis, DelayFunction, DelayPiece, Known, Unknown};
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

    /// On a bounded time a continuous formula is uniformly continuous; for ever it may swing faster and faster.
    fn known(&self) -> Known {
        let (on_run, for_ever) = (self.within(), self.for_ever());
        let enclosed = Known {
            until_s: Some(self.until_s()),
            basis: Basis::Enclosure,
            ..Known::by_rule([on_run.low, on_run.high])
        };
        if !(for_ever.low >= 0.0 && for_ever.high.is_finite()) {
            Known { unknown: Some(Unknown::FormulaBound), ..enclosed }
        } else if !self.formula().is_uniformly_continuous() {
            Known { unknown: Some(Unknown::FormulaContinuity), ..enclosed }
        } else {
            Known { bound_s: for_ever.high, ..enclosed }
        }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.enclosed(|[low, high]| self.formula().enclose(Interval { low, high }));
    }
}
