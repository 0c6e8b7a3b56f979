//! From agents to reference dynamics. What the agents exchange is a type; which dynamics they have is known at run time
//! only, and costs one indirect call for a whole population.

use std::sync::Arc;

use forwardstep_core::reference::{
    Backstepping, Consensus, Exchange, Following, Heard, Measured, Position, PositionVelocity, PureIntegral, Reference,
    ReferenceOut, Sliding, SmoothFollowing,
};
use forwardstep_core::{Kernel, LengthError, dispatch};

use super::error::SetupError;
use crate::leader::FollowingDesign;
use crate::setup::{ReferenceKind, Setup};

/// Reference dynamics of agents that exchange `X`.
pub(crate) type AnyReference<X> = Arc<dyn Reference<Exchange = X>>;

/// What can be exchanged, with the dynamics that exist for this exchange alone.
pub(crate) trait Transmits: Exchange {
    /// They for `agents` agents, if there are any of this kind.
    fn own(kind: &ReferenceKind, agents: usize) -> Result<Option<AnyReference<Self>>, SetupError>;
}

impl Transmits for Position {
    fn own(kind: &ReferenceKind, agents: usize) -> Result<Option<AnyReference<Self>>, SetupError> {
        let ReferenceKind::Backstepping { filter_s, acceleration_limit } = kind else { return Ok(None) };
        let limit = acceleration_limit.unwrap_or(f64::INFINITY);
        Ok(Some(shared(Backstepping::new((0..agents).map(|_| (*filter_s, limit)))?)))
    }
}

impl Transmits for PositionVelocity {
    fn own(kind: &ReferenceKind, agents: usize) -> Result<Option<AnyReference<Self>>, SetupError> {
        let ReferenceKind::Following(following) = kind else { return Ok(None) };
        let sliding = following.sliding();
        Ok(Some(match following.design {
            FollowingDesign::Continuous => shared(Following::new(agents, sliding)),
            FollowingDesign::Swarm { coupling } => shared(SmoothFollowing::swarm(agents, sliding, coupling)),
            _ => shared(SmoothFollowing::new(agents, sliding)),
        }))
    }
}

/// The reference dynamics of the agents in `group`.
pub(super) fn reference<X: Transmits>(setup: &Setup, group: &[usize]) -> Result<AnyReference<X>, SetupError> {
    let design = |agent: usize| (&setup.agents[agent].roots_per_s[..], setup.agents[agent].manipulability);
    let designs = || group.iter().map(|&agent| design(agent));
    let first = &setup.agents[group[0]];
    let roots = |agent: usize| move |error| SetupError::Roots { agent: setup.agents[agent].name.clone(), error };
    if let ReferenceKind::Consensus | ReferenceKind::PureIntegral = setup.reference {
        // Every agent's own design first, so that the one to blame is named.
        for &agent in group {
            Consensus::<X>::new([design(agent)]).map_err(roots(agent))?;
        }
    }
    match &setup.reference {
        ReferenceKind::Consensus => Ok(shared(Consensus::<X>::new(designs()).map_err(roots(group[0]))?)),
        ReferenceKind::PureIntegral => Ok(shared(PureIntegral::<X>::new(designs()).map_err(roots(group[0]))?)),
        kind => X::own(kind, group.len())?.ok_or_else(|| SetupError::wrong_reference(setup, first)),
    }
}

fn shared<F: Reference>(reference: F) -> AnyReference<F::Exchange> {
    Arc::new(Dispatched(reference))
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
