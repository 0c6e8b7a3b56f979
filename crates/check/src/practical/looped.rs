//! Agents under (6)–(7) with all that is around s: the reference, what neighbours tell, filters and delays of commands.
//!
//! Not from the paper, derived for this software. σ speaks of s under K and Γ alone. But the reference goes by the q̇ that was measured a
//! sample ago, or that a filter gives, and it is that which a slow sample or a slow filter breaks first where roots are fast. One period
//! takes small deviations of an agent, and of the mean m̄ of what it hears, to
//!
//! ```text
//! x⁺ = J x + B₁ m̄ + B₂ m̄⁺        m = C x, what it tells
//! ```
//!
//! by differences of the run itself ([`sampled_loop`]), with its largest Σ_j w_ij. Let r be the largest rate ln|μ|/h of the multipliers μ.
//!
//! - **By itself**, m̄ = 0: neighbours stay where they are. A target has none.
//! - **In its network**, where that is fixed, nothing is heard late, and all agents have the same J: m̄ = ε m with the eigenvalues ε of D⁻¹W
//!   gives all multipliers of all agents.
//! - **In any fixed network** of such agents with late links: let G(μ) = C (μ − J)⁻¹ (B₁ + μ B₂). While the spectral radius of G is at most one on
//!   |μ| = 1, and J decays, every mode that passes on means of what is heard decays or stays, since a late link multiplies by
//!   μ^(−k), which is smaller still outside the circle. G(1) = 1: agreement.
//!
//! Sampled sixteen times as fast, with measured velocities and commands that act at once, the same agent has a rate and a radius of
//! its own: what is no worse than that is no matter of sampling. All of it is local, at the start, with estimates that are right; agents with
//! friction are left out, since its slope at rest is that of no motion.

use forwardstep_sim::graph::Weight;
use forwardstep_sim::{Adaptive, AgentSetup, Control, SampledLoop, Setup, VelocitySensor, sampled_loop};
use nalgebra::{Complex, DMatrix};

use super::PracticalAnswer;
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;
use crate::prediction::roots::eigenvalues::eigenvalues;
use crate::surroundings::smoothed_friction;

/// Smaller multipliers are zero: commands that are remembered.
const FORGOTTEN: f64 = 1e-6;
/// How much faster what is compared with is sampled.
const FASTER: f64 = 16.0;
/// A rate counts that makes a mode e times as large within the run, and is no rounding of differences, 1/s.
const LEAST_RATE: f64 = 0.05;
/// How much larger G may be than that of the ideal loop.
const PART: f64 = 0.02;
/// Angles at which G is looked at, from the smallest on.
const ANGLES: (f64, u32) = (1e-3, 40);
/// Agents that are looked at, spread evenly, and the most states of an agent in a network.
const MOST_AGENTS: usize = 3;
const MOST_STATES: usize = 80;
/// Agents whose network has its modes worked out.
const MOST_IN_NETWORK: usize = 100;

/// The agent whose loop is worst.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLoop {
    /// The agent.
    pub agent: Named,
    /// h, s.
    pub period_s: f64,
    /// The largest rate by itself, 1/s, and of the ideal loop.
    pub rate_per_s: [f64; 2],
    /// The same of all modes of its network, where they can be told.
    pub network_rate_per_s: Option<[f64; 2]>,
    /// The largest spectral radius of G, and of the ideal loop; nothing where no agent is heard.
    pub passed_on: Option<[f64; 2]>,
    /// Agents that were looked at.
    pub agents: usize,
    /// Agents under (6)–(7) without friction.
    pub of: usize,
    /// The end of the run, s.
    end_s: f64,
}

