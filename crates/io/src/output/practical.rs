//! Practical verdicts, and what is watched along a run, in words and numbers: parts of `summary.json`, of what `check --json` prints,
//! and of the report.

use std::collections::BTreeMap;

use forwardstep_check::{Along, LoadReached, MarginReached, PowerReached, Practical, Source, along};
use forwardstep_sim::Setup;
use forwardstep_sim::recording::Recording;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number;

/// What can be said of the loop as it is deployed, before a run. It is not from the paper, and counts neither for the outcome of the
/// hypotheses nor for their exit status.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PracticalVerdicts {
    /// Whose they are: `derived for this software, not in the paper`.
    pub source: String,
    /// The worst answer; absent where nothing is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<String>,
    /// One by one.
    pub verdicts: Vec<PracticalVerdict>,
}

/// One practical verdict.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PracticalVerdict {
    /// Its stable name, for example `sampling-margin`.
    pub id: String,
    /// What it is about.
    pub about: String,
    /// `bound`, where nothing is required, `adequate`, `marginal`, `not shown` or `inadequate`.
    pub answer: String,
    /// What was found.
    pub because: String,
    /// The numbers in it, by stable names that end in their units.
    pub numbers: BTreeMap<String, f64>,
}

impl From<&Practical> for PracticalVerdicts {
    fn from(practical: &Practical) -> Self {
        let verdict = |finding: &forwardstep_check::Finding| PracticalVerdict {
            id: finding.name().to_owned(),
            about: finding.about().to_owned(),
            answer: finding.answer().words().to_owned(),
            because: finding.because(),
            numbers: finding.numbers().into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        };
        PracticalVerdicts {
            source: Source::Derived.words(),
            worst: practical.worst().map(|worst| worst.words().to_owned()),
            verdicts: practical.findings.iter().map(verdict).collect(),
        }
    }
}

/// What was watched along a run, at rows of its tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Watched {
    /// The largest sampling margin σ; absent in continuous time and without agents under (6)–(7).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling_margin: Option<WatchedMargin>,
    /// The static torque |g_j(q)| closest to its limit; absent where no limit is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_load: Option<WatchedLoad>,
    /// The mean of Σ sᵀKs of the agents under (6)–(7); absent where nothing feeds V for ever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tracking_power: Option<WatchedPower>,
    /// How many states were looked at for the first two.
    pub states: usize,
    /// Rows that these are of; zero in files of earlier versions, which do not say.
    #[serde(default)]
    pub rows: usize,
}

/// How large s was, as power.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WatchedPower {
    /// The mean of Σ sᵀKs over all rows, W.
    pub mean_w: f64,
    /// What it cannot exceed, or is expected not to where there is noise, with the pushes, the start and σ of the run, W; null where V was
    /// not recorded.
    pub bound_w: Option<f64>,
}

/// The largest σ that was reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WatchedMargin {
    /// Index of the agent.
    pub agent: usize,
    /// When, s.
    pub t_s: f64,
    /// σ.
    #[serde(deserialize_with = "number::or_nan")]
    #[schemars(with = "Option<f64>")]
    pub sigma: f64,
}

/// The static torque that came closest to its limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WatchedLoad {
    /// Index of the agent.
    pub agent: usize,
    /// The axis.
    pub axis: usize,
    /// When, s.
    pub t_s: f64,
    /// |g_j(q)|, N m or N.
    pub torque: f64,
    /// Its limit, N m or N.
    pub limit: f64,
}

impl Watched {
    /// At how many of the rows of a run this was looked at, in words; nothing where it was at all of them.
    pub fn rows_words(&self, recording: &Recording) -> Option<String> {
        let all = recording.t_s.len();
        (self.rows > 0 && self.rows < all).then(|| format!("{} of {all} rows", self.rows))
    }

    /// Looks at a recording; `None` where there is nothing to be watched.
    pub fn of(setup: &Setup, recording: &Recording) -> Option<Watched> {
        let Along { margin, load, power, states, rows } = along(setup, recording);
        let tracking_power = power
            .map(|PowerReached { mean_w, bound }| WatchedPower { mean_w, bound_w: bound.map(|bound| bound.mean_w) });
        let sampling_margin = margin.map(|MarginReached { agent, t_s, sigma, .. }| WatchedMargin { agent, t_s, sigma });
        let static_load = load.map(|LoadReached { t_s, load }| WatchedLoad {
            agent: load.agent.index,
            axis: load.axis,
            t_s,
            torque: load.torque,
            limit: load.limit,
        });
        let found = Watched { sampling_margin, static_load, tracking_power, states, rows };
        (sampling_margin.is_some() || static_load.is_some() || tracking_power.is_some()).then_some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn that_not_all_rows_were_looked_at_is_said() {
        let recording = Recording { t_s: vec![0.0; 3001], ..Recording::default() };
        let words = |rows| Watched { rows, ..Watched::default() }.rows_words(&recording);
        assert_eq!([words(500), words(3001), words(0)], [Some("500 of 3001 rows".to_owned()), None, None]);
    }
}
