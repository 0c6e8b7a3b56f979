//! The roots of the polynomial (25), real ones and complex pairs.

use alloc::vec::Vec;

/// A pair of roots p = −`real` ± `imaginary` i of a polynomial with real coefficients: the factor (p + a)² + b².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootPair {
    /// a, 1/s: how fast what it describes decays.
    pub real: f64,
    /// b, 1/s: how fast it turns.
    pub imaginary: f64,
}

/// The roots of a polynomial ∏ᵣ (p + κᵣ) · ∏ₖ ((p + aₖ)² + bₖ²).
///
/// The paper's (25) has real ones alone. Complex pairs are kept apart, since everything that rests on the chain of averages of (30)
/// needs every root to be real, while tracking needs a Hurwitz polynomial only.
///
/// ```
/// use forwardstep_core::reference::{RootPair, RootSet, polynomial};
///
/// let roots = RootSet { real: vec![3.0], pairs: vec![RootPair { real: 1.0, imaginary: 2.0 }] };
/// assert_eq!((roots.len(), roots.first_real(), roots.slowest_per_s()), (3, Some(3.0), Some(1.0)));
/// // (p + 3)(p² + 2 p + 5)
/// assert_eq!(polynomial(&roots)?, [15.0, 11.0, 5.0, 1.0]);
/// # Ok::<(), forwardstep_core::reference::RootsError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RootSet {
    /// The numbers κ₀, κ₁, … of the real roots −κ, 1/s.
    pub real: Vec<f64>,
    /// The pairs of complex roots.
    pub pairs: Vec<RootPair>,
}

impl RootSet {
    /// How many roots there are, which is the degree of the polynomial: a pair counts as two.
    pub fn len(&self) -> usize {
        self.real.len() + 2 * self.pairs.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.real.is_empty() && self.pairs.is_empty()
    }

    /// Removes all of them.
    pub fn clear(&mut self) {
        self.real.clear();
        self.pairs.clear();
    }

    /// All κ, where every root is real.
    pub fn all_real(&self) -> Option<&[f64]> {
        self.pairs.is_empty().then_some(&self.real)
    }

    /// κ₀ of (a5), by which what is heard of velocities is divided: the first real one.
    pub fn first_real(&self) -> Option<f64> {
        self.real.first().copied()
    }

    /// The smallest κ or a, 1/s: the polynomial is Hurwitz exactly if it is positive. None without roots; NaN if one is not a number.
    pub fn slowest_per_s(&self) -> Option<f64> {
        let all = self.real.iter().copied().chain(self.pairs.iter().map(|pair| pair.real));
        all.reduce(|least, next| if next < least || next.is_nan() { next } else { least })
    }
}

impl From<Vec<f64>> for RootSet {
    fn from(real: Vec<f64>) -> Self {
        RootSet { real, pairs: Vec::new() }
    }
}

impl From<&Vec<f64>> for RootSet {
    fn from(real: &Vec<f64>) -> Self {
        real.clone().into()
    }
}

impl From<&[f64]> for RootSet {
    fn from(real: &[f64]) -> Self {
        real.to_vec().into()
    }
}

impl<const N: usize> From<&[f64; N]> for RootSet {
    fn from(real: &[f64; N]) -> Self {
        real.to_vec().into()
    }
}

impl<const N: usize> From<[f64; N]> for RootSet {
    fn from(real: [f64; N]) -> Self {
        real.to_vec().into()
    }
}

impl From<&RootSet> for RootSet {
    fn from(roots: &RootSet) -> Self {
        roots.clone()
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;

    #[test]
    fn the_slowest_root_is_of_either_kind() {
        let with = |real: &[f64], a: f64| {
            RootSet { real: real.to_vec(), pairs: vec![RootPair { real: a, imaginary: 9.0 }] }.slowest_per_s()
        };
        assert_eq!([with(&[2.0, 3.0], 4.0), with(&[2.0, 3.0], 1.0), with(&[], 5.0)], [Some(2.0), Some(1.0), Some(5.0)]);
        assert_eq!(RootSet::default().slowest_per_s(), None);
        assert!(
            with(&[f64::NAN, 1.0], 1.0).is_some_and(f64::is_nan) && with(&[1.0], f64::NAN).is_some_and(f64::is_nan)
        );
    }

    #[test]
    fn a_pair_is_two_roots_and_no_real_one() {
        let mut roots = RootSet { real: vec![1.0], pairs: vec![RootPair { real: 0.1, imaginary: 2.0 }] };
        assert_eq!((roots.len(), roots.all_real(), roots.is_empty()), (3, None, false));
        roots.clear();
        assert_eq!((roots.len(), roots.all_real(), roots.is_empty()), (0, Some(&[][..]), true));
    }
}
