//! What Section V adds to a scenario, as it is written: targets. The doc comments of this file
//! are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::attitude_file::AttitudeStartFile;
use super::push_file::FunctionFile;

/// Where an agent should be over time; among agents that agree, its offset from where all of them are.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TargetFile {
    /// A number or a formula in t for every axis, in rad or m.
    Formulas(At<Vec<At<FunctionFile>>>),
    /// A constant and sinusoids for every axis, whose bounds are known for ever.
    Sinusoids(At<Vec<SwingFile>>),
    /// The smoothest curve through points, at rest before the first and after the last. It has four derivatives, so that no more
    /// roots can follow it; the others have as many as are asked for.
    Points(PointsFile),
    /// The same through points of a table.
    Csv(TargetCsvFile),
    /// Position and orientation of an end-effector of which both follow.
    Pose(PoseTargetFile),
}

/// Where an end-effector should be and how it should be turned, in the base.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PoseTargetFile {
    /// A number or a formula in t for each of x, y and z, in m.
    pub position: At<Vec<At<FunctionFile>>>,
    /// The orientation of the link at the start. Default: that of the base.
    pub attitude: Option<At<AttitudeStartFile>>,
    /// How it turns from there on. Default: not at all.
    pub turning: Option<TurningFile>,
}

/// A constant angular velocity.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurningFile {
    /// About this axis of the base, of any length.
    pub axis: At<[f64; 3]>,
    /// At this rate, in rad/s.
    pub rad_per_s: At<f64>,
}

/// A constant and sinusoids.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwingFile {
    /// What it swings about, in rad or m. Default: 0.
    pub offset: Option<At<f64>>,
    /// What swings.
    #[serde(default)]
    pub waves: Vec<WaveFile>,
}

/// amplitude · sin(rate · t + phase).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WaveFile {
    /// In rad or m.
    pub amplitude: At<f64>,
    /// The angular rate, in rad/s.
    pub rad_per_s: At<f64>,
    /// In rad. Default: 0.
    pub phase_rad: Option<At<f64>>,
}

/// A table of points.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TargetCsvFile {
    /// The CSV file, beside the scenario file or in `inputs` beside it. Its first line names its columns: `t_s`, rising, and one
    /// for each axis by its name; of the end-effector of a robot `x`, `y`, `z`, and of its orientation `q_x`, `q_y`,
    /// `q_z`, `q_o`; of the quaternion of a spacecraft `x`, `y`, `z` and, for
    /// the scalar part, `o`.
    pub file: At<String>,
}

/// Points that a curve goes through.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointsFile {
    /// When, in s; rising.
    #[schemars(length(min = 1))]
    pub times_s: At<Vec<At<f64>>>,
    /// Where, a list with an entry per axis for every time, in rad or m.
    pub positions: At<Vec<At<Vec<At<f64>>>>>,
}
