//! `delay.formula_s`: a formula in t.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::Fault;
use super::super::super::formula_text::FormulaText;
use super::super::super::network::NetworkReader;
use super::super::KindTable;
use super::{DelayKind, DelayPlan};

/// A formula in t, in s, such as "0.2 + 0.1*sin(2*pi*t/3)"; it must be shown not to become negative.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct FormulaFile(At<FormulaText>);

impl DelayKind for FormulaFile {
    fn table() -> KindTable {
        let description = "A formula in t, in s, such as \"0.2 + 0.1*sin(2*pi*t/3)\"; it must be shown not to become negative. It may contain t, \
         pi, e, + - * / ^, sin, cos, exp, log, sqrt, abs, tanh, atan, min and max.";
        KindTable { key: "formula_s", description }
    }

    fn plan(&self, network: &mut NetworkReader<'_>) -> Result<DelayPlan, Fault> {
        Ok(DelayPlan::Shared(network.formula_delay(&self.0)?))
    }
}
