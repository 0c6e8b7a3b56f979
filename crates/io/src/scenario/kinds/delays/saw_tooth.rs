//! `delay.saw_tooth`: a delay that rises and drops.

use forwardstep_sim::delay::{Delay, SawTooth};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::fault::Fault;
use super::super::super::network::NetworkReader;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that rises and drops.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SawToothFile {
    /// In s.
    #[schemars(range(min = 0))]
    min_s: f64,
    /// In s.
    #[schemars(range(min = 0))]
    max_s: f64,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: f64,
    /// How far the first tooth has come at t = 0, in s. Default: 0.
    #[serde(default)]
    offset_s: f64,
}

impl DelayKind for SawToothFile {
    fn table() -> KindTable {
        KindTable { key: "saw_tooth", description: "Rises from min to max over every period, then drops." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let SawToothFile { min_s, max_s, period_s, offset_s } = *self;
        // The same tooth, and no precision lost to a large offset.
        let offset_s = offset_s.rem_euclid(if period_s > 0.0 { period_s } else { 1.0 });
        Ok(DelayPlan::Shared(Delay::new(SawTooth { min_s, max_s, period_s, offset_s })))
    }
}
