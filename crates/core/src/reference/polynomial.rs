//! The polynomial (25) from its roots.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::roots::{RootPair, RootSet};

/// Roots that do not make a Hurwitz polynomial, or not the one that is needed.
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
    /// A pair of complex roots that does not decay, or does not turn.
    #[error(
        "the pair {index} of complex roots has the real part {} and the imaginary part {} per second, but both must be positive and \
         finite; a real root is written as a number",
        pair.real,
        pair.imaginary
    )]
    Pair {
        /// Position in the list of pairs, from zero.
        index: usize,
        /// The pair.
        pair: RootPair,
    },
    /// More roots than blocks of reference state can be numbered.
    #[error("{found} roots were given, but the blocks of reference state are numbered up to {most}")]
    TooMany {
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// A polynomial whose coefficients do not say where its roots are.
    #[error(
        "the coefficients of the polynomial of these {count} roots say {lost:.1} of 16 digits less about its stability, and at most \
         {MOST_DIGITS_LOST} may be lost: use fewer roots, roots that are further apart, or pairs with more damping"
    )]
    IllConditioned {
        /// How many roots there are.
        count: usize,
        /// Decimal digits.
        lost: f64,
    },
    /// A coefficient beyond the largest number.
    #[error("a coefficient of the polynomial of these {count} roots is beyond 1e308: use smaller roots, or fewer")]
    Overflow {
        /// How many roots there are.
        count: usize,
    },
    /// Velocities are sent, and there is no κ₀ to divide them by.
    #[error("all roots are complex, but (a5), which sends velocities, needs a real one: κ₀, the first real root")]
    NoRealRoot,
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

/// Roots that may be numbered.
const MOST_ROOTS: usize = 254;
/// Digits that rounding the coefficients may cost.
const MOST_DIGITS_LOST: f64 = 12.0;

/// How many digits less the coefficients of P say about its stability: the decimal logarithm of the largest P(ω)/|P(iω)|.
///
/// All coefficients are positive, so Σ αᵣ ωʳ = P(ω). Changing each by the part ε changes P(iω) by ε P(ω) at most, and P stays Hurwitz as long
/// as that is less than |P(iω)| for every ω. N equal roots lose 0.15 N digits, at ω = κ; roots that are far apart lose less, and a pair with
/// the damping ratio ζ loses −log₁₀ ζ. ω is looked for at the sizes of all roots.
pub(crate) fn digits_lost(roots: &RootSet) -> f64 {
    let at = |omega: f64| {
        let real = roots.real.iter().map(|kappa| libm::log10((omega + kappa) / libm::hypot(omega, *kappa)));
        let pairs = roots.pairs.iter().map(|RootPair { real: a, imaginary: b }| {
            // |(iω + a)² + b²| = |iω + a + b i| |iω + a − b i|
            let (far, near) = (libm::hypot(*a, omega + b), libm::hypot(*a, omega - b));
            let along = libm::hypot(omega + a, *b);
            libm::log10(along / far) + libm::log10(along / near)
        });
        real.chain(pairs).sum::<f64>()
    };
    let sizes = roots.real.iter().copied().chain(roots.pairs.iter().map(|pair| libm::hypot(pair.real, pair.imaginary)));
    sizes.map(at).fold(0.0, f64::max)
}

/// The coefficients α₀ … α_{ℓ−1}, α_ℓ = 1 of ∏ᵣ (p + κᵣ) · ∏ₖ ((p + aₖ)² + bₖ²): polynomial (25), with pairs of complex roots.
///
/// # Errors
/// [`RootsError`] when there are no roots or one is not positive and finite, or a part of a pair is not, and when the coefficients
/// would not say in `f64` where the roots are.
///
/// ```
/// use forwardstep_core::reference::polynomial;
///
/// // (p + 1)(p + 2)(p + 4)
/// assert_eq!(polynomial([1.0, 2.0, 4.0])?, [8.0, 14.0, 7.0, 1.0]);
/// assert!(polynomial([1.0, -2.0]).is_err());
/// # Ok::<(), forwardstep_core::reference::RootsError>(())
/// ```
pub fn polynomial(roots_per_s: impl Into<RootSet>) -> Result<Vec<f64>, RootsError> {
    let roots = roots_per_s.into();
    let count = roots.len();
    if count == 0 {
        return Err(RootsError::Empty);
    }
    if count > MOST_ROOTS {
        return Err(RootsError::TooMany { found: count, most: MOST_ROOTS });
    }
    let alpha = expanded(&roots)?;
    if !alpha.iter().all(|alpha| alpha.is_finite()) {
        return Err(RootsError::Overflow { count });
    }
    let lost = digits_lost(&roots);
    if lost > MOST_DIGITS_LOST {
        return Err(RootsError::IllConditioned { count, lost });
    }
    Ok(alpha)
}

