//! From reference dynamics as data to those that run. What the agents exchange is a type; which dynamics they have is known at run
//! time only, and costs one indirect call for a whole population.

use std::sync::Arc;

use forwardstep_core::reference::{
    Estimates, Exchange, Heard, Measured, Position, PositionVelocity, Reference, ReferenceOut, Sliding,
};
use forwardstep_core::{Kernel, LengthError, dispatch};

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
    Ok(Arc::new(Dispatched(reference)))
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
    })
}

/// Reference dynamics whose right-hand side is compiled for every instruction set, as nothing can be inlined into it from
/// behind a pointer.
struct Dispatched<F>(F);

impl<F: Reference> Reference for Dispatched<F> {
    type Exchange = F::Exchange;

    fn agents(&self) -> usize {
        self.0.agents()
    }

    fn vectors(&self) -> usize {
        self.0.vectors()
    }

    fn derivatives(&self) -> usize {
        self.0.derivatives()
    }

    fn sliding(&self) -> Option<&Sliding> {
        self.0.sliding()
    }

    fn is_affine(&self) -> bool {
        self.0.is_affine()
    }

    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, F::Exchange>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        dispatch(Evaluate { reference: &self.0, axes, measured, state, heard, out })
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        given: &[f64],
        heard: Heard<'_, F::Exchange>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.0.start(axes, measured, given, heard, state)
    }
}

struct Evaluate<'a, 'h, F: Reference> {
    reference: &'a F,
    axes: usize,
    measured: Measured<'a>,
    state: &'a [f64],
    heard: Heard<'h, F::Exchange>,
    out: ReferenceOut<'a>,
}

impl<F: Reference> Kernel for Evaluate<'_, '_, F> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.reference.evaluate(self.axes, self.measured, self.state, self.heard, self.out)
    }
}
