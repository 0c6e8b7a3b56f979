//! Why a scenario is refused.

use forwardstep_sim::SetupError;
use thiserror::Error;

use super::FORMAT;
use super::kinds::KindProblem;
use super::network_problem::NetworkProblem;
use super::push_problem::PushProblem;
use super::refusal;
use super::system_problem::SystemProblem;
use super::table::TableProblem;
use super::value_problem::ValueProblem;
use crate::files::ReadError;
use crate::wording::{axes, choose, entry_count, for_shell};
use crate::{Meant, Problem, shown};

/// Why a scenario has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScenarioProblem {
    /// A value without meaning.
    #[error(transparent)]
    Value(#[from] ValueProblem),
    /// A target, a leader or a system without meaning.
    #[error(transparent)]
    System(#[from] SystemProblem),
    /// A version of the format that this program does not read.
    #[error("`format` is {found}, but this version reads format {FORMAT}")]
    Format {
        /// The version.
        found: i64,
        /// The file.
        file: String,
    },
    /// A file that is empty, or holds comments only.
    #[error("nothing is written in this file")]
    NothingWritten,
    /// A text that is clearly something else.
    #[error("this is {meant}, and no scenario")]
    Meant {
        /// What it is.
        meant: Meant,
        /// The file.
        file: String,
    },
    /// A name that would not work in tables.
    #[error("{name:?} cannot be the name of an agent")]
    AgentName {
        /// The name.
        name: String,
    },
    /// Two agents of one name.
    #[error("a second agent is named `{name}`; the first is on line {first_line}")]
    AgentTwice {
        /// The name.
        name: String,
        /// Where the first is.
        first_line: usize,
    },
    /// More agents than can be simulated.
    #[error("there are {total} agents, but at most {most} are accepted")]
    TooManyAgents {
        /// How many there are.
        total: u64,
        /// How many are accepted.
        most: u64,
    },
    /// Agents that can never agree, because their positions have different lengths.
    #[error("`{first}` has {} and `{other}` has {other_axes}, but all agents of a scenario need as many", axes(*.first_axes))]
    AxesDiffer {
        /// The first agent.
        first: String,
        /// Its number of axes.
        first_axes: usize,
        /// The agent that differs.
        other: String,
        /// Its number of axes.
        other_axes: usize,
    },
    /// A robot file that cannot be read.
    #[error("cannot read the robot file `{file}`: {reason}")]
    RobotFile {
        /// The name as written.
        file: String,
        /// Why not.
        reason: ReadError,
        /// What might be meant.
        known: Vec<String>,
    },
    /// A joint that cannot be locked.
    #[error(transparent)]
    Lock(Box<crate::urdf::UrdfProblem>),
    /// Limits are to be enforced where there are none.
    #[error("`enforce_limits` is true, but axis `{axis}` of `{agent}` has no effort limit")]
    NoEffortLimit {
        /// The agent.
        agent: String,
        /// The axis.
        axis: String,
    },
    /// A spread where there is nothing to differ from.
    #[error("`parameter_variation` is given, but there is no `count`")]
    SpreadOfOne,
    /// A robot that its spread has made impossible.
    #[error("with this spread the mass matrix of `{agent}` is not positive definite")]
    SpreadMassMatrix {
        /// The agent.
        agent: String,
    },
    /// A key whose unit is not that of the robot's axes.
    #[error("`{key}` does not fit `{agent}`, whose axis `{axis}` is measured in {unit}")]
    Unit {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// An axis with another unit.
        axis: String,
        /// Its unit.
        unit: &'static str,
        /// The key that fits any robot.
        any: &'static str,
    },
    /// An agent without roots.
    #[error("`{agent}` has no `roots_per_s`")]
    NoRoots {
        /// The agent.
        agent: String,
        /// The key of the reference dynamics.
        common: &'static str,
    },
    /// An agent's reference dynamics are of another kind than everybody's.
    #[error("`{agent}` cannot have reference dynamics of its own kind; those of all are `{common}`")]
    ReferenceDiffers {
        /// The agent.
        agent: String,
        /// The key of everybody's.
        common: &'static str,
        /// Whether an agent may state anything under it.
        own_roots: bool,
    },
    /// More derivatives than the reference dynamics have.
    #[error("`derivatives` has {}, but the reference of `{agent}` is of order {order}", entry_count(*.found))]
    Derivatives {
        /// How many there are.
        found: usize,
        /// The agent.
        agent: String,
        /// The order of its reference.
        order: usize,
    },
    /// An agent, or a population, that does not exist.
    #[error("there is no agent `{name}`")]
    NoSuchAgent {
        /// The name.
        name: String,
        /// The agents there are, and the populations where one may be named.
        agents: Vec<String>,
    },
    /// A table that has no meaning, or cannot be read.
    #[error(transparent)]
    Table(#[from] TableProblem),
    /// A network that has no meaning.
    #[error(transparent)]
    Network(#[from] NetworkProblem),
    /// A push that has no meaning.
    #[error(transparent)]
    Push(#[from] PushProblem),
    /// A goal that asks for nothing.
    #[error("the goal says nothing about the disagreement")]
    EmptyGoal,
    /// A threshold that is not used.
    #[error("`{key}` says nothing about agents that diverge")]
    ThresholdUnused {
        /// The threshold.
        key: &'static str,
    },
    /// Two goals.
    #[error("`disagreement_below` and `error_below` are both given")]
    TwoGoals,
    /// An error, but no target.
    #[error("`error_below` is about targets and leaders, but the agents agree with each other")]
    NothingTracked,
    /// A disagreement among agents that do not agree.
    #[error("`disagreement_below` is about agreement, but every agent follows a target or a leader")]
    NothingAgreed,
    /// A disagreement of one agent.
    #[error("`disagreement_below` compares agents, but there is one only")]
    OneAgent,
    /// What a kind finds wrong with its table.
    #[error(transparent)]
    Kind(KindProblem),
    /// What the closed loop refuses although every number by itself has a meaning.
    #[error("{0}")]
    Setup(SetupError),
}

impl Problem for ScenarioProblem {
    fn help(&self) -> Option<String> {
        let text = match self {
            ScenarioProblem::Value(problem) => return problem.help(),
            ScenarioProblem::System(problem) => return problem.help(),
            ScenarioProblem::Format { found: 1, file } => {
                format!("`forwardstep upgrade {}` converts it and prints what it renames", for_shell(&shown(file).to_string()))
            }
            ScenarioProblem::Format { found, .. } if *found > FORMAT => "use a later version of forwardstep".into(),
            ScenarioProblem::NothingWritten => {
                "`forwardstep new my-scenario.toml` writes a scenario to start from, and `forwardstep scenarios` lists those that are there".into()
            }
            ScenarioProblem::Meant { meant, file } => meant.given_as_scenario(&shown(file).to_string()),
            ScenarioProblem::AgentName { .. } => "use up to 64 letters, digits, `-` and `_`".into(),
            ScenarioProblem::AgentTwice { .. } => {
                "agents of a counted population are named after it: `arm` with `count = 2` gives `arm-1` and `arm-2`"
                    .into()
            }
            ScenarioProblem::AxesDiffer { .. } => {
                "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF".into()
            }
            ScenarioProblem::RobotFile { reason, .. } if reason.help().is_some() => {
                reason.help().unwrap_or_default().into()
            }
            ScenarioProblem::RobotFile { file, known, .. } if !known.is_empty() => choose(file, "there are", known),
            ScenarioProblem::Lock(problem) => return problem.help(),
            ScenarioProblem::NoEffortLimit { .. } => {
                "only a URDF states limits, as <limit effort=\"…\"> of a joint".into()
            }
            ScenarioProblem::SpreadOfOne => "a population of `count = 1` may have a spread, too".into(),
            ScenarioProblem::SpreadMassMatrix { .. } => {
                "some body has an inertia that no body can have; correct it, or let `relative` be smaller".into()
            }
            ScenarioProblem::Unit { any, .. } => format!("`{any}` takes rad or m as each axis has it"),
            ScenarioProblem::NoRoots { common, .. } => {
                format!("add `roots_per_s` to [reference.{common}], or `reference.{common}.roots_per_s` to the agent")
            }
            ScenarioProblem::ReferenceDiffers { own_roots: false, .. } => {
                "remove it: these dynamics have nothing that an agent could have of its own".into()
            }
            ScenarioProblem::ReferenceDiffers { common, .. } => {
                format!("an agent may have `reference.{common}` with roots and a gain of its own")
            }
            ScenarioProblem::Derivatives { .. } => "an order of l has the derivatives 1 to l − 1".into(),
            ScenarioProblem::NoSuchAgent { name, agents } => choose(name, "the agents are", agents),
            ScenarioProblem::Table(problem) => return problem.help(),
            ScenarioProblem::Network(problem) => return problem.help(),
            ScenarioProblem::Push(problem) => return problem.help(),
            ScenarioProblem::EmptyGoal => {
                "set `disagreement_below = 1e-3` (with targets `error_below`), or `expect = \"diverges\"`, or delete the goal".into()
            }
            ScenarioProblem::ThresholdUnused { .. } | ScenarioProblem::TwoGoals => "delete one of the two".into(),
            ScenarioProblem::NothingTracked => "write `disagreement_below`".into(),
            ScenarioProblem::NothingAgreed => "write `error_below`".into(),
            ScenarioProblem::OneAgent => "leave `[goal]` out, or give it others to agree with by `count` or another `[[agents]]`".into(),
            ScenarioProblem::Kind(problem) => return problem.help(),
            ScenarioProblem::Setup(error) => return refusal::advice(error),
            _ => return None,
        };
        Some(text)
    }
}
