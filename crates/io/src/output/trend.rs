//! How what is to vanish moves at the end of a run: closer, away, or neither.

use std::ops::Range;

use super::disagreement::greater;

/// In a quarter of the run a gap that falls becomes smaller than this much of itself.
const FALLS: f64 = 0.9;
/// The same of a gap that falls from row to row.
const FALLS_STEADILY: f64 = 0.999;
/// The same of a gap whose mean falls from each of so many stretches of the last half to the next.
const FALLS_ON_THE_WHOLE: f64 = 0.99;
const STRETCHES: u8 = 8;
/// A gap fell faster before when it did so by this much, of the logarithm of what was left.
const SLOWS: f64 = 1.15;

/// What the gap does at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Trend {
    /// There are too few rows to tell.
    Unknown,
    /// It becomes smaller by this much of itself in a quarter of the run.
    Falls(f64),
    /// It neither falls nor grows much.
    Stays,
    /// It grows.
    Grows,
}

impl Trend {
    /// By the last quarter of the time and the one before it.
    pub(super) fn of(t_s: &[f64], overall: &[f64]) -> Trend {
        let Some((left, steadily)) = left_in_quarter(0, t_s, overall) else { return Trend::Unknown };
        if left < if steadily { FALLS_STEADILY } else { FALLS } {
            return Trend::Falls(left);
        }
        // One peak of noise decides what is largest, and not a mean: it falls, unless it has risen again at the end.
        let mean = |stretch| mean(stretch, t_s, overall);
        let now = mean([0.25, 0.0]) / mean([0.5, 0.25]);
        let falls = if falls_on_the_whole(0, t_s, overall) { FALLS_ON_THE_WHOLE } else { FALLS };
        match mean([0.125, 0.0]) > mean([0.25, 0.125]) {
            false if now < falls => Trend::Falls(now),
            true if left > 1.0 / FALLS => Trend::Grows,
            _ => Trend::Stays,
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Trend::Unknown => "and too few rows tell whether it comes closer",
            Trend::Falls(_) => "and coming closer",
            Trend::Stays => "and not coming closer",
            Trend::Grows => "and getting worse",
        }
    }
}

/// The rows of a stretch of the time, which begins and ends at these parts of it before its end. Rows need not be evenly spaced; the last one counts
/// to the stretch that ends with it.
fn rows_before_end([from, to]: [f64; 2], t_s: &[f64], overall: &[f64]) -> Range<usize> {
    let t_s = &t_s[..t_s.len().min(overall.len())];
    let (Some(begin_s), Some(end_s)) = (t_s.first(), t_s.last()) else { return 0..0 };
    let row_from = |part: f64| t_s.partition_point(|t_s| *t_s < end_s - part * (end_s - begin_s));
    row_from(from)..if to == 0.0 { t_s.len() } else { row_from(to) }
}

/// What is left of a gap in a quarter of the time, that which ends so many `quarters` before the end, and whether it falls there from row to row;
/// `None` where there are too few rows to tell.
///
/// By its largest value there and in the quarter before, which of a gap that falls from row to row is the one at their start: by those at its
/// ends then.
fn left_in_quarter(quarters: u32, t_s: &[f64], overall: &[f64]) -> Option<(f64, bool)> {
    let part = 0.25 * f64::from(quarters);
    let [before, now] =
        [[part + 0.5, part + 0.25], [part + 0.25, part]].map(|part| rows_before_end(part, t_s, overall));
    if before.is_empty() || now.len() < 2 {
        return None;
    }
    let (first, last) = (overall[now.start], overall[now.end - 1]);
    if overall[before.start..now.end].is_sorted_by(|before, after| before >= after) && last < first {
        let quarter_s = 0.25 * (t_s.last()? - t_s.first()?);
        return Some(((last / first).powf(quarter_s / (t_s[now.end - 1] - t_s[now.start])), true));
    }
    Some((largest(&overall[now]) / largest(&overall[before]), false))
}

/// Whether a gap falls from row to row in the last half, not in steps and without ripples.
pub(super) fn falls_steadily(t_s: &[f64], overall: &[f64]) -> bool {
    left_in_quarter(0, t_s, overall).is_some_and(|(_, steadily)| steadily)
}

