//! Whether a symmetric matrix is positive definite, decided exactly.
//!
//! Rounding makes a Cholesky factor of a singular matrix, and of [[1, 2, 3], [2, 4, 6], [3, 6, 10]] it finds none only by luck.
//! Here A = L D Lᵀ is eliminated in intervals that are rounded outwards, which decides all matrices but those that are almost
//! singular, and those are eliminated in rational numbers.
//!
//! Entries are known twice: as an `f64`, which is what a law multiplies by, and as the shortest decimal that reads as that `f64`,
//! which is what somebody wrote. [[0.1, 0.3], [0.3, 0.9]] is singular as it is written and is not in `f64`. Both have to be
//! positive definite.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::GainError;
use crate::expression::{Interval, Number};

/// What refutes that a symmetric matrix A is positive definite: v ≠ 0 with vᵀA v ≤ 0, in exact numbers.
///
/// `Display` writes `vᵀ A v = 0 for v = (-2, 1, 0)`, with six digits where exact numbers are long.
#[derive(Clone, Debug, PartialEq)]
pub struct Indefinite {
    /// v, one entry per row. With the order k of the first leading minor that is not positive, the k-th entry is 1 and those
    /// after it are 0.
    pub direction: Vec<BigRational>,
    /// vᵀA v.
    pub value: BigRational,
}

/// Rows of a matrix that is eliminated in rational numbers, whose digits grow with every row.
const MOST_ROWS: usize = 32;

/// Checks that a symmetric matrix, row by row, is positive definite. Only entries on and below the diagonal are looked at, and
/// all of those have to be finite.
///
/// # Errors
/// [`GainError::NotPositiveDefinite`] with a direction in which it is not; [`GainError::NearlySingular`] where intervals do not
/// decide a matrix that is too large for rational numbers.
pub(crate) fn positive_definite(size: usize, entries: &[f64]) -> Result<(), GainError> {
    let Err(order) = pivots_are_positive(size, entries) else { return Ok(()) };
    if size > MOST_ROWS {
        return Err(GainError::NearlySingular { order });
    }
    decide(size, entries).map_err(|refuted| GainError::NotPositiveDefinite(Box::new(refuted)))
}

fn decide(size: usize, entries: &[f64]) -> Result<(), Indefinite> {
    eliminate(size, &entries.iter().map(|entry| Number::written(*entry)).collect::<Vec<_>>())?;
    eliminate(size, &entries.iter().map(|entry| binary(*entry)).collect::<Vec<_>>())
}

fn binary(entry: f64) -> BigRational {
    BigRational::from_float(entry).unwrap_or_else(BigRational::zero)
}

/// Whether all pivots are shown to be positive in intervals, whichever way entries are read; otherwise the order of the first
/// leading minor that is not.
fn pivots_are_positive(size: usize, entries: &[f64]) -> Result<(), usize> {
    // The decimal lies within half a unit in the last place.
    let mut a: Vec<Interval> =
        entries.iter().map(|entry| Interval { low: entry.next_down(), high: entry.next_up() }).collect();
    for k in 0..size {
        let pivot = a[k * size + k];
        if !(pivot.low > 0.0 && pivot.is_finite()) {
            return Err(k + 1);
        }
        for i in k + 1..size {
            let factor = a[i * size + k].div(pivot);
            for j in k + 1..=i {
                a[i * size + j] = a[i * size + j].sub(factor.mul(a[j * size + k]));
            }
        }
    }
    Ok(())
}

/// A = L D Lᵀ in rational numbers. Where the pivot d of row k is not positive, v with Lᵀv = e_k has vᵀA v = d.
fn eliminate(size: usize, entries: &[BigRational]) -> Result<(), Indefinite> {
    let mut a = entries.to_vec();
    for k in 0..size {
        let pivot = a[k * size + k].clone();
        if !pivot.is_positive() {
            return Err(Indefinite { direction: direction(size, k, &a), value: pivot });
        }
        for i in k + 1..size {
            let factor = &a[i * size + k] / &pivot;
            for j in k + 1..=i {
                let product = &factor * &a[j * size + k];
                a[i * size + j] -= product;
            }
        }
        // L stands below the diagonal from here on.
        for i in k + 1..size {
            a[i * size + k] = &a[i * size + k] / &pivot;
        }
    }
    Ok(())
}

/// v with Lᵀv = e_k, where the first k columns of L stand below the diagonal of `a`.
fn direction(size: usize, k: usize, a: &[BigRational]) -> Vec<BigRational> {
    let mut v = vec![BigRational::zero(); size];
    v[k] = BigRational::one();
    for row in (0..k).rev() {
        v[row] = -(row + 1..=k).map(|below| &a[below * size + row] * &v[below]).sum::<BigRational>();
    }
    v
}

