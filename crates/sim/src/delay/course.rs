//! What a delay does on a part of one of its pieces, for those who enclose what is heard.

use std::f64::consts::TAU;

use forwardstep_core::expression::Interval;

use super::{Constant, Delay, DelayPiece, PiecewiseConstant, RandomHold, SawTooth, Sinusoid};
use crate::formula::BoundedFormula;

/// More than the angle of a sinusoid can be off by rounding, as a part of it and of a turn.
const ANGLE: f64 = 1e-14;

/// When what is heard over a stretch of time was sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SentOver {
    /// At one time all the while, s; −∞ for the initial message.
    Held(f64),
    /// T goes along a straight line between these values at the ends of the stretch, s.
    Line([f64; 2]),
    /// T keeps within these, s.
    Within([f64; 2]),
}

impl Delay {
    /// What T does from one time to a later one, both of them on `piece`. The kinds that come with forwardstep are looked at as they
    /// are; of any other, what is known of all of its values is said.
    pub fn sent_over(&self, piece: DelayPiece, [from_s, to_s]: [f64; 2]) -> SentOver {
        if let Some(sent_s) = piece.held_s {
            return SentOver::Held(sent_s);
        }
        let is_straight = self.downcast::<Constant>().is_some()
            || self.downcast::<PiecewiseConstant>().is_some()
            || self.downcast::<RandomHold>().is_some()
            || self.downcast::<SawTooth>().is_some();
        if is_straight {
            return SentOver::Line([self.value_on(piece, from_s), self.value_on(piece, to_s)]);
        }
        let (known, over) = (self.known().within_s, Interval { low: from_s, high: to_s });
        let within = if let Some(formula) = self.downcast::<BoundedFormula>() {
            formula.formula().enclose(over)
        } else if let Some(wave) = self.downcast::<Sinusoid>() {
            wave.enclose(over)
        } else {
            Interval { low: known[0], high: known[1] }
        };
        SentOver::Within([within.low.max(known[0]), within.high.min(known[1])])
    }
}

impl Sinusoid {
    fn enclose(&self, over: Interval) -> Interval {
        let angle = Interval::point(TAU / self.period_s) * over + Interval::point(self.phase_rad);
        let wave = angle.with_room(ANGLE * (angle.size() + TAU)).sine();
        Interval::point(self.amplitude_s) * wave + Interval::point(self.mean_s)
    }
}
