//! A delay that swings.

use core::f64::consts::TAU;

use forwardstep_core::sine_and_cosine;

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::{LARGEST, MOST_EVENTS, QuantityError, at_most, few, not_negative, positive, within};

/// T = mean + amplitude · sin(2π t / period + phase).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid {
    /// In s; at least the amplitude.
    pub mean_s: f64,
    /// In s; not negative.
    pub amplitude_s: f64,
    /// In s.
    pub period_s: f64,
    /// In rad.
    pub phase_rad: f64,
}

impl DelayFunction for Sinusoid {
    fn words(&self) -> &'static str {
        "a sinusoid"
    }

    fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
        not_negative("", "mean_s", self.mean_s)?;
        not_negative("", "amplitude_s", self.amplitude_s)?;
        // Beyond the mean the delay would become negative.
        at_most("", "amplitude_s", self.amplitude_s, ("mean_s", self.mean_s))?;
        positive("", "period_s", self.period_s)?;
        within("", "phase_rad", self.phase_rad, -LARGEST, LARGEST)?;
        few("", "period_s", self.period_s, ("swings of the delay", end_s / self.period_s, MOST_EVENTS))
    }

    fn piece(&self, _: u64) -> DelayPiece {
        DelayPiece::WHOLE
    }

    fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
        let angle = libm::fma(TAU / self.period_s, t_s, self.phase_rad);
        // Rounding must not make a delay whose amplitude equals its mean negative.
        libm::fma(self.amplitude_s, sine_and_cosine(angle).0, self.mean_s).max(0.0)
    }

    fn known(&self) -> Known {
        Known::by_rule([(self.mean_s - self.amplitude_s).max(0.0), self.mean_s + self.amplitude_s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        // d/dt (t − T) = 1 − a ω cos(ω t + φ) vanishes where cos = 1/(a ω).
        let omega = TAU / self.period_s;
        let cosine = 1.0 / (self.amplitude_s * omega);
        if cosine.abs() >= 1.0 {
            return search.monotone();
        }
        // Two families of turning points, one period apart each; taken in turn, the earlier first.
        let (angle, [from, _]) = (libm::acos(cosine), search.span_s());
        let first = |sign: f64| {
            let base = (sign * angle - self.phase_rad) / omega;
            base + ((from - base) / self.period_s).ceil() * self.period_s
        };
        let mut next = [first(-1.0), first(1.0)];
        search.between(std::iter::from_fn(|| {
            let earlier = usize::from(next[1] < next[0]);
            let turn = next[earlier];
            next[earlier] += self.period_s;
            Some(turn)
        }));
    }
}
