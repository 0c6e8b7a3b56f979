//! Peak torques while everybody follows exactly.
//!
//! With s ≡ 0 the torque (6) of a robot that knows ϑ is Y(q, q̇, z, ż) ϑ = M(q) ż + C(q, q̇) q̇ + g(q) along the reference, whatever its gains.
//! An estimate that starts near ϑ adds little. It is a prediction, no bound: the torque also has −K s and Y Δϑ̂ in it.
//!
//! How much these can add follows from V. With P = Y Γ Yᵀ, by Cauchy and Schwarz in the norm of V = ½ sᵀMs + ½ Δϑ̂ᵀ Γ⁻¹ Δϑ̂,
//!
//! ```text
//! |τ_j − (Y ϑ)_j| = |(−K s + Y Δϑ̂)_j| ≤ √(2 V) √((K M⁻¹ K + P)_jj)
//! ```
//!
//! and V ≤ V(0) in continuous time without pushes, dry friction and limits. That is certain wherever M and Y are those of the run. Before the run they are not
//! known but along the reference, where they are taken: the sum is a bound for certain where s ≡ 0, since V(0) = 0, and otherwise as far as q, q̇, z and ż
//! stay near those that s ≡ 0 leads to. With estimates that start far from ϑ it is many times what is reached. Not from the paper.

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{Adaptive, AgentSetup, DynamicsAt, Known, Recording, Setup, Signal};
use nalgebra::{DMatrix, DVector};

use crate::practical::{Gains, is_fed, start_energy_j};

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
    /// What its size cannot exceed while V is at most V(0) and M and Y are those along the reference; `None` where V(0) is not known, or V
    /// may grow: under digital control, with pushes or dry friction, and with limits that are enforced.
    pub at_most: Option<f64>,
}

impl PeakTorque {
    /// The bound is within twice what is predicted, so that motors can be chosen by it.
    pub fn is_practical(&self) -> bool {
        self.at_most.is_some_and(|at_most| at_most <= 2.0 * self.value.abs())
    }
}

/// Rows at which the bound is worked out at most, for every agent.
const MOST_ROWS: usize = 200;

/// What damping and adaptation of an agent can add.
struct Allowance {
    gains: Gains,
    /// √(2 V(0)).
    size: f64,
}

impl Allowance {
    fn of(setup: &Setup, index: usize) -> Option<Allowance> {
        if is_fed(setup) || setup.agents[index].enforce_limits {
            return None;
        }
        let gains = Gains::of(&setup.agents[index])?;
        let energy_j = start_energy_j(setup, index, &gains)?;
        (energy_j >= 0.0 && energy_j.is_finite()).then(|| Allowance { size: (2.0 * energy_j).sqrt(), gains })
    }

    /// √(2 V(0)) √((K M⁻¹ K + P)_jj) of every axis.
    fn at(&self, dynamics: &DynamicsAt) -> Option<DVector<f64>> {
        let Gains { damping, adaptation } = &self.gains;
        let axes = damping.nrows();
        let mass = DMatrix::from_row_slice(axes, axes, &dynamics.mass);
        let mut squares = (damping * mass.cholesky()?.solve(damping)).diagonal();
        if let Some(gamma) = adaptation {
            let y = DMatrix::from_row_slice(axes, gamma.nrows(), &dynamics.regressor);
            squares += (&y * gamma).component_mul(&y).column_sum();
        }
        Some(squares.map(|square| self.size * square.max(0.0).sqrt()))
    }
}

/// The peaks of all robots under (6)–(7) of `setup`, from the rows of the run of [`crate::ideal`]. Other agents have none.
pub(super) fn peak_torques(setup: &Setup, ideal: &Recording) -> Vec<PeakTorque> {
    let robots = setup.agents.iter().enumerate();
    robots.filter_map(|(index, agent)| of_agent(setup, index, agent, ideal)).flatten().collect()
}

fn of_agent(setup: &Setup, index: usize, agent: &AgentSetup, ideal: &Recording) -> Option<Vec<PeakTorque>> {
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
    let mut peaks: Vec<PeakTorque> = (0..axes)
        .map(|axis| PeakTorque { agent: index, axis, value: 0.0, t_s: 0.0, estimate_off, at_most: None })
        .collect();
    let allowance = Allowance::of(setup, index);
    let mut most = allowance.as_ref().map(|_| vec![0.0_f64; axes]);
    let stride = ideal.t_s.len().div_ceil(MOST_ROWS).max(1);
    let theta = &agent.robot.theta;
    let at = |columns: &[&[f64]], row: usize| {
        columns.iter().map(|column| column.get(row).copied()).collect::<Option<Vec<f64>>>()
    };
    for (row, t_s) in ideal.t_s.iter().enumerate() {
        let (q, dq, ddq) = (at(&q, row)?, at(&dq, row)?, at(&ddq, row)?);
        let motion = TwoVelocity { q: &q, dq: &dq, z: &dq, dz: &ddq };
        let dynamics = model.dynamics_at(theta, motion).ok()?;
        let mut torques = Vec::with_capacity(axes);
        for (axis, peak) in peaks.iter_mut().enumerate() {
            let entries = dynamics.regressor[axis * theta.len()..].iter().zip(theta);
            let value: f64 = entries.map(|(y, theta)| y * theta).sum();
            if value.abs() > peak.value.abs() {
                (peak.value, peak.t_s) = (value, *t_s);
            }
            torques.push(value.abs());
        }
        if let Some(allowance) = allowance.as_ref().filter(|_| row % stride == 0) {
            let added = allowance.at(&dynamics);
            most = most.zip(added).map(|(most, added)| {
                let both = most.iter().zip(torques.iter().zip(&added));
                both.map(|(most, (torque, added))| most.max(torque + added)).collect()
            });
        }
    }
    for (peak, most) in peaks.iter_mut().zip(most.into_iter().flatten()) {
        // Between the rows that were looked at the predicted torque itself may be larger.
        peak.at_most = Some(most.max(peak.value.abs())).filter(|most| most.is_finite());
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
