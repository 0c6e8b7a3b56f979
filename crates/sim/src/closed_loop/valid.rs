//! Finds what makes a setup meaningless.

use forwardstep_core::LengthError;

use super::assembly::length;
use super::error::SetupError;
use super::frictions::{dry_friction, is_acted_on};
use super::unused;
use crate::engine::{Integrator, SampledChannel};
use crate::quantity::{MOST_EVENTS, Path, each, few, finite, not_negative, positive};
use crate::reference::ReferenceInterface;
use crate::setup::{AgentSetup, AxisUnit, Exchange, Setup};
use crate::system::{LawWords, PositionKind};

/// Whether the parts of a setup fit together: as many vertices as agents, links between those that there are, as many axes as the start has
/// positions. What asks nothing of a setup but this has an answer, or a typed reason why there is none, whatever the numbers in it are.
///
/// # Errors
/// [`SetupError`] for the first that does not.
pub fn check_shape(setup: &Setup) -> Result<(), SetupError> {
    setup.network.check_shape()?;
    // A motion is a vertex of its own; an agent that leads is one already.
    let leaders = usize::from(setup.following().is_some_and(|following| following.motion().is_some()));
    if setup.network.agents != setup.agents.len() + leaders {
        let agents = setup.agents.len() + leaders;
        return Err(SetupError::AgentCount { network: setup.network.agents, agents });
    }
    for (index, agent) in setup.agents.iter().enumerate() {
        let (axes, velocities) = (agent.robot.axes.len(), agent.robot.velocity_len());
        if axes == 0 {
            return Err(SetupError::NoAxes { agent: agent.name.clone() });
        }
        let place = |key| Path::from("agents").index(index).key(key);
        if agent.start.q.len() != axes {
            length(agent, place("start.position"), axes, agent.start.q.len())?;
        }
        if agent.start.dq.len() != velocities {
            length(agent, place("start.velocity"), velocities, agent.start.dq.len())?;
        }
    }
    Ok(())
}

/// Everything that does not need a robot's kernels.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn validate(setup: &Setup) -> Result<(), SetupError> {
    setup.time.check()?;
    check_shape(setup)?;
    setup.network.validate(setup.time.end_s)?;
    setup.solver.check()?;
    setup.control.as_ref().map_or(Ok(()), |control| control.check(setup.time.end_s))?;
    setup.reference.check(setup)?;
    check_memory(setup)?;
    let ReferenceInterface { exchanges, nonlinear_coupling, .. } = setup.reference.interface();
    let may_be_nonlinear = nonlinear_coupling && setup.exchange == Exchange::Position;
    if !(setup.network.coupling.is_linear() || may_be_nonlinear) {
        return Err(SetupError::Coupling);
    }
    if !exchanges.contains(&setup.exchange) {
        let reference = setup.reference.words().name;
        return Err(SetupError::ReferenceExchange { reference, exchange: setup.exchange });
    }
    (0..setup.agents.len()).try_for_each(|index| check_agent(setup, index))?;
    unused::of_setup(setup)?;
    same_space(setup)
}

/// More of z(0), ż(0), … than there may be.
pub(super) fn too_many(agent: &AgentSetup, need: usize, got: usize) -> SetupError {
    let error = LengthError { what: "the start of the reference", need, got };
    SetupError::StartOfReference { agent: agent.name.clone(), error }
}

/// Whoever agrees with a vehicle has a position in m, or in a unit of its own. (An arm and a cart may agree on a number.)
fn same_space(setup: &Setup) -> Result<(), SetupError> {
    let moves = |agent: &&AgentSetup| agent.robot.interface().position == PositionKind::Point;
    let Some(vehicle) = setup.agents.iter().find(moves) else { return Ok(()) };
    for agent in &setup.agents {
        if let Some(axis) = agent.robot.axes.iter().find(|axis| !matches!(axis.unit, AxisUnit::Metre | AxisUnit::Own)) {
            let (vehicle, agent) = (vehicle.name.clone(), agent.name.clone());
            return Err(SetupError::UnitsDiffer { vehicle, agent, axis: axis.name.clone() });
        }
    }
    Ok(())
}

/// The numbers in a message. What is computed is sent by sampled controllers; in continuous time it is looked up.
pub(super) fn message_len(setup: &Setup) -> usize {
    let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
    let computed = if setup.control.is_some() { setup.following().map_or(0, |f| f.sliding().transmitted()) } else { 0 };
    (setup.exchange.words().len() + computed) * axes
}

