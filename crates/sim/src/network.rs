//! Who hears whom, when, and how late.

use crate::delay::Delay;
use crate::schedule::Schedule;

/// A switching digraph with delays.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Number of agents.
    pub agents: usize,
    /// The graph over time.
    pub schedule: Schedule,
    /// The delays that edges refer to by index.
    pub delays: Vec<Delay>,
}
