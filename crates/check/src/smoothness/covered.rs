//! Of which agents the jumps of the input are known, and what they are promised.

use forwardstep_sim::graph::Weight;
use forwardstep_sim::reference::{Consensus, Desired, Dynamics, PureIntegral, ReferenceFamily};
use forwardstep_sim::{
    ChainLaw, ChainModel, InputOrder, PositionOnlyLaw, Series, Setup, Signal, ThrustLaw, reference_dynamics,
};
use thiserror::Error;

use crate::instance::{Design, design};
use crate::kinds::is_lagrangian;
use crate::surroundings::dry_loss_w;

/// One input of an agent, of which jumps are reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Covered {
    /// What it is: τ, or what else drives a plant.
    pub signal: Signal,
    /// Derivatives that what is heard determines: u, u̇, … as many as this.
    pub derivatives: usize,
    /// How many of them must not jump. `None` where nothing is promised.
    pub continuous: Option<usize>,
}

/// Why nothing is reported of an agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NotCovered {
    /// Its law is another, where robots under (6)–(7) are compared.
    #[error("its law is {law}")]
    Law {
        /// The law, with an article.
        law: &'static str,
    },
    /// It follows a target.
    #[error("it follows a target of its own, and no switch and no delay reaches its input")]
    OwnTarget,
    /// It follows a target, and hears others by a protocol of the scenario.
    #[error("it follows a target and hears others by a protocol that the scenario states, which is not expanded")]
    Protocol,
    /// A set-valued sign is part of its reference dynamics.
    #[error(
        "{reference} has a set-valued sign, which is set at instants of its own: what the network does is not all that jumps"
    )]
    Sign {
        /// What leads it.
        reference: &'static str,
    },
    /// Dry friction jumps at instants of its own.
    #[error(
        "its joints have dry friction, which jumps whenever a joint turns round or sticks, and dτ/dt with it: what the network does is not \
         all that jumps; `friction.smooth` shows what the design does"
    )]
    DryFriction,
    /// No derivative of its input depends on what is heard.
    #[error("no derivative of its input depends on what it hears")]
    Deaf,
}

/// The most derivatives that a series has.
pub(super) const MOST: usize = size_of::<Series>() / size_of::<f64>();

/// Why nothing is said of an agent, if so.
pub(super) fn refused(setup: &Setup, agent: usize) -> Option<NotCovered> {
    if setup.tracks(agent) {
        let hears = setup.reference.downcast().is_some_and(Desired::hears_beside_target);
        return Some(if hears { NotCovered::Protocol } else { NotCovered::OwnTarget });
    }
    if dry_loss_w(&setup.agents[agent]).is_some() {
        return Some(NotCovered::DryFriction);
    }
    let sign = setup.reference.interface().family == ReferenceFamily::Leader;
    sign.then(|| NotCovered::Sign { reference: setup.reference.words().name })
}

/// The reference dynamics of an agent, if its torque is that of (6)–(7) and can be expanded; derivatives of weights are not known.
pub(super) fn expandable(setup: &Setup, agent: usize) -> Option<Dynamics> {
    let own = &setup.agents[agent];
    let known = if setup.reference.is::<Consensus>() { own.roots_per_s.len() <= MOST } else { !varying_weights(setup) };
    let expandable = known && is_lagrangian(own) && refused(setup, agent).is_none();
    expandable.then(|| reference_dynamics(setup, agent).ok()).flatten()
}

/// Whether some weight of some graph changes with time.
fn varying_weights(setup: &Setup) -> bool {
    setup.network.schedule.graphs.iter().flatten().any(|edge| matches!(edge.weight, Weight::Formula(_)))
}

/// What is reported of an agent, from the derivatives that an expansion of its torque determines, or from the `orders` of its inputs.
pub(super) fn covered(
    setup: &Setup,
    agent: usize,
    expanded: Option<usize>,
    orders: &[InputOrder],
) -> Result<Vec<Covered>, NotCovered> {
    if let Some(reason) = refused(setup, agent) {
        return Err(reason);
    }
    let of = |signal, derivatives| Covered { signal, derivatives, continuous: continuous(setup, agent, signal) };
    if let Some(derivatives) = expanded {
        return Ok(vec![of(Signal::Torque, derivatives)]);
    }
    let known = orders.iter().filter_map(|input| Some(of(input.signal, input.order? + 1)));
    let known: Vec<Covered> = known.collect();
    if known.is_empty() { Err(NotCovered::Deaf) } else { Ok(known) }
}

/// How many derivatives of an input of an agent must not jump.
///
/// With N − 1 roots and a plant of order k, z follows the (k − 1)-th derivative, ℓ = N − k + 1, and the input reads up to ż:
/// ℓ − 1 = roots + 1 − k, as (43) says. Of a vehicle with one thrust ω reads z̈ through (50) and the virtual control itself through (46), one derivative
/// more than the torques of robots, as does σ̇ where that is the input, and σ is an integral of what ω reads. Where an inner loop turns the vehicle, and of laws and reference dynamics from
/// outside, nothing is promised.
fn continuous(setup: &Setup, agent: usize, signal: Signal) -> Option<usize> {
    let own = &setup.agents[agent];
    // Desired dynamics may be a design of the paper.
    let written = design(setup);
    let is = |found: Design| written.as_ref().is_some_and(|(design, _)| *design == found);
    let order = written.as_ref().map_or(own.roots_per_s.len(), |(_, roots)| roots.len());
    if setup.reference.is::<PureIntegral>() || is(Design::PureIntegral) {
        let fixed = setup.network.schedule.constant_graph().is_some();
        return (fixed && is_lagrangian(own)).then_some(1);
    }
    if !setup.reference.is::<Consensus>() && !is(Design::Consensus) {
        None
    } else if is_lagrangian(own) || own.law.is::<PositionOnlyLaw>() {
        Some(order.saturating_sub(1))
    } else if own.law.is::<ChainLaw>() {
        let model: &ChainModel = own.robot.kind.downcast()?;
        Some((order + 1).saturating_sub(model.order()))
    } else if own.law.is::<ThrustLaw>() && signal == Signal::Thrust {
        Some(order.saturating_sub(1))
    } else if own.law.is::<ThrustLaw>() && matches!(signal, Signal::AngularVelocity | Signal::ThrustRate) {
        Some(order.saturating_sub(2))
    } else {
        None
    }
}
