//! Numbers as people read them.

/// Stands for a blank at which no line may break.
pub(crate) const TIE: &str = "\u{a0}";

/// The units that messages write behind a number. What is longer is a word, and none of them is one.
const UNITS: [&str; 23] = [
    "s", "ms", "µs", "m", "mm", "kg", "kg/s", "N", "J", "W", "Hz", "rad", "rad/s", "rad/s²", "m/s", "m/s²", "1/s",
    "1/s²", "%", "kB", "MB", "GB", "×",
];

use forwardstep::sim::quantity::with_power;

/// Three digits, with a power of ten where the number is very small or large.
pub(crate) fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if (0.01..1e5).contains(&size) {
        let places = (2.0 - size.log10().floor()).max(0.0) as usize;
        format!("{value:.places$}")
    } else {
        with_power(&format!("{value:.2e}"))
    }
}

/// The same text with a [`TIE`] between a number and its unit, and within a power of ten and a unit of two letters.
pub(crate) fn with_units(text: &str) -> String {
    let is_digit = |c: char| c.is_ascii_digit() || "⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c);
    let bare = |word: &str| word.trim_end_matches(['.', ',', ';', ':', ')']).len();
    let mut words = text.split(' ');
    let mut before = words.next().unwrap_or_default();
    let mut tied = before.to_owned();
    let mut is_size = false;
    for word in words {
        let unit = &word[..bare(word)];
        let is_unit = before.ends_with(is_digit) && UNITS.contains(&unit);
        let goes_on = before == "×" || is_size && before == "N" && unit == "m";
        tied += if is_unit || goes_on { TIE } else { " " };
        tied += word;
        (before, is_size) = (word, is_unit);
    }
    tied
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_do_not_break_within_a_size() {
        let shown = |text: &str| with_units(text).replace(TIE, "_");
        assert_eq!(
            shown("at 33.68 N m, 2.5 × 10⁻⁴ rad/s (12 %) by 40 s; 3 robots"),
            "at 33.68_N_m, 2.5_×_10⁻⁴_rad/s (12_%) by 40_s; 3 robots"
        );
        assert_eq!(shown("  two  gaps stay, N m alone too"), "  two  gaps stay, N m alone too");
        assert_eq!(shown(""), "");
    }
}
