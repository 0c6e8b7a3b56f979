//! No agreement: every agent follows a target of its own.

use super::{Dynamics, LinearReference, ReferenceDynamics, ReferenceFamily, ReferenceInterface, ReferenceWords, Roots};
use crate::closed_loop::{Assembly, SetupError};
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::Known;

/// Nothing is agreed upon: every agent follows a target of its own, by a law that has reference dynamics of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tracking;

impl ReferenceDynamics for Tracking {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "following a target", key: "tracking" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Target,
            exchanges: &[Exchange::Position, Exchange::PositionVelocity],
            roots: Roots::ByLaw,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    fn free_derivatives(&self, roots: usize) -> usize {
        // Without roots there is z alone.
        roots.max(1)
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    /// The law has the reference dynamics, not this.
    fn linear(&self, _: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        None
    }

    fn check(&self, _: &Setup) -> Result<(), SetupError> {
        Ok(())
    }

    /// A law that takes its reference from others is not led by a target.
    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        Err(assembly.wrong_reference())
    }
}
