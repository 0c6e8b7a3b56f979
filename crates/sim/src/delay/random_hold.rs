//! Delays drawn at random, each held for a time drawn at random.

use rand::Rng;

use super::packets::{Drawn, Kind, stream};
use super::{Arrivals, DelayFunction, DelayPiece, HoldLog, Known};
use crate::quantity::{Path, QuantityError, at_most, each, not_negative, positive};

/// A delay that takes a new value, each equally likely, after times of which each is equally likely.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomHold {
    /// Least and largest value, s.
    value_s: [f64; 2],
    hold_s: [f64; 2],
    drawn: HoldLog,
}

impl RandomHold {
    /// Draws the delay of the edge between two agents (from, to) up to `until_s`: values from `value_s`, held for times
    /// from `hold_s`. Every ordered pair of agents has its own stream of random numbers.
    ///
    /// # Errors
    /// [`QuantityError`] of [`check`](Self::check), and when there would be more values than fit into memory.
    pub fn draw(
        seed: u64,
        (from, to): (usize, usize),
        value_s: [f64; 2],
        hold_s: [f64; 2],
        until_s: f64,
    ) -> Result<Self, QuantityError> {
        RandomHold::check(value_s, hold_s)?;
        // As many as there are on average.
        Drawn::default().add("jumps of the delay", 2.0 * until_s / (hold_s[0] + hold_s[1]))?;
        let mut draw = stream(Kind::Holds, seed, from, to);
        let mut between = |[low, high]: [f64; 2]| {
            let share: f64 = draw.random();
            // Rounding must not lead outside.
            (low + share * (high - low)).clamp(low, high)
        };
        let (mut times_s, mut values_s) = (Vec::new(), Vec::new());
        let mut t_s = 0.0;
        loop {
            let value = between(value_s);
            let next = t_s + between(hold_s);
            // A hold so short that it is lost to rounding is over at once.
            if next > t_s {
                times_s.push(t_s);
                values_s.push(value);
            }
            if next > until_s {
                break;
            }
            t_s = next;
        }
        Ok(RandomHold { value_s, hold_s, drawn: HoldLog { times_s, values_s, until_s } })
    }

    /// Checks what [`draw`](Self::draw) is given.
    ///
    /// # Errors
    /// [`QuantityError`] when a value is negative, a hold is not positive, or a pair falls.
    pub fn check(value_s: [f64; 2], hold_s: [f64; 2]) -> Result<(), QuantityError> {
        each("", "value_s", &value_s, not_negative)?;
        at_most(Path::from("value_s").index(0), "", value_s[0], ("the largest", value_s[1]))?;
        each("", "hold_s", &hold_s, positive)?;
        at_most(Path::from("hold_s").index(0), "", hold_s[0], ("the longest", hold_s[1]))
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
        &self.drawn.times_s
    }

    /// The values, s.
    pub fn values_s(&self) -> &[f64] {
        &self.drawn.values_s
    }

    /// Until when they are drawn, s.
    pub fn until_s(&self) -> f64 {
        self.drawn.until_s
    }
}

impl DelayFunction for RandomHold {
    fn words(&self) -> &'static str {
        "a random hold"
    }

    /// It is made by a function that checks.
    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, index: u64) -> DelayPiece {
        self.drawn.piece(index)
    }

    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
        self.drawn.value(piece, t_s)
    }

    /// Its values are drawn between two bounds, for ever.
    fn known(&self) -> Known {
        Known { until_s: Some(self.drawn.until_s), ..Known::by_rule(self.value_s) }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        self.drawn.arrivals(search);
    }
}
