//! Networks that stay what they are: one graph, constant weights and delays, what is heard a linear function.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::network::Network;
use thiserror::Error;

/// What in a network changes, or is not linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NotFixed {
    /// The graph changes.
    #[error("the graph switches")]
    Switching,
    /// A delay changes, or is none of those that the network has.
    #[error("a delay varies with time")]
    VaryingDelay,
    /// A weight changes.
    #[error("a weight varies with time")]
    VaryingWeight,
    /// What is heard is no linear function.
    #[error("the coupling is nonlinear")]
    Coupling,
}

/// An edge that stays.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) weight: f64,
    pub(crate) delay_s: f64,
}

/// The edges of a network that stays what it is, as they are written and with what they are worth.
pub(crate) fn fixed(network: &Network) -> Result<(&[Edge], Vec<Link>), NotFixed> {
    if !network.coupling.is_linear() {
        return Err(NotFixed::Coupling);
    }
    let edges = network.schedule.constant_graph().ok_or(NotFixed::Switching)?;
    let link = |edge: &Edge| {
        let delay = network.delays.get(edge.delay).filter(|delay| delay.is_constant());
        let delay_s = delay.ok_or(NotFixed::VaryingDelay)?.value(0.0);
        let weight = edge.weight.constant().ok_or(NotFixed::VaryingWeight)?;
        Ok(Link { from: edge.from, to: edge.to, weight, delay_s })
    };
    let links = edges.iter().map(link).collect::<Result<_, _>>()?;
    Ok((edges, links))
}
