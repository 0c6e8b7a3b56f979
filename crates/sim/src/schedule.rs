//! Which graph is in force when.

use crate::graph::Edge;

/// A graph that stays in force for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its edges; at most one from any agent to any other.
    pub edges: Vec<Edge>,
    /// How long it lasts, s. Ignored for [`Schedule::Fixed`] and for the last phase of [`Schedule::Once`].
    pub dwell_s: f64,
}

/// A switching signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Schedule {
    /// One graph for ever.
    Fixed(Vec<Edge>),
    /// The phases in turn, again and again.
    Periodic(Vec<Phase>),
    /// The phases in turn; the last one stays for ever.
    Once(Vec<Phase>),
    /// A seeded random draw: at every switch one of the graphs, equally likely, for a dwell time drawn uniformly.
    Random {
        /// The graphs to draw from.
        graphs: Vec<Vec<Edge>>,
        /// Shortest and longest dwell, s.
        dwell_s: [f64; 2],
        /// Seed of the draw.
        seed: u64,
    },
}