/// The mean over a stretch of the time; not a number where it has no row.
fn mean(stretch: [f64; 2], t_s: &[f64], overall: &[f64]) -> f64 {
    let rows = &overall[rows_before_end(stretch, t_s, overall)];
    rows.iter().sum::<f64>() / rows.len() as f64
}

/// Whether a gap, whatever ripples it has, falls in the half of the time that ends so many `quarters` before the end: by the means of its stretches.
fn falls_on_the_whole(quarters: u32, t_s: &[f64], overall: &[f64]) -> bool {
    let (end, length) = (0.25 * f64::from(quarters), 0.5 / f64::from(STRETCHES));
    let stretch = |k: u8| [end + length * f64::from(k), end + length * f64::from(k - 1)];
    let means: Vec<f64> = (1..=STRETCHES).rev().map(|k| mean(stretch(k), t_s, overall)).collect();
    means.is_sorted_by(|before, after| before > after)
}

fn largest(gaps: &[f64]) -> f64 {
    gaps.iter().copied().fold(0.0, greater)
}

/// Whether a gap that falls does so more slowly than it did: what is left of it after a time is no measure for what a longer time leaves then.
pub(super) fn is_slowing(t_s: &[f64], overall: &[f64]) -> bool {
    // Largest values of a wave beat with the quarters.
    let steadily =
        |quarters| left_in_quarter(quarters, t_s, overall).filter(|(_, steadily)| *steadily).map(|(left, _)| left);
    let on_the_whole = |quarters: u32| {
        let end = 0.25 * f64::from(quarters);
        let left = mean([end + 0.25, end], t_s, overall) / mean([end + 0.5, end + 0.25], t_s, overall);
        falls_on_the_whole(quarters, t_s, overall).then_some(left)
    };
    let rate = |quarters| steadily(quarters).or_else(|| on_the_whole(quarters)).map(|left| -left.ln());
    rate(1).zip(rate(0)).is_some_and(|(before, now)| before > SLOWS * now)
}

