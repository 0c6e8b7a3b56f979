//! From agents to plants and controllers that stand by themselves: everything that is not a robot under (6)–(7).

use forwardstep_core::LengthError;
use forwardstep_core::agent::Limiter;
use forwardstep_core::controller::{Controller, Guide, PositionOnly};
use forwardstep_core::plant::{Mechanical, Plant, total};
use forwardstep_core::reference::{Consensus, Position, polynomial};
use forwardstep_core::robot::PointMass;

use super::chains::chain;
use super::members::sensor;
use super::population::Columns;
use super::single;
use super::solo::{Digital, Solo, Target};
use super::valid::SetupError;
use super::vehicles;
use crate::recording::Signal;
use crate::setup::{AgentSetup, Control, Exchange, Law, ReferenceKind, RobotKind, Setup};
use crate::trajectory::Pieces;

/// The agent number `agent` with its law.
pub(super) fn system(setup: &Setup, agent: usize) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    match (&own.robot.kind, &own.law) {
        (
            RobotKind::PointMass { dimension },
            &Law::PositionOnly { damping, filter_per_s, adaptation, estimate_start },
        ) => {
            let plant = Mechanical { robot: PointMass { dimension: *dimension }, theta: own.robot.theta.clone() };
            for (what, value) in [("k", damping), ("λ_f", filter_per_s)] {
                positive(own, what, value)?;
            }
            not_negative(own, "γ*", adaptation)?;
            let guide = guide(setup, own)?;
            let controller =
                PositionOnly { axes: *dimension, guide, damping, filter_per_s, adaptation, estimate_start };
            solo(setup, agent, plant, controller)
        }
        (RobotKind::Chain(model), _) => chain(setup, agent, model),
        (&RobotKind::Vehicle { gravity }, Law::Thrust(law)) => vehicles::vehicle(setup, agent, gravity, *law),
        (RobotKind::Rotorcraft { .. }, Law::Thrust(law)) => vehicles::rotorcraft(setup, agent, *law),
        (_, Law::TaskSpace(law)) => single::task_space(setup, agent, law),
        (RobotKind::Spacecraft { inertia_kg_m2, wheels }, Law::Attitude(law)) => {
            single::attitude(setup, agent, inertia_kg_m2, wheels, law)
        }
        (_, law) => {
            Err(SetupError::LawOfAnother { agent: own.name.clone(), law: law.words(), made_for: law.made_for() })
        }
    }
}

/// Where z leads: to a target, or to agreement.
fn guide(setup: &Setup, own: &AgentSetup) -> Result<Guide, SetupError> {
    let name = || own.name.clone();
    let roots = |error| SetupError::Roots { agent: name(), error };
    match setup.reference {
        ReferenceKind::Tracking => {
            root_count(own, 3)?;
            let mut alpha = polynomial(&own.roots_per_s).map_err(roots)?;
            // The leading one is not listed.
            alpha.pop();
            Ok(Guide::Tracking { alpha })
        }
        ReferenceKind::Consensus if own.roots_per_s.len() < 2 => {
            Err(SetupError::OrderTooLow { agent: name(), order: own.roots_per_s.len(), least: 2 })
        }
        ReferenceKind::Consensus => Ok(Guide::Consensus(
            Consensus::<Position>::new([(&own.roots_per_s[..], own.manipulability)]).map_err(roots)?,
        )),
        _ => Err(SetupError::ReferenceOfLaw { agent: name(), law: own.law.words() }),
    }
}

