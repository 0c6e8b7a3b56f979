//! The adaptive tracking law (6)–(7), after Slotine and Li.
//!
//! ```text
//! s = q̇ − z                                   (5)
//! τ = −K s + Y(q, q̇, z, ż) ϑ̂                   (6)
//! ϑ̂' = −Γ Y(q, q̇, z, ż)ᵀ s                      (7)
//! ```
//!
//! ϑ̂ may be kept within bounds ([`ParameterBounds`]). With V = ½ sᵀ M s + ½ Δϑᵀ Γ⁻¹ Δϑ and viscous damping D in ϑ, V̇ = −sᵀ(K + D)s + sᵀτ_ext along every run.

use super::ParameterBounds;
use crate::robot::{Lagrangian, TwoVelocity};
use crate::{LengthError, ResolvedGain, Scalar};

/// The gains of (6)–(7).
///
/// **Source**: (5), (6), (7). **Measures**: q, q̇. **Transmits**: nothing.
/// **Requires**: K and Γ symmetric positive definite, guaranteed by [`ResolvedGain`].
/// **Guarantees**: s square-integrable and bounded, ϑ̂ bounded, for any bounded ż and any ϑ̂(0).
///
/// Whatever ϑ̂ is, what it does to s and what (7) does to it cancel, and −sᵀK s is left:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::law::{SlotineLi, SlotineLiOutput};
/// use forwardstep_core::robot::{Lagrangian, PlanarArm, PlanarLinks, TwoVelocity};
///
/// let (k, gamma) = (8.0, 3.0);
/// let law = SlotineLi {
///     damping: Gain::Number(k).resolve(2, &[])?,
///     adaptation: Some(Gain::Number(gamma).resolve(5, &[])?),
///     bounds: None,
/// };
/// let theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta();
/// let theta_hat = [0.1, -0.4, 2.0, 1.0, 0.3];
/// let motion = TwoVelocity { q: &[0.3, -0.7], dq: &[0.5, 0.2], z: &[-0.1, 0.4], dz: &[1.0, -2.0] };
/// let (mut s, mut tau, mut yt_s) = ([0.0; 2], [0.0; 2], [0.0; 5]);
/// let out = SlotineLiOutput { s: &mut s, tau: &mut tau, yt_s: &mut yt_s };
/// law.output(&PlanarArm, &mut (), motion, &theta_hat, out)?;
/// let mut d_theta_hat = [0.0; 5];
/// law.adaptation_rate(&theta_hat, &yt_s, &mut d_theta_hat);
///
/// let mut y_theta = [0.0; 2];
/// PlanarArm.regressor_products(&mut (), motion, &theta, &s, &mut y_theta, &mut [0.0; 5])?;
/// let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
/// let error: [f64; 5] = std::array::from_fn(|j| theta_hat[j] - theta[j]);
/// let by_torque = dot(&s, &tau) - dot(&s, &y_theta);
/// assert!((by_torque + dot(&error, &d_theta_hat) / gamma + k * dot(&s, &s)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlotineLi<S = f64> {
    /// K, m × m.
    pub damping: ResolvedGain<S>,
    /// Γ, p × p; `None` when ϑ is known and nothing is adapted.
    pub adaptation: Option<ResolvedGain<S>>,
    /// Bounds for ϑ̂. That V falls no slower with them needs a diagonal Γ.
    pub bounds: Option<ParameterBounds<S>>,
}

/// Where [`SlotineLi::output`] puts its results.
#[derive(Debug)]
pub struct SlotineLiOutput<'a, S> {
    /// s, m entries.
    pub s: &'a mut [S],
    /// τ, m entries.
    pub tau: &'a mut [S],
    /// Yᵀs, p entries.
    pub yt_s: &'a mut [S],
}

impl<S: Scalar> SlotineLi<S> {
    /// s, τ and Yᵀs; needs ż, hence comes after the reference dynamics' output and before their rate.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    #[inline(always)]
    pub fn output<R: Lagrangian<S>>(
        &self,
        robot: &R,
        scratch: &mut R::Scratch,
        motion: TwoVelocity<'_, S>,
        theta_hat: &[S],
        out: SlotineLiOutput<'_, S>,
    ) -> Result<(), LengthError> {
        let m = self.damping.size();
        motion.check(m)?;
        LengthError::check("s", m, out.s.len())?;
        LengthError::check("tau", m, out.tau.len())?;
        for k in 0..m {
            out.s[k] = motion.dq[k] - motion.z[k];
        }
        robot.regressor_products(scratch, motion, theta_hat, out.s, out.tau, out.yt_s)?;
        self.damping.subtract_from(out.s, out.tau);
        Ok(())
    }

    /// ϑ̂' from Yᵀs and ϑ̂. Zero when ϑ is known.
    #[inline(always)]
    pub fn adaptation_rate(&self, theta_hat: &[S], yt_s: &[S], d_theta_hat: &mut [S]) {
        self.free_rate(yt_s, d_theta_hat);
        if let Some(bounds) = &self.bounds {
            bounds.slow(theta_hat, d_theta_hat);
        }
    }

    /// −Γ Yᵀs, whatever the bounds.
    #[inline(always)]
    pub fn free_rate(&self, yt_s: &[S], d_theta_hat: &mut [S]) {
        d_theta_hat.fill(S::ZERO);
        if let Some(gamma) = &self.adaptation {
            gamma.subtract_from(yt_s, d_theta_hat);
        }
    }
}
