//! `delay.constant_s`: the same delay for ever.

use forwardstep_sim::delay::Delay;
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::fault::Fault;
use super::super::super::network::NetworkReader;
use super::super::super::values::NotNegative;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// In s.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct ConstantFile(#[schemars(with = "NotNegative")] f64);

impl DelayKind for ConstantFile {
    fn table() -> KindTable {
        KindTable { key: "constant_s", description: "Always the same, in s." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        Ok(DelayPlan::Shared(Delay::constant(self.0)))
    }
}
