//! How far one held sample goes: guides for the rate of a sampled controller.

use forwardstep_core::Gain;
use forwardstep_sim::{Adaptive, AgentSetup, DynamicsAt, Known, Setup};
use nalgebra::{DMatrix, DVector};

use crate::inertia::Inertias;

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
    /// No x at any position exceeds this, by the certified bounds of M; `None` where an agent has none.
    pub anywhere: Option<f64>,
}

/// How fast the damping is: λ_max(M⁻¹K) in 1/s, the rate at which s decays in its fastest mode, over the agents under (6)–(7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastestDamping {
    /// Index of the agent whose damping is fastest at the start.
    pub agent: usize,
    /// That of this agent, with M at its start, 1/s.
    pub at_start_per_s: f64,
    /// No rate of any of the agents exceeds this at any position, by the certified bounds of M, 1/s; `None` where one has none.
    pub anywhere_per_s: Option<f64>,
}

/// [`FastestDamping`] of a setup; `None` when no agent is under (6)–(7), or no mass matrix can be factored.
pub fn fastest_damping(setup: &Setup) -> Option<FastestDamping> {
    let all: Vec<usize> = (0..setup.agents.len()).collect();
    fastest_damping_of(setup, &all, &mut Inertias::default())
}

/// The same of some agents.
pub(crate) fn fastest_damping_of(setup: &Setup, agents: &[usize], inertias: &mut Inertias) -> Option<FastestDamping> {
    let mut fastest: Option<FastestDamping> = None;
    let mut bounded = true;
    for &agent in agents {
        let own = &setup.agents[agent];
        if gain(own).is_none() {
            continue;
        }
        let known = fastest.and_then(|before| before.anywhere_per_s).unwrap_or(0.0);
        let Some((at_start_per_s, anywhere_per_s)) = rates(own, inertias, known) else {
            bounded = false;
            continue;
        };
        let found = FastestDamping { agent, at_start_per_s, anywhere_per_s };
        fastest = Some(fastest.map_or(found, |before| {
            let first = if at_start_per_s > before.at_start_per_s { found } else { before };
            let both = before.anywhere_per_s.zip(anywhere_per_s).map(|(a, b)| a.max(b));
            FastestDamping { anywhere_per_s: both, ..first }
        }));
    }
    fastest.map(|found| FastestDamping { anywhere_per_s: found.anywhere_per_s.filter(|_| bounded), ..found })
}

/// [`SampledDamping`] of a setup under digital control; `None` when control is continuous or no mass matrix can be factored.
pub fn sampled_damping(setup: &Setup) -> Option<SampledDamping> {
    let control = setup.control.as_ref()?;
    let period_s = 1.0 / control.sample_hz;
    let late = control.computation_delay_s * control.sample_hz;
    let slow = if late < 0.5 { 2.0 / (1.0 - 2.0 * late) } else { f64::INFINITY };
    let root = 1.0 + late.sqrt();
    let [overshoots_above, unstable_above] = [1.0 / (root * root), slow.min(1.0 / late)];
    let FastestDamping { agent, at_start_per_s, anywhere_per_s } = fastest_damping(setup)?;
    let anywhere = anywhere_per_s.map(|rate| period_s * rate);
    Some(SampledDamping {
        value: period_s * at_start_per_s,
        overshoots_above,
        unstable_above,
        agent,
        period_s,
        anywhere,
    })
}

/// How far one held sample of damping and adaptation goes: h · λ_max(M⁻¹(K + ½ h Y Γ Yᵀ)), largest over the agents that adapt.
///
/// The estimate is stepped with the Y of one sample and the s of the next; the head of `agent/mod.rs` of the core derives that
/// a mode is stable while this is below two. Y is that of the start, with z = q̇, and with ż as large as the gain of the sign where
/// a leader is followed and zero elsewhere. Y grows with the velocities and with ż, so this is a guide, not a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledAdaptation {
    /// h · λ_max(M⁻¹(K + ½ h Y Γ Yᵀ)).
    pub value: f64,
    /// Index of the agent.
    pub agent: usize,
}

