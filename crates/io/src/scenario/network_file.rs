//! The `[network]` of a scenario file as it is written.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

use super::at::At;
use super::document::Node;
use super::edges_file::EdgesFile;
use super::file::{KeyVisitor, kind};
use super::links_file::{LinkDelayFile, WeightFile};
use super::values::Positive;

/// The names under which [`SwitchingFile`] and [`DelayFile`] ask their deserialiser for a kind.
pub(super) const SWITCHING: &str = "$forwardstep::Switching";
pub(super) const DELAY: &str = "$forwardstep::Delay";

/// Who hears whom, when, and how late: one graph (`edges`) or several in turn (`phases`).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["edges"] }, { "required": ["phases"] }]))]
pub struct NetworkFile {
    /// The weight of every edge that has none of its own: a number, or a formula in t. Default: 1.
    pub weight: Option<At<WeightFile>>,
    /// The delay of every edge that has none of its own. Default: none.
    pub delay: Option<At<DelayFile>>,
    /// Delays of single links, stated once for all phases. An edge whose link is here states none of its own.
    #[serde(default)]
    pub link_delays: Vec<At<LinkDelayFile>>,
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

impl NetworkFile {
    /// Where the first edge stands that leads to this agent, if it is written by itself.
    pub(super) fn edge_to(&self, agent: &str) -> Option<Range<usize>> {
        let phases = self.phases.iter().flat_map(|phases| &phases.value).map(|phase| &phase.value.edges);
        let edges = self.edges.iter().chain(phases).flat_map(|edges| match &edges.value {
            EdgesFile::List(list) => list.as_slice(),
            EdgesFile::Rule(_) => &[],
        });
        edges.into_iter().find(|edge| edge.value.to.value == agent).map(|edge| edge.span.clone())
    }
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

/// How the phases of a network follow each other: the key of a kind, whose table stays in the tree of the file.
#[derive(Clone, Debug)]
pub struct SwitchingFile {
    /// The key.
    pub key: String,
}

kind!(SwitchingFile, SWITCHING, "SwitchingFile");

/// How old a message is when it is heard.
#[derive(Clone, Copy, Debug)]
pub enum DelayFile {
    /// The table of a kind stays in the tree of the file, as this node.
    Kind(Node),
    /// Always the same, in s: from a table of edges.
    Constant(f64),
}

impl<'de> Deserialize<'de> for DelayFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NodeVisitor;
        impl Visitor<'_> for NodeVisitor {
            type Value = DelayFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table with one key")
            }

            fn visit_u64<E>(self, node: u64) -> Result<DelayFile, E> {
                Ok(DelayFile::Kind(Node(node)))
            }
        }
        deserializer.deserialize_newtype_struct(DELAY, NodeVisitor)
    }
}

impl JsonSchema for DelayFile {
    fn schema_name() -> Cow<'static, str> {
        "DelayFile".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "object" })
    }
}
