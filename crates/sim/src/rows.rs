//! Who takes the rows of a run.

use std::ops::ControlFlow;

use crate::recording::Recording;

/// Takes the rows of a run as they are recorded, in the order of time. A [`Recording`] is one that keeps them in memory.
pub trait RowSink {
    /// A row: its time, s, and one value per column, in the order of [`crate::recorded_columns`].
    fn row(&mut self, t_s: f64, values: &[f64]);

    /// A step has ended; rows that wait somewhere need not wait for the next row. Whoever says stop interrupts the run.
    fn step(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl RowSink for Recording {
    fn row(&mut self, t_s: f64, values: &[f64]) {
        self.t_s.push(t_s);
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.values.push(*value);
        }
    }
}
