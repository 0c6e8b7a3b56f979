//! What a theorem promises and what was found of its hypotheses, in words: a part of `summary.json` and of what `check --json`
//! prints.

use forwardstep_check::{Answer, Report};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A [`Report`] in words.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verdicts {
    /// The stable name of the theorem, for example `theorem-2`; absent in documents of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Whose it is: `the paper`, `the paper as corrected (…)`, or derived for this software; absent like `id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// The theorem.
    pub theorem: String,
    /// What it guarantees.
    #[serde(alias = "promises")]
    pub guarantees: String,
    /// The worst answer.
    pub worst: String,
    /// Its hypotheses.
    pub hypotheses: Vec<Verdict>,
}

/// One hypothesis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verdict {
    /// The stable name of the hypothesis, for example `spanning-tree`; absent in documents of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// Where the paper asks for it: a theorem, an equation, a section; absent like `id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Whose it is, in the words of [`Verdicts::source`]; absent like `id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// How the answer was found: `exact`, `enclosed`, `given`, `computed`, `sampled`, `declared` or `watched`; absent like `id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rigour: Option<String>,
    /// What is required.
    pub requires: String,
    /// `holds`, `holds on [0, end]`, `watched during the run`, `not shown`, `not covered by the paper` or `violated`.
    pub answer: String,
    /// Certificate or witness.
    pub because: String,
    /// The smallest change that would make it hold for all time; absent where it holds, and like `id`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<String>,
}

impl Verdicts {
    pub(crate) fn of(report: &Report) -> Self {
        let worst: Answer = report.worst();
        Verdicts {
            id: Some(report.theorem.name().to_owned()),
            source: Some(report.theorem.source().words()),
            theorem: report.theorem.to_string(),
            guarantees: report.promises.clone(),
            worst: worst.words().to_owned(),
            hypotheses: (report.hypotheses.iter())
                .map(|h| Verdict {
                    id: Some(h.id.name().to_owned()),
                    place: Some(h.place().to_owned()),
                    source: Some(h.source().words()),
                    rigour: Some(h.rigour().word().to_owned()),
                    requires: h.requires(),
                    answer: h.answer().words().to_owned(),
                    because: h.because(),
                    change: h.change(),
                })
                .collect(),
        }
    }

    /// Whether these, which may lack what older versions did not write, say what `now` says.
    pub(crate) fn agree_with(&self, now: &Self) -> bool {
        let mut now = now.clone();
        let forget = |then: &Option<String>, now: &mut Option<String>| {
            if then.is_none() {
                *now = None;
            }
        };
        forget(&self.id, &mut now.id);
        forget(&self.source, &mut now.source);
        for (then, now) in self.hypotheses.iter().zip(&mut now.hypotheses) {
            forget(&then.id, &mut now.id);
            forget(&then.place, &mut now.place);
            forget(&then.source, &mut now.source);
            forget(&then.rigour, &mut now.rigour);
            forget(&then.change, &mut now.change);
        }
        *self == now
    }
}
