//! `switching = "once"`: the phases in turn, the last of which stays.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::{Once, Schedule};

use super::super::super::fault::Fault;
use super::super::super::network::PhaseReader;
use super::super::KindTable;
use super::ScheduleKind;

/// In turn; the last one stays for ever.
#[derive(Clone, Copy, Debug, Default)]
pub struct OnceFile;

impl ScheduleKind for OnceFile {
    fn table() -> KindTable {
        KindTable { key: "once", description: "In turn; the last one stays for ever." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        let last = phases.count() - 1;
        phases.unused_dwell(last);
        let dwell_s = (0..last).map(|phase| phases.dwell_s(phase)).collect::<Result<_, _>>()?;
        Ok(Schedule::new(graphs, Once { dwell_s }))
    }
}
