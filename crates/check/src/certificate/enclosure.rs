//! What a formula keeps within, by one pass of interval arithmetic on each of some equal pieces: the least that a checker needs.

use forwardstep_core::expression::{Expression, Interval};

use super::exact::{above, below};
use super::late::late;
use super::proof::{Enclosure, Range};
use super::slopes::{on_piece, slope};

/// How many pieces are tried.
const CELLS: [usize; 6] = [1, 8, 32, 128, 512, 2048];
/// Times from which one piece takes all that is left of a formula.
const STARTS_S: [u32; 5] = [1, 16, 64, 256, 1024];
/// Room, as a part, for the ends of pieces, which are rounded here and exact elsewhere.
const ROOM: f64 = 1e-9;

/// The first stretch on which `formula` keeps within something that is `good`: for ever, over a period, or in pieces of which the last
/// has no end.
pub(super) fn enclosed(formula: &Expression, good: impl Fn(Interval) -> bool) -> Option<Enclosure> {
    let slope = slope(formula);
    let enclose = |t: Interval| match t.high.is_finite() {
        true => on_piece(formula, slope.as_ref(), t),
        false => late_or_whole(formula, t),
    };
    found(&Stretches::of(formula), enclose, good)
}

/// What a formula keeps within on a stretch of time, which may have no end.
pub(super) fn late_or_whole(formula: &Expression, t_s: Interval) -> Interval {
    if t_s.high.is_finite() {
        return formula.enclose(t_s);
    }
    if t_s.low > 0.0 {
        return late(formula, t_s.low).within;
    }
    // As a checker does it: up to 1 s, and from there on.
    formula.enclose(Interval { low: 0.0, high: 1.0 }).hull(late(formula, 1.0).within)
}

/// What is tried besides [0, ∞) at once.
pub(super) struct Stretches {
    period_s: Option<f64>,
    /// Times from which one piece takes all that is left.
    starts_s: Vec<u32>,
    /// From when on no edge follows it any more.
    gone_s: Option<f64>,
}

impl Stretches {
    /// Those of a formula, which may repeat.
    pub(super) fn of(formula: &Expression) -> Self {
        Stretches { period_s: formula.period(), starts_s: STARTS_S.to_vec(), gone_s: None }
    }

    /// Those of what stays where it is from a time on.
    pub(super) fn until(last_s: f64) -> Self {
        let whole = last_s.ceil().max(1.0);
        let start_s = (whole <= f64::from(u32::MAX)).then_some(whole as u32);
        Stretches { period_s: None, starts_s: start_s.into_iter().collect(), gone_s: None }
    }
}

/// The same of a formula where the ends matter: one pass in rational numbers ends at zero where rounded ends fall short of it, as
/// 0.2 + 0.2 sin 3 t. What no edge follows any more from `gone_s` on counts until then.
pub(super) fn steady(formula: &Expression, gone_s: Option<f64>, good: impl Fn(Interval) -> bool) -> Option<Enclosure> {
    let slope = slope(formula);
    let enclose = |t: Interval| {
        if t.high.is_finite() {
            return on_piece(formula, slope.as_ref(), t);
        }
        let within = late_or_whole(formula, t);
        let near_zero = within.low < 0.0 && within.low > -ROOM * within.size();
        let touches = near_zero && formula.bounds(t.low, t.high).low >= 0.0;
        Interval { low: if touches { 0.0 } else { within.low }, ..within }
    };
    found(&Stretches { gone_s, ..Stretches::of(formula) }, enclose, good)
}

/// The same for what is made of a formula and has its period, as its derivatives have.
pub(super) fn found(
    stretches: &Stretches,
    enclose: impl Fn(Interval) -> Interval,
    good: impl Fn(Interval) -> bool,
) -> Option<Enclosure> {
    let good = |within: &Interval| within.is_finite() && good(*within);
    let from = |low: f64| enclose(Interval { low, high: f64::INFINITY });
    if let Some(within) = Some(from(0.0)).filter(good) {
        return Some(stated(Range::ForEver, within));
    }
    let cut = |until_s: f64, rest: Option<Interval>, range: &dyn Fn(usize) -> Range| {
        CELLS.into_iter().find_map(|cells| {
            let at = |k: usize| until_s * k as f64 / cells as f64;
            let pieces = (0..cells).map(|k| enclose(Interval { low: at(k), high: at(k + 1) }));
            let hull = pieces.chain(rest).reduce(Interval::hull).filter(|hull| hull.is_finite())?;
            let wide = hull.with_room(ROOM * hull.size());
            // What ends at zero does so exactly.
            let within = Interval { low: if hull.low == 0.0 { 0.0 } else { wide.low }, ..wide };
            good(&within).then(|| stated(range(cells), within))
        })
    };
    let period = || cut(stretches.period_s?, None, &|cells| Range::Period { cells });
    let tail = || {
        stretches.starts_s.iter().find_map(|until_s| {
            let until_s = *until_s;
            let start_s = f64::from(until_s);
            let rest = Some(from(start_s)).filter(good)?;
            cut(start_s, Some(rest), &|cells| Range::Tail { cells, until_s })
        })
    };
    let run = || cut(stretches.gone_s?, None, &|cells| Range::Run { cells });
    period().or_else(tail).or_else(run)
}

fn stated(range: Range, within: Interval) -> Enclosure {
    Enclosure { edge: None, range, within: [below(within.low), above(within.high)] }
}
