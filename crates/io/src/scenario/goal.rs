//! What a scenario expects of its run.

use forwardstep_sim::Setup;

use super::at::At;
use super::fault::{Fault, fault, positive};
use super::file::{ExpectFile, GoalFile};
use super::problem::ScenarioProblem;

/// What a scenario asks of its run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The run completes and max |q_i − q_j| at its end is below this, rad or m.
    DisagreementBelow(f64),
    /// The run completes and no agent is further from its target on any axis at its end, rad or m.
    ErrorBelow(f64),
    /// The run must not agree: it breaks down, or its disagreement grows.
    ExpectDiverges,
}

impl Goal {
    /// The bound on what remains at the end, if it is one.
    pub fn bound(&self) -> Option<f64> {
        match *self {
            Goal::DisagreementBelow(bound) | Goal::ErrorBelow(bound) => Some(bound),
            Goal::ExpectDiverges => None,
        }
    }

    /// The goal in words.
    pub fn words(&self) -> String {
        match self {
            Goal::DisagreementBelow(bound) => format!("disagreement below {bound} at the end"),
            Goal::ErrorBelow(bound) => format!("error below {bound} at the end"),
            Goal::ExpectDiverges => "the run is expected to diverge".into(),
        }
    }
}

/// Reads the `[goal]` of a setup.
pub(super) fn goal(file: &At<GoalFile>, setup: &Setup) -> Result<Goal, Fault> {
    let GoalFile { disagreement_below, error_below, expect } = &file.value;
    if let (Some(_), Some(second)) = (disagreement_below, error_below) {
        return Err(fault(second, ScenarioProblem::TwoGoals));
    }
    let below = disagreement_below.as_ref().map(|below| ("disagreement_below", below));
    let below = below.or(error_below.as_ref().map(|below| ("error_below", below)));
    match (expect.as_ref().map(|expect| expect.value), below) {
        (Some(ExpectFile::Diverges), None) => Ok(Goal::ExpectDiverges),
        (Some(ExpectFile::Diverges), Some((key, below))) => Err(fault(below, ScenarioProblem::ThresholdUnused { key })),
        (_, None) => Err(fault(file, ScenarioProblem::EmptyGoal)),
        (_, Some((key, below))) => {
            let bound = positive(key, below)?;
            match (key, setup.reference.interface().family.is_followed()) {
                ("error_below", true) => Ok(Goal::ErrorBelow(bound)),
                ("error_below", false) => Err(fault(below, ScenarioProblem::NothingTracked)),
                (_, true) => Err(fault(below, ScenarioProblem::NothingAgreed)),
                (_, false) if setup.agents.len() < 2 => Err(fault(below, ScenarioProblem::OneAgent)),
                (_, false) => Ok(Goal::DisagreementBelow(bound)),
            }
        }
    }
}
