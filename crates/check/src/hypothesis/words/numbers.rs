//! Numbers for reading.

/// With at most four digits.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Rounded up to four digits.
pub(super) fn rounded_up(value: f64) -> f64 {
    let four = |value: f64| format!("{value:.3e}");
    let number = |text: &str| text.parse::<f64>().unwrap_or(value);
    let near = four(value);
    if number(&near) >= value || !value.is_finite() {
        return number(&near);
    }
    let exponent: i32 = near.rsplit('e').next().and_then(|exponent| exponent.parse().ok()).unwrap_or(0);
    number(&four(number(&near) + number(&format!("1e{}", exponent - 3))))
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
        }
        assert_eq!([rounded_up(1.4141), rounded_up(0.0), rounded_up(f64::INFINITY)], [1.415, 0.0, f64::INFINITY]);
    }
}
