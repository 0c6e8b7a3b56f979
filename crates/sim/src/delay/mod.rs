//! Communication delays T(t), evaluated at reception.
//!
//! A delay is smooth on *pieces*; it may jump from one to the next. The integrator lands on every piece's end and keeps
//! to one piece during a step, so that a jump has a left and a right side.
//!
//! Links that carry packets hold the newest message that has arrived until a newer one does ([`packets`]): a saw-tooth of
//! slope one, drawn for every edge from a stream of its own. So are the values of a [`RandomHold`].

mod known;
pub mod packets;
mod random_hold;

use std::sync::Arc;

use forwardstep_core::Scalar;
use forwardstep_core::expression::{Interval, bisect};

use crate::formula::BoundedFormula;
pub use known::{Basis, Known, Unknown};
pub use packets::{Loss, Packet, PacketLink, Trace};
pub use random_hold::RandomHold;

/// Halvings of a stretch in which arrivals through a formula are looked for.
const CUTS: usize = 12;

/// A delay as a function of time; all of its values are non-negative and finite.
#[derive(Clone, Debug, PartialEq)]
pub enum Delay {
    /// T = s.
    Constant {
        /// In s; may be zero.
        s: f64,
    },
    /// T = mean + amplitude · sin(2π t / period + phase).
    Sinusoid {
        /// In s; at least the amplitude.
        mean_s: f64,
        /// In s.
        amplitude_s: f64,
        /// In s.
        period_s: f64,
        /// In rad.
        phase_rad: f64,
    },
    /// T = `values_s[k]` from `times_s[k]` until the next time.
    PiecewiseConstant {
        /// Rising, the first is zero, s.
        times_s: Vec<f64>,
        /// As many values, s.
        values_s: Vec<f64>,
        /// Repeat after this long, s; more than the last time.
        period_s: Option<f64>,
    },
    /// T = min + (max − min) · frac((t + offset) / period): rises, then drops. A slope of one is a packet held until the
    /// next.
    SawTooth {
        /// In s.
        min_s: f64,
        /// In s.
        max_s: f64,
        /// In s.
        period_s: f64,
        /// In s.
        offset_s: f64,
    },
    /// A formula in t, shown not to be negative up to the end of the run.
    Formula(Arc<BoundedFormula>),
    /// Values drawn at random, each held for a time drawn at random.
    RandomHold(Arc<RandomHold>),
    /// The newest packet that has arrived is held until a newer one does.
    Packets(Arc<Trace>),
}

/// A stretch of time on which a delay is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DelayPiece {
    /// Its number, counted from the piece that holds t = 0.
    pub index: u64,
    /// From here on, s.
    pub start_s: f64,
    /// Until here, s; infinite for the last.
    pub end_s: f64,
}

