//! `reference.backstepping`: the baseline (aa6).

use forwardstep_sim::Exchange;
use forwardstep_sim::reference::Backstepping;
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::Fault;
use super::{ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};

/// The backstepping baseline.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BacksteppingFile {
    /// The time constant of the filter that differentiates.
    pub filter_s: At<f64>,
    /// The largest reference acceleration, rad/s² or m/s². Default: none.
    pub acceleration_limit: Option<At<f64>>,
}

impl ReferenceKind for BacksteppingFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "backstepping",
            description: "The baseline (aa6) that differentiates what it hears; positions are exchanged.",
            own_roots: false,
        }
    }

    fn read(&self, _: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let acceleration_limit = self.acceleration_limit.as_ref().map(|limit| limit.value);
        let dynamics = Backstepping { filter_s: self.filter_s.value, acceleration_limit };
        Ok(ReferenceRead::new(dynamics, Exchange::Position))
    }
}
