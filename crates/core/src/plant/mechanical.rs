//! A Lagrangian robot with its true parameters, as a plant.

use alloc::vec;
use alloc::vec::Vec;

use super::Plant;
use crate::LengthError;
use crate::robot::Lagrangian;
use crate::signal::{Block, Signal};

/// M(q) q̈ + C(q, q̇) q̇ + g(q) + D q̇ = τ with ϑ known to nature alone. State and output: q, q̇. Input: τ.
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
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("rate", self.output_len(), d_state.len())?;
        let (q, dq) = state.split_at(self.axes());
        let (d_q, ddq) = d_state.split_at_mut(self.axes());
        d_q.copy_from_slice(dq);
        self.robot.forward_dynamics(scratch, q, dq, &self.theta, input, ddq)
    }
}
