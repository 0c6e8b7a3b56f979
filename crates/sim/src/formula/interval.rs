//! Interval arithmetic that encloses what [`super::Formula::eval`] returns, rounding included.
//!
//! The operations that IEEE 754 rounds correctly (+, −, ×, ÷, √) are monotone as computed: what they give for the ends of
//! intervals encloses what they give inside, and nothing needs widening. The other functions are computed to within a few
//! units in the last place, by which their enclosures are widened.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use super::sine;

/// More than the error of a sine near its largest values.
const SINE_ERROR: f64 = 4.0 * f64::EPSILON;
/// Angles beyond this are not told apart.
const FAR_RAD: f64 = 1e9;

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

    pub(super) fn new(low: f64, high: f64) -> Self {
        // Not-a-number stands for an operation that has no value somewhere inside.
        if low <= high { Interval { low, high } } else { Interval::WHOLE }
    }

    /// Whether both ends are finite.
    pub fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Made wider by `room` on both sides.
    pub(crate) fn with_room(self, room: f64) -> Self {
        Interval::new(self.low - room, self.high + room)
    }

    /// What the sine of it keeps within.
    pub(crate) fn sine(self) -> Self {
        self.sin_of()
    }

    /// The largest size of a number in it.
    pub fn size(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// Made wider by a few units in the last place.
    fn widened(self) -> Self {
        let by = |x: f64| 4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE;
        let outside = |x: f64, sign: f64| if x.is_finite() { x + sign * by(x) } else { x };
        Interval::new(outside(self.low, -1.0), outside(self.high, 1.0))
    }

    pub(super) fn neg(self) -> Self {
        Interval::new(-self.high, -self.low)
    }

    pub(super) fn add(self, other: Self) -> Self {
        Interval::new(self.low + other.low, self.high + other.high)
    }

    pub(super) fn sub(self, other: Self) -> Self {
        Interval::new(self.low - other.high, self.high - other.low)
    }

    pub(super) fn mul(self, other: Self) -> Self {
        // An infinite end is a bound that is not reached, so that zero times it is zero.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        Self::ends(self, other, product)
    }

    pub(super) fn div(self, other: Self) -> Self {
        if other.low <= 0.0 && other.high >= 0.0 {
            return Interval::WHOLE;
        }
        let quotient = |a: f64, b: f64| {
            if a == 0.0 || b.is_infinite() && a.is_finite() {
                0.0
            } else if b.is_infinite() {
                f64::NAN
            } else {
                a / b
            }
        };
        // An unbounded divisor and an unbounded dividend: the quotient lies between nothing and what the nearer end of the
        // divisor gives.
        let ends = [quotient(self.low, other.low), quotient(self.low, other.high)];
        let more = [quotient(self.high, other.low), quotient(self.high, other.high)];
        let all = || ends.into_iter().chain(more).map(|x| if x.is_nan() { 0.0 } else { x });
        Interval::new(all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max))
    }

    fn ends(a: Self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let all = [f(a.low, b.low), f(a.low, b.high), f(a.high, b.low), f(a.high, b.high)];
        if all.iter().any(|x| x.is_nan()) {
            return Interval::WHOLE;
        }
        Interval::new(all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    pub(super) fn abs(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            self.neg()
        } else {
            Interval::new(0.0, self.high.max(-self.low))
        }
    }

    pub(super) fn min(self, other: Self) -> Self {
        Interval::new(self.low.min(other.low), self.high.min(other.high))
    }

    pub(super) fn max(self, other: Self) -> Self {
        Interval::new(self.low.max(other.low), self.high.max(other.high))
    }

    /// A function that rises, computed with a small relative error.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Interval::new(f(self.low), f(self.high)).widened()
    }

    pub(super) fn sqrt_of(self) -> Self {
        if self.low >= 0.0 { Interval::new(libm::sqrt(self.low), libm::sqrt(self.high)) } else { Interval::WHOLE }
    }

    pub(super) fn exp_of(self) -> Self {
        let Interval { low, high } = self.rising(libm::exp);
        Interval::new(low.max(0.0), high)
    }

    pub(super) fn log_of(self) -> Self {
        if self.low >= 0.0 { self.rising(libm::log) } else { Interval::WHOLE }
    }

    pub(super) fn tanh_of(self) -> Self {
        let Interval { low, high } = self.rising(libm::tanh);
        Interval::new(low.max(-1.0), high.min(1.0))
    }

    pub(super) fn atan_of(self) -> Self {
        self.rising(libm::atan)
    }

    /// By products of sizes, each of which is monotone as computed.
    pub(super) fn powi_of(self, n: i32) -> Self {
        let even = n % 2 == 0;
        if n < 0 {
            return Interval::new(1.0, 1.0).div(self.powi_of(-n));
        }
        if even {
            let Interval { low, high } = self.abs();
            Interval::new(super::powi(low, n), super::powi(high, n))
        } else {
            Interval::new(super::powi(self.low, n), super::powi(self.high, n))
        }
    }

    /// To a constant power that is not a small whole number.
    pub(super) fn powf_of(self, exponent: f64) -> Self {
        if self.low < 0.0 || self.low == 0.0 && exponent < 0.0 {
            return Interval::WHOLE;
        }
        let (a, b) = (libm::pow(self.low, exponent), libm::pow(self.high, exponent));
        let Interval { low, high } = Interval::new(a.min(b), a.max(b)).widened();
        Interval::new(low.max(0.0), high)
    }

    pub(super) fn sin_of(self) -> Self {
        self.wave(FRAC_PI_2)
    }

    pub(super) fn cos_of(self) -> Self {
        self.wave(0.0)
    }

    /// A wave of size one that is highest at `crest`.
    fn wave(self, crest: f64) -> Self {
        let Interval { low, high } = self;
        let full = Interval { low: -1.0, high: 1.0 };
        if (high - low).is_nan() || high - low >= TAU || low.abs().max(high.abs()) > FAR_RAD {
            return full;
        }
        // Whether a point at `phase` plus whole turns lies inside, asked generously.
        let inside = |phase: f64| {
            let slack = 1e-6;
            ((low - phase) / TAU - slack).ceil() <= ((high - phase) / TAU + slack).floor()
        };
        let value = |x: f64| if crest == 0.0 { sine(x).1 } else { sine(x).0 };
        let (a, b) = (value(low), value(high));
        let bottom = if inside(crest + PI) { -1.0 } else { (a.min(b) - SINE_ERROR).max(-1.0) };
        let top = if inside(crest) { 1.0 } else { (a.max(b) + SINE_ERROR).min(1.0) };
        Interval::new(bottom, top)
    }
}
