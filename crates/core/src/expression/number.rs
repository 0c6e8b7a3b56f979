//! The constants of an expression, exactly as they were written.

use alloc::format;
use alloc::sync::Arc;

use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};

use super::interval::Interval;

/// Digits that a decimal may be written with.
pub const MOST_DIGITS: usize = 64;
/// Decimal exponents, and places after the point, are at most this large.
const MOST_EXPONENT: i32 = 300;
/// Those of the shortest decimal of any `f64`, which has 17 digits at most.
const MOST_OF_F64: i32 = 324 + 17;

/// A real constant: a rational number such as 1/10, or an enclosed irrational one such as π. `f64` arithmetic uses the nearest
/// `f64`, everything else the number itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    value: f64,
    /// The tightest interval of `f64` that holds the number.
    within: Interval,
    /// The number, where `within` is not a single point and it is rational.
    exact: Option<Arc<BigRational>>,
}

impl Number {
    /// π.
    pub const PI: Number = Number::near(core::f64::consts::PI);
    /// Euler's number.
    pub const E: Number = Number::near(core::f64::consts::E);

    /// A number that is known to lie within one unit in the last place of `value`.
    pub(super) const fn near(value: f64) -> Self {
        Number { value, within: Interval { low: value.next_down(), high: value.next_up() }, exact: None }
    }

    /// A number without sign as it is written in decimals, such as `0.1` or `2.5e-3`; `None` when it is not one, or has more than
    /// [`MOST_DIGITS`] digits or an exponent beyond 300.
    pub fn decimal(text: &str) -> Option<Self> {
        Number::ratio(text, MOST_EXPONENT).map(Number::rational)
    }

    /// What `text` writes, with so large an exponent at most.
    fn ratio(text: &str, most_exponent: i32) -> Option<BigRational> {
        let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let (whole, part) = digits.split_once('.').unwrap_or((digits, ""));
        let count = whole.len() + part.len();
        if !(1..=MOST_DIGITS).contains(&count) || !(whole.bytes().chain(part.bytes())).all(|c| c.is_ascii_digit()) {
            return None;
        }
        let places = exponent.parse::<i32>().ok()?.checked_sub(part.len() as i32)?;
        if places.abs() > most_exponent {
            return None;
        }
        let power = "0".repeat(places.unsigned_abs() as usize);
        let ratio = if places < 0 { format!("{whole}{part}/1{power}") } else { format!("{whole}{part}{power}") };
        ratio.parse().ok()
    }

    /// What somebody wrote who got this `f64`: the shortest decimal that reads as it; zero for what is not finite.
    pub fn written(value: f64) -> BigRational {
        let size = Number::ratio(&format!("{:e}", value.abs()), MOST_OF_F64).unwrap_or_else(BigRational::zero);
        if value < 0.0 { -size } else { size }
    }

    /// A rational number.
    pub fn rational(exact: BigRational) -> Self {
        let within = enclosed(&exact);
        let value = exact.to_f64().unwrap_or(f64::NAN).clamp(within.low, within.high);
        let exact = (within.low < within.high).then(|| Arc::new(exact));
        Number { value, within, exact }
    }

    /// A number within `within`, near `value`; `None` where that is not finite.
    pub(super) fn enclosed(value: f64, within: Interval) -> Option<Self> {
        within.is_finite().then(|| Number { value: value.clamp(within.low, within.high), within, exact: None })
    }

    /// The nearest `f64`.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// An interval that holds the number.
    pub fn within(&self) -> Interval {
        self.within
    }

    /// The number itself, where it is known to be rational.
    pub fn exact(&self) -> Option<BigRational> {
        match &self.exact {
            Some(exact) => Some(BigRational::clone(exact)),
            None if self.within.low < self.within.high => None,
            None => BigRational::from_float(self.value),
        }
    }

    /// The number less a small whole one.
    pub(super) fn minus(&self, whole: f64) -> Self {
        Number { value: self.value - whole, within: self.within.sub(Interval::point(whole)), exact: None }
    }
}

/// The tightest interval of `f64` around a rational number.
pub(super) fn enclosed(exact: &BigRational) -> Interval {
    let near = exact.to_f64().unwrap_or(0.0).clamp(f64::MIN, f64::MAX);
    let (mut low, mut high) = (near, near);
    // Division has rounded somewhere; comparisons say to which side.
    while BigRational::from_float(low).is_some_and(|low| low > *exact) {
        low = low.next_down();
    }
    while BigRational::from_float(high).is_some_and(|high| high < *exact) {
        high = high.next_up();
    }
    Interval::new(low, high)
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Number { value, within: Interval::point(value), exact: None }
    }
}
