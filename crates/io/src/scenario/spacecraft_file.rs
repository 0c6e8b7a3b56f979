//! Spacecraft in a scenario, as they are written. The doc comments of this file are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::values::{GainFile, Positive};

/// A spacecraft that turns itself by reaction wheels.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpacecraftFile {
    /// The inertia of the body with the wheels, less the inertia of each wheel about its own axis, in kg m²: the diagonal, or the
    /// rows of a symmetric matrix.
    pub inertia_kg_m2: At<GainFile>,
    /// At least three, whose axes are not in one plane. Default: three along the axes of the body, without limits.
    #[schemars(with = "Option<Vec<WheelFile>>", length(min = 3))]
    pub wheels: Option<At<Vec<At<WheelFile>>>>,
}

/// A reaction wheel. Limits are reported, and kept where the agent says `enforce_limits = true`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelFile {
    /// Its axis in the body, of any length.
    pub axis: At<[f64; 3]>,
    /// The largest torque of its motor, in N m. Default: none.
    #[schemars(with = "Option<Positive>")]
    pub torque_limit_n_m: Option<At<f64>>,
    /// The largest momentum it can hold, in N m s. Default: none.
    #[schemars(with = "Option<Positive>")]
    pub momentum_limit_n_m_s: Option<At<f64>>,
}

/// Where a spacecraft starts. Default: at rest, aligned with the inertial frame, wheels still.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpacecraftStartFile {
    /// Turned about this axis, of any length.
    pub axis: Option<At<[f64; 3]>>,
    /// By this angle, in rad.
    pub angle_rad: Option<At<f64>>,
    /// Or the attitude as a quaternion of any length, vector part first.
    pub quaternion: Option<At<[f64; 4]>>,
    /// Angular velocity in coordinates of the body, in rad/s.
    pub rate_rad_s: Option<At<[f64; 3]>>,
    /// Momentum of each wheel about its axis, in N m s.
    pub wheel_momentum_n_m_s: Option<At<Vec<At<f64>>>>,
}

/// Attitude tracking without angular velocity: (97) to (105) of the paper.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AttitudeFile {
    /// The gain α₁ on the attitude error, in 1/s². Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub error_gain_per_s2: Option<At<f64>>,
    /// The gain α₂ on the rate error, in 1/s. Default: 2.
    #[schemars(with = "Option<Positive>")]
    pub rate_gain_per_s: Option<At<f64>>,
    /// The gain Λ_f of the filter, in 1/s: a number, four, or a 4 × 4 matrix. Default: 1.
    pub filter_gain_per_s: Option<At<GainFile>>,
    /// The gain K of what stands in for the angular velocity: a number, four, or a 4 × 4 matrix. Default: 3.
    pub damping: Option<At<GainFile>>,
}
