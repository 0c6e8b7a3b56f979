//! How far pushes move the value agreed upon, where that is known before the run.
//!
//! With λ > 0 an agent's share of the conserved quantity moves by (λ/α₀) ∫ s dt (see `agreement`). With known
//! parameters M ṡ + C s + (K + D) s = τ_ext, and ∫ s follows in two cases:
//!
//! ```text
//! nothing acts and s(0) = 0          s ≡ 0, whatever the robot
//! a point mass, s → 0                K ∫ s dt = ∫ τ_ext dt + m s(0),  since M = m 1 and C = D = 0
//! ```
//!
//! The second is what Remark 4 wants: a push moves the agreement by as much as its impulse says, and λ = 0 makes it not move
//! at all. A hand and dry friction give torques that only the run knows.

use forwardstep_core::Gain;
use forwardstep_core::robot::PointMass;
use forwardstep_sim::push::{Between, Course, Effect, Function, Push, Table};
use forwardstep_sim::{AgentSetup, Known};

use crate::surroundings::dry_loss_w;

/// ∫ s dt over all time on one axis, if it is known before the run.
pub(crate) fn error_integral(agent: &AgentSetup, axis: usize) -> Option<f64> {
    let Known { damping } = agent.law.downcast()?;
    if agent.enforce_limits {
        return None;
    }
    let s_0 = agent.start.reference.first().map_or(0.0, |z| agent.start.dq[axis] - z[axis]);
    if agent.pushes.is_empty() && dry_loss_w(agent).is_none() && follows(agent) {
        return Some(0.0);
    }
    let (true, [mass]) = (agent.robot.kind.is::<PointMass>(), agent.robot.theta.as_slice()) else { return None };
    let k = match damping {
        Gain::Number(k) => *k,
        Gain::Diagonal(diagonal) => *diagonal.get(axis)?,
        Gain::Bandwidth(omega) => omega * mass,
        Gain::Matrix(_) => return None,
    };
    Some((impulses(agent, axis)? + mass * s_0) / k)
}

/// ∫ τ_ext dt of all pushes on one axis, if it is known before the run.
pub(crate) fn impulses(agent: &AgentSetup, axis: usize) -> Option<f64> {
    agent.pushes.iter().map(|push| impulse(push, axis)).sum()
}

/// Whether z(0) = q̇(0) on all axes.
fn follows(agent: &AgentSetup) -> bool {
    agent.start.reference.first().is_none_or(|z| *z == agent.start.dq)
}

/// ∫ τ_ext dt of a push on one axis.
fn impulse(push: &Push, axis: usize) -> Option<f64> {
    let Effect::Torque(course) = &push.effect else { return None };
    let [begins_s, ends_s] = push.span_s();
    if begins_s >= ends_s {
        return Some(0.0);
    }
    match course {
        Course::Each(functions) => match functions.get(axis)? {
            Function::Constant(value) if *value == 0.0 => Some(0.0),
            Function::Constant(value) if ends_s.is_finite() => Some(value * (ends_s - begins_s)),
            _ => None,
        },
        Course::Table(table) => Some(area(table, axis, begins_s, ends_s)),
    }
}

/// The area under one column between two times.
fn area(table: &Table, axis: usize, begins_s: f64, ends_s: f64) -> f64 {
    let width = table.components();
    if axis >= width {
        return 0.0;
    }
    let pieces =
        table.times_s.windows(2).zip(table.values.chunks_exact(width).zip(table.values.chunks_exact(width).skip(1)));
    pieces
        .map(|(times, (here, next))| {
            let (from, to) = (begins_s.max(times[0]), ends_s.min(times[1]));
            if from >= to {
                return 0.0;
            }
            let slope = match table.between {
                Between::Hold => 0.0,
                Between::Linear => (next[axis] - here[axis]) / (times[1] - times[0]),
            };
            (to - from) * (here[axis] + slope * (0.5 * (from + to) - times[0]))
        })
        .sum()
}
