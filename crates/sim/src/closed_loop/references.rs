//! From reference dynamics as data to those that run. Which dynamics, and what their agents exchange, is known at run time only, and costs
//! one indirect call for a whole population.

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
pub(super) struct Transmission {
    /// What a message holds, vectors with an entry per axis.
    pub(super) signals: &'static [Signal],
    /// The block of the reference state where a message begins; nothing where it is measured.
    pub(super) held: Option<usize>,
}

impl Transmission {
    fn by<X: Exchange>() -> Transmission {
        Transmission { signals: X::SIGNALS, held: X::HELD }
    }

    /// Of what a setup says.
    pub(super) fn of(exchange: setup::Exchange) -> Transmission {
        match exchange {
            setup::Exchange::Position => Transmission::by::<Position>(),
            setup::Exchange::PositionVelocity => Transmission::by::<PositionVelocity>(),
            setup::Exchange::Estimates => Transmission::by::<Estimates>(),
            setup::Exchange::Composite => Transmission::by::<Composite>(),
        }
    }

    /// Vectors in a message.
    pub(super) fn channels(self) -> usize {
        self.signals.len()
    }
}

/// The value for the reference dynamics in `dynamics`, of any exchange.
macro_rules! any {
    ($dynamics:expr, $reference:ident => $value:expr) => {
        match $dynamics {
            Dynamics::Position($reference) => $value,
            Dynamics::PositionVelocity($reference) => $value,
            Dynamics::Estimates($reference) => $value,
            Dynamics::Composite($reference) => $value,
        }
    };
}

/// What [`Reference`] says and does, whatever the agents exchange.
impl Dynamics {
    pub(super) fn transmitted(&self) -> Transmission {
        Transmission::of(self.exchange())
    }

    pub(super) fn vectors(&self) -> usize {
        any!(self, reference => reference.vectors())
    }

    pub(super) fn derivatives(&self) -> usize {
        any!(self, reference => reference.derivatives())
    }

    pub(super) fn sliding(&self) -> Option<&Sliding> {
        any!(self, reference => reference.sliding())
    }

    pub(super) fn is_affine(&self) -> bool {
        any!(self, reference => reference.is_affine())
    }

    /// With what is heard at t.
    pub(super) fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        (t_s, Inputs { degree, sums, .. }): (f64, Inputs<'_>),
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let channel = axes * degree.len();
        any!(self, reference => {
            reference.evaluate(axes, measured, state, Heard::new(degree, sums, channel)?.at(t_s), out)
        })
    }

    pub(super) fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        Inputs { degree, sums, .. }: Inputs<'_>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let channel = axes * degree.len();
        any!(self, reference => reference.start(axes, measured, given, Heard::new(degree, sums, channel)?, state))
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
    length("agents", assembly.agents().len(), any!(&dynamics, reference => reference.agents()))?;
    let (blocks, derivatives) = (dynamics.vectors(), dynamics.derivatives());
    length("derivatives of z in the state", derivatives.min(blocks), derivatives)?;
    if dynamics.sliding().is_some() && setup.following().is_none() {
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