/// The product of all factors.
fn expanded(RootSet { real, pairs }: &RootSet) -> Result<Vec<f64>, RootsError> {
    let is_positive = |value: f64| value > 0.0 && value.is_finite();
    let mut alpha = vec![1.0];
    for (index, kappa) in real.iter().enumerate() {
        if !is_positive(*kappa) {
            return Err(RootsError::NotPositive { index, value: *kappa });
        }
        // (p + κ) · Σ αᵣ pʳ
        alpha.insert(0, 0.0);
        for r in 0..alpha.len() - 1 {
            alpha[r] += kappa * alpha[r + 1];
        }
    }
    for (index, pair) in pairs.iter().enumerate() {
        let RootPair { real: a, imaginary: b } = *pair;
        if !(is_positive(a) && is_positive(b)) {
            return Err(RootsError::Pair { index, pair: *pair });
        }
        // (p² + 2 a p + a² + b²) · Σ αᵣ pʳ
        alpha.splice(0..0, [0.0; 2]);
        for r in 0..alpha.len() - 1 {
            let next = alpha.get(r + 2).map_or(0.0, |above| (a * a + b * b) * above);
            alpha[r] += 2.0 * a * alpha[r + 1] + next;
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
    /// α₀/κ₀ of every agent that hears velocities.
    pub(crate) alpha_0_over_kappa_0: Vec<f64>,
    /// λ of every agent, Remark 4.
    pub(crate) lambda: Vec<f64>,
}

impl Coefficients {
    /// From the roots and λ of every agent; `velocities` says whether they are sent.
    pub(crate) fn new<R: Into<RootSet>>(
        designs: impl IntoIterator<Item = (R, f64)>,
        velocities: bool,
    ) -> Result<Self, RootsError> {
        let (mut columns, mut alpha_0_over_kappa_0, mut lambda) = (Vec::<Vec<f64>>::new(), Vec::new(), Vec::new());
        for (roots, manipulability) in designs {
            let roots = roots.into();
            let alpha = polynomial(&roots)?;
            if let Some(first) = columns.first().map(Vec::len)
                && first != alpha.len()
            {
                return Err(RootsError::Order { need: first - 1, got: roots.len() });
            }
            if !(manipulability >= 0.0 && manipulability.is_finite()) {
                return Err(RootsError::Manipulability { value: manipulability });
            }
            alpha_0_over_kappa_0.push(match roots.first_real() {
                Some(kappa_0) => alpha[0] / kappa_0,
                None if velocities => return Err(RootsError::NoRealRoot),
                // Nothing is heard that it would multiply.
                None => 0.0,
            });
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
        assert_eq!(polynomial([2.0]), Ok(vec![2.0, 1.0]));
        assert_eq!(polynomial([1.0, 2.0, 3.0]), Ok(vec![6.0, 11.0, 6.0, 1.0]));
        assert_eq!(polynomial([]), Err(RootsError::Empty));
        assert_eq!(polynomial([1.0, -2.0]), Err(RootsError::NotPositive { index: 1, value: -2.0 }));
    }

    fn with(real: &[f64], pairs: &[[f64; 2]]) -> RootSet {
        let pairs = pairs.iter().map(|[real, imaginary]| RootPair { real: *real, imaginary: *imaginary });
        RootSet { real: real.to_vec(), pairs: pairs.collect() }
    }

    /// At p = −a + b i of a pair, and at p = −κ, the polynomial vanishes; its leading coefficient is one.
    #[test]
    fn eq_25_with_pairs_vanishes_at_its_roots() {
        let (real, pairs) = ([0.7, 2.5], [[0.1, 2.0], [1.5, 0.25]]);
        let alpha = polynomial(with(&real, &pairs)).unwrap();
        assert_eq!((alpha.len(), alpha[6]), (7, 1.0));
        let value =
            |[x, y]: [f64; 2]| alpha.iter().rev().fold([0.0; 2], |[u, v], next| [u * x - v * y + next, u * y + v * x]);
        let all = real.iter().map(|kappa| [-kappa, 0.0]).chain(pairs.iter().map(|[a, b]| [-a, *b]));
        for root in all {
            let [u, v] = value(root);
            assert!(u.abs() < 1e-12 && v.abs() < 1e-12, "{root:?} {u} {v}");
        }
    }

    /// Against the coefficients: Σ αᵣ ωʳ over |Σ αᵣ (iω)ʳ|.
    #[test]
    fn digits_are_lost_where_the_polynomial_is_small_for_its_terms() {
        let direct = |roots: &RootSet, omega: f64| {
            let alpha = polynomial(roots).unwrap();
            let value = alpha.iter().rev().fold([0.0; 2], |[u, v], next| [next - v * omega, u * omega]);
            let size = alpha.iter().rev().fold(0.0, |sum, next| sum * omega + next);
            libm::log10(size / libm::hypot(value[0], value[1]))
        };
        for roots in
            [with(&[1.0; 9], &[]), with(&[0.7, 2.5, 40.0], &[[0.1, 2.0], [1.5, 0.25]]), with(&[], &[[0.01, 3.0]])]
        {
            let most =
                (0..40_000).map(|k| direct(&roots, libm::pow(10.0, f64::from(k) * 1e-4 - 2.0))).fold(0.0, f64::max);
            let found = digits_lost(&roots);
            assert!(found <= most + 1e-3 && found > 0.85 * most, "{roots:?}: {found} {most}");
        }
        // Half the decimal logarithm of two for each.
        assert!((digits_lost(&with(&[3.0; 20], &[])) - 10.0 * libm::log10(2.0)).abs() < 1e-12);
    }

    #[test]
    fn roots_that_the_coefficients_cannot_hold_are_refused_with_what_is_lost() {
        assert_eq!(polynomial(with(&[1.0; 79], &[])).unwrap().len(), 80);
        let lost = 40.0 * libm::log10(2.0);
        let found = polynomial(with(&[1.0; 80], &[])).unwrap_err();
        assert!(matches!(found, RootsError::IllConditioned { count: 80, lost: found } if (found - lost).abs() < 1e-9));
        assert!(alloc::format!("{found}").contains("these 80 roots say 12.0 of 16 digits less"), "{found}");
        // Far apart, as many are well told.
        let apart: Vec<f64> = (0..80).map(|k| libm::exp2(f64::from(k) * 0.2 - 8.0)).collect();
        assert!(digits_lost(&apart.clone().into()) < 8.0 && polynomial(apart).is_ok());
        assert!(matches!(polynomial(with(&[], &[[1e-13, 1.0]])), Err(RootsError::IllConditioned { count: 2, .. })));
        assert_eq!(polynomial(with(&[1e100; 4], &[])), Err(RootsError::Overflow { count: 4 }));
        assert_eq!(polynomial(vec![1.0; 255]), Err(RootsError::TooMany { found: 255, most: 254 }));
    }

    #[test]
    fn pairs_must_decay_and_turn() {
        for [a, b] in [[0.0, 1.0], [-0.1, 1.0], [1.0, 0.0], [1.0, -2.0], [f64::NAN, 1.0], [1.0, f64::INFINITY]] {
            let found = polynomial(with(&[1.0], &[[1.0, 1.0], [a, b]]));
            assert!(matches!(found, Err(RootsError::Pair { index: 1, .. })), "{a} {b} {found:?}");
        }
    }

    #[test]
    fn velocities_need_a_real_root_and_positions_do_not() {
        let design = || [(with(&[], &[[1.0, 2.0]]), 0.0)];
        assert_eq!(Coefficients::new(design(), true).map(|_| ()), Err(RootsError::NoRealRoot));
        let found = Coefficients::new(design(), false).unwrap();
        assert_eq!((found.order, found.alpha), (2, vec![5.0, 2.0, 1.0]));
    }
}
