//! Eigenvalues of small dense matrices.

use nalgebra::{DMatrix, DVector, Schur};

use super::characteristic::C;

/// QR steps, many more than are needed.
const MOST_STEPS: usize = 10_000;
/// How small a subdiagonal entry is taken for zero, relative to its neighbours, one attempt after the other.
const SMALL: [f64; 3] = [1e-14, 1e-13, 1e-12];

/// All eigenvalues of `matrix`; `None` when they do not converge, or an entry is not finite.
///
/// The QR algorithm has no exceptional shifts and stalls on a matrix that permutes, as that of a ring does: it is given a
/// mirror image, which has the same eigenvalues and no structure.
pub(crate) fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<C>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    SMALL.iter().enumerate().find_map(|(attempt, small)| {
        let mirrored = mirrored(matrix, attempt + 1);
        Some(Schur::try_new(mirrored, *small, MOST_STEPS)?.complex_eigenvalues().iter().copied().collect())
    })
}

/// H A H with H = 1 − 2 v vᵀ for a unit vector v that looks arbitrary.
fn mirrored(matrix: &DMatrix<f64>, attempt: usize) -> DMatrix<f64> {
    let v = DVector::from_fn(matrix.nrows(), |k, _| libm::sin((12.9898 * k as f64 + 0.7) * attempt as f64)).normalize();
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
    }
}
