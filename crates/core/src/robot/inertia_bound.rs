//! Property 1 as a number: M(q) is positive definite *uniformly*, by at least so much at every q.
//!
//! Everything is enclosed by intervals that are rounded outwards, so that the numbers are bounds of the real matrices, not of what
//! was computed.

use alloc::vec;
use alloc::vec::Vec;

use super::enclosed::Enclosed;
use crate::expression::Interval;
use crate::{LengthError, ResolvedGain};

/// What holds of M(q) for every q.
///
/// Constant matrices N₁, N₂, … are known such that, at every q, some mean of them is at least M(q)⁻¹. Then
///
/// ```text
/// λ_min(M(q)) ≥ 1/max λ_max(N)          λ_max(M(q)⁻¹K) ≤ max λ_max(N K)
/// ```
///
/// **Source**: Property 1. Units are those of M: kg m² for revolute joints, kg for prismatic ones; where a robot has both, the
/// eigenvalues of M mix them, but those of M⁻¹K are in 1/s all the same.
#[derive(Clone, Debug, PartialEq)]
pub struct InertiaBound {
    least: f64,
    inverses: Vec<Enclosed>,
}

/// Whether M(q) is positive definite uniformly.
#[derive(Clone, Debug, PartialEq)]
pub enum Definiteness {
    /// It is, by a bound.
    Uniform(InertiaBound),
    /// It is not, at this q: `direction` · M(q) `direction` ≤ 0, by intervals.
    Not {
        /// Joint positions, rad or m.
        q: Vec<f64>,
        /// Velocities that have no kinetic energy, or a negative one.
        direction: Vec<f64>,
    },
    /// Neither is shown. Of the postures that were looked at, M is closest to singular at this one.
    Unknown {
        /// Joint positions, rad or m.
        q: Vec<f64>,
        /// What every eigenvalue of M exceeds there; zero where that is not known.
        least: f64,
    },
}

impl Definiteness {
    /// By a bound, else by what M is with all joints at zero.
    pub(super) fn of(bound: Option<InertiaBound>, at_zero: &Enclosed) -> Self {
        if let Some(bound) = bound {
            return Definiteness::Uniform(bound);
        }
        let q = vec![0.0; at_zero.size()];
        match at_zero.against() {
            Some(direction) => Definiteness::Not { q, direction },
            None => Definiteness::Unknown { q, least: at_zero.least().unwrap_or(0.0) },
        }
    }
}

impl InertiaBound {
    /// By matrices of which a mean is at least M(q)⁻¹; `None` unless their eigenvalues have bounds.
    pub(super) fn by_inverses(inverses: Vec<Enclosed>) -> Option<Self> {
        let mut largest = 0.0_f64;
        for inverse in &inverses {
            largest = largest.max(inverse.largest()?);
        }
        let least = (Interval::point(1.0) / Interval::point(largest)).low;
        (least > 0.0).then_some(InertiaBound { least, inverses })
    }

    /// By λ_min(M(q)) ≥ `least` > 0, in `dof` dimensions.
    pub(super) fn by_least(least: f64, dof: usize) -> Option<Self> {
        let inverse = Interval::point(1.0) / Interval::point(least);
        let inverses = vec![Enclosed::diagonal(&vec![inverse; dof])];
        (least > 0.0 && inverse.is_finite()).then_some(InertiaBound { least, inverses })
    }

    /// The same matrices with a bound that is known to be better.
    pub(super) fn at_least(self, least: f64) -> Self {
        InertiaBound { least: self.least.max(least), ..self }
    }

    /// No eigenvalue of M(q) is smaller, whatever q; positive.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// No eigenvalue of M(q)⁻¹K is larger, whatever q, 1/s: no motion of s under τ = −K s is faster. `None` where none is known,
    /// which is so of a K that is positive definite by rounding alone. Where `at_least` is such a bound it is the answer, which is
    /// found sooner than the best one.
    ///
    /// λ K⁻¹ − N ⪰ 0 says λ ≥ λ_max(N K), and with K = L D Lᵀ it is λ D⁻¹ − LᵀN L ⪰ 0.
    ///
    /// # Errors
    /// [`LengthError`] when K has another size.
    pub fn fastest(&self, gain: &ResolvedGain, at_least: f64) -> Result<Option<f64>, LengthError> {
        let size = self.inverses.first().map_or(0, Enclosed::size);
        LengthError::check("gain", size, gain.size())?;
        let point = |entries: &[f64]| entries.iter().map(|entry| Interval::point(*entry)).collect::<Vec<_>>();
        let factors = match gain {
            ResolvedGain::Diagonal(entries) => Some(Enclosed::diagonal(&point(entries))),
            ResolvedGain::Matrix { size, entries } => {
                Enclosed::from_rows(*size, point(entries)).and_then(Enclosed::factors)
            }
        };
        let Some(factors) = factors else { return Ok(None) };
        let weights: Vec<Interval> = (0..size).map(|i| Interval::point(1.0) / factors.at(i, i)).collect();
        let mut fastest = at_least;
        for inverse in &self.inverses {
            let inverse = inverse.between(&factors);
            if fastest > 0.0 && inverse.keeps_below(fastest, &weights) {
                continue;
            }
            let Some(own) = inverse.largest_over(&weights) else { return Ok(None) };
            fastest = fastest.max(own);
        }
        Ok(Some(fastest))
    }
}
