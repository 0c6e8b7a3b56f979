//! `delay.formula_s`: a formula in t.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::Fault;
use super::super::super::network::NetworkReader;
use super::{DelayKind, DelayPlan};

/// A formula in t, in s, such as "0.2 + 0.1*sin(2*pi*t/3)"; it must be shown not to become negative.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct FormulaFile(At<String>);

impl DelayKind for FormulaFile {
    fn key() -> &'static str {
        "formula_s"
    }

    fn description() -> &'static str {
        "A formula in t, in s, such as \"0.2 + 0.1*sin(2*pi*t/3)\"; it must be shown not to become negative. It may contain t, \
         pi, e, + - * / ^, sin, cos, exp, log, sqrt, abs, tanh, atan, min and max."
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        Ok(DelayPlan::Shared(network.formula_delay(&self.0)?))
    }
}
