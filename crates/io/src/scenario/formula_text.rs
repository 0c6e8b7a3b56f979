//! The text of a formula as it is written. Unlike names, choices and titles it may be long and over several lines.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use serde::de::{Deserializer, Error, Visitor};

use super::de::quoted;
use super::fault::Fault;
use super::value_problem::ValueProblem;
use crate::shown::breaks_lines;

/// The name under which a formula, or a number in its place, asks its deserialiser for a text of more than a line.
pub(super) const FORMULA: &str = "$forwardstep::Formula";

/// Bytes that a formula may have. What takes long is bounded by its steps; these are room for many digits, blanks and lines.
const LONGEST_FORMULA: usize = 10_000;

/// The text of a formula. In a schema it looks like any text.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FormulaText(pub String);

impl AsRef<str> for FormulaText {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

/// A text that may be a formula: blanks of every kind stand between its words, and nothing that steers a terminal.
pub(super) fn of_any_length(text: &str) -> Result<&str, Fault> {
    if text.len() > LONGEST_FORMULA || text.contains(|c| breaks_lines(c) && !matches!(c, '\n' | '\r' | '\t')) {
        return Err(Fault::new(ValueProblem::FormulaText { found: quoted(text), most: LONGEST_FORMULA }));
    }
    Ok(text)
}

impl<'de> Deserialize<'de> for FormulaText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TextVisitor;
        impl<'de> Visitor<'de> for TextVisitor {
            type Value = FormulaText;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a text in quotes")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<FormulaText, E> {
                Ok(FormulaText(text.to_owned()))
            }

            fn visit_newtype_struct<D: Deserializer<'de>>(self, text: D) -> Result<FormulaText, D::Error> {
                String::deserialize(text).map(FormulaText)
            }
        }
        deserializer.deserialize_newtype_struct(FORMULA, TextVisitor)
    }
}

impl JsonSchema for FormulaText {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        String::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        String::json_schema(generator)
    }
}
