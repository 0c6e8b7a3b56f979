//! What digital control adds to the question whether a theorem applies.

use forwardstep_core::robot::{Lagrangian, PlanarArm, PointMass};
use forwardstep_core::{Gain, LengthError};
use forwardstep_sim::{AgentSetup, Law, RobotKind, Setup, VelocitySensor};
use nalgebra::{DMatrix, DVector};

use crate::verdict::{Answer, Hypothesis};

/// How far one held sample of the damping goes: h · λ_max(M⁻¹K), largest over the agents, at their starts.
///
/// Held for a period h and applied δ h late, τ = −K s moves s along a mode of x = h λ as
///
/// ```text
/// s_{k+1} = (1 − x (1 − δ)) s_k − x δ s_{k−1}
/// ```
///
/// which is stable for x δ < 1 and x (1 − 2δ) < 2, and does not overshoot for x ≤ 1/(1 + √δ)². M changes with the position, and a
/// filter of velocities comes later still, so this is a guide, not a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledDamping {
    /// x = h · λ_max(M⁻¹K).
    pub value: f64,
    /// Above this the held damping overshoots: one, and less when torques come late.
    pub overshoots_above: f64,
    /// Above this it is unstable: two, and less when torques come late.
    pub unstable_above: f64,
    /// Index of the agent.
    pub agent: usize,
    /// The period h, s.
    pub period_s: f64,
}

/// [`SampledDamping`] of a setup under digital control; `None` when control is continuous or no mass matrix can be factored.
pub fn sampled_damping(setup: &Setup) -> Option<SampledDamping> {
    let control = setup.control.as_ref()?;
    let period_s = 1.0 / control.sample_hz;
    let late = control.computation_delay_s * control.sample_hz;
    let slow = if late < 0.5 { 2.0 / (1.0 - 2.0 * late) } else { f64::INFINITY };
    let root = 1.0 + late.sqrt();
    let [overshoots_above, unstable_above] = [1.0 / (root * root), slow.min(1.0 / late)];
    let all = setup.agents.iter().enumerate();
    let values = all.filter_map(|(agent, a)| fastest(a).map(|lambda| (agent, lambda)));
    let (agent, lambda) = values.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(SampledDamping { value: period_s * lambda, overshoots_above, unstable_above, agent, period_s })
}

/// λ_max(M⁻¹K) at the start, 1/s.
fn fastest(agent: &AgentSetup) -> Option<f64> {
    let m = agent.start.q.len();
    let mass = match &agent.robot.kind {
        RobotKind::Tree(tree) => mass(&**tree, agent),
        RobotKind::PlanarArm => mass(&PlanarArm, agent),
        RobotKind::PointMass { dimension } => mass(&PointMass { dimension: *dimension }, agent),
        RobotKind::Vehicle { .. }
        | RobotKind::Rotorcraft { .. }
        | RobotKind::Spacecraft { .. }
        | RobotKind::Chain(_) => return None,
    };
    let (Law::Adaptive { damping, .. } | Law::Known { damping }) = &agent.law else { return None };
    let mass = DMatrix::from_row_slice(m, m, &mass.ok()?);
    let scale: Vec<f64> = mass.diagonal().iter().copied().collect();
    let damping: &Gain = damping;
    let k = damping.resolve(m, &scale).ok()?;
    let mut dense = DMatrix::zeros(m, m);
    let mut unit = DVector::zeros(m);
    let mut column = vec![0.0; m];
    for j in 0..m {
        unit.fill(0.0);
        unit[j] = 1.0;
        k.apply(unit.as_slice(), &mut column);
        dense.set_column(j, &DVector::from_column_slice(&column));
    }
    // The eigenvalues of M⁻¹K are those of L⁻¹ K L⁻ᵀ, which is symmetric, with M = L Lᵀ.
    let l = mass.cholesky()?.l();
    let half = l.solve_lower_triangular(&dense)?;
    let whole = l.solve_lower_triangular(&half.transpose())?;
    let largest = whole.symmetric_eigenvalues().max();
    largest.is_finite().then_some(largest)
}

fn mass<R: Lagrangian<f64>>(robot: &R, agent: &AgentSetup) -> Result<Vec<f64>, LengthError> {
    let m = robot.dof();
    let mut mass = vec![0.0; m * m];
    robot.mass_matrix(&mut robot.scratch(), &agent.start.q, &agent.robot.theta, &mut mass)?;
    Ok(mass)
}

/// Under digital control: the theorems speak of continuous time and of exact measurements.
pub(crate) fn digital(setup: &Setup) -> Vec<Hypothesis> {
    let Some(control) = &setup.control else { return Vec::new() };
    let damping = sampled_damping(setup).map_or_else(String::new, |damping| {
        let name = &setup.agents[damping.agent].name;
        let short = |value: f64| (value * 1000.0).round() / 1000.0;
        let (value, overshoots) = (short(damping.value), short(damping.overshoots_above));
        let meaning = if damping.value > damping.overshoots_above {
            let unstable = short(damping.unstable_above);
            format!(
                "above {overshoots} the held damping overshoots, above {unstable} it is unstable: sample faster or let K be smaller"
            )
        } else if let VelocitySensor::Filtered { .. } = control.sensors.velocity {
            format!("up to {overshoots} the held damping would not overshoot, if the filter of the velocities did not lag")
        } else {
            format!("up to {overshoots} the held damping does not overshoot")
        };
        format!("; h · λ_max(M⁻¹K) is {value} at the start ({name}): {meaning}")
    });
    let late = if control.computation_delay_s > 0.0 {
        format!(", torques come {} s late", control.computation_delay_s)
    } else {
        String::new()
    };
    let mut hypotheses = vec![Hypothesis {
        requires: "the controllers work in continuous time".into(),
        answer: Answer::NotCovered,
        because: format!(
            "they sample at {} Hz{late}; what is heard is up to a period older; as h → 0 the loop tends to the one the theorem speaks of{damping}",
            control.sample_hz
        ),
    }];
    let sensors = &control.sensors;
    let mut inexact = Vec::new();
    if sensors.position_noise > 0.0 || sensors.velocity_noise > 0.0 {
        inexact.push("there is noise");
    }
    if sensors.position_quantum > 0.0 || sensors.velocity_quantum > 0.0 {
        inexact.push("measurements are quantised");
    }
    if let VelocitySensor::Filtered { .. } = sensors.velocity {
        inexact.push("velocities come from filtered differences");
    }
    if !inexact.is_empty() {
        hypotheses.push(Hypothesis {
            requires: "q and q̇ are measured".into(),
            answer: Answer::NotCovered,
            because: inexact.join(", "),
        });
    }
    hypotheses
}

/// What keeps the torque from being what the law asks for, in words.
pub(crate) fn limited_actuators(setup: &Setup) -> Vec<&'static str> {
    let Some(control) = &setup.control else { return Vec::new() };
    let actuators = &control.actuators;
    let each = [
        (actuators.torque_limit.is_some(), "torques are limited"),
        (actuators.torque_rate_limit.is_some(), "the rate of torques is limited"),
        (actuators.torque_quantum > 0.0, "torques are quantised"),
    ];
    each.into_iter().filter(|(is, _)| *is).map(|(_, words)| words).collect()
}
