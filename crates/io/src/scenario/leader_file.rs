//! A leader as it is written. The doc comments of this file are descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::systems_file::TargetFile;

/// A leader: a motion without a robot.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeaderFile {
    /// Its name, as edges name it. Default: `leader`.
    pub name: Option<At<String>>,
    /// Where it is over time.
    pub motion: At<TargetFile>,
}
