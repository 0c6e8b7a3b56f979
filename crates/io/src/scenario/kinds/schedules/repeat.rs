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
        let dwell_s: Vec<f64> = (0..phases.count()).map(|phase| phases.dwell_s(phase)).collect::<Result<_, _>>()?;
        let (round_s, span): (f64, _) = (dwell_s.iter().sum(), phases.span().clone());
        let switches = phases.network().end_s() / round_s * dwell_s.len() as f64;
        phases.network().few("switches", switches, &span)?;
        Ok(Schedule::new(graphs, Periodic { dwell_s }))
    }
}
