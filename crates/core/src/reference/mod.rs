//! Reference dynamics: what produces the reference velocity z and the reference acceleration ż.
//!
//! - `consensus`: the family (aa10), (a1), (a5), (24), which only integrates what it constructed itself.
//! - `desired`: linear ones of any order that a user writes down, for plants of any order.
//! - `pure_integral`: (3) and (23), which contain q̈ and are realised by their integral.
//! - `backstepping`: (aa6), the baseline, which differentiates.
//! - `following`: (110), (119), (122), which follow a leader.
//! - `composite`: a leader behind graphs that switch and links that delay, with differentiable torques; not from the paper.
//! - `observer`: a rival of (110), which hears estimates of where the leader is.
//! - `per_axis`: those of one's own, from one function.
//! - `sliding`: the set-valued sign in them.
//! - `exchange`: what agents tell each other.

mod backstepping;
mod composite;
mod consensus;
mod desired;
mod exchange;
mod following;
mod observer;
mod per_axis;
mod polynomial;
mod pure_integral;
mod roots;
mod sliding;

pub use backstepping::{Backstepping, BacksteppingError};
pub use composite::CompositeFollowing;
pub use consensus::Consensus;
pub(crate) use desired::Place;
pub use desired::{Desired, DesiredDynamics, DesiredError, WrittenIn};
pub use exchange::{
    Composite, CompositeSums, EstimateSums, Estimates, Exchange, Heard, Position, PositionSums, PositionVelocity,
    PositionVelocitySums,
};
pub use following::{Following, SmoothFollowing};
pub use observer::Observer;
pub use per_axis::{AxisInput, AxisOutput, PerAxis};
pub use polynomial::{RootsError, polynomial};
pub use pure_integral::PureIntegral;
pub use roots::{RootPair, RootSet};
pub use sliding::{Choice, Derived, Sliding, SlidingInputs, saturated};

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::LengthError;

/// What reference dynamics measure of their own robots, `axes · agents` entries each.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Joint positions.
    pub q: &'a [f64],
    /// Joint velocities.
    pub dq: &'a [f64],
}

/// Where reference dynamics put their results.
#[derive(Debug)]
pub struct ReferenceOut<'a> {
    /// z, `axes · agents` entries.
    pub z: &'a mut [f64],
    /// ż, `axes · agents` entries.
    pub dz: &'a mut [f64],
    /// d/dt of the state.
    pub d_state: &'a mut [f64],
}

/// Reference dynamics of a population of agents.
///
/// All columns are laid out as `axis · agents + agent`; the state is [`Reference::vectors`] such blocks, one after the
/// other. One agent is a population of one. z̈ never enters a torque, so outputs and rates are computed together, before it.
pub trait Reference: Send + Sync + 'static {
    /// What agents tell each other; what is not in it cannot be read.
    type Exchange: Exchange;

    /// Number of agents.
    fn agents(&self) -> usize;

    /// Blocks of state.
    fn vectors(&self) -> usize;

    /// How many of them are z, ż, z̈, … in this order.
    fn derivatives(&self) -> usize;

    /// The set-valued sign in it, if it has one. The last block of state is then the value of the sign, which has rate zero and
    /// is set by the integrator, or the sampled controller.
    fn sliding(&self) -> Option<&Sliding>;

    /// Whether the rate of the state is affine in the state, by a matrix that depends on Σ_j w_ij alone and is the same for each axis.
    /// Sampled agents then step it exactly, else by the classical Runge–Kutta method.
    fn is_affine(&self) -> bool;

    /// z, ż and the rate of the state.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, Self::Exchange>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError>;

    /// The state that gives z and its derivatives the values `given`, as far as the dynamics leave them free: `given`
    /// holds [`Reference::vectors`] blocks z(0), ż(0), ….
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, Self::Exchange>,
        state: &mut [f64],
    ) -> Result<(), LengthError>;

    /// The message of one agent before its first sample, when its state has not been computed: what it will transmit once it starts with
    /// z(0), ż(0), … as `wanted`. `message` comes filled with what is measured, q and then q̇, as far as it has room. Called only where
    /// messages are blocks of the state, see [`Exchange::HELD`].
    fn initial_message(&self, _wanted: &[Vec<f64>], _message: &mut [f64]) {}
}

/// Which dynamics, known at run time only, behind a pointer of its own or a shared one.
macro_rules! behind {
    ($pointer:ident) => {
        impl<X: Exchange> Reference for $pointer<dyn Reference<Exchange = X>> {
            type Exchange = X;

            fn agents(&self) -> usize {
                (**self).agents()
            }

            fn vectors(&self) -> usize {
                (**self).vectors()
            }

            fn derivatives(&self) -> usize {
                (**self).derivatives()
            }

            fn sliding(&self) -> Option<&Sliding> {
                (**self).sliding()
            }

            fn is_affine(&self) -> bool {
                (**self).is_affine()
            }

            fn evaluate(
                &self,
                axes: usize,
                measured: Measured<'_>,
                state: &[f64],
                heard: Heard<'_, X>,
                out: ReferenceOut<'_>,
            ) -> Result<(), LengthError> {
                (**self).evaluate(axes, measured, state, heard, out)
            }

            fn start(
                &self,
                axes: usize,
                measured: Measured<'_>,
                given: &[f64],
                heard: Heard<'_, X>,
                state: &mut [f64],
            ) -> Result<(), LengthError> {
                (**self).start(axes, measured, given, heard, state)
            }

            fn initial_message(&self, wanted: &[Vec<f64>], message: &mut [f64]) {
                (**self).initial_message(wanted, message)
            }
        }
    };
}

behind!(Box);
behind!(Arc);

/// The start of dynamics whose state begins with z, ż, …: the first `stated` of its `need` entries are those given, the rest is zero.
fn begin([stated, need]: [usize; 2], given: &[f64], state: &mut [f64]) -> Result<(), LengthError> {
    LengthError::check("start of the reference", need, given.len())?;
    LengthError::check("reference state", need, state.len())?;
    let stated = stated.min(need);
    state.fill(0.0);
    state[..stated].copy_from_slice(&given[..stated]);
    Ok(())
}

/// Checks the lengths that all reference dynamics share.
#[inline(always)]
fn check<X: Exchange>(
    [axes, agents, vectors]: [usize; 3],
    measured: Measured<'_>,
    state: &[f64],
    heard: Heard<'_, X>,
    out: &ReferenceOut<'_>,
) -> Result<(), LengthError> {
    let block = axes * agents;
    LengthError::check("q", block, measured.q.len())?;
    LengthError::check("dq", block, measured.dq.len())?;
    LengthError::check("reference state", vectors * block, state.len())?;
    LengthError::check("reference rate", vectors * block, out.d_state.len())?;
    LengthError::check("z", block, out.z.len())?;
    LengthError::check("dz", block, out.dz.len())?;
    LengthError::check("degree", agents, heard.degree.len())?;
    X::check(heard.sums, block)
}
