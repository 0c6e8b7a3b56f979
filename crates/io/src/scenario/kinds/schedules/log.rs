//! `switching.log`: phases replayed from a file.

use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::{Logged, Schedule};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, Faults, between, fault};
use super::super::super::network::PhaseReader;
use super::super::super::network_problem::NetworkProblem;
use super::super::super::table::{Column, TableProblem, all_rising, cell_number, read_table, table_text};
use super::super::KindTable;
use super::ScheduleKind;

/// The phases in the order and for the times of a table.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwitchingLogFile {
    /// The CSV file, beside the scenario file or in `inputs` beside it. Its first line names its columns: `t_s`, rising from 0, and
    /// `phase`, the number of the phase that begins there, from 1. It is empty in the last line, which says when the last phase
    /// ends. A run whose phases are drawn writes such a file, `phases.csv`.
    pub file: At<String>,
}

impl ScheduleKind for SwitchingLogFile {
    fn table() -> KindTable {
        KindTable { key: "log", description: "Replayed from a CSV file." }
    }

    fn schedule(&self, graphs: Vec<Vec<Edge>>, phases: &mut PhaseReader<'_, '_>) -> Result<Schedule, Fault> {
        (0..phases.count()).for_each(|phase| phases.unused_dwell(phase));
        let source = table_text(&self.file, phases.network().folder())?;
        let (count, end_s) = (graphs.len(), phases.network().end_s());
        let log = log_of(source.text(), count, end_s).map_err(|fault| fault.within_table(&source, &self.file))?;
        Ok(Schedule::logged(graphs, log))
    }
}

/// The lines of a table; the last one is the end.
fn log_of(text: &str, phases: usize, end_s: f64) -> Result<Logged, Fault> {
    let columns = ["t_s", "phase"].map(|name| Column { name, required: name == "t_s" });
    let (mut times, mut graphs, mut ended) = (Vec::new(), Vec::new(), false);
    let mut faults = Faults::default();
    for At { value: [t_s, phase], span } in read_table(text, columns, &mut faults)? {
        if phase.span == span {
            let columns = columns.map(|column| column.name.to_owned()).to_vec();
            return Err(Fault::new(TableProblem::MissingColumn { name: "phase".into(), columns }));
        }
        let (t_s, phase) = (faults.noted(cell_number(&t_s)), faults.noted(cell_number(&phase)));
        let (Some(Some(t_s)), Some(phase)) = (t_s, phase) else { continue };
        if ended {
            faults.add(|| fault(&t_s, NetworkProblem::AfterTheEnd));
            continue;
        }
        times.push(t_s);
        match phase {
            None => ended = true,
            Some(phase) => graphs.extend(faults.noted(numbered(&phase, phases))),
        }
    }
    all_rising("t_s", &times, &mut faults);
    faults.end()?;
    let Some(last) = times.pop_if(|_| ended) else { return Err(Fault::new(NetworkProblem::NoEnd)) };
    if last.value < end_s {
        return Err(fault(&last, NetworkProblem::LogEndsEarly { until_s: last.value, end_s }));
    }
    match times.first() {
        Some(first) if first.value == 0.0 => {}
        Some(first) => return Err(fault(first, NetworkProblem::StartsLate)),
        None => return Err(fault(&last, NetworkProblem::StartsLate)),
    }
    let starts_s = times.iter().map(|time| time.value + 0.0).collect();
    Ok(Logged { starts_s, graphs, until_s: last.value })
}

/// The index of a phase that is numbered from one.
fn numbered(phase: &At<f64>, phases: usize) -> Result<usize, Fault> {
    let number = between("phase", phase, 1.0, phases as f64)?;
    if number.fract() == 0.0 {
        Ok(number as usize - 1)
    } else {
        Err(fault(phase, NetworkProblem::NotANumber { found: number }))
    }
}
