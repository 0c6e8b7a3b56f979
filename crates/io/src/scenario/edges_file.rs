//! `edges` as they are written: one by one, or by a rule.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};

use super::at::At;
use super::links_file::WeightFile;
use super::network_file::DelayFile;

/// The name under which [`EdgesFile`] asks its deserialiser for a list or a choice.
pub(super) const LIST_OR_CHOICE: &str = "$forwardstep::ListOrChoice";

/// The edges of one graph.
#[derive(Clone, Debug)]
pub enum EdgesFile {
    /// One by one.
    List(Vec<At<EdgeFile>>),
    /// By a rule, or from a table.
    Rule(Box<RuleFile>),
}

/// Edges by a rule among all agents, or among some of them in the order given; or from a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RuleFile {
    /// Every agent is heard by the next, the last by the first.
    Ring(AlongFile),
    /// Every agent is heard by the next.
    Path(AlongFile),
    /// One agent in the middle of all others.
    Star(StarFile),
    /// Every agent hears all others.
    Complete(CompleteFile),
    /// Every agent hears as many others, drawn at random.
    Random(RandomGraphFile),
    /// The edges listed in a CSV file.
    Csv(CsvFile),
}

/// A ring or a path.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AlongFile {
    /// Whether neighbours hear each other. Default: forward.
    #[serde(default)]
    pub direction: AlongDirection,
    /// The agents it runs through, in this order. Default: all.
    pub among: Option<At<Vec<At<String>>>>,
    /// The weight of these edges.
    pub weight: Option<At<WeightFile>>,
    /// The delay of these edges.
    pub delay: Option<At<DelayFile>>,
}

/// Direction of the edges along a ring or a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlongDirection {
    /// Each agent is heard by the next.
    #[default]
    Forward,
    /// Neighbours hear each other.
    Both,
}

/// A star.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StarFile {
    /// The agent in the middle.
    pub centre: At<String>,
    /// Who hears whom. Default: out.
    #[serde(default)]
    pub direction: StarDirection,
    /// The agents around it. Default: all others.
    pub among: Option<At<Vec<At<String>>>>,
    /// The weight of these edges.
    pub weight: Option<At<WeightFile>>,
    /// The delay of these edges.
    pub delay: Option<At<DelayFile>>,
}

/// Direction of the edges of a star.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StarDirection {
    /// All others hear the centre.
    #[default]
    Out,
    /// The centre hears all others.
    In,
    /// Both.
    Both,
}

/// A complete graph.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CompleteFile {
    /// The agents that hear each other. Default: all.
    pub among: Option<At<Vec<At<String>>>>,
    /// The weight of these edges.
    pub weight: Option<At<WeightFile>>,
    /// The delay of these edges.
    pub delay: Option<At<DelayFile>>,
}

/// A random graph; every choice of so many others is equally likely.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomGraphFile {
    /// How many others every agent hears.
    #[schemars(range(min = 1))]
    pub in_degree: At<i64>,
    /// The same seed gives the same graph, always.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// The agents that hear each other. Default: all.
    pub among: Option<At<Vec<At<String>>>>,
    /// The weight of these edges.
    pub weight: Option<At<WeightFile>>,
    /// The delay of these edges.
    pub delay: Option<At<DelayFile>>,
}

/// A table of edges.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CsvFile {
    /// The CSV file, beside the scenario file or in `inputs` beside it. Its first line names its columns: `from`, `to` and, if
    /// wanted, `weight` and `delay_s`; a weight may be a formula in t. Where one of these two is left empty, the network's
    /// own holds.
    pub file: At<String>,
}

/// An edge says who is heard by whom: `["from", "to"]`, or `{ from = …, to = … }` with a weight or delay of its own.
#[derive(Clone, Debug)]
pub struct EdgeFile {
    /// The agent that is heard.
    pub from: At<String>,
    /// The agent that hears it.
    pub to: At<String>,
    /// A weight of its own.
    pub weight: Option<At<WeightFile>>,
    /// A delay of its own.
    pub delay: Option<At<DelayFile>>,
}

/// An edge written as a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct EdgeTable {
    /// The agent that is heard.
    from: At<String>,
    /// The agent that hears it.
    to: At<String>,
    /// The weight of this edge.
    weight: Option<At<WeightFile>>,
    /// The delay of this edge.
    delay: Option<At<DelayFile>>,
}

impl<'de> Deserialize<'de> for EdgesFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EdgesVisitor;
        impl<'de> Visitor<'de> for EdgesVisitor {
            type Value = EdgesFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of edges or a table of ring, path, star, complete, random or csv")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<EdgesFile, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(EdgesFile::List)
            }

            fn visit_newtype_struct<D: Deserializer<'de>>(self, choice: D) -> Result<EdgesFile, D::Error> {
                Box::deserialize(choice).map(EdgesFile::Rule)
            }
        }
        deserializer.deserialize_newtype_struct(LIST_OR_CHOICE, EdgesVisitor)
    }
}

impl JsonSchema for EdgesFile {
    fn schema_name() -> Cow<'static, str> {
        "Edges".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "The edges of one graph: one by one, by a rule, or from a table.",
            "anyOf": [
                { "type": "array", "items": generator.subschema_for::<EdgeFile>() },
                generator.subschema_for::<RuleFile>()
            ]
        })
    }
}

impl<'de> Deserialize<'de> for EdgeFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EdgeVisitor;
        impl<'de> Visitor<'de> for EdgeVisitor {
            type Value = EdgeFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(r#"an edge, ["from", "to"] or { from = "…", to = "…" }"#)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<EdgeFile, A::Error> {
                let names: Vec<At<String>> = Vec::deserialize(SeqAccessDeserializer::new(seq))?;
                let found = names.len();
                match <[At<String>; 2]>::try_from(names) {
                    Ok([from, to]) => Ok(EdgeFile { from, to, weight: None, delay: None }),
                    Err(_) => Err(serde::de::Error::invalid_length(found, &self)),
                }
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<EdgeFile, A::Error> {
                let EdgeTable { from, to, weight, delay } = EdgeTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(EdgeFile { from, to, weight, delay })
            }
        }
        deserializer.deserialize_any(EdgeVisitor)
    }
}

impl JsonSchema for EdgeFile {
    fn schema_name() -> Cow<'static, str> {
        "Edge".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "description": "Who is heard by whom.",
            "anyOf": [
                { "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2 },
                generator.subschema_for::<EdgeTable>()
            ]
        })
    }
}
