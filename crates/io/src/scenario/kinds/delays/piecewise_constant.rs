//! `delay.piecewise_constant`: a delay that jumps from value to value.

use forwardstep_sim::delay::{Delay, PiecewiseConstant};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::fault::Fault;
use super::super::super::network::NetworkReader;
use super::super::super::values::NotNegative;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that jumps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiecewiseConstantFile {
    /// When each value begins, in s; rising from 0.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    times_s: Vec<f64>,
    /// The values, in s; as many as times.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    values_s: Vec<f64>,
    /// Begin again after this long, in s. Default: the last value stays.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: Option<f64>,
}

impl DelayKind for PiecewiseConstantFile {
    fn table() -> KindTable {
        KindTable { key: "piecewise_constant", description: "Jumps from value to value." }
    }

    fn plan(&self, _: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let PiecewiseConstantFile { times_s, values_s, period_s } = self.clone();
        Ok(DelayPlan::Shared(Delay::new(PiecewiseConstant { times_s, values_s, period_s })))
    }
}