/// The largest gap of the last quarter.
pub(super) fn lately(t_s: &[f64], overall: &[f64]) -> f64 {
    largest(&overall[rows_before_end([0.25, 0.0], t_s, overall)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trend_is_that_of_the_last_quarters() {
        let of = |values: &[f64]| {
            let t_s: Vec<f64> = (0..values.len()).map(|row| row as f64).collect();
            Trend::of(&t_s, values)
        };
        assert_eq!(of(&[8.0, 8.0, 8.0, 8.0, 3.0, 4.0, 2.0, 1.0, 2.0]), Trend::Falls(0.5));
        // From row to row, by what is left at the ends.
        assert_eq!(of(&[8.0, 8.0, 8.0, 8.0, 4.0, 3.5, 3.0, 2.0, 1.5]), Trend::Falls(0.5));
        assert_eq!(of(&[8.0, 8.0, 7.9, 7.8, 7.7, 7.6, 7.5, 7.4, 6.9]), Trend::Falls(0.92));
        assert_eq!(of(&[8.0, 8.0, 8.0, 8.0, 8.0, 8.0, 8.0, 8.0, 7.999]), Trend::Stays);
        assert_eq!(of(&[1.0, 1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 2.9, 2.9]), Trend::Stays);
        assert_eq!(of(&[9.0, 9.0, 9.0, 9.0, 2.0, 3.0, 3.0, 4.0, 4.0]), Trend::Grows);
        assert_eq!(of(&[1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Trend::Stays, "nothing is left");
        assert_eq!(of(&[3.0, 2.0, 1.0]), Trend::Unknown, "too short to tell");
    }

    /// One row of noise decides what is largest in a quarter.
    #[test]
    fn regress_a_peak_of_noise_is_no_trend() {
        let t_s: Vec<f64> = (0..=400).map(|row| 0.1 * f64::from(row)).collect();
        let noisy = |peak_s: f64, gap: &dyn Fn(f64) -> f64| {
            let value = |t_s: &f64| gap(*t_s) * if (t_s - peak_s).abs() < 0.01 { 2.0 } else { 1.0 };
            Trend::of(&t_s, &t_s.iter().map(value).collect::<Vec<_>>())
        };
        assert!(matches!(noisy(31.0, &|t_s| (-0.03 * t_s).exp()), Trend::Falls(left) if left < 0.8));
        assert_eq!(noisy(31.0, &|_| 1.0), Trend::Stays);
        // What comes late and stays is no noise.
        assert_eq!(noisy(31.0, &|t_s| if t_s < 36.0 { 1.0 } else { 3.0 }), Trend::Grows);
        assert_ne!(noisy(0.0, &|t_s| if t_s < 38.0 { (-0.1 * t_s).exp() } else { 0.5 }), Trend::Falls(0.5));
    }

    /// 300 agents in a ring came closer by an eighth in the last half, with ripples, and were said not to.
    #[test]
    fn regress_a_gap_that_falls_slowly_with_ripples_falls() {
        let t_s: Vec<f64> = (0..=1000).map(|row| 0.02 * f64::from(row)).collect();
        let of = |gap: &dyn Fn(f64) -> f64| Trend::of(&t_s, &t_s.iter().map(|t_s| gap(*t_s)).collect::<Vec<_>>());
        let ripple = |t_s: f64| 1.0 + 0.002 * (40.0 * t_s).sin();
        assert!(matches!(of(&|t_s| (2.0 - 0.036 * t_s) * ripple(t_s)), Trend::Falls(left) if left > 0.8));
        assert_eq!(of(&ripple), Trend::Stays);
        let slows = |gap: &dyn Fn(f64) -> f64| is_slowing(&t_s, &t_s.iter().map(|t_s| gap(*t_s)).collect::<Vec<_>>());
        assert!(
            slows(&|t_s| 2.0 / (1.0 + 0.2 * t_s) * ripple(t_s)) && !slows(&|t_s| (-0.05 * t_s).exp() * ripple(t_s))
        );
        assert_eq!(of(&|t_s| (1.0 + (-t_s).exp()) * ripple(t_s)), Trend::Stays, "it comes to rest away from zero");
    }

    #[test]
    fn regress_a_trend_does_not_depend_on_where_rows_are() {
        let even: Vec<f64> = (0..=400).map(|row| 0.1 * f64::from(row)).collect();
        let late: Vec<f64> = even.iter().map(|t_s| 40.0 * (t_s / 40.0).powf(0.2)).collect();
        let early: Vec<f64> = even.iter().map(|t_s| 40.0 * (t_s / 40.0).powi(3)).collect();
        for t_s in [even, late, early] {
            let gap: Vec<f64> = t_s.iter().map(|t_s| (-0.1 * t_s).exp()).collect();
            let Trend::Falls(left) = Trend::of(&t_s, &gap) else { panic!("it falls") };
            assert!((left - (-1.0_f64).exp()).abs() < 1e-9, "{left}");
        }
    }

    /// A first minute of two modes told a time after which the slower one was still there, as one that would be enough.
    #[test]
    fn regress_a_gap_that_falls_more_and_more_slowly_is_seen() {
        let t_s: Vec<f64> = (0..=400).map(|row| 0.1 * f64::from(row)).collect();
        let slows = |gap: &dyn Fn(f64) -> f64| is_slowing(&t_s, &t_s.iter().map(|t_s| gap(*t_s)).collect::<Vec<_>>());
        let slow = |t_s: f64| 0.05 * (-0.02 * t_s).exp();
        assert!(!slows(&|t_s| (-0.1 * t_s).exp()) && !slows(&slow), "one mode");
        assert!(slows(&|t_s| (-0.2 * t_s).exp() + slow(t_s)), "a slower one takes over");
        assert!(!slows(&|t_s| (-0.4 * t_s).exp() + 20.0 * slow(t_s)), "it has taken over");
        // Of waves nothing is told, whose quarters differ by where they are cut.
        for turns in 1..40 {
            let wave = |t_s: f64| (0.1 * f64::from(turns) * t_s + 0.3).cos().abs() * (-0.1 * t_s).exp();
            assert!(!slows(&wave), "{turns}");
        }
        assert!(!slows(&|_| 1.0) && !slows(&|_| 0.0) && !slows(&|t_s| t_s));
    }
}
