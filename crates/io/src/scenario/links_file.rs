//! Weights of links, and delays of theirs for all graphs, as they are written.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

use super::at::At;
use super::formula_text::{FORMULA, FormulaText};
use super::network_file::DelayFile;

/// A weight: a number, or a formula in t.
#[derive(Clone, Debug, PartialEq)]
pub enum WeightFile {
    /// Always the same.
    Number(f64),
    /// Changes with t.
    Formula(FormulaText),
}

/// The delay of one link, whichever graph is in force.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinkDelayFile {
    /// The agent that is heard.
    pub from: At<String>,
    /// The agent that hears it.
    pub to: At<String>,
    /// The delay of this edge in every graph that has it.
    pub delay: At<DelayFile>,
}

impl<'de> Deserialize<'de> for WeightFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct WeightVisitor;
        impl<'de> Visitor<'de> for WeightVisitor {
            type Value = WeightFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a formula in t in quotes")
            }

            fn visit_newtype_struct<D: Deserializer<'de>>(self, value: D) -> Result<WeightFile, D::Error> {
                value.deserialize_any(self)
            }

            fn visit_f64<E>(self, value: f64) -> Result<WeightFile, E> {
                Ok(WeightFile::Number(value))
            }

            fn visit_str<E>(self, text: &str) -> Result<WeightFile, E> {
                Ok(WeightFile::Formula(FormulaText(text.to_owned())))
            }
        }
        deserializer.deserialize_newtype_struct(FORMULA, WeightVisitor)
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
