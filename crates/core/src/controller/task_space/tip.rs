//! What (76)–(82) make of a measured tip: Δx, Ĵ and its rate, z_r and ż_r, and θ̂' with its projection.

use alloc::vec;
use alloc::vec::Vec;

use super::null_space::Free;
use super::{TaskMeasured, TaskSpace};
use crate::attitude::{IDENTITY, Quaternion};
use crate::controller::{Jets, Singularity};
use crate::law::ParameterBounds;
use crate::linear::{invert, singular_values};
use crate::robot::{Lagrangian, Posture, TipKinematics};
use crate::signal::Signal;
use crate::{InverseQuadratic, LengthError, ResolvedGain};

/// Working memory of [`TaskSpace`].
#[derive(Clone, Debug)]
pub struct TaskWork<S> {
    pub(super) robot: S,
    pub(super) j: Vec<f64>,
    pub(super) dj: Vec<f64>,
    pub(super) factored: Vec<f64>,
    pub(super) inverse: Vec<f64>,
    pub(super) z_r: Vec<f64>,
    pub(super) dz_r: Vec<f64>,
    /// Δx, or Δp and Δq_v; K*Δx, or e; Ĵᵀ times that.
    pub(super) error: Vec<f64>,
    pub(super) weighted: Vec<f64>,
    pub(super) pulled: Vec<f64>,
    /// ZᵀK*Δx and θ̂'.
    pub(super) push: Vec<f64>,
    pub(super) d_theta_hat: Vec<f64>,
    pub(super) s: Vec<f64>,
    pub(super) damped: Vec<f64>,
    pub(super) still: Vec<f64>,
    pub(super) yt_s: Vec<f64>,
    pub(super) difference: Vec<f64>,
    /// ẋ_d and ẍ_d, or ṗ_d and ω_d, p̈_d and ω̇_d.
    pub(super) d_target: Vec<f64>,
    pub(super) dd_target: Vec<f64>,
    /// Δq_o and the quaternion of the tip, of a pose.
    pub(super) error_scalar: f64,
    pub(super) attitude: Quaternion,
    /// The largest singular value, where the smallest is shown.
    pub(super) largest: f64,
    pub(super) free: Free,
    pub(super) inverse_gamma: Option<InverseQuadratic>,
    pub(super) inverse_lambda: Option<InverseQuadratic>,
}

/// Where the blocks of the state begin, after z: ϑ̂, θ̂, det Ĵ(0), the sign of Δq, and the end; and how much is shown.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) theta: usize,
    pub(super) kinematic: usize,
    pub(super) determinant: usize,
    pub(super) sign: usize,
    pub(super) end: usize,
    pub(super) shown: usize,
}

