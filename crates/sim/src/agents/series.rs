//! A robot's dynamics in truncated Taylor series: the same kernels, with derivatives of what they compute.

use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_core::{LengthError, Taylor};

/// A value with its first seven derivatives: as many as the torque of reference dynamics of order eight has before one of them jumps.
pub type Series = Taylor<8>;

/// A robot's dynamics in series, with working memory of their own.
pub trait SeriesEvaluator {
    /// `y_theta` = Y(q, q̇, z, ż) ϑ and `yt_s` = Y(q, q̇, z, ż)ᵀ s, as [`Lagrangian::regressor_products`] has them.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn products(
        &mut self,
        theta: &[Series],
        motion: TwoVelocity<'_, Series>,
        s: &[Series],
        y_theta: &mut [Series],
        yt_s: &mut [Series],
    ) -> Result<(), LengthError>;

    /// `ddq` in the state [q, q̇] under the torque `tau`, as [`Lagrangian::forward_dynamics`] has it.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn acceleration(
        &mut self,
        theta: &[Series],
        q_dq: [&[Series]; 2],
        tau: &[Series],
        ddq: &mut [Series],
    ) -> Result<(), LengthError>;
}

/// The kernel of a robot model.
pub(super) struct OfKernel<K: Lagrangian<Series>> {
    kernel: K,
    scratch: K::Scratch,
}

impl<K: Lagrangian<Series>> OfKernel<K> {
    pub(super) fn new(kernel: K) -> Self {
        OfKernel { scratch: kernel.scratch(), kernel }
    }
}

impl<K: Lagrangian<Series>> SeriesEvaluator for OfKernel<K> {
    fn products(
        &mut self,
        theta: &[Series],
        motion: TwoVelocity<'_, Series>,
        s: &[Series],
        y_theta: &mut [Series],
        yt_s: &mut [Series],
    ) -> Result<(), LengthError> {
        self.kernel.regressor_products(&mut self.scratch, motion, theta, s, y_theta, yt_s)
    }

    fn acceleration(
        &mut self,
        theta: &[Series],
        [q, dq]: [&[Series]; 2],
        tau: &[Series],
        ddq: &mut [Series],
    ) -> Result<(), LengthError> {
        self.kernel.forward_dynamics(&mut self.scratch, q, dq, theta, tau, ddq)
    }
}
