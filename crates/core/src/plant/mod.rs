//! Systems to be controlled, as vector fields, when they are more than a robot under (6)–(7).
//!
//! - `mechanical`: (1), a robot.
//! - `chain`, `vector_chain`: (33) with one axis and with several.
//! - `vehicle`: (44), a thrust-propelled vehicle, and one that measures its acceleration.
//! - `rotorcraft`: the same as a rigid body with torques and rotors.

mod cascade;
mod chain;
mod mechanical;
mod rotorcraft;
mod spacecraft;
mod task_arm;
mod vector_chain;
mod vector_field;
mod vehicle;

pub use cascade::{Cascade, CascadeError, CascadeTerms, CascadeWork};
pub use chain::{Chain, ChainWork, Closures, Formulas, FormulasWork, Terms};
pub use mechanical::Mechanical;
pub use rotorcraft::{Rotorcraft, Rotors};
pub use spacecraft::{Spacecraft, SpacecraftError, Wheel, Wheels};
pub use task_arm::{TaskArm, WatchedTaskArm, WatchedTaskWork};
pub use vector_chain::{VectorChain, VectorFormulas, VectorFormulasWork};
pub use vector_field::VectorField;
pub use vehicle::{AcceleratedVehicle, Vehicle, VehicleState};

use alloc::vec::Vec;

use crate::LengthError;
use crate::signal::{Block, Signal};

/// A system d/dt state = f(state, input).
///
/// The first [`Plant::axes`] numbers of its state are the position, which is what an agent transmits; where there is a
/// velocity, it comes next. The true parameters are part of the plant: a controller has its own.
///
/// Behind the check of lengths nothing panics, whatever the numbers.
pub trait Plant: Send + Sync + 'static {
    /// Working memory of one call.
    type Scratch: Send;

    /// Allocates it.
    fn scratch(&self) -> Self::Scratch;

    /// m, the numbers of a position.
    fn axes(&self) -> usize;

    /// What the state is, block by block: the position first, then the velocity.
    fn states(&self) -> Vec<Block>;

    /// What the input is, block by block.
    fn inputs(&self) -> Vec<Block>;

    /// What [`Plant::output`] gives, block by block: the position first, then the velocity where there is one.
    fn outputs(&self) -> Vec<Block>;

    /// Numbers in [`Plant::outputs`], without listing them.
    fn output_len(&self) -> usize;

    /// Everything that a sensor could see in `state`; which of it a controller may read is said by
    /// [`crate::controller::Controller::see`]. The position comes first, then the velocity where there is one.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn output(&self, scratch: &mut Self::Scratch, state: &[f64], output: &mut [f64]) -> Result<(), LengthError>;

    /// Limits `input` to what the actuators can give in `state`.
    fn limit(&self, state: &[f64], input: &mut [f64]);

    /// Writes over what a controller shows of its command, block `signal`, what `input` does, which actuators may have limited; leaves alone what
    /// it knows nothing of.
    fn acting(&self, _signal: Signal, _input: &[f64], _shown: &mut [f64]) {}

    /// d/dt of `state` under `input` and what acts from outside. Forces and torques come in `external`, in the order of the
    /// axes and then of the body, or what is added to each equation; empty when nothing acts. A plant that nothing acts on
    /// takes an empty one only.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn rate(
        &self,
        scratch: &mut Self::Scratch,
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError>;

    /// Brings `state`, which rounding and truncation have led away by little, back to its manifold: unit quaternions have
    /// norm one.
    fn settle(&self, state: &mut [f64]);
}

/// Checks that `external` has an entry for each of `need`, or none.
///
/// # Errors
/// [`LengthError`] when it has another number.
pub fn check_external(need: usize, external: &[f64]) -> Result<(), LengthError> {
    if external.is_empty() { Ok(()) } else { LengthError::check("what acts from outside", need, external.len()) }
}

/// Numbers in all blocks.
pub fn total(blocks: &[Block]) -> usize {
    blocks.iter().map(|(_, count)| count).sum()
}