impl<R, T> TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    pub(super) fn layout(&self) -> Layout {
        let theta = self.tip.joints();
        let kinematic = theta + self.robot.parameter_count();
        let determinant = kinematic + self.tip.parameter_count();
        let sign = determinant + 1;
        let of_attitude = if self.tip.turns() { 6 } else { 0 };
        let shown = sign + 2 * theta + self.tip.axes() + self.tip.rows() + of_attitude;
        Layout { theta, kinematic, determinant, sign, end: sign + usize::from(self.tip.turns()), shown }
    }

    /// What says how far Ĵ is from singular.
    pub(super) fn regularity(&self) -> Signal {
        if self.tip.turns() || self.is_redundant() { Signal::SingularValue } else { Signal::Determinant }
    }

    /// What is wrong where Ĵ comes too close to singular, by what says so at the start and now.
    pub(super) fn vanishing(&self, start: f64, value: f64) -> Option<Singularity> {
        // A change of sign is below the floor too, and a start at zero is there at once.
        let floor = self.determinant_floor * start;
        let vanishes = if start < 0.0 { value >= floor } else { value <= floor };
        vanishes.then_some(Singularity::Vanishes { signal: self.regularity(), axis: 0, value, floor })
    }

    pub(super) fn is_redundant(&self) -> bool {
        self.tip.joints() > self.tip.rows()
    }

    /// Working memory of the right size.
    pub(super) fn work(&self) -> TaskWork<R::Scratch> {
        let (n, m, p) = (self.tip.joints(), self.tip.rows(), self.tip.parameter_count());
        let inverse = |gain: &Option<ResolvedGain>| gain.as_ref().and_then(|gain| InverseQuadratic::new(gain).ok());
        TaskWork {
            robot: self.robot.scratch(),
            j: vec![0.0; m * n],
            dj: vec![0.0; m * n],
            factored: vec![0.0; m * n],
            inverse: vec![0.0; m * m],
            z_r: vec![0.0; n],
            dz_r: vec![0.0; n],
            error: vec![0.0; m],
            weighted: vec![0.0; m],
            pulled: vec![0.0; n],
            push: vec![0.0; p],
            d_theta_hat: vec![0.0; p],
            s: vec![0.0; n],
            damped: vec![0.0; n],
            still: vec![0.0; n],
            yt_s: vec![0.0; self.robot.parameter_count()],
            difference: vec![0.0; p.max(self.robot.parameter_count())],
            d_target: vec![0.0; m],
            dd_target: vec![0.0; m],
            error_scalar: 1.0,
            attitude: IDENTITY,
            largest: 0.0,
            free: Free::new(n, m),
            inverse_gamma: inverse(&self.law.adaptation),
            inverse_lambda: inverse(&self.kinematic_adaptation),
        }
    }

    /// Δx and what follows from it, Ĵ and its rate, z_r and ż_r, into the working memory; returns det Ĵ, or the smallest singular
    /// value.
    pub(super) fn task(
        &self,
        work: &mut TaskWork<R::Scratch>,
        measured: TaskMeasured<'_>,
        target: Jets<'_>,
        state: &[f64],
    ) -> Result<f64, LengthError> {
        let l = self.layout();
        LengthError::check("state", l.end, state.len())?;
        self.check()?;
        LengthError::check("x", self.tip.axes(), measured.x.len())?;
        self.errors(work, measured, target, state.get(l.sign).copied())?;
        self.led(work, measured, &state[l.kinematic..l.determinant])
    }

    /// The same behind the errors and the two rates of what leads the tip.
    pub(super) fn led(
        &self,
        work: &mut TaskWork<R::Scratch>,
        measured: TaskMeasured<'_>,
        theta_hat: &[f64],
    ) -> Result<f64, LengthError> {
        let (n, m) = (self.tip.joints(), self.tip.rows());
        let TaskMeasured { q, dq, .. } = measured;
        self.tip.regressor_transposed(q, dq, &work.weighted, &mut work.push)?;
        work.d_theta_hat.fill(0.0);
        if let Some(lambda) = &self.kinematic_adaptation {
            lambda.add_to(&work.push, &mut work.d_theta_hat);
            if let Some(bounds) = self.enforced_bounds() {
                bounds.slow(theta_hat, &mut work.d_theta_hat);
            }
        }
        let posture = Posture { q, dq, theta: theta_hat, d_theta: &work.d_theta_hat };
        self.tip.jacobian(posture, &mut work.j, &mut work.dj)?;
        for i in 0..n {
            work.pulled[i] = 0.0;
            for k in 0..m {
                work.pulled[i] += work.j[k * n + i] * work.weighted[k];
            }
        }
        let determinant = if self.is_redundant() { self.spread(work, measured) } else { self.inverted(work) };
        if self.regularity() == Signal::Determinant {
            return Ok(determinant);
        }
        work.factored.copy_from_slice(&work.j);
        let [smallest, largest] = singular_values(m, n, &mut work.factored);
        work.largest = largest;
        Ok(smallest)
    }

    /// z_r and ż_r of (77) and (78) with a square Ĵ, of which it returns the determinant.
    fn inverted(&self, work: &mut TaskWork<R::Scratch>) -> f64 {
        let m = self.tip.rows();
        work.factored.copy_from_slice(&work.j);
        let determinant = invert(m, &mut work.factored, &mut work.inverse);
        for i in 0..m {
            work.z_r[i] = 0.0;
            for k in 0..m {
                work.z_r[i] += work.inverse[i * m + k] * work.d_target[k];
            }
        }
        work.dz_r.fill(0.0);
        for k in 0..m {
            let mut rest = work.dd_target[k];
            for i in 0..m {
                rest -= work.dj[k * m + i] * work.z_r[i];
            }
            for i in 0..m {
                work.dz_r[i] += work.inverse[i * m + k] * rest;
            }
        }
        determinant
    }

    /// The bounds, where Λ is diagonal.
    pub(super) fn enforced_bounds(&self) -> Option<&ParameterBounds> {
        let diagonal = matches!(self.kinematic_adaptation, Some(ResolvedGain::Diagonal(_)));
        self.bounds.as_ref().filter(|_| diagonal)
    }

    pub(super) fn check(&self) -> Result<(), LengthError> {
        let (n, p) = (self.tip.joints(), self.tip.parameter_count());
        LengthError::check("axes of the robot", n, self.robot.dof())?;
        LengthError::check("task gain", self.tip.axes(), self.task_gain.size())?;
        LengthError::check("damping gain", n, self.law.damping.size())?;
        if let Some(null_space) = &self.null_space {
            LengthError::check("posture of the null-space term", n, null_space.posture.len())?;
        }
        LengthError::check("start of the estimate", self.robot.parameter_count(), self.estimate_start.len())?;
        LengthError::check("start of the kinematic estimate", p, self.kinematic_start.len())?;
        if let Some(gamma) = &self.law.adaptation {
            LengthError::check("adaptation gain", self.robot.parameter_count(), gamma.size())?;
        }
        if let Some(lambda) = &self.kinematic_adaptation {
            LengthError::check("kinematic adaptation gain", p, lambda.size())?;
        }
        if let Some(bounds) = &self.bounds {
            bounds.check(p)?;
        }
        Ok(())
    }
}
