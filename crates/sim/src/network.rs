//! Who hears whom, when, and how late.

use thiserror::Error;

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

/// Why a network has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NetworkError {
    /// There is nobody.
    #[error("a network needs at least one agent")]
    NoAgents,
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
    /// A weight that is not positive.
    #[error(
        "graph {graph} gives the edge from {from} to {to} the weight {weight}; weights must be positive and finite"
    )]
    Weight {
        /// Index of the graph.
        graph: usize,
        /// Sender.
        from: usize,
        /// Receiver.
        to: usize,
        /// The weight.
        weight: f64,
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
    /// A dwell time that is not positive.
    #[error("graph {graph} dwells for {dwell_s} s; dwell times must be positive and finite")]
    Dwell {
        /// Index of the graph.
        graph: usize,
        /// The dwell time.
        dwell_s: f64,
    },
    /// A delay with a parameter that makes no sense.
    #[error("delay {delay}: {parameter} is {value}, but {requirement}")]
    Delay {
        /// Index of the delay.
        delay: usize,
        /// The parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
}

impl Network {
    /// Checks everything that the structs themselves do not rule out.
    ///
    /// # Errors
    /// [`NetworkError`] for the first thing found.
    pub fn validate(&self) -> Result<(), NetworkError> {
        if self.agents == 0 {
            return Err(NetworkError::NoAgents);
        }
        let graphs = self.schedule.graphs();
        if graphs.is_empty() {
            return Err(NetworkError::NoGraphs);
        }
        for (graph, edges) in graphs.into_iter().enumerate() {
            let mut seen = std::collections::HashSet::new();
            for edge in edges {
                let (from, to, weight) = (edge.from, edge.to, edge.weight);
                if from >= self.agents || to >= self.agents {
                    return Err(NetworkError::NoSuchAgent { graph, from, to, agents: self.agents });
                }
                if from == to {
                    return Err(NetworkError::SelfLoop { graph, agent: from });
                }
                if !seen.insert((from, to)) {
                    return Err(NetworkError::DuplicateEdge { graph, from, to });
                }
                if !(weight > 0.0 && weight.is_finite()) {
                    return Err(NetworkError::Weight { graph, from, to, weight });
                }
                if edge.delay >= self.delays.len() {
                    return Err(NetworkError::NoSuchDelay { graph, delay: edge.delay, delays: self.delays.len() });
                }
            }
        }
        self.check_dwell()?;
        self.delays.iter().enumerate().try_for_each(|(delay, kind)| {
            kind.validate().map_err(|(parameter, value, requirement)| NetworkError::Delay {
                delay,
                parameter,
                value,
                requirement,
            })
        })
    }

    fn check_dwell(&self) -> Result<(), NetworkError> {
        let dwells: Vec<f64> = match &self.schedule {
            Schedule::Fixed(_) => Vec::new(),
            Schedule::Periodic(phases) => phases.iter().map(|phase| phase.dwell_s).collect(),
            Schedule::Once(phases) => phases.iter().take(phases.len() - 1).map(|phase| phase.dwell_s).collect(),
            // The longest must not be below the shortest; reported as what it is.
            Schedule::Random { dwell_s: [low, high], .. } if high >= low => vec![*low, *high],
            Schedule::Random { dwell_s: [_, high], .. } => {
                return Err(NetworkError::Dwell { graph: 0, dwell_s: *high });
            }
        };
        match dwells.iter().position(|dwell| !(*dwell > 0.0 && dwell.is_finite())) {
            Some(graph) => Err(NetworkError::Dwell { graph, dwell_s: dwells[graph] }),
            None => Ok(()),
        }
    }

    /// The largest delay that any edge can have, s.
    pub fn max_delay_s(&self) -> f64 {
        self.used_delays().map(|index| self.delays[index].max_s()).fold(0.0, f64::max)
    }

    /// Indices of the delays that some edge of some graph refers to, rising.
    pub fn used_delays(&self) -> impl Iterator<Item = usize> + '_ {
        let mut used = vec![false; self.delays.len()];
        for edge in self.schedule.graphs().into_iter().flatten() {
            if let Some(used) = used.get_mut(edge.delay) {
                *used = true;
            }
        }
        used.into_iter().enumerate().filter(|(_, used)| *used).map(|(index, _)| index)
    }
}
