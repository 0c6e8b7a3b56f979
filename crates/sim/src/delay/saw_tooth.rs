//! A delay that rises and drops.

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::{LARGEST, MOST_EVENTS, QuantityError, at_most, few, not_negative, positive, within};

/// T = min + (max − min) · frac((t + offset) / period): rises, then drops. A slope of one is a packet held until the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SawTooth {
    /// In s.
    pub min_s: f64,
    /// In s.
    pub max_s: f64,
    /// In s.
    pub period_s: f64,
    /// In s.
    pub offset_s: f64,
}

impl SawTooth {
    /// Where a piece begins; piece 0 holds t = 0.
    fn start_s(&self, index: u64) -> f64 {
        ((self.offset_s / self.period_s).floor() + index as f64) * self.period_s - self.offset_s
    }
}

impl DelayFunction for SawTooth {
    fn words(&self) -> &'static str {
        "a saw-tooth"
    }

    fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
        not_negative("", "min_s", self.min_s)?;
        not_negative("", "max_s", self.max_s)?;
        at_most("", "min_s", self.min_s, ("max_s", self.max_s))?;
        positive("", "period_s", self.period_s)?;
        within("", "offset_s", self.offset_s, -LARGEST, LARGEST)?;
        few("", "period_s", self.period_s, ("jumps of the delay", end_s / self.period_s, MOST_EVENTS))
    }

    fn piece(&self, index: u64) -> DelayPiece {
        DelayPiece::new(index, self.start_s(index), self.start_s(index + 1))
    }

    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
        let SawTooth { min_s, max_s, period_s, .. } = *self;
        libm::fma((max_s - min_s) / period_s, t_s - piece.start_s, min_s).clamp(min_s, max_s)
    }

    fn known(&self) -> Known {
        Known::by_rule([self.min_s, self.max_s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}
