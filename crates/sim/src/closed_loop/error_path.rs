//! Where in a setup stands what an error is about: the path of a key, as scenario files have it.

use forwardstep_core::controller::ChainError;
use forwardstep_core::reference::BacksteppingError;

use super::error::SetupError;
use super::limit_error::LimitError;
use crate::quantity::Path;
use crate::reference::{ReferenceDynamics, ReferenceFamily};
use crate::setup::{AgentSetup, RECORD_EVERY_S, Setup, Solver};

impl SetupError {
    /// Where in `setup` stands what it is about.
    pub fn path(&self, setup: &Setup) -> Path {
        let of = |agent: &str| match setup.agents.iter().position(|known| known.name == agent) {
            Some(index) => Path::from("agents").index(index),
            None => Path::from("leader"),
        };
        let reference = || Path::from("reference").key(setup.reference.words().key);
        let own = |agent: &str| {
            let index = setup.agents.iter().position(|known| known.name == agent);
            let reference = index.map_or(&*setup.reference, |index| setup.reference_of(index));
            of(agent).key("reference").key(reference.words().key)
        };
        let roots = |agent| own(agent).key("roots_per_s");
        match self {
            SetupError::Quantity(error) => error.path.clone(),
            SetupError::Entries { path, .. } | SetupError::Gain { path, .. } => path.clone(),
            SetupError::Network(_)
            | SetupError::AgentCount { .. }
            | SetupError::UnusedEdges { .. }
            | SetupError::LeaderHears { .. } => "network".into(),
            SetupError::Coupling => "network.coupling".into(),
            SetupError::NoAgent { .. } => "agents".into(),
            SetupError::ReferenceExchange { .. }
            | SetupError::ReferenceShape { .. }
            | SetupError::SignWithoutLeader { .. }
            | SetupError::OnlyTracks { .. }
            | SetupError::NotTracking { .. }
            | SetupError::ReferenceOfLaw { .. } => "reference".into(),
            SetupError::Desired { .. } => reference(),
            SetupError::ProtocolHearsVelocities { .. } => reference().key("heard"),
            SetupError::DesiredVariables { .. } => reference().key("written_in"),
            SetupError::DesiredOrder { .. } => reference().key("polynomial"),
            SetupError::Backstepping(BacksteppingError::Filter { .. }) => reference().key("filter_s"),
            SetupError::Backstepping(BacksteppingError::Limit { .. }) => reference().key("acceleration_limit"),
            SetupError::DelayedDerived { .. } => reference().key("design"),
            SetupError::SendsPositionOnly { .. } => reference().key("exchange"),
            SetupError::Roots { agent, .. }
            | SetupError::OrderTooLow { agent, .. }
            | SetupError::RootCount { agent, .. }
            | SetupError::TargetDerivatives { agent, .. }
            | SetupError::Chain { agent, error: ChainError::ReferenceModel(_) } => roots(agent),
            SetupError::NoManipulability { agent, .. } => own(agent).key("manipulability_gain"),
            SetupError::StartOfReference { agent, .. } => of(agent).key("start.reference"),
            SetupError::CannotLead { .. } => Path::from("leader"),
            SetupError::NoTarget { agent } | SetupError::Recipe { agent, .. } => of(agent).key("name"),
            SetupError::Trajectory { agent, .. } | SetupError::NoOffsets { agent, .. } => of(agent).key("target"),
            SetupError::UnitsDiffer { agent, .. }
            | SetupError::AxesDiffer { agent, .. }
            | SetupError::NoAxes { agent }
            | SetupError::Spacecraft { agent, .. }
            | SetupError::Limit { agent, error: LimitError::NoEffortLimit { .. } | LimitError::EffortLimit { .. } }
            | SetupError::Chain { agent, error: ChainError::Expression(_) } => of(agent).key("robot"),
            SetupError::Chain {
                agent,
                error: ChainError::Antiderivative { parameter, .. } | ChainError::AntiderivativeNotShown { parameter },
            } => of(agent).key("law.immersion.antiderivatives").index(*parameter),
            SetupError::Chain { agent, error: ChainError::StartAtBound { .. } } => {
                of(agent).key("law.adaptive_backstepping.estimate_start")
            }
            SetupError::Chain { agent, .. }
            | SetupError::Length { agent, .. }
            | SetupError::LawOfAnother { agent, .. }
            | SetupError::Tip { agent, .. }
            | SetupError::ProjectionOfMatrix { agent }
            | SetupError::BoundsOfKnown { agent }
            | SetupError::NullSpace { agent, .. }
            | SetupError::TipVelocity { agent }
            | SetupError::NotPushed { agent, .. } => of(agent).key("law"),
            SetupError::Push { agent, .. } => of(agent),
            SetupError::Limit { error: LimitError::Rates(_), .. } => "control.torque_rate_limit_per_s".into(),
            SetupError::Limit { .. } => "control.torque_limit".into(),
            SetupError::VelocityFilter(_) => "control.velocity".into(),
            SetupError::VelocityUnused { quantity, .. } => Path::from("control").key(quantity.key()),
            // What was not asked for is not what is wrong.
            SetupError::Memory { budget_bytes, .. }
                if setup.control.is_some() && *budget_bytes == Solver::default().memory_budget_bytes =>
            {
                "control.sample_hz".into()
            }
            SetupError::Memory { .. } => "solver.memory_budget_bytes".into(),
            SetupError::RecordingTooLarge { least_s: None, .. } => "time.record_at".into(),
            SetupError::RecordingTooLarge { .. } if setup.time.record_every_s == RECORD_EVERY_S => "time.end_s".into(),
            SetupError::RecordingTooLarge { .. } => "time.record_every_s".into(),
        }
    }

    /// The reference dynamics do not lead the law of `agent`.
    pub(crate) fn wrong_reference(reference: &dyn ReferenceDynamics, agent: &AgentSetup) -> Self {
        let (name, law) = (agent.name.clone(), agent.law.words().name);
        let only_tracks = agent.interface().is_some_and(|interface| interface.follows == [ReferenceFamily::Target]);
        let follows_targets =
            agent.interface().is_some_and(|interface| interface.follows.contains(&ReferenceFamily::Target));
        match reference.interface().family {
            ReferenceFamily::Target | ReferenceFamily::DesiredTarget if !follows_targets => {
                SetupError::NotTracking { agent: name, law }
            }
            _ if only_tracks => SetupError::OnlyTracks { agent: name, law },
            _ => SetupError::ReferenceOfLaw { agent: name, law },
        }
    }
}
