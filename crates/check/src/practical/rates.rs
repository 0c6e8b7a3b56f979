//! How fast K is on a robot, and with it the adaptation: the modes that a sample must not outrun.
//!
//! Not from the paper, derived for this software. Let M and Y be those of a sample, P = Y Γ Yᵀ, and δ = s⁺ − s. A sampled (6)–(7) does
//! `M δ = h (Y Δϑ − K s)` and `Δϑ⁺ = Δϑ − h Γ Yᵀ s⁺`, the latter perhaps projected onto a box that holds ϑ, which V does not mind for a
//! diagonal Γ. Then V = ½ sᵀ M s + ½ Δϑᵀ Γ⁻¹ Δϑ changes in a period by
//!
//! ```text
//! V⁺ − V = −½ δᵀ M δ + h s⁺ᵀ K δ − h s⁺ᵀ K s⁺ + ½ h² s⁺ᵀ P s⁺
//!        ≤ −½ h s⁺ᵀ [2 K − h (K M⁻¹ K + P)] s⁺,      with equality for δ = h M⁻¹ K s⁺
//! ```
//!
//! so that V falls as long as σ < 1 with σ the largest eigenvalue of ½ h (K M⁻¹ K + P) relative to K. Nothing about Y from sample to
//! sample is used. Without adaptation σ = ½ h λ_max(M⁻¹ K). With Y frozen besides, a mode is unstable exactly above
//! h λ_max(M⁻¹ (K + ½ h P)) = 2, which the head of `agent/mod.rs` of the core derives.
//!
//! Where commands come late, or velocities are filtered, the damping bears k in place of 2, and ℓ h P is taken from K (`held`):
//!
//! ```text
//! σ = λ_max(K⁻¹ [(h/k) K M⁻¹ K + h (½ + ℓ) P])
//! ```
//!
//! which is the same where neither is. That is no bound on V: it says that no mode grows while Y stays, to first order in ℓ. Of one axis and every late or
//! filtered command no mode grows below σ = 0.975, as a test shows by the recursion of `held`.

use forwardstep_core::Gain;
use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::{Adaptive, AgentSetup, DynamicsAt, Known, Setup, check_shape};
use nalgebra::{DMatrix, DVector};

use super::held::Hold;
use crate::finite::finite;
use crate::inertia::Inertias;

/// Of a multiplier that is one.
const ROUNDING: f64 = 1e-7;

/// K and Γ of one agent under (6)–(7), with all their entries.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gains {
    pub(crate) damping: DMatrix<f64>,
    /// `None` where nothing adapts.
    pub(crate) adaptation: Option<DMatrix<f64>>,
}

/// What they come to at one state.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rates {
    /// λ_max(M⁻¹ K), 1/s.
    pub(crate) damping_per_s: f64,
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    learning: Option<Learning>,
}

/// What adaptation adds.
#[derive(Clone, Debug, PartialEq)]
struct Learning {
    /// P.
    p: DMatrix<f64>,
    /// K M⁻¹ K.
    kmk: DMatrix<f64>,
}

impl Gains {
    /// `None` where the law is another or a gain cannot be resolved.
    pub(crate) fn of(agent: &AgentSetup) -> Option<Gains> {
        let adaptive = agent.law.downcast().map(|Adaptive { adaptation, .. }| adaptation);
        Gains::resolved(agent, gain(agent)?, adaptive)
    }

    /// K and Γ as they are stated for a robot, whatever its law; `None` where one cannot be resolved.
    pub(crate) fn resolved(agent: &AgentSetup, damping: &Gain, adaptation: Option<&Gain>) -> Option<Gains> {
        let axes = agent.robot.axes.len();
        let DynamicsAt { mass, adaptation_scale, .. } =
            dynamics(agent, &agent.start.q, &agent.start.dq, &vec![0.0; agent.start.q.len()])?;
        let scale: Vec<f64> = mass.iter().copied().step_by(axes + 1).collect();
        let adaptation = match adaptation {
            None => None,
            Some(adaptation) => {
                // Γ = ω² diag(scale): one ω is multiplied in here, the other by `resolve`.
                let omega = if let Gain::Bandwidth(omega) = adaptation { *omega } else { 1.0 };
                let scale: Vec<f64> = adaptation_scale.iter().map(|scale| omega * scale).collect();
                Some(dense(adaptation, scale.len(), &scale)?)
            }
        };
        Some(Gains { damping: dense(damping, axes, &scale)?, adaptation })
    }

