//! The kinds of switching that scenario files know: for each the struct of its table, or a word that stands alone.

pub mod log;
pub mod once;
pub mod random;
pub mod repeat;

use std::fmt;

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;

use super::super::fault::Fault;
use super::super::network::PhaseReader;
use super::KindTable;

/// A kind of switching in scenario files: its table, as it was read.
pub trait ScheduleKind: fmt::Debug {
    /// What the list says of it; its key stands in `switching`.
    fn table() -> KindTable
    where
        Self: Sized;

    /// The graphs of `phases` as it takes them.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault>;
}
