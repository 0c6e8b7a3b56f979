//! Robots, reference dynamics, laws and network joined into one delay-differential equation.
//!
//! - `fleet`: robots with their tracking laws, several at once.
//! - `population`: agents of one kind, side by side in columns: reference dynamics, then the fleet.
//! - `sampler`: the digital controllers of a population, with their sensors.
//! - `sampling`: the instants at which they sample and act.
//! - `pushes`: what acts on the robots from outside.
//! - `assemble`: from a [`crate::Setup`] to populations, with everything checked.

mod assemble;
mod fleet;
mod population;
mod pushes;
mod sampler;
mod sampling;

pub(crate) use assemble::ClosedLoop;
pub use assemble::SetupError;
