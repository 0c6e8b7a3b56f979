//! Numbers as people read them.

/// Four significant digits, with a power of ten where the number is very small or large.
pub(crate) fn number(x: f64) -> String {
    if x.is_nan() {
        return "not a number".into();
    }
    if x.is_infinite() {
        return if x > 0.0 { "∞".into() } else { "−∞".into() };
    }
    if x == 0.0 {
        return "0".into();
    }
    let scientific = format!("{x:.3e}");
    let Some((digits, exponent)) = scientific.split_once('e') else { return scientific };
    let power: i32 = exponent.parse().unwrap_or(0);
    let text = if (-3..6).contains(&power) {
        let places = (3 - power).max(0).unsigned_abs() as usize;
        trim(&format!("{x:.places$}")).to_owned()
    } else {
        format!("{} × 10{}", trim(digits), superscript(power))
    };
    text.replace('-', "−")
}

/// Without zeros at the end of a fraction.
fn trim(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// A whole number in raised digits.
pub(crate) fn superscript(power: i32) -> String {
    let raise = |c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        digit => char::from_u32('⁴' as u32 + digit as u32 - '4' as u32).unwrap_or(digit),
    };
    power.to_string().chars().map(raise).collect()
}

/// A unit as in [`super::super::names::unit`], set for reading: `rad/s²`, `N m`.
pub(crate) fn unit(plain: &str) -> String {
    match plain.split_once('^') {
        Some((base, "0.5")) => format!("√{base}"),
        Some((base, power)) => format!("{base}{}", superscript(power.parse().unwrap_or(0))),
        None => plain.to_owned(),
    }
}

/// The distinct units, for reading: `rad or m`.
pub(crate) fn units(all: impl Iterator<Item = String>) -> String {
    let mut distinct: Vec<String> = Vec::new();
    for unit in all.map(|plain| unit(&plain)) {
        if !distinct.contains(&unit) {
            distinct.push(unit);
        }
    }
    distinct.join(" or ")
}

/// `1 agent`, `2 agents`.
pub(crate) fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0"),
            (60.0, "60"),
            (-0.25, "−0.25"),
            (1234.56, "1235"),
            (0.009_687_6, "0.009688"),
            (6.28e-8, "6.28 × 10⁻⁸"),
            (-1e30, "−1 × 10³⁰"),
            (999_999.9, "1 × 10⁶"),
            (f64::NAN, "not a number"),
            (f64::NEG_INFINITY, "−∞"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
        assert_eq!(unit("rad/s^2"), "rad/s²");
        assert_eq!(unit("J^0.5"), "√J");
        assert_eq!(superscript(-12), "⁻¹²");
    }

    #[test]
    fn units_are_named_once() {
        let all = ["rad", "m", "rad", "m"].map(String::from).into_iter();
        assert_eq!(units(all), "rad or m");
        assert_eq!(units(["rad/s^2".to_owned()].into_iter()), "rad/s²");
    }
}
