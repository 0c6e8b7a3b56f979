//! A delay that rises and drops.

use forwardstep_core::Scalar;

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::parameter::ParameterError;

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

    fn validate(&self) -> Result<(), ParameterError> {
        ParameterError::unless_positive("the period", self.period_s)?;
        ParameterError::unless_non_negative("the minimum", self.min_s)?;
        ParameterError::unless_non_negative("the maximum", self.max_s)?;
        ParameterError::unless_non_negative("the size of the offset", self.offset_s.abs())?;
        ParameterError::unless(self.max_s >= self.min_s, "the maximum", self.max_s, "must not be below the minimum")
    }

    fn piece(&self, index: u64) -> DelayPiece {
        DelayPiece::new(index, self.start_s(index), self.start_s(index + 1))
    }

    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
        let SawTooth { min_s, max_s, period_s, .. } = *self;
        Scalar::mul_add((max_s - min_s) / period_s, t_s - piece.start_s, min_s).clamp(min_s, max_s)
    }

    fn known(&self) -> Known {
        Known::by_rule([self.min_s, self.max_s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}
