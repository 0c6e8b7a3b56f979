//! A Lagrangian robot whose tip is watched: (71)–(73).

use alloc::vec;
use alloc::vec::Vec;

use super::{Mechanical, Plant};
use crate::LengthError;
use crate::robot::{Lagrangian, Posture, TipKinematics};
use crate::signal::{Block, Signal};

/// A robot with ϑ and θ known to nature alone. State: q, q̇. Output: q, q̇ and the position x of the tip. Input: τ.
/// From outside: τ_ext, which a force f on the tip makes by Jᵀf.
///
/// **Source**: (71), (73).
#[derive(Clone, Debug)]
pub struct TaskArm<R, T> {
    /// The robot with its true ϑ.
    pub arm: Mechanical<R>,
    /// Where its tip is.
    pub tip: T,
    /// The true θ.
    pub tip_theta: Vec<f64>,
}

impl<R, T> Plant for TaskArm<R, T>
where
    R: Lagrangian<f64> + Send + Sync + 'static,
    T: TipKinematics,
{
    type Scratch = R::Scratch;

    fn scratch(&self) -> Self::Scratch {
        self.arm.scratch()
    }

    fn axes(&self) -> usize {
        self.arm.axes()
    }

    fn states(&self) -> Vec<Block> {
        self.arm.states()
    }

    fn inputs(&self) -> Vec<Block> {
        self.arm.inputs()
    }

    fn outputs(&self) -> Vec<Block> {
        let mut outputs = self.arm.states();
        outputs.push((Signal::TaskPosition, self.tip.axes()));
        outputs
    }

    fn output_len(&self) -> usize {
        2 * self.axes() + self.tip.axes()
    }

    fn output(&self, scratch: &mut Self::Scratch, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("output", self.output_len(), output.len())?;
        let (motion, x) = output.split_at_mut(2 * self.axes());
        self.arm.output(scratch, state, motion)?;
        self.tip.position(&motion[..self.arm.axes()], &self.tip_theta, x)
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn settle(&self, _: &mut [f64]) {}

    fn rate(
        &self,
        scratch: &mut Self::Scratch,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.arm.rate(scratch, state, input, external, d_state)
    }
}

/// The same where the velocity of the tip is measured too: the output has ẋ = J(q) q̇ behind x, by the true θ.
#[derive(Clone, Debug)]
pub struct WatchedTaskArm<R, T>(pub TaskArm<R, T>);

/// Working memory of [`WatchedTaskArm`].
#[derive(Clone, Debug)]
pub struct WatchedTaskWork<S> {
    arm: S,
    j: Vec<f64>,
    dj: Vec<f64>,
    still: Vec<f64>,
}

impl<R, T> Plant for WatchedTaskArm<R, T>
where
    R: Lagrangian<f64> + Send + Sync + 'static,
    T: TipKinematics,
{
    type Scratch = WatchedTaskWork<R::Scratch>;

    fn scratch(&self) -> Self::Scratch {
        let tip = &self.0.tip;
        let entries = tip.rows() * tip.joints();
        WatchedTaskWork {
            arm: self.0.scratch(),
            j: vec![0.0; entries],
            dj: vec![0.0; entries],
            still: vec![0.0; tip.parameter_count()],
        }
    }

    fn axes(&self) -> usize {
        self.0.axes()
    }

    fn states(&self) -> Vec<Block> {
        self.0.states()
    }

    fn inputs(&self) -> Vec<Block> {
        self.0.inputs()
    }

    fn outputs(&self) -> Vec<Block> {
        let mut outputs = self.0.outputs();
        outputs.push((Signal::TaskVelocity, self.0.tip.axes()));
        outputs
    }

    fn output_len(&self) -> usize {
        self.0.output_len() + self.0.tip.axes()
    }

    fn output(&self, work: &mut Self::Scratch, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("output", self.output_len(), output.len())?;
        let (n, tip) = (self.axes(), &self.0.tip);
        let (seen, dx) = output.split_at_mut(self.0.output_len());
        self.0.output(&mut work.arm, state, seen)?;
        let (q, dq) = (&seen[..n], &seen[n..2 * n]);
        let posture = Posture { q, dq, theta: &self.0.tip_theta, d_theta: &work.still };
        tip.jacobian(posture, &mut work.j, &mut work.dj)?;
        for (dx, row) in dx.iter_mut().zip(work.j.chunks_exact(n.max(1))) {
            *dx = row.iter().zip(dq).map(|(j, dq)| j * dq).sum();
        }
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn settle(&self, _: &mut [f64]) {}

    fn rate(
        &self,
        work: &mut Self::Scratch,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.0.rate(&mut work.arm, state, input, external, d_state)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{PlanarArm, PlanarLinks, PlanarTip};

    #[test]
    fn eq_71_the_output_holds_the_position_of_the_true_tip() {
        let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
        let plant = TaskArm {
            arm: Mechanical { robot: PlanarArm, theta: links.theta().to_vec() },
            tip: PlanarTip { length_m: links.length_m },
            tip_theta: vec![1.0, 0.8],
        };
        let mut output = vec![0.0; plant.output_len()];
        plant.output(&mut (), &[0.0, core::f64::consts::FRAC_PI_2, 0.1, 0.2], &mut output).unwrap();
        assert_eq!(output[..4], [0.0, core::f64::consts::FRAC_PI_2, 0.1, 0.2]);
        assert!((output[4] - 1.0).abs() < 1e-15 && (output[5] - 0.8).abs() < 1e-15, "{output:?}");
        assert!(plant.output(&mut (), &[0.0; 3], &mut output).is_err());

        // The elbow at a right angle: the second link points up, ẋ = (−0.8 (q̇₁ + q̇₂), q̇₁).
        let watched = WatchedTaskArm(plant);
        let mut output = vec![0.0; watched.output_len()];
        let mut work = watched.scratch();
        watched.output(&mut work, &[0.0, core::f64::consts::FRAC_PI_2, 0.1, 0.2], &mut output).unwrap();
        assert!((output[6] + 0.24).abs() < 1e-15 && (output[7] - 0.1).abs() < 1e-15, "{output:?}");
        assert!(watched.output(&mut work, &[0.0; 3], &mut output).is_err());
    }
}
