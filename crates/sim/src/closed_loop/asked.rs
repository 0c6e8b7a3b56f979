//! What the reference dynamics of a population ask for at one instant: z, ż, the rate of their state, and the signs in it.

use std::ops::Range;

use forwardstep_core::LengthError;
use forwardstep_core::reference::{Derived, Measured, ReferenceOut, SlidingInputs, saturated};

use super::columns::Inputs;
use super::robot_batch::Layout;
use crate::reference::Dynamics;

/// Signs that are functions of the instant.
pub(super) struct Layer {
    pub(super) width: f64,
    pub(super) selection: Vec<f64>,
}

/// What the signs of everybody are taken of.
pub(super) fn argument(
    reference: &Dynamics,
    l: Layout,
    x: &[f64],
    inputs: Inputs<'_>,
    derived: [&[f64]; 2],
    e: &mut [f64],
) -> Result<(), LengthError> {
    let (Some(sliding), block) = (reference.sliding(), l.block()) else { return Ok(()) };
    let transmitted = reference.transmitted();
    let first = transmitted.held.map_or(0, |held| l.reference + held * block);
    let channels = transmitted.channels();
    // Of a channel that is not heard nothing is read.
    let channel = |columns: &'_ [f64], c: usize| -> Range<usize> {
        if c < channels { c * block..(c + 1) * block } else { columns.len()..columns.len() }
    };
    let (held, heard) = (&x[first..], inputs.sums);
    let own = [&held[channel(held, 0)], &held[channel(held, 1)], derived[0]];
    let sums = [&heard[channel(heard, 0)], &heard[channel(heard, 1)], derived[1]];
    sliding.argument(l.m, SlidingInputs { own, degree: inputs.degree, sums }, e)
}

/// A sign that is a function of the instant and taken of what is heard alone leans on ż or on the rate of y, before the torque.
pub(super) fn add_sign_terms_now(
    reference: &Dynamics,
    layer: &mut Option<Layer>,
    l: Layout,
    x: &[f64],
    inputs: Inputs<'_>,
    dz: &mut [f64],
    d_state: &mut [f64],
) -> Result<(), LengthError> {
    let (Some(layer), Some(sliding)) = (layer, reference.sliding()) else { return Ok(()) };
    let leans_on_dz = match sliding.derived {
        Derived::Nothing => true,
        Derived::Composite => false,
        Derived::Acceleration | Derived::ReferenceAcceleration => return Ok(()),
    };
    argument(reference, l, x, inputs, [&[], &[]], &mut layer.selection)?;
    // The block that leans on the sign stands before that of the sign.
    let leaning = d_state.len() - 2 * l.block();
    for (k, selection) in layer.selection.iter_mut().enumerate() {
        *selection = saturated(*selection, layer.width);
        if leans_on_dz {
            dz[k] -= sliding.gamma * *selection;
        }
        d_state[leaning + k] -= sliding.gamma * *selection;
    }
    Ok(())
}

/// z, ż and the rate of the reference state of everybody.
pub(super) fn evaluate(
    reference: &Dynamics,
    l: Layout,
    (t_s, x): (f64, &[f64]),
    inputs: Inputs<'_>,
    out: ReferenceOut<'_>,
) -> Result<(), LengthError> {
    let measured = Measured { q: &x[..l.dq], dq: &x[l.dq..l.reference] };
    reference.evaluate(l.m, measured, &x[l.reference..l.theta_hat], (t_s, inputs), out)
}
