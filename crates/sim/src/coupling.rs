//! Nonlinear protocols: how strongly a disagreement acts.
//!
//! Where a linear design has Σ_j w_ij (x_i − x_j(t−T_ij)), a nonlinear one has Σ_j w_ij φ(x_i − x_j(t−T_ij)) with an odd,
//! continuous φ that grows and keeps within the sector 0 < φ(v)/v ≤ 1. So the receiver takes
//!
//! ```text
//! x_i − φ(x_i − x_j(t−T_ij))     in place of     x_j(t−T_ij)
//! ```
//!
//! and no reference dynamics have to change. With λ = 1 − φ(v)/v ∈ [0, 1) that is λ x_i + (1 − λ) x_j(t−T_ij), a point between
//! the own position and the one that was heard. In the argument of Theorem 3 with (24) every intermediate value of every agent
//! moves towards points between values that were there within the longest delay; that stays so, and the spread of all of
//! them never grows. On bounded disagreements φ(v)/v is bounded away from zero, since φ is continuous and has a positive slope
//! at zero, so the weights that count are too, and the spread shrinks as before, only more slowly while disagreements are
//! large. Tracking errors enter as before. Under a bounded φ the spread D falls by a fixed share of min(D, limit) over a
//! window and rises by at most ∫|s|, which grows like √t for a square-integrable s: D stays bounded, and vanishes.
//!
//! Only positions may be heard: of a velocity that is heard φ would need the derivative.

use forwardstep_core::Scalar;

/// φ, in the units of the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coupling {
    /// φ(v) = v.
    #[default]
    Linear,
    /// v within ± the limit, else ± the limit.
    Saturated {
        /// The limit.
        limit: f64,
    },
    /// a tanh(v/a).
    Tanh {
        /// a: what φ approaches.
        scale: f64,
    },
    /// v/(1 + |v|/a).
    Rational {
        /// a: what φ approaches.
        scale: f64,
    },
}

impl Coupling {
    /// Whether φ(v) = v.
    pub fn is_linear(self) -> bool {
        self == Coupling::Linear
    }

    /// Its limit or scale.
    pub fn size(self) -> Option<f64> {
        match self {
            Coupling::Linear => None,
            Coupling::Saturated { limit: size }
            | Coupling::Tanh { scale: size }
            | Coupling::Rational { scale: size } => Some(size),
        }
    }

    /// φ(v).
    pub fn value(self, v: f64) -> f64 {
        match self {
            Coupling::Linear => v,
            // Not-a-number stays, so that a delay that is not what its author says does not look like one more value.
            Coupling::Saturated { limit } => v.saturate(limit),
            Coupling::Tanh { scale } => scale * libm::tanh(v / scale),
            Coupling::Rational { scale } => v / (1.0 + v.abs() / scale),
        }
    }

    /// What is taken in place of `heard` by a receiver at `own`.
    pub fn taken(self, own: f64, heard: f64) -> f64 {
        own - self.value(own - heard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_couplings_are_odd_grow_and_keep_within_the_sector() {
        let all = [
            Coupling::Linear,
            Coupling::Saturated { limit: 0.5 },
            Coupling::Tanh { scale: 0.7 },
            Coupling::Rational { scale: 0.3 },
        ];
        for coupling in all {
            assert!(coupling.taken(1.0, f64::NAN).is_nan(), "{coupling:?}: what is no number is no message");
            let mut before = 0.0;
            for k in 1..2000 {
                let v = 0.01 * f64::from(k);
                let value = coupling.value(v);
                assert_eq!(coupling.value(-v), -value);
                assert!(value > 0.0 && value <= v && value >= before);
                before = value;
                let taken = coupling.taken(1.0, 1.0 + v);
                assert!((1.0..=1.0 + v).contains(&taken));
            }
        }
        assert!(Coupling::Tanh { scale: -1.0 }.check().is_err());
    }
}