/// [`SampledAdaptation`] of a setup under digital control; `None` when no agent under (6)–(7) adapts, and where robots follow targets
/// of their own: there both are of one sample.
pub fn sampled_adaptation(setup: &Setup) -> Option<SampledAdaptation> {
    let control = setup.control.as_ref()?;
    let period_s = 1.0 / control.sample_hz;
    let dz = setup.following().map_or(0.0, |following| following.gain);
    let value = |(agent, own): (usize, &AgentSetup)| {
        let Adaptive { adaptation, .. } = own.law.downcast()?;
        let model = model(own, dz)?;
        let p = model.scale.len();
        // Γ = ω² diag(scale): one ω is multiplied in here, the other by `resolve`.
        let omega = if let Gain::Bandwidth(omega) = adaptation { *omega } else { 1.0 };
        let scale: Vec<f64> = model.scale.iter().map(|scale| omega * scale).collect();
        let gamma = dense(adaptation, p, &scale)?;
        let learns = &model.regressor * gamma * model.regressor.transpose();
        let value = period_s * largest(&model.mass, &(damping(own, &model)? + 0.5 * period_s * learns))?;
        Some(SampledAdaptation { value, agent })
    };
    let followers = setup.agents.iter().enumerate().filter(|(agent, _)| !setup.tracks(*agent));
    followers.filter_map(value).max_by(|a, b| a.value.total_cmp(&b.value))
}

/// λ_max(M⁻¹K) at the start, and what it does not exceed at any position, where that is known, 1/s: `known` if that suffices.
fn rates(agent: &AgentSetup, inertias: &mut Inertias, known: f64) -> Option<(f64, Option<f64>)> {
    let model = model(agent, 0.0)?;
    let at_start = largest(&model.mass, &damping(agent, &model)?)?;
    let scale: Vec<f64> = model.mass.diagonal().iter().copied().collect();
    let gain = gain(agent)?.resolve(scale.len(), &scale).ok()?;
    Some((at_start, inertias.bound(&agent.robot, |bound| bound.fastest(&gain, known).ok().flatten())))
}

/// What an agent under (6)–(7) is at its start.
struct Model {
    mass: DMatrix<f64>,
    /// Y.
    regressor: DMatrix<f64>,
    /// What a Γ that is a bandwidth goes by.
    scale: Vec<f64>,
}

/// `None` where the law is another; every entry of ż is `dz`.
fn model(agent: &AgentSetup, dz: f64) -> Option<Model> {
    gain(agent)?;
    let DynamicsAt { mass, regressor, adaptation_scale } =
        agent.robot.kind.lagrangian()?.dynamics_at_start(agent, dz).ok()?;
    let (m, p) = (agent.robot.axes.len(), adaptation_scale.len());
    Some(Model {
        mass: DMatrix::from_row_slice(m, m, &mass),
        regressor: DMatrix::from_row_slice(m, p, &regressor),
        scale: adaptation_scale,
    })
}

/// K as it was stated, of agents under (6)–(7).
fn gain(agent: &AgentSetup) -> Option<&Gain> {
    let adaptive = agent.law.downcast().map(|Adaptive { damping, .. }| damping);
    adaptive.or(agent.law.downcast().map(|Known { damping }| damping))
}

/// K.
fn damping(agent: &AgentSetup, model: &Model) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = model.mass.diagonal().iter().copied().collect();
    dense(gain(agent)?, scale.len(), &scale)
}

/// A gain with all its entries.
fn dense(gain: &Gain, size: usize, scale: &[f64]) -> Option<DMatrix<f64>> {
    let gain = gain.resolve(size, scale).ok()?;
    let mut dense = DMatrix::zeros(size, size);
    let (mut unit, mut column) = (vec![0.0; size], DVector::zeros(size));
    for j in 0..size {
        unit.fill(0.0);
        unit[j] = 1.0;
        gain.apply(&unit, column.as_mut_slice());
        dense.set_column(j, &column);
    }
    Some(dense)
}

/// The largest eigenvalue of M⁻¹ `gain`: those of L⁻¹ `gain` L⁻ᵀ, which is symmetric, with M = L Lᵀ.
fn largest(mass: &DMatrix<f64>, gain: &DMatrix<f64>) -> Option<f64> {
    let l = mass.clone().cholesky()?.l();
    let half = l.solve_lower_triangular(gain)?;
    let whole = l.solve_lower_triangular(&half.transpose())?;
    let largest = whole.symmetric_eigenvalues().max();
    largest.is_finite().then_some(largest)
}
