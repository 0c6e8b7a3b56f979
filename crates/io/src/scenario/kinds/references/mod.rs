//! The reference dynamics that scenario files know: for each the struct of its table.

pub mod backstepping;
pub mod consensus;
pub mod desired;
pub mod leader;
pub mod tracking;

use std::fmt;
use std::sync::Arc;

use forwardstep_sim::leader::{Leader, Leading};
use forwardstep_sim::{Exchange, ReferenceDynamics};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::at::At;
use super::super::fault::{Fault, fault};
use super::super::file::ScenarioFile;
use super::super::inputs::InputFolder;
use super::super::leader_file::LeaderFile;
use super::super::problem::ScenarioProblem;
use super::super::roots::{RootFile, RootsFile};
use super::super::system_problem::SystemProblem;
use super::super::target::{Owner, target};

/// A kind of reference dynamics in scenario files: its table, as it was read.
pub trait ReferenceKind: fmt::Debug {
    /// What the list says of it.
    fn table() -> ReferenceTable
    where
        Self: Sized;

    /// What all agents share.
    ///
    /// # Errors
    /// The first mistake, at its place.
    fn read(&self, reader: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault>;
}

/// What the list of kinds says of reference dynamics.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceTable {
    /// Their key in `reference`.
    pub key: &'static str,
    /// What they are, in a sentence, for the schema.
    pub description: &'static str,
    /// Whether an agent may state roots, and a gain λ, of its own.
    pub own_roots: bool,
}

/// Reference dynamics, and what their table says for agents that say nothing of their own.
#[derive(Clone, Debug)]
pub struct ReferenceRead {
    /// They as data.
    pub dynamics: Arc<dyn ReferenceDynamics>,
    /// What the agents tell each other.
    pub exchange: Exchange,
    /// The roots of all agents without their own.
    pub roots_per_s: Option<RootsFile>,
    /// λ of all agents without their own.
    pub manipulability_gain: Option<At<f64>>,
}

impl ReferenceRead {
    /// Dynamics without roots.
    pub fn new(dynamics: impl ReferenceDynamics, exchange: Exchange) -> Self {
        ReferenceRead { dynamics: Arc::new(dynamics), exchange, roots_per_s: None, manipulability_gain: None }
    }
}

/// What else reference dynamics can ask the file for.
#[derive(Debug)]
pub struct ReferenceReader<'a> {
    leader: Option<&'a At<LeaderFile>>,
    /// Whether [`ReferenceReader::leader`] was asked for.
    asked: bool,
    /// The agents, and what their axes are called.
    names: &'a [String],
    axes: &'a [String],
    end_s: f64,
    sampled: bool,
    folder: &'a mut InputFolder,
}

/// The name of a leader that has none.
const LEADER: &str = "leader";

impl<'a> ReferenceReader<'a> {
    pub(in super::super) fn new(
        file: &'a ScenarioFile,
        [names, axes]: [&'a [String]; 2],
        end_s: f64,
        folder: &'a mut InputFolder,
    ) -> Self {
        let (leader, sampled) = (file.leader.as_ref(), file.control.is_some());
        ReferenceReader { leader, asked: false, names, axes, end_s, sampled, folder }
    }

    /// What the axes of the agents are called.
    pub fn axes(&self) -> &[String] {
        self.axes
    }

    /// Whether controllers sample.
    pub fn sampled(&self) -> bool {
        self.sampled
    }

    /// The leader of the file. One that is not asked for is refused.
    ///
    /// # Errors
    /// When there is none, or it has a mistake.
    pub fn leader(&mut self) -> Result<Leading, Fault> {
        self.asked = true;
        let place = self.leader.ok_or_else(|| Fault::new(SystemProblem::NoLeader))?;
        let leader = &place.value;
        let motion = match (&leader.motion, &leader.agent) {
            (Some(motion), None) => motion,
            (None, Some(agent)) => {
                if let Some(name) = &leader.name {
                    return Err(fault(name, SystemProblem::LeaderNamedTwice { agent: agent.value.clone() }));
                }
                let index = self.names.iter().position(|name| *name == agent.value);
                let unknown =
                    || ScenarioProblem::NoSuchAgent { name: agent.value.clone(), agents: self.names.to_vec() };
                return index.map(Leading::Agent).ok_or_else(|| fault(agent, unknown()));
            }
            (Some(_), Some(agent)) => return Err(fault(agent, SystemProblem::TwoLeaders)),
            (None, None) => return Err(fault(place, SystemProblem::NoMotion)),
        };
        let name = match &leader.name {
            None => LEADER.to_owned(),
            Some(name) => super::super::agents::checked_name(name)?.to_owned(),
        };
        let owner = Owner { name: &name, axes: self.axes, quaternion: None, end_s: self.end_s };
        let trajectory = target(motion, &owner, self.folder)?;
        Ok(Leading::Motion(Leader { name, trajectory }))
    }

    /// Refuses a leader that the reference dynamics under `key` did not ask for.
    pub(in super::super) fn refuse_unused(&self, key: &'static str) -> Result<(), Fault> {
        match self.leader {
            Some(leader) if !self.asked => Err(fault(leader, SystemProblem::LeaderUnused { reference: key })),
            _ => Ok(()),
        }
    }
}

/// What an agent states of its own, under the key of everybody's reference dynamics.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgentReferenceTable {
    /// The positive numbers κ₀, κ₁, … in 1/s of this agent, and pairs of complex roots.
    #[schemars(with = "Option<Vec<RootFile>>", length(min = 1))]
    pub roots_per_s: Option<RootsFile>,
    /// The gain λ of Remark 4 of this agent.
    pub manipulability_gain: Option<At<f64>>,
}
