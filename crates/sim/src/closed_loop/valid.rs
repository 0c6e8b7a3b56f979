//! Finds what makes a setup meaningless.

use forwardstep_core::LengthError;
use forwardstep_core::reference::Choice;

use super::error::SetupError;
use super::unused;
use crate::agents::Adaptive;
use crate::engine::{Integrator, Radio};
use crate::leader::{Following, FollowingDesign};
use crate::setup::{AgentSetup, AxisUnit, Control, Exchange, Method, ReferenceKind, Setup};

/// Samples that a run may have.
const MOST_SAMPLES: f64 = 1e7;

/// Everything that does not need a robot's kernels.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn validate(setup: &Setup) -> Result<(), SetupError> {
    setup.network.validate()?;
    let leaders = usize::from(setup.following().is_some());
    if setup.network.agents != setup.agents.len() + leaders {
        let agents = setup.agents.len() + leaders;
        return Err(SetupError::AgentCount { network: setup.network.agents, agents });
    }
    let positive = |what, value: f64| {
        if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SetupError::NotPositive { what, value }) }
    };
    positive("the horizon", setup.time.end_s)?;
    positive("the recording interval", setup.time.record_every_s)?;
    positive("the smallest step", setup.solver.min_step_s)?;
    setup.solver.max_step_s.map_or(Ok(()), |step| positive("the largest step", step))?;
    match setup.solver.method {
        Method::Adaptive { rtol, atol } => {
            positive("the relative tolerance", rtol)?;
            positive("the absolute tolerance", atol)?;
        }
        Method::Fixed { step_s } => positive("the step", step_s)?,
    }
    setup.control.as_ref().map_or(Ok(()), |control| check_control(control, setup))?;
    check_memory(setup)?;
    let goes = setup.reference == ReferenceKind::Consensus && setup.exchange == Exchange::Position;
    if !setup.network.coupling.is_linear() && !goes {
        return Err(SetupError::Coupling);
    }
    if matches!(setup.reference, ReferenceKind::Backstepping { .. }) && setup.exchange != Exchange::Position {
        return Err(SetupError::BacksteppingExchange);
    }
    if let Some(following) = setup.following() {
        check_following(following, setup)?;
    }
    setup.agents.iter().try_for_each(|agent| check_agent(setup, agent))?;
    unused::of_setup(setup)?;
    same_space(setup)
}

/// More of z(0), ż(0), … than there may be.
pub(super) fn too_many(agent: &AgentSetup, need: usize, got: usize) -> SetupError {
    let error = LengthError { what: "the start of the reference", need, got };
    SetupError::StartOfReference { agent: agent.name.clone(), error }
}

/// Whoever agrees with a vehicle has a position in m. (An arm and a cart may agree on a number.)
fn same_space(setup: &Setup) -> Result<(), SetupError> {
    let moves = |agent: &&AgentSetup| agent.robot.kind.moves_in_space();
    let Some(vehicle) = setup.agents.iter().find(moves) else { return Ok(()) };
    for agent in &setup.agents {
        if let Some(axis) = agent.robot.axes.iter().find(|axis| axis.unit != AxisUnit::Metre) {
            let (vehicle, agent) = (vehicle.name.clone(), agent.name.clone());
            return Err(SetupError::UnitsDiffer { vehicle, agent, axis: axis.name.clone() });
        }
    }
    Ok(())
}

/// What following a leader needs.
fn check_following(following: &Following, setup: &Setup) -> Result<(), SetupError> {
    let positive = |what, value: f64| {
        if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SetupError::NotPositive { what, value }) }
    };
    positive("α", following.alpha)?;
    positive("γ", following.gain)?;
    if following.design != FollowingDesign::Continuous {
        positive("β", following.beta)?;
    }
    if let FollowingDesign::Swarm { coupling } = following.design {
        positive("the coupling k", coupling)?;
    }
    match following.choice {
        Choice::Layer { width } => positive("the width of the boundary layer", width)?,
        Choice::Implicit | Choice::Explicit if setup.control.is_none() => {
            positive("the period of the sign", following.period_s)?;
            let settings = setup.time.end_s / following.period_s;
            if settings > MOST_SAMPLES {
                let what = "the number of times that the sign is set";
                return Err(SetupError::Control { what, value: settings, requirement: "must not exceed 1e7" });
            }
        }
        _ => {}
    }
    if setup.exchange != Exchange::PositionVelocity {
        return Err(SetupError::FollowingExchange);
    }
    let (leader, axes) = (&following.leader, setup.agents.first().map_or(0, |agent| agent.robot.axes.len()));
    LengthError::check("the leader's trajectory", axes, leader.trajectory.axes())
        .map_err(|error| SetupError::Length { agent: leader.name.clone(), error })?;
    let told = following.sliding().told() > 0 && setup.control.is_none();
    for edge in setup.network.schedule.graphs().into_iter().flatten() {
        if edge.to == setup.agents.len() {
            return Err(SetupError::LeaderHears { leader: leader.name.clone() });
        }
        let delay_s = setup.network.delays.get(edge.delay).map_or(0.0, |delay| delay.max_s());
        if told && delay_s > 0.0 {
            return Err(SetupError::DelayedDerived { delay_s });
        }
    }
    Ok(())
}

