//! A leader as it is written. The doc comments of this file are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::systems_file::TargetFile;
use super::values::Positive;

/// A leader: a motion without a robot.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeaderFile {
    /// Its name, as edges name it. Default: `leader`.
    pub name: Option<At<String>>,
    /// Where it is over time.
    pub motion: At<TargetFile>,
}

/// Reference dynamics that follow a leader, and the set-valued sign in them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeaderReferenceFile {
    /// Which of the designs.
    pub design: At<LeaderDesignFile>,
    /// The positive numbers κ in 1/s: one for `continuous`, α = κ₀; two for the others, β = κ₀ + κ₁ and α = κ₀ κ₁.
    #[schemars(with = "Vec<Positive>", length(min = 1, max = 2))]
    pub roots_per_s: At<Vec<At<f64>>>,
    /// The factor k of the differences to neighbours; for `swarm`, which needs it.
    #[schemars(with = "Option<Positive>")]
    pub coupling: Option<At<f64>>,
    /// The gain γ of the sign, in rad/s² or m/s² for `continuous`, else in rad/s³ or m/s³. It must exceed what drives the
    /// leader: see what `check` says.
    #[schemars(with = "Positive")]
    pub gain: At<f64>,
    /// How a value of the sign is chosen. Default: implicit.
    pub sign: Option<At<SignFile>>,
    /// How often the sign is set when control is continuous, in s. Default: 0.001. Sampled controllers set it at every sample.
    #[schemars(with = "Option<Positive>")]
    pub sign_period_s: Option<At<f64>>,
}

/// The designs that follow a leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LeaderDesignFile {
    /// (110), Theorem 8: the sign acts on the reference acceleration.
    Continuous,
    /// (119), Theorem 9: torques are differentiable; accelerations are transmitted.
    Differentiable,
    /// (122), Remark 12: torques are differentiable; reference accelerations are transmitted instead.
    WithoutAcceleration,
    /// Swarm tracking over an undirected graph, with differences to neighbours only; not printed in the paper.
    Swarm,
}

/// How a value of a set-valued sign is chosen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SignFile {
    /// Such that it suits the end of the period: no chatter.
    Implicit,
    /// By the start of the period; for comparison: it chatters.
    Explicit,
    /// A straight line between −width and width at every instant; for comparison: an error of that size stays.
    BoundaryLayer(LayerFile),
}

/// A boundary layer.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayerFile {
    /// Its width ε, in the unit of what the sign is taken of.
    #[schemars(with = "Positive")]
    pub width: At<f64>,
}