impl Delay {
    /// Checks the parameters; the error is (parameter, value, what it must be).
    pub(crate) fn validate(&self) -> Result<(), (&'static str, f64, &'static str)> {
        const NON_NEGATIVE: &str = "must be finite and not negative";
        const POSITIVE: &str = "must be positive and finite";
        let non_negative = |name, value: f64| {
            if value >= 0.0 && value.is_finite() { Ok(()) } else { Err((name, value, NON_NEGATIVE)) }
        };
        let positive =
            |name, value: f64| if value > 0.0 && value.is_finite() { Ok(()) } else { Err((name, value, POSITIVE)) };
        match self {
            Delay::Constant { s } => non_negative("the delay", *s),
            Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
                positive("the period", *period_s)?;
                non_negative("the mean", *mean_s)?;
                non_negative("the size of the phase", phase_rad.abs())?;
                if amplitude_s.abs() <= *mean_s {
                    Ok(())
                } else {
                    Err(("the amplitude", *amplitude_s, "must not exceed the mean, or the delay would become negative"))
                }
            }
            Delay::PiecewiseConstant { times_s, values_s, period_s } => {
                if times_s.len() != values_s.len() || times_s.is_empty() {
                    return Err((
                        "the number of values",
                        values_s.len() as f64,
                        "must be that of the times, and not zero",
                    ));
                }
                values_s.iter().try_for_each(|value| non_negative("a value", *value))?;
                if times_s[0] != 0.0 {
                    return Err(("the first time", times_s[0], "must be zero"));
                }
                for pair in times_s.windows(2) {
                    if !(pair[1] > pair[0] && pair[1].is_finite()) {
                        return Err(("a time", pair[1], "must be finite and later than the one before"));
                    }
                }
                match (period_s, times_s.last()) {
                    (Some(period), Some(last)) if !(period > last && period.is_finite()) => {
                        Err(("the period", *period, "must be finite and longer than the last time"))
                    }
                    _ => Ok(()),
                }
            }
            Delay::SawTooth { min_s, max_s, period_s, offset_s } => {
                positive("the period", *period_s)?;
                non_negative("the minimum", *min_s)?;
                non_negative("the maximum", *max_s)?;
                non_negative("the size of the offset", offset_s.abs())?;
                if max_s >= min_s { Ok(()) } else { Err(("the maximum", *max_s, "must not be below the minimum")) }
            }
            Delay::Formula(formula) => {
                let within = formula.within();
                non_negative("the lower bound of the formula", within.low)?;
                non_negative("the upper bound of the formula", within.high)
            }
            // Both are made by functions that check.
            Delay::RandomHold(_) | Delay::Packets(_) => Ok(()),
        }
    }

    /// Until when this is known, s; `None` for ever.
    pub(crate) fn known_until_s(&self) -> Option<f64> {
        match self {
            Delay::Formula(formula) => Some(formula.until_s()),
            Delay::RandomHold(hold) => Some(hold.until_s()),
            Delay::Packets(trace) => Some(trace.until_s()),
            Delay::Constant { .. }
            | Delay::Sinusoid { .. }
            | Delay::PiecewiseConstant { .. }
            | Delay::SawTooth { .. } => None,
        }
    }

    /// The piece that holds t = 0 from the right.
    pub fn first_piece(&self) -> DelayPiece {
        self.piece(0)
    }

    /// The piece after this one; its own copy when it is the last.
    pub fn next_piece(&self, piece: DelayPiece) -> DelayPiece {
        if piece.end_s.is_infinite() { piece } else { self.piece(piece.index + 1) }
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let (start_s, end_s) = match self {
            Delay::Constant { .. } | Delay::Sinusoid { .. } => (0.0, f64::INFINITY),
            Delay::Formula(formula) => {
                let kink_s = |k: u64| formula.kinks_s().get(k as usize).copied();
                let start_s = index.checked_sub(1).map_or(Some(0.0), kink_s);
                (start_s.unwrap_or(f64::INFINITY), kink_s(index).unwrap_or(f64::INFINITY))
            }
            Delay::RandomHold(hold) => hold.span(index),
            Delay::Packets(trace) => trace.span(index),
            Delay::PiecewiseConstant { times_s, period_s, .. } => {
                let (repeat, k) = self.repeat_of(index, times_s.len());
                match period_s {
                    Some(period) => {
                        let base = repeat as f64 * period;
                        let end = times_s.get(k + 1).map_or((repeat + 1) as f64 * period, |t| base + t);
                        (base + times_s[k], end)
                    }
                    None => (times_s[k], times_s.get(k + 1).copied().unwrap_or(f64::INFINITY)),
                }
            }
            Delay::SawTooth { period_s, offset_s, .. } => {
                (tooth_start(*period_s, *offset_s, index), tooth_start(*period_s, *offset_s, index + 1))
            }
        };
        DelayPiece { index, start_s, end_s }
    }

    /// Which repetition and which entry of a piecewise constant delay a piece is.
    fn repeat_of(&self, index: u64, entries: usize) -> (u64, usize) {
        match self {
            Delay::PiecewiseConstant { period_s: Some(_), .. } => {
                (index / entries as u64, (index % entries as u64) as usize)
            }
            _ => (0, (index as usize).min(entries - 1)),
        }
    }

    /// T(t) by the formula of `piece`, which also gives the one-sided values at its ends.
    pub fn value_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, period_s, phase_rad } => {
                let angle = Scalar::mul_add(core::f64::consts::TAU / period_s, t_s, *phase_rad);
                // Rounding must not make a delay whose amplitude equals its mean negative.
                Scalar::mul_add(*amplitude_s, Scalar::sin_cos(angle).0, *mean_s).max(0.0)
            }
            Delay::PiecewiseConstant { times_s, values_s, .. } => {
                values_s[self.repeat_of(piece.index, times_s.len()).1]
            }
            Delay::SawTooth { min_s, max_s, period_s, .. } => {
                Scalar::mul_add((max_s - min_s) / period_s, t_s - piece.start_s, *min_s).clamp(*min_s, *max_s)
            }
            Delay::Formula(formula) => formula.value(t_s),
            Delay::RandomHold(hold) => hold.value(piece.index),
            // Before anything has arrived the initial message is heard, which was sent again, one may say, at t = 0.
            Delay::Packets(trace) => (t_s - trace.sent_s(piece.index).max(0.0)).max(0.0),
        }
    }

    /// When what is heard at `t_s` was sent, by the formula of `piece`: t − T(t), and exactly the packet's own time where
    /// packets are held; −∞ before any has arrived.
    #[inline]
    pub fn sent_on(&self, piece: DelayPiece, t_s: f64) -> f64 {
        match self {
            Delay::Packets(trace) => trace.sent_s(piece.index),
            _ => t_s - self.value_on(piece, t_s),
        }
    }

    /// T(t), from the right where it jumps.
    pub fn value(&self, t_s: f64) -> f64 {
        self.value_on(self.piece_at(t_s), t_s)
    }

    /// The piece in force at `t_s` ≥ 0, from the right.
    pub fn piece_at(&self, t_s: f64) -> DelayPiece {
        let guess = match self {
            Delay::Constant { .. } | Delay::Sinusoid { .. } => 0,
            Delay::Formula(formula) => formula.kinks_s().partition_point(|kink_s| *kink_s <= t_s) as u64,
            Delay::RandomHold(hold) => return self.piece(hold.index_at(t_s)),
            Delay::Packets(trace) => return self.piece(trace.index_at(t_s)),
            Delay::PiecewiseConstant { times_s, period_s, .. } => {
                let repeat = period_s.map_or(0.0, |period| (t_s / period).floor().max(0.0));
                let within = t_s - repeat * period_s.unwrap_or(0.0);
                repeat as u64 * times_s.len() as u64 + times_s.partition_point(|start| *start <= within) as u64
            }
            Delay::SawTooth { period_s, offset_s, .. } => {
                (((t_s + offset_s) / period_s).floor() - (offset_s / period_s).floor()).max(0.0) as u64
            }
        };
        // The quotient may be off by one in either direction; the piece's own ends decide.
        let mut piece = self.piece(guess.saturating_sub(2));
        while piece.end_s <= t_s {
            piece = self.next_piece(piece);
        }
        piece
    }

    /// An upper bound of T over all time, or for as long as T is known, s.
    pub fn max_s(&self) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, .. } => mean_s + amplitude_s.abs(),
            Delay::PiecewiseConstant { values_s, .. } => values_s.iter().copied().fold(0.0, f64::max),
            Delay::SawTooth { max_s, .. } => *max_s,
            Delay::Formula(formula) => formula.within().high,
            Delay::RandomHold(hold) => hold.value_s[1],
            Delay::Packets(trace) => trace.max_s(),
        }
    }

    /// A lower bound of T over all time, or for as long as T is known, s.
    pub fn min_s(&self) -> f64 {
        match self {
            Delay::Constant { s } => *s,
            Delay::Sinusoid { mean_s, amplitude_s, .. } => (mean_s - amplitude_s.abs()).max(0.0),
            Delay::PiecewiseConstant { values_s, .. } => values_s.iter().copied().fold(f64::INFINITY, f64::min),
            Delay::SawTooth { min_s, .. } => *min_s,
            Delay::Formula(formula) => formula.within().low,
            Delay::RandomHold(hold) => hold.value_s[0],
            Delay::Packets(trace) => trace.min_s(),
        }
    }

    /// Whether T does not change with time.
    pub fn is_constant(&self) -> bool {
        match self {
            Delay::Packets(_) => false,
            Delay::Formula(formula) => formula.formula().is_constant(),
            Delay::Constant { .. }
            | Delay::Sinusoid { .. }
            | Delay::PiecewiseConstant { .. }
            | Delay::SawTooth { .. }
            | Delay::RandomHold(_) => self.min_s() == self.max_s(),
        }
    }

    /// Whether the two are the same without looking at every packet.
    pub(crate) fn shares(&self, other: &Delay) -> bool {
        match (self, other) {
            (Delay::Packets(trace), Delay::Packets(other)) => Arc::ptr_eq(trace, other),
            (Delay::RandomHold(hold), Delay::RandomHold(other)) => Arc::ptr_eq(hold, other),
            _ => self == other,
        }
    }

    /// Appends every t > `sent_s` at which something sent at `sent_s` is heard: the solutions of t − T(t) = `sent_s`.
    /// Nothing is looked for after `until_s`, since a delay may be longer than any run.
    ///
    /// A stretch on which t − T(t) stands still (a held packet) has no inner solutions: its ends are jumps of the delay
    /// and break-points anyway.
    pub fn arrivals(&self, sent_s: f64, until_s: f64, arrivals: &mut Vec<f64>) {
        if let Delay::Constant { s } = self {
            if *s > 0.0 {
                arrivals.push(sent_s + s);
            }
            return;
        }
        if let Delay::Packets(_) = self {
            return;
        }
        // Rounded up, so that the arrival of a constant delay is inside the stretch searched.
        let last = (sent_s + self.max_s()).next_up().next_up().min(until_s);
        let mut piece = self.piece_at(sent_s.max(0.0));
        loop {
            let from = piece.start_s.max(sent_s);
            let to = piece.end_s.min(last);
            if to >= from {
                self.arrivals_on(piece, [from, to], sent_s, arrivals);
            }
            if piece.end_s > last {
                break;
            }
            piece = self.next_piece(piece);
        }
    }

    fn arrivals_on(&self, piece: DelayPiece, [from, to]: [f64; 2], sent_s: f64, arrivals: &mut Vec<f64>) {
        // Between its turning points t − T(t) is monotone, so a change of sign brackets exactly one arrival.
        let early = |t: f64| t - self.value_on(piece, t) - sent_s;
        if let Delay::Formula(formula) = self {
            // Nothing is known of its slope: the stretch is cut until t − T(t) cannot be `sent_s` on a part, or the part
            // is short. Two arrivals within one short part may be missed; they are kinks that the error control sees.
            let mut waiting = [(0.0, 0.0); CUTS + 2];
            waiting[0] = (from, to);
            let (mut count, shortest_s) = (1, (to - from) / f64::from(1 << CUTS));
            while count > 0 {
                count -= 1;
                let (left, right) = waiting[count];
                let delay = formula.formula().enclose(Interval { low: left, high: right });
                if left - delay.high > sent_s || right - delay.low < sent_s {
                    continue;
                }
                let middle = left + 0.5 * (right - left);
                if right - left <= shortest_s || middle <= left || middle >= right {
                    let (early_left, early_right) = (early(left), early(right));
                    if early_left < 0.0 && early_right >= 0.0 || early_left > 0.0 && early_right <= 0.0 {
                        let arrival = bisect(early, left, right, early_left < 0.0);
                        if arrival > sent_s {
                            arrivals.push(arrival);
                        }
                    }
                    continue;
                }
                // The earlier half on top; the stack is never higher than the number of cuts.
                waiting[count] = (middle, right);
                waiting[count + 1] = (left, middle);
                count += 2;
            }
            return;
        }
        let mut left = from;
        let mut f_left = early(left);
        let mut visit = |right: f64| {
            let f_right = early(right);
            if f_left < 0.0 && f_right >= 0.0 || f_left > 0.0 && f_right <= 0.0 {
                let arrival = bisect(early, left, right, f_left < 0.0);
                if arrival > sent_s {
                    arrivals.push(arrival);
                }
            }
            (left, f_left) = (right, f_right);
        };
        if let Delay::Sinusoid { amplitude_s, period_s, phase_rad, .. } = self {
            // d/dt (t − T) = 1 − a ω cos(ω t + φ) vanishes where cos = 1/(a ω).
            let omega = core::f64::consts::TAU / period_s;
            let cosine = 1.0 / (amplitude_s * omega);
            if cosine.abs() < 1.0 {
                // Two families of turning points, one period apart each; taken in turn, the earlier first.
                let angle = libm::acos(cosine);
                let first = |sign: f64| {
                    let base = (sign * angle - phase_rad) / omega;
                    base + ((from - base) / period_s).ceil() * period_s
                };
                let mut next = [first(-1.0), first(1.0)];
                loop {
                    let earlier = usize::from(next[1] < next[0]);
                    if next[earlier] >= to {
                        break;
                    }
                    visit(next[earlier]);
                    next[earlier] += period_s;
                }
            }
        }
        visit(to);
    }
}

/// Where a saw-tooth's piece begins; piece 0 holds t = 0.
fn tooth_start(period_s: f64, offset_s: f64, index: u64) -> f64 {
    ((offset_s / period_s).floor() + index as f64) * period_s - offset_s
}

#[cfg(test)]
mod tests;
