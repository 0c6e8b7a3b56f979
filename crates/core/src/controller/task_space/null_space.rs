//! Redundant joints in Theorem 6: n joints and m < n coordinates of a position. Not from the paper, whose J is square.
//!
//! The proof takes of z_r only that Ĵ z_r = ẋ_d, that ż_r is its derivative and holds no task-space velocity, and that both are
//! bounded. With a velocity φ(q) that the joints would like to have, and A = Ĵ Ĵᵀ,
//!
//! ```text
//! z_r = φ + Ĵᵀλ,   λ = A⁻¹(ẋ_d − Ĵφ)          that is   Ĵ⁺ẋ_d + (I − Ĵ⁺Ĵ) φ,   Ĵ⁺ = ĴᵀA⁻¹
//! ż_r = φ̇ + (dĴ/dt)ᵀλ + Ĵᵀλ̇,   λ̇ = A⁻¹[ẍ_d − (dĴ/dt) φ − Ĵ φ̇ − (dĴ/dt) Ĵᵀλ − Ĵ (dĴ/dt)ᵀλ]
//! ```
//!
//! so Ĵ z_r = ẋ_d, and V and V̇ are those of Theorem 6. Ĵᵀe → 0 gives e → 0 where Ĵ has full rank, watched by its smallest singular
//! value. The term is
//!
//! ```text
//! φ_k = −k_n r_k / √(1 + r_k²),   r_k = q_k − q_n,k        φ̇_k = −k_n q̇_k / (1 + r_k²)^(3/2)
//! ```
//!
//! with a rate k_n and a posture q_n: it leads down W = Σ √(1 + r_k²) (r in rad or m) as far as the tip leaves freedom, and is bounded by k_n
//! per joint wherever q is, so that z_r is bounded as in the proof. Without a term φ = 0.
//!
//! What it promises: q̇ − z_r → 0, no more. Where the tip rests, Ẇ = −φᵀ(I − Ĵ⁺Ĵ)φ/k_n up to that remainder, so the posture comes as near to
//! q_n as a descent along the self-motion gets.

use alloc::vec;
use alloc::vec::Vec;

use super::tip::TaskWork;
use super::{TaskMeasured, TaskSpace};
use crate::linear::invert;
use crate::robot::{Lagrangian, TipKinematics};

/// The posture that redundant joints keep to where the tip leaves them free.
#[derive(Clone, Debug, PartialEq)]
pub struct NullSpace {
    /// k_n, 1/s.
    pub rate_per_s: f64,
    /// q_n, an entry per joint.
    pub posture: Vec<f64>,
}

/// Working memory of redundant joints.
#[derive(Clone, Debug)]
pub(super) struct Free {
    /// φ and φ̇.
    phi: Vec<f64>,
    d_phi: Vec<f64>,
    /// A, λ, λ̇, (dĴ/dt)ᵀλ, and what A⁻¹ is applied to.
    a: Vec<f64>,
    lambda: Vec<f64>,
    d_lambda: Vec<f64>,
    swung: Vec<f64>,
    rest: Vec<f64>,
}

impl Free {
    pub(super) fn new(n: usize, m: usize) -> Self {
        let [joints, rows] = if n > m { [n, m] } else { [0, 0] };
        let of = |entries: usize| vec![0.0; entries];
        Free {
            phi: of(joints),
            d_phi: of(joints),
            a: of(rows * rows),
            lambda: of(rows),
            d_lambda: of(rows),
            swung: of(joints),
            rest: of(rows),
        }
    }
}

/// A matrix by rows times a vector.
fn times(a: &[f64], v: &[f64], product: &mut [f64]) {
    for (row, entry) in a.chunks_exact(v.len().max(1)).zip(product) {
        *entry = row.iter().zip(v).map(|(a, v)| a * v).sum();
    }
}

/// A transposed matrix by rows times a vector, added.
fn add_transposed(a: &[f64], v: &[f64], sum: &mut [f64]) {
    for (row, v) in a.chunks_exact(sum.len().max(1)).zip(v) {
        for (sum, a) in sum.iter_mut().zip(row) {
            *sum += a * v;
        }
    }
}

impl<R, T> TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    /// z_r and ż_r of more joints than coordinates; returns det A.
    pub(super) fn spread(&self, work: &mut TaskWork<R::Scratch>, measured: TaskMeasured<'_>) -> f64 {
        let (n, m) = (self.tip.joints(), self.tip.rows());
        let TaskWork { j, dj, inverse, z_r, dz_r, d_target, dd_target, free, .. } = work;
        let Free { phi, d_phi, a, lambda, d_lambda, swung, rest } = free;
        self.wished(measured, phi, d_phi);
        for i in 0..m {
            for k in 0..m {
                let rows = j[i * n..(i + 1) * n].iter().zip(&j[k * n..(k + 1) * n]);
                a[i * m + k] = rows.map(|(x, y)| x * y).sum();
            }
        }
        let determinant = invert(m, a, inverse);

        times(j, phi, rest);
        rest.iter_mut().zip(d_target).for_each(|(rest, target)| *rest = *target - *rest);
        times(inverse, rest, lambda);
        z_r.copy_from_slice(phi);
        add_transposed(j, lambda, z_r);

        // (dĴ/dt) φ + (dĴ/dt) Ĵᵀλ is (dĴ/dt) z_r.
        swung.fill(0.0);
        add_transposed(dj, lambda, swung);
        dz_r.iter_mut().zip(d_phi).zip(swung).for_each(|((sum, phi), swung)| *sum = *phi + *swung);
        times(j, dz_r, rest);
        times(dj, z_r, d_lambda);
        rest.iter_mut().zip(dd_target).zip(d_lambda.iter()).for_each(|((rest, target), swung)| {
            *rest = *target - *swung - *rest;
        });
        times(inverse, rest, d_lambda);
        add_transposed(j, d_lambda, dz_r);
        determinant
    }

    /// φ and φ̇.
    fn wished(&self, measured: TaskMeasured<'_>, phi: &mut [f64], d_phi: &mut [f64]) {
        phi.fill(0.0);
        d_phi.fill(0.0);
        let Some(NullSpace { rate_per_s, posture }) = &self.null_space else { return };
        for (k, rest) in posture.iter().enumerate() {
            let apart = measured.q[k] - rest;
            let root = libm::sqrt(1.0 + apart * apart);
            phi[k] = -rate_per_s * apart / root;
            d_phi[k] = -rate_per_s * measured.dq[k] / (root * root * root);
        }
    }
}