/// The numbers in a message. What is computed is sent by sampled controllers; in continuous time it is looked up.
pub(super) fn message_len(setup: &Setup) -> usize {
    let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
    let computed = if setup.control.is_some() { setup.following().map_or(0, |f| f.sliding().told()) } else { 0 };
    (setup.exchange.words().len() + computed) * axes
}

/// Samples are kept as long as any delay from the start on; pieces of history need room for the first at least.
fn check_memory(setup: &Setup) -> Result<(), SetupError> {
    let numbers = setup.network.agents.saturating_mul(message_len(setup));
    let need_bytes = match &setup.control {
        Some(control) => Radio::bytes(&setup.network, setup.time.end_s, control.sample_hz, numbers),
        None => Integrator::least_bytes(numbers),
    };
    let budget_bytes = setup.solver.memory_budget_bytes;
    if need_bytes > budget_bytes { Err(SetupError::Memory { need_bytes, budget_bytes }) } else { Ok(()) }
}

fn check_control(control: &Control, setup: &Setup) -> Result<(), SetupError> {
    let wrong = |what, value, requirement| Err(SetupError::Control { what, value, requirement });
    let Control { sample_hz, computation_delay_s, sensors, actuators, failures } = control;
    if !(*sample_hz > 0.0 && sample_hz.is_finite()) {
        return wrong("the sample rate", *sample_hz, "must be positive and finite");
    }
    if setup.time.end_s * sample_hz > MOST_SAMPLES {
        return wrong("the number of samples", setup.time.end_s * sample_hz, "must not exceed 1e7");
    }
    if let Some(timeout_s) = failures.message_timeout_s
        && !(timeout_s >= 0.0 && timeout_s.is_finite())
    {
        return wrong("the time-out of messages", timeout_s, "must be finite and not negative");
    }
    if !(*computation_delay_s >= 0.0 && *computation_delay_s <= 1.0 / sample_hz) {
        return wrong("the computation delay", *computation_delay_s, "must be from 0 to one period");
    }
    for (what, value) in [
        ("the noise of positions", sensors.position_noise),
        ("the noise of velocities", sensors.velocity_noise),
        ("the step of positions", sensors.position_quantum),
        ("the step of velocities", sensors.velocity_quantum),
        ("the step of torques", actuators.torque_quantum),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return wrong(what, value, "must be finite and not negative");
        }
    }
    Ok(())
}

fn check_agent(setup: &Setup, agent: &AgentSetup) -> Result<(), SetupError> {
    let first = &setup.agents[0];
    let (axes, vectors) = (first.robot.axes.len(), setup.reference.free_derivatives(agent));
    if agent.robot.axes.len() != axes {
        return Err(SetupError::AxesDiffer {
            agent: agent.name.clone(),
            axes: agent.robot.axes.len(),
            first: first.name.clone(),
            first_axes: axes,
        });
    }
    let vector = |what: &'static str, need: usize, values: &[f64]| {
        LengthError::check(what, need, values.len())
            .map_err(|error| SetupError::Length { agent: agent.name.clone(), error })?;
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(SetupError::NotFinite { agent: agent.name.clone(), what, value: *value }),
            None => Ok(()),
        }
    };
    vector("the start position", axes, &agent.start.q)?;
    let velocities = agent.robot.velocity_len();
    vector("the start velocity", velocities, &agent.start.dq)?;
    // How much more a state has is known where the plant is built.
    vector("the start of the plant", agent.start.rest.len(), &agent.start.rest)?;
    goes_together(setup, agent)?;
    // The second state of a chain may be no velocity, but it has a z.
    let leads = if velocities == 0 { axes } else { velocities };
    for z in &agent.start.reference {
        vector("the start of the reference", leads, z)?;
    }
    if agent.start.reference.len() > vectors {
        let (need, got) = (vectors, agent.start.reference.len());
        return Err(too_many(agent, need, got));
    }
    vector("theta", agent.robot.theta.len(), &agent.robot.theta)?;
    if let Some(Adaptive { estimate_start, .. }) = agent.law.downcast() {
        vector("the start of the estimate", agent.robot.theta.len(), estimate_start)?;
    }
    for (k, push) in agent.pushes.iter().enumerate() {
        let problem = |error| SetupError::Push { agent: agent.name.clone(), push: k + 1, error };
        push.check(&agent.robot).map_err(problem)?;
    }
    Ok(())
}

/// Whether the law goes with the robot, the reference dynamics, what is exchanged and what acts on the agent.
fn goes_together(setup: &Setup, agent: &AgentSetup) -> Result<(), SetupError> {
    let (name, law) = (|| agent.name.clone(), agent.law.words());
    let Some(interface) = agent.interface() else {
        return Err(SetupError::LawOfAnother { agent: name(), law, made_for: agent.law.made_for() });
    };
    let tracks = setup.reference == ReferenceKind::Tracking;
    if !interface.follows.contains(&setup.reference.family()) {
        return Err(SetupError::wrong_reference(setup, agent));
    }
    if !interface.exchanges.contains(&setup.exchange) {
        return Err(SetupError::SendsPositionOnly { agent: name(), law });
    }
    if !interface.pushed && !agent.pushes.is_empty() {
        return Err(SetupError::NotPushed { agent: name(), law });
    }
    match (&agent.target, tracks) {
        (None, true) => Err(SetupError::NoTarget { agent: name() }),
        (Some(_), false) if !interface.offsets => Err(SetupError::NoOffsets { agent: name(), law }),
        _ => unused::of_agent(setup, agent, &interface),
    }
}
