//! Positive definite gains K and Γ: a number, a diagonal, a matrix, or a bandwidth times a natural scale.

use alloc::vec;
use alloc::vec::Vec;

use crate::definite::positive_definite;
use crate::{GainError, LengthError, Packed, Scalar};

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

/// A gain of known size, checked to be symmetric positive definite when it was [resolved](Gain::resolve).
///
/// In lanes it is the gains of several agents side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum ResolvedGain<S = f64> {
    /// diag(k₁ … kₙ).
    Diagonal(Vec<S>),
    /// A full matrix, row by row.
    Matrix {
        /// Number of rows.
        size: usize,
        /// size² entries, row by row.
        entries: Vec<S>,
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
    positive_definite(size, entries)?;
    cholesky(size, entries).map_err(|order| GainError::NearlySingular { order })?;
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

impl<S: Scalar> ResolvedGain<S> {
    /// Number of rows.
    pub fn size(&self) -> usize {
        match self {
            ResolvedGain::Diagonal(k) => k.len(),
            ResolvedGain::Matrix { size, .. } => *size,
        }
    }

    /// out = gain · x. Entries beyond [`ResolvedGain::size`] are left alone.
    #[inline(always)]
    pub fn apply(&self, x: &[S], out: &mut [S]) {
        for out in out.iter_mut().take(self.size()) {
            *out = S::ZERO;
        }
        self.add_to(x, out);
    }

    /// out += gain · x. Entries beyond [`ResolvedGain::size`] are left alone.
    #[inline(always)]
    pub fn add_to(&self, x: &[S], out: &mut [S]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for ((out, k), x) in out.iter_mut().zip(k).zip(x) {
                    *out = k.mul_add(*x, *out);
                }
            }
            ResolvedGain::Matrix { size, entries } => {
                for (out, row) in out.iter_mut().zip(entries.chunks_exact((*size).max(1))) {
                    for (a, x) in row.iter().zip(x) {
                        *out = a.mul_add(*x, *out);
                    }
                }
            }
        }
    }

    /// out −= gain · x. Entries beyond [`ResolvedGain::size`] are left alone.
    #[inline(always)]
    pub fn subtract_from(&self, x: &[S], out: &mut [S]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for ((out, k), x) in out.iter_mut().zip(k).zip(x) {
                    *out = k.neg_mul_add(*x, *out);
                }
            }
            ResolvedGain::Matrix { size, entries } => {
                for (out, row) in out.iter_mut().zip(entries.chunks_exact((*size).max(1))) {
                    for (a, x) in row.iter().zip(x) {
                        *out = a.neg_mul_add(*x, *out);
                    }
                }
            }
        }
    }
}

impl<S: Packed> ResolvedGain<S> {
    /// The gains of several agents side by side: `gain(k)` is that of lane k. All must have the same size. A diagonal one
    /// beside a full matrix is written out in full; the products keep their bits.
    pub fn pack<'a>(gain: impl Fn(usize) -> &'a ResolvedGain) -> Self {
        let size = gain(0).size();
        let entry = |lane: usize, row: usize, column: usize| match gain(lane) {
            ResolvedGain::Diagonal(k) if row == column => k[row],
            ResolvedGain::Diagonal(_) => 0.0,
            ResolvedGain::Matrix { size, entries } => entries[row * size + column],
        };
        if (0..S::WIDTH).all(|lane| matches!(gain(lane), ResolvedGain::Diagonal(_))) {
            ResolvedGain::Diagonal((0..size).map(|k| S::from_lanes(|lane| entry(lane, k, k))).collect())
        } else {
            let entries = (0..size * size).map(|at| S::from_lanes(|lane| entry(lane, at / size, at % size))).collect();
            ResolvedGain::Matrix { size, entries }
        }
    }
}

impl ResolvedGain {
    /// Replaces x by gain⁻¹ · x. Entries beyond [`ResolvedGain::size`] are left alone. It factorises the gain anew, so it is for
    /// building and starting.
    pub fn solve(&self, x: &mut [f64]) {
        match self {
            ResolvedGain::Diagonal(k) => {
                for (x, k) in x.iter_mut().zip(k) {
                    *x /= k;
                }
            }
            ResolvedGain::Matrix { size, entries } => {
                let Ok(l) = cholesky(*size, entries) else { return };
                if x.len() < *size {
                    return;
                }
                for i in 0..*size {
                    for k in 0..i {
                        x[i] -= l[i * size + k] * x[k];
                    }
                    x[i] /= l[i * size + i];
                }
                for i in (0..*size).rev() {
                    for k in i + 1..*size {
                        x[i] -= l[k * size + i] * x[k];
                    }
                    x[i] /= l[i * size + i];
                }
            }
        }
    }
}

/// xᵀ · gain⁻¹ · x for one fixed gain, for Lyapunov-like functions: the factorisation is made once.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseQuadratic {
    /// Lower Cholesky factor, row by row; only its diagonal for a diagonal gain.
    factor: Vec<f64>,
    size: usize,
    diagonal: bool,
    work: Vec<f64>,
}

impl InverseQuadratic {
    /// Factorises `gain`.
    ///
    /// # Errors
    /// [`GainError::NearlySingular`] for a matrix that did not come from [`Gain::resolve`].
    pub fn new(gain: &ResolvedGain) -> Result<Self, GainError> {
        let size = gain.size();
        let (factor, diagonal) = match gain {
            ResolvedGain::Diagonal(k) => (k.clone(), true),
            ResolvedGain::Matrix { size, entries } => {
                let lost = |order| GainError::NearlySingular { order };
                (cholesky(*size, entries).map_err(lost)?, false)
            }
        };
        Ok(InverseQuadratic { factor, size, diagonal, work: vec![0.0; size] })
    }

    /// xᵀ · gain⁻¹ · x. Entries of `x` beyond the size of the gain do not count, missing ones count as zero.
    pub fn of(&mut self, x: &[f64]) -> f64 {
        let mut sum = 0.0;
        if self.diagonal {
            for (k, x) in self.factor.iter().zip(x) {
                sum += x * x / k;
            }
            return sum;
        }
        // gain = L Lᵀ, so the value is |L⁻¹ x|².
        for (i, row) in self.factor.chunks_exact(self.size.max(1)).enumerate() {
            let mut v = x.get(i).copied().unwrap_or(0.0);
            for (l, y) in row.iter().zip(&self.work[..i]) {
                v -= l * y;
            }
            let y = v / row[i];
            self.work[i] = y;
            sum += y * y;
        }
        sum
    }
}
