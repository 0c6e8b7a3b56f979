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
