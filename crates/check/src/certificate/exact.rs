//! Numbers as they were written.

use core::fmt::Write;

use forwardstep_core::expression::Number;
use num_rational::BigRational;
use num_traits::{One, Zero};

/// The shortest decimal that reads as this number, which is what somebody wrote; zero for what is not finite.
pub(crate) fn written(value: f64) -> BigRational {
    let size = Number::decimal(&format!("{:e}", value.abs())).and_then(|number| number.exact());
    let size = size.or_else(|| BigRational::from_float(value.abs())).unwrap_or_else(BigRational::zero);
    if value < 0.0 { -size } else { size }
}

/// A short decimal that is not above a finite number.
pub(super) fn below(value: f64) -> BigRational {
    let exact = BigRational::from_float(value).unwrap_or_else(BigRational::zero);
    let short = written(value);
    if short <= exact { short } else { written(value.next_down()) }
}

/// A short decimal that is not below a finite number.
pub(super) fn above(value: f64) -> BigRational {
    -below(-value)
}

/// Digits behind the point up to which a number is written as a decimal.
const MOST_PLACES: usize = 40;

/// A rational number as it stands in a certificate: a whole number or a short decimal where it is one, else p/q.
///
/// ```
/// use forwardstep_check::certificate::decimal;
/// use num_rational::BigRational;
///
/// let number = |p: i64, q: i64| decimal(&BigRational::new(p.into(), q.into()));
/// assert_eq!([number(-3, 8), number(6, 2), number(1, 3)], ["-0.375", "3", "1/3"]);
/// ```
pub fn decimal(number: &BigRational) -> String {
    let ten = BigRational::from_integer(10.into());
    let (mut scaled, mut places) = (number.clone(), 0);
    while !scaled.denom().is_one() && places < MOST_PLACES {
        scaled *= &ten;
        places += 1;
    }
    if !scaled.denom().is_one() {
        return number.to_string();
    }
    let digits = scaled.numer().magnitude().to_string();
    let (whole, broken) = match digits.len().checked_sub(places) {
        Some(whole) if whole > 0 => (digits[..whole].to_owned(), digits[whole..].to_owned()),
        _ => ("0".to_owned(), format!("{digits:0>places$}")),
    };
    let mut text = String::from(if *number < BigRational::zero() { "-" } else { "" });
    text += &whole;
    if places > 0 {
        // Writing to a String cannot fail.
        let _ = write!(text, ".{broken}");
    }
    text
}
