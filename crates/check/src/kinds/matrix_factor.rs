//! How far a matrix ψ of the state stays from having no inverse, whatever the state is.
//!
//! Every entry is enclosed over all states by itself. Of the bounds on the smallest singular value that such enclosures give, the better
//! one is taken:
//!
//! - *Dominance.* Rows may change their sign, which is an orthogonal factor, so let the diagonal be positive. For any v,
//!   ‖A v‖ ‖v‖ ≥ vᵀAv = vᵀ½(A + Aᵀ)v, so σ_min(A) is at least the smallest eigenvalue of the symmetric part, and by Gershgorin's discs that is at
//!   least min_i (a_ii − ½ Σ_{j≠i} (|a_ij| + |a_ji|)).
//! - *Determinant.* The product of the other m − 1 singular values is at most the power m − 1 of their quadratic mean, so
//!   σ_min ≥ |det A| ((m − 1)/‖A‖_F²)^((m−1)/2) with Frobenius' norm; for m = 1 it is |A|.
//!
//! All sums are rounded outwards. The power is not, by which a few units in the last place could be gained: it is moved down by much more
//! than they are.

use forwardstep_core::expression::{Expression, Interval};
use num_rational::BigRational;
use num_traits::{One, Zero};

/// Matrices with more rows have too many terms in their determinant.
const MOST_EXPANDED: usize = 6;
/// More than any rounding of a power.
const ROOM: f64 = 1e-12;

/// A lower bound on the smallest singular value in every state; zero where none is found.
pub(super) fn least_everywhere(psi: &[Vec<Expression>]) -> f64 {
    let entries = enclosed(psi);
    dominance(&entries).max(by_determinant(&entries))
}

fn enclosed(psi: &[Vec<Expression>]) -> Vec<Vec<Interval>> {
    psi.iter().map(|row| row.iter().map(|entry| entry.everywhere().0).collect()).collect()
}

/// A vector that a constant matrix of rational numbers takes to zero, which shows that it has no inverse; `None` for any other matrix.
pub(crate) fn null_vector(psi: &[Vec<Expression>]) -> Option<Vec<BigRational>> {
    let exact = |entry: &Expression| entry.constant()?.exact();
    let mut rows: Vec<Vec<BigRational>> =
        psi.iter().map(|row| row.iter().map(exact).collect()).collect::<Option<_>>()?;
    // Of each column that has one, the row whose first entry that is not zero stands there; the others are zero in it.
    let mut leads: Vec<usize> = Vec::new();
    for column in 0..rows.len() {
        let done = leads.len();
        let Some(at) = (done..rows.len()).find(|at| !rows[*at][column].is_zero()) else {
            let mut vector = vec![BigRational::zero(); rows.len()];
            vector[column] = BigRational::one();
            for (row, lead) in rows.iter().zip(leads) {
                vector[lead] = -row[column].clone();
            }
            return Some(vector);
        };
        rows.swap(done, at);
        let lead = rows[done][column].clone();
        let row: Vec<BigRational> = rows[done].iter().map(|entry| entry / &lead).collect();
        for other in rows.iter_mut() {
            let share = other[column].clone();
            for (entry, own) in other.iter_mut().zip(&row) {
                *entry -= &share * own;
            }
        }
        rows[done] = row;
        leads.push(column);
    }
    None
}

fn dominance(entries: &[Vec<Interval>]) -> f64 {
    let size = |row: usize, column: usize| Interval::point(entries[row][column].size());
    let row = |i: usize| {
        let own = entries[i][i].low.max(-entries[i][i].high);
        let others = (0..entries.len()).filter(|j| *j != i);
        let sum = others.fold(Interval::point(0.0), |sum, j| sum + size(i, j) + size(j, i));
        (Interval::point(own) - sum * Interval::point(0.5)).low
    };
    // Not a number, where something has no value, is no bound: of it and zero, zero is taken.
    (0..entries.len()).map(row).fold(f64::INFINITY, |least, row| least.min(row.max(0.0)))
}

fn by_determinant(entries: &[Vec<Interval>]) -> f64 {
    let m = entries.len();
    if m > MOST_EXPANDED {
        return 0.0;
    }
    let found = determinant(entries, &(0..m).collect::<Vec<_>>(), &Interval::point(0.0));
    let least = found.low.max(-found.high);
    let square = |entry: &Interval| Interval::point(entry.size()) * Interval::point(entry.size());
    let norm = entries.iter().flatten().fold(Interval::point(0.0), |sum, entry| sum + square(entry)).high;
    let others = m.saturating_sub(1) as f64;
    let bound = least * libm::pow(others / norm, others / 2.0) * (1.0 - ROOM);
    // Where the norm is too small for a number, it is no bound either.
    if bound.is_finite() { bound.max(0.0) } else { 0.0 }
}