    /// The same without the adaptation.
    pub(crate) fn damping_alone(self) -> Gains {
        Gains { adaptation: None, ..self }
    }

    /// Their rates where M, Y and ϑ are those of `dynamics`; `None` where something is not finite, or M cannot be factored.
    pub(crate) fn rates(&self, dynamics: &DynamicsAt) -> Option<Rates> {
        if dynamics.mass.iter().chain(&dynamics.regressor).any(|entry| !entry.is_finite()) {
            return None;
        }
        let m = self.damping.nrows();
        let mass = DMatrix::from_row_slice(m, m, &dynamics.mass);
        let damping_per_s = largest(&mass, &self.damping)?;
        let learning = match &self.adaptation {
            None => None,
            Some(gamma) => {
                let y = DMatrix::from_row_slice(m, gamma.nrows(), &dynamics.regressor);
                let kmk = &self.damping * mass.clone().cholesky()?.solve(&self.damping);
                Some(Learning { p: &y * gamma * y.transpose(), kmk })
            }
        };
        Some(Rates { damping_per_s, mass, damping: self.damping.clone(), learning })
    }
}

impl Rates {
    /// σ with the period h = `period_s`; infinite where it cannot be told.
    pub(crate) fn sigma(&self, hold: Hold, period_s: f64) -> f64 {
        let share = period_s / hold.largest_gain(period_s);
        let Some(Learning { p, kmk }) = &self.learning else { return share * self.damping_per_s };
        let learnt = period_s * (0.5 + hold.lag(period_s));
        largest(&self.damping, &(share * kmk + learnt * p)).unwrap_or(f64::INFINITY)
    }

    /// Whether a mode grows from sample to sample where Y stays, by damping and adaptation together; not where nothing adapts.
    pub(crate) fn grows(&self, hold: Hold, period_s: f64) -> bool {
        if hold.is_ideal() {
            return self.frozen(period_s).is_some_and(|sigma| sigma >= 1.0);
        }
        let Some((Learning { p, .. }, factor)) = self.learning.as_ref().zip(self.mass.clone().cholesky()) else {
            return false;
        };
        let radius = hold.radius(period_s, &factor.solve(&self.damping), &factor.solve(p));
        radius.is_some_and(|radius| radius > 1.0 + ROUNDING)
    }

    /// ½ h λ_max(M⁻¹ (K + ½ h P)); `None` where nothing adapts. Above 1 damping and adaptation together are unstable where Y stays.
    pub(crate) fn frozen(&self, period_s: f64) -> Option<f64> {
        let Learning { p, .. } = self.learning.as_ref()?;
        Some(0.5 * period_s * largest(&self.mass, &(&self.damping + 0.5 * period_s * p))?)
    }
}