impl Indefinite {
    /// The order of the first leading minor that is not positive.
    pub fn order(&self) -> usize {
        self.direction.iter().rposition(|entry| !entry.is_zero()).map_or(0, |last| last + 1)
    }
}

impl fmt::Display for Indefinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const LONG: u64 = 20;
        let number = |f: &mut fmt::Formatter<'_>, number: &BigRational| {
            if number.numer().bits() + number.denom().bits() <= LONG {
                write!(f, "{number}")
            } else {
                write!(f, "{:.5e}", number.to_f64().unwrap_or(f64::NAN))
            }
        };
        f.write_str("vᵀ A v = ")?;
        number(f, &self.value)?;
        f.write_str(" for v = (")?;
        for (k, entry) in self.direction.iter().enumerate() {
            f.write_str(if k == 0 { "" } else { ", " })?;
            number(f, entry)?;
        }
        f.write_str(")")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// vᵀA v from the definition, for both ways to read A.
    fn quadratic(entries: &[f64], read: fn(f64) -> BigRational, v: &[BigRational]) -> BigRational {
        let n = v.len();
        let term = |at: usize| read(entries[at]) * &v[at / n] * &v[at % n];
        (0..n * n).map(term).sum()
    }

    #[test]
    fn a_singular_matrix_of_integers_is_refuted_by_a_direction() {
        let a = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 3.0, 6.0, 10.0];
        let found = decide(3, &a).unwrap_err();
        assert_eq!(found.to_string(), "vᵀ A v = 0 for v = (-2, 1, 0)");
        assert_eq!((found.order(), quadratic(&a, binary, &found.direction)), (2, BigRational::zero()));
    }

    #[test]
    fn prop_every_refutation_can_be_replayed() {
        let cases: [(usize, &[f64]); 5] = [
            (1, &[-3.0]),
            (2, &[1.0, 2.0, 2.0, 1.0]),
            (2, &[0.0, 0.0, 0.0, 1.0]),
            (3, &[2.0, -1.0, -1.0, -1.0, 2.0, -1.0, -1.0, -1.0, 2.0]),
            (3, &[0.1, 0.2, 0.3, 0.2, 0.5, 0.7, 0.3, 0.7, 0.9]),
        ];
        for (n, a) in cases {
            let found = decide(n, a).unwrap_err();
            assert_eq!(quadratic(a, Number::written, &found.direction), found.value);
            assert!(!found.value.is_positive() && found.order() > 0, "{found}");
        }
    }

    #[test]
    fn decimals_and_what_a_law_multiplies_by_both_have_to_be_positive_definite() {
        let decimal = [0.1, 0.3, 0.3, 0.9];
        assert!(decide(2, &decimal).unwrap_err().value.is_zero(), "0.1 · 0.9 − 0.3² as it is written");
        assert!(eliminate(2, &decimal.map(binary)).is_ok(), "f64 alone would not have shown it");
        // Intervals of f64 alone would even have decided this one: 0.69² is 0.4761 as it is written, and less in f64.
        assert!(positive_definite(2, &[1.0, 0.69, 0.69, 0.4761]).is_err());
        // And the other way round.
        let rounded = [0.3, 1.1, 1.1, 4.033333333333334];
        assert!(eliminate(2, &rounded.map(Number::written)).is_ok() && decide(2, &rounded).is_err());
    }

    #[test]
    fn prop_intervals_and_rational_numbers_decide_alike() {
        // A = B Bᵀ + ε for B of random small integers, singular for ε = 0.
        let mut state = 7_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 7) as f64 - 3.0
        };
        for case in 0..200 {
            let n = 2 + case % 5;
            let b: Vec<f64> = (0..n * (n - 1)).map(|_| draw()).collect();
            let entry = |i: usize, j: usize| (0..n - 1).map(|k| b[i * (n - 1) + k] * b[j * (n - 1) + k]).sum::<f64>();
            let with = |shift: f64| -> Vec<f64> {
                (0..n * n).map(|at| entry(at / n, at % n) + if at / n == at % n { shift } else { 0.0 }).collect()
            };
            let [below, singular, above] = [-1.0, 0.0, 1.0].map(|sign| decide(n, &with(sign / 1024.0)));
            assert!(above.is_ok() && singular.is_err() && below.is_err(), "{b:?}");
            assert!(
                pivots_are_positive(n, &with(1.0)).is_ok(),
                "what is not almost singular needs no rational numbers: {b:?}"
            );
        }
    }

    #[test]
    fn large_matrices_are_decided_in_intervals_or_not_at_all() {
        let n = 40;
        let filled = |diagonal: f64| -> Vec<f64> {
            (0..n * n).map(|at| if at / n == at % n { diagonal } else { 1.0 }).collect()
        };
        assert_eq!(positive_definite(n, &filled(1.5)), Ok(()));
        assert_eq!(positive_definite(n, &filled(1.0)), Err(GainError::NearlySingular { order: 2 }));
    }
}
