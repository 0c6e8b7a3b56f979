//! `delay.sinusoid`: a delay that swings.

use std::f64::consts::TAU;

use forwardstep_sim::delay::{Delay, Sinusoid};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, fault, not_negative, positive};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that swings.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SinusoidFile {
    /// In s.
    #[schemars(range(min = 0))]
    mean_s: At<f64>,
    /// In s; at most the mean.
    #[schemars(range(min = 0))]
    amplitude_s: At<f64>,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: At<f64>,
    /// In rad. Default: 0.
    #[serde(default)]
    phase_rad: f64,
}

impl DelayKind for SinusoidFile {
    fn table() -> KindTable {
        KindTable { key: "sinusoid", description: "mean + amplitude · sin(2π t / period + phase)." }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let mean_s = not_negative("mean_s", &self.mean_s)?;
        let amplitude_s = not_negative("amplitude_s", &self.amplitude_s)?;
        if amplitude_s > mean_s {
            return Err(fault(&self.amplitude_s, NetworkProblem::Amplitude { amplitude_s, mean_s }));
        }
        let period_s = positive("period_s", &self.period_s)?;
        network.few("swings of the delay", network.end_s() / period_s, &self.period_s.span)?;
        let phase_rad = self.phase_rad.rem_euclid(TAU);
        Ok(DelayPlan::Shared(Delay::new(Sinusoid { mean_s, amplitude_s, period_s, phase_rad })))
    }
}
