//! Who sets dry friction: values of σ ∈ Sgn q̇ that suit the end of a period.
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

use super::drives::Friction;
use super::model::{Tree, TreeScratch};
use crate::LengthError;
use crate::linear::invert;
use crate::reference::saturated;
use crate::robot::Lagrangian;

/// Sweeps at one instant.
const MOST_SWEEPS: usize = 400;
/// Values that change by less are settled.
const SETTLED: f64 = 1e-13;

/// The dry friction of one tree.
#[derive(Clone, Debug)]
pub struct Stick {
    scratch: TreeScratch<f64>,
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
    /// Nothing rubs yet: σ is zero.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.joint_count();
        let joints = || vec![0.0; n];
        Stick {
            scratch: tree.scratch(),
            mass: vec![0.0; n * n],
            mobility: vec![0.0; n * n],
            sigma: joints(),
            torque: joints(),
            free: joints(),
        }
    }

    /// F σ as it is held, joint by joint, N m or N; it acts on the joints with the opposite sign.
    pub fn torque(&self) -> &[f64] {
        &self.torque
    }

    /// Sets σ for a period `h_s` from the state q, q̇ on. `ddq` is q̈ there, under the friction that is held until now.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn set(&mut self, tree: &Tree, h_s: f64, theta: &[f64], [q, dq, ddq]: [&[f64]; 3]) -> Result<(), LengthError> {
        let n = self.sigma.len();
        LengthError::check("joints", n, tree.joint_count())?;
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("ddq", n, ddq.len())?;
        tree.mass_matrix(&mut self.scratch, q, theta, &mut self.mass)?;
        invert(n, &mut self.mass, &mut self.mobility);
        for i in 0..n {
            let row = &self.mobility[i * n..(i + 1) * n];
            let rubbed: f64 = row.iter().zip(&self.torque).map(|(entry, torque)| entry * torque).sum();
            self.free[i] = dq[i] + h_s * (ddq[i] + rubbed);
        }
        let [_, frictions] = tree.drive_parameters();
        for _ in 0..MOST_SWEEPS {
            let mut change = 0.0_f64;
            for (Friction { joint, .. }, force) in tree.drives().friction.iter().zip(&theta[frictions.clone()]) {
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
