//! What a formula keeps within, by one pass of interval arithmetic on each of some equal pieces: the least that a checker needs.

use forwardstep_core::expression::{Expression, Interval};

use super::exact::{above, below};
use super::period::period_s;
use super::proof::{Enclosure, Range};

/// How many pieces are tried.
const CELLS: [usize; 6] = [1, 8, 32, 128, 512, 2048];
/// Room, as a part, for the ends of pieces, which are rounded here and exact elsewhere.
const ROOM: f64 = 1e-9;

/// All t from zero on.
const FOR_EVER: Interval = Interval { low: 0.0, high: f64::INFINITY };

/// How far a proof has to reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// For all time.
    ForEver,
    /// Up to the end of the run, or further.
    Run,
}

/// The first stretch on which `formula` keeps within something that is `good`: for ever, over a period, up to `end_s`.
pub(super) fn enclosed(
    formula: &Expression,
    end_s: f64,
    reach: Reach,
    good: impl Fn(Interval) -> bool,
) -> Option<Enclosure> {
    found(formula, |t| formula.enclose(t), end_s, reach, good)
}

/// The same for what is made of a formula and has its period, as its derivatives have.
pub(super) fn found(
    formula: &Expression,
    enclose: impl Fn(Interval) -> Interval,
    end_s: f64,
    reach: Reach,
    good: impl Fn(Interval) -> bool,
) -> Option<Enclosure> {
    let good = |within: &Interval| within.is_finite() && good(*within);
    let whole = Some(enclose(FOR_EVER)).filter(good);
    if let Some(within) = whole {
        return Some(stated(Range::ForEver, within));
    }
    let cut = |until_s: f64, range: fn(usize) -> Range| {
        CELLS.into_iter().find_map(|cells| {
            let at = |k: usize| until_s * k as f64 / cells as f64;
            let pieces = (0..cells).map(|k| enclose(Interval { low: at(k), high: at(k + 1) }));
            let hull = pieces.reduce(Interval::hull).filter(|hull| hull.is_finite())?;
            let within = Some(hull.with_room(ROOM * hull.size())).filter(good)?;
            Some(stated(range(cells), within))
        })
    };
    let period = period_s(formula).and_then(|period_s| cut(period_s, |cells| Range::Period { cells }));
    match reach {
        Reach::ForEver => period,
        Reach::Run => period.or_else(|| cut(end_s, |cells| Range::Run { cells })),
    }
}

fn stated(range: Range, within: Interval) -> Enclosure {
    Enclosure { edge: None, range, within: [below(within.low), above(within.high)] }
}