impl WholeLoop {
    /// Of the agents of a setup under (6)–(7); `None` when control is continuous, there are none, or nothing finite is found.
    pub fn of(setup: &Setup) -> Option<WholeLoop> {
        let control = setup.control.as_ref()?;
        let (period_s, end_s) = (1.0 / control.sample_hz, setup.time.end_s);
        let known = &known(setup);
        let mut ideal = known.clone();
        let mut sensors = control.sensors;
        sensors.velocity = VelocitySensor::Measured;
        let sample_hz = FASTER * control.sample_hz;
        ideal.control = Some(Control { sample_hz, computation_delay_s: 0.0, sensors, ..control.clone() });
        let all: Vec<usize> = (0..setup.agents.len()).filter(|agent| is_smooth(&setup.agents[*agent])).collect();
        let of = all.len();
        let looked: Vec<usize> = all.iter().copied().step_by(of.div_ceil(MOST_AGENTS).max(1)).collect();
        let shares = shares(setup);
        let alike = shares.is_some() && is_alike(known, &all);
        let mut worst: Option<WholeLoop> = None;
        let mut agents = 0;
        for &agent in &looked {
            let degree = degree(setup, agent);
            let of_setup = |setup: &Setup| Linear::new(sampled_loop(setup, agent, degree).ok()??, setup);
            let Some((own, ideal)) = of_setup(known).zip(of_setup(&ideal)) else { continue };
            let pair = |of: &dyn Fn(&Linear) -> Option<f64>| Some([of(&own)?, of(&ideal)?]);
            let Some(rate_per_s) = pair(&|it| it.rate(None)) else { continue };
            let shares = shares.as_ref().filter(|_| alike && own.size() <= MOST_STATES);
            let modes = |it: &Linear| shares?.iter().map(|share| it.rate(Some(*share))).try_fold(f64::MIN, larger);
            let passed_on = if degree > 0.0 { pair(&|it| Some(it.passed_on())) } else { None };
            agents += 1;
            let agent = Named::of(setup, agent);
            let network_rate_per_s = pair(&modes);
            let found = WholeLoop { agent, period_s, rate_per_s, network_rate_per_s, passed_on, agents, of, end_s };
            if worst.as_ref().is_none_or(|worst| found.answer() > worst.answer()) {
                worst = Some(found);
            }
        }
        worst.map(|found| WholeLoop { agents, ..found })
    }

    /// Inadequate where a mode grows, not shown where one may in some network.
    pub fn answer(&self) -> PracticalAnswer {
        if self.growth_per_s().is_some() {
            PracticalAnswer::Inadequate
        } else if self.amplified().is_some() {
            PracticalAnswer::NotShown
        } else {
            PracticalAnswer::Adequate
        }
    }

    /// The rate of a mode that grows and would not in the ideal loop: of its network, or by itself.
    pub fn growth_per_s(&self) -> Option<f64> {
        let grows = |[rate, ideal]: &[f64; 2]| {
            let more = rate - ideal.max(0.0);
            more > LEAST_RATE && more * self.end_s > 1.0
        };
        [self.network_rate_per_s, Some(self.rate_per_s)].into_iter().flatten().find(grows).map(|[rate, _]| rate)
    }

    /// How much of what is heard is passed on, where that is more than all of it and more than in the ideal loop, and where the
    /// modes of the network do not tell that it is harmless.
    pub fn amplified(&self) -> Option<f64> {
        let is_more = |[part, ideal]: &[f64; 2]| *part > (1.0 + PART) * ideal.max(1.0);
        self.passed_on.filter(|_| self.network_rate_per_s.is_none()).filter(is_more).map(|[part, _]| part)
    }
}

fn larger(one: f64, other: Option<f64>) -> Option<f64> {
    Some(one.max(other?))
}

/// Under (6)–(7), without friction, whose slope at rest says nothing of a motion.
fn is_smooth(agent: &AgentSetup) -> bool {
    is_lagrangian(agent) && smoothed_friction(agent, &agent.start.dq).is_none()
}

/// The same with estimates that are right.
fn known(setup: &Setup) -> Setup {
    let mut known = setup.clone();
    for agent in &mut known.agents {
        let theta = agent.robot.theta.clone();
        agent.change_law(|law: &mut Adaptive| law.estimate_start = theta);
    }
    known
}

/// The largest Σ_j w_ij of an agent in any phase; zero where it follows a target or a leader, whose sign has no derivative.
fn degree(setup: &Setup, agent: usize) -> f64 {
    if setup.tracks(agent) || setup.following().is_some() {
        return 0.0;
    }
    let network = &setup.network;
    let weight = |weight: Weight| match weight {
        Weight::Constant(weight) => weight,
        Weight::Formula(index) => network.weights.get(index).map_or(0.0, |formula| formula.within().high),
    };
    let of = |edges: &Vec<forwardstep_sim::graph::Edge>| -> f64 {
        edges.iter().filter(|edge| edge.to == agent).map(|edge| weight(edge.weight)).sum()
    };
    network.schedule.graphs.iter().map(of).fold(0.0, f64::max)
}

