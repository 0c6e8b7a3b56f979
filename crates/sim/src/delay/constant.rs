//! The same delay for ever.

use super::{Arrivals, Delay, DelayFunction, DelayPiece, Known};
use crate::quantity::{QuantityError, not_negative};

/// T = s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    /// In s; may be zero.
    pub s: f64,
}

impl Delay {
    /// T = `s`.
    pub fn constant(s: f64) -> Delay {
        Delay::new(Constant { s })
    }
}

impl DelayFunction for Constant {
    fn words(&self) -> &'static str {
        "a constant delay"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        not_negative("", "constant_s", self.s)
    }

    fn piece(&self, _: u64) -> DelayPiece {
        DelayPiece::WHOLE
    }

    fn value(&self, _: &DelayPiece, _: f64) -> f64 {
        self.s
    }

    fn known(&self) -> Known {
        Known::by_rule([self.s, self.s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.found(search.sent_s() + self.s);
    }
}
