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
//! and V ≤ V(0) in continuous time without pushes, dry friction and limits. With one root z is no state beside what is conserved, but follows from it: ż has
//! −(α₀ + dᵢ − λᵢ) sᵢ in it, and w_ij s_j(t − T_ij) where velocities are heard, so that M ż adds as much. By |s_k| ≤ √(2 V) √((M⁻¹)_kk) that is bounded, too.
//!
//! That is certain wherever M and Y are those of the run. Before the run they are not known but along the reference, where they are taken: the sum is a bound
//! for certain where s ≡ 0, since V(0) = 0, and otherwise as far as q, q̇, z and ż, but for what s adds to ż at once, stay near those that s ≡ 0 leads to. With
//! estimates that start far from ϑ it is many times what is reached. Not from the paper.
//!
//! A run whose z(0) is not q̇(0) does not begin on that course, and the integral of s leads it, and those who hear it, away: there is no bound. The torque
//! that it begins with is known, and stands in the place of that of s ≡ 0.

use std::ops::ControlFlow;

use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::{Adaptive, AgentSetup, DynamicsAt, Known, Recording, Setup, Signal, TimeSpan, simulate};
use nalgebra::{DMatrix, DVector};

use super::ideal::start_error;
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
    /// What its size cannot exceed while V is at most V(0) and M and Y are those along the reference, but for what s adds to ż at once;
    /// `None` where V(0) is not known, V may grow, under digital control, with pushes or dry friction, and with limits that are enforced, or the
    /// run begins beside this course, with an s(0).
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
    /// What ż has in it of s at once, 1/s; zero with several roots.
    through_per_s: f64,
    /// The same of what is heard, of every axis.
    heard: Vec<f64>,
}

impl Allowance {
    fn of(setup: &Setup, index: usize) -> Option<Allowance> {
        let agent = &setup.agents[index];
        let (gains, size) = own_size(setup, index)?;
        let axes = agent.robot.axes.len();
        let mut allowance = Allowance { gains, size, through_per_s: 0.0, heard: vec![0.0; axes] };
        if agent.roots_per_s.len() > 1 {
            return Some(allowance);
        }
        let mut most = (0.0_f64, vec![0.0_f64; axes]);
        for graph in &setup.network.schedule.graphs {
            let (mut degree, mut heard) = (0.0, vec![0.0; axes]);
            for edge in graph.iter().filter(|edge| edge.to == index) {
                let weight = weight_at_most(setup, edge.weight);
                degree += weight;
                if setup.exchange.has_velocities() {
                    let errors = errors(setup, edge.from)?;
                    heard.iter_mut().zip(errors).for_each(|(sum, error)| *sum += weight * error);
                }
            }
            most.0 = most.0.max(degree);
            most.1.iter_mut().zip(heard).for_each(|(most, sum)| *most = most.max(sum));
        }
        let own = agent.roots_per_s.first_real()?;
        (allowance.through_per_s, allowance.heard) = (own + most.0 + agent.manipulability, most.1);
        Some(allowance)
    }

    /// √(2 V(0)) √((K M⁻¹ K + P)_jj) of every axis, and what s and what is heard of it add to M ż.
    fn at(&self, dynamics: &DynamicsAt) -> Option<DVector<f64>> {
        let Gains { damping, adaptation } = &self.gains;
        let axes = damping.nrows();
        let mass = DMatrix::from_row_slice(axes, axes, &dynamics.mass);
        let factor = mass.clone().cholesky()?;
        let own = factor.inverse().diagonal().map(|inverse| self.through_per_s * self.size * inverse.max(0.0).sqrt());
        let through = mass.abs() * (own + DVector::from_column_slice(&self.heard));
        let mut squares = (damping * factor.solve(damping)).diagonal();
        if let Some(gamma) = adaptation {
            let y = DMatrix::from_row_slice(axes, gamma.nrows(), &dynamics.regressor);
            squares += (&y * gamma).component_mul(&y).column_sum();
        }
        Some(squares.map(|square| self.size * square.max(0.0).sqrt()) + through)
    }
}

/// Gains and √(2 V(0)) of an agent whose V cannot grow.
fn own_size(setup: &Setup, index: usize) -> Option<(Gains, f64)> {
    if is_fed(setup) || setup.agents[index].enforce_limits {
        return None;
    }
    let gains = Gains::of(&setup.agents[index])?;
    let energy_j = start_energy_j(setup, index, &gains)?;
    (energy_j >= 0.0 && energy_j.is_finite()).then(|| (gains, (2.0 * energy_j).sqrt()))
}

/// How large s of every axis of an agent can be, with M as at the start.
fn errors(setup: &Setup, index: usize) -> Option<Vec<f64>> {
    let (agent, (_, size)) = (&setup.agents[index], own_size(setup, index)?);
    let axes = agent.robot.axes.len();
    if size == 0.0 {
        return Some(vec![0.0; axes]);
    }
    let (q, dq) = (&agent.start.q, &agent.start.dq);
    let motion = TwoVelocity { q, dq, z: dq, dz: &vec![0.0; axes] };
    let mass = agent.robot.kind.lagrangian()?.dynamics_at(&agent.robot.theta, motion).ok()?.mass;
    let inverse = DMatrix::from_row_slice(axes, axes, &mass).cholesky()?.inverse();
    Some(inverse.diagonal().iter().map(|inverse| size * inverse.max(0.0).sqrt()).collect())
}

/// The largest value of a weight.
fn weight_at_most(setup: &Setup, weight: Weight) -> f64 {
    match weight {
        Weight::Constant(weight) => weight,
        Weight::Formula(index) => {
            setup.network.weights.get(index).map_or(f64::INFINITY, |formula| formula.within().high)
        }
    }
}