/// The eigenvalues of D⁻¹W where the graph and its weights are fixed, nothing is heard late, and everybody hears as much.
fn shares(setup: &Setup) -> Option<Vec<Complex<f64>>> {
    let (network, n) = (&setup.network, setup.agents.len());
    let edges = network.schedule.constant_graph()?;
    let late = |edge: &forwardstep_sim::graph::Edge| network.delays.get(edge.delay).is_some_and(|it| it.max_s() > 0.0);
    if n > MOST_IN_NETWORK || edges.iter().any(late) || (0..n).any(|agent| setup.tracks(agent)) {
        return None;
    }
    let degrees: Vec<f64> = (0..n).map(|agent| degree(setup, agent)).collect();
    if degrees.iter().any(|degree| *degree <= 0.0 || *degree != degrees[0]) {
        return None;
    }
    let mut mean = DMatrix::zeros(n, n);
    for edge in edges {
        mean[(edge.to, edge.from)] += edge.weight.constant()? / degrees[edge.to];
    }
    eigenvalues(&mean)
}

/// Whether one period is the same map for all.
fn is_alike(setup: &Setup, agents: &[usize]) -> bool {
    if agents.len() != setup.agents.len() {
        return false;
    }
    let of =
        |agent: usize| sampled_loop(setup, agent, degree(setup, agent)).ok().flatten().map(|found| found.own.entries);
    let Some(first) = of(0) else { return false };
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + a.abs());
    agents
        .iter()
        .skip(1)
        .all(|agent| of(*agent).is_some_and(|other| other.len() == first.len() && other.iter().zip(&first).all(near)))
}

/// The matrices of a period.
struct Linear {
    period_s: f64,
    own: DMatrix<f64>,
    tells: DMatrix<f64>,
    hears: [DMatrix<f64>; 2],
}

impl Linear {
    fn new(found: SampledLoop, setup: &Setup) -> Option<Linear> {
        let (n, m) = (found.own.size, found.message);
        let hears = found.hears.map(|entries| DMatrix::from_row_slice(n, m, &entries));
        let period_s = 1.0 / setup.control.as_ref()?.sample_hz;
        let own = DMatrix::from_row_slice(n, n, &found.own.entries);
        Some(Linear { period_s, own, tells: DMatrix::from_row_slice(m, n, &found.tells), hears })
    }

    fn size(&self) -> usize {
        self.own.nrows()
    }

    /// The largest ln|μ|/h by itself, or where m̄ is this share of m.
    fn rate(&self, share: Option<Complex<f64>>) -> Option<f64> {
        let n = self.size();
        // J is close to 1 when a period is short, and the QR algorithm then stalls on it, but not on what is left.
        let away = match share {
            None => &self.own - DMatrix::identity(n, n),
            Some(share) => {
                let [begin, end] = self.hears.each_ref().map(|hears| complex(&(hears * &self.tells)) * share);
                let one = DMatrix::<Complex<f64>>::identity(n, n);
                let period = (&one - end).lu().solve(&(complex(&self.own) + begin))? - one;
                in_reals(&period)
            }
        };
        let sizes = eigenvalues(&away)?.into_iter().map(|mu| (mu + 1.0).norm()).filter(|size| *size > FORGOTTEN);
        Some(libm::log(sizes.fold(0.0, f64::max)) / self.period_s)
    }

    /// The largest spectral radius of G on the unit circle.
    fn passed_on(&self) -> f64 {
        let n = self.size();
        let (own, tells) = (complex(&self.own), complex(&self.tells));
        let (first, count) = ANGLES;
        let step = libm::pow(core::f64::consts::PI / first, 1.0 / f64::from(count));
        let radius = |k: u32| {
            let mu = Complex::from_polar(1.0, first * libm::pow(step, f64::from(k)));
            let heard = complex(&self.hears[0]) + complex(&self.hears[1]) * mu;
            let state = (DMatrix::identity(n, n) * mu - &own).lu().solve(&heard)?;
            Some(eigenvalues(&in_reals(&(&tells * state)))?.into_iter().map(|it| it.norm()).fold(0.0, f64::max))
        };
        (0..=count).filter_map(radius).fold(0.0, f64::max)
    }
}

fn complex(matrix: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    matrix.map(|entry| Complex::new(entry, 0.0))
}

/// Of real and imaginary parts together: the eigenvalues of a matrix and their conjugates.
fn in_reals(matrix: &DMatrix<Complex<f64>>) -> DMatrix<f64> {
    let n = matrix.nrows();
    DMatrix::from_fn(2 * n, 2 * n, |k, l| {
        let entry = matrix[(k % n, l % n)];
        match (k < n, l < n) {
            (true, true) | (false, false) => entry.re,
            (true, false) => -entry.im,
            (false, true) => entry.im,
        }
    })
}
