//! `delay.sinusoid`: a delay that swings.

use std::f64::consts::TAU;

use forwardstep_sim::delay::{Delay, Sinusoid};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::fault::Fault;
use super::super::super::network::NetworkReader;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that swings.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SinusoidFile {
    /// In s.
    #[schemars(range(min = 0))]
    mean_s: f64,
    /// In s; at most the mean.
    #[schemars(range(min = 0))]
    amplitude_s: f64,
    /// In s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: f64,
    /// In rad. Default: 0.
    #[serde(default)]
    phase_rad: f64,
}

impl DelayKind for SinusoidFile {
    fn table() -> KindTable {
        KindTable { key: "sinusoid", description: "mean + amplitude · sin(2π t / period + phase)." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let SinusoidFile { mean_s, amplitude_s, period_s, phase_rad } = *self;
        let phase_rad = phase_rad.rem_euclid(TAU);
        Ok(DelayPlan::Shared(Delay::new(Sinusoid { mean_s, amplitude_s, period_s, phase_rad })))
    }
}
