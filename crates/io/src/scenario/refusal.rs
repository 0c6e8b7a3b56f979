//! What the closed loop refuses although every number by itself has a meaning: where in the scenario it stands, and what to do.

use std::ops::Range;
use std::rc::Rc;

use forwardstep_core::controller::ChainError;
use forwardstep_sim::{AgentSetup, SetupError, VelocityQuantity};

use super::agents::names;
use super::at::At;
use super::control_file::ControlFile;
use super::document::KeyedLaw;
use super::fault::Fault;
use super::file::{AgentFile, AgentReferenceFile, ConsensusFile, ReferenceFile, ScenarioFile};
use super::kinds::LawKind;
use super::problem::ScenarioProblem;

type Span = Range<usize>;

/// The tables of the agents' laws.
pub(super) struct Laws<'a> {
    pub(super) agents: &'a [AgentSetup],
    pub(super) tables: &'a [Rc<KeyedLaw>],
}

impl Laws<'_> {
    fn of(&self, agent: &str) -> Option<&dyn LawKind> {
        let index = self.agents.iter().position(|known| known.name == agent)?;
        self.tables.get(index).map(|law| &*law.1)
    }
}

/// The error at its place in the file.
pub(super) fn refused(file: &ScenarioFile, laws: &Laws<'_>, error: SetupError) -> Fault {
    let place = place(file, laws, &error);
    let fault = Fault::new(ScenarioProblem::Setup(error));
    match place {
        Some(span) => fault.at(&span),
        None => fault,
    }
}

/// What the error is about, as closely as it is written.
fn place(file: &ScenarioFile, laws: &Laws<'_>, error: &SetupError) -> Option<Span> {
    let law = |agent: &str| laws.of(agent).and_then(|law| law.place(error)).or_else(|| law(file, agent));
    let reference = || Some(file.reference.span.clone());
    let exchange = || common(file).map(|file| file.exchange.span.clone()).or_else(reference);
    match error {
        SetupError::Coupling => file.network.as_ref()?.value.coupling.as_ref().map(|coupling| coupling.span.clone()),
        SetupError::BacksteppingExchange | SetupError::FollowingExchange | SetupError::OnlyTracks { .. } => reference(),
        SetupError::StartOfReference { agent, .. } => start_of_reference(file, agent),
        SetupError::NobodyHears { .. } => file.network.as_ref().map(|network| network.span.clone()),
        SetupError::VelocityUnused { quantity, .. } => velocity(file.control.as_ref()?, *quantity),
        SetupError::DelayedDerived { .. } => match &file.reference.value {
            ReferenceFile::Leader(file) => Some(file.design.span.clone()),
            _ => reference(),
        },
        SetupError::SendsPositionOnly { .. } => exchange(),
        SetupError::NotTracking { .. } | SetupError::ReferenceOfLaw { .. } => reference(),
        SetupError::Roots { agent, .. } | SetupError::OrderTooLow { agent, .. } => roots(file, agent),
        SetupError::NoTarget { agent } | SetupError::Recipe { agent, .. } => {
            Some(entry(file, agent)?.name.span.clone())
        }
        SetupError::NoOffsets { agent, .. } => entry(file, agent)?.target.as_ref().map(|target| target.span.clone()),
        SetupError::UnitsDiffer { agent, .. }
        | SetupError::AxesDiffer { agent, .. }
        | SetupError::Spacecraft { agent, .. }
        | SetupError::NoEffortLimit { agent, .. } => Some(entry(file, agent)?.robot.span.clone()),
        SetupError::RootCount { agent, .. } => roots(file, agent),
        SetupError::TorqueLimitCount { of_rates, .. } => {
            let control = file.control.as_ref()?;
            let limit = if *of_rates { &control.torque_rate_limit_per_s } else { &control.torque_limit };
            limit.as_ref().map(|limit| limit.span.clone())
        }
        SetupError::Chain { agent, error } => match error {
            ChainError::Guide(_) => roots(file, agent),
            ChainError::Expression(_) => Some(entry(file, agent)?.robot.span.clone()),
            _ => law(agent),
        },
        SetupError::NoManipulability { agent, .. } => manipulability(file, agent),
        SetupError::Length { agent, .. }
        | SetupError::LawNumber { agent, .. }
        | SetupError::LawOfAnother { agent, .. }
        | SetupError::Gain { agent, .. }
        | SetupError::Tip { agent, .. }
        | SetupError::ProjectionOfMatrix { agent }
        | SetupError::BoundsOfKnown { agent }
        | SetupError::NotFinite { agent, .. } => law(agent),
        SetupError::Memory { .. } => {
            let written = file.solver.as_ref().and_then(|solver| solver.memory_budget_bytes.as_ref());
            let sampled = || file.control.as_ref().map(|control| control.sample_hz.span.clone());
            written.map(|bytes| bytes.span.clone()).or_else(sampled)
        }
        SetupError::Limiter { .. } | SetupError::VelocityFilter(_) | SetupError::Control { .. } => {
            file.control.as_ref().map(|control| control.sample_hz.span.clone())
        }
        _ => None,
    }
}

/// The entry that stands for this agent.
fn entry<'a>(file: &'a ScenarioFile, agent: &str) -> Option<&'a AgentFile> {
    let is_it = |entry: &&At<AgentFile>| names(&entry.value).is_ok_and(|names| names.iter().any(|name| name == agent));
    file.agents.value.iter().find(is_it).map(|entry| &entry.value)
}

