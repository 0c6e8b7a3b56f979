//! What the theorems promise for a given network, with witnesses.

pub mod verdict;

pub use verdict::{Answer, Hypothesis, Report};
