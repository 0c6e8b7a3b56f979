//! The adaptive tracking law (6)–(7), after Slotine and Li.
//!
//! ```text
//! s = q̇ − z                                   (5)
//! τ = −K s + Y(q, q̇, z, ż) ϑ̂                   (6)
//! ϑ̂' = −Γ Y(q, q̇, z, ż)ᵀ s                      (7)
//! ```
//!
//! With V = ½ sᵀ M s + ½ Δϑᵀ Γ⁻¹ Δϑ and viscous damping D in ϑ, V̇ = −sᵀ(K + D)s + sᵀτ_ext along every run.

use crate::robot::{Lagrangian, TwoVelocity};
use crate::{LengthError, ResolvedGain, Scalar};

/// The gains of (6)–(7).
///
/// **Source**: (5), (6), (7). **Measures**: q, q̇. **Transmits**: nothing.
/// **Requires**: K and Γ symmetric positive definite, guaranteed by [`ResolvedGain`].
/// **Guarantees**: s square-integrable and bounded, ϑ̂ bounded, for any bounded ż and any ϑ̂(0).
#[derive(Clone, Debug, PartialEq)]
pub struct SlotineLi<S = f64> {
    /// K, m × m.
    pub damping: ResolvedGain<S>,
    /// Γ, p × p; `None` when ϑ is known and nothing is adapted.
    pub adaptation: Option<ResolvedGain<S>>,
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

    /// ϑ̂' from Yᵀs. Zero when ϑ is known.
    #[inline(always)]
    pub fn adaptation_rate(&self, yt_s: &[S], d_theta_hat: &mut [S]) {
        match &self.adaptation {
            Some(gamma) => {
                d_theta_hat.fill(S::ZERO);
                gamma.subtract_from(yt_s, d_theta_hat);
            }
            None => d_theta_hat.fill(S::ZERO),
        }
    }
}
