//! `switching = "repeat"`: the phases in turn, again and again.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::{Periodic, Schedule};

use super::super::super::fault::Fault;
use super::super::super::network::PhaseReader;
use super::super::KindTable;
use super::ScheduleKind;

/// In turn, again and again.
#[derive(Clone, Copy, Debug, Default)]
pub struct RepeatFile;

impl ScheduleKind for RepeatFile {
    fn table() -> KindTable {
        KindTable { key: "repeat", description: "In turn, again and again." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        let dwell_s = (0..phases.count()).map(|phase| phases.dwell_s(phase)).collect::<Result<_, _>>()?;
        Ok(Schedule::new(graphs, Periodic { dwell_s }))
    }
}