/// By expansion along the rows from that after `rows.len() − columns.len()` on, over `columns`.
fn determinant<S>(rows: &[Vec<S>], columns: &[usize], zero: &S) -> S
where
    S: Clone + std::ops::Add<Output = S> + std::ops::Sub<Output = S> + std::ops::Mul<Output = S>,
{
    let row = &rows[rows.len() - columns.len()];
    if let [last] = columns {
        return row[*last].clone();
    }
    let mut sum = zero.clone();
    for (place, column) in columns.iter().enumerate() {
        let others: Vec<usize> = columns.iter().copied().filter(|other| other != column).collect();
        let term = row[*column].clone() * determinant(rows, &others, zero);
        sum = if place % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

#[cfg(test)]
mod tests {
    use forwardstep_core::expression::Number;

    use super::*;

    fn numbers(rows: &[&[f64]]) -> Vec<Vec<Expression>> {
        rows.iter().map(|row| row.iter().map(|entry| Expression::number(*entry)).collect()).collect()
    }

    #[test]
    fn prop_the_bound_is_below_the_smallest_singular_value_and_near_it_where_it_is_sharp() {
        // A multiple of a rotation has equal singular values; both bounds meet them where they apply.
        let turned = least_everywhere(&numbers(&[&[0.6, -0.8], &[0.8, 0.6]]));
        assert!((turned - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-9, "{turned}");
        let diagonal = least_everywhere(&numbers(&[&[-3.0, 0.0, 0.0], &[0.0, 2.0, 0.0], &[0.0, 0.0, 5.0]]));
        assert_eq!(diagonal, 2.0);
        let swapped = least_everywhere(&numbers(&[&[0.0, 1.0], &[1.0, 0.0]]));
        assert!(swapped > 0.7 && swapped <= 1.0, "{swapped}");
        for singular in [&[&[1.0, 2.0][..], &[2.0, 4.0]][..], &[&[0.0, 0.0], &[0.0, 1.0]]] {
            assert_eq!(least_everywhere(&numbers(singular)), 0.0);
        }
    }

    #[test]
    fn each_bound_by_itself_is_what_its_formula_says_and_zero_where_it_says_nothing() {
        let dominance = |rows: &[&[f64]]| super::dominance(&enclosed(&numbers(rows)));
        let by_determinant = |rows: &[&[f64]]| super::by_determinant(&enclosed(&numbers(rows)));
        let is = |found: f64, expected: f64| found < expected * (1.0 - 0.9 * ROOM) && found > expected * (1.0 - 1e-11);
        // min(5 − ½ (2 + 1), 3 − ½ (2 + 1)), and none where a row is not larger than the others.
        assert!((dominance(&[&[5.0, 2.0], &[-1.0, -3.0]]) - 1.5).abs() < 1e-12);
        assert!((dominance(&[&[-3.0, 2.0], &[-1.0, 5.0]]) - 1.5).abs() < 1e-12);
        for weak in [&[&[1.0, 2.0][..], &[1.0, 5.0]][..], &[&[5.0, 2.0], &[1.0, 1.0]], &[&[0.0, 0.0], &[0.0, 1.0]]] {
            assert_eq!(dominance(weak), 0.0);
        }
        // With m = 1 the power is one, with m = 3 it is the first; of two rows |det|/‖A‖.
        assert!(is(by_determinant(&[&[-3.0]]), 3.0));
        assert!(is(by_determinant(&[&[0.0, 1.0, 0.0], &[0.0, 0.0, -1.0], &[1.0, 0.0, 0.0]]), 2.0 / 3.0));
        assert!(is(by_determinant(&[&[5.0, 2.0], &[-1.0, -3.0]]), 13.0 / 39.0_f64.sqrt()));
        // Six rows are expanded, seven are not.
        let shifted = |m: usize| {
            let row = |i: usize| (0..m).map(|j| Interval::point(if j == (i + 1) % m { 1.0 } else { 0.0 })).collect();
            super::by_determinant(&(0..m).map(row).collect::<Vec<_>>())
        };
        assert!(is(shifted(6), (5.0_f64 / 6.0).powf(2.5)));
        assert_eq!(shifted(7), 0.0);
        // What may have no inverse, and numbers that are too small or too large for their squares.
        for [low, high] in [[-1.0, 1.0], [0.0, 1.0], [-1.0, 0.0], [f64::NAN, 1.0], [1.0, f64::INFINITY]] {
            assert_eq!(
                super::by_determinant(&[vec![Interval { low, high }]]),
                if low == 1.0 { 1.0 - ROOM } else { 0.0 }
            );
        }
        for size in [1e-160, 1e-200, 1e200] {
            assert_eq!(by_determinant(&[&[0.0, size], &[size, 0.0]]), 0.0);
        }
        let unknown = Interval { low: f64::NAN, high: f64::NAN };
        assert_eq!(super::dominance(&[vec![Interval::point(2.0), unknown], vec![unknown, Interval::point(2.0)]]), 0.0);
    }

    #[test]
    fn prop_a_null_vector_is_taken_to_zero_and_others_have_none() {
        let singular: [&[&[f64]]; 4] = [
            &[&[1.0, 2.0], &[2.0, 4.0]],
            &[&[0.0, 0.0, 1.0], &[0.0, 3.0, 0.0], &[0.0, 1.0, 1.0]],
            &[&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0], &[7.0, 8.0, 9.0]],
            &[&[0.0]],
        ];
        for rows in singular {
            let vector = null_vector(&numbers(rows)).unwrap_or_default();
            assert!(vector.iter().any(|entry| !entry.is_zero()), "{rows:?}");
            for row in rows {
                let parts = row.iter().zip(&vector).map(|(entry, x)| Number::written(*entry) * x);
                assert!(parts.sum::<BigRational>().is_zero(), "{rows:?}: {vector:?}");
            }
        }
        // So small a determinant is no number of floating point.
        let regular: [&[&[f64]]; 3] =
            [&[&[1e-200, 0.0], &[0.0, 1e-200]], &[&[0.0, 1.0], &[1.0, 0.0]], &[&[1.0, 2.0], &[2.0, 4.0000000001]]];
        for rows in regular {
            assert_eq!(null_vector(&numbers(rows)), None, "{rows:?}");
        }
        assert_eq!(null_vector(&[vec![Expression::variable(0)]]), None);
    }

    #[test]
    fn prop_the_bound_holds_in_random_states_of_random_matrices() {
        let mut drawn = (0..).map(|k: u32| (f64::from(k) * 0.618_033_988_749_894_9).fract() * 2.0 - 1.0);
        let mut bounded = 0;
        for _ in 0..200 {
            let [a, b, c, d, e] = std::array::from_fn(|_| drawn.next().unwrap_or(0.0));
            let x = Expression::variable(0);
            // a + 2 + b sin x and so on: [2 + a + b sin x, c; d cos x, 2 + e]
            let psi = vec![
                vec![Expression::number(2.0 + a) + Expression::number(b) * x.clone().sin_of(), Expression::number(c)],
                vec![Expression::number(d) * x.cos_of(), Expression::number(2.0 + e)],
            ];
            let least = least_everywhere(&psi);
            bounded += usize::from(least > 0.0);
            for k in 0..40 {
                let [p, q, r, s] = [0, 1, 2, 3].map(|at| psi[at / 2][at % 2].value(&[f64::from(k) * 0.3]));
                // Of two rows the singular values solve σ⁴ − ‖A‖² σ² + det² = 0.
                let (norm, det) = (p * p + q * q + r * r + s * s, p * s - q * r);
                let smallest = ((norm - (norm * norm - 4.0 * det * det).max(0.0).sqrt()) / 2.0).max(0.0).sqrt();
                assert!(least <= smallest + 1e-9, "{least} > {smallest}");
            }
        }
        assert!(bounded > 100, "{bounded}");
    }

    #[test]
    fn a_constant_matrix_without_an_inverse_is_found_by_exact_numbers() {
        assert!(null_vector(&numbers(&[&[0.5, 1.5], &[1.0, 3.0]])).is_some());
        assert!(null_vector(&numbers(&[&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0], &[7.0, 8.0, 9.0]])).is_some());
        assert_eq!(null_vector(&numbers(&[&[1.0, 2.0], &[2.0, 4.5]])), None);
        assert_eq!(null_vector(&[vec![Expression::variable(0)]]), None);
    }
}
