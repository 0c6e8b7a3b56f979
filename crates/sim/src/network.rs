//! Who hears whom, when, and how late.

use thiserror::Error;

use crate::coupling::Coupling;
use crate::delay::{Delay, DelayFault, Drawn};
use crate::formula::BoundedFormula;
use crate::graph::Weight;
use crate::quantity::{Path, QuantityError};
use crate::schedule::{Schedule, ScheduleFault};

/// A switching digraph with delays.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Number of agents.
    pub agents: usize,
    /// The graph over time.
    pub schedule: Schedule,
    /// The delays that edges refer to by index.
    pub delays: Vec<Delay>,
    /// The weights that change with time, which edges refer to by index.
    pub weights: Vec<BoundedFormula>,
    /// How strongly a disagreement acts, on every edge.
    pub coupling: Coupling,
}

/// Why a network has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NetworkError {
    /// There are no agents.
    #[error("a network needs at least one agent")]
    NoAgents,
    /// A quantity out of its range.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
    /// A schedule without any graph.
    #[error("the schedule has no graph")]
    NoGraphs,
    /// An edge leads to or from an agent that does not exist.
    #[error("graph {graph} has an edge from {from} to {to}, but there are {agents} agents")]
    NoSuchAgent {
        /// Index of the graph.
        graph: usize,
        /// Sender.
        from: usize,
        /// Receiver.
        to: usize,
        /// Number of agents.
        agents: usize,
    },
    /// An agent hears itself.
    #[error("graph {graph} has a self-loop at agent {agent}")]
    SelfLoop {
        /// Index of the graph.
        graph: usize,
        /// The agent.
        agent: usize,
    },
    /// Two edges between the same agents in the same direction.
    #[error("graph {graph} has two edges from {from} to {to}")]
    DuplicateEdge {
        /// Index of the graph.
        graph: usize,
        /// Sender.
        from: usize,
        /// Receiver.
        to: usize,
    },
    /// An edge refers to a weight that does not exist.
    #[error("graph {graph} refers to weight {weight}, but there are {weights}")]
    NoSuchWeight {
        /// Index of the graph.
        graph: usize,
        /// Index of the weight.
        weight: usize,
        /// Number of weights.
        weights: usize,
    },
    /// A delay or a weight that is known for less than the run.
    #[error(
        "delay or weight {index} is known until {until_s} s, but the run ends at {end_s} s; make it for the whole run"
    )]
    EndsEarly {
        /// Index of the delay or of the weight.
        index: usize,
        /// Until when it is known, s.
        until_s: f64,
        /// The end of the run, s.
        end_s: f64,
    },
    /// An edge refers to a delay that does not exist.
    #[error("graph {graph} refers to delay {delay}, but there are {delays}")]
    NoSuchDelay {
        /// Index of the graph.
        graph: usize,
        /// Index of the delay.
        delay: usize,
        /// Number of delays.
        delays: usize,
    },
    /// A switching signal from outside that is not what its author says.
    #[error("{words} is not what it is declared to be: {fault}")]
    RefutedSwitching {
        /// What the signal is called.
        words: &'static str,
        /// What was found.
        fault: ScheduleFault,
    },
    /// A delay from outside that is not what its author says.
    #[error("delay {delay}, {words}, is not what it is declared to be: {fault}")]
    RefutedDelay {
        /// Index of the delay.
        delay: usize,
        /// What it is called.
        words: &'static str,
        /// What was found.
        fault: DelayFault,
    },
}

impl Network {
    /// Checks everything that the structs themselves do not rule out, for a run of `end_s`.
    ///
    /// # Errors
    /// [`NetworkError`] for the first thing found.
    pub fn validate(&self, end_s: f64) -> Result<(), NetworkError> {
        self.check_shape()?;
        for (graph, edges) in self.schedule.graphs.iter().enumerate() {
            let mut seen = std::collections::HashSet::new();
            for (k, edge) in edges.iter().enumerate() {
                let (from, to) = (edge.from, edge.to);
                if from == to {
                    return Err(NetworkError::SelfLoop { graph, agent: from });
                }
                if !seen.insert((from, to)) {
                    return Err(NetworkError::DuplicateEdge { graph, from, to });
                }
                let at = || Path::from("network.graphs").index(graph).index(k);
                edge.weight.check(&self.weights).map_err(|error| error.under(at()))?;
            }
        }
        self.coupling.check()?;
        self.schedule.check(end_s)?;
        let mut all = Drawn::default();
        self.delays.iter().enumerate().try_for_each(|(index, delay)| {
            let (what, drawn) = delay.drawn();
            let checked = delay.check(end_s).and_then(|()| all.add(what, drawn as f64));
            Ok(checked.map_err(|error| error.under(Path::from("network.delays").index(index)))?)
        })
    }

