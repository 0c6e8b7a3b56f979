//! `bounds` of laws that estimate parameters: what their estimates are kept within.

use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_sim::{Attachments, RobotSetup};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{At, EstimateStartFile, Fault, LawReader, estimate, length, positive, values};
use crate::scenario::values::Positive;

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
    /// Those of a robot.
    pub(super) fn of(&self, robot: &RobotSetup) -> Result<ParameterBounds, Fault> {
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

impl EstimateBoundsFile {
    /// Those of a robot of which one number is estimated.
    pub(super) fn of_mass(&self, robot: &RobotSetup, whose: &str) -> Result<Range, Fault> {
        if let EstimateBoundsFile::Given(GivenBoundsFile { lower, upper }) = self {
            length("lower", &lower.span, lower.value.len(), 1, whose)?;
            length("upper", &upper.span, upper.value.len(), 1, whose)?;
        }
        Ok(self.of(robot)?.range(0))
    }
}

/// Where an estimate starts: at zero, or the nearest within the bounds, unless a file says otherwise.
pub(super) fn started(
    file: Option<&EstimateStartFile>,
    bounds: Option<&ParameterBounds>,
    agent: &LawReader<'_>,
) -> Vec<f64> {
    let mut start = estimate(file, agent);
    if let (None, Some(bounds)) = (file, bounds) {
        bounds.project(&mut start);
    }
    start
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
