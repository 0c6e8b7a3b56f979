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
    /// Where a piece begins; piece 0 holds t = 0, and more than rounding of what follows.
    fn start_s(&self, index: u64) -> f64 {
        let SawTooth { period_s, offset_s, .. } = *self;
        // Of 0.29 s and 0.01 s the rest is a hundredth less a rounding, and means none.
        let (rest_s, rounding_s) = (offset_s.rem_euclid(period_s), 4.0 * f64::EPSILON * offset_s.abs());
        let rest_s = if rest_s >= period_s - rounding_s { 0.0 } else { rest_s };
        index as f64 * period_s - rest_s
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_the_first_piece_holds_zero_and_more_than_rounding() {
        let shifted = [(0.01, 0.29), (0.17, 2.21), (0.39, 1.17), (0.05, 0.15), (0.5, 1e30), (0.5, -1e30), (0.3, -0.1)];
        for (period_s, offset_s) in shifted {
            let tooth = SawTooth { min_s: 0.1, max_s: 0.2, period_s, offset_s };
            let [first, second] = [0, 1].map(|index| tooth.piece(index));
            assert!(first.start_s <= 0.0 && first.end_s > 1e-3 * period_s, "{tooth:?}: {first:?}");
            assert_eq!(first.end_s, second.start_s);
            assert!((second.end_s - second.start_s - period_s).abs() < 1e-12);
        }
        // Whole periods of a hundredth: T(0) is the least.
        let whole = SawTooth { min_s: 0.1, max_s: 0.2, period_s: 0.01, offset_s: 0.29 };
        assert_eq!(whole.value(&whole.piece(0), 0.0), 0.1);
        let part = SawTooth { min_s: 0.1, max_s: 0.2, period_s: 0.4, offset_s: 0.5 };
        assert!((part.value(&part.piece(0), 0.0) - 0.125).abs() < 1e-15);
    }
}
