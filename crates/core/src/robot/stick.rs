//! Sets dry friction: values of σ ∈ Sgn q̇ that suit the end of a period.
//!
//! Over a period h with σ held the velocity goes from q̇ to about r = q̇ + h (q̈₀ − M⁻¹F σ), where q̈₀ is the acceleration without friction.
//! The value that suits the end of the period solves
//!
//! ```text
//! σ ∈ Sgn(r)        that is   −1 ≤ σ ≤ 1,   r_i = 0 where σ_i is inside, r_i ≥ 0 where it is 1, ≤ 0 where it is −1
//! ```
//!
//! which in the impulses h F σ is a box complementarity problem with the symmetric positive definite matrix M⁻¹: there is one solution, and
//! projected Gauss–Seidel comes closer to it with every sweep. A joint whose σ is inside sticks: it stands at the end of the period, however
//! it got there.

use alloc::vec;
use alloc::vec::Vec;

use super::Drives;
use crate::LengthError;
use crate::linear::invert;
use crate::reference::saturated;

/// Sweeps at one instant.
const MOST_SWEEPS: usize = 400;
/// Values that change by less are settled.
const SETTLED: f64 = 1e-13;

/// The dry friction of one robot.
#[derive(Clone, Debug)]
pub struct Stick {
    /// The joints that rub.
    joints: Vec<usize>,
    mass: Vec<f64>,
    /// M⁻¹.
    mobility: Vec<f64>,
    /// σ, joint by joint; zero where there is no friction.
    sigma: Vec<f64>,
    /// F σ.
    torque: Vec<f64>,
    free: Vec<f64>,
}

impl Stick {
    /// For a robot with so many axes. Nothing rubs yet: σ is zero.
    pub fn new(drives: &Drives, axes: usize) -> Self {
        let each = || vec![0.0; axes];
        Stick {
            joints: drives.friction.iter().map(|friction| friction.joint).collect(),
            mass: vec![0.0; axes * axes],
            mobility: vec![0.0; axes * axes],
            sigma: each(),
            torque: each(),
            free: each(),
        }
    }

    /// F σ as it is held, joint by joint, N m or N; it acts on the joints with the opposite sign.
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Sets σ for a period `h_s` from a state on with the inertia `mass` = M(q), armatures included, row by row, and with `forces` F, those
    /// of the joints that rub. `ddq` is q̈ there, under the friction that is held until now.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn set(&mut self, h_s: f64, mass: &[f64], forces: &[f64], [dq, ddq]: [&[f64]; 2]) -> Result<(), LengthError> {
        let n = self.sigma.len();
        LengthError::check("mass matrix", n * n, mass.len())?;
        LengthError::check("frictions", self.joints.len(), forces.len())?;
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("ddq", n, ddq.len())?;
        self.mass.copy_from_slice(mass);
        invert(n, &mut self.mass, &mut self.mobility);
        for i in 0..n {
            let row = &self.mobility[i * n..(i + 1) * n];
            let rubbed: f64 = row.iter().zip(&self.torque).map(|(entry, torque)| entry * torque).sum();
            self.free[i] = dq[i] + h_s * (ddq[i] + rubbed);
        }
        for _ in 0..MOST_SWEEPS {
            let mut change = 0.0_f64;
            for (joint, force) in self.joints.iter().zip(forces) {
                let (i, row) = (*joint, &self.mobility[joint * n..(joint + 1) * n]);
                let others: f64 = (0..n).filter(|k| *k != i).map(|k| row[k] * self.torque[k]).sum();
                let value = saturated(self.free[i] - h_s * others, h_s * row[i] * force);
                change = change.max((value - self.sigma[i]).abs());
                self.sigma[i] = value;
                self.torque[i] = force * value;
            }
            if change <= SETTLED || change.is_nan() {
                break;
            }
        }
        Ok(())
    }
}
