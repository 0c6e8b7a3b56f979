//! Peak torques while everybody follows exactly.
//!
//! With s ≡ 0 the torque (6) of a robot that knows ϑ is Y(q, q̇, z, ż) ϑ = M(q) ż + C(q, q̇) q̇ + g(q) along the reference, whatever its gains.
//! An estimate that starts near ϑ adds little. It is a prediction, no bound: the torque also has −K s and Y Δϑ̂ in it.

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{Adaptive, AgentSetup, Known, Recording, Setup, Signal};

/// The largest torque of an axis along the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakTorque {
    /// Index of the agent.
    pub agent: usize,
    /// Index of the axis.
    pub axis: usize,
    /// The torque with its sign, N m or N.
    pub value: f64,
    /// When, s.
    pub t_s: f64,
    /// How far the estimate starts from the truth: the largest |ϑ̂ − ϑ| of an entry over |ϑ|; zero where ϑ is known.
    pub estimate_off: f64,
}

/// The peaks of all robots under (6)–(7) of `setup`, from the rows of the run of [`crate::ideal`]. Other agents have none.
pub(super) fn peak_torques(setup: &Setup, ideal: &Recording) -> Vec<PeakTorque> {
    let robots = setup.agents.iter().enumerate();
    robots.filter_map(|(index, agent)| of_agent(index, agent, ideal)).flatten().collect()
}

fn of_agent(index: usize, agent: &AgentSetup, ideal: &Recording) -> Option<Vec<PeakTorque>> {
    let (model, estimate_off) = (agent.robot.kind.lagrangian()?, estimate_off(agent)?);
    let axes = agent.robot.axes.len();
    let columns = |signal| -> Option<Vec<&[f64]>> {
        let column = |axis| {
            let is =
                |column: &&forwardstep_sim::Column| (column.agent, column.signal, column.axis) == (index, signal, axis);
            ideal.columns.iter().find(is).map(|column| column.values.as_slice())
        };
        (0..axes).map(column).collect()
    };
    let (q, dq, ddq) = (columns(Signal::Position)?, columns(Signal::Velocity)?, columns(Signal::Reference(1))?);
    let mut peaks: Vec<PeakTorque> =
        (0..axes).map(|axis| PeakTorque { agent: index, axis, value: 0.0, t_s: 0.0, estimate_off }).collect();
    let theta = &agent.robot.theta;
    let at = |columns: &[&[f64]], row: usize| {
        columns.iter().map(|column| column.get(row).copied()).collect::<Option<Vec<f64>>>()
    };
    for (row, t_s) in ideal.t_s.iter().enumerate() {
        let (q, dq, ddq) = (at(&q, row)?, at(&dq, row)?, at(&ddq, row)?);
        let motion = TwoVelocity { q: &q, dq: &dq, z: &dq, dz: &ddq };
        let dynamics = model.dynamics_at(theta, motion).ok()?;
        for (axis, peak) in peaks.iter_mut().enumerate() {
            let entries = dynamics.regressor[axis * theta.len()..].iter().zip(theta);
            let value: f64 = entries.map(|(y, theta)| y * theta).sum();
            if value.abs() > peak.value.abs() {
                (peak.value, peak.t_s) = (value, *t_s);
            }
        }
    }
    Some(peaks)
}

/// How far the estimate starts from the truth; `None` under another law.
fn estimate_off(agent: &AgentSetup) -> Option<f64> {
    if agent.law.is::<Known>() {
        return Some(0.0);
    }
    let Adaptive { estimate_start, .. } = agent.law.downcast()?;
    let off = |(estimate, theta): (&f64, &f64)| {
        if estimate == theta { 0.0 } else { ((estimate - theta) / theta).abs() }
    };
    Some(estimate_start.iter().zip(&agent.robot.theta).map(off).fold(0.0, f64::max))
}
