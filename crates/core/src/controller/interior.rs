//! Estimates strictly between their bounds, for designs that differentiate the estimate's rate.
//!
//! Tuning functions put θ̂' = Γ τ_n into the steps before it is known, as Γ τ_i, and make up for the difference later. Where a projection
//! takes something off Γ τ_n, what was put in and what happens differ by ∂e_i/∂θ̂ times that, which has no sign and which nothing makes up
//! for; and a projection has no derivatives, which later steps ask for. So c_k of `law::bounds` is not admissible here. What is: a gain that
//! depends on θ̂. With c and h the middle and half the width of the bounds of a parameter, let
//!
//! ```text
//! θ̂ = c + h tanh(ξ/h)        ξ' = γ τ        so  θ̂' = γ(θ̂) τ,   γ(θ̂) = γ (1 − ((θ̂ − c)/h)²)
//! ```
//!
//! The recursion of `steps` never used that Γ is constant: its two last sums are one another's mirror image for every symmetric Γ(θ̂), as
//! long as ∂e_i/∂θ̂ is that of the e_i in which Γ(θ̂) stands. And with
//!
//! ```text
//! D = ∫ (σ − θ)/γ(σ) dσ from θ to θ̂ = (1/γ) ∫ (θ̂(ξ) − θ) dξ        D' = (θ̂ − θ) τ
//! ```
//!
//! in V in the place of (θ̂ − θ)²/2γ, V̇ = −Σ c_i e_i² as without bounds. D ≥ 0 wherever θ keeps to the bounds. θ̂ stays strictly between
//! them for ever, whatever disturbs the loop, since ξ is what is integrated; γ(θ̂) is a polynomial, so that nothing becomes less smooth. The
//! price is that θ̂ adapts more slowly near a bound, and cannot start there: γ(θ̂) vanishes.

use alloc::vec::Vec;

use crate::expression::Expression;
use crate::law::ParameterBounds;

/// Bounds that estimates stay strictly between.
#[derive(Clone, Debug)]
pub(super) struct Interior {
    /// c and h of every parameter.
    spans: Vec<[f64; 2]>,
}

impl Interior {
    pub(super) fn new(bounds: &ParameterBounds) -> Interior {
        let ends = bounds.lower.iter().zip(&bounds.upper);
        Interior { spans: ends.map(|(low, high)| [0.5 * (low + high), 0.5 * (high - low)]).collect() }
    }

    /// Whether this is strictly between the bounds, so that ξ is a finite number.
    pub(super) fn holds(&self, k: usize, theta_hat: f64) -> bool {
        self.xi(k, theta_hat).is_finite()
    }

    /// ξ.
    pub(super) fn xi(&self, k: usize, theta_hat: f64) -> f64 {
        let [c, h] = self.spans[k];
        h * libm::atanh((theta_hat - c) / h)
    }

    /// θ̂.
    pub(super) fn theta_hat(&self, k: usize, xi: f64) -> f64 {
        let [c, h] = self.spans[k];
        c + h * libm::tanh(xi / h)
    }

    /// γ D.
    pub(super) fn divergence(&self, k: usize, xi: f64, theta: f64) -> f64 {
        let [c, h] = self.spans[k];
        let (y, r) = (xi / h, ((theta - c) / h).clamp(-1.0, 1.0));
        // ln cosh y, and (1 + r) ln(1 + r) which is zero for r = −1.
        let log_cosh = y.abs() + libm::log1p(libm::exp(-2.0 * y.abs())) - core::f64::consts::LN_2;
        let entropy = |r: f64| if r > -1.0 { (1.0 + r) * libm::log1p(r) } else { 0.0 };
        h * h * (log_cosh + 0.5 * (entropy(r) + entropy(-r))) - (theta - c) * xi
    }

    /// γ(θ̂)/γ of every parameter, of which the variable `first` is θ̂ of the first.
    pub(super) fn slopes(&self, first: usize) -> Vec<Expression> {
        let slope = |(k, [c, h]): (usize, &[f64; 2])| {
            let part = (Expression::variable(first + k) + -c) * (1.0 / h);
            -part.power(2.0) + 1.0
        };
        self.spans.iter().enumerate().map(slope).collect()
    }
}

/// Γ, or Γ(θ̂).
#[derive(Clone, Copy, Debug)]
pub(super) struct Metric<'a> {
    /// The diagonal of Γ.
    pub(super) gamma: &'a [f64],
    /// What each entry is multiplied by, if anything.
    pub(super) slopes: &'a [Expression],
}

impl<'a> From<&'a [f64]> for Metric<'a> {
    fn from(gamma: &'a [f64]) -> Self {
        Metric { gamma, slopes: &[] }
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;

    #[test]
    fn prop_the_divergence_of_an_estimate_between_bounds_rises_with_its_error_and_is_never_negative() {
        let interior = Interior::new(&ParameterBounds::new(vec![-0.4], vec![1.1], 1.0));
        for theta in [-0.4, -0.39, 0.35, 0.8, 1.1] {
            for step in -300..300 {
                let (xi, delta) = (f64::from(step) * 0.03 + 0.001, 1e-5);
                let of = |xi| interior.divergence(0, xi, theta);
                let slope = (of(xi + delta) - of(xi - delta)) / (2.0 * delta);
                let error = interior.theta_hat(0, xi) - theta;
                assert!((slope - error).abs() < 1e-9, "{theta} {xi}: {slope} is not {error}");
                assert!(of(xi) >= -1e-15, "{theta} {xi}: {}", of(xi));
            }
        }
        assert!(!interior.holds(0, 1.1) && !interior.holds(0, 2.0) && interior.holds(0, 1.0));
        assert!((interior.theta_hat(0, interior.xi(0, 0.9)) - 0.9).abs() < 1e-15);
        assert!(interior.divergence(0, interior.xi(0, 0.8), 0.8).abs() < 1e-15);
    }
}
