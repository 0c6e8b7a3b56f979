//! A Lagrangian robot with its true parameters, as a plant.

use alloc::vec;
use alloc::vec::Vec;

use super::{Plant, check_external};
use crate::LengthError;
use crate::robot::{Called, Lagrangian};
use crate::signal::{Block, Signal};

/// M(q) q̈ + C(q, q̇) q̇ + g(q) + D q̇ = τ + τ_ext with ϑ known to nature alone. State and output: q, q̇. Input: τ. From outside: τ_ext.
#[derive(Clone, Debug)]
pub struct Mechanical<R> {
    /// Geometry and kernels.
    pub robot: R,
    /// The true ϑ.
    pub theta: Vec<f64>,
}

impl<R: Lagrangian<f64> + Send + Sync + 'static> Plant for Mechanical<R> {
    type Scratch = R::Scratch;

    fn scratch(&self) -> Self::Scratch {
        self.robot.scratch()
    }

    fn axes(&self) -> usize {
        self.robot.dof()
    }

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Position, self.axes()), (Signal::Velocity, self.axes())]
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::Torque, self.axes())]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        2 * self.axes()
    }

    fn output(&self, _: &mut Self::Scratch, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        output.copy_from_slice(state);
        Ok(())
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
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("rate", self.output_len(), d_state.len())?;
        LengthError::check("input", self.axes(), input.len())?;
        check_external(self.axes(), external)?;
        let (q, dq) = state.split_at(self.axes());
        let (d_q, ddq) = d_state.split_at_mut(self.axes());
        // Room for the sum of all torques, until it is needed for q̇.
        d_q.copy_from_slice(input);
        for (torque, external) in d_q.iter_mut().zip(external) {
            *torque += external;
        }
        Called(&self.robot).forward_dynamics(scratch, q, dq, &self.theta, d_q, ddq)?;
        d_q.copy_from_slice(dq);
        Ok(())
    }
}
