//! Projection: estimates that stay where the parameters are known to be.
//!
//! Let ϑ̂_k' = c_k r_k, where r_k is the rate that the law asks for with a diagonal Γ. c_k is one but where ϑ̂_k is beyond a bound and r_k
//! leads further out; there it falls to zero over a margin. In V, ½ ΔϑᵀΓ⁻¹Δϑ then brings one more term,
//!
//! ```text
//! Σ (c_k − 1) Δϑ_k r_k / Γ_k ≤ 0        Δϑ = ϑ̂ − ϑ
//! ```
//!
//! since Δϑ_k and r_k have one sign wherever c_k < 1, if ϑ keeps to the bounds. So V̇ is no larger than without, and every theorem stands; ϑ̂
//! stays within the bounds and their margins, whatever disturbs the loop. c_k is Lipschitz, so that ϑ̂' is.
//!
//! At samples ϑ̂⁺ = Π(ϑ̂ + h r), Π onto the bounds entry by entry: with a diagonal Γ that is the nearest point in the norm of Γ⁻¹ to a set
//! that ϑ lies in, and comes no farther from ϑ.

use alloc::vec::Vec;

use crate::{LengthError, Packed, Scalar};

/// Bounds within which parameters are known to be.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterBounds<S = f64> {
    /// An entry per parameter.
    pub lower: Vec<S>,
    /// An entry per parameter.
    pub upper: Vec<S>,
    /// How far beyond a bound an estimate may go in continuous time, an entry per parameter in its unit; positive.
    pub margin: Vec<S>,
}

impl<S: Scalar> ParameterBounds<S> {
    /// Bounds with the same margin for all parameters.
    pub fn new(lower: Vec<S>, upper: Vec<S>, margin: S) -> Self {
        let margin = lower.iter().map(|_| margin).collect();
        ParameterBounds { lower, upper, margin }
    }

    /// Checks that there is an entry for each of `parameters`.
    ///
    /// # Errors
    /// [`LengthError`] for the first list of which that is not so.
    pub fn check(&self, parameters: usize) -> Result<(), LengthError> {
        LengthError::check("lower bounds", parameters, self.lower.len())?;
        LengthError::check("upper bounds", parameters, self.upper.len())?;
        LengthError::check("margins of bounds", parameters, self.margin.len())
    }

    /// c_k r_k for the parameter `k`, whose estimate is `hat`.
    #[inline(always)]
    pub fn slowed(&self, k: usize, hat: S, rate: S) -> S {
        let left = |beyond: S| (S::splat(1.0) - beyond.positive() / self.margin[k]).positive();
        let (up, down) = (rate.positive(), (-rate).positive());
        up * left(hat - self.upper[k]) - down * left(self.lower[k] - hat)
    }

    /// The same for all parameters.
    #[inline(always)]
    pub fn slow(&self, theta_hat: &[S], rates: &mut [S]) {
        for (k, (hat, rate)) in theta_hat.iter().zip(rates).enumerate() {
            *rate = self.slowed(k, *hat, *rate);
        }
    }

    /// Σ (1 − c_k) Δϑ_k (−y_k), what V loses beside: y = Yᵀs, and −y_k has the sign of the rate.
    #[inline(always)]
    pub fn gained(&self, theta_hat: &[S], theta: &[S], yt_s: &[S]) -> S {
        let mut gained = S::ZERO;
        for (k, y) in yt_s.iter().enumerate() {
            let withheld = -*y - self.slowed(k, theta_hat[k], -*y);
            gained = (theta_hat[k] - theta[k]).mul_add(withheld, gained);
        }
        gained
    }
}

impl ParameterBounds {
    /// Bounds that no estimate reaches.
    pub fn anywhere(parameters: usize) -> Self {
        let entries = |entry: f64| core::iter::repeat_n(entry, parameters).collect();
        ParameterBounds { lower: entries(f64::NEG_INFINITY), upper: entries(f64::INFINITY), margin: entries(1.0) }
    }

    /// Brings estimates back to the nearest within the bounds.
    pub fn project(&self, theta_hat: &mut [f64]) {
        for (hat, (lower, upper)) in theta_hat.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            // Not-a-number stays what it is.
            if *hat > *upper {
                *hat = *upper;
            } else if *hat < *lower {
                *hat = *lower;
            }
        }
    }
}

impl<S: Packed> ParameterBounds<S> {
    /// The bounds of several agents side by side: `bounds(k)` are those of lane k. All must have the same length.
    pub fn pack<'a>(bounds: impl Fn(usize) -> &'a ParameterBounds) -> Self {
        let packed = |entries: fn(&ParameterBounds) -> &[f64]| -> Vec<S> {
            (0..entries(bounds(0)).len()).map(|k| S::from_lanes(|lane| entries(bounds(lane))[k])).collect()
        };
        ParameterBounds {
            lower: packed(|bounds| &bounds.lower),
            upper: packed(|bounds| &bounds.upper),
            margin: packed(|bounds| &bounds.margin),
        }
    }
}
