//! How far agents are apart, or from where they should be.

use forwardstep_check::prediction::only_passes;
use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::setup::Setup;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::number;
use super::table::Table;

/// What is to vanish in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    /// Between agents.
    Disagreement,
    /// Between agents and their targets, or their leader.
    Error,
}

impl Gap {
    /// What is to vanish in a run of `setup`.
    pub fn of(setup: &Setup) -> Gap {
        if setup.reference.interface().family.is_followed() { Gap::Error } else { Gap::Disagreement }
    }

    /// `Disagreement` or `Error`.
    pub fn name(self) -> &'static str {
        match self {
            Gap::Disagreement => "Disagreement",
            Gap::Error => "Error",
        }
    }

    /// The name in the middle of a sentence.
    pub fn word(self) -> &'static str {
        match self {
            Gap::Disagreement => "disagreement",
            Gap::Error => "error",
        }
    }

    /// How it is measured.
    pub fn formula(self, setup: &Setup) -> &'static str {
        let several = setup.agents.iter().any(|agent| agent.robot.axes.len() > 1);
        match (self, several) {
            (Gap::Disagreement, _) if Gap::keeps_offsets(setup) => {
                "max |yᵢ − yⱼ| of any coordinate, y = q less its offset"
            }
            (Gap::Disagreement, true) => "max |qᵢ − qⱼ| of any coordinate",
            (Gap::Disagreement, false) => "max |qᵢ − qⱼ|",
            (Gap::Error, _) if setup.leading_agent().is_some() => {
                "max |error| of any coordinate: of the leader from its target, of the others from it"
            }
            (Gap::Error, true) => "max |error| of any coordinate",
            (Gap::Error, false) => "max |error|",
        }
    }

    /// Whether agents are to differ by offsets.
    pub fn keeps_offsets(setup: &Setup) -> bool {
        Gap::of(setup) == Gap::Disagreement && setup.agents.iter().any(|agent| agent.target.is_some())
    }
}

/// max |q_i − q_j| over agents and axes, less their offsets, or max |error| where agents have targets; rad or m. Or why
/// there is no such number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Disagreement {
    /// At the first and last row, and the largest of all rows.
    Measured {
        /// At the first row.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        initial: f64,
        /// At the last row.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        last: f64,
        /// The largest of all rows.
        #[serde(deserialize_with = "number::or_nan")]
        #[schemars(with = "Option<f64>")]
        largest: f64,
        /// The last is as small as that of agents that agree, but only in passing.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        passes: bool,
    },
    /// There is none.
    Absent(Absence),
}

impl Disagreement {
    /// The disagreement at the first row.
    pub fn initial(&self) -> Option<f64> {
        match *self {
            Disagreement::Measured { initial, .. } => Some(initial),
            Disagreement::Absent(_) => None,
        }
    }

    /// The disagreement at the last row.
    pub fn last(&self) -> Option<f64> {
        match *self {
            Disagreement::Measured { last, .. } => Some(last),
            Disagreement::Absent(_) => None,
        }
    }
}

/// What is left of the disagreement when agents are said to have agreed.
const AGREED: f64 = 0.01;

impl Disagreement {
    /// Of a disagreement in the course of time.
    pub(super) fn over(t_s: &[f64], overall: &[f64]) -> Disagreement {
        let largest = overall.iter().copied().fold(0.0, greater);
        Disagreement::Measured {
            initial: overall.first().copied().unwrap_or(f64::NAN),
            last: overall.last().copied().unwrap_or(f64::NAN),
            largest,
            passes: only_passes(t_s, overall, AGREED * largest),
        }
    }

    /// Whether the last is at most 1 % of the largest, and not just on its way through. Whether that is enough is for the goal to say.
    pub fn is_agreement(&self) -> bool {
        match *self {
            Disagreement::Measured { last, largest, passes, .. } => last <= AGREED * largest && !passes,
            Disagreement::Absent(_) => false,
        }
    }
}

/// Why there is no disagreement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Absence {
    /// Nothing was recorded.
    NoRows,
    /// One agent alone, or none, agrees with itself.
    FewerThanTwoAgents,
    /// These agents have different numbers of axes.
    DifferentAxes {
        /// The first agent.
        first: usize,
        /// The one that differs from it.
        other: usize,
    },
    /// The positions of this agent were not recorded.
    NotRecorded {
        /// The agent.
        agent: usize,
    },
}

impl Absence {
    /// The reason in words.
    pub fn words(self) -> &'static str {
        match self {
            Absence::NoRows => "nothing was recorded",
            Absence::FewerThanTwoAgents => "there are no two agents to compare",
            Absence::DifferentAxes { .. } => "the agents do not have the same axes",
            Absence::NotRecorded { .. } => "not all positions were recorded",
        }
    }
}

/// The disagreement row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct DisagreementSeries {
    /// Over all axes.
    pub overall: Vec<f64>,
    /// On each axis.
    pub per_axis: Vec<Vec<f64>>,
}

impl DisagreementSeries {
    /// max |q_i − q_j| at every row.
    ///
    /// # Errors
    /// [`Absence`] when the agents cannot be compared.
    pub fn of(setup: &Setup, recording: &Recording) -> Result<Self, Absence> {
        Self::of_table(&Table::new(setup, recording))
    }

