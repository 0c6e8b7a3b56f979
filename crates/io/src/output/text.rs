//! Numbers and sentences as people read them.

use forwardstep_core::signal::superscript;
use forwardstep_sim::quantity::with_power;
use maud::{Markup, html};

pub(crate) use crate::wording::{count, unbroken};

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

/// A unit as in [`super::names::unit`], set for reading: `rad/s²`, `N m`.
pub(crate) fn unit(plain: &str) -> String {
    match plain.split_once('^') {
        None if plain == "1" => String::new(),
        Some((base, "0.5")) => format!("√{base}"),
        Some((base, power)) => format!("{base}{}", superscript(power)),
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
    if distinct.len() > 1 {
        distinct.iter_mut().filter(|unit| unit.is_empty()).for_each(|unit| unit.push('1'));
    }
    distinct.join(" or ")
}

/// ` in rad` behind a name, and nothing for a pure number.
pub(crate) fn in_unit(unit: &str) -> String {
    if matches!(unit, "" | "1") { String::new() } else { format!(" in {unit}") }
}

/// `2.5e-4` as [`number`] writes it, `2.5 × 10⁻⁴`, wherever a word is such a number.
fn powers(words: &str) -> String {
    let is_part = |c: char| c.is_alphanumeric() || "._-−".contains(c);
    let told = |token: &str| {
        let word = token.trim_end_matches(|c| !is_part(c)).trim_end_matches('.');
        let (digits, power) = word.split_once('e')?;
        let is_number = digits.trim_start_matches(['-', '−']).starts_with(|c: char| c.is_ascii_digit());
        digits.replace('−', "-").parse::<f64>().ok().filter(|_| is_number)?;
        power.parse::<i32>().ok()?;
        Some(format!("{}{}", with_power(word).replace('-', "−"), &token[word.len()..]))
    };
    words.split_inclusive(|c| !is_part(c)).map(|token| told(token).unwrap_or_else(|| token.to_owned())).collect()
}

/// A sentence of the program, in which backticks stand around what is code; one without a partner stays as it is.
pub(crate) fn prose(words: &str) -> Markup {
    let parts: Vec<&str> = words.split('`').collect();
    let is_code = |k: usize| k % 2 == 1 && k + 1 < parts.len() && !parts[k].is_empty();
    html! {
        @for (k, part) in parts.iter().enumerate() {
            @if is_code(k) { code { (part) } }
            @else if k % 2 == 0 { (powers(part)) }
            // What is not closed, or has nothing in it, keeps its backticks.
            @else { "`" (part) @if k + 1 < parts.len() { "`" } }
        }
    }
}

/// A time of a run to about a thousandth of its horizon, and not later than it is.
pub(crate) fn time_reached(until_s: f64, end_s: f64) -> String {
    let places = (3.0 - end_s.log10().ceil()).clamp(0.0, 9.0) as usize;
    let part = 10_f64.powi(-(places as i32));
    // 0.29 stays 0.29.
    let shown_s = (until_s / part * (1.0 + 1e-12)).floor() * part;
    format!("{shown_s:.places$} s of {end_s} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_sentences_are_written_as_others_are() {
        let cases = [
            ("at most 2.59e-4 rad.", "at most 2.59 × 10⁻⁴ rad."),
            ("(1e12, -3.0e-9) and 1e-5.", "(1 × 10¹², −3.0 × 10⁻⁹) and 1 × 10⁻⁵."),
            ("arm-1e5, pe2, 3e, e5, 0x1e5, 1.2.3e4 and 12e45e6", "arm-1e5, pe2, 3e, e5, 0x1e5, 1.2.3e4 and 12e45e6"),
            ("1.5e", "1.5e"),
        ];
        for (words, wanted) in cases {
            assert_eq!(powers(words), wanted);
        }
        assert_eq!(prose("`1e-4` of 1e-4").into_string(), "<code>1e-4</code> of 1 × 10⁻⁴");
    }

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
    }

    #[test]
    fn units_are_named_once() {
        let all = ["rad", "m", "rad", "m"].map(String::from).into_iter();
        assert_eq!(units(all), "rad or m");
        assert_eq!(units(["rad/s^2".to_owned()].into_iter()), "rad/s²");
        assert_eq!(units(["1", "1"].map(String::from).into_iter()), "");
        assert_eq!(units(["1", "m"].map(String::from).into_iter()), "1 or m");
        assert_eq!([in_unit("1"), in_unit(""), in_unit("m")], ["", "", " in m"]);
    }

    #[test]
    fn what_stands_between_backticks_is_code_and_everything_is_escaped() {
        for (words, page) in [
            ("no code", "no code"),
            ("set `time.end_s = 230` or `rate`", "set <code>time.end_s = 230</code> or <code>rate</code>"),
            ("(`a < b`) & <b>", "(<code>a &lt; b</code>) &amp; &lt;b&gt;"),
            ("`</code><script>` x", "<code>&lt;/code&gt;&lt;script&gt;</code> x"),
            ("one ` alone", "one ` alone"),
            ("`a` and ` alone", "<code>a</code> and ` alone"),
            ("nothing in ``", "nothing in ``"),
            ("`", "`"),
            ("", ""),
        ] {
            assert_eq!(prose(words).into_string(), page, "{words}");
        }
    }

    #[test]
    fn a_run_is_never_said_to_be_farther_than_it_is() {
        for (until_s, end_s, said) in [
            (0.6, 2000.0, "0 s of 2000 s"),
            (1999.99, 2000.0, "1999 s of 2000 s"),
            (12.39, 60.0, "12.3 s of 60 s"),
            (0.29, 1.0, "0.290 s of 1 s"),
            (0.5, 0.5, "0.500 s of 0.5 s"),
            (60.0, 60.0, "60.0 s of 60 s"),
        ] {
            assert_eq!(time_reached(until_s, end_s), said);
        }
    }
}
