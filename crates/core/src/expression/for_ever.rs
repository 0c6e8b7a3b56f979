//! What an expression in one variable does on [0, ∞): bounds from both sides, each of them a proof.
//!
//! A period is enough where there is one. Else [0, T] is cut until bounds are tight, and from T on [`Tails`] has them.

use super::bounds::weighted_interval;
use super::interval::Interval;
use super::jet::{Taylor, times_factorial};
use super::tail::{Series, Tails};
use super::{Algebra, Binary, Branching, Expression};

/// Times from which on tails are looked at, and until which stretches are cut.
const STARTS: [f64; 3] = [16.0, 1024.0, 1_048_576.0];
/// Values that are looked at, evenly spread at first, then as a geometric series up to the last start.
const LOOKS: u32 = 128;
/// Bounds this close to what is reached are close enough, as a part of the range.
const CLOSE: f64 = 1e-3;

/// What an expression does on [0, ∞).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForEver {
    /// It never leaves this; everything where no bound could be shown.
    pub within: Interval,
    /// Its infimum is `low` at most, its supremum is `high` at least. Infinite where it is shown to be unbounded; the wrong way
    /// round, with infinite ends, where no value is known.
    pub reaches: Interval,
    /// Whether it is shown to be uniformly continuous.
    pub uniform: bool,
}

impl ForEver {
    /// Whether it is shown to leave every bound.
    pub fn is_unbounded(&self) -> bool {
        self.reaches.low == f64::NEG_INFINITY || self.reaches.high == f64::INFINITY
    }
}

impl Expression {
    /// What it does on [0, ∞), as exact arithmetic would evaluate it.
    pub fn for_ever(&self) -> ForEver {
        let mut found = self.combination_for_ever(&[1.0, 0.0, 0.0, 0.0, 0.0]);
        found.uniform = found.within.is_finite() && (self.is_uniformly_continuous() || self.has_steady_tail());
        found
    }

    /// The same of Σₖ `weights[k]` · (k-th derivative); nothing is claimed about its continuity.
    pub fn combination_for_ever(&self, weights: &[f64]) -> ForEver {
        let value_alone = weights.first() == Some(&1.0) && has_value_only(weights);
        let bounds = |to: f64| match value_alone {
            true => self.bounds(0.0, to),
            false => self.bounds_of_derivatives(weights, 0.0, to),
        };
        let mut found = ForEver { within: bounds(f64::INFINITY), reaches: self.seen(weights), uniform: false };
        let period = self.period();
        if let Some(period) = period {
            found.within = found.within.and(bounds(period)).or_whole();
        }
        for from in STARTS {
            let tail = self.tail(weights, from);
            let comes_back = tail.comes_back_to();
            found.reaches.low = found.reaches.low.min(comes_back.low);
            found.reaches.high = found.reaches.high.max(comes_back.high);
            if found.is_unbounded() || found.is_tight() || period.is_some() {
                break;
            }
            if tail.is_known() {
                found.within = found.within.and(tail.range().hull(bounds(from)).or_whole()).or_whole();
            }
            if found.is_tight() {
                break;
            }
        }
        found
    }

    /// From a time on it has a limit, or a bounded slope. Before, it is continuous on a bounded stretch.
    fn has_steady_tail(&self) -> bool {
        STARTS.iter().any(|from| {
            let settles = self.fold(&mut Tails { from: *from }).settles();
            settles || self.tail(&[0.0, 1.0, 0.0, 0.0, 0.0], *from).is_bounded()
        })
    }

    fn tail(&self, weights: &[f64], from: f64) -> Series {
        let mut tails = Tails { from };
        if has_value_only(weights) {
            let value = self.fold(&mut tails);
            let factor = weights.first().copied().unwrap_or(0.0);
            let weight = tails.number(&factor.into());
            return if factor == 1.0 { value } else { tails.binary(Binary::Multiply, weight, value) };
        }
        match weights.len() {
            0..=5 => self.tail_of_derivatives::<5>(weights, tails),
            6..=17 => self.tail_of_derivatives::<17>(weights, tails),
            18..=33 => self.tail_of_derivatives::<33>(weights, tails),
            // The lists of series would fill a stack.
            _ => tails.unknown(),
        }
    }

    fn tail_of_derivatives<const N: usize>(&self, weights: &[f64], tails: Tails) -> Series {
        let mut taylor = Taylor::<Tails, N>(tails);
        let jet = self.fold(&mut taylor);
        let mut tails = taylor.0;
        if !jet[0].is_known() {
            // Without a value there is no derivative either.
            return jet[0];
        }
        let used = weights.iter().zip(jet).enumerate().filter(|(_, (weight, _))| **weight != 0.0);
        used.fold(tails.number(&0.0.into()), |sum, (k, (weight, c))| {
            let weight = tails.number(&(*weight).into());
            let weight = times_factorial(&mut tails, weight, k);
            let term = tails.binary(Binary::Multiply, weight, c);
            tails.binary(Binary::Add, sum, term)
        })
    }

    /// Between which values it is seen, by enclosures at single points.
    fn seen(&self, weights: &[f64]) -> Interval {
        let last = STARTS[STARTS.len() - 1];
        let even = (0..=LOOKS).map(|k| f64::from(k) * STARTS[0] / f64::from(LOOKS));
        let far = (1..=LOOKS).map(|k| STARTS[0] * libm::pow(last / STARTS[0], f64::from(k) / f64::from(LOOKS)));
        let mut seen = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for at in even.chain(far) {
            let value = self.enclose_combination(weights, at);
            if value.is_finite() {
                seen = Interval { low: seen.low.min(value.high), high: seen.high.max(value.low) };
            }
        }
        seen
    }

    /// An interval that holds Σₖ `weights[k]` · (k-th derivative) at one point; everything where it may have no value.
    pub fn enclose_combination(&self, weights: &[f64], at: f64) -> Interval {
        let point = Interval::point(at);
        match has_value_only(weights) {
            true => weighted_interval(weights, &[self.enclose(point)]),
            false => self.enclose_weighted(weights, point),
        }
    }
}

/// Whether no derivative has a weight.
fn has_value_only(weights: &[f64]) -> bool {
    weights.iter().skip(1).all(|weight| *weight == 0.0)
}

impl ForEver {
    /// Whether bounds are about what is reached.
    fn is_tight(&self) -> bool {
        let (within, reaches) = (self.within, self.reaches);
        let close = CLOSE * (reaches.high - reaches.low);
        within.is_finite() && reaches.low - within.low <= close && within.high - reaches.high <= close
    }
}
