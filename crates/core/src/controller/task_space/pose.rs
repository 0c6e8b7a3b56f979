//! Poses in Theorem 6: position and orientation of an end-effector. Not from the paper, whose Δx is a vector.
//!
//! R is the orientation of the end-effector, R_d the desired one, ω and ω_d their angular velocities, all in coordinates of the
//! base, and Δq = (Δq_v, Δq_o) a quaternion of R_e = R R_dᵀ, the product of that of R and that of R_dᵀ. From Ṙ = S(ω) R
//!
//! ```text
//! Ṙ_e = S(ω) R_e − R_e S(ω_d) = S(ω − R_e ω_d) R_e        Δq̇_o = −½ Δq_vᵀ(ω − R_e ω_d)
//! ```
//!
//! and Δq_v is the axis of R_e, R_eᵀΔq_v = Δq_v, so the turned ω_d can be replaced by ω_d itself:
//!
//! ```text
//! d/dt 2 (1 − Δq_o) = Δq_vᵀ(ω − ω_d)
//! ```
//!
//! So with J q̇ = (ṗ, ω), ẋ_d = (ṗ_d, ω_d), ẍ_d = (p̈_d, ω̇_d), K_p symmetric positive definite and a number k_o > 0,
//!
//! ```text
//! U = ½ ΔpᵀK_pΔp + 2 k_o (1 − Δq_o)        e = (K_p Δp, k_o Δq_v)        U̇ = eᵀ(J q̇ − ẋ_d)
//! ```
//!
//! In (76)–(82) e takes the place of K*Δx, and nothing else changes. With Ĵ q̇ − J q̇ = Z Δθ and Ĵ z_r = ẋ_d,
//!
//! ```text
//! d/dt (z − z_r) = −α (z − z_r) − Ĵᵀe              U̇ = eᵀ[Ĵ (z − z_r) + Ĵ s − Z Δθ]
//! M ṡ + C s = −(K + D) s − κ Ĵᵀe + Y Δϑ            ϑ̂' = −Γ Yᵀs,   θ̂' = Λ Zᵀe
//! ```
//!
//! V = κ [½ |z − z_r|² + U + ½ ΔθᵀΛ⁻¹Δθ] + ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ loses sᵀ(K + D) s + κ α |z − z_r|²: what e does to z − z_r, to s
//! and to θ̂ cancels as in the paper. Hence, as there, Ĵᵀe → 0, and e → 0 where Ĵ stays regular: Δp → 0 and Δq_v → 0, ω − ω_d → 0.
//!
//! **k_o is a number.** With a symmetric matrix K_o in its place there would have to be a function of Δq whose rate is
//! Δq_vᵀK_oω for every ω, with Δq̇_v = ½ (Δq_o ω − Δq_v × ω). Let X_i be the motion with ω along axis i. Mixed derivatives ask for
//!
//! ```text
//! X_i(K_oΔq_v)_j − X_j(K_oΔq_v)_i + ε_ijk (K_oΔq_v)_k = −½ ε_ijk [(tr K_o I − 3 K_o) Δq_v]_k = 0
//! ```
//!
//! for every Δq_v, which is K_o = k_o I. (And ω_d would not come out of its turn: only along Δq_v is R_eω_d like ω_d.)
//!
//! **The two signs.** q and −q are one attitude, U is not one function of attitudes: it is one of Δq. So Δq has to be continuous.
//! That of the end-effector is a product of half turns of its joints (`robot/tree/turned.rs`), continuous in q; that of the
//! target is its own path. At the start the sign is chosen so that Δq_o(0) ≥ 0, and kept. Δq_v = 0 is the attitude reached for
//! Δq_o = 1 and for Δq_o = −1; the latter is a saddle of U, where a run ends only if it is put there. Δq_o(0) = 0 is half a turn: both
//! ways are equally long, and there is no continuous law on attitudes that chooses.
//!
//! **Lengths** enter the rows of ṗ alone: those of ω hold the directions of the joints. So Zᵀe = Z_pᵀK_pΔp, and the orientation of
//! the end-effector is known from q; only its position is measured.

use super::tip::TaskWork;
use super::{TaskMeasured, TaskSpace};
use crate::LengthError;
use crate::attitude::{Desired, angle, product};
use crate::controller::{Jet, Jets};
use crate::robot::{Lagrangian, TipKinematics};

impl<R, T> TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    /// Entries of the target.
    pub(super) fn followed(&self) -> usize {
        self.tip.axes() + if self.tip.turns() { 4 } else { 0 }
    }

    /// The errors, e, and the first two rates of the target, into the working memory.
    pub(super) fn errors(
        &self,
        work: &mut TaskWork<R::Scratch>,
        measured: TaskMeasured<'_>,
        target: Jets<'_>,
        sign: Option<f64>,
    ) -> Result<(), LengthError> {
        let axes = self.tip.axes();
        LengthError::check("target", self.followed(), target.len())?;
        for (k, jet) in target.iter().enumerate().take(axes) {
            work.error[k] = measured.x[k] - jet[0];
            (work.d_target[k], work.dd_target[k]) = (jet[1], jet[2]);
        }
        self.task_gain.apply(&work.error[..axes], &mut work.weighted[..axes]);
        if let (Some(attitude), Some(sign)) = (self.tip.attitude(measured.q), sign) {
            let path: [Jet; 4] = core::array::from_fn(|k| target.jet(axes + k));
            let Desired { q: [x, y, z, o], omega, d_omega } = Desired::from_path(&path);
            let error = product(attitude, [-x, -y, -z, o]).map(|entry| sign * entry);
            for k in 0..3 {
                work.error[axes + k] = error[k];
                work.weighted[axes + k] = self.attitude_gain * error[k];
                work.d_target[axes + k] = omega[k];
                work.dd_target[axes + k] = d_omega[k];
            }
            work.error_scalar = error[3];
            work.attitude = attitude;
        }
        Ok(())
    }

    /// U.
    pub(super) fn potential(&self, work: &TaskWork<R::Scratch>) -> f64 {
        let axes = self.tip.axes();
        let mut twice = 0.0;
        for k in 0..axes {
            twice += work.error[k] * work.weighted[k];
        }
        if self.tip.turns() {
            // 4 (1 − Δq_o) = 2 |Δq − (0, 1)|², without its cancellation.
            let apart = 1.0 - work.error_scalar;
            let turned: f64 = work.error[axes..].iter().map(|entry| entry * entry).sum();
            twice += 2.0 * self.attitude_gain * (turned + apart * apart);
        }
        0.5 * twice
    }
}

impl<S> TaskWork<S> {
    /// Δq_o, the angle and the quaternion of the tip, where there is place for them.
    pub(super) fn show_attitude(&self, shown: &mut [f64]) {
        if let ([scalar, turned, attitude @ ..], [.., x, y, z]) = (shown, &self.error[..]) {
            *scalar = self.error_scalar;
            *turned = angle([*x, *y, *z, self.error_scalar]);
            attitude.copy_from_slice(&self.attitude);
        }
    }
}
