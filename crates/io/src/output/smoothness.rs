//! Jumps of derivatives of inputs, for programs: what `forwardstep smoothness --json` prints.

use forwardstep_check::smoothness::{Covered, Filters, LargestJump, NotCovered, OfOrder, Smoothness};
use forwardstep_sim::Setup;
use schemars::{JsonSchema, Schema, schema_for};
use serde::{Deserialize, Serialize};

use super::names;
use crate::scenario::Scenario;

/// The format of this document; it grows when fields change their meaning or vanish, not when some are added.
pub const SMOOTHNESS_FORMAT: u32 = 1;

/// Jumps of derivatives of inputs, scenario by scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "forwardstep smoothness")]
pub struct SmoothnessDocument {
    /// The format of this document, a number that grows when fields change their meaning or vanish.
    pub format: u32,
    /// The version of forwardstep.
    pub version: String,
    /// The scenarios, in the order asked for.
    pub scenarios: Vec<SmoothScenario>,
}

/// What is found of one scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmoothScenario {
    /// Its name.
    pub name: String,
    /// Its title.
    pub title: String,
    /// What was found.
    pub found: SmoothnessFound,
}

/// What was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SmoothnessFound {
    /// Every derivative of every input, of the scenario as it is.
    AsItIs {
        /// Instants at which the graph switched.
        switches: usize,
        /// Other instants at which delays jumped, or might have.
        delay_jumps: usize,
        /// Whether no derivative jumps that must not.
        kept: bool,
        /// The inputs of which something is said, each kind once.
        inputs: Vec<SmoothInput>,
        /// The agents of which nothing is said.
        not_covered: Vec<NothingSaid>,
    },
    /// The same network under reference dynamics of several orders.
    Orders(Vec<SmoothOrder>),
    /// The same agents under the backstepping baseline.
    Filters {
        /// The slope of ln |jump| over ln ε.
        slope: f64,
        /// The largest jump of the input with each filter.
        jumps: Vec<FilteredInput>,
    },
}

/// The inputs of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmoothInput {
    /// What they are, as columns of a table are called.
    pub signal: String,
    /// The names of the agents.
    pub agents: Vec<String>,
    /// How many derivatives must not jump, the input itself counted; absent where nothing is promised.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuous: Option<usize>,
    /// The largest jump of the r-th derivative, for r = 0, 1, …; `null` where nothing that is heard jumps.
    pub derivatives: Vec<Option<LargestInputJump>>,
}

/// The largest jump of one derivative; where none jumps it is zero, and tells where that was seen first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LargestInputJump {
    /// How large it is, in `unit` over sʳ.
    pub jump: f64,
    /// The unit of the input.
    pub unit: String,
    /// The name of the agent.
    pub agent: String,
    /// The entry, in words; empty for inputs with one entry.
    pub entry: String,
    /// When, s.
    pub t_s: f64,
    /// Whether the graph changed; otherwise a delay jumped.
    pub switched: bool,
}

/// An agent of which nothing is said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NothingSaid {
    /// Its name.
    pub agent: String,
    /// Why.
    pub reason: String,
}

/// What one order gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SmoothOrder {
    /// ℓ.
    pub order: usize,
    /// When the disagreement has settled to 1 % of its start, s; absent when it has not by the end of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled_s: Option<f64>,
    /// The largest jump of the derivative of order ℓ − 1; `null` where nothing that is heard jumps.
    pub jump: Option<LargestInputJump>,
    /// Whether no derivative below jumps.
    pub kept: bool,
}

/// What one filter gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FilteredInput {
    /// ε, s.
    pub filter_s: f64,
    /// The largest jump of the input.
    pub jump: LargestInputJump,
}

impl SmoothnessDocument {
    /// With these scenarios.
    pub fn new(version: &str, scenarios: Vec<SmoothScenario>) -> Self {
        SmoothnessDocument { format: SMOOTHNESS_FORMAT, version: version.to_owned(), scenarios }
    }

    /// It as indented JSON.
    ///
    /// # Errors
    /// Those of `serde_json`, which has none for a document of this form.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self)
    }

    /// The JSON schema of this document.
    pub fn schema() -> Schema {
        schema_for!(SmoothnessDocument)
    }
}

impl SmoothScenario {
    /// What was `found` of a scenario.
    pub fn new(scenario: &Scenario, found: SmoothnessFound) -> Self {
        SmoothScenario { name: scenario.name.clone(), title: scenario.title.clone(), found }
    }
}

impl SmoothnessFound {
    /// Of a scenario as it is.
    pub fn as_it_is(setup: &Setup, found: &Smoothness) -> Self {
        let input = |kind: Covered| SmoothInput {
            signal: kind.signal.name(),
            agents: found.agents_of(kind).into_iter().map(|agent| names::agent_name(setup, agent)).collect(),
            continuous: kind.continuous,
            derivatives: (0..kind.derivatives)
                .map(|r| found.largest(kind, r).map(|jump| largest(setup, jump)))
                .collect(),
        };
        let nothing = |(agent, said): (usize, &Result<Vec<Covered>, NotCovered>)| {
            let reason = said.as_ref().err()?.to_string();
            Some(NothingSaid { agent: names::agent_name(setup, agent), reason })
        };
        SmoothnessFound::AsItIs {
            switches: found.switches,
            delay_jumps: found.delay_jumps,
            kept: found.kept(),
            inputs: found.kinds().into_iter().map(input).collect(),
            not_covered: found.agents.iter().enumerate().filter_map(nothing).collect(),
        }
    }

    /// Of several orders.
    pub fn orders(setup: &Setup, found: &[OfOrder]) -> Self {
        let order = |of: &OfOrder| SmoothOrder {
            order: of.order,
            settled_s: of.settled_s,
            jump: of.jump.map(|jump| largest(setup, jump)),
            kept: of.kept,
        };
        SmoothnessFound::Orders(found.iter().map(order).collect())
    }

    /// Of several filters.
    pub fn filters(setup: &Setup, found: &Filters) -> Self {
        let jumps = found.jumps.iter();
        let jumps = jumps.map(|of| FilteredInput { filter_s: of.filter_s, jump: largest(setup, of.jump) }).collect();
        SmoothnessFound::Filters { slope: found.slope, jumps }
    }
}

fn largest(setup: &Setup, jump: LargestJump) -> LargestInputJump {
    LargestInputJump {
        jump: jump.size,
        unit: names::unit(setup, jump.agent, jump.signal, jump.axis),
        agent: names::agent_name(setup, jump.agent),
        entry: names::entry_words(setup, jump.agent, jump.signal, jump.axis),
        t_s: jump.t_s,
        switched: jump.switched,
    }
}
