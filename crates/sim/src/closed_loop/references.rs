//! From reference dynamics as data to those that run. What the agents exchange is a type; which dynamics they have is known at run
//! time only, and costs one indirect call for a whole population.

use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::reference::{Composite, Estimates, Exchange, Position, PositionVelocity, Reference};

use super::assembly::Assembly;
use super::error::SetupError;
use crate::reference::Dynamics;
use crate::setup::{self, Setup};

/// Reference dynamics of agents that exchange `X`.
pub(crate) type AnyReference<X> = Arc<dyn Reference<Exchange = X>>;

/// What can be exchanged.
pub(crate) trait Transmits: Exchange {
    /// The dynamics, if their agents exchange this.
    fn of(dynamics: Dynamics) -> Option<AnyReference<Self>>;
}

impl Transmits for Position {
    fn of(dynamics: Dynamics) -> Option<AnyReference<Self>> {
        if let Dynamics::Position(reference) = dynamics { Some(reference) } else { None }
    }
}

impl Transmits for PositionVelocity {
    fn of(dynamics: Dynamics) -> Option<AnyReference<Self>> {
        if let Dynamics::PositionVelocity(reference) = dynamics { Some(reference) } else { None }
    }
}

impl Transmits for Estimates {
    fn of(dynamics: Dynamics) -> Option<AnyReference<Self>> {
        if let Dynamics::Estimates(reference) = dynamics { Some(reference) } else { None }
    }
}

impl Transmits for Composite {
    fn of(dynamics: Dynamics) -> Option<AnyReference<Self>> {
        if let Dynamics::Composite(reference) = dynamics { Some(reference) } else { None }
    }
}

/// The reference dynamics of the agents of `assembly`.
pub(super) fn reference<X: Transmits>(assembly: &Assembly<'_>) -> Result<AnyReference<X>, SetupError> {
    let setup = assembly.setup();
    let name = setup.reference.words().name;
    let reference = X::of(setup.reference.dynamics(assembly)?)
        .ok_or(SetupError::ReferenceExchange { reference: name, exchange: setup.exchange })?;
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::ReferenceShape { reference: name, error })
    };
    length("agents", assembly.agents().len(), reference.agents())?;
    let (blocks, derivatives) = (reference.vectors(), reference.derivatives());
    length("derivatives of z in the state", derivatives.min(blocks), derivatives)?;
    if reference.sliding().is_some() && setup.following().is_none() {
        return Err(SetupError::SignWithoutLeader { reference: name });
    }
    Ok(reference)
}

/// The reference dynamics of one agent by itself, by its number.
///
/// # Errors
/// [`SetupError`] when they have no meaning, or no agent has this number.
pub fn reference_dynamics(setup: &Setup, agent: usize) -> Result<Dynamics, SetupError> {
    if agent >= setup.agents.len() {
        return Err(SetupError::NoAgent { agent, agents: setup.agents.len() });
    }
    let agents = [agent];
    let assembly = Assembly::new(setup, &agents);
    Ok(match setup.exchange {
        setup::Exchange::Position => Dynamics::Position(reference(&assembly)?),
        setup::Exchange::PositionVelocity => Dynamics::PositionVelocity(reference(&assembly)?),
        setup::Exchange::Estimates => Dynamics::Estimates(reference(&assembly)?),
        setup::Exchange::Composite => Dynamics::Composite(reference(&assembly)?),
    })
}
