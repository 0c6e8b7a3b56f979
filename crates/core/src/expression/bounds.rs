//! Bounds of an expression in one variable, x, and of its derivatives.

use alloc::collections::BinaryHeap;

use super::exact::Exact;
use super::float::Floats;
use super::interval::{Interval, Intervals};
use super::jet::{MOST_DERIVATIVES, Taylor, times_factorial};
use super::{Algebra, Binary, Branching, Expression, Switch};

/// Evaluations that one search for bounds may cost.
const SEARCH: usize = 2000;
/// Bounds this close to values that are taken are close enough, as a part of the range.
const CLOSE: f64 = 1e-4;

impl Expression {
    /// Whether no variable appears in it.
    pub fn is_constant(&self) -> bool {
        self.variables() == 0
    }

    /// Its value at x; not-a-number or infinite where it has none.
    pub fn eval(&self, x: f64) -> f64 {
        self.value(&[x])
    }

    /// The value and the first four derivatives at x; not-a-number or infinite where there are none.
    pub fn jet(&self, x: f64) -> [f64; 5] {
        let mut jet = [0.0; 5];
        self.derivatives(x, &mut jet);
        jet
    }

    /// The value and as many derivatives at x as `out` has room for; not-a-number or infinite where there are none, and beyond
    /// [`MOST_DERIVATIVES`]. Allocates nothing.
    pub fn derivatives(&self, x: f64, out: &mut [f64]) {
        self.derivatives_over(Floats::new(&[x]), out);
        without_a_value(out);
    }

    /// The same by the branches of |a|, min and max that are active right after `since`: one-sided derivatives where a piece
    /// begins or ends. `switches` is what [`switches`](Self::switches) found.
    pub fn derivatives_on(&self, switches: &[Switch], since: f64, x: f64, out: &mut [f64]) {
        self.derivatives_over(Floats::on_piece(&[x], switches, since), out);
        without_a_value(out);
    }

    /// By the shortest list of coefficients that is long enough.
    fn derivatives_over<A: Branching>(&self, algebra: A, out: &mut [A::Value]) {
        match out.len() {
            0..=5 => self.put::<A, 5>(algebra, out),
            6..=9 => self.put::<A, 9>(algebra, out),
            10..=17 => self.put::<A, 17>(algebra, out),
            18..=33 => self.put::<A, 33>(algebra, out),
            34..=65 => self.put::<A, 65>(algebra, out),
            _ => self.put::<A, { MOST_DERIVATIVES + 1 }>(algebra, out),
        }
    }

    fn put<A: Branching, const N: usize>(&self, algebra: A, out: &mut [A::Value]) {
        let mut taylor = Taylor::<A, N>(algebra);
        let jet = self.fold(&mut taylor);
        out.fill(taylor.0.unknown());
        for (k, (out, c)) in out.iter_mut().zip(jet).enumerate() {
            *out = times_factorial(&mut taylor.0, c, k);
        }
    }

    /// An interval that holds the value at every x in `x`, in one pass; everything where there may be no value.
    pub fn enclose(&self, x: Interval) -> Interval {
        self.fold(&mut Intervals(&[x])).or_whole()
    }

    /// Intervals that hold the value and the first four derivatives, as [`enclose_derivatives`](Self::enclose_derivatives) has them.
    pub fn enclose_jet(&self, x: Interval) -> [Interval; 5] {
        let mut jet = [Interval::WHOLE; 5];
        self.enclose_derivatives(x, &mut jet);
        jet
    }

    /// Intervals that hold the value and as many derivatives as `out` has room for at every x in `x`, in one pass; everything where
    /// nothing better could be shown, so also where a derivative may not exist.
    pub fn enclose_derivatives(&self, x: Interval, out: &mut [Interval]) {
        self.derivatives_over(Intervals(&[x]), out);
        let mut exists = true;
        for within in out {
            // Without a value there is no derivative either, though the rules may give one.
            exists &= within.low <= within.high;
            *within = if exists { within.or_whole() } else { Interval::WHOLE };
        }
    }

    /// An interval that holds every value from `from` to `to`, which may be infinite; everything where nothing better could be
    /// shown, so also where there is no value.
    ///
    /// For an infinite stretch that is what exact arithmetic would give; a number on the way may overflow all the same.
    ///
    /// The interval is narrowed by cutting the stretch until the bounds are close to values that are taken, and by one pass in
    /// rational numbers.
    pub fn bounds(&self, from: f64, to: f64) -> Interval {
        let whole = self.fold(&mut Exact(Interval::new(from, to))).rounded().or_whole();
        if !(to - from).is_finite() {
            return whole;
        }
        let enclose = |from: f64, to: f64| self.enclose_by_slope(&[1.0], Interval::new(from, to));
        search(from, to, CLOSE, enclose, |x| self.eval(x)).and(whole)
    }

    /// Whether it is shown to have a finite value everywhere from `from` to `to`; cheaper than [`bounds`](Self::bounds), since
    /// mostly one look tells.
    pub fn is_bounded(&self, from: f64, to: f64) -> bool {
        self.enclose(Interval::new(from, to)).is_finite() || self.bounds(from, to).is_finite()
    }

    /// An interval that holds Σₖ `weights[k]` · (k-th derivative) from `from` to `to`, which may be infinite; as
    /// [`bounds`](Self::bounds) is for the value.
    pub fn bounds_of_derivatives(&self, weights: &[f64], from: f64, to: f64) -> Interval {
        if !(to - from).is_finite() {
            return self.enclose_weighted(weights, Interval::new(from, to));
        }
        let enclose = |from: f64, to: f64| self.enclose_by_slope(weights, Interval::new(from, to));
        search(from, to, CLOSE, enclose, |x| self.weighted(weights, x))
    }

