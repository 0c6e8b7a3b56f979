//! Values that may be written in several ways: a gain, a start, a list of named numbers.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};

use super::at::At;
use super::fault::values;

/// An entry of a list: a number, or a list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A number.
    Number(f64),
    /// A list of numbers.
    List(Vec<At<f64>>),
}

impl Item {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Item::Number(value) => Some(*value),
            Item::List(_) => None,
        }
    }
}

/// A list of numbers, or a list of such lists.
pub type Rows = Vec<At<Item>>;

/// A gain: a number, a diagonal or a matrix.
#[derive(Clone, Debug, PartialEq)]
pub enum GainFile {
    /// The same number on the whole diagonal.
    Number(f64),
    /// A diagonal, or a matrix row by row.
    Rows(Rows),
}

/// A number for all axes, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisValues {
    /// The same for all.
    All(f64),
    /// One for each.
    Each(Vec<At<f64>>),
}

impl AxisValues {
    /// One for each of `axes`, or as many as were written.
    pub fn each(&self, axes: usize) -> Vec<f64> {
        match self {
            AxisValues::All(value) => vec![*value; axes],
            AxisValues::Each(list) => values(list),
        }
    }
}

/// A gain, or a bandwidth that is multiplied by a natural scale.
#[derive(Clone, Debug, PartialEq)]
pub enum GainOrBandwidth {
    /// The gain itself.
    Gain(GainFile),
    /// A bandwidth.
    Bandwidth(BandwidthFile),
}

/// A gain as a bandwidth.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BandwidthFile {
    /// The bandwidth in 1/s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub bandwidth_per_s: At<f64>,
}

/// Where agents start on each axis: one list, one list per agent of a counted population, or a seeded random draw.
#[derive(Clone, Debug, PartialEq)]
pub enum StartValues {
    /// One number per axis, or one such list per agent.
    Rows(Rows),
    /// Drawn at random.
    Random(RandomFile),
}

/// Wraps the draw, so that it is written `{ random = { … } }`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RandomChoice {
    /// A seeded random draw.
    random: RandomFile,
}

/// Independent numbers drawn uniformly, agent after agent and axis after axis.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomFile {
    /// The same seed gives the same numbers, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// Lowest and highest value, of all entries or of each.
    pub within: At<Within>,
}

/// Between which values a draw lies.
#[derive(Clone, Debug, PartialEq)]
pub enum Within {
    /// The same for all entries: the lowest and the highest.
    All([f64; 2]),
    /// One such pair for each.
    Each(Vec<[f64; 2]>),
}

/// Stands for a positive number in the schema.
pub(super) struct Positive;

/// Stands for a number that is not negative in the schema.
pub(super) struct NotNegative;

/// Stands for a number that is not negative, for all axes or for each, in the schema.
pub(super) struct NotNegativeEach;

/// Numbers by name, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Named(pub Vec<(At<String>, At<f64>)>);

/// Implements `Deserialize` by handing whatever is found to a visitor.
macro_rules! deserialize_any {
    ($type:ty, $visitor:ident) => {
        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any($visitor)
            }
        }
    };
}

deserialize_any!(Item, ItemVisitor);
deserialize_any!(AxisValues, AxisVisitor);
deserialize_any!(GainFile, GainVisitor);
deserialize_any!(GainOrBandwidth, GainOrBandwidthVisitor);
deserialize_any!(StartValues, StartVisitor);
deserialize_any!(Within, WithinVisitor);

fn rows<'de, A: SeqAccess<'de>>(seq: A) -> Result<Rows, A::Error> {
    Rows::deserialize(SeqAccessDeserializer::new(seq))
}

struct ItemVisitor;

impl<'de> Visitor<'de> for ItemVisitor {
    type Value = Item;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_f64<E>(self, value: f64) -> Result<Item, E> {
        Ok(Item::Number(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Item, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Item::List)
    }
}

struct AxisVisitor;

impl<'de> Visitor<'de> for AxisVisitor {
    type Value = AxisValues;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or a list of numbers")
    }

    fn visit_f64<E>(self, value: f64) -> Result<AxisValues, E> {
        Ok(AxisValues::All(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<AxisValues, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(seq)).map(AxisValues::Each)
    }
}

struct GainVisitor;

impl<'de> Visitor<'de> for GainVisitor {
    type Value = GainFile;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a list (the diagonal) or a list of rows")
    }