/// The torques of every agent with which the run itself begins, where it does not begin as s ≡ 0 does.
fn at_start(setup: &Setup) -> Option<Recording> {
    if setup.control.is_some() || setup.agents.iter().all(|agent| start_error(agent) == 0.0) {
        return None;
    }
    let end_s = setup.time.end_s.min(setup.time.record_every_s);
    let setup = Setup { time: TimeSpan { end_s, record_every_s: end_s, ..setup.time.clone() }, ..setup.clone() };
    simulate(&setup, &mut |_| ControlFlow::Break(())).ok().map(|outcome| outcome.recording)
}

/// The peaks of all robots under (6)–(7) of `setup`, from the rows of the run of [`crate::ideal`]. Other agents have none.
pub(super) fn peak_torques(setup: &Setup, ideal: &Recording) -> Vec<PeakTorque> {
    let robots = setup.agents.iter().enumerate();
    let start = at_start(setup);
    robots.filter_map(|(index, agent)| of_agent(setup, index, agent, [Some(ideal), start.as_ref()])).flatten().collect()
}

/// The column of a signal of every axis.
fn columns_of(recording: &Recording, agent: usize, signal: Signal, axes: usize) -> Option<Vec<&[f64]>> {
    let column = |axis| {
        let is =
            |column: &&forwardstep_sim::Column| (column.agent, column.signal, column.axis) == (agent, signal, axis);
        recording.columns.iter().find(is).map(|column| column.values.as_slice())
    };
    (0..axes).map(column).collect()
}

/// q, z and ż of an agent along the reference, where q̇ = z. Numbers are many, so no row has lists of its own.
struct Motions<'a> {
    columns: [Vec<&'a [f64]>; 3],
    now: [Vec<f64>; 3],
}

impl Motions<'_> {
    fn at(&mut self, row: usize) -> Option<TwoVelocity<'_, f64>> {
        for (columns, now) in self.columns.iter().zip(&mut self.now) {
            for (column, now) in columns.iter().zip(now) {
                *now = *column.get(row)?;
            }
        }
        let [q, z, dz] = &self.now;
        Some(TwoVelocity { q, dq: z, z, dz })
    }
}

fn of_agent(
    setup: &Setup,
    index: usize,
    agent: &AgentSetup,
    [ideal, start]: [Option<&Recording>; 2],
) -> Option<Vec<PeakTorque>> {
    let (model, estimate_off) = (agent.robot.kind.lagrangian()?, estimate_off(agent)?);
    let axes = agent.robot.axes.len();
    let ideal = ideal?;
    let columns = |signal| columns_of(ideal, index, signal, axes);
    let first = |torques: Vec<&[f64]>| torques.into_iter().map(|torque| torque.first().copied()).collect();
    let begins: Option<Vec<f64>> =
        start.and_then(|start| columns_of(start, index, Signal::Torque, axes)).and_then(first);
    let mut motions = Motions {
        columns: [columns(Signal::Position)?, columns(Signal::Velocity)?, columns(Signal::Reference(1))?],
        now: [(); 3].map(|()| vec![0.0; axes]),
    };
    let mut peaks: Vec<PeakTorque> = (0..axes)
        .map(|axis| PeakTorque { agent: index, axis, value: 0.0, t_s: 0.0, estimate_off, at_most: None })
        .collect();
    // A run that begins elsewhere does not stay near this course while V ≤ V(0) brings it there.
    let allowance = if begins.is_some() { None } else { Allowance::of(setup, index) };
    let stride = ideal.t_s.len().div_ceil(MOST_ROWS).max(1);
    let theta = &agent.robot.theta;
    let (mut evaluator, no_error) = (model.evaluator(), vec![0.0; axes]);
    let mut peak_rows = vec![0; axes];
    for (row, t_s) in ideal.t_s.iter().enumerate() {
        let motion = motions.at(row)?;
        let along = &evaluator.at(theta, motion, &no_error).ok()?.model;
        let begins = begins.as_ref().filter(|_| row == 0);
        for (axis, (peak, peak_row)) in peaks.iter_mut().zip(&mut peak_rows).enumerate() {
            let value = begins.map_or(along[axis], |begins| begins[axis]);
            if value.abs() > peak.value.abs() {
                (peak.value, peak.t_s, *peak_row) = (value, *t_s, row);
            }
        }
    }
    let mut most = allowance.as_ref().map(|_| vec![0.0_f64; axes]);
    if let Some(allowance) = &allowance {
        // Where the torque itself is largest counts, however few the other rows are.
        for row in (0..ideal.t_s.len()).step_by(stride).chain(peak_rows) {
            let motion = motions.at(row)?;
            let Some(added) = allowance.at(&model.dynamics_at(theta, motion).ok()?) else {
                most = None;
                break;
            };
            let along = &evaluator.at(theta, motion, &no_error).ok()?.model;
            for (most, (torque, added)) in most.iter_mut().flatten().zip(along.iter().zip(&added)) {
                *most = most.max(torque.abs() + added);
            }
        }
    }
    for (peak, most) in peaks.iter_mut().zip(most.into_iter().flatten()) {
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
    let off = |(estimate, theta): (&f64, &f64)| relative_error(*estimate, *theta);
    Some(estimate_start.iter().zip(&agent.robot.theta).map(off).fold(0.0, f64::max))
}

/// |ϑ̂ − ϑ| over |ϑ|.
pub(super) fn relative_error(estimate: f64, theta: f64) -> f64 {
    if estimate == theta { 0.0 } else { ((estimate - theta) / theta).abs() }
}
