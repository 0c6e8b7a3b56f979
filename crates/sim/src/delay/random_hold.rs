//! Delays drawn at random, each held for a time drawn at random.

use rand::Rng;

use super::packets::{Kind, PacketError, stream};
use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::QuantityError;

/// Values that one delay may take one after another.
const MOST_VALUES: usize = 100_000_000;

/// A delay that takes a new value, each equally likely, after times of which each is equally likely.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomHold {
    /// Least and largest value, s.
    value_s: [f64; 2],
    hold_s: [f64; 2],
    until_s: f64,
    times_s: Vec<f64>,
    values_s: Vec<f64>,
}

impl RandomHold {
    /// Draws the delay of the edge between two agents (from, to) up to `until_s`: values from `value_s`, held for times
    /// from `hold_s`. Every ordered pair of agents has its own stream of random numbers.
    ///
    /// # Errors
    /// [`PacketError`] when a bound is negative or not finite, a shortest hold is not positive, a pair falls, or there are
    /// more values than any memory holds.
    pub fn draw(
        seed: u64,
        (from, to): (usize, usize),
        value_s: [f64; 2],
        hold_s: [f64; 2],
        until_s: f64,
    ) -> Result<Self, PacketError> {
        let check = |parameter, value: f64, good: bool, requirement| {
            if good && value.is_finite() {
                Ok(())
            } else {
                Err(PacketError::Parameter { parameter, value, requirement })
            }
        };
        check("the least delay", value_s[0], value_s[0] >= 0.0, "must be finite and not negative")?;
        check("the largest delay", value_s[1], value_s[1] >= value_s[0], "must not be below the least")?;
        check("the shortest hold", hold_s[0], hold_s[0] > 0.0, "must be positive and finite")?;
        check("the longest hold", hold_s[1], hold_s[1] >= hold_s[0], "must not be below the shortest")?;
        let too_many = || PacketError::TooManyValues { most: MOST_VALUES };
        // Too many even if every hold were the longest.
        if until_s / hold_s[1] > MOST_VALUES as f64 {
            return Err(too_many());
        }
        let mut draw = stream(Kind::Holds, seed, from, to);
        let mut between = |[low, high]: [f64; 2]| {
            let share: f64 = draw.random();
            // Rounding must not lead outside.
            (low + share * (high - low)).clamp(low, high)
        };
        let (mut times_s, mut values_s) = (Vec::new(), Vec::new());
        let (mut t_s, mut drawn) = (0.0, 0);
        loop {
            drawn += 1;
            if drawn > MOST_VALUES {
                return Err(too_many());
            }
            let value = between(value_s);
            let next = t_s + between(hold_s);
            // A hold so short that it is lost to rounding is over at once.
            if next > t_s {
                times_s.push(t_s);
                values_s.push(value);
            }
            if next > until_s || until_s.is_nan() {
                break;
            }
            t_s = next;
        }
        Ok(RandomHold { value_s, hold_s, until_s, times_s, values_s })
    }

    /// Least and largest value, s.
    pub fn value_s(&self) -> [f64; 2] {
        self.value_s
    }

    /// Shortest and longest hold, s.
    pub fn hold_s(&self) -> [f64; 2] {
        self.hold_s
    }

    /// When each value begins, s.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn clamped(&self, index: u64) -> usize {
        (index as usize).min(self.times_s.len() - 1)
    }
}

impl DelayFunction for RandomHold {
    fn words(&self) -> &'static str {
        "a random hold"
    }

    /// It is made by a function that checks.
    fn validate(&self) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let k = self.clamped(index);
        DelayPiece::new(index, self.times_s[k], self.times_s.get(k + 1).copied().unwrap_or(f64::INFINITY))
    }

    fn value(&self, piece: &DelayPiece, _: f64) -> f64 {
        self.values_s[self.clamped(piece.index)]
    }

    /// Its values are drawn between two bounds, for ever.
    fn known(&self) -> Known {
        Known { until_s: Some(self.until_s), ..Known::by_rule(self.value_s) }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}
