//! `switching.random`: phases drawn at random.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, seed};
use super::super::super::network::PhaseReader;
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
    dwell_s: [f64; 2],
}

impl ScheduleKind for RandomSwitchingFile {
    fn table() -> KindTable {
        KindTable { key: "random", description: "Drawn at random." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        (0..phases.count()).for_each(|phase| phases.unused_dwell(phase));
        Ok(Schedule::random(graphs, self.dwell_s, seed(&self.seed)?))
    }
}
