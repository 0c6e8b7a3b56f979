//! The interval of all cascaded variables ψ and of all messages on their way, as the run took it, beside what is guaranteed of it.

use forwardstep_check::prediction::CascadeSpread;
use serde::Serialize;

use super::super::guarantee::{Guarantee, GuaranteeFound, GuaranteedFall, GuaranteedRepeat};
use super::super::names;
use super::super::record::RunRecord;

/// What is left when it has settled.
const SETTLED: f64 = 0.01;

/// The numbers of its series.
#[derive(Serialize)]
pub(super) struct CascadeIndex {
    unit: String,
    /// The largest length of the interval over all axes.
    width: usize,
    /// What there is at most, for certain and for s ≡ 0.
    guaranteed: Option<usize>,
    /// Its ends, one for every axis; none where positions are to differ by offsets, which are not in it.
    low: Vec<usize>,
    high: Vec<usize>,
}

impl CascadeIndex {
    /// Whether it has a curve of what there is at most.
    pub(super) fn is_guaranteed(&self) -> bool {
        self.guaranteed.is_some()
    }

    /// Of a run; nothing where these variables are not defined or were not recorded.
    pub(super) fn of(record: &RunRecord<'_>, spread: &CascadeSpread, add: &mut impl FnMut(&[f64]) -> usize) -> Self {
        let t_s = &record.outcome.recording.t_s;
        let widths = spread.widths();
        let guaranteed = match record.prediction.as_ref().and_then(|prediction| prediction.guarantee.as_ref()) {
            Some(Guarantee::Found(found)) => widths.first().map(|first| add(&stairs(found, *first, t_s))),
            Some(Guarantee::NoneSince(_)) | None => None,
        };
        let ends = if record.keeps_offsets() { (&[][..], &[][..]) } else { (&spread.low[..], &spread.high[..]) };
        CascadeIndex {
            // The largest over all axes, as of a disagreement.
            unit: names::gap_unit(record.setup),
            width: add(&widths),
            guaranteed,
            low: ends.0.iter().map(|end| add(end)).collect(),
            high: ends.1.iter().map(|end| add(end)).collect(),
        }
    }
}

/// What is left of `first` at most: between two times at which that is shown, what was left at the earlier one, and again and again a part
/// of that where the network repeats itself. That is counted from whole numbers of its times on, which are whole numbers of periods.
fn stairs(found: &GuaranteeFound, first: f64, t_s: &[f64]) -> Vec<f64> {
    let start = GuaranteedFall { t_s: 0.0, left: 1.0 };
    let settled = found.settled_s.map(|t_s| GuaranteedFall { t_s, left: SETTLED });
    let known: Vec<GuaranteedFall> = [start].into_iter().chain(found.falls.iter().copied()).chain(settled).collect();
    let again = |from_s: f64, t_s: f64| {
        let times = |repeat: &GuaranteedRepeat| (t_s / repeat.over_s).floor() - (from_s / repeat.over_s).ceil();
        found.repeat.as_ref().map_or(1.0, |repeat| repeat.left.powf(times(repeat).max(0.0)))
    };
    let left = |t_s: f64| {
        let sure = known.iter().filter(|fall| fall.t_s <= t_s);
        sure.map(|fall| fall.left * again(fall.t_s, t_s)).fold(1.0, f64::min)
    };
    t_s.iter().map(|t_s| first * left(*t_s)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_falls_when_it_is_shown_to() {
        let falls = [(1.0, 0.5), (2.0, 0.1)].map(|(t_s, left)| GuaranteedFall { t_s, left }).to_vec();
        let found = GuaranteeFound { falls, settled_s: None, repeat: None, drawn: false, any_delay: None };
        assert_eq!(stairs(&found, 4.0, &[0.0, 0.99, 1.0, 1.5, 3.0]), [4.0, 4.0, 2.0, 2.0, 0.4]);
    }

    /// The curve ended level though more is known.
    #[test]
    fn regress_what_repeats_goes_on_falling() {
        let falls = [(1.0, 0.8), (2.5, 0.5)].map(|(t_s, left)| GuaranteedFall { t_s, left }).to_vec();
        let repeat = GuaranteedRepeat { over_s: 2.0, windows: None, left: 0.25 };
        let found = GuaranteeFound { falls, settled_s: Some(7.0), repeat: Some(repeat), drawn: false, any_delay: None };
        // 0.25 at 2 s and 0.0625 at 4 s from the start, which is less than half of what is left at 2.5 s; then 1 % at 7 s, and again from 8 s on.
        let at_s = [0.0, 1.0, 2.0, 3.9, 4.0, 6.0, 7.0, 8.0, 10.0];
        let left = [1.0, 0.8, 0.25, 0.25, 0.0625, 0.015625, 0.01, 0.00390625, 0.0009765625];
        assert_eq!(stairs(&found, 1.0, &at_s), left);
    }
}
