//! From reference dynamics as data to those that run. Which dynamics, and what their agents exchange, is known at run time only, and costs
//! two indirect calls for a whole population.

use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::reference::{
    Composite, Estimates, Exchange, Heard, Measured, Position, PositionVelocity, Reference, ReferenceOut, Sliding,
};

use super::assembly::Assembly;
use super::columns::Inputs;
use super::error::SetupError;
use crate::recording::Signal;
use crate::reference::Dynamics;
use crate::setup::{self, Setup};

/// What agents tell each other.
#[derive(Clone, Copy)]
pub(super) struct Told {
    /// What a message holds, vectors with an entry per axis.
    pub(super) signals: &'static [Signal],
    /// The block of the reference state where a message begins; nothing where it is measured.
    pub(super) held: Option<usize>,
}

impl Told {
    fn by<X: Exchange>() -> Told {
        Told { signals: X::SIGNALS, held: X::HELD }
    }

    /// Of what a setup says.
    pub(super) fn of(exchange: setup::Exchange) -> Told {
        match exchange {
            setup::Exchange::Position => Told::by::<Position>(),
            setup::Exchange::PositionVelocity => Told::by::<PositionVelocity>(),
            setup::Exchange::Estimates => Told::by::<Estimates>(),
            setup::Exchange::Composite => Told::by::<Composite>(),
        }
    }

    /// Vectors in a message.
    pub(super) fn channels(self) -> usize {
        self.signals.len()
    }
}

/// Reference dynamics, whatever their agents exchange; see [`Reference`].
pub(super) trait Leads {
    fn told(&self) -> Told;
    fn agents(&self) -> usize;
    fn vectors(&self) -> usize;
    fn derivatives(&self) -> usize;
    fn sliding(&self) -> Option<&Sliding>;
    fn is_affine(&self) -> bool;
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: (f64, Inputs<'_>),
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError>;
    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Inputs<'_>,
        state: &mut [f64],
    ) -> Result<(), LengthError>;
}

impl<X: Exchange> Leads for Arc<dyn Reference<Exchange = X>> {
    fn told(&self) -> Told {
        Told::by::<X>()
    }

    fn agents(&self) -> usize {
        Reference::agents(self)
    }

    fn vectors(&self) -> usize {
        Reference::vectors(self)
    }

    fn derivatives(&self) -> usize {
        Reference::derivatives(self)
    }

    fn sliding(&self) -> Option<&Sliding> {
        Reference::sliding(self)
    }

    fn is_affine(&self) -> bool {
        Reference::is_affine(self)
    }

    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        (t_s, inputs): (f64, Inputs<'_>),
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let heard = Heard::new(inputs.degree, inputs.sums, axes * Reference::agents(self))?.at(t_s);
        Reference::evaluate(self, axes, measured, state, heard, out)
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        inputs: Inputs<'_>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let heard = Heard::new(inputs.degree, inputs.sums, axes * Reference::agents(self))?;
        Reference::start(self, axes, measured, given, heard, state)
    }
}

impl Dynamics {
    /// Whatever their agents exchange.
    pub(super) fn leads(&self) -> &dyn Leads {
        match self {
            Dynamics::Position(reference) => reference,
            Dynamics::PositionVelocity(reference) => reference,
            Dynamics::Estimates(reference) => reference,
            Dynamics::Composite(reference) => reference,
        }
    }

    fn exchange(&self) -> setup::Exchange {
        match self {
            Dynamics::Position(_) => setup::Exchange::Position,
            Dynamics::PositionVelocity(_) => setup::Exchange::PositionVelocity,
            Dynamics::Estimates(_) => setup::Exchange::Estimates,
            Dynamics::Composite(_) => setup::Exchange::Composite,
        }
    }
}

/// The reference dynamics of the agents of `assembly`.
pub(super) fn dynamics(assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
    let setup = assembly.setup();
    let name = setup.reference.words().name;
    let dynamics = setup.reference.dynamics(assembly)?;
    if dynamics.exchange() != setup.exchange {
        return Err(SetupError::ReferenceExchange { reference: name, exchange: setup.exchange });
    }
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::ReferenceShape { reference: name, error })
    };
    let reference = dynamics.leads();
    length("agents", assembly.agents().len(), reference.agents())?;
    let (blocks, derivatives) = (reference.vectors(), reference.derivatives());
    length("derivatives of z in the state", derivatives.min(blocks), derivatives)?;
    if reference.sliding().is_some() && setup.following().is_none() {
        return Err(SetupError::SignWithoutLeader { reference: name });
    }
    Ok(dynamics)
}

/// The reference dynamics of one agent by itself, by its number.
///
/// # Errors
/// [`SetupError`] when they have no meaning, or no agent has this number.
pub fn reference_dynamics(setup: &Setup, agent: usize) -> Result<Dynamics, SetupError> {
    if agent >= setup.agents.len() {
        return Err(SetupError::NoAgent { agent, agents: setup.agents.len() });
    }
    dynamics(&Assembly::new(setup, &[agent]))
}
