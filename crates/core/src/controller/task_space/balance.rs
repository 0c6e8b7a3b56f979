//! V of a tip, and what it loses: what the laws with and without a measured velocity of the tip have in common.

use super::TaskSpace;
use super::tip::TaskWork;
use crate::LengthError;
use crate::controller::Balance;
use crate::plant::TaskArm;
use crate::robot::{Called, Lagrangian, TipKinematics, TwoVelocity};

/// z; ϑ̂ and θ̂.
pub(super) type Carried<'a> = (&'a [f64], [&'a [f64]; 2]);

impl<R, T> TaskSpace<R, T>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    T: TipKinematics + Clone,
{
    /// V and what it loses, with Δx and ZᵀK*Δx in `work` and ż in the place of its ż_r.
    ///
    /// Beside ½ sᵀM s, U, and the squares of Δϑ and Δθ, V has κ/2 times the first of `own`, and loses κ α times the second beside
    /// sᵀ(K + D) s.
    pub(super) fn balanced(
        &self,
        work: &mut TaskWork<R::Scratch>,
        [state, external]: [&[f64]; 2],
        plant: &TaskArm<R, T>,
        (z, [estimate, theta_hat]): Carried<'_>,
        own: [f64; 2],
    ) -> Result<Balance, LengthError> {
        let m = self.tip.joints();
        LengthError::check("theta", self.robot.parameter_count(), plant.arm.theta.len())?;
        LengthError::check("kinematic parameters", self.tip.parameter_count(), plant.tip_theta.len())?;
        LengthError::check("state of the plant", 2 * m, state.len())?;
        let (q, dq) = state.split_at(m);
        for k in 0..m {
            work.s[k] = dq[k] - z[k];
        }

        // Y(q, 0, 0, ż) ϑ = M ż + g, and beside g stands what damping and friction take.
        let (inertia, lost) = {
            let TaskWork { robot, still, s, damped, yt_s, .. } = work;
            let (arm, theta) = (Called(&plant.arm.robot), &plant.arm.theta);
            let power = |torque: &[f64], s: &[f64]| -> f64 { s.iter().zip(torque).map(|(s, torque)| s * torque).sum() };
            arm.regressor_products(robot, TwoVelocity { q, dq: still, z: still, dz: s }, theta, s, damped, yt_s)?;
            let whole = power(damped, s);
            arm.regressor_products(robot, TwoVelocity { q, dq: still, z: still, dz: still }, theta, s, damped, yt_s)?;
            let gravity = power(damped, s);
            arm.add_damping(robot, TwoVelocity { q, dq, z, dz: still }, theta, damped)?;
            (whole - gravity, power(damped, s) - gravity)
        };
        self.law.damping.apply(&work.s, &mut work.damped);
        let mut dissipation = lost;
        for k in 0..m {
            dissipation += work.s[k] * work.damped[k];
            dissipation -= external.get(k).map_or(0.0, |external| work.s[k] * external);
        }
        let mut value = 0.5 * inertia + 0.5 * self.kappa * (own[0] + 2.0 * self.potential(work));
        dissipation += self.kappa * self.alpha * own[1];

        if let Some(bounds) = &self.law.bounds {
            let TaskWork { robot, dz_r, s, damped, yt_s, .. } = &mut *work;
            Called(&self.robot).regressor_products(
                robot,
                TwoVelocity { q, dq, z, dz: dz_r },
                estimate,
                s,
                damped,
                yt_s,
            )?;
            dissipation += bounds.gained(estimate, &plant.arm.theta, yt_s);
        }
        let TaskWork { difference, inverse_gamma, inverse_lambda, push, .. } = work;
        if let Some(inverse) = inverse_gamma {
            for (k, hat) in estimate.iter().enumerate() {
                difference[k] = hat - plant.arm.theta[k];
            }
            value += 0.5 * inverse.of(difference);
        }
        if let Some(inverse) = inverse_lambda {
            for (k, hat) in theta_hat.iter().enumerate() {
                difference[k] = hat - plant.tip_theta[k];
                if let Some(bounds) = self.enforced_bounds() {
                    dissipation += self.kappa * difference[k] * (push[k] - bounds.slowed(k, *hat, push[k]));
                }
            }
            value += 0.5 * self.kappa * inverse.of(difference);
        }
        Ok(Balance { value, dissipation })
    }
}
