//! `delay.saw_tooth`: a delay that rises and drops.

use forwardstep_sim::delay::{Delay, SawTooth};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, fault, not_negative, positive};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that rises and drops.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SawToothFile {
    /// In s.
    #[schemars(range(min = 0))]
    min_s: At<f64>,
    /// In s.
    #[schemars(range(min = 0))]
    max_s: At<f64>,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: At<f64>,
    /// How far the first tooth has come at t = 0, in s. Default: 0.
    #[serde(default)]
    offset_s: f64,
}

impl DelayKind for SawToothFile {
    fn table() -> KindTable {
        KindTable { key: "saw_tooth", description: "Rises from min to max over every period, then drops." }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let min_s = not_negative("min_s", &self.min_s)?;
        let max_s = not_negative("max_s", &self.max_s)?;
        if min_s > max_s {
            return Err(fault(&self.min_s, NetworkProblem::SawTooth { min_s, max_s }));
        }
        let period_s = positive("period_s", &self.period_s)?;
        network.few("jumps of the delay", network.end_s() / period_s, &self.period_s.span)?;
        // The same tooth, and no precision lost to a large offset.
        let offset_s = self.offset_s.rem_euclid(period_s);
        Ok(DelayPlan::Shared(Delay::new(SawTooth { min_s, max_s, period_s, offset_s })))
    }
}
