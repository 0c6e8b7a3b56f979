//! `law.adaptive` and `law.known`: (6) and (7), for robots of Section II-B.

use std::sync::Arc;

use forwardstep_core::law::ParameterBounds;
use forwardstep_sim::{Adaptive, Attachments, Known, Law, RobotSetup};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    At, DampingFile, EstimateStartFile, Fault, GainOrBandwidth, LawKind, LawReader, LawTable, adaptation, damping,
    estimate, positive, values,
};
use crate::scenario::values::Positive;

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

/// Bounds that the estimate is kept within.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EstimateBoundsFile {
    /// Every parameter is known to so large a share of itself, or of a hundredth of the largest alike; a friction F lies between zero and 2 F.
    Within(#[schemars(with = "Positive")] At<f64>),
    /// These.
    Given(GivenBoundsFile),
}

/// Bounds of the estimate, an entry per parameter.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenBoundsFile {
    /// The lowest values.
    pub lower: At<Vec<At<f64>>>,
    /// The highest values.
    pub upper: At<Vec<At<f64>>>,
}

/// How far beyond its bounds an estimate may go in continuous time, as a share of their distance.
const MARGIN: f64 = 0.05;
/// A margin, in the unit of the parameter, over which a rate can fall to zero without making the loop stiff.
const LEAST_MARGIN: f64 = 1e-6;
/// A parameter that is small beside its like is known no better than that share of the largest.
const LEAST: f64 = 0.01;

impl EstimateBoundsFile {
    fn of(&self, robot: &RobotSetup) -> Result<ParameterBounds, Fault> {
        let (lower, upper): (Vec<f64>, Vec<f64>) = match self {
            EstimateBoundsFile::Within(share) => {
                positive("bounds.within", share)?;
                let slack = like(robot).into_iter().zip(&robot.theta);
                let slack = slack.map(|(largest, own)| share.value * own.abs().max(LEAST * largest));
                let ends = robot.theta.iter().zip(slack).map(|(own, slack)| (own - slack, own + slack));
                let mut ends: Vec<(f64, f64)> = ends.collect();
                let frictions = robot.interface().drives.ranges_in(robot.theta.len());
                for k in frictions.into_iter().flat_map(|[.., frictions]| frictions) {
                    ends[k] = (0.0, 2.0 * robot.theta[k]);
                }
                ends.into_iter().unzip()
            }
            EstimateBoundsFile::Given(GivenBoundsFile { lower, upper }) => (values(&lower.value), values(&upper.value)),
        };
        let margin = lower.iter().zip(&upper).map(|(low, high)| (MARGIN * (high - low)).max(LEAST_MARGIN));
        Ok(ParameterBounds { margin: margin.collect(), lower, upper })
    }
}

/// For every parameter the largest of its kind: masses, first moments, inertias of the bodies of a tree, else what a body has; dampings,
/// armatures, frictions.
fn like(robot: &RobotSetup) -> Vec<f64> {
    let interface = robot.interface();
    let of_links = matches!(interface.attachments, Attachments::Links(_));
    let drives = interface.drives.ranges_in(robot.theta.len()).unwrap_or_default();
    let kind = |k: usize| match (drives.iter().position(|own| own.contains(&k)), of_links, k % 10) {
        (Some(drive), ..) => 4 + drive,
        (None, true, 0) => 0,
        (None, true, 1..=3) => 1,
        (None, true, _) => 2,
        (None, false, _) => 3,
    };
    let mut largest = [0.0_f64; 7];
    for (k, own) in robot.theta.iter().enumerate() {
        largest[kind(k)] = largest[kind(k)].max(own.abs());
    }
    (0..robot.theta.len()).map(|k| largest[kind(k)]).collect()
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
        let mut estimate_start = estimate(self.estimate_start.as_ref(), agent);
        if let (None, Some(bounds)) = (&self.estimate_start, &bounds) {
            bounds.project(&mut estimate_start);
        }
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
