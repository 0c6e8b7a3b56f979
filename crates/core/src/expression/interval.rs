//! Intervals that hold the real values of an expression, and what `f64` makes of them.
//!
//! +, −, ×, ÷ and √ are rounded outwards: the sign of the rounding error, which a fused multiply-add gives exactly, says on which
//! side of the computed number the real one lies, so that exact results are not widened. The other functions are computed
//! to within a unit in the last place or two and widened by more.
//!
//! [`Interval::UNDEFINED`] stands for an operation that may have no value, such as a division by what may be zero. It
//! absorbs: tanh of it is undefined too. Whoever asks is told [`Interval::WHOLE`].

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use core::ops::{Add, Div, Mul, Neg, Sub};

use super::float::{apply, repeated, whole};
use super::{Algebra, Binary, Branch, Branching, Number, Unary};
use crate::Scalar;

/// More than the error of a sine, which is 2.2 units in its last place.
const SINE_ERROR: f64 = 4.0 * f64::EPSILON;
/// Angles beyond this are not told apart.
const FAR_RAD: f64 = 1e9;
/// Below this the error of a product may itself be rounded.
const SMALL: f64 = 1e-280;

/// All numbers from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end; may be −∞.
    pub low: f64,
    /// The upper end; may be ∞.
    pub high: f64,
}

impl Interval {
    /// Everything: nothing is known.
    pub const WHOLE: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
    /// There may be no value.
    pub(super) const UNDEFINED: Interval = Interval { low: f64::NAN, high: f64::NAN };

    /// From `low` to `high`; undefined when they are not in this order.
    pub(super) fn new(low: f64, high: f64) -> Self {
        // What overflows on the way is a real number beyond the largest f64.
        if low <= high { Interval { low: low.min(f64::MAX), high: high.max(f64::MIN) } } else { Interval::UNDEFINED }
    }

    /// One number.
    pub fn point(value: f64) -> Self {
        Interval { low: value, high: value }
    }

    /// The same, with everything for what is undefined.
    pub(super) fn or_whole(self) -> Self {
        if self.low <= self.high { self } else { Interval::WHOLE }
    }

