//! A recording with its columns found by agent, signal and axis.

use std::collections::HashMap;

use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::setup::Setup;

/// Columns of a table as they stand in a file, by their names.
pub(crate) type NamedColumns = Vec<(String, Vec<f64>)>;

/// Looks columns up; the map is never walked, so its order does not matter.
pub(crate) struct Table<'a> {
    pub(crate) setup: &'a Setup,
    pub(crate) t_s: &'a [f64],
    columns: HashMap<(usize, Signal, usize), &'a [f64]>,
}

impl<'a> Table<'a> {
    pub(crate) fn new(setup: &'a Setup, recording: &'a Recording) -> Self {
        let rows = recording.t_s.len();
        let columns = recording
            .columns
            .iter()
            .map(|c| ((c.agent, c.signal, c.axis), &c.values[..c.values.len().min(rows)]))
            .collect();
        Table { setup, t_s: &recording.t_s, columns }
    }

    pub(crate) fn agents(&self) -> usize {
        self.setup.agents.len()
    }

    pub(crate) fn dof(&self, agent: usize) -> usize {
        self.setup.agents.get(agent).map_or(0, |a| a.robot.axes.len())
    }

    pub(crate) fn largest_dof(&self) -> usize {
        (0..self.agents()).map(|agent| self.dof(agent)).max().unwrap_or(0)
    }

    /// How many entries of a signal of an agent were recorded.
    pub(crate) fn entries(&self, agent: usize, signal: Signal) -> usize {
        (0..).take_while(|entry| self.column(agent, signal, *entry).is_some()).count()
    }

    /// The values of a column, or nothing when it was not recorded.
    pub(crate) fn column(&self, agent: usize, signal: Signal, axis: usize) -> Option<&'a [f64]> {
        self.columns.get(&(agent, signal, axis)).copied()
    }

    /// All (agent, axis) pairs of the setup with the column of `signal`, where there is one.
    pub(crate) fn axes(&self, signal: Signal) -> impl Iterator<Item = (usize, usize, &'a [f64])> + '_ {
        (0..self.agents()).flat_map(move |agent| {
            (0..self.dof(agent)).filter_map(move |axis| Some((agent, axis, self.column(agent, signal, axis)?)))
        })
    }
}