    pub(crate) fn of_table(table: &Table<'_>) -> Result<Self, Absence> {
        if Gap::of(table.setup) == Gap::Error {
            return Self::of_errors(table);
        }
        let agents = &table.setup.agents;
        let [first, others @ ..] = agents.as_slice() else { return Err(Absence::FewerThanTwoAgents) };
        if others.is_empty() {
            return Err(Absence::FewerThanTwoAgents);
        }
        // Agreement is on numbers: an arm in rad and a cart in m can agree.
        let differs = |other: &forwardstep_sim::AgentSetup| other.robot.axes.len() != first.robot.axes.len();
        if let Some(other) = others.iter().position(differs) {
            return Err(Absence::DifferentAxes { first: 0, other: other + 1 });
        }
        if table.t_s.is_empty() {
            return Err(Absence::NoRows);
        }
        let rows = table.t_s.len();
        let mut per_axis = Vec::new();
        for axis in 0..first.robot.axes.len() {
            let mut low = vec![f64::INFINITY; rows];
            let mut high = vec![f64::NEG_INFINITY; rows];
            for agent in 0..agents.len() {
                let q = table.column(agent, Signal::Position, axis).ok_or(Absence::NotRecorded { agent })?;
                let offset = table.column(agent, Signal::Offset, axis);
                for row in 0..rows {
                    let away = offset.and_then(|offset| offset.get(row)).copied().unwrap_or(0.0);
                    let q = q.get(row).map_or(f64::NAN, |q| q - away);
                    low[row] = lesser(low[row], q);
                    high[row] = greater(high[row], q);
                }
            }
            per_axis.push(low.iter().zip(&high).map(|(low, high)| apart(*low, *high)).collect::<Vec<_>>());
        }
        Ok(Self::largest(rows, per_axis))
    }

    /// The largest |error| of all agents.
    fn of_errors(table: &Table<'_>) -> Result<Self, Absence> {
        let rows = table.t_s.len();
        if rows == 0 {
            return Err(Absence::NoRows);
        }
        let mut per_axis: Vec<Vec<f64>> = Vec::new();
        for agent in 0..table.setup.agents.len() {
            let mut axis = 0;
            while let Some(errors) = table.column(agent, Signal::Error, axis) {
                if per_axis.len() <= axis {
                    per_axis.push(vec![0.0; rows]);
                }
                for (worst, error) in per_axis[axis].iter_mut().zip(errors) {
                    *worst = greater(*worst, error.abs());
                }
                axis += 1;
            }
            if axis == 0 {
                return Err(Absence::NotRecorded { agent });
            }
        }
        Ok(Self::largest(rows, per_axis))
    }

    fn largest(rows: usize, per_axis: Vec<Vec<f64>>) -> Self {
        let overall = (0..rows).map(|row| per_axis.iter().map(|axis| axis[row]).fold(0.0, greater)).collect();
        DisagreementSeries { overall, per_axis }
    }
}

/// Differences that are smaller are not asked for, rad or m.
const FINEST: f64 = 1e-9;

/// The difference of two positions. Of numbers so large that their last digit is coarser than what anybody asks for, it is not less than that
/// digit: those that run away together have not agreed because they are rounded to the same number.
fn apart(low: f64, high: f64) -> f64 {
    let digit = f64::EPSILON * greater(low.abs(), high.abs());
    if digit > FINEST && digit.is_finite() { greater(high - low, digit) } else { high - low }
}

/// The greater of two numbers, NaN as soon as one is.
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

fn lesser(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// Whether the disagreement ends non-finite or exceeds, in the last quarter of the rows, all of the first quarter.
pub(crate) fn grows(setup: &Setup, recording: &Recording) -> bool {
    let Ok(series) = DisagreementSeries::of(setup, recording) else { return false };
    let overall = &series.overall;
    let quarter = overall.len().div_ceil(4);
    let largest = |part: &[f64]| part.iter().copied().fold(0.0, greater);
    let last = largest(&overall[overall.len() - quarter..]);
    !last.is_finite() || last > largest(&overall[..quarter])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_decides_whether_agreement_was_reached() {
        let measured = |last: f64| Disagreement::over(&[0.0, 1.0, 200.0], &[1.0, 2.0, last]).is_agreement();
        assert_eq!([0.0, 0.02, 0.021, 2.0, f64::NAN].map(measured), [true, true, false, false, false]);
    }

    #[test]
    fn regress_numbers_that_run_away_together_are_as_far_apart_as_they_are_coarse() {
        assert_eq!([apart(1e25, 1e25), apart(-1e25, -1e25)], [f64::EPSILON * 1e25; 2]);
        assert_eq!(apart(1e25, 2e25), 1e25);
        assert_eq!([apart(3.0, 3.0), apart(1e6, 1e6), apart(-2.0, 1.5)], [0.0, 0.0, 3.5]);
        assert!(apart(1e7, 1e7) > FINEST);
        assert!([[1.0, f64::NAN], [f64::NAN, 1e25]].iter().all(|[low, high]| apart(*low, *high).is_nan()));
        assert_eq!(apart(f64::NEG_INFINITY, 1.0), f64::INFINITY);
    }
}
