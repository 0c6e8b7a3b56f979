//! A delay that jumps from value to value.

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::{QuantityError, not_negative, such};

/// T = `values_s[k]` from `times_s[k]` until the next time.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseConstant {
    /// Rising, the first is zero, s.
    pub times_s: Vec<f64>,
    /// As many values, s.
    pub values_s: Vec<f64>,
    /// Repeat after this long, s; more than the last time.
    pub period_s: Option<f64>,
}

impl PiecewiseConstant {
    /// Which repetition and which entry a piece is.
    fn repeat_of(&self, index: u64) -> (u64, usize) {
        let entries = self.times_s.len();
        match self.period_s {
            Some(_) => (index / entries as u64, (index % entries as u64) as usize),
            None => (0, (index as usize).min(entries - 1)),
        }
    }
}

impl DelayFunction for PiecewiseConstant {
    fn words(&self) -> &'static str {
        "a piecewise constant delay"
    }

    fn validate(&self) -> Result<(), QuantityError> {
        let PiecewiseConstant { times_s, values_s, period_s } = self;
        let matched = times_s.len() == values_s.len() && !times_s.is_empty();
        let values = values_s.len() as f64;
        such(matched, "", "the number of values_s", values, "must be that of times_s, and not zero")?;
        values_s.iter().try_for_each(|value| not_negative("", "values_s", *value))?;
        such(times_s[0] == 0.0, "", "times_s", times_s[0], "the first must be zero")?;
        for pair in times_s.windows(2) {
            let later = pair[1] > pair[0] && pair[1].is_finite();
            such(later, "", "times_s", pair[1], "must be finite and later than the one before")?;
        }
        match (period_s, times_s.last()) {
            (Some(period), Some(last)) => {
                let longer = period > last && period.is_finite();
                such(longer, "", "period_s", *period, "must be finite and longer than the last time")
            }
            _ => Ok(()),
        }
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let (repeat, k) = self.repeat_of(index);
        let base = self.period_s.map_or(0.0, |period| repeat as f64 * period);
        let end = self.period_s.map_or(f64::INFINITY, |period| (repeat + 1) as f64 * period);
        DelayPiece::new(index, base + self.times_s[k], self.times_s.get(k + 1).map_or(end, |t| base + t))
    }

    fn value(&self, piece: &DelayPiece, _: f64) -> f64 {
        self.values_s[self.repeat_of(piece.index).1]
    }

    fn known(&self) -> Known {
        let values = || self.values_s.iter().copied();
        Known::by_rule([values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max)])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}
