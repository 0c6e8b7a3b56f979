//! The polynomial (25) from its roots.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

/// A root that does not make a Hurwitz polynomial with real roots.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RootsError {
    /// No roots at all.
    #[error("the reference dynamics need at least one root")]
    Empty,
    /// A root that is not a positive number.
    #[error("root {index} is {value} per second, but every root must be positive and finite")]
    NotPositive {
        /// Position in the list, from zero.
        index: usize,
        /// The offending value, 1/s.
        value: f64,
    },
    /// A manipulability gain that is not a number from zero up.
    #[error("the manipulability gain is {value}, but must be finite and not negative")]
    Manipulability {
        /// The offending value, 1/s^ℓ.
        value: f64,
    },
    /// Agents of one population must share the order.
    #[error("{got} roots were given where the population has order {need}")]
    Order {
        /// The order of the population.
        need: usize,
        /// The number of roots given.
        got: usize,
    },
}

/// The coefficients α₀ … α_{ℓ−1}, α_ℓ = 1 of ∏ᵣ (p + κᵣ): polynomial (25).
///
/// # Errors
/// [`RootsError`] when there are no roots or one is not positive and finite.
///
/// ```
/// use forwardstep_core::reference::polynomial;
///
/// // (p + 1)(p + 2)(p + 4)
/// assert_eq!(polynomial(&[1.0, 2.0, 4.0])?, [8.0, 14.0, 7.0, 1.0]);
/// assert!(polynomial(&[1.0, -2.0]).is_err());
/// # Ok::<(), forwardstep_core::reference::RootsError>(())
/// ```
pub fn polynomial(roots_per_s: &[f64]) -> Result<Vec<f64>, RootsError> {
    if roots_per_s.is_empty() {
        return Err(RootsError::Empty);
    }
    let mut alpha = vec![1.0];
    for (index, kappa) in roots_per_s.iter().enumerate() {
        if !(*kappa > 0.0 && kappa.is_finite()) {
            return Err(RootsError::NotPositive { index, value: *kappa });
        }
        // (p + κ) · Σ αᵣ pʳ
        alpha.insert(0, 0.0);
        for r in 0..alpha.len() - 1 {
            alpha[r] += kappa * alpha[r + 1];
        }
    }
    Ok(alpha)
}

/// The coefficients of a population, column by column.
#[derive(Clone, Debug)]
pub(crate) struct Coefficients {
    pub(crate) order: usize,
    pub(crate) agents: usize,
    /// αᵣ of every agent: entry `r · agents + agent`, r = 0 … ℓ.
    pub(crate) alpha: Vec<f64>,
    /// α₀/κ₀ of every agent.
    pub(crate) alpha_0_over_kappa_0: Vec<f64>,
    /// λ of every agent, Remark 4.
    pub(crate) lambda: Vec<f64>,
}

impl Coefficients {
    /// From the roots and λ of every agent.
    pub(crate) fn new<'a>(designs: impl IntoIterator<Item = (&'a [f64], f64)>) -> Result<Self, RootsError> {
        let (mut columns, mut alpha_0_over_kappa_0, mut lambda) = (Vec::<Vec<f64>>::new(), Vec::new(), Vec::new());
        for (roots, manipulability) in designs {
            let alpha = polynomial(roots)?;
            if let Some(first) = columns.first().map(Vec::len)
                && first != alpha.len()
            {
                return Err(RootsError::Order { need: first - 1, got: roots.len() });
            }
            if !(manipulability >= 0.0 && manipulability.is_finite()) {
                return Err(RootsError::Manipulability { value: manipulability });
            }
            alpha_0_over_kappa_0.push(alpha[0] / roots[0]);
            lambda.push(manipulability);
            columns.push(alpha);
        }
        let Some(order) = columns.first().map(|alpha| alpha.len() - 1) else { return Err(RootsError::Empty) };
        let alpha = (0..=order).flat_map(|r| columns.iter().map(move |alpha| alpha[r])).collect();
        Ok(Coefficients { order, agents: columns.len(), alpha, alpha_0_over_kappa_0, lambda })
    }

    /// αᵣ of every agent.
    #[inline(always)]
    pub(crate) fn alpha(&self, r: usize) -> &[f64] {
        &self.alpha[r * self.agents..(r + 1) * self.agents]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_25_roots_give_the_polynomial() {
        assert_eq!(polynomial(&[2.0]), Ok(vec![2.0, 1.0]));
        assert_eq!(polynomial(&[1.0, 2.0, 3.0]), Ok(vec![6.0, 11.0, 6.0, 1.0]));
        assert_eq!(polynomial(&[]), Err(RootsError::Empty));
        assert_eq!(polynomial(&[1.0, -2.0]), Err(RootsError::NotPositive { index: 1, value: -2.0 }));
    }
}
