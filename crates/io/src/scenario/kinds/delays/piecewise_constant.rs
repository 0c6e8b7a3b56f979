//! `delay.piecewise_constant`: a delay that jumps from value to value.

use forwardstep_sim::delay::{Delay, PiecewiseConstant};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, fault, filled, not_negative, positive, values};
use super::super::super::network::NetworkReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::super::values::NotNegative;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A delay that jumps.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiecewiseConstantFile {
    /// When each value begins, in s; rising from 0.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    times_s: At<Vec<At<f64>>>,
    /// The values, in s; as many as times.
    #[schemars(with = "Vec<NotNegative>", length(min = 1))]
    values_s: At<Vec<At<f64>>>,
    /// Begin again after this long, in s. Default: the last value stays.
    #[schemars(extend("exclusiveMinimum" = 0))]
    period_s: Option<At<f64>>,
}

impl DelayKind for PiecewiseConstantFile {
    fn table() -> KindTable {
        KindTable { key: "piecewise_constant", description: "Jumps from value to value." }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        let times_s = filled("times_s", &self.times_s)?;
        if let Some(first) = times_s.first()
            && first.value != 0.0
        {
            return Err(fault(first, NetworkProblem::TimesBegin { first_s: first.value }));
        }
        for pair in times_s.windows(2) {
            let (before_s, after_s) = (pair[0].value, pair[1].value);
            if before_s >= after_s {
                return Err(fault(&pair[1], NetworkProblem::TimesRise { before_s, after_s }));
            }
        }
        let (times, number) = (times_s.len(), self.values_s.value.len());
        if times != number {
            return Err(fault(&self.values_s, NetworkProblem::TimesAndValues { times, values: number }));
        }
        for value in &self.values_s.value {
            not_negative("values_s", value)?;
        }
        let period_s = self.period_s.as_ref().map(|period| positive("period_s", period)).transpose()?;
        if let (Some(place), Some(period_s), Some(last)) = (&self.period_s, period_s, times_s.last()) {
            if period_s <= last.value {
                return Err(fault(place, NetworkProblem::PeriodTooShort { period_s, last_s: last.value }));
            }
            network.few("jumps of the delay", network.end_s() / period_s * times as f64, &place.span)?;
        }
        let (times_s, values_s) = (values(times_s), values(&self.values_s.value));
        Ok(DelayPlan::Shared(Delay::new(PiecewiseConstant { times_s, values_s, period_s })))
    }
}
