//! From an external torque to s at rest: (M p + K + D + Y Γ Yᵀ/p)⁻¹, and the first term of its series at p = 0.

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{AgentSetup, DynamicsAt};
use nalgebra::{DMatrix, DVector};

use crate::finite::finite;
use crate::practical::rates::{Gains, dynamics};
use crate::prediction::roots::characteristic::C;

/// Of the largest eigenvalue of Y Γ Yᵀ: smaller ones are rounding.
const RANK: f64 = 1e-10;

/// rad/s or m/s: so slow that the friction tanh(q̇/ε) of any width is linear, and a power of two, so that D is exact.
const SLOW: f64 = 1.0 / (1_u64 << 40) as f64;

/// M, K + D and Y Γ Yᵀ of one agent.
#[derive(Debug)]
pub(super) struct Response {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    learning: DMatrix<f64>,
}

impl Response {
    /// At the position of its start with all velocities zero; `None` where the law is not (6)–(7) or a gain cannot be resolved.
    pub(super) fn at_rest(agent: &AgentSetup) -> Option<Response> {
        let gains = Gains::of(agent)?;
        let m = agent.robot.axes.len();
        let DynamicsAt { mass, regressor, .. } = dynamics(agent, &agent.start.q, &vec![0.0; m], &vec![0.0; m])?;
        let mass = DMatrix::from_row_slice(m, m, &mass);
        let learning = gains.adaptation.map_or_else(
            || DMatrix::zeros(m, m),
            |gamma| {
                let y = DMatrix::from_row_slice(m, gamma.nrows(), &regressor);
                &y * gamma * y.transpose()
            },
        );
        Some(Response { mass, damping: gains.damping + viscous(agent)?, learning: finite(learning)? })
    }

    /// [s₀, s₁] of s = s₀ + s₁ p + O(p²), for a torque on `axis` and s on the same; s₁ only where s₀ is zero, since it never counts
    /// otherwise.
    pub(super) fn series(&self, axis: usize) -> [f64; 2] {
        let m = self.mass.nrows();
        let eigen = self.learning.clone().symmetric_eigen();
        let floor = RANK * eigen.eigenvalues.amax();
        let (mut null, mut inverse) = (Vec::new(), DMatrix::zeros(m, m));
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value <= floor {
                null.push(vector.into_owned());
            } else {
                inverse += vector * vector.transpose() / *value;
            }
        }
        match self.on_kernel(&null, axis) {
            Some(rest) => [rest, 0.0],
            None => [0.0, inverse[(axis, axis)]],
        }
    }

    /// N (Nᵀ (K + D) N)⁻¹ Nᵀ on the axis; `None` where the kernel does not move it.
    fn on_kernel(&self, null: &[DVector<f64>], axis: usize) -> Option<f64> {
        let null = (!null.is_empty()).then(|| DMatrix::from_columns(null)).filter(|n| n.row(axis).norm() > RANK)?;
        let rest = &null * (null.transpose() * &self.damping * &null).try_inverse()? * null.transpose();
        Some(rest[(axis, axis)])
    }

    /// s on `axis` per torque on it at p ≠ 0.
    pub(super) fn at(&self, p: C, axis: usize) -> Option<C> {
        let m = self.mass.nrows();
        let impedance = DMatrix::from_fn(m, m, |i, j| {
            p * self.mass[(i, j)] + self.damping[(i, j)] + C::from(self.learning[(i, j)]) / p
        });
        Some(impedance.try_inverse()?[(axis, axis)])
    }
}

/// D and, where friction is smooth, F/ε: what is lost at rest per speed, column by column.
fn viscous(agent: &AgentSetup) -> Option<DMatrix<f64>> {
    let m = agent.robot.axes.len();
    let zero = vec![0.0; m];
    let mut evaluator = agent.robot.kind.lagrangian()?.evaluator();
    let mut damping = DMatrix::zeros(m, m);
    for axis in 0..m {
        let mut slow = zero.clone();
        slow[axis] = SLOW;
        let motion = TwoVelocity { q: &agent.start.q, dq: &slow, z: &zero, dz: &zero };
        let lost = &evaluator.at(&agent.robot.theta, motion, &slow).ok()?.damped;
        damping.set_column(axis, &(DVector::from_column_slice(lost) / SLOW));
    }
    Some(damping)
}
