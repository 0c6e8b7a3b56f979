//! The `[network]` of a scenario file as it is written.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::edges_file::EdgesFile;
use super::links_file::{LogFile, PacketsFile, RandomHoldFile, WeightFile};
use super::values::{NotNegative, Positive};

/// Who hears whom, when, and how late: one graph (`edges`) or several in turn (`phases`).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["edges"] }, { "required": ["phases"] }]))]
pub struct NetworkFile {
    /// The weight of every edge that has none of its own: a number, or a formula in t. Default: 1.
    pub weight: Option<At<WeightFile>>,
    /// The delay of every edge that has none of its own. Default: none.
    pub delay: Option<At<DelayFile>>,
    /// How strongly a disagreement acts: bounded or saturated for a nonlinear protocol. Default: in proportion. Only with
    /// `exchange = "position"`.
    pub coupling: Option<At<CouplingFile>>,
    /// The edges of a graph that never changes.
    pub edges: Option<At<EdgesFile>>,
    /// How the phases follow each other. Default: repeat.
    pub switching: Option<At<SwitchingFile>>,
    /// The graphs of a network that switches.
    #[schemars(length(min = 1))]
    pub phases: Option<At<Vec<At<PhaseFile>>>>,
}

/// What takes the place of a disagreement v between two agents; each is v itself where v is small. In rad or m.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CouplingFile {
    /// v, but at most this.
    Saturated(#[schemars(with = "Positive")] At<f64>),
    /// a tanh(v/a), for this a.
    Tanh(#[schemars(with = "Positive")] At<f64>),
    /// v/(1 + |v|/a), for this a.
    Rational(#[schemars(with = "Positive")] At<f64>),
}

/// A graph that stays in force for a while.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PhaseFile {
    /// How long, in s. Not used by the last phase of a network that switches `once`, nor by random switching.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub dwell_s: Option<At<f64>>,
    /// Its edges.
    pub edges: At<EdgesFile>,
}

/// How the phases of a network follow each other.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SwitchingFile {
    /// In turn, again and again.
    Repeat,
    /// In turn; the last one stays for ever.
    Once,
    /// Drawn at random.
    Random(RandomSwitchingFile),
}

/// At every switch one of the phases is drawn, each equally likely.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomSwitchingFile {
    /// The same seed gives the same switches, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// Shortest and longest dwell, in s.
    #[schemars(with = "[Positive; 2]")]
    pub dwell_s: At<[At<f64>; 2]>,
}

/// How old a message is when it is heard.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DelayFile {
    /// Always the same, in s.
    ConstantS(#[schemars(with = "NotNegative")] At<f64>),
    /// mean + amplitude · sin(2π t / period + phase).
    Sinusoid(SinusoidFile),
    /// Jumps from value to value.
    PiecewiseConstant(PiecewiseConstantFile),
    /// Rises from min to max over every period, then drops.
    SawTooth(SawToothFile),
    /// A formula in t, in s, such as "0.2 + 0.1*sin(2*pi*t/3)"; it must be shown not to become negative. It may contain
    /// t, pi, e, + - * / ^, sin, cos, exp, log, sqrt, abs, tanh, atan, min and max.
    FormulaS(At<String>),
    /// Random values, each held for a random time.
    RandomHold(RandomHoldFile),
    /// Packets that are late, lost and overtaken; the newest that has arrived is heard.
    Packets(PacketsFile),
    /// Packets replayed from a CSV file.
    Log(LogFile),
}

/// A delay that swings.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SinusoidFile {
    /// In s.
    #[schemars(range(min = 0))]
    pub mean_s: At<f64>,
    /// In s; at most the mean.
    #[schemars(range(min = 0))]
    pub amplitude_s: At<f64>,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: At<f64>,
    /// In rad. Default: 0.
    #[serde(default)]
    pub phase_rad: f64,
}

/// A delay that jumps.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiecewiseConstantFile {
    /// When each value begins, in s; rising from 0.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    pub times_s: At<Vec<At<f64>>>,
    /// The values, in s; as many as times.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    pub values_s: At<Vec<At<f64>>>,
    /// Begin again after this long, in s. Default: the last value stays.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: Option<At<f64>>,
}

/// A delay that rises and drops.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SawToothFile {
    /// In s.
    #[schemars(range(min = 0))]
    pub min_s: At<f64>,
    /// In s.
    #[schemars(range(min = 0))]
    pub max_s: At<f64>,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: At<f64>,
    /// How far the first tooth has come at t = 0, in s. Default: 0.
    #[serde(default)]
    pub offset_s: f64,
}
