//! Control of a tip in a scenario, as it is written. The doc comments of this file are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::file::{DampingFile, EstimateStartFile};
use super::values::{GainFile, GainOrBandwidth, Positive};

/// The tip follows the target with uncertain lengths and parameters, without its velocity: (80) to (82) of the paper.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskSpaceFile {
    /// The tip of a robot from a URDF. A planar arm has one of its own.
    pub tip: Option<At<TipFile>>,
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 20 otherwise.
    pub damping: Option<DampingFile>,
    /// The gain Γ. Default: a bandwidth of 5 1/s for a URDF, 30 otherwise.
    pub adaptation_gain: Option<At<GainOrBandwidth>>,
    /// The estimate of the parameters at the start. Default: zero.
    pub estimate_start: Option<EstimateStartFile>,
    /// The gain K* on the error of the tip in the reference dynamics: a number, a diagonal or a matrix. Default: 20.
    pub task_gain: Option<At<GainFile>>,
    /// The gain κ with which that error enters the torque. Default: 5.
    #[schemars(with = "Option<Positive>")]
    pub torque_share: Option<At<f64>>,
    /// The rate α at which the reference velocity forgets, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub reference_gain_per_s: Option<At<f64>>,
    /// The gain Λ of the lengths: a number, a diagonal or a matrix. Large ones can drive the estimated Jacobian through a
    /// singularity. Default: 0.3.
    pub kinematic_gain: Option<At<GainFile>>,
    /// The estimate of the lengths at the start. Zero would be singular. Default: the true ones times 1.2.
    pub kinematic_start: Option<EstimateStartFile>,
    /// Keeps the estimates of the lengths within bounds. Default: there are none.
    pub bounds: Option<At<BoundsFile>>,
    /// The run ends when det Ĵ falls below this share of its first value. Default: 0.01.
    #[schemars(range(min = 0, max = 1))]
    pub determinant_floor: Option<At<f64>>,
}

/// A point of a link, and what is known of it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TipFile {
    /// The link, by its name in the URDF.
    pub link: At<String>,
    /// The point in the frame of the link, in m. Default: its origin.
    pub at_m: Option<[f64; 3]>,
    /// Which coordinates of the base frame are controlled: as many as joints move. Default: all three.
    #[schemars(length(min = 1, max = 3))]
    pub coordinates: Option<At<Vec<At<CoordinateFile>>>>,
    /// Which lengths are uncertain. Default: the tool.
    pub uncertain: Option<UncertainFile>,
}

/// A coordinate of the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CoordinateFile {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// Which lengths are uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UncertainFile {
    /// From the last joint to the tip.
    Tool,
    /// From each joint to the next as well, for the Jacobian; the regressor of the dynamics keeps the geometry of the URDF, so no
    /// theorem covers those of them that enter it: see what `check` says.
    Chain,
}

/// Bounds of the lengths, an entry for each.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundsFile {
    /// In m.
    pub lower_m: At<Vec<At<f64>>>,
    /// In m.
    pub upper_m: At<Vec<At<f64>>>,
    /// How far beyond an estimate may go before it stands, in m. Default: 0.01.
    #[schemars(with = "Option<Positive>")]
    pub margin_m: Option<At<f64>>,
}
