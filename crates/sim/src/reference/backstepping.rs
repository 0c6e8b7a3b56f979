//! The baseline (aa6), which differentiates what it hears.

use forwardstep_core::reference;

use super::{Dynamics, LinearReference, ReferenceDynamics, ReferenceFamily, ReferenceInterface, ReferenceWords, Roots};
use crate::closed_loop::{Assembly, SetupError};
use crate::quantity::positive;
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::Known;

/// The baseline (aa6): exchanges positions, has no roots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backstepping {
    /// Time constant ε of the filter that differentiates, s.
    pub filter_s: f64,
    /// Limit of the reference acceleration, rad/s² or m/s²; none for no limit.
    pub acceleration_limit: Option<f64>,
}

impl ReferenceDynamics for Backstepping {
    fn words(&self) -> ReferenceWords {
        ReferenceWords { name: "the backstepping baseline", key: "backstepping" }
    }

    fn interface(&self) -> ReferenceInterface {
        ReferenceInterface {
            family: ReferenceFamily::Backstepping,
            exchanges: &[Exchange::Position],
            roots: Roots::None,
            manipulability: false,
            nonlinear_coupling: false,
        }
    }

    /// None of z, but what its filter holds.
    fn free_derivatives(&self, _: usize) -> usize {
        1
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    /// z is no state: it follows what is heard through a filter.
    fn linear(&self, _: &AgentSetup, _: Exchange) -> Option<LinearReference> {
        None
    }

    fn check(&self, _: &Setup) -> Result<(), SetupError> {
        let at = "reference.backstepping";
        positive(at, "filter_s", self.filter_s)?;
        Ok(self.acceleration_limit.map_or(Ok(()), |limit| positive(at, "acceleration_limit", limit))?)
    }

    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError> {
        let each = (self.filter_s, self.acceleration_limit.unwrap_or(f64::INFINITY));
        let agents = || assembly.agents().iter().map(|agent| &assembly.setup().agents[*agent]);
        let starts = agents().map(|agent| agent.start.reference.first().cloned());
        let filters = reference::Backstepping::new(agents().map(|_| each))?.starting_at(starts);
        Ok(Dynamics::position(filters))
    }
}
