//! A delay that jumps from value to value.

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::{
    LARGEST, MOST_EVENTS, Path, QuantityError, as_many, each, few, filled, more_than, not_negative, positive, such,
    within,
};

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

    fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
        let PiecewiseConstant { times_s, values_s, period_s } = self;
        filled("", "times_s", times_s)?;
        each("", "times_s", times_s, |at, key, time_s| within(at, key, time_s, -LARGEST, LARGEST))?;
        such(times_s[0] == 0.0, Path::from("times_s").index(0), "", times_s[0], "must begin at 0")?;
        for (k, pair) in times_s.windows(2).enumerate() {
            more_than(Path::from("times_s").index(k + 1), "", pair[1], ("the one before", pair[0]))?;
        }
        as_many("", "values_s", values_s, ("times_s", times_s.len()))?;
        each("", "values_s", values_s, not_negative)?;
        let Some(period_s) = *period_s else { return Ok(()) };
        positive("", "period_s", period_s)?;
        more_than("", "period_s", period_s, ("the last time", times_s[times_s.len() - 1]))?;
        let jumps = end_s / period_s * times_s.len() as f64;
        few("", "period_s", period_s, ("jumps of the delay", jumps, MOST_EVENTS))
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
