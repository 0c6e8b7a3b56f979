//! When what was sent at one time is heard: the solutions of t − T(t) = s.

use forwardstep_core::expression::{Interval, bisect};

use super::{Delay, DelayPiece};

/// Halvings of a stretch of which nothing is known but enclosures.
const CUTS: usize = 12;

/// The search for arrivals on a part of one piece.
#[derive(Debug)]
pub struct Arrivals<'a> {
    delay: &'a Delay,
    piece: DelayPiece,
    span_s: [f64; 2],
    sent_s: f64,
    found: &'a mut Vec<f64>,
}

impl<'a> Arrivals<'a> {
    pub(super) fn new(
        delay: &'a Delay,
        piece: DelayPiece,
        span_s: [f64; 2],
        sent_s: f64,
        found: &'a mut Vec<f64>,
    ) -> Self {
        Arrivals { delay, piece, span_s, sent_s, found }
    }

    /// Where to look, s.
    pub fn span_s(&self) -> [f64; 2] {
        self.span_s
    }

    /// When it was sent, s.
    pub fn sent_s(&self) -> f64 {
        self.sent_s
    }

    /// The piece.
    pub fn piece(&self) -> &DelayPiece {
        &self.piece
    }

    /// It is heard at `t_s`.
    pub fn found(&mut self, t_s: f64) {
        if t_s > self.sent_s && t_s.is_finite() {
            self.found.push(t_s);
        }
    }

    /// Looks where t − T(t) only rises, or only falls.
    pub fn monotone(&mut self) {
        self.between([]);
    }

    /// Looks where t − T(t) is monotone between `turns`, which rise.
    pub fn between(&mut self, turns: impl IntoIterator<Item = f64>) {
        let [mut left, to] = self.span_s;
        for turn in turns.into_iter().take_while(|turn| *turn < to) {
            self.bracketed(left, turn);
            left = turn;
        }
        self.bracketed(left, to);
    }

    /// Looks where |dT/dt| does not exceed `slope`.
    pub fn within_slope(&mut self, slope: f64) {
        let (delay, piece) = (self.delay, self.piece);
        self.enclosed(|[low, high]| {
            let (value_s, reach_s) = (delay.value_on(piece, low), slope.abs() * (high - low));
            Interval { low: value_s - reach_s, high: value_s + reach_s }
        });
    }

    /// Looks where `enclosure` of a stretch holds all values of T on it: a stretch is cut until t − T(t) cannot be what is
    /// looked for on a part, or the part is short. Two arrivals within one short part may be missed; they are kinks that the
    /// error control sees.
    pub fn enclosed(&mut self, enclosure: impl Fn([f64; 2]) -> Interval) {
        let [from, to] = self.span_s;
        let mut waiting = [(0.0, 0.0); CUTS + 2];
        waiting[0] = (from, to);
        let (mut count, shortest_s) = (1, (to - from) / f64::from(1 << CUTS));
        while count > 0 {
            count -= 1;
            let (left, right) = waiting[count];
            let delay = enclosure([left, right]);
            if left - delay.high > self.sent_s || right - delay.low < self.sent_s {
                continue;
            }
            let middle = left + 0.5 * (right - left);
            let full = count + 2 > waiting.len();
            if right - left <= shortest_s || middle <= left || middle >= right || full {
                self.bracketed(left, right);
                continue;
            }
            // The earlier half on top; the stack is never higher than the number of cuts.
            waiting[count] = (middle, right);
            waiting[count + 1] = (left, middle);
            count += 2;
        }
    }

    /// A change of sign brackets exactly one arrival where t − T(t) is monotone.
    fn bracketed(&mut self, left: f64, right: f64) {
        let (delay, piece, sent_s) = (self.delay, self.piece, self.sent_s);
        let early = |t: f64| t - delay.value_on(piece, t) - sent_s;
        let (early_left, early_right) = (early(left), early(right));
        if early_left < 0.0 && early_right >= 0.0 || early_left > 0.0 && early_right <= 0.0 {
            self.found(bisect(early, left, right, early_left < 0.0));
        }
    }
}
