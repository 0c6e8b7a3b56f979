//! The kinds of delay that scenario files know: for each the struct of its table.

pub mod constant;
pub mod formula;
pub mod hold_log;
pub mod log;
pub mod packets;
pub mod piecewise_constant;
pub mod random_hold;
pub mod saw_tooth;
pub mod sinusoid;

use std::fmt;
use std::sync::Arc;

use forwardstep_sim::Same;
use forwardstep_sim::delay::{Delay, Drawn};

use super::super::fault::Fault;
use super::super::network::NetworkReader;
use super::KindTable;

/// A kind of delay in scenario files: its table, as it was read.
pub trait DelayKind: fmt::Debug {
    /// What the list says of it; its key stands in `delay`.
    fn table() -> KindTable
    where
        Self: Sized;

    /// What the links have that name it.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault>;
}

/// The delay of some links.
#[derive(Clone, Debug)]
pub enum DelayPlan {
    /// One delay for all of them.
    Shared(Delay),
    /// Every link has its own.
    EachLink(Arc<dyn LinkDelays>),
}

impl DelayPlan {
    /// Every link has its own.
    pub fn each_link(delays: impl LinkDelays) -> DelayPlan {
        DelayPlan::EachLink(Arc::new(delays))
    }
}

/// Delays of which every link has its own.
pub trait LinkDelays: Same + fmt::Debug {
    /// Whether it is the link's own whatever the graph, as packets on the air are: other graphs cannot give it another.
    fn stays_with_link(&self) -> bool;

    /// The delay of one link.
    ///
    /// # Errors
    /// The first mistake.
    fn draw(&self, link: &mut Link<'_>) -> Result<Delay, Fault>;
}

/// A link that a delay is drawn for.
#[derive(Debug)]
pub struct Link<'a> {
    /// The sender and the receiver, by number.
    pub agents: (usize, usize),
    /// Their names.
    pub names: [&'a str; 2],
    /// The end of the run, s.
    pub end_s: f64,
    /// What has been drawn for all links so far.
    pub(crate) drawn: &'a mut Drawn,
}

impl Link<'_> {
    /// Refuses jumps, packets or whatever `what` is when those of all links together exceed any memory.
    ///
    /// # Errors
    /// [`ValueProblem::Quantity`](super::super::ValueProblem::Quantity).
    pub fn few(&mut self, what: &'static str, events: f64) -> Result<(), Fault> {
        Ok(self.drawn.add(what, events)?)
    }
}
