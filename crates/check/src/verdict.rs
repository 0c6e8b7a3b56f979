//! Answers to "does this theorem apply?", hypothesis by hypothesis.

/// The theorems that were looked at, in the order in which they should be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The theorem that speaks about this setup, for example `Theorem 2`.
    pub theorem: String,
    /// What it promises, in one sentence.
    pub promises: String,
    /// Its hypotheses and what was found.
    pub hypotheses: Vec<Hypothesis>,
}

/// One hypothesis.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// What is required, in words.
    pub requires: String,
    /// What was found.
    pub answer: Answer,
    /// Certificate or witness in words: the smallest window and its root, the unreachable agent, …
    pub because: String,
}

/// The answers, from best to worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Answer {
    /// For all time.
    Holds,
    /// Only shown on the horizon of the run.
    HoldsOnHorizon,
    /// Only a run can show it: one in which it fails stops there.
    Watched,
    /// The paper does not speak about this case.
    NotCovered,
    /// It fails, and `because` names a witness.
    Violated,
}

impl Answer {
    /// The words used in tables: `holds`, `holds on [0, end]`, `watched during the run`,
    /// `not covered by the paper`, `violated`.
    pub fn words(self) -> &'static str {
        match self {
            Answer::Holds => "holds",
            Answer::HoldsOnHorizon => "holds on [0, end]",
            Answer::Watched => "watched during the run",
            Answer::NotCovered => "not covered by the paper",
            Answer::Violated => "violated",
        }
    }
}

impl Report {
    /// The worst answer of all hypotheses; [`Answer::Holds`] when there are none.
    pub fn worst(&self) -> Answer {
        self.hypotheses.iter().map(|h| h.answer).max().unwrap_or(Answer::Holds)
    }
}

/// A number with at most four digits, for reading.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Rounded up to four digits.
pub(crate) fn rounded_up(value: f64) -> f64 {
    let four = |value: f64| format!("{value:.3e}");
    let number = |text: &str| text.parse::<f64>().unwrap_or(value);
    let near = four(value);
    if number(&near) >= value || !value.is_finite() {
        return number(&near);
    }
    let exponent: i32 = near.rsplit('e').next().and_then(|exponent| exponent.parse().ok()).unwrap_or(0);
    number(&four(number(&near) + number(&format!("1e{}", exponent - 3))))
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
