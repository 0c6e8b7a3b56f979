//! Polynomials in the differential operator p = d/dt, with rational coefficients: constants, so they commute with p.

use std::ops::{Add, Mul, Neg, Sub};

use num_rational::BigRational;
use num_traits::{One, Zero};

/// Σ_r c_r pʳ.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polynomial(
    /// c₀, c₁, …, the last of which is not zero; none of the zero polynomial.
    Vec<BigRational>,
);

impl Polynomial {
    /// From c₀, c₁, ….
    pub fn new(mut coefficients: Vec<BigRational>) -> Self {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Polynomial(coefficients)
    }

    /// A number.
    pub fn number(number: BigRational) -> Self {
        Polynomial::new(vec![number])
    }

    /// 1.
    pub fn one() -> Self {
        Polynomial::number(BigRational::one())
    }

    /// pᵏ.
    pub fn power(k: usize) -> Self {
        let mut coefficients = vec![BigRational::zero(); k];
        coefficients.push(BigRational::one());
        Polynomial(coefficients)
    }

    /// p + κ.
    pub fn factor(kappa: &BigRational) -> Self {
        Polynomial::new(vec![kappa.clone(), BigRational::one()])
    }

    /// ∏_r (p + κ_r), which is (25).
    pub fn with_roots<'a>(kappas: impl IntoIterator<Item = &'a BigRational>) -> Self {
        kappas.into_iter().fold(Polynomial::one(), |product, kappa| &product * &Polynomial::factor(kappa))
    }

    /// c₀, c₁, …; none of the zero polynomial.
    pub fn coefficients(&self) -> &[BigRational] {
        &self.0
    }

    /// c_r.
    pub fn coefficient(&self, r: usize) -> BigRational {
        self.0.get(r).cloned().unwrap_or_else(BigRational::zero)
    }

    /// The highest power; `None` of the zero polynomial.
    pub fn degree(&self) -> Option<usize> {
        self.0.len().checked_sub(1)
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The quotient and what is left; `None` for a divisor of zero.
    pub fn divided_by(&self, divisor: &Polynomial) -> Option<(Polynomial, Polynomial)> {
        let (low, lead) = (divisor.degree()?, divisor.0.last()?);
        let mut left = self.0.clone();
        let mut quotient = vec![BigRational::zero(); left.len().saturating_sub(low)];
        for power in (0..quotient.len()).rev() {
            let share = &left[power + low] / lead;
            for (r, coefficient) in divisor.0.iter().enumerate() {
                left[power + r] -= &share * coefficient;
            }
            quotient[power] = share;
        }
        Some((Polynomial::new(quotient), Polynomial::new(left)))
    }

    /// The same powers times a number.
    pub fn scaled(&self, number: &BigRational) -> Self {
        Polynomial::new(self.0.iter().map(|coefficient| coefficient * number).collect())
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;

    fn add(self, other: &Polynomial) -> Polynomial {
        let len = self.0.len().max(other.0.len());
        Polynomial::new((0..len).map(|r| self.coefficient(r) + other.coefficient(r)).collect())
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;

    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;

    fn neg(self) -> Polynomial {
        Polynomial(self.0.iter().map(|coefficient| -coefficient).collect())
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;

    fn mul(self, other: &Polynomial) -> Polynomial {
        let mut product = vec![BigRational::zero(); (self.0.len() + other.0.len()).saturating_sub(1)];
        for (r, a) in self.0.iter().enumerate() {
            for (k, b) in other.0.iter().enumerate() {
                product[r + k] += a * b;
            }
        }
        Polynomial::new(product)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn rational(numerator: i32, denominator: u32) -> BigRational {
        BigRational::new(numerator.into(), (i64::from(denominator) + 1).into())
    }

    fn any() -> impl Strategy<Value = Polynomial> {
        let coefficient = (-20..20_i32, 0..6_u32).prop_map(|(n, d)| rational(n, d));
        proptest::collection::vec(coefficient, 0..7).prop_map(Polynomial::new)
    }

    #[test]
    fn eq_25_is_the_product_over_its_roots() {
        let product = Polynomial::with_roots(&[rational(1, 0), rational(5, 1), rational(3, 0)]);
        // (p + 1)(p + 5/2)(p + 3) = p³ + 13/2 p² + 13 p + 15/2
        assert_eq!(product.coefficients(), [rational(15, 1), rational(13, 0), rational(13, 1), rational(1, 0)]);
        let (quotient, rest) = product.divided_by(&Polynomial::factor(&rational(5, 1))).unwrap();
        assert_eq!(
            (quotient, rest),
            (Polynomial::with_roots(&[rational(1, 0), rational(3, 0)]), Polynomial::default())
        );
        assert_eq!(product.divided_by(&Polynomial::default()), None);
    }

    proptest! {
        #[test]
        fn prop_division_gives_back_what_was_divided(a in any(), b in any()) {
            if let Some((quotient, rest)) = a.divided_by(&b) {
                prop_assert_eq!(&(&quotient * &b) + &rest, a);
                prop_assert!(rest.degree() < b.degree());
            } else {
                prop_assert!(b.is_zero());
            }
        }

        #[test]
        fn prop_polynomials_are_a_ring(a in any(), b in any(), c in any()) {
            prop_assert_eq!(&(&a + &b) * &c, &(&a * &c) + &(&b * &c));
            prop_assert_eq!(&a * &b, &b * &a);
            prop_assert!((&a - &a).is_zero());
        }
    }
}
