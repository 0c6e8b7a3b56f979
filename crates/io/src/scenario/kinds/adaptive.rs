//! `law.adaptive` and `law.known`: (6) and (7), for robots of Section II-B.

use std::sync::Arc;

use forwardstep_sim::{Adaptive, Known, Law, RobotSetup};
use schemars::JsonSchema;
use serde::Deserialize;

use super::bounds::{EstimateBoundsFile, started};
use super::{
    At, DampingFile, EstimateStartFile, Fault, GainOrBandwidth, LawKind, LawReader, LawTable, adaptation, damping,
};

/// The adaptive tracking law.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveFile {
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 8 otherwise.
    pub damping: Option<DampingFile>,
    /// The gain Γ. Default: a bandwidth of 5 1/s for a URDF, 10 otherwise.
    pub adaptation_gain: Option<At<GainOrBandwidth>>,
    /// The estimate at the start. Default: zero, or the nearest within the bounds.
    pub estimate_start: Option<EstimateStartFile>,
    /// Bounds that the estimate is kept within. Default: none. What disturbs a loop for long, as dry friction does, makes estimates drift
    /// without.
    pub bounds: Option<EstimateBoundsFile>,
}

impl LawKind for AdaptiveFile {
    fn table() -> LawTable {
        LawTable {
            key: "adaptive",
            description: "The parameters of the robot are unknown and estimated: (6) and (7) of the paper.",
            made_for: "arms and point masses",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.lagrangian().is_some()
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let bounds = self.bounds.as_ref().map(|bounds| bounds.of(agent.robot)).transpose()?;
        let estimate_start = started(self.estimate_start.as_ref(), bounds.as_ref(), agent);
        Ok(Arc::new(Adaptive {
            damping: damping(self.damping.as_ref(), agent)?,
            adaptation: adaptation(self.adaptation_gain.as_ref(), agent)?,
            estimate_start,
            bounds,
        }))
    }
}

/// The tracking law with known parameters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KnownFile {
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 8 otherwise.
    pub damping: Option<DampingFile>,
}

impl LawKind for KnownFile {
    fn table() -> LawTable {
        LawTable {
            key: "known",
            description: "The parameters of the robot are known.",
            made_for: "arms and point masses",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.lagrangian().is_some()
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(Known { damping: damping(self.damping.as_ref(), agent)? }))
    }
}
