//! Of which agents the jumps of the torque are known, and what they are promised.

use forwardstep_core::LengthError;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::reference::{Consensus, Dynamics, PureIntegral, ReferenceFamily};
use forwardstep_sim::{Series, Setup, SetupError, reference_dynamics};
use thiserror::Error;

use crate::kinds::is_lagrangian;

/// One agent of which jumps are reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Covered {
    /// Derivatives that what is heard determines: τ, τ̇, … as many as this.
    pub derivatives: usize,
    /// How many of them must not jump: ℓ − 1 for the consensus family of order ℓ. `None` where nothing is promised.
    pub continuous: Option<usize>,
}

/// Why nothing is reported of an agent.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NotCovered {
    /// Its law is another.
    #[error("its torque is not that of (6), but of {law}, whose derivatives are not built")]
    Law {
        /// The law, with an article.
        law: &'static str,
    },
    /// It follows a target.
    #[error("it follows a target of its own, and no switch and no delay reaches its torque")]
    OwnTarget,
    /// A set-valued sign is part of its reference dynamics.
    #[error(
        "{reference} has a set-valued sign, which is set at instants of its own: what the network does is not all that jumps"
    )]
    Sign {
        /// What leads it.
        reference: &'static str,
    },
    /// More derivatives stay continuous than are computed.
    #[error("its reference dynamics have the order {order}; derivatives are computed up to order {most}")]
    Order {
        /// ℓ.
        order: usize,
        /// The most.
        most: usize,
    },
    /// Weights that change stand beside more than the highest derivative.
    #[error("a weight changes with time, and derivatives of weights would enter {reference}")]
    VaryingWeights {
        /// What leads it.
        reference: &'static str,
    },
    /// Derivatives of its reference dynamics are not known.
    #[error("{reference} is not affine in what it measures and in its state, so that its derivatives are not known")]
    NotAffine {
        /// What leads it.
        reference: &'static str,
    },
    /// Its gains cannot be resolved with its robot.
    #[error("its gains cannot be resolved with its robot")]
    Gains,
    /// Its reference dynamics cannot be built.
    #[error(transparent)]
    Reference(Box<SetupError>),
    /// They do not have the shape that they state.
    #[error(transparent)]
    Length(#[from] LengthError),
}

/// The most derivatives.
pub(super) const MOST: usize = size_of::<Series>() / size_of::<f64>();

/// The reference dynamics of an agent, if its torque can be expanded.
pub(super) fn covered(setup: &Setup, agent: usize) -> Result<Dynamics, NotCovered> {
    let own = &setup.agents[agent];
    if !is_lagrangian(own) {
        return Err(NotCovered::Law { law: own.law.words().name });
    }
    if setup.tracks(agent) {
        return Err(NotCovered::OwnTarget);
    }
    let reference = setup.reference.words().name;
    if setup.reference.interface().family == ReferenceFamily::Leader {
        return Err(NotCovered::Sign { reference });
    }
    let order = own.roots_per_s.len();
    if setup.reference.is::<Consensus>() {
        if order > MOST {
            return Err(NotCovered::Order { order, most: MOST });
        }
    } else if varying_weights(setup) {
        return Err(NotCovered::VaryingWeights { reference });
    }
    reference_dynamics(setup, agent).map_err(|error| NotCovered::Reference(Box::new(error)))
}

/// Whether some weight of some graph changes with time.
fn varying_weights(setup: &Setup) -> bool {
    setup.network.schedule.graphs.iter().flatten().any(|edge| matches!(edge.weight, Weight::Formula(_)))
}

impl Covered {
    /// What an agent with so many derivatives is promised.
    pub(super) fn of(setup: &Setup, agent: usize, derivatives: usize) -> Self {
        let order = setup.agents[agent].roots_per_s.len();
        let fixed = setup.network.schedule.constant_graph().is_some();
        let continuous = if setup.reference.is::<Consensus>() {
            Some(order.saturating_sub(1))
        } else if setup.reference.is::<PureIntegral>() && fixed {
            Some(1)
        } else {
            None
        };
        Covered { derivatives, continuous }
    }
}