/// The law as it is written, else the robot that has the usual one.
fn law(file: &ScenarioFile, agent: &str) -> Option<Span> {
    let entry = entry(file, agent)?;
    let law = entry.law.as_ref().or(file.law.as_ref());
    Some(law.map_or_else(|| entry.robot.span.clone(), |law| law.span.clone()))
}

/// The reference dynamics of all, where they lead to agreement.
fn common(file: &ScenarioFile) -> Option<&ConsensusFile> {
    match &file.reference.value {
        ReferenceFile::Consensus(common) | ReferenceFile::PureIntegral(common) => Some(common),
        _ => None,
    }
}

/// The roots of an agent, else the reference that has none.
fn roots(file: &ScenarioFile, agent: &str) -> Option<Span> {
    let own = entry(file, agent)?.reference.as_ref().and_then(|own| match &own.value {
        AgentReferenceFile::Consensus(own) | AgentReferenceFile::PureIntegral(own) => own.roots_per_s.as_ref(),
        AgentReferenceFile::Tracking(own) => own.roots_per_s.as_ref(),
    });
    let roots = own.or_else(|| match &file.reference.value {
        ReferenceFile::Tracking(common) => common.roots_per_s.as_ref(),
        _ => common(file).and_then(|common| common.roots_per_s.as_ref()),
    });
    Some(roots.map_or_else(|| file.reference.span.clone(), |roots| roots.span.clone()))
}

fn manipulability(file: &ScenarioFile, agent: &str) -> Option<Span> {
    let own = entry(file, agent)?.reference.as_ref().and_then(|own| match &own.value {
        AgentReferenceFile::Consensus(own) | AgentReferenceFile::PureIntegral(own) => own.manipulability_gain.as_ref(),
        AgentReferenceFile::Tracking(_) => None,
    });
    let gain = own.or_else(|| common(file).and_then(|common| common.manipulability_gain.as_ref()));
    gain.map(|gain| gain.span.clone())
}

/// The start of an agent's z, else that of all.
fn start_of_reference(file: &ScenarioFile, agent: &str) -> Option<Span> {
    let own = entry(file, agent)?.start.as_ref().and_then(|start| start.value.reference.as_ref());
    let common = || file.start.as_ref().and_then(|start| start.value.reference.as_ref());
    own.or_else(common).map(|reference| reference.span.clone())
}

/// What is said of a sensor of velocities.
fn velocity(control: &ControlFile, quantity: VelocityQuantity) -> Option<Span> {
    let place = match quantity {
        VelocityQuantity::Noise => control.noise.as_ref()?.velocity.as_ref()?.span.clone(),
        VelocityQuantity::Step => control.quantisation.as_ref()?.velocity.as_ref()?.span.clone(),
        VelocityQuantity::CutOff => control.velocity.as_ref()?.span.clone(),
    };
    Some(place)
}

/// What the user can do about it.
pub(super) fn advice(error: &SetupError) -> Option<String> {
    Some(match error {
        SetupError::Coupling => {
            "write `exchange = \"position\"` in `reference.consensus`, or leave `coupling` out".to_owned()
        }
        SetupError::SendsPositionOnly { .. } => "write `exchange = \"position\"`".to_owned(),
        SetupError::ReferenceOfLaw { .. } => "write `reference.consensus` with `exchange = \"position\"`".to_owned(),
        SetupError::NotTracking { .. } => {
            "write `reference.consensus`; laws that track are `adaptive`, `known`, `position_only`, `task_space`, `attitude` and those of chains".to_owned()
        }
        SetupError::OnlyTracks { .. } => "write `reference.tracking`, and give it a `target`".to_owned(),
        SetupError::StartOfReference { error, .. } => match error.need {
            0 => "leave it out: this law has no reference velocity of its own".to_owned(),
            1 => "leave `derivatives` out: z is all that this law integrates".to_owned(),
            need => format!("give `z` and at most {} of its derivatives", need - 1),
        },
        SetupError::NobodyHears { .. } => "leave `network` out, or write `reference.consensus`".to_owned(),
        SetupError::VelocityUnused { .. } => "leave it out".to_owned(),
        SetupError::RootCount { error, .. } if error.need == 0 => {
            "leave `roots_per_s` out: this law has reference dynamics of its own".to_owned()
        }
        SetupError::OrderTooLow { least, .. } => format!("give it {least} roots or more"),
        SetupError::RootCount { error, .. } => {
            format!("this law takes {} roots; an agent may have `reference` with roots of its own", error.need)
        }
        SetupError::TorqueLimitCount { .. } => {
            "leave it out: this robot has another number of torques than of axes".to_owned()
        }
        SetupError::Chain { error: ChainError::Guide(_), .. } => {
            "an agent may have `reference` with roots of its own".to_owned()
        }
        SetupError::Chain { error: ChainError::Antiderivative { .. }, .. } => {
            "leave `antiderivatives` out for regressors without the highest derivative".to_owned()
        }
        SetupError::Memory { need_bytes, .. } => {
            format!("write `memory_budget_bytes = {need_bytes}` or more in `[solver]`, sample more slowly, or shorten the longest delay")
        }
        SetupError::UnitsDiffer { .. } => {
            "point masses, vehicles and robots with three prismatic joints have a position in space".to_owned()
        }
        SetupError::NotPushed { agent, .. } => format!("leave `{agent}` out of `on`"),
        SetupError::NoTarget { .. } => "give it a `target`".to_owned(),
        SetupError::NoOffsets { .. } => {
            "leave its `target` out; only vehicles and rotorcraft agree up to offsets".to_owned()
        }
        SetupError::NoManipulability { .. } => {
            "leave `manipulability_gain` out".to_owned()
        }
        _ => return None,
    })
}
