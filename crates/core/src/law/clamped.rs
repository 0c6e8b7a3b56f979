//! Estimates that are used no farther than their bounds, where the rate that a law asks for is not known.
//!
//! The laws without velocity or acceleration find their estimates by parts, and immersion and invariance adds a function of the state, so
//! that what is integrated is not the estimate and nothing can slow the estimate down, as `bounds` does. Let μ be what they find, and r the
//! rate that the proof gives it. The law uses Π(μ), the nearest number within the bounds, in the place of μ, and
//!
//! ```text
//! μ' = r − ρ (μ − Π(μ))        W = ∫ (Π(σ) − θ) dσ from θ to μ        in V: W/γ in the place of (μ − θ)²/2γ
//! W' = (Π(μ) − θ) r − ρ (Π(μ) − θ)(μ − Π(μ))
//! ```
//!
//! The first part is what every proof cancels, with the estimate that the law uses. The second is never positive: beyond a bound both
//! factors have one sign as long as θ keeps to the bounds, and within them μ = Π(μ). Since Π rises, by no more than its argument does, and
//! Π(θ) = θ, W ≥ ½ (Π(μ) − θ)². So V̇ is no larger than without bounds, every theorem stands, and the estimate that is used keeps to the
//! bounds whatever disturbs the loop. ρ brings μ back, which could otherwise wind up beyond a bound; it is a rate that the law has already.
//! Π is Lipschitz, so that an input that holds Π(μ) is continuous, and has no derivative where μ passes a bound.

use super::ParameterBounds;

/// Bounds within which one number is known to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower end.
    pub lower: f64,
    /// The upper end.
    pub upper: f64,
}

impl Range {
    /// Π(μ). Not-a-number stays what it is.
    pub fn nearest(self, mu: f64) -> f64 {
        if mu > self.upper {
            self.upper
        } else if mu < self.lower {
            self.lower
        } else {
            mu
        }
    }

    /// μ − Π(μ).
    pub fn beyond(self, mu: f64) -> f64 {
        mu - self.nearest(mu)
    }

    /// W.
    pub fn potential(self, mu: f64, theta: f64) -> f64 {
        let used = self.nearest(mu) - theta;
        used * (0.5 * used + self.beyond(mu))
    }

    /// (Π(μ) − θ)(μ − Π(μ)), which is not negative where θ keeps to the bounds.
    pub fn withheld(self, mu: f64, theta: f64) -> f64 {
        (self.nearest(mu) - theta) * self.beyond(mu)
    }
}

impl ParameterBounds {
    /// The bounds of the parameter `k`; of one that is not there, none that any number reaches.
    pub fn range(&self, k: usize) -> Range {
        let entry = |of: &[f64], none: f64| of.get(k).copied().unwrap_or(none);
        Range { lower: entry(&self.lower, f64::NEG_INFINITY), upper: entry(&self.upper, f64::INFINITY) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prop_what_stands_in_v_for_a_clamped_estimate_rises_with_what_is_used() {
        let range = Range { lower: -0.4, upper: 1.1 };
        for theta in [-0.4, 0.3, 1.1] {
            for step in -400..400 {
                let (mu, h) = (f64::from(step) * 0.01 + 0.0031, 1e-6);
                let slope = (range.potential(mu + h, theta) - range.potential(mu - h, theta)) / (2.0 * h);
                let used = range.nearest(mu) - theta;
                assert!((slope - used).abs() < 1e-8, "{mu}: {slope} is not {used}");
                assert!(range.potential(mu, theta) >= 0.5 * used * used, "{mu}");
                assert!(range.withheld(mu, theta) >= 0.0, "{mu}");
            }
        }
    }
}
