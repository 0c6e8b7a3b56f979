//! Reference dynamics: what produces the reference velocity z and the reference acceleration ż.

mod consensus;
mod exchange;

pub use consensus::{Consensus, Measured, RootsError, polynomial};
pub use exchange::{Exchange, Heard, Position, PositionSums, PositionVelocity, PositionVelocitySums};