    fn visit_f64<E>(self, value: f64) -> Result<GainFile, E> {
        Ok(GainFile::Number(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<GainFile, A::Error> {
        rows(seq).map(GainFile::Rows)
    }
}

struct GainOrBandwidthVisitor;

impl<'de> Visitor<'de> for GainOrBandwidthVisitor {
    type Value = GainOrBandwidth;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a list (the diagonal), a list of rows or { bandwidth_per_s = … }")
    }

    fn visit_f64<E>(self, value: f64) -> Result<GainOrBandwidth, E> {
        Ok(GainOrBandwidth::Gain(GainFile::Number(value)))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<GainOrBandwidth, A::Error> {
        rows(seq).map(|rows| GainOrBandwidth::Gain(GainFile::Rows(rows)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<GainOrBandwidth, A::Error> {
        BandwidthFile::deserialize(MapAccessDeserializer::new(map)).map(GainOrBandwidth::Bandwidth)
    }
}

struct StartVisitor;

impl<'de> Visitor<'de> for StartVisitor {
    type Value = StartValues;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of numbers, one such list per agent, or { random = { seed = …, within = [low, high] } }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<StartValues, A::Error> {
        rows(seq).map(StartValues::Rows)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<StartValues, A::Error> {
        RandomChoice::deserialize(MapAccessDeserializer::new(map)).map(|choice| StartValues::Random(choice.random))
    }
}

struct WithinVisitor;

impl<'de> Visitor<'de> for WithinVisitor {
    type Value = Within;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[low, high], or one such pair per axis")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Within, A::Error> {
        let rows = rows(seq)?;
        let numbers = |row: &At<Item>| row.value.number();
        let pair = |row: &At<Item>| match &row.value {
            Item::List(list) => <[f64; 2]>::try_from(values(list)).ok(),
            Item::Number(_) => None,
        };
        let all = rows.iter().map(numbers).collect::<Option<Vec<_>>>().and_then(|all| <[f64; 2]>::try_from(all).ok());
        let each = || rows.iter().map(pair).collect::<Option<Vec<_>>>().filter(|each| !each.is_empty());
        all.map(Within::All)
            .or_else(|| each().map(Within::Each))
            .ok_or_else(|| A::Error::invalid_type(Unexpected::Seq, &self))
    }
}

impl<'de> Deserialize<'de> for Named {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NamedVisitor;
        impl<'de> Visitor<'de> for NamedVisitor {
            type Value = Named;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of numbers")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Named, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Named(entries))
            }
        }
        deserializer.deserialize_map(NamedVisitor)
    }
}

/// Implements `JsonSchema` in place, under the type's own name, from a value and the sub-schemas it needs.
macro_rules! inline_schema {
    ($type:ty, $name:literal, |$generator:ident| $schema:expr) => {
        impl JsonSchema for $type {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }

            fn json_schema($generator: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    };
}

fn numbers() -> Schema {
    json_schema!({ "type": "array", "items": { "type": "number" } })
}

inline_schema!(Positive, "Positive", |_generator| json_schema!({ "type": "number", "exclusiveMinimum": 0 }));
inline_schema!(NotNegative, "NotNegative", |_generator| json_schema!({ "type": "number", "minimum": 0 }));
inline_schema!(NotNegativeEach, "NotNegativeEach", |_generator| json_schema!({
    "anyOf": [{ "type": "number", "minimum": 0 }, { "type": "array", "items": { "type": "number", "minimum": 0 } }],
}));
inline_schema!(Within, "Within", |_generator| {
    let pair = json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
    json_schema!({ "anyOf": [pair, { "type": "array", "items": pair, "minItems": 1 }] })
});
inline_schema!(AxisValues, "AxisValues", |_generator| json_schema!({
    "anyOf": [
        { "type": "number", "exclusiveMinimum": 0 },
        { "type": "array", "items": { "type": "number", "exclusiveMinimum": 0 } },
    ],
}));
inline_schema!(Item, "Item", |_generator| json_schema!({ "anyOf": [{ "type": "number" }, numbers()] }));
inline_schema!(GainFile, "Gain", |_generator| json_schema!({
    "anyOf": [
        { "type": "number", "exclusiveMinimum": 0 },
        { "type": "array", "items": { "type": "number", "exclusiveMinimum": 0 } },
        { "type": "array", "items": numbers() }
    ]
}));
inline_schema!(GainOrBandwidth, "GainOrBandwidth", |generator| json_schema!({
    "anyOf": [generator.subschema_for::<GainFile>(), generator.subschema_for::<BandwidthFile>()]
}));
inline_schema!(StartValues, "StartValues", |generator| json_schema!({
    "anyOf": [
        numbers(),
        { "type": "array", "items": numbers() },
        generator.subschema_for::<RandomChoice>()
    ]
}));
inline_schema!(Named, "Named", |_generator| json_schema!({
    "type": "object", "additionalProperties": { "type": "number" }
}));

/// Digits that are written for any `f64`.
const DIGITS: usize = 17;

/// What is computed with instead of a number of so many digits that some of them are lost. Up to seventeen stand for the `f64` next
/// to them, as programs write it.
pub(super) fn shorter(written: &str, value: f64) -> Option<String> {
    let significand = written.split(['e', 'E']).next().unwrap_or_default();
    let digits: String = significand.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_start_matches('0').trim_end_matches('0');
    (digits.len() > DIGITS).then(|| format!("{value:?}"))
}
