//! A plant whose vector field is a closure.

use alloc::vec::Vec;
use core::fmt;

use super::{Plant, check_external, total};
use crate::LengthError;
use crate::scalar::Scalar;
use crate::signal::Block;

/// ẋ = f(x, u) + w, all of whose state can be measured. `rate` takes x, u and ẋ, in this order, each as long as its blocks say;
/// the disturbance w, where there is one, is added to what it gives, entry by entry.
///
/// ```
/// use forwardstep_core::plant::{Plant, VectorField};
/// use forwardstep_core::signal::Signal;
///
/// // A ẋ = u: the level of a tank of 2 m².
/// let tank = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 1)], |_, u, dx| dx[0] = u[0] / 2.0);
/// let mut rate = [0.0];
/// tank.rate(&mut (), &[1.0], &[0.5], &[], &mut rate)?;
/// assert_eq!(rate, [0.25]);
/// # Ok::<(), forwardstep_core::LengthError>(())
/// ```
#[derive(Clone)]
pub struct VectorField<F> {
    axes: usize,
    states: Vec<Block>,
    inputs: Vec<Block>,
    limits: Vec<f64>,
    rate: F,
}

impl<F: Fn(&[f64], &[f64], &mut [f64])> VectorField<F> {
    /// A plant of which the first `axes` states are the position, without limits.
    pub fn new(axes: usize, states: impl Into<Vec<Block>>, inputs: impl Into<Vec<Block>>, rate: F) -> Self {
        VectorField { axes, states: states.into(), inputs: inputs.into(), limits: Vec::new(), rate }
    }

    /// The same plant, whose actuators give no input of a greater magnitude than these, entry by entry. Inputs beyond the list
    /// have no limit, nor has one whose limit is infinite.
    pub fn limited(mut self, limits: impl Into<Vec<f64>>) -> Self {
        self.limits = limits.into();
        self
    }
}

impl<F> fmt::Debug for VectorField<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let VectorField { axes, states, inputs, limits, .. } = self;
        f.debug_struct("VectorField")
            .field("axes", axes)
            .field("states", states)
            .field("inputs", inputs)
            .field("limits", limits)
            .finish_non_exhaustive()
    }
}

impl<F: Fn(&[f64], &[f64], &mut [f64]) + Send + Sync + 'static> Plant for VectorField<F> {
    type Scratch = ();

    fn scratch(&self) {}

    fn axes(&self) -> usize {
        self.axes
    }

    fn states(&self) -> Vec<Block> {
        self.states.clone()
    }

    fn inputs(&self) -> Vec<Block> {
        self.inputs.clone()
    }

    fn outputs(&self) -> Vec<Block> {
        self.states.clone()
    }

    fn output_len(&self) -> usize {
        total(&self.states)
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", total(&self.states), state.len())?;
        LengthError::check("output", total(&self.states), output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], input: &mut [f64]) {
        for (input, limit) in input.iter_mut().zip(&self.limits) {
            *input = input.saturate(*limit);
        }
    }

    fn rate(
        &self,
        (): &mut (),
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", total(&self.states), state.len())?;
        LengthError::check("input", total(&self.inputs), input.len())?;
        LengthError::check("rate", total(&self.states), d_state.len())?;
        check_external(total(&self.states), external)?;
        (self.rate)(state, input, d_state);
        d_state.iter_mut().zip(external).for_each(|(d_state, w)| *d_state += w);
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Signal;

    #[test]
    fn limits_are_those_of_their_inputs() {
        let plant = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Torque, 3)], |_, u, dx| dx[0] = u[0]);
        let mut input = [3.0, -3.0, 3.0];
        plant.limit(&[0.0], &mut input);
        assert_eq!(input, [3.0, -3.0, 3.0]);
        let plant = plant.limited([1.0, 2.0]);
        plant.limit(&[0.0], &mut input);
        assert_eq!(input, [1.0, -2.0, 3.0]);
        input[0] = f64::NAN;
        plant.limit(&[0.0], &mut input);
        assert!(input[0].is_nan(), "what a law cannot say is no command: {input:?}");
    }

    #[test]
    fn wrong_lengths_are_errors() {
        let plant = VectorField::new(1, [(Signal::Position, 2)], [(Signal::Torque, 1)], |_, u, dx| dx[0] = u[0]);
        let mut rate = [0.0, 5.0];
        plant.rate(&mut (), &[0.0; 2], &[1.0], &[0.25, -1.0], &mut rate).unwrap();
        assert_eq!(rate, [1.25, 4.0]);
        for [state, input, w, rate] in [[1, 1, 0, 2], [2, 2, 0, 2], [2, 1, 0, 3], [2, 1, 1, 2]] {
            let (state, input, w) = (vec![0.0; state], vec![0.0; input], vec![0.0; w]);
            assert!(plant.rate(&mut (), &state, &input, &w, &mut vec![0.0; rate]).is_err());
        }
        assert!(plant.output(&mut (), &[1.0, 2.0], &mut [0.0; 1]).is_err());
        assert!(plant.output(&mut (), &[1.0], &mut [0.0; 2]).is_err());
    }
}