    /// Checks that there are agents and graphs, and that edges name agents, weights and delays that there are.
    ///
    /// # Errors
    /// [`NetworkError`] for the first thing found.
    pub(crate) fn check_shape(&self) -> Result<(), NetworkError> {
        if self.agents == 0 {
            return Err(NetworkError::NoAgents);
        }
        if self.schedule.graphs.is_empty() {
            return Err(NetworkError::NoGraphs);
        }
        for (graph, edges) in self.schedule.graphs.iter().enumerate() {
            for edge in edges {
                let (from, to) = (edge.from, edge.to);
                if from >= self.agents || to >= self.agents {
                    return Err(NetworkError::NoSuchAgent { graph, from, to, agents: self.agents });
                }
                if let Weight::Formula(weight) = edge.weight
                    && weight >= self.weights.len()
                {
                    return Err(NetworkError::NoSuchWeight { graph, weight, weights: self.weights.len() });
                }
                if edge.delay >= self.delays.len() {
                    return Err(NetworkError::NoSuchDelay { graph, delay: edge.delay, delays: self.delays.len() });
                }
            }
        }
        Ok(())
    }

    /// Checks that the packets, random holds and formulas of links are known until `end_s`, and that what is from outside is until
    /// then what its author says, as far as that can be seen.
    ///
    /// # Errors
    /// [`NetworkError::EndsEarly`], [`NetworkError::RefutedSwitching`] or [`NetworkError::RefutedDelay`] for the first that is not.
    pub fn lasts_until(&self, end_s: f64) -> Result<(), NetworkError> {
        let delays = self.used_delays().map(|index| (index, self.delays[index].known().until_s));
        let weights = self.schedule.graphs.iter().flatten().filter_map(|edge| match edge.weight {
            Weight::Constant(_) => None,
            Weight::Formula(index) => Some((index, self.weights.get(index).map(BoundedFormula::until_s))),
        });
        for (index, until_s) in delays.chain(weights) {
            if let Some(until_s) = until_s.filter(|until_s| *until_s < end_s) {
                return Err(NetworkError::EndsEarly { index, until_s, end_s });
            }
        }
        let switching = |fault| NetworkError::RefutedSwitching { words: self.schedule.words(), fault };
        self.schedule.probe(end_s).map_err(switching)?;
        self.used_delays().try_for_each(|delay| {
            let refuted = |fault| NetworkError::RefutedDelay { delay, words: self.delays[delay].words(), fault };
            self.delays[delay].probe(end_s).map_err(refuted)
        })
    }

    /// The value of a weight at `t_s`.
    #[inline]
    pub fn weight_at(&self, weight: Weight, t_s: f64) -> f64 {
        match weight {
            Weight::Constant(weight) => weight,
            Weight::Formula(index) => self.weights.get(index).map_or(f64::NAN, |formula| formula.value(t_s)),
        }
    }

    /// The largest delay that any edge can have, s.
    pub fn max_delay_s(&self) -> f64 {
        self.used_delays().map(|index| self.delays[index].max_s()).fold(0.0, f64::max)
    }

    /// Whether an agent ever hears another.
    pub fn has_edges(&self) -> bool {
        self.schedule.graphs.iter().any(|graph| !graph.is_empty())
    }

    /// Indices of the delays that some edge of some graph refers to, rising.
    pub fn used_delays(&self) -> impl Iterator<Item = usize> + '_ {
        let mut used = vec![false; self.delays.len()];
        for edge in self.schedule.graphs.iter().flatten() {
            if let Some(used) = used.get_mut(edge.delay) {
                *used = true;
            }
        }
        used.into_iter().enumerate().filter(|(_, used)| *used).map(|(index, _)| index)
    }
}