/// Samples are kept as long as any delay from the start on; pieces of history need room for the first at least.
fn check_memory(setup: &Setup) -> Result<(), SetupError> {
    let numbers = setup.network.agents.saturating_mul(message_len(setup));
    let need_bytes = match &setup.control {
        Some(control) => SampledChannel::bytes(&setup.network, setup.time.end_s, control.sample_hz, numbers),
        None => Integrator::least_bytes(numbers),
    };
    let budget_bytes = setup.solver.memory_budget_bytes;
    if need_bytes > budget_bytes { Err(SetupError::Memory { need_bytes, budget_bytes }) } else { Ok(()) }
}

fn check_agent(setup: &Setup, index: usize) -> Result<(), SetupError> {
    let (first, agent) = (&setup.agents[0], &setup.agents[index]);
    let vectors = setup.reference_of(index).free_derivatives(agent.roots_per_s.len());
    let axes = first.robot.axes.len();
    if agent.robot.axes.len() != axes {
        return Err(SetupError::AxesDiffer {
            agent: agent.name.clone(),
            axes: agent.robot.axes.len(),
            first: first.name.clone(),
            first_axes: axes,
        });
    }
    let own = Path::from("agents").index(index);
    if let Some((_, period_s)) = dry_friction(agent) {
        let settings = ("settings of dry friction", setup.time.end_s / period_s, MOST_EVENTS);
        few(own.clone().key("robot.friction.dry"), "period_s", period_s, settings)?;
    }
    let vector = |key: &'static str, need: usize, values: &[f64]| {
        length(agent, own.clone().key(key), need, values.len())?;
        each(own.clone(), key, values, finite).map_err(SetupError::from)
    };
    vector("start.position", axes, &agent.start.q)?;
    let velocities = agent.robot.velocity_len();
    vector("start.velocity", velocities, &agent.start.dq)?;
    // How much more a state has is known where the plant is built.
    each(own.clone(), "start.higher_states", &agent.start.rest, finite)?;
    goes_together(setup, index)?;
    // The second state of a chain may be no velocity, but it has a z.
    let leads = if velocities == 0 { axes } else { velocities };
    let further = agent.interface().map_or(&[][..], |law| law.further_starts);
    let starts = &agent.start.reference;
    for z in starts.iter().take(vectors) {
        vector("start.reference", leads, z)?;
    }
    for (values, need) in starts.iter().skip(vectors).zip(further) {
        vector("start.reference", if values.is_empty() { 0 } else { *need }, values)?;
    }
    if starts.len() > vectors + further.len() {
        return Err(too_many(agent, vectors + further.len(), starts.len()));
    }
    each(own.clone(), "robot.theta", &agent.robot.theta, finite)?;
    let design = own.clone().key("reference").key(setup.reference_of(index).words().key);
    each(design.clone(), "roots_per_s", &agent.roots_per_s.real, positive)?;
    // As if they stood behind the real ones.
    for (pair, index) in agent.roots_per_s.pairs.iter().zip(agent.roots_per_s.real.len()..) {
        let place = || design.clone().key("roots_per_s").index(index);
        positive(place(), "real", pair.real)?;
        positive(place(), "imaginary", pair.imaginary)?;
    }
    not_negative(design, "manipulability_gain", agent.manipulability)?;
    for (k, push) in agent.pushes.iter().enumerate() {
        let problem = |error| SetupError::Push { agent: agent.name.clone(), push: k + 1, error };
        push.check(&agent.robot).map_err(problem)?;
    }
    Ok(())
}

/// Whether the law goes with the robot, the reference dynamics, what is exchanged and what acts on the agent.
fn goes_together(setup: &Setup, index: usize) -> Result<(), SetupError> {
    let (agent, reference) = (&setup.agents[index], setup.reference_of(index));
    let name = || agent.name.clone();
    let LawWords { name: law, made_for } = agent.law.words();
    let Some(interface) = agent.interface() else {
        return Err(SetupError::LawOfAnother { agent: name(), law, made_for });
    };
    if !interface.follows.contains(&reference.interface().family) {
        return Err(SetupError::wrong_reference(reference, agent));
    }
    // Whatever its law says of itself, what has no velocity sends none. No edge leads to the agent that leads.
    let sends = setup.exchange != Exchange::PositionVelocity || agent.robot.velocity_len() > 0;
    if !(sends && interface.exchanges.contains(&setup.exchange)) && setup.leader() != Some(index) {
        return Err(SetupError::SendsPositionOnly { agent: name(), law });
    }
    if !interface.pushed && is_acted_on(agent) {
        return Err(SetupError::NotPushed { agent: name(), law });
    }
    match (&agent.target, setup.tracks(index)) {
        (None, true) => Err(SetupError::NoTarget { agent: name() }),
        (Some(_), false) if !interface.offsets => Err(SetupError::NoOffsets { agent: name(), law }),
        _ => unused::of_agent(reference, agent, &interface),
    }
}