    /// Whether both ends are finite.
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Whether a number lies in it.
    pub fn holds(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// Made wider by `room` on both sides.
    #[must_use]
    pub fn with_room(self, room: f64) -> Self {
        Interval::new(self.low - room, self.high + room).or_whole()
    }

    /// What the sine of it keeps within.
    #[must_use]
    pub fn sine(self) -> Self {
        if self == Interval::point(0.0) { self } else { self.wave(Unary::Sin, FRAC_PI_2) }
    }

    /// Its square root.
    #[must_use]
    pub(crate) fn root(self) -> Self {
        self.apply(Unary::Sqrt).after(&[self])
    }

    /// The largest size of a number in it.
    pub fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Interval::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// What both hold.
    #[must_use]
    pub(super) fn and(self, other: Self) -> Self {
        Interval { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    /// Made wider by a few units in the last place.
    fn widened(self) -> Self {
        let by = |x: f64| if x.is_finite() { 4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE } else { 0.0 };
        Interval::new(self.low - by(self.low), self.high + by(self.high))
    }

    fn neg(self) -> Self {
        Interval { low: -self.high, high: -self.low }
    }

    fn add(self, other: Self) -> Self {
        Interval::new(down(sum(self.low, other.low)), up(sum(self.high, other.high)))
    }

    pub(crate) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        self.ends(other, product)
    }

    pub(crate) fn div(self, other: Self) -> Self {
        if other.holds(0.0) { Interval::UNDEFINED } else { self.ends(other, quotient) }
    }

    /// Of an operation that is monotone in each operand, for the ends of both.
    fn ends(self, other: Self, f: fn(f64, f64) -> (f64, f64)) -> Self {
        let all = [(self.low, other.low), (self.low, other.high), (self.high, other.low), (self.high, other.high)];
        let all = all.map(|(a, b)| f(a, b));
        let low = all.map(down).into_iter().fold(f64::INFINITY, f64::min);
        Interval::new(low, all.map(up).into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    fn abs(self) -> Self {
        match self {
            _ if self.low >= 0.0 => self,
            _ if self.high <= 0.0 => self.neg(),
            _ => Interval::new(0.0, self.size()),
        }
    }

    /// A function that rises, computed with a small relative error, and is exactly `value` at `at`.
    fn rising(self, function: Unary, at: f64, value: f64) -> Self {
        let near = Interval::new(apply(function, self.low), apply(function, self.high));
        let Interval { low, high } = near.widened();
        // What lies on one side of `at` stays on one side of `value`: tanh t is not negative for t ≥ 0.
        let low = if self.low >= at { low.max(value) } else { low };
        let high = if self.high <= at { high.min(value) } else { high };
        Interval::new(low, high)
    }

    /// To a whole power.
    fn whole_power(self, n: i32) -> Self {
        if n < 0 {
            return Interval::point(1.0).div(self.whole_power(-n));
        }
        let size = if n % 2 == 0 { self.abs() } else { self };
        let end = |x: f64, to: fn((f64, f64)) -> f64, other: fn((f64, f64)) -> f64| {
            let to = if x < 0.0 { other } else { to };
            let size = repeated(x.abs(), n.unsigned_abs(), |a, b| to(product(a, b)));
            if x < 0.0 { -size } else { size }
        };
        Interval::new(end(size.low, down, up), end(size.high, up, down))
    }

    /// To a power that is not a small whole number: monotone in base and exponent.
    fn real_power(self, exponent: Interval) -> Self {
        if self.low < 0.0 || self.low == 0.0 && exponent.low < 0.0 {
            return Interval::UNDEFINED;
        }
        let power = |a: f64, b: f64| (libm::pow(a, b), 0.0);
        let Interval { low, high } = self.ends(exponent, power).widened();
        Interval::new(low.max(0.0), high)
    }

    /// Sine or cosine, a wave of size one that is highest at `crest`.
    fn wave(self, function: Unary, crest: f64) -> Self {
        let Interval { low, high } = self;
        if (high - low).is_nan() || high - low >= TAU || self.size() > FAR_RAD {
            return Interval { low: -1.0, high: 1.0 };
        }
        // Whether a point at `phase` plus whole turns lies inside, asked generously.
        let inside = |phase: f64| {
            let slack = 1e-6;
            libm::ceil((low - phase) / TAU - slack) <= libm::floor((high - phase) / TAU + slack)
        };
        let (a, b) = (apply(function, low), apply(function, high));
        let bottom = if inside(crest + PI) { -1.0 } else { (a.min(b) - SINE_ERROR).max(-1.0) };
        let top = if inside(crest) { 1.0 } else { (a.max(b) + SINE_ERROR).min(1.0) };
        Interval::new(bottom, top)
    }

    fn apply(self, function: Unary) -> Self {
        let clamped =
            |Interval { low, high }: Interval, least: f64, most: f64| Interval::new(low.max(least), high.min(most));
        match function {
            Unary::Negate => self.neg(),
            Unary::Abs => self.abs(),
            Unary::Sin => self.sine(),
            Unary::Cos => self.wave(function, 0.0),
            Unary::Exp => clamped(self.rising(function, 0.0, 1.0), 0.0, f64::INFINITY),
            Unary::Tanh => clamped(self.rising(function, 0.0, 0.0), -1.0, 1.0),
            Unary::Atan => self.rising(function, 0.0, 0.0),
            Unary::Log | Unary::Sqrt if self.low < 0.0 => Interval::UNDEFINED,
            Unary::Log => self.rising(function, 1.0, 0.0),
            Unary::Sqrt => Interval::new(down(root(self.low)), up(root(self.high))),
        }
    }

    fn combine(self, function: Binary, other: Self) -> Self {
        match function {
            Binary::Add => self.add(other),
            Binary::Subtract => self.sub(other),
            Binary::Multiply => self.mul(other),
            Binary::Divide => self.div(other),
            Binary::Min => Interval::new(self.low.min(other.low), self.high.min(other.high)),
            Binary::Max => Interval::new(self.low.max(other.low), self.high.max(other.high)),
        }
    }

    /// What leaves the finite numbers may come back as not-a-number, and so has no value whatever is done with it later.
    fn after(self, operands: &[Interval]) -> Self {
        let undefined = operands.iter().any(|operand| operand.low.is_nan());
        let lost = operands.iter().all(|operand| operand.is_finite()) && !self.is_finite();
        if undefined || lost { Interval::UNDEFINED } else { self }
    }
}

/// A sum as computed, and the sign of what is missing to the real one; not-a-number where that is not known.
fn sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let rest = sum - a;
    (sum, (a - (sum - rest)) + (b - rest))
}

/// The same of a product. An infinite end is a bound that is not reached, so that zero times it is zero.
fn product(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b == 0.0 {
        return (0.0, 0.0);
    }
    let product = a * b;
    (product, if product.abs() < SMALL { f64::NAN } else { libm::fma(a, b, -product) })
}

fn quotient(a: f64, b: f64) -> (f64, f64) {
    if a == 0.0 || b.is_infinite() {
        // An unbounded divisor: the quotient comes as close to zero as one likes.
        return (0.0, 0.0);
    }
    let quotient = a / b;
    let rest = libm::fma(-quotient, b, a);
    let known = quotient.abs() > SMALL && a.abs() > SMALL;
    (quotient, if known { rest * b.signum() } else { f64::NAN })
}

fn root(a: f64) -> (f64, f64) {
    let root = libm::sqrt(a);
    let rest = libm::fma(-root, root, a);
    (
        root,
        if a > SMALL {
            rest
        } else if a == 0.0 {
            0.0
        } else {
            f64::NAN
        },
    )
}

fn down((value, missing): (f64, f64)) -> f64 {
    if missing >= 0.0 { value } else { value.next_down() }
}

fn up((value, missing): (f64, f64)) -> f64 {
    if missing <= 0.0 { value } else { value.next_up() }
}

/// The algebra of intervals.
#[derive(Debug)]
pub struct Intervals<'a>(pub &'a [Interval]);

impl Algebra for Intervals<'_> {
    type Value = Interval;

    fn number(&mut self, number: &Number) -> Interval {
        number.within()
    }
    fn variable(&mut self, index: usize) -> Interval {
        self.0.get(index).copied().unwrap_or(Interval::UNDEFINED)
    }
    fn unary(&mut self, function: Unary, a: Interval) -> Interval {
        a.apply(function).after(&[a])
    }
    fn binary(&mut self, function: Binary, a: Interval, b: Interval) -> Interval {
        a.combine(function, b).after(&[a, b])
    }
    fn power(&mut self, a: Interval, exponent: &Number) -> Interval {
        let within = exponent.within();
        let power = if within.low == within.high { whole(within.low) } else { None };
        power.map_or_else(|| a.real_power(within), |n| a.whole_power(n)).after(&[a])
    }
}

impl Branching for Intervals<'_> {
    fn branch(&mut self, larger: Interval, smaller: Interval) -> Branch {
        match () {
            // Where they are equal at an end, the next stretch may have the other branch, and derivatives do not exist between.
            () if larger.low > smaller.high => Branch::First,
            () if larger.high < smaller.low => Branch::Second,
            () => Branch::Either,
        }
    }
    fn either(&mut self, a: Interval, b: Interval) -> Interval {
        a.hull(b).after(&[a, b])
    }
    fn unknown(&self) -> Interval {
        Interval::UNDEFINED
    }
    fn is_zero(&self, a: Interval) -> bool {
        a == Interval::point(0.0)
    }
}

