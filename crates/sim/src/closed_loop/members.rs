//! From agents to batches: robots, reference dynamics, laws and, under digital control, samplers.

use forwardstep_core::law::SlotineLi;
use forwardstep_core::plant::total;
use forwardstep_core::robot::Lagrangian;
use forwardstep_core::{Gain, InverseQuadratic, Lanes, ResolvedGain, Vectors};

use super::assembly::{Assembly, effort_limits};
use super::columns::Columns;
use super::error::SetupError;
use super::population::Population;
use super::references::dynamics;
use super::robot_batch::{Layout, Member, RobotBatch, Robots};
use crate::agents::{Adaptive, Known, RobotModel};
use crate::setup::{AgentSetup, Setup};

/// Batches of at least so many agents are worked on in lanes.
const LANES_FROM: usize = 3;

/// Agents that can stand side by side: one robot model, one order, laws that share batches. Groups in order of their first
/// agent. Who follows a target of its own stands alone.
pub(super) fn batches(setup: &Setup) -> Vec<Vec<usize>> {
    let agents = &setup.agents;
    let in_batches =
        |index: usize| !setup.tracks(index) && agents[index].interface().is_some_and(|interface| interface.in_batches);
    let alike = |a: &AgentSetup, b: &AgentSetup| {
        a.roots_per_s.len() == b.roots_per_s.len()
            && a.law.same_type(&*b.law)
            && a.robot.kind.lagrangian().is_some_and(|robot| robot.same_model(&*b.robot.kind))
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, agent) in agents.iter().enumerate() {
        let joins = in_batches(index);
        match groups.iter_mut().find(|group| joins && alike(&agents[group[0]], agent)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

/// Robots of one model under (6)–(7), side by side.
pub(super) fn batch<M: RobotModel>(model: &M, assembly: &Assembly<'_>) -> Result<Box<dyn Columns>, SetupError> {
    boxed(model.kernel(), assembly)
}

fn boxed<R>(robot: R, assembly: &Assembly<'_>) -> Result<Box<dyn Columns>, SetupError>
where
    R: Lagrangian<f64> + Lagrangian<Lanes<8>> + Clone + Send + Sync + 'static,
{
    let setup = assembly.setup();
    let mut members = Vec::new();
    for agent in assembly.agents() {
        members.push(member(&robot, &Assembly::new(setup, std::slice::from_ref(agent)))?);
    }
    let reference = dynamics(assembly)?;
    let sampled = setup.control.is_some();
    // What a held torque does is not what the balance balances.
    let balance = setup.solver.balance && !sampled;
    let adaptive = members.iter().all(|member| member.law.adaptation.is_some());
    let (m, p) = (Lagrangian::<f64>::dof(&robot), Lagrangian::<f64>::parameter_count(&robot));
    let layout = Layout::new([members.len(), m, p, reference.vectors()], adaptive, balance);
    // Eight lanes cost about as much as two or three robots one at a time, so idle lanes pay from three robots on.
    let robots: Box<dyn Robots> = match Vectors::of_this_processor().filter(|_| members.len() >= LANES_FROM) {
        Some(vectors) => Box::new(RobotBatch::<R, Lanes<8>>::new(robot, vectors, &members, layout)),
        None => Box::new(RobotBatch::<R, f64>::new(robot, (), &members, layout)),
    };
    Ok(Box::new(Population::new(members, reference, robots, layout, sampled)))
}

/// The agent of `assembly` with its gains, checked.
pub(super) fn member<R: Lagrangian<f64>>(robot: &R, assembly: &Assembly<'_>) -> Result<Member, SetupError> {
    let (agent, at, m, p) = (assembly.agent(), assembly.of_robot(), robot.dof(), robot.parameter_count());
    assembly.length(at.clone(), "axes", m, agent.robot.axes.len())?;
    assembly.length(at.clone(), "theta", p, agent.robot.theta.len())?;
    assembly.length(at, "what acts on it from outside", m, total(&agent.robot.interface().attachments.blocks(m)))?;
    let (damping, adaptation, bounds) = match (agent.law.downcast::<Adaptive>(), agent.law.downcast::<Known>()) {
        (Some(Adaptive { damping, adaptation, estimate_start, bounds }), _) => {
            assembly.estimate("estimate_start.given", estimate_start, p)?;
            (damping, Some(adaptation), bounds.as_ref())
        }
        (None, Some(Known { damping })) => (damping, None, None),
        (None, None) => return Err(assembly.law_of_another()),
    };
    let mut law = tracking_law(robot, assembly, damping, adaptation)?;
    if let Some(bounds) = bounds {
        assembly.bounds(bounds, ["lower", "upper", "margin"], p)?;
        if !matches!(law.adaptation, Some(ResolvedGain::Diagonal(_))) {
            return Err(SetupError::ProjectionOfMatrix { agent: agent.name.clone() });
        }
        law.bounds = Some(bounds.clone());
    }
    let estimate_cost = law.adaptation.as_ref().map(InverseQuadratic::new).transpose().map_err(|error| {
        SetupError::Gain { agent: agent.name.clone(), path: assembly.of_law().key("adaptation_gain"), error }
    })?;
    let effort_limits = effort_limits(agent, m)?;
    Ok(Member {
        agent: assembly.agents()[0],
        theta: agent.robot.theta.clone(),
        axes: m,
        law,
        estimate_cost,
        effort_limits,
    })
}

/// K and Γ of the agent of `assembly`, with its robot's natural scales for gains that are bandwidths.
pub(crate) fn tracking_law<R: Lagrangian<f64>>(
    robot: &R,
    assembly: &Assembly<'_>,
    damping: &Gain,
    adaptation: Option<&Gain>,
) -> Result<SlotineLi, SetupError> {
    let (agent, m, p) = (assembly.agent(), robot.dof(), robot.parameter_count());
    let mut mass = vec![0.0; m * m];
    robot
        .mass_matrix(&mut robot.scratch(), &agent.start.q, &agent.robot.theta, &mut mass)
        .map_err(|error| SetupError::Length { agent: agent.name.clone(), error })?;
    let diagonal: Vec<f64> = mass.iter().step_by(m + 1).copied().collect();
    let adaptation = match adaptation {
        Some(gain) => {
            // Γ = ω² diag(scale): one ω is multiplied in here, the other where the gain is resolved.
            let omega = if let Gain::Bandwidth(omega) = gain { *omega } else { 1.0 };
            let scale = robot.adaptation_scale(&agent.start.q, &agent.robot.theta);
            let scale: Vec<f64> = scale.iter().map(|scale| omega * scale).collect();
            let path = key_of(gain, ["adaptation_gain", "adaptation_gain.bandwidth_per_s"]);
            Some(assembly.resolved(gain, assembly.of_law().key(path), p, &scale)?)
        }
        None => None,
    };
    let path = assembly.of_law().key(key_of(damping, ["damping.gain", "damping.bandwidth_per_s"]));
    Ok(SlotineLi { damping: assembly.resolved(damping, path, m, &diagonal)?, adaptation, bounds: None })
}

/// The key of a gain, which is the second for a bandwidth.
fn key_of(gain: &Gain, [itself, bandwidth]: [&'static str; 2]) -> &'static str {
    match gain {
        Gain::Number(_) | Gain::Diagonal(_) | Gain::Matrix(_) => itself,
        Gain::Bandwidth(_) => bandwidth,
    }
}
