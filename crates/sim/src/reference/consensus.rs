//! The family (aa10), (a1), (a5), (24), and its pure integrals (3), (23): agents with roots of their own.

use forwardstep_core::LengthError;
use forwardstep_core::reference::{self, Position, PositionVelocity, Reference, RootSet, RootsError};

use super::{Dynamics, LinearReference, ReferenceDynamics, ReferenceFamily, ReferenceInterface, ReferenceWords, Roots};
use crate::closed_loop::{Assembly, SetupError};
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::Known;

/// What agents can exchange.
const EXCHANGES: &[Exchange] = &[Exchange::Position, Exchange::PositionVelocity];

/// The family (aa10), (a1), (a5), (24).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Consensus;

impl ReferenceDynamics for Consensus {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "the consensus family", key: "consensus" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Consensus,
            exchanges: EXCHANGES,
            roots: Roots::Every,
            manipulability: true,
            nonlinear_coupling: true,
        }
    }

    fn free_derivatives(&self, roots: usize) -> usize {
        roots
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn linear(&self, agent: &AgentSetup, exchange: Exchange) -> Option<LinearReference> {
        LinearReference::consensus(agent, exchange, 2)
    }

    fn check(&self, _: &Setup) -> Result<(), SetupError> {
        Ok(())
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        Ok(match assembly.setup().exchange {
            Exchange::Position => Dynamics::position(designed(assembly, reference::Consensus::<Position>::new)?),
            Exchange::PositionVelocity => {
                Dynamics::position_velocity(designed(assembly, reference::Consensus::<PositionVelocity>::new)?)
            }
            Exchange::Estimates | Exchange::Composite => return Err(assembly.wrong_reference()),
        })
    }
}

/// The order of (3) and (23).
const ORDER: usize = 2;

/// (3) or, when only positions are exchanged, (23): order two, fixed graphs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PureIntegral;

impl ReferenceDynamics for PureIntegral {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "the pure integral", key: "pure_integral" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface { family: ReferenceFamily::PureIntegral, nonlinear_coupling: false, ..Consensus.interface() }
    }

    fn free_derivatives(&self, _: usize) -> usize {
        ORDER
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn linear(&self, agent: &AgentSetup, exchange: Exchange) -> Option<LinearReference> {
        LinearReference::consensus(agent, exchange, 3)
    }

    fn check(&self, setup: &Setup) -> Result<(), SetupError> {
        setup.agents.iter().try_for_each(|agent| {
            LengthError::check("the list of roots", ORDER, agent.roots_per_s.len())
                .map_err(|error| SetupError::RootCount { agent: agent.name.clone(), error })
        })
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        Ok(match assembly.setup().exchange {
            Exchange::Position => Dynamics::position(designed(assembly, reference::PureIntegral::<Position>::new)?),
            Exchange::PositionVelocity => {
                Dynamics::position_velocity(designed(assembly, reference::PureIntegral::<PositionVelocity>::new)?)
            }
            Exchange::Estimates | Exchange::Composite => return Err(assembly.wrong_reference()),
        })
    }
}

/// Roots and λ of one agent.
type Design<'a> = (&'a RootSet, f64);

/// Reference dynamics from the designs of all agents.
fn designed<'a, R: Reference>(
    assembly: &Assembly<'a>,
    new: fn(Vec<Design<'a>>) -> Result<R, RootsError>,
) -> Result<R, SetupError> {
    let agents = || assembly.agents().iter().map(|agent| &assembly.setup().agents[*agent]);
    let roots = |agent: &str, error| SetupError::Roots { agent: agent.to_owned(), error };
    // Every agent's own design first, so that the one to blame is named.
    for agent in agents() {
        new(vec![(&agent.roots_per_s, agent.manipulability)]).map_err(|error| roots(&agent.name, error))?;
    }
    let designs = agents().map(|agent| (&agent.roots_per_s, agent.manipulability)).collect();
    new(designs).map_err(|error| roots(&assembly.agent().name, error))
}
