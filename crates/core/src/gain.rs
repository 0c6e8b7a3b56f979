//! Positive definite gains K and Γ: a number, a diagonal, a matrix, or a bandwidth times a natural scale.

use alloc::vec;
use alloc::vec::Vec;

use crate::{GainError, LengthError};

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
    cholesky(size, entries).map_err(|order| GainError::NotPositiveDefinite { order })?;
    Ok(ResolvedGain::Matrix { size, entries: entries.to_vec() })
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
    pub fn apply(&self, x: &[f64], out: &mut [f64]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for ((out, k), x) in out.iter_mut().zip(k).zip(x) {
                    *out = k * x;
                }
            }
            ResolvedGain::Matrix { size, entries } => {
                for (out, row) in out.iter_mut().zip(entries.chunks_exact(*size)) {
                    let mut sum = 0.0;
                    for (a, x) in row.iter().zip(x) {
                        sum = crate::Scalar::mul_add(*a, *x, sum);
                    }
                    *out = sum;
                }
            }
        }
    }

    /// xᵀ · gain⁻¹ · x, for Lyapunov-like functions.
    pub fn inverse_quadratic(&self, x: &[f64]) -> f64 {
        match self {
            ResolvedGain::Diagonal(k) => k.iter().zip(x).map(|(k, x)| x * x / k).sum(),
            ResolvedGain::Matrix { size, entries } => {
                // gain = L Lᵀ, so the value is |L⁻¹x|²; the gain was checked when it was built.
                let Ok(l) = cholesky(*size, entries) else { return f64::NAN };
                let mut y = vec![0.0; *size];
                let mut sum = 0.0;
                for i in 0..*size {
                    let mut v = x[i];
                    for k in 0..i {
                        v -= l[i * size + k] * y[k];
                    }
                    y[i] = v / l[i * size + i];
                    sum += y[i] * y[i];
                }
                sum
            }
        }
    }
}
