//! Matrices whose eigenvalues and singular values can be asked for: the iterations for these do not end where an entry is not finite.

use nalgebra::DMatrix;

/// The same matrix; `None` where an entry is not finite.
pub(crate) fn finite(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    Some(matrix).filter(|matrix| matrix.iter().all(|entry| entry.is_finite()))
}