    /// Σₖ `weights[k]` · (k-th derivative) at x; not-a-number with more weights than [`MOST_DERIVATIVES`] and one.
    pub fn weighted(&self, weights: &[f64], x: f64) -> f64 {
        let mut room = [0.0; MOST_DERIVATIVES + 1];
        let Some(jet) = room.get_mut(..weights.len()) else { return f64::NAN };
        self.derivatives(x, jet);
        weighted(weights, jet)
    }

    /// The same, enclosed.
    pub(super) fn enclose_weighted(&self, weights: &[f64], x: Interval) -> Interval {
        let mut room = [Interval::WHOLE; MOST_DERIVATIVES + 1];
        let Some(jet) = room.get_mut(..weights.len()) else { return Interval::WHOLE };
        self.enclose_derivatives(x, jet);
        weighted_interval(weights, jet)
    }

    /// The same on a bounded stretch, also by the slope: what rises or falls keeps within its ends, and of what does neither the error is
    /// one of the square of the length, where that of one pass is one of the length. Where the pass gives finite bounds, every part has a
    /// value and is continuous.
    fn enclose_by_slope(&self, weights: &[f64], x: Interval) -> Interval {
        let mut room = [Interval::WHOLE; MOST_DERIVATIVES + 1];
        let Some(jet) = room.get_mut(..=weights.len()) else { return self.enclose_weighted(weights, x) };
        self.enclose_derivatives(x, jet);
        let within = weighted_interval(weights, jet);
        let slope = weighted_interval(weights, &jet[1..]);
        if !within.is_finite() {
            return within;
        }
        let at = |x: f64| self.enclose_combination(weights, x);
        let middle = x.low + 0.5 * (x.high - x.low);
        let by_slope = match slope.low >= 0.0 || slope.high <= 0.0 {
            true => at(x.low).hull(at(x.high)),
            false => at(middle) + slope * (x - Interval::point(middle)),
        };
        within.and(by_slope.or_whole())
    }
}

/// Σₖ wₖ · (k-th derivative).
pub fn weighted(weights: &[f64], jet: &[f64]) -> f64 {
    let used = weights.iter().zip(jet).filter(|(weight, _)| **weight != 0.0);
    used.fold(0.0, |sum, (weight, c)| sum + weight * c)
}

pub(super) fn weighted_interval(weights: &[f64], jet: &[Interval]) -> Interval {
    let used = weights.iter().zip(jet).filter(|(weight, _)| **weight != 0.0);
    let mut intervals = Intervals(&[]);
    let sum = used.fold(Interval::point(0.0), |sum, (weight, c)| {
        let term = intervals.binary(Binary::Multiply, Interval::point(*weight), *c);
        intervals.binary(Binary::Add, sum, term)
    });
    sum.or_whole()
}

/// An interval that holds every value from `from` to `to` of what `value` gives and `enclose` bounds on a stretch, close to
/// values that are taken by the part `close` of their range.
pub fn search(
    from: f64,
    to: f64,
    close: f64,
    enclose: impl Fn(f64, f64) -> Interval,
    value: impl Fn(f64) -> f64,
) -> Interval {
    let least = highest(from, to, close, |from, to| -enclose(from, to).low, |x| -value(x));
    let most = highest(from, to, close, |from, to| enclose(from, to).high, value);
    Interval::new(-least, most).or_whole()
}

/// An upper bound: the stretch whose bound is highest is cut until that bound is close to a value that is taken and tells whether
/// all values are negative or zero, or the work is done.
fn highest(from: f64, to: f64, close: f64, bound: impl Fn(f64, f64) -> f64, value: impl Fn(f64) -> f64) -> f64 {
    let mut taken = value(from).max(value(to));
    let mut least = taken;
    let mut stretches = BinaryHeap::new();
    stretches.push(stretch(bound(from, to), from, to));
    let bound_of = |key: i64| f64::from_bits(ordered(key) as u64);
    for _ in 0..SEARCH {
        let Some((key, _, ends)) = stretches.peek().copied() else { break };
        let (highest, [from, to]) = (bound_of(key), ends.map(f64::from_bits));
        let middle = from + 0.5 * (to - from);
        let gap = highest - taken;
        // A sign is known, or has been seen to be none.
        let decided = highest <= 0.0 || taken > 0.0;
        // What has no value somewhere has no gap either.
        if gap.is_nan() || decided && gap <= close * (taken - least) || middle <= from || middle >= to {
            break;
        }
        stretches.pop();
        let value = value(middle);
        taken = taken.max(value);
        least = least.min(value);
        for (from, to) in [(from, middle), (middle, to)] {
            stretches.push(stretch(bound(from, to), from, to));
        }
    }
    stretches.peek().map_or(f64::INFINITY, |stretch| bound_of(stretch.0))
}

/// Without a value there are no derivatives, though the rules may give some.
fn without_a_value(out: &mut [f64]) {
    if out.first().is_some_and(|value| value.is_nan()) {
        out.fill(f64::NAN);
    }
}

/// A number such that a larger one belongs to a larger `f64`, as [`f64::total_cmp`] orders them; its own inverse.
fn ordered(bits: i64) -> i64 {
    bits ^ ((bits >> 63) as u64 >> 1) as i64
}

/// A stretch in the order of what the expression does not exceed on it. Of equal bounds the longest comes first, so that a bound
/// that is unbounded everywhere is cut evenly.
fn stretch(bound: f64, from: f64, to: f64) -> (i64, i64, [u64; 2]) {
    let key = |value: f64| ordered(value.to_bits() as i64);
    (key(bound), key(to - from), [from.to_bits(), to.to_bits()])
}
