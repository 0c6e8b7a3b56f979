//! Numbers for reading.

use std::fmt;

use forwardstep_sim::quantity::number;

/// A number as it is read: with a power of ten where decimals would be long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shown(f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        number(self.0).fmt(f)
    }
}

/// With at most four digits.
pub(crate) fn rounded(value: f64) -> Shown {
    Shown(format!("{value:.3e}").parse().unwrap_or(value))
}

/// Rounded up to four digits.
pub(crate) fn rounded_up(value: f64) -> Shown {
    Shown(outwards(value, 4))
}

/// Rounded down to four digits.
pub(super) fn rounded_down(value: f64) -> Shown {
    Shown(-outwards(-value, 4))
}

/// A number rounded up to so many digits, unless it has no more.
fn outwards(value: f64, digits: usize) -> f64 {
    let places = digits - 1;
    let short = |value: f64| format!("{value:.places$e}");
    let number = |text: &str| text.parse::<f64>().unwrap_or(value);
    let near = short(value);
    if number(&near) >= value || !value.is_finite() {
        return number(&near);
    }
    let exponent: i32 = near.rsplit('e').next().and_then(|exponent| exponent.parse().ok()).unwrap_or(0);
    let up = number(&short(number(&near) + number(&format!("1e{}", exponent - places as i32))));
    // The last steps towards the largest and the smallest numbers are lost to rounding.
    if up >= value && up.is_finite() { up } else { value }
}

/// An upper bound of something that was computed from decimals: rounded up to four digits, where two units in the last place
/// of an `f64` do not count, so that a bound of three tenths is 0.3.
pub(super) fn bound(value: f64) -> Shown {
    let below = value.next_down().next_down();
    rounded_up(if (below < 0.0) == (value < 0.0) && value != 0.0 { below } else { value })
}

/// The same for a lower bound.
pub(super) fn lower_bound(value: f64) -> Shown {
    let Shown(above) = bound(-value);
    Shown(-above)
}

/// An upper bound of something that stays below `limit`, with as many digits as it takes to say so, and four at least.
pub(super) fn bound_below(value: f64, limit: f64) -> Shown {
    Shown((4..17).map(|digits| outwards(value, digits)).find(|up| *up < limit).unwrap_or(value))
}

/// Something that reaches `limit`, rounded down, with as many digits as it takes to say so, and four at least.
pub(super) fn reached_above(value: f64, limit: f64) -> Shown {
    Shown((4..17).map(|digits| -outwards(-value, digits)).find(|down| *down >= limit).unwrap_or(value))
}

/// Something above `limit`, rounded down, with as many digits as it takes to say so, and four at least.
pub(super) fn above(value: f64, limit: f64) -> Shown {
    let Shown(below) = bound_below(-value, -limit);
    Shown(-below)
}

/// With all its digits.
pub(super) fn as_it_is(value: f64) -> Shown {
    Shown(value)
}

/// A time without the digits that rounding left behind.
pub(crate) fn seconds(t_s: f64) -> f64 {
    (t_s * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn up(value: f64) -> f64 {
        rounded_up(value).0
    }

    fn down(value: f64) -> f64 {
        rounded_down(value).0
    }

    #[test]
    fn prop_bounds_are_rounded_away_from_what_they_bound() {
        for value in [1.0, 1.0001, 1.2344, 1.2345, 9.9999, 2.0_f64.sqrt(), 4e-7, 12_345.6, 1e300, 3.0e-300] {
            assert!(up(value) >= value && up(value) <= value * 1.0011, "{value}: {}", up(value));
            assert_eq!(up(up(value)), up(value), "four digits are four digits");
            assert!((rounded(value).0 - value).abs() <= 0.00051 * value);
            assert!(down(value) <= value && down(value) >= value / 1.0011, "{value}: {}", down(value));
        }
        for value in [-1.2345, -4e-7, -2.0, -9.9999, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324] {
            assert!(up(value) >= value && down(value) <= value, "{value}");
        }
        assert_eq!([down(1.4149), down(-1.4141), up(-1.4149)], [1.414, -1.415, -1.414]);
        assert_eq!([down(0.0), down(f64::INFINITY)], [0.0, f64::INFINITY]);
        assert_eq!([up(1.4141), up(0.0), up(f64::INFINITY)], [1.415, 0.0, f64::INFINITY]);
    }

    #[test]
    fn a_bound_of_three_tenths_is_said_as_such_and_a_small_one_is_not_zero() {
        assert_eq!([0.1 + 0.2, 0.3, 4e-7, 0.0, 1.0 / 3.0].map(|value| bound(value).0), [0.3, 0.3, 4e-7, 0.0, 0.3334]);
        assert_eq!([0.3, 0.0, 2.0 / 3.0].map(|value| lower_bound(value).0), [0.3, 0.0, 0.6666]);
    }

    #[test]
    fn what_is_compared_is_said_with_the_digits_that_tell() {
        let gamma = core::f64::consts::SQRT_2;
        assert_eq!([1.2, gamma.next_down()].map(|value| bound_below(value, gamma).0), [1.2, gamma.next_down()]);
        assert_eq!(bound_below(1.41409, gamma).0, 1.4141);
        assert_eq!([gamma, 1.41425, 2.0].map(|value| reached_above(value, gamma).0), [gamma, 1.41425, 2.0]);
    }

    #[test]
    fn long_decimals_are_read_as_powers_of_ten() {
        let said =
            [0.0, 0.3, 1e-4, 4e-7, -9.15e-10, 9_999_999.0, 1e7, f64::INFINITY].map(|value| Shown(value).to_string());
        assert_eq!(said, ["0", "0.3", "0.0001", "4e-7", "-9.15e-10", "9999999", "1e7", "inf"]);
    }
}
