//! From agents to populations: robots, reference dynamics, laws and, under digital control, samplers.

use std::sync::Arc;

use forwardstep_core::law::SlotineLi;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Lagrangian, PlanarArm, PointMass};
use forwardstep_core::{Gain, InverseQuadratic, Lanes, LengthError, ResolvedGain};

use super::fleet::Member;
use super::population::{Columns, Population};
use super::references::{Transmits, reference};
use super::systems::system;
use super::valid::SetupError;
use crate::setup::{AgentSetup, Law, RobotKind, Setup};

/// Populations of at least so many agents are worked on in lanes.
const LANES_FROM: usize = 3;
/// Agents that can stand side by side: one robot model, one order, all adaptive or none. Groups in order of their first
/// agent.
pub(super) fn populations(agents: &[AgentSetup]) -> Vec<Vec<usize>> {
    let alike = |a: &AgentSetup, b: &AgentSetup| {
        let same_model = match (&a.robot.kind, &b.robot.kind) {
            (RobotKind::Tree(a), RobotKind::Tree(b)) => Arc::ptr_eq(a, b),
            (RobotKind::PlanarArm, RobotKind::PlanarArm) => true,
            (RobotKind::PointMass { dimension: a }, RobotKind::PointMass { dimension: b }) => a == b,
            _ => false,
        };
        same_model
            && a.law.is_lagrangian()
            && b.law.is_lagrangian()
            && a.roots_per_s.len() == b.roots_per_s.len()
            && matches!(a.law, Law::Adaptive { .. }) == matches!(b.law, Law::Adaptive { .. })
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, agent) in agents.iter().enumerate() {
        match groups.iter_mut().find(|group| alike(&agents[group[0]], agent)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

pub(super) fn population<X: Transmits>(setup: &Setup, group: &[usize]) -> Result<Box<dyn Columns>, SetupError> {
    let first = &setup.agents[group[0]];
    if !first.law.is_lagrangian() {
        return system(setup, group[0]);
    }
    match &first.robot.kind {
        RobotKind::Tree(tree) => boxed::<Tree, X>(Tree::clone(tree), setup, group),
        RobotKind::PlanarArm => boxed::<PlanarArm, X>(PlanarArm, setup, group),
        RobotKind::PointMass { dimension } => boxed::<PointMass, X>(PointMass { dimension: *dimension }, setup, group),
        RobotKind::Vehicle { .. }
        | RobotKind::Rotorcraft { .. }
        | RobotKind::Spacecraft { .. }
        | RobotKind::Chain(_) => Err(SetupError::LawOfAnother {
            agent: first.name.clone(),
            law: first.law.words(),
            made_for: first.law.made_for(),
        }),
    }
}

fn boxed<R, X>(robot: R, setup: &Setup, group: &[usize]) -> Result<Box<dyn Columns>, SetupError>
where
    R: Lagrangian<f64> + Lagrangian<Lanes<8>> + Clone + Send + Sync + 'static,
    X: Transmits,
{
    let mut members = Vec::new();
    for &agent in group {
        members.push(member(&robot, &setup.agents[agent], agent)?);
    }
    let reference = reference::<X>(setup, group)?;
    let sampled = setup.control.is_some();
    // What a held torque does is not what the ledger balances.
    let ledger = setup.solver.ledger && !sampled;
    // Eight lanes cost about as much as two or three robots one at a time, so idle lanes pay from three robots on.
    Ok(if members.len() < LANES_FROM {
        Box::new(Population::<R, X, f64>::new(robot, members, reference, sampled, ledger))
    } else {
        Box::new(Population::<R, X, Lanes<8>>::new(robot, members, reference, sampled, ledger))
    })
}

fn member<R: Lagrangian<f64>>(robot: &R, agent: &AgentSetup, index: usize) -> Result<Member, SetupError> {
    let (m, p) = (robot.dof(), robot.parameter_count());
    let name = || agent.name.clone();
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::Length { agent: name(), error })
    };
    length("axes", m, agent.robot.axes.len())?;
    length("theta", p, agent.robot.theta.len())?;
    let (damping, adaptation) = match &agent.law {
        Law::Known { damping } => (damping, None),
        Law::Adaptive { damping, adaptation, estimate_start } => {
            length("start of the estimate", p, estimate_start.len())?;
            (damping, Some(adaptation))
        }
        law => return Err(SetupError::LawOfAnother { agent: name(), law: law.words(), made_for: law.made_for() }),
    };
    let law = tracking_law(robot, agent, damping, adaptation)?;
    let estimate_cost = match &law.adaptation {
        Some(gamma) => {
            Some(InverseQuadratic::new(gamma).map_err(|error| SetupError::Gain { agent: name(), gain: "Γ", error })?)
        }
        None => None,
    };
    let effort_limits = if agent.enforce_limits {
        let limit = |axis: &crate::setup::Axis| {
            axis.effort_limit.ok_or_else(|| SetupError::NoEffortLimit { agent: name(), axis: axis.name.clone() })
        };
        Some(agent.robot.axes.iter().map(limit).collect::<Result<_, _>>()?)
    } else {
        None
    };
    Ok(Member {
        agent: index,
        theta: agent.robot.theta.clone(),
        viscous: agent.robot.viscous(),
        law,
        estimate_cost,
        effort_limits,
    })
}

/// K and Γ of one agent, with its robot's natural scales for gains that are bandwidths.
pub(super) fn tracking_law<R: Lagrangian<f64>>(
    robot: &R,
    agent: &AgentSetup,
    damping: &Gain,
    adaptation: Option<&Gain>,
) -> Result<SlotineLi, SetupError> {
    let (m, p) = (robot.dof(), robot.parameter_count());
    let name = || agent.name.clone();
    let mut mass = vec![0.0; m * m];
    robot
        .mass_matrix(&mut robot.scratch(), &agent.start.q, &agent.robot.theta, &mut mass)
        .map_err(|error| SetupError::Length { agent: name(), error })?;
    let diagonal: Vec<f64> = mass.iter().step_by(m + 1).copied().collect();
    let resolve = |gain: &Gain, which, size, scale: &[f64]| -> Result<ResolvedGain, SetupError> {
        gain.resolve(size, scale).map_err(|error| SetupError::Gain { agent: name(), gain: which, error })
    };
    let adaptation = match adaptation {
        Some(gain) => {
            // Γ = ω² diag(scale): one ω is multiplied in here, the other by `resolve`.
            let omega = if let Gain::Bandwidth(omega) = gain { *omega } else { 1.0 };
            let scale = robot.adaptation_scale(&agent.start.q, &agent.robot.theta);
            let scale: Vec<f64> = scale.iter().map(|scale| omega * scale).collect();
            Some(resolve(gain, "Γ", p, &scale)?)
        }
        None => None,
    };
    Ok(SlotineLi { damping: resolve(damping, "K", m, &diagonal)?, adaptation })
}
