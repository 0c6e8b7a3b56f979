//! When a disagreement has settled.

/// What is left of the disagreement at the start once it has settled.
pub const SHARE: f64 = 0.01;

/// When the disagreement exceeds 1 % of what it is at the start for the last time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settled {
    /// Then, s; between two rows the logarithm is taken to be a straight line.
    At(f64),
    /// It still does at the last row, or is below it there only in passing, see [`only_passes`].
    NotYet,
    /// There is no disagreement at the start to compare with.
    NoStart,
}

impl Settled {
    /// The time, s, if it has settled.
    pub fn time_s(self) -> Option<f64> {
        match self {
            Settled::At(t_s) => Some(t_s),
            Settled::NotYet | Settled::NoStart => None,
        }
    }
}

/// When `disagreement`, row by row at `t_s`, has settled.
pub fn settled(t_s: &[f64], disagreement: &[f64]) -> Settled {
    let Some(start) = disagreement.first().copied().filter(|start| *start > 0.0) else { return Settled::NoStart };
    let bound = SHARE * start;
    // What is no number exceeds every bound.
    let exceeds = |d: &f64| d.is_nan() || *d > bound;
    let Some(last) = disagreement.iter().rposition(exceeds) else { return Settled::NoStart };
    let rows = t_s.get(last).zip(t_s.get(last + 1)).zip(disagreement.get(last + 1));
    let Some(((from_s, to_s), below)) = rows else { return Settled::NotYet };
    if only_passes(t_s, disagreement, bound) {
        return Settled::NotYet;
    }
    let share = libm::log(disagreement[last] / bound) / libm::log(disagreement[last] / below);
    // Where the disagreement vanishes at a row the logarithm has no straight line.
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    Settled::At(from_s + share * (to_s - from_s))
}

/// A gap that has been below its bound for this share of the time before is not asked how fast it moves.
const STAYS: f64 = 0.02;

/// Whether what is at most `bound` at the last row is so only in passing: it was so for as long before, and left again, or it moves so fast that it
/// would not be for a fiftieth of the time that it took.
///
/// What decays at a rate r to a hundredth takes 4.6/r, and moves by 0.09 of its bound in that share of it; what swings through zero moves by
/// a multiple of its bound.
pub fn only_passes(t_s: &[f64], gap: &[f64], bound: f64) -> bool {
    let exceeds = |d: &f64| d.is_nan() || *d > bound;
    let rows = t_s.len().min(gap.len());
    let (t_s, gap) = (&t_s[..rows], &gap[..rows]);
    let Some(last_above) = gap.iter().rposition(exceeds).filter(|row| row + 1 < rows) else { return false };
    let (begin_s, end_s) = (t_s[last_above + 1], t_s[rows - 1]);
    // Of what was below before: when it came to be so.
    let (mut since_s, mut longest_s) = (None, 0.0_f64);
    for row in 1..=last_above {
        match (exceeds(&gap[row - 1]), exceeds(&gap[row])) {
            (true, false) => since_s = Some(t_s[row]),
            (false, true) => longest_s = longest_s.max(since_s.take().map_or(0.0, |since_s| t_s[row] - since_s)),
            _ => {}
        }
    }
    let stayed_s = end_s - begin_s;
    let lasts_s = STAYS * (begin_s - t_s[0]);
    let speed = |row: usize| {
        let (before, now, took_s) = (gap[row - 1], gap[row], t_s[row] - t_s[row - 1]);
        // From far above the bound it falls by as much of itself all the time, as what decays does: rows may be few.
        let fell = if row == last_above + 1 { now * libm::log(before / now) } else { now - before };
        libm::fabs(fell) / took_s
    };
    let speeds = (last_above + 1..rows).map(speed).filter(|speed| speed.is_finite());
    stayed_s < longest_s || stayed_s < lasts_s && speeds.fold(0.0, f64::max) * lasts_s > bound
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two masses that pass each other are together at one instant.
    #[test]
    fn regress_what_passes_has_not_settled() {
        let t_s: Vec<f64> = (0..=4000).map(|k| 0.01 * f64::from(k)).collect();
        let swing: Vec<f64> = t_s.iter().map(|t| libm::fabs(libm::exp(-0.12 * t) * libm::cos(0.57 * t))).collect();
        let upto = |end_s: f64| {
            let rows = t_s.partition_point(|t| *t <= end_s);
            settled(&t_s[..rows], &swing[..rows])
        };
        let last_s = t_s[swing.iter().rposition(|d| *d > SHARE).unwrap_or(0)];
        for crossing in 0..8 {
            let at_s = (f64::from(crossing) + 0.5) * std::f64::consts::PI / 0.57;
            if at_s < last_s {
                assert_eq!(upto(at_s + 0.01), Settled::NotYet, "{at_s}");
            }
        }
        assert!(matches!(upto(40.0), Settled::At(t) if (t - last_s).abs() < 0.01));
    }

    #[test]
    fn what_was_below_for_longer_and_left_has_not_settled() {
        let t_s: Vec<f64> = (0..12).map(f64::from).collect();
        let gap = [1.0, 0.001, 0.001, 0.001, 1.0, 0.5, 0.1, 0.02, 0.009, 0.0085, 0.008, 0.0079];
        assert_eq!(settled(&t_s[..10], &gap[..10]), Settled::NotYet);
        assert!(matches!(settled(&t_s, &gap), Settled::At(t) if t > 7.0 && t < 8.0));
        // What is small from the start on, before it grows, did not come to be so.
        assert!(!only_passes(&t_s, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.02, 0.009, 0.008], 0.01));
    }

    #[test]
    fn it_is_the_last_time_above_one_percent_of_the_start() {
        let exponential: Vec<f64> = (0..100).map(|k| 3.0 * (-0.1 * k as f64).exp()).collect();
        let t_s: Vec<f64> = (0..100).map(f64::from).collect();
        let Settled::At(at) = settled(&t_s, &exponential) else { panic!("it has settled") };
        assert!((at - 10.0 * 100.0_f64.ln()).abs() < 1e-9, "{at}");
        let again = [1.0, 0.001, 0.5, 0.001, 0.0];
        assert!(matches!(settled(&t_s, &again), Settled::At(t) if t > 2.0 && t < 3.0), "{:?}", settled(&t_s, &again));
        assert_eq!(settled(&t_s, &[1.0, 0.0]), Settled::At(0.0));
        assert_eq!(settled(&t_s, &[1.0, 0.011]), Settled::NotYet);
        assert_eq!(settled(&t_s, &[1.0, f64::NAN]), Settled::NotYet);
        assert_eq!(settled(&t_s, &[1.0, f64::NAN, 0.0]), Settled::At(1.0));
        assert_eq!(settled(&t_s, &[0.0, 0.5]), Settled::NoStart);
        assert_eq!(settled(&t_s, &[]), Settled::NoStart);
    }
}