/// Checks what the two traits need, and builds the block.
pub(super) fn solo<C: Controller>(
    setup: &Setup,
    agent: usize,
    plant: C::Plant,
    controller: C,
) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    let name = || own.name.clone();
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::Length { agent: name(), error })
    };
    let start = &own.start;
    length("the start", total(&plant.states()), start.q.len() + start.dq.len() + start.rest.len())?;
    if setup.exchange != Exchange::Position {
        return Err(SetupError::SendsPositionOnly { agent: name(), law: own.law.words() });
    }
    if !own.pushes.is_empty() {
        return Err(SetupError::NotPushed { agent: name(), law: own.law.words() });
    }
    let is_offset = setup.reference != ReferenceKind::Tracking;
    let target = match &own.target {
        None if is_offset => None,
        None => return Err(SetupError::NoTarget { agent: name() }),
        Some(_) if is_offset && !C::KNOWS_OFFSETS => {
            return Err(SetupError::NoOffsets { agent: name(), law: own.law.words() });
        }
        Some(trajectory) => {
            length("the target", plant.axes(), trajectory.axes())?;
            let wrong = |error| SetupError::Trajectory { agent: name(), error };
            Some(Target { trajectory: Pieces::new(trajectory.clone(), setup.time.end_s).map_err(wrong)?, is_offset })
        }
    };
    let torques: usize = plant.inputs().iter().filter(|(signal, _)| *signal == Signal::Torque).map(|(_, n)| n).sum();
    let effort_limits = effort_limits(own, torques)?;
    let digital = match &setup.control {
        None => None,
        Some(control) => Some(Digital::new(
            sensor(agent, setup, control)?,
            limiter(own, control, torques)?,
            1.0 / control.sample_hz,
            control.actuators.torque_quantum,
        )),
    };
    // What a limit takes away is not what the ledger balances.
    let ledger = setup.solver.ledger && !own.enforce_limits;
    Ok(Box::new(Solo::new(agent, plant, controller, target, effort_limits, digital, ledger)))
}

/// The limits of the torques, if they are to be enforced.
fn effort_limits(own: &AgentSetup, torques: usize) -> Result<Option<Vec<f64>>, SetupError> {
    // What is no torque of an axis is limited by the plant itself.
    if !own.enforce_limits || torques == 0 {
        return Ok(None);
    }
    let limit = |axis: &crate::setup::Axis| {
        let (agent, axis_name) = (own.name.clone(), axis.name.clone());
        axis.effort_limit.ok_or(SetupError::NoEffortLimit { agent, axis: axis_name })
    };
    let limits: Vec<f64> = own.robot.axes.iter().map(limit).collect::<Result<_, _>>()?;
    LengthError::check("the effort limits", torques, limits.len())
        .map_err(|error| SetupError::Length { agent: own.name.clone(), error })?;
    Ok(Some(limits))
}

/// Limits of what a sampled controller asks for.
fn limiter(own: &AgentSetup, control: &Control, torques: usize) -> Result<Limiter, SetupError> {
    let limits = |given: &Option<Vec<f64>>, of_rates| {
        let what = if of_rates { "the limit of torque rates" } else { "the limit of torques" };
        let values = given.clone().unwrap_or_else(|| vec![f64::INFINITY; torques]);
        LengthError::check(what, torques, values.len()).map_err(|error| SetupError::TorqueLimitCount {
            agent: own.name.clone(),
            of_rates,
            error,
        })?;
        Ok::<_, SetupError>(values)
    };
    let mut limit = limits(&control.actuators.torque_limit, false)?;
    let quantum = control.actuators.torque_quantum;
    // A rounded torque must not exceed its limit either.
    if quantum > 0.0 {
        limit.iter_mut().for_each(|limit| *limit = quantum * (*limit / quantum).floor());
    }
    let rate = limits(&control.actuators.torque_rate_limit, true)?;
    Limiter::new(limit, rate).map_err(|error| SetupError::Limiter { agent: own.name.clone(), error })
}

/// Checks how many roots an agent has.
pub(super) fn root_count(own: &AgentSetup, need: usize) -> Result<(), SetupError> {
    LengthError::check("the list of roots", need, own.roots_per_s.len())
        .map_err(|error| SetupError::RootCount { agent: own.name.clone(), error })
}

/// Checks that an agent has no manipulability gain.
pub(super) fn no_manipulability(own: &AgentSetup) -> Result<(), SetupError> {
    if own.manipulability == 0.0 {
        return Ok(());
    }
    let (agent, law, value) = (own.name.clone(), own.law.words(), own.manipulability);
    Err(SetupError::NoManipulability { agent, law, value })
}

pub(super) fn positive(own: &AgentSetup, what: &'static str, value: f64) -> Result<(), SetupError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(SetupError::LawNumber { agent: own.name.clone(), what, value, requirement: "must be positive and finite" })
}

pub(super) fn not_negative(own: &AgentSetup, what: &'static str, value: f64) -> Result<(), SetupError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    let requirement = "must be finite and not negative";
    Err(SetupError::LawNumber { agent: own.name.clone(), what, value, requirement })
}
