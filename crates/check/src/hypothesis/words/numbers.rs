//! Numbers for reading.

/// With at most four digits.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Rounded up to four digits.
pub(super) fn rounded_up(value: f64) -> f64 {
    outwards(value, 4)
}

/// Rounded down to four digits.
pub(super) fn rounded_down(value: f64) -> f64 {
    -outwards(-value, 4)
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
pub(super) fn bound(value: f64) -> f64 {
    let below = value.next_down().next_down();
    rounded_up(if (below < 0.0) == (value < 0.0) && value != 0.0 { below } else { value })
}

/// The same for a lower bound.
pub(super) fn lower_bound(value: f64) -> f64 {
    -bound(-value)
}

/// An upper bound of something that stays below `limit`, with as many digits as it takes to say so, and four at least.
pub(super) fn bound_below(value: f64, limit: f64) -> f64 {
    (4..17).map(|digits| outwards(value, digits)).find(|up| *up < limit).unwrap_or(value)
}

/// Something that reaches `limit`, rounded down, with as many digits as it takes to say so, and four at least.
pub(super) fn reached_above(value: f64, limit: f64) -> f64 {
    (4..17).map(|digits| -outwards(-value, digits)).find(|down| *down >= limit).unwrap_or(value)
}

/// To three digits after the point.
pub(super) fn short(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// A time without the digits that rounding left behind.
pub(super) fn seconds(t_s: f64) -> f64 {
    (t_s * 1e6).round() / 1e6
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_bounds_are_rounded_away_from_what_they_bound() {
        for value in [1.0, 1.0001, 1.2344, 1.2345, 9.9999, 2.0_f64.sqrt(), 4e-7, 12_345.6, 1e300, 3.0e-300] {
            let up = rounded_up(value);
            assert!(up >= value && up <= value * 1.0011, "{value}: {up}");
            assert_eq!(rounded_up(up), up, "four digits are four digits");
            assert!((rounded(value) - value).abs() <= 0.00051 * value);
            let down = rounded_down(value);
            assert!(down <= value && down >= value / 1.0011, "{value}: {down}");
        }
        for value in [-1.2345, -4e-7, -2.0, -9.9999, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324] {
            assert!(rounded_up(value) >= value && rounded_down(value) <= value, "{value}");
        }
        assert_eq!([rounded_down(1.4149), rounded_down(-1.4141), rounded_up(-1.4149)], [1.414, -1.415, -1.414]);
        assert_eq!([rounded_down(0.0), rounded_down(f64::INFINITY)], [0.0, f64::INFINITY]);
        assert_eq!([rounded_up(1.4141), rounded_up(0.0), rounded_up(f64::INFINITY)], [1.415, 0.0, f64::INFINITY]);
    }

    #[test]
    fn a_bound_of_three_tenths_is_said_as_such_and_a_small_one_is_not_zero() {
        assert_eq!(
            [bound(0.1 + 0.2), bound(0.3), bound(4e-7), bound(0.0), bound(1.0 / 3.0)],
            [0.3, 0.3, 4e-7, 0.0, 0.3334]
        );
        assert_eq!([lower_bound(0.3), lower_bound(0.0), lower_bound(2.0 / 3.0)], [0.3, 0.0, 0.6666]);
    }

    #[test]
    fn what_is_compared_is_said_with_the_digits_that_tell() {
        let gamma = core::f64::consts::SQRT_2;
        assert_eq!([bound_below(1.2, gamma), bound_below(gamma.next_down(), gamma)], [1.2, gamma.next_down()]);
        assert_eq!(bound_below(1.41409, gamma), 1.4141);
        assert_eq!(
            [reached_above(gamma, gamma), reached_above(1.41425, gamma), reached_above(2.0, gamma)],
            [gamma, 1.41425, 2.0]
        );
    }
}