/// Implements an operator by the function of two operands of the same meaning.
macro_rules! operator {
    ($($operator:ident, $name:ident, $function:ident;)*) => {
        $(impl $operator for Interval {
            type Output = Interval;
            fn $name(self, other: Interval) -> Interval {
                self.combine(Binary::$function, other).after(&[self, other])
            }
        })*
    };
}

operator!(
    Add, add, Add;
    Sub, sub, Subtract;
    Mul, mul, Multiply;
    Div, div, Divide;
);

impl Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        self.apply(Unary::Negate).after(&[self])
    }
}

/// So that kernels enclose what they compute. A sum of products is rounded outwards twice.
impl Scalar for Interval {
    const ZERO: Self = Interval { low: 0.0, high: 0.0 };

    fn splat(value: f64) -> Self {
        Interval::point(value)
    }

    fn mul_add(self, a: Self, b: Self) -> Self {
        Mul::mul(self, a) + b
    }

    fn saturate(self, limit: Self) -> Self {
        let least = self.combine(Binary::Min, limit);
        least.combine(Binary::Max, limit.apply(Unary::Negate)).after(&[self, limit])
    }

    fn sin_cos(self) -> (Self, Self) {
        if self == Interval::point(0.0) {
            return (self, Interval::point(1.0));
        }
        (self.sine().after(&[self]), self.apply(Unary::Cos).after(&[self]))
    }

    fn positive(self) -> Self {
        self.combine(Binary::Max, Interval::point(0.0)).after(&[self])
    }

    fn tanh(self) -> Self {
        self.apply(Unary::Tanh).after(&[self])
    }
}
