//! Chains of Section IV and the laws for them, as they are written. The doc comments of this file are descriptions of the
//! published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::file::EstimateStartFile;
use super::values::{AxisValues, Positive};

/// A plant whose derivative of some order is χ + ψ u; formulas are in x, dx, d2x, d3x, ….
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChainFile {
    /// The order k.
    #[schemars(range(min = 1, max = 8))]
    pub order: At<i64>,
    /// What is known of χ. Default: 0.
    pub chi: Option<At<String>>,
    /// ψ, which must stay away from zero. Default: 1.
    pub psi: Option<At<String>>,
    /// What the parameters are multiplied by in χ, a formula for each.
    #[serde(default)]
    pub regressor: At<Vec<At<String>>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

/// A chain in strict-feedback form: the rate of x1 is x2 and parameters times functions of x1, the rate of x2 is x3 and
/// parameters times functions of x1 and x2, and so on; the last rate has the input in place of the next state.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StrictFeedbackFile {
    /// For each equation what the parameters are multiplied by: a formula in x1, x2, … for each parameter.
    #[schemars(length(min = 1, max = 6))]
    pub regressors: At<Vec<At<Vec<At<String>>>>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

/// A chain in pure-feedback form: the next state may enter the rate of each in any way.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PureFeedbackFile {
    /// For each equation what is known: a formula in the states up to the next one.
    #[schemars(length(min = 1, max = 6))]
    pub known: At<Vec<At<String>>>,
    /// For each equation what the parameters are multiplied by.
    #[schemars(length(min = 1, max = 6))]
    pub regressors: At<Vec<At<Vec<At<String>>>>>,
    /// What the input is multiplied by in the last equation. Default: 1.
    pub psi: Option<At<String>>,
    /// The true parameters.
    #[serde(default)]
    pub parameters: At<Vec<At<f64>>>,
}

/// Feedback linearisation of a chain of derivatives, with the true parameters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearisingFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The run ends where ψ comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

/// The adaptive law for a chain of derivatives.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearAdaptiveFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero.
    pub estimate_start: Option<EstimateStartFile>,
    /// The run ends where ψ comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

/// Immersion and invariance for a chain of derivatives.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImmersionFile {
    /// How fast the tracking error vanishes, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub gain_per_s: Option<At<f64>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero.
    pub estimate_start: Option<EstimateStartFile>,
    /// For each parameter a formula whose derivative by the highest derivative of x is the regressor. Default: the regressor
    /// times that derivative, for regressors without it.
    pub antiderivatives: Option<At<Vec<At<String>>>>,
    /// The run ends where ψ comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}

/// Adaptive backstepping for a chain in strict-feedback or pure-feedback form.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveBacksteppingFile {
    /// The gains of the steps in 1/s, one for all or one for each. Default: 1.
    pub gains_per_s: Option<At<AxisValues>>,
    /// The gain Γ, one for all parameters or one for each. Default: 1.
    pub adaptation_gain: Option<At<AxisValues>>,
    /// The estimate at the start. Default: zero.
    pub estimate_start: Option<EstimateStartFile>,
    /// The run ends where the factor of the input in the last step comes closer to zero. Default: 1e-3.
    #[schemars(with = "Option<Positive>")]
    pub floor: Option<At<f64>>,
}
