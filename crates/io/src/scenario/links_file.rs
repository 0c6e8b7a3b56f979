//! Delays of links as they are written: formulas, random holds, packets and logs; and weights.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

use super::at::At;
use super::values::{NotNegative, Positive};

/// A delay that takes a new value after a random time. Every edge draws its own.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomHoldFile {
    /// The same seed gives the same delays, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// Least and largest value, in s.
    #[schemars(with = "[NotNegative; 2]")]
    pub value_s: At<[At<f64>; 2]>,
    /// Shortest and longest time for which a value is held, in s.
    #[schemars(with = "[Positive; 2]")]
    pub hold_s: At<[At<f64>; 2]>,
}

/// A link that sends packets. What is heard is the newest message that has arrived; every edge draws its own packets.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PacketsFile {
    /// From one packet to the next, in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period_s: At<f64>,
    /// When the first is sent, in s; at most `period_s`. Default: 0.
    #[schemars(range(min = 0))]
    pub first_s: Option<At<f64>>,
    /// The least time that a packet takes, in s.
    #[schemars(range(min = 0))]
    pub latency_s: At<f64>,
    /// Each packet takes up to this much longer, uniformly drawn, in s; beyond `period_s` packets overtake each other.
    /// Default: 0.
    #[schemars(range(min = 0))]
    pub jitter_s: Option<At<f64>>,
    /// The same seed gives the same packets, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// How packets are lost. Default: none is.
    pub loss: Option<At<LossFile>>,
}

/// How packets are lost.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LossFile {
    /// Each by itself.
    Random(RandomLossFile),
    /// In bursts: the link is good or bad, and loses every packet while it is bad.
    Bursts(BurstsFile),
}

/// Packets are lost independently.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomLossFile {
    /// How likely each packet is lost.
    #[schemars(range(min = 0, max = 1))]
    pub probability: At<f64>,
    /// No more than this are lost one after another. Default: any number may be.
    #[schemars(range(min = 1))]
    pub most_consecutive: Option<At<i64>>,
}

/// Packets are lost in bursts.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BurstsFile {
    /// How likely a good link turns bad from one packet to the next.
    #[schemars(range(min = 0, max = 1))]
    pub enter: At<f64>,
    /// How likely a bad link turns good from one packet to the next; a burst lasts 1/leave packets on average.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1))]
    pub leave: At<f64>,
    /// No more than this are lost one after another. Default: any number may be.
    #[schemars(range(min = 1))]
    pub most_consecutive: Option<At<i64>>,
}

/// Packets that were recorded.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogFile {
    /// The CSV file, beside the scenario file. Its first line names its columns: `from`, `to`, `send_s` and `delay_s`, which
    /// is left empty for a packet that was lost. A run with packets writes such a file, `packets.csv`.
    pub file: At<String>,
}

/// A weight: a number, or a formula in t.
#[derive(Clone, Debug, PartialEq)]
pub enum WeightFile {
    /// Always the same.
    Number(f64),
    /// Changes with t.
    Formula(String),
}

impl<'de> Deserialize<'de> for WeightFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WeightVisitor;
        impl Visitor<'_> for WeightVisitor {
            type Value = WeightFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a formula in t in quotes")
            }

            fn visit_f64<E>(self, value: f64) -> Result<WeightFile, E> {
                Ok(WeightFile::Number(value))
            }

            fn visit_str<E>(self, text: &str) -> Result<WeightFile, E> {
                Ok(WeightFile::Formula(text.to_owned()))
            }
        }
        deserializer.deserialize_any(WeightVisitor)
    }
}

impl JsonSchema for WeightFile {
    fn schema_name() -> Cow<'static, str> {
        "Weight".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "A positive number, or a formula in t that stays positive, such as \"1 + 0.5*sin(t)\".",
            "anyOf": [{ "type": "number", "exclusiveMinimum": 0 }, { "type": "string", "minLength": 1 }]
        })
    }
}
