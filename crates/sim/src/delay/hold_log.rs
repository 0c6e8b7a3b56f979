//! Delays replayed from a table: values, each held until the next begins.

use super::{Arrivals, Basis, DelayFunction, DelayPiece, Known, Unknown};
use crate::quantity::{
    LARGEST, Path, QuantityError, as_many, at_least, each, filled, more_than, not_negative, such, within,
};

/// T = `values_s[k]` from `times_s[k]` until the next time, as it was drawn or measured up to `until_s`.
#[derive(Clone, Debug, PartialEq)]
pub struct HoldLog {
    /// Rising, the first is zero, s.
    pub times_s: Vec<f64>,
    /// As many values, s.
    pub values_s: Vec<f64>,
    /// The end of the last of them, s.
    pub until_s: f64,
}

impl HoldLog {
    fn clamped(&self, index: u64) -> usize {
        (index as usize).min(self.times_s.len() - 1)
    }
}

impl DelayFunction for HoldLog {
    fn words(&self) -> &'static str {
        "a log of held values"
    }

    fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
        let HoldLog { times_s, values_s, until_s } = self;
        filled("", "times_s", times_s)?;
        each("", "times_s", times_s, |at, key, time_s| within(at, key, time_s, -LARGEST, LARGEST))?;
        such(times_s[0] == 0.0, Path::from("times_s").index(0), "", times_s[0], "must begin at 0")?;
        for (k, pair) in times_s.windows(2).enumerate() {
            more_than(Path::from("times_s").index(k + 1), "", pair[1], ("the one before", pair[0]))?;
        }
        as_many("", "values_s", values_s, ("times_s", times_s.len()))?;
        each("", "values_s", values_s, not_negative)?;
        more_than("", "until_s", *until_s, ("the last time", times_s[times_s.len() - 1]))?;
        at_least("", "until_s", *until_s, ("the end of the run", end_s))
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let k = self.clamped(index);
        DelayPiece::new(index, self.times_s[k], self.times_s.get(k + 1).copied().unwrap_or(f64::INFINITY))
    }

    fn value(&self, piece: &DelayPiece, _: f64) -> f64 {
        self.values_s[self.clamped(piece.index)]
    }

    /// Its values say nothing about later ones.
    fn known(&self) -> Known {
        let values = || self.values_s.iter().copied();
        Known {
            until_s: Some(self.until_s),
            unknown: Some(Unknown::LaterHolds),
            basis: Basis::Numbers,
            ..Known::by_rule([values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max)])
        }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}
