//! The `[control]` of a scenario file as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::values::AxisValues;

/// Digital control. At every sample all agents measure, send, hear and compute; torques are held until the next.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ControlFile {
    /// Samples per second, the same for all agents.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sample_hz: At<f64>,
    /// How long after a sample its torque is applied, in s; at most one period. Until then the torque before is held; at the
    /// start there is none. Default: 0.
    #[schemars(range(min = 0))]
    pub computation_delay_s: Option<At<f64>>,
    /// Where velocities come from. Default: they are measured.
    pub velocity: Option<At<VelocityFile>>,
    /// Noise of the measurements. Default: none.
    pub noise: Option<NoiseFile>,
    /// Steps of the measurements and the torques. Default: none.
    pub quantisation: Option<QuantisationFile>,
    /// The largest torque of every axis, or of all, in N m or N. Effort limits of a URDF are enforced by `enforce_limits`.
    pub torque_limit: Option<At<AxisValues>>,
    /// The fastest change of the torque of every axis, or of all, in N m/s or N/s.
    pub torque_rate_limit_per_s: Option<At<AxisValues>>,
    /// What is commanded when a step of a controller fails, since its law divides by something that vanishes; the run then goes
    /// on. Default: the run ends there.
    pub safe_command: Option<At<SafeCommandFile>>,
    /// How old a message may become, in s: the sender of an older one does not count until a newer one arrives. Default: any age.
    #[schemars(range(min = 0))]
    pub message_timeout_s: Option<At<f64>>,
}

/// What is commanded when a step fails.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SafeCommandFile {
    /// The last command.
    Hold,
    /// Zero.
    Zero,
    /// These, one for each input of a controller, within the limits.
    Values(At<Vec<At<f64>>>),
}

/// Where velocities come from.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VelocityFile {
    /// They are measured.
    Measured,
    /// From encoders alone: differences of positions through a first-order low-pass filter.
    FilteredDifference(FilteredDifferenceFile),
}

/// The filter of the velocities.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FilteredDifferenceFile {
    /// Its cut-off, in Hz.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub cut_off_hz: At<f64>,
}

/// Normally distributed noise, independent from sample to sample, in the units of the axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseFile {
    /// The same seed gives the same noise, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// Standard deviation of positions, in rad or m. Default: 0.
    #[schemars(range(min = 0))]
    pub position: Option<At<f64>>,
    /// Standard deviation of velocities, in rad/s or m/s. Default: 0.
    #[schemars(range(min = 0))]
    pub velocity: Option<At<f64>>,
    /// Standard deviation of the velocities of end-effectors, in m/s; for laws that measure them. Default: 0.
    #[schemars(range(min = 0))]
    pub tip_velocity: Option<At<f64>>,
}

/// Steps to the nearest multiple of which values are rounded, in the units of the axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuantisationFile {
    /// Of measured positions, in rad or m. Default: 0, for none.
    #[schemars(range(min = 0))]
    pub position: Option<At<f64>>,
    /// Of measured velocities, in rad/s or m/s. Default: 0, for none.
    #[schemars(range(min = 0))]
    pub velocity: Option<At<f64>>,
    /// Of torques, in N m or N. Default: 0, for none.
    #[schemars(range(min = 0))]
    pub torque: Option<At<f64>>,
}
