//! Eigenvalues of small dense matrices.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, DVector, Schur};

use super::characteristic::C;

/// QR steps per row, many more than are needed.
const STEPS_OF_A_ROW: usize = 60;
/// How small a subdiagonal entry is taken for zero, relative to its neighbours, one attempt after the other.
const SMALL: [f64; 5] = [1e-14, 1e-13, 1e-12, 1e-11, 1e-10];
/// Sizes of entries of a matrix that is balanced.
const LIMITS: core::ops::Range<f64> = 1e-60..1e60;
/// Mirror images that are tried with each.
const IMAGES: usize = 3;

/// All eigenvalues of `matrix`; `None` when they do not converge, or an entry is not finite.
///
/// The QR algorithm has no exceptional shifts and stalls on a matrix that permutes, as that of a ring does: it is given a
/// mirror image, which has the same eigenvalues and no structure. Where an eigenvalue is that of several alike agents it stalls too, unless
/// rows are as large as columns before, and after that on fewer of the images the more is taken for zero.
pub(crate) fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<C>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let mut balanced = matrix.clone();
    // Balancing does not end where what it scales by overflows.
    let is_moderate = |entry: &f64| *entry == 0.0 || LIMITS.contains(&entry.abs());
    if matrix.iter().all(is_moderate) {
        balance_parlett_reinsch(&mut balanced);
    }
    let steps = STEPS_OF_A_ROW * matrix.nrows();
    let mut attempts = SMALL.iter().flat_map(|small| (1..=IMAGES).map(move |image| (small, image)));
    attempts.find_map(|(small, image)| {
        let found = Schur::try_new(mirrored(&balanced, image), *small, steps)?;
        Some(found.complex_eigenvalues().iter().copied().collect())
    })
}

/// H A H with H = 1 − 2 v vᵀ for a unit vector v that looks arbitrary.
fn mirrored(matrix: &DMatrix<f64>, image: usize) -> DMatrix<f64> {
    let v = DVector::from_fn(matrix.nrows(), |k, _| libm::sin((12.9898 * k as f64 + 0.7) * image as f64)).normalize();
    let left = matrix - &v * (v.transpose() * matrix) * 2.0;
    let right = (&left * &v) * v.transpose() * 2.0;
    left - right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutations_and_triangles_have_theirs() {
        for n in [1, 2, 3, 8, 30] {
            let cycle = DMatrix::from_fn(n, n, |i, j| if i == (j + 1) % n { 1.0 } else { 0.0 });
            let found = eigenvalues(&cycle).unwrap();
            assert_eq!(found.len(), n);
            for k in 0..n {
                let angle = core::f64::consts::TAU * k as f64 / n as f64;
                let wanted = C::new(libm::cos(angle), libm::sin(angle));
                assert!(found.iter().any(|mu| (mu - wanted).norm_sqr() < 1e-20), "{n}: {wanted}");
            }
        }
        let triangle = DMatrix::from_fn(5, 5, |i, j| if i <= j { (1 + i) as f64 } else { 0.0 });
        let found = eigenvalues(&triangle).unwrap();
        assert!((1..=5).all(|k| found.iter().any(|mu| (mu - C::from(f64::from(k))).norm_sqr() < 1e-20)));
        assert_eq!(eigenvalues(&DMatrix::from_element(2, 2, f64::NAN)), None);
        let far = DMatrix::from_row_slice(2, 2, &[-1e300, 1e300, 1e-300, -1.0]);
        assert!(eigenvalues(&far).is_none_or(|found| found.len() == 2), "it ends");
    }

    /// Several agents that are alike, with entries of very different sizes, and what differences miss.
    #[test]
    fn eigenvalues_that_many_agents_have_converge() {
        let companion = [[0.0, 0.08, 0.003], [-0.15, -0.08, 0.07], [-63.0, -32.0, -1.15]];
        let own = DMatrix::from_fn(3, 3, |i, j| companion[i][j]);
        let largest = |found: &[C]| found.iter().map(|mu| (mu + 1.0).norm_sqr().sqrt()).fold(0.0, f64::max);
        let wanted = largest(&eigenvalues(&own).unwrap());
        for copies in [3, 9, 15, 30] {
            for noise in [0.0, 1e-12, 1e-10] {
                let missed = |i: usize, j: usize| 1.0 + noise * libm::sin(12.9898 * i as f64 + 78.233 * j as f64);
                let all = DMatrix::from_fn(3 * copies, 3 * copies, |i, j| {
                    let own = if i % copies == j % copies { companion[i / copies][j / copies] } else { 0.0 };
                    own * missed(i, j)
                });
                let found = eigenvalues(&all).unwrap_or_default();
                assert!((largest(&found) - wanted).abs() < 1e-4, "{copies}, {noise}: {}", largest(&found));
            }
        }
    }
}
