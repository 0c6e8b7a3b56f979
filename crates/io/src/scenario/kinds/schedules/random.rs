//! `switching.random`: phases drawn at random.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, fault, positive, seed};
use super::super::super::network::PhaseReader;
use super::super::super::value_problem::ValueProblem;
use super::super::super::values::Positive;
use super::super::KindTable;
use super::ScheduleKind;

/// At every switch one of the phases is drawn, each equally likely.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomSwitchingFile {
    /// The same seed gives the same switches, always.
    #[schemars(range(min = 0))]
    seed: At<i64>,
    /// Shortest and longest dwell, in s.
    #[schemars(with = "[Positive; 2]")]
    dwell_s: At<[At<f64>; 2]>,
}

impl ScheduleKind for RandomSwitchingFile {
    fn table() -> KindTable {
        KindTable { key: "random", description: "Drawn at random." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        (0..phases.count()).for_each(|phase| phases.unused_dwell(phase));
        let [low, high] = &self.dwell_s.value;
        let dwell_s = [positive("dwell_s", low)?, positive("dwell_s", high)?];
        if dwell_s[0] > dwell_s[1] {
            let problem = ValueProblem::Interval { key: "dwell_s", low: dwell_s[0], high: dwell_s[1] };
            return Err(fault(&self.dwell_s, problem));
        }
        let network = phases.network();
        network.few("switches", 2.0 * network.end_s() / (dwell_s[0] + dwell_s[1]), &self.dwell_s.span)?;
        Ok(Schedule::random(graphs, dwell_s, seed(&self.seed)?))
    }
}
