//! Positive definite gains K and Γ: a number, a diagonal, a matrix, or a bandwidth times a natural scale.

use alloc::vec;
use alloc::vec::Vec;

use crate::{GainError, LengthError, Scalar};

/// A gain as a user states it.
#[derive(Clone, Debug, PartialEq)]
pub enum Gain {
    /// The same positive number on the whole diagonal.
    Number(f64),
    /// A positive diagonal.
    Diagonal(Vec<f64>),
    /// A symmetric positive definite matrix, row by row.
    Matrix(Vec<f64>),
    /// A bandwidth ω in 1/s, multiplied by a natural scale of each axis or parameter.
    ///
    /// For K the scale is diag M(q₀), so that K M⁻¹ is about ω on every joint; the paper's single number would be stiff
    /// on the light joints of a real arm. For Γ see [`crate::robot::Lagrangian::adaptation_scale`].
    Bandwidth(f64),
}

/// A gain of known size, checked to be symmetric positive definite.
#[derive(Clone, Debug, PartialEq)]
pub enum ResolvedGain {
    /// diag(k₁ … kₙ).
    Diagonal(Vec<f64>),
    /// A full matrix, row by row.
    Matrix {
        /// Number of rows.
        size: usize,
        /// size² entries, row by row.
        entries: Vec<f64>,
        /// Its lower Cholesky factor, row by row.
        factor: Vec<f64>,
    },
}

impl Gain {
    /// Checks the gain against its size and, for [`Gain::Bandwidth`], multiplies by `scale`.
    ///
    /// # Errors
    /// [`GainError`] when the size is wrong or the gain is not symmetric positive definite.
    pub fn resolve(&self, size: usize, scale: &[f64]) -> Result<ResolvedGain, GainError> {
        match self {
            Gain::Number(k) => diagonal(vec![*k; size]),
            Gain::Diagonal(k) => {
                LengthError::check("gain diagonal", size, k.len())?;
                diagonal(k.clone())
            }
            Gain::Matrix(entries) => {
                LengthError::check("gain matrix", size * size, entries.len())?;
                matrix(size, entries)
            }
            Gain::Bandwidth(omega) => {
                if scale.len() != size {
                    return Err(GainError::NoScale { bandwidth_per_s: *omega, need: size, got: scale.len() });
                }
                // Checked apart, so that two negative factors do not pass for a gain.
                diagonal(vec![*omega])?;
                diagonal(scale.iter().map(|m| omega * m).collect())
            }
        }
    }
}

fn diagonal(k: Vec<f64>) -> Result<ResolvedGain, GainError> {
    match k.iter().position(|k| !(*k > 0.0 && k.is_finite())) {
        Some(index) => Err(GainError::NotPositive { index, value: k[index] }),
        None => Ok(ResolvedGain::Diagonal(k)),
    }
}

fn matrix(size: usize, entries: &[f64]) -> Result<ResolvedGain, GainError> {
    for (index, value) in entries.iter().enumerate() {
        if !value.is_finite() {
            return Err(GainError::NotPositive { index, value: *value });
        }
    }
    for row in 0..size {
        for column in row + 1..size {
            let (upper, lower) = (entries[row * size + column], entries[column * size + row]);
            if upper != lower {
                return Err(GainError::NotSymmetric { row, column, upper, lower });
            }
        }
    }
    let factor = cholesky(size, entries).map_err(|order| GainError::NotPositiveDefinite { order })?;
    Ok(ResolvedGain::Matrix { size, entries: entries.to_vec(), factor })
}

/// Lower factor L of A = L Lᵀ, or the order of the first leading minor that is not positive.
fn cholesky(size: usize, a: &[f64]) -> Result<Vec<f64>, usize> {
    let mut l = vec![0.0; size * size];
    for i in 0..size {
        for j in 0..=i {
            let mut sum = a[i * size + j];
            for k in 0..j {
                sum -= l[i * size + k] * l[j * size + k];
            }
            if i == j {
                if sum <= 0.0 || !sum.is_finite() {
                    return Err(i + 1);
                }
                l[i * size + i] = libm::sqrt(sum);
            } else {
                l[i * size + j] = sum / l[j * size + j];
            }
        }
    }
    Ok(l)
}

impl ResolvedGain {
    /// Number of rows.
    pub fn size(&self) -> usize {
        match self {
            ResolvedGain::Diagonal(k) => k.len(),
            ResolvedGain::Matrix { size, .. } => *size,
        }
    }

    /// out = gain · x. Entries beyond [`ResolvedGain::size`] are left alone.
    #[inline(always)]
    pub fn apply<S: Scalar>(&self, x: &[S], out: &mut [S]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for ((out, k), x) in out.iter_mut().zip(k).zip(x) {
                    *out = S::splat(*k) * *x;
                }
            }
            ResolvedGain::Matrix { size, entries, .. } => {
                for (out, row) in out.iter_mut().zip(entries.chunks_exact(*size)) {
                    let mut sum = S::ZERO;
                    for (a, x) in row.iter().zip(x) {
                        sum = S::splat(*a).mul_add(*x, sum);
                    }
                    *out = sum;
                }
            }
        }
    }

    /// out −= gain · x. Entries beyond [`ResolvedGain::size`] are left alone.
    #[inline(always)]
    pub fn subtract_from<S: Scalar>(&self, x: &[S], out: &mut [S]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for ((out, k), x) in out.iter_mut().zip(k).zip(x) {
                    *out = S::splat(*k).neg_mul_add(*x, *out);
                }
            }
            ResolvedGain::Matrix { size, entries, .. } => {
                for (out, row) in out.iter_mut().zip(entries.chunks_exact(*size)) {
                    for (a, x) in row.iter().zip(x) {
                        *out = S::splat(*a).neg_mul_add(*x, *out);
                    }
                }
            }
        }
    }

    /// xᵀ · gain⁻¹ · x, for Lyapunov-like functions. `work` has [`ResolvedGain::size`] entries.
    pub fn inverse_quadratic(&self, x: &[f64], work: &mut [f64]) -> f64 {
        let mut sum = 0.0;
        match self {
            ResolvedGain::Diagonal(k) => {
                for (k, x) in k.iter().zip(x) {
                    sum += x * x / k;
                }
            }
            ResolvedGain::Matrix { size, factor, .. } => {
                // gain = L Lᵀ, so the value is |L⁻¹ x|².
                for (i, (row, x)) in factor.chunks_exact(*size).zip(x).enumerate() {
                    let (done, rest) = work.split_at_mut(i.min(work.len()));
                    let mut v = *x;
                    for (l, y) in row.iter().zip(&*done) {
                        v -= l * y;
                    }
                    let y = v / row[i];
                    if let Some(slot) = rest.first_mut() {
                        *slot = y;
                    }
                    sum += y * y;
                }
            }
        }
        sum
    }
}
