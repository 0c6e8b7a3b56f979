//! A point mass in ℝᵐ: M = ϑ₁ I, no Coriolis terms, no gravity.

use alloc::vec;
use alloc::vec::Vec;

use super::enclosed::Enclosed;
use super::inertia_bound::{Definiteness, InertiaBound};
use super::{Lagrangian, TwoVelocity};
use crate::expression::Interval;
use crate::{LengthError, Scalar};

/// A point mass in ℝᵐ with ϑ = \[mass\] and Y = ż.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointMass {
    /// The dimension m of its space.
    pub dimension: usize,
}

impl PointMass {
    /// M = ϑ₁ 1 for all q; `None` for a mass that is not positive.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn inertia_bound(self, theta: &[f64]) -> Result<Option<InertiaBound>, LengthError> {
        LengthError::check("theta", 1, theta.len())?;
        Ok(InertiaBound::by_least(theta[0], self.dimension))
    }

    /// Whether M is positive definite.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn definiteness(self, theta: &[f64]) -> Result<Definiteness, LengthError> {
        let bound = self.inertia_bound(theta)?;
        Ok(Definiteness::of(bound, &Enclosed::diagonal(&vec![Interval::point(theta[0]); self.dimension])))
    }
}

impl<S: Scalar> Lagrangian<S> for PointMass {
    type Scratch = ();

    fn dof(&self) -> usize {
        self.dimension
    }

    fn parameter_count(&self) -> usize {
        1
    }

    fn scratch(&self) {}

    #[inline(always)]
    fn regressor_products(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        motion.check(self.dimension)?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("s", self.dimension, s.len())?;
        LengthError::check("y_theta", self.dimension, y_theta.len())?;
        LengthError::check("yt_s", 1, yt_s.len())?;
        let mut sum = S::ZERO;
        for ((y_theta, dz), s) in y_theta.iter_mut().zip(motion.dz).zip(s) {
            *y_theta = theta[0] * *dz;
            sum = dz.mul_add(*s, sum);
        }
        yt_s[0] = sum;
        Ok(())
    }

    #[inline(always)]
    fn forward_dynamics(
        &self,
        (): &mut (),
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        LengthError::check("q", self.dimension, q.len())?;
        LengthError::check("dq", self.dimension, dq.len())?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("tau", self.dimension, tau.len())?;
        LengthError::check("ddq", self.dimension, ddq.len())?;
        let inverse = S::splat(1.0) / theta[0];
        for (ddq, tau) in ddq.iter_mut().zip(tau) {
            *ddq = *tau * inverse;
        }
        Ok(())
    }

    #[inline(always)]
    fn mass_matrix(&self, (): &mut (), q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", self.dimension, q.len())?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("mass matrix", self.dimension * self.dimension, m.len())?;
        m.fill(S::ZERO);
        for diagonal in m.iter_mut().step_by(self.dimension + 1) {
            *diagonal = theta[0];
        }
        Ok(())
    }

    fn coriolis_matrix(&self, (): &mut (), q: &[S], dq: &[S], theta: &[S], c: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", self.dimension, q.len())?;
        LengthError::check("dq", self.dimension, dq.len())?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("Coriolis matrix", self.dimension * self.dimension, c.len())?;
        c.fill(S::ZERO);
        Ok(())
    }

    #[inline(always)]
    fn add_damping(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        motion.check(self.dimension)?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("damping torque", self.dimension, out.len())
    }

    fn gravity(&self, (): &mut (), q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", self.dimension, q.len())?;
        LengthError::check("theta", 1, theta.len())?;
        LengthError::check("gravity", self.dimension, g.len())?;
        g.fill(S::ZERO);
        Ok(())
    }

    fn regressor(&self, (): &mut (), motion: TwoVelocity<'_, S>, y: &mut [S]) -> Result<(), LengthError> {
        motion.check(self.dimension)?;
        LengthError::check("regressor", self.dimension, y.len())?;
        y.copy_from_slice(motion.dz);
        Ok(())
    }

    fn adaptation_scale(&self, _q: &[f64], theta: &[f64]) -> Vec<f64> {
        vec![theta.first().copied().unwrap_or(1.0)]
    }
}
