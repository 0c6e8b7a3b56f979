//! From chains and their laws to blocks of the closed loop.

use forwardstep_core::controller::{
    AdaptiveBackstepping, BacksteppingGains, ChainError, Following, Guide, Immersion, Linearising,
};
use forwardstep_core::plant::{Cascade, CascadeError, Chain, Formulas};
use forwardstep_core::reference::{Consensus, Position, polynomial};

use super::population::Columns;
use super::systems::solo;
use super::valid::SetupError;
use crate::chain::{ChainLaw, ChainModel, ChainStep};
use crate::setup::{AgentSetup, Law, ReferenceKind, Setup};

/// The agent number `agent`, a chain with a law for chains.
pub(super) fn chain(setup: &Setup, agent: usize, model: &ChainModel) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    let another =
        || SetupError::LawOfAnother { agent: own.name.clone(), law: own.law.words(), made_for: own.law.made_for() };
    let wrong = |error: ChainError| SetupError::Chain { agent: own.name.clone(), error };
    let Law::Chain(ChainLaw { step, floor }) = &own.law else { return Err(another()) };
    let floor = *floor;
    if !(floor > 0.0 && floor.is_finite()) {
        let requirement = "must be positive and finite";
        return Err(SetupError::LawNumber { agent: own.name.clone(), what: "the floor", value: floor, requirement });
    }
    let guide = guide(setup, own)?;
    match (model, step) {
        (ChainModel::Derivatives(terms), ChainStep::Linearising { gain_per_s }) => {
            let following = Following { guide, gain_per_s: *gain_per_s, floor };
            let law = Linearising::new(Formulas::clone(terms), own.robot.theta.clone(), following).map_err(wrong)?;
            solo(setup, agent, derivatives(own, terms), law)
        }
        (ChainModel::Derivatives(terms), ChainStep::Adaptive { gain_per_s, estimate }) => {
            let following = Following { guide, gain_per_s: *gain_per_s, floor };
            let (gamma, start) = (estimate.adaptation.clone(), estimate.start.clone());
            let law = Linearising::adaptive(Formulas::clone(terms), following, gamma, start).map_err(wrong)?;
            solo(setup, agent, derivatives(own, terms), law)
        }
        (ChainModel::Derivatives(terms), ChainStep::Immersion { gain_per_s, estimate, antiderivatives }) => {
            let following = Following { guide, gain_per_s: *gain_per_s, floor };
            let (gamma, start) = (estimate.adaptation.clone(), estimate.start.clone());
            let law =
                Immersion::new(Formulas::clone(terms), antiderivatives, following, gamma, start).map_err(wrong)?;
            solo(setup, agent, derivatives(own, terms), law)
        }
        (ChainModel::Cascade(terms), ChainStep::Backstepping { gains_per_s, estimate }) => {
            let gains =
                BacksteppingGains { gains_per_s: gains_per_s.clone(), adaptation: estimate.adaptation.clone(), floor };
            let law = AdaptiveBackstepping::new(terms, guide, gains, estimate.start.clone()).map_err(wrong)?;
            let plant = Cascade::new(terms.as_ref().clone(), own.robot.theta.clone()).map_err(|error| match error {
                CascadeError::Length(error) => SetupError::Length { agent: own.name.clone(), error },
                CascadeError::Expression(error) => wrong(ChainError::Expression(error)),
                CascadeError::Empty | CascadeError::Above { .. } => another(),
            })?;
            solo(setup, agent, plant, law)
        }
        _ => Err(another()),
    }
}

fn derivatives(own: &AgentSetup, terms: &Formulas) -> Chain<Formulas> {
    Chain { terms: terms.clone(), theta: own.robot.theta.clone() }
}

/// Where z leads: to a target, or to agreement.
fn guide(setup: &Setup, own: &AgentSetup) -> Result<Guide, SetupError> {
    let roots = |error| SetupError::Roots { agent: own.name.clone(), error };
    match setup.reference {
        ReferenceKind::Tracking => {
            let mut alpha = polynomial(&own.roots_per_s).map_err(roots)?;
            // The leading one is not listed.
            alpha.pop();
            Ok(Guide::Tracking { alpha })
        }
        ReferenceKind::Consensus => {
            Ok(Guide::Consensus(Consensus::<Position>::new([(&own.roots_per_s[..], 0.0)]).map_err(roots)?))
        }
        _ => Err(SetupError::ReferenceOfLaw { agent: own.name.clone(), law: own.law.words() }),
    }
}
