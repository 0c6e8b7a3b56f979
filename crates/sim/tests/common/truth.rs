//! What programs that share nothing with this one have computed, see `validation`.

use std::collections::BTreeMap;

use forwardstep_sim::{Method, Setup};
use serde::Deserialize;

use super::run;

/// One closed loop.
#[derive(Deserialize)]
pub struct Truth {
    pub name: String,
    /// The k-th time is k times the first.
    pub t_s: Vec<f64>,
    /// By agent and by the name of the signal: rows by time, with an entry per axis.
    pub agents: Vec<BTreeMap<String, Vec<Vec<f64>>>>,
}

/// The closed loops in a file.
pub fn read(text: &str) -> Vec<Truth> {
    serde_json::from_str(text).unwrap()
}

impl Truth {
    /// Runs `setup` at tight tolerances; the largest difference from what is known, as a part of numbers above one.
    pub fn largest_difference(&self, mut setup: Setup) -> f64 {
        setup.time.record_every_s = self.t_s[0];
        setup.time.end_s = self.t_s[0] * (self.t_s.len() as f64 + 0.5);
        setup.solver.method = Method::Adaptive { rtol: 1e-11, atol: 1e-12 };
        let outcome = run(&setup);
        let mut worst = 0.0_f64;
        for (agent, signals) in self.agents.iter().enumerate() {
            for (name, rows) in signals {
                let mine = outcome.recording.columns.iter().filter(|c| c.agent == agent && c.signal.name() == *name);
                let columns: Vec<&[f64]> = mine.map(|column| &column.values[..]).collect();
                assert_eq!(columns.len(), rows[0].len(), "{}: entries of {name} of agent {agent}", self.name);
                for (row, wanted) in rows.iter().enumerate() {
                    for (column, want) in columns.iter().zip(wanted) {
                        worst = worst.max((column[row + 1] - want).abs() / want.abs().max(1.0));
                    }
                }
            }
        }
        worst
    }
}
