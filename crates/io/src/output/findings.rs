//! What is found of a scenario before a run, for programs: what `forwardstep check --json` prints.

use forwardstep_check::{Id, NoPrediction, Practical, Prediction, Report};
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};

use super::names;
use super::practical::PracticalVerdicts;
use super::prediction::Predictions;
use super::verdicts::Verdicts;
use crate::scenario::Scenario;

/// The format of this document; it grows when fields change their meaning or vanish, not when some are added.
pub const FINDINGS_FORMAT: u32 = 1;

/// What is found of a scenario before a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "forwardstep check")]
pub struct Findings {
    /// The format of this document, a number that grows when fields change their meaning or vanish.
    pub format: u32,
    /// The version of forwardstep.
    pub version: String,
    /// Which scenario it is.
    pub scenario: Checked,
    /// The theorem that speaks about it, with its hypotheses.
    pub verdicts: Verdicts,
    /// The stable names of hypotheses whose answers were waived.
    pub accepted: Vec<String>,
    /// The worst answer but for what was waived, in the words of the hypotheses.
    pub outcome: String,
    /// Whether the outcome is `holds`, `holds on [0, end]` or `watched during the run`; the exit status is then 0, otherwise 1. With
    /// `--practical` it is 1 too where a practical verdict says `inadequate`; that does not count here.
    pub fine: bool,
    /// What can be said of the loop as it is deployed; not from the paper.
    pub practical: PracticalVerdicts,
    /// The value that the agents will agree on.
    pub agreement: PredictedAgreement,
    /// What is predicted for robots that follow their references exactly, s ≡ 0; absent unless it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prediction: Option<Predictions>,
    /// Remarks.
    pub notices: Vec<String>,
}

/// Which scenario was checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Checked {
    /// Its name.
    pub name: String,
    /// Its title.
    pub title: String,
    /// The BLAKE3 digest of its text, in hexadecimal.
    pub digest_blake3: String,
}

/// The value that agents will agree on, or why it is not known before a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PredictedAgreement {
    /// The value, one entry per axis.
    Value {
        /// In the units of the axes.
        value: Vec<f64>,
        /// How far rounding can have moved each entry.
        error_bound: Vec<f64>,
    },
    /// Why there is none.
    NoneSince(String),
}

impl Findings {
    /// What `report`, `practical` and `agreement`, which are those of `scenario`, say when the answers about `accepted` are waived, with
    /// what is predicted, if that was asked for.
    pub fn of(
        scenario: &Scenario,
        version: &str,
        report: &Report,
        practical: &Practical,
        agreement: &Result<Prediction, NoPrediction>,
        prediction: Option<Predictions>,
        accepted: &[Id],
    ) -> Findings {
        let outcome = report.worst_without(accepted);
        Findings {
            format: FINDINGS_FORMAT,
            version: version.to_owned(),
            scenario: Checked {
                name: scenario.name.clone(),
                title: scenario.title.clone(),
                digest_blake3: blake3::hash(scenario.source.text().as_bytes()).to_hex().to_string(),
            },
            verdicts: Verdicts::of(report),
            accepted: accepted.iter().map(|id| id.name().to_owned()).collect(),
            outcome: outcome.words().to_owned(),
            fine: outcome.is_fine(),
            practical: PracticalVerdicts::from(practical),
            agreement: match agreement {
                Ok(Prediction { value, error_bound, .. }) => {
                    PredictedAgreement::Value { value: value.clone(), error_bound: error_bound.clone() }
                }
                Err(error) => PredictedAgreement::NoneSince(names::reason(&scenario.setup, error)),
            },
            prediction,
            notices: scenario.notices.iter().map(ToString::to_string).collect(),
        }
    }

    /// It as indented JSON. Numbers that are not finite are `null`.
    ///
    /// # Errors
    /// Those of `serde_json`, which has none for a document of this form.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self)
    }

    /// The JSON schema of this document.
    pub fn schema() -> Schema {
        schema_for!(Findings)
    }
}