/// M, Y and the scale of ϑ of an agent at one state, where z = q̇, with ż.
pub(crate) fn dynamics(agent: &AgentSetup, q: &[f64], dq: &[f64], dz: &[f64]) -> Option<DynamicsAt> {
    let motion = TwoVelocity { q, dq, z: dq, dz };
    agent.robot.kind.lagrangian()?.dynamics_at(&agent.robot.theta, motion).ok()
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
    check_shape(setup).ok()?;
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
        let Some((at_start_per_s, anywhere_per_s)) = damping_rates(own, inertias, known) else {
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

/// λ_max(M⁻¹K) at the start, and what it does not exceed at any position, where that is known, 1/s: `known` if that suffices.
fn damping_rates(agent: &AgentSetup, inertias: &mut Inertias, known: f64) -> Option<(f64, Option<f64>)> {
    let DynamicsAt { mass, .. } = dynamics(agent, &agent.start.q, &agent.start.dq, &vec![0.0; agent.start.q.len()])?;
    let axes = agent.robot.axes.len();
    let scale: Vec<f64> = mass.iter().copied().step_by(axes + 1).collect();
    let stated = gain(agent)?;
    let mass = DMatrix::from_row_slice(axes, axes, &mass);
    let at_start = largest(&mass, &dense(stated, axes, &scale)?)?;
    let gain = stated.resolve(axes, &scale).ok()?;
    Some((at_start, inertias.bound(&agent.robot, |bound| bound.fastest(&gain, known).ok().flatten())))
}

/// K as it was stated, of agents under (6)–(7).
fn gain(agent: &AgentSetup) -> Option<&Gain> {
    let adaptive = agent.law.downcast().map(|Adaptive { damping, .. }| damping);
    adaptive.or(agent.law.downcast().map(|Known { damping }| damping))
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

/// The largest eigenvalue of `scale`⁻¹ `matrix`: those of L⁻¹ `matrix` L⁻ᵀ, which is symmetric, with `scale` = L Lᵀ.
fn largest(scale: &DMatrix<f64>, matrix: &DMatrix<f64>) -> Option<f64> {
    let l = scale.clone().cholesky()?.l();
    let half = l.solve_lower_triangular(matrix)?;
    let whole = l.solve_lower_triangular(&half.transpose())?;
    let largest = finite(whole)?.symmetric_eigenvalues().max();
    largest.is_finite().then_some(largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A symmetric positive definite matrix out of numbers.
    fn definite(n: usize, numbers: &[f64], floor: f64) -> DMatrix<f64> {
        let a = DMatrix::from_fn(n, n, |i, j| numbers[(i * n + j) % numbers.len()]);
        &a * a.transpose() + floor * DMatrix::identity(n, n)
    }

    /// V⁺ − V of one period, by its definition.
    fn gained(
        [mass, damping, gamma, y]: [&DMatrix<f64>; 4],
        h: f64,
        s: &DVector<f64>,
        error: &DVector<f64>,
    ) -> Option<(f64, DVector<f64>)> {
        let v = |s: &DVector<f64>, error: &DVector<f64>| -> Option<f64> {
            Some(0.5 * s.dot(&(mass * s)) + 0.5 * error.dot(&gamma.clone().cholesky()?.solve(error)))
        };
        let next = s + h * mass.clone().cholesky()?.solve(&(y * error - damping * s));
        let learnt = error - h * (gamma * (y.transpose() * &next));
        Some((v(&next, &learnt)? - v(s, error)?, next))
    }

    fn rates_of(mass: DMatrix<f64>, damping: DMatrix<f64>, p: DMatrix<f64>) -> Rates {
        let kmk = &damping * mass.clone().cholesky().unwrap().solve(&damping);
        let damping_per_s = largest(&mass, &damping).unwrap();
        Rates { damping_per_s, mass, damping, learning: Some(Learning { p, kmk }) }
    }

    /// The largest multiplier of `held` for these.
    fn radius(rates: &Rates, hold: Hold, period_s: f64) -> f64 {
        let factor = rates.mass.clone().cholesky().unwrap();
        let learning = factor.solve(&rates.learning.as_ref().unwrap().p);
        hold.radius(period_s, &factor.solve(&rates.damping), &learning).unwrap()
    }

    fn any_hold(late: f64, cut_off: f64, period_s: f64) -> Hold {
        let cut_off_rad_s = (cut_off < 1e3).then_some(cut_off / period_s);
        Hold { delay_s: late * period_s, cut_off_rad_s }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn prop_of_one_axis_no_mode_grows_below_the_margin_while_y_stays(
            late in prop_oneof![Just(0.0), Just(0.25), Just(0.5), Just(1.0), 0.0..1.0_f64],
            cut_off in prop_oneof![Just(1e9), 0.02..20.0_f64], share in 1e-3..1.0_f64, m in 0.1..10.0_f64, h in 1e-3..1.0_f64,
        ) {
            let hold = any_hold(late, cut_off, h);
            let k = share * hold.largest_gain(h) * m / h;
            let p = (1.0 - share) * k / (h * (0.5 + hold.lag(h)));
            let one = |x: f64| DMatrix::from_element(1, 1, x);
            let at = |sigma: f64| rates_of(one(m), one(sigma * k), one(sigma * sigma * p));
            prop_assert!((at(1.0).sigma(hold, h) - 1.0).abs() < 1e-9 && (at(0.975).sigma(hold, h) - 0.975).abs() < 1e-9);
            let below = at(0.975);
            prop_assert!(radius(&below, hold, h) < 1.0 + ROUNDING && !below.grows(hold, h), "{}", radius(&below, hold, h));
        }
    }

    /// A mode that is slow against the period grows exactly where ℓ h P is more than K.
    #[test]
    fn eq_what_is_learnt_late_is_taken_from_the_damping() {
        let h = 0.01;
        for (late, cut_off) in [(0.25, 1e9), (1.0, 1e9), (0.0, 0.3), (0.0, 5.0), (0.7, 0.3), (0.5, 3.0)] {
            let (hold, p) = (any_hold(late, cut_off, h), 1e-2);
            let one = |x: f64| DMatrix::from_element(1, 1, x);
            let grows = |share: f64| rates_of(one(1.0), one(share * hold.lag(h) * h * p), one(p)).grows(hold, h);
            let radius = |share: f64| radius(&rates_of(one(1.0), one(share * hold.lag(h) * h * p), one(p)), hold, h);
            assert!(radius(0.99) > 1.0 && radius(1.01) < 1.0, "{late}, {cut_off}: {} {}", radius(0.99), radius(1.01));
            assert!(!grows(1.01));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn prop_one_sample_changes_the_lyapunov_function_by_no_more_than_the_margin_says(
            m in 1_usize..6, p in 1_usize..9, h in 1e-4..2.0_f64,
            numbers in proptest::collection::vec(-1.5..1.5_f64, 97),
        ) {
            let mass = definite(m, &numbers[..41], 0.05);
            let damping = definite(m, &numbers[41..68], 0.02);
            let gamma = definite(p, &numbers[5..90], 0.02);
            let y = DMatrix::from_fn(m, p, |i, j| numbers[(11 * i + 7 * j + 3) % 97]);
            let s = DVector::from_fn(m, |i, _| numbers[(13 * i + 1) % 97]);
            let error = DVector::from_fn(p, |i, _| numbers[(17 * i + 2) % 97]);
            let kmk = &damping * mass.clone().cholesky().unwrap().solve(&damping);
            let learning = &y * &gamma * y.transpose();
            let bound = |next: &DVector<f64>| {
                -0.5 * h * next.dot(&((2.0 * &damping - h * (&kmk + &learning)) * next))
            };
            let (gain, next) = gained([&mass, &damping, &gamma, &y], h, &s, &error).unwrap();
            let size = 1.0 + gain.abs() + bound(&next).abs();
            prop_assert!(gain <= bound(&next) + 1e-9 * size, "{} {}", gain, bound(&next));

            // It is attained where δ = h M⁻¹ K s⁺: pick s⁺ = s, and the error that leads there from s⁺ − δ, if Y can.
            let wide = DMatrix::from_fn(m, m, |i, j| f64::from(u8::from(i == j)) + 0.1 * numbers[(5 * i + j) % 97]);
            let gamma = definite(m, &numbers[30..], 0.1);
            let delta = h * mass.clone().cholesky().unwrap().solve(&(&damping * &s));
            let before = &s - &delta;
            let force = &mass * &delta / h + &damping * &before;
            if let Some(error) = wide.clone().lu().solve(&force) {
                let (gain, next) = gained([&mass, &damping, &gamma, &wide], h, &before, &error).unwrap();
                let learning = &wide * &gamma * wide.transpose();
                let bound = -0.5 * h * next.dot(&((2.0 * &damping - h * (&kmk + learning)) * &next));
                let size = 1.0 + gain.abs() + bound.abs() + error.dot(&gamma.clone().cholesky().unwrap().solve(&error));
                prop_assert!((gain - bound).abs() < 1e-7 * size, "{} {}", gain, bound);
            }

            // σ = 1 is where the bound stops to fall in the worst direction.
            let dynamics = DynamicsAt {
                mass: mass.transpose().as_slice().to_vec(),
                regressor: y.transpose().as_slice().to_vec(),
                adaptation_scale: Vec::new(),
            };
            let rates = Gains { damping: damping.clone(), adaptation: Some(definite(p, &numbers[5..90], 0.02)) };
            let rates = rates.rates(&dynamics).unwrap();
            let edge = 1.0 / rates.sigma(Hold::IDEAL, 1.0);
            let least = (2.0 * &damping - edge * (&kmk + &y * definite(p, &numbers[5..90], 0.02) * y.transpose()))
                .symmetric_eigenvalues()
                .min();
            prop_assert!(least.abs() < 1e-8 * (1.0 + damping.norm()), "{}", least);
            prop_assert!(2.0 * rates.sigma(Hold::IDEAL, 1.0) >= rates.damping_per_s * (1.0 - 1e-9));
        }
    }
}
