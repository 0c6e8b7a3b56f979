//! What (76)–(82) make of a measured tip: Δx, Ĵ and its rate, z_r and ż_r, and θ̂' with its projection.

use alloc::vec;
use alloc::vec::Vec;

use super::{TaskMeasured, TaskSpace};
use crate::controller::Jet;
use crate::law::ParameterBounds;
use crate::linear::invert;
use crate::robot::{Lagrangian, Posture, TipKinematics};
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
    /// Δx, K*Δx, ĴᵀK*Δx.
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
    pub(super) inverse_gamma: Option<InverseQuadratic>,
    pub(super) inverse_lambda: Option<InverseQuadratic>,
}

/// Where the blocks of the state begin, after z: ϑ̂, θ̂, det Ĵ(0), and the end.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) theta: usize,
    pub(super) kinematic: usize,
    pub(super) determinant: usize,
    pub(super) end: usize,
}

impl<R, T> TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    pub(super) fn layout(&self) -> Layout {
        let theta = self.tip.axes();
        let kinematic = theta + self.robot.parameter_count();
        let determinant = kinematic + self.tip.parameter_count();
        Layout { theta, kinematic, determinant, end: determinant + 1 }
    }

    /// Working memory of the right size.
    pub(super) fn work(&self) -> TaskWork<R::Scratch> {
        let (m, p) = (self.tip.axes(), self.tip.parameter_count());
        let inverse = |gain: &Option<ResolvedGain>| gain.as_ref().and_then(|gain| InverseQuadratic::new(gain).ok());
        TaskWork {
            robot: self.robot.scratch(),
            j: vec![0.0; m * m],
            dj: vec![0.0; m * m],
            factored: vec![0.0; m * m],
            inverse: vec![0.0; m * m],
            z_r: vec![0.0; m],
            dz_r: vec![0.0; m],
            error: vec![0.0; m],
            weighted: vec![0.0; m],
            pulled: vec![0.0; m],
            push: vec![0.0; p],
            d_theta_hat: vec![0.0; p],
            s: vec![0.0; m],
            damped: vec![0.0; m],
            still: vec![0.0; m],
            yt_s: vec![0.0; self.robot.parameter_count()],
            difference: vec![0.0; p.max(self.robot.parameter_count())],
            inverse_gamma: inverse(&self.law.adaptation),
            inverse_lambda: inverse(&self.kinematic_adaptation),
        }
    }

    /// Δx and what follows from it, Ĵ and its rate, z_r and ż_r, into the working memory; returns det Ĵ.
    pub(super) fn task(
        &self,
        work: &mut TaskWork<R::Scratch>,
        measured: TaskMeasured<'_>,
        target: &[Jet],
        theta_hat: &[f64],
    ) -> Result<f64, LengthError> {
        let m = self.tip.axes();
        let TaskMeasured { q, dq, x } = measured;
        self.check()?;
        LengthError::check("x", m, x.len())?;
        LengthError::check("target", m, target.len())?;
        LengthError::check("kinematic parameters", work.push.len(), theta_hat.len())?;
        for k in 0..m {
            work.error[k] = x[k] - target[k][0];
        }
        self.task_gain.apply(&work.error, &mut work.weighted);
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
        work.factored.copy_from_slice(&work.j);
        let determinant = invert(m, &mut work.factored, &mut work.inverse);
        for i in 0..m {
            work.z_r[i] = 0.0;
            work.pulled[i] = 0.0;
            for k in 0..m {
                work.z_r[i] += work.inverse[i * m + k] * target[k][1];
                work.pulled[i] += work.j[k * m + i] * work.weighted[k];
            }
        }
        work.dz_r.fill(0.0);
        for k in 0..m {
            let mut rest = target[k][2];
            for i in 0..m {
                rest -= work.dj[k * m + i] * work.z_r[i];
            }
            for i in 0..m {
                work.dz_r[i] += work.inverse[i * m + k] * rest;
            }
        }
        Ok(determinant)
    }

    /// The bounds, where Λ is diagonal.
    pub(super) fn enforced_bounds(&self) -> Option<&ParameterBounds> {
        let diagonal = matches!(self.kinematic_adaptation, Some(ResolvedGain::Diagonal(_)));
        self.bounds.as_ref().filter(|_| diagonal)
    }

    pub(super) fn check(&self) -> Result<(), LengthError> {
        let (m, p) = (self.tip.axes(), self.tip.parameter_count());
        LengthError::check("axes of the robot", m, self.robot.dof())?;
        LengthError::check("task gain", m, self.task_gain.size())?;
        LengthError::check("damping gain", m, self.law.damping.size())?;
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
