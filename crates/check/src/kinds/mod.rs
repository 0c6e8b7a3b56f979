//! Kinds of systems, each with its law: which theorem speaks about it, and what its law adds to the hypotheses.

mod bounds;
pub(crate) mod chain;
mod declared;
mod lagrangian;
pub(crate) mod matrix_factor;
mod model_reference;
mod passivity_filter;
mod point_mass;
mod rotorcraft;
mod spacecraft;
pub(crate) mod start_attitude;
pub(crate) mod task_space;
mod vehicle;

use forwardstep_sim::{AgentSetup, Setup};

pub(crate) use chain::Chain;
pub(crate) use declared::{DeclaredKind, declaration};
pub(crate) use lagrangian::{LagrangianRobot, is_lagrangian, starts_from_zero};
pub(crate) use model_reference::ModelledMass;
pub(crate) use passivity_filter::FilteredSpacecraft;
pub(crate) use point_mass::PositionOnlyMass;
pub(crate) use rotorcraft::{Rotorcraft, rotors_of};
pub(crate) use spacecraft::Spacecraft;
pub(crate) use task_space::TaskSpaceRobot;
pub(crate) use vehicle::{Vehicle, is_its_own_reference};

use crate::hypothesis::Hypothesis;
use crate::theorem::Theorem;

/// A theorem, and what it promises in this case.
pub(crate) struct Claim {
    pub(crate) theorem: Theorem,
    pub(crate) promises: String,
}

/// What is known of a kind of system under its law. Every kind answers all of it.
pub(crate) trait KindCheck: Sync {
    /// A name that no other kind has.
    fn name(&self) -> &'static str;

    /// Whether this agent is of this kind.
    fn treats(&self, agent: &AgentSetup) -> bool;

    /// Where this agent is treated, in words: beside agents of other kinds they tell what is mixed.
    fn treated(&self, agent: &AgentSetup) -> &'static str;

    /// The statement about a setup of this kind alone; `None` where the reference dynamics decide which it is.
    fn claim(&self, setup: &Setup) -> Option<Claim>;

    /// What the law asks for, about the agents of this kind by their indices; never called without any.
    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis>;

    /// How many derivatives of a target, or of an offset, its law needs to be bounded.
    fn target_derivatives(&self, agent: &AgentSetup) -> usize;
}
