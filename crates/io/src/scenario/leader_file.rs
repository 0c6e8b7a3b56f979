//! A leader as it is written. The doc comments of this file are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::systems_file::TargetFile;

/// A leader: a motion without a robot, or an agent.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{ "required": ["motion"] }, { "required": ["agent"] }]))]
pub struct LeaderFile {
    /// Its name, as edges name it. Default: `leader`. An agent has a name already.
    pub name: Option<At<String>>,
    /// Where it is over time.
    pub motion: Option<At<TargetFile>>,
    /// The name of the agent that leads: it follows its `target`, under `reference.tracking`, and the others follow it.
    pub agent: Option<At<String>>,
}
