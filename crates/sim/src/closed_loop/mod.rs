//! Robots, reference dynamics, laws and network joined into one delay-differential equation.
//!
//! - `population`: agents of one kind, side by side in columns; the staged right-hand side.
//! - `assemble`: from a [`crate::Setup`] to populations, with everything checked.

mod assemble;
mod population;

pub(crate) use assemble::ClosedLoop;
pub use assemble::SetupError;
