//! A delay that swings.

use core::f64::consts::TAU;

use forwardstep_core::Scalar;

use super::{Arrivals, DelayFunction, DelayPiece, Known};
use crate::quantity::{LARGEST, QuantityError, not_negative, positive, within};

/// T = mean + amplitude · sin(2π t / period + phase).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid {
    /// In s; at least the amplitude.
    pub mean_s: f64,
    /// In s.
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

    fn validate(&self) -> Result<(), QuantityError> {
        positive("", "period_s", self.period_s)?;
        not_negative("", "mean_s", self.mean_s)?;
        within("", "phase_rad", self.phase_rad, -LARGEST, LARGEST)?;
        // Beyond the mean the delay would become negative.
        within("", "amplitude_s", self.amplitude_s, -self.mean_s, self.mean_s)
    }

    fn piece(&self, _: u64) -> DelayPiece {
        DelayPiece::WHOLE
    }

    fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
        let angle = Scalar::mul_add(TAU / self.period_s, t_s, self.phase_rad);
        // Rounding must not make a delay whose amplitude equals its mean negative.
        Scalar::mul_add(self.amplitude_s, Scalar::sin_cos(angle).0, self.mean_s).max(0.0)
    }

    fn known(&self) -> Known {
        let size = self.amplitude_s.abs();
        Known::by_rule([(self.mean_s - size).max(0.0), self.mean_s + size])
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
