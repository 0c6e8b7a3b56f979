//! Agents under digital control as a whole: plant and controller, the reference, what neighbours tell, filters and delays of commands.
//!
//! Not from the paper, derived for this software. σ speaks of s under K and Γ alone. But the reference goes by the q̇ that was measured a
//! sample ago, or that a filter gives, and it is that which a slow sample or a slow filter breaks first where roots are fast; and for other laws than (6)–(7)
//! there is no σ. One period takes small deviations of an agent, and of the mean m̄ of what it hears, to
//!
//! ```text
//! x⁺ = J x + B₁ m̄ + B₂ m̄⁺        m = C x, what it tells
//! ```
//!
//! by differences of the run itself ([`forwardstep_sim::sampled_loop`]), with its largest Σ_j w_ij. Let r be the largest rate ln|μ|/h of
//! the multipliers μ.
//!
//! - **In its network**, where that is fixed and so are its delays, m̄ is a sum of what others told κ samples before: all modes of all
//!   agents, where these are few; where they are many, alike, and hear each other at once, m̄ = ε m with the eigenvalues ε of D⁻¹W.
//! - **By itself** elsewhere, m̄ = 0: neighbours stay where they are. A target has none.
//! - **In any fixed network** of such agents with late links: let G(μ) = C (μ − J)⁻¹ (B₁ + μ B₂). While the spectral radius of G is at most one on
//!   |μ| = 1, and J decays, every mode that passes on means of what is heard decays or stays, since a late link multiplies by
//!   μ^(−k), which is smaller still outside the circle. G(1) = 1: agreement.
//!
//! Sampled sixteen times as fast, with measured velocities and commands that act at once, the same agent has a rate and a radius of
//! its own: what is no worse than that is no matter of sampling. A mode that overshoots from sample to sample, Re μ < 0, as 1 − h λ does for h λ > 1, or
//! that decays half as fast as it would, is near to one that grows.
//!
//! All of it is local. It is looked at where a run starts, and where its references lead, with s ≡ 0: what lasts is there. Consensus
//! comes to rest, and its last state counts; along the motion of a target it is the mean of r, an estimate as for any loop that changes
//! with time. Agents under other laws are looked at again after some periods by themselves. A loop that is bad at the start alone is left
//! before it has grown. Estimates are right, and where they move, the last state is looked at again with those that may be reached: at
//! their upper bounds, or without bounds as they start. A loop that grows there may do so after it has drifted. Agents with friction are
//! left out, since its slope at rest is that of no motion.

mod linear;
mod network;
mod place;

use forwardstep_sim::{Adaptive, AgentSetup, Setup};

use self::linear::Linear;
use self::network::degree;
use self::place::{NOISE, Place};
use super::PracticalAnswer;
use super::led::{Led, way};
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;
use crate::surroundings::smoothed_friction;

pub use self::place::{LoopAt, LoopRate};

/// How much larger G may be than that of the ideal loop.
const PART: f64 = 0.02;
/// Agents that are looked at, spread evenly: while they have no more states together, between these numbers.
const MOST_STATES: usize = 200;
const AGENTS: [usize; 2] = [3, 16];
/// Factor from one period to the next while one is looked for at which a mode grows, and how many are looked at.
const SCAN: (f64, u32) = (1.25, 48);
/// The period is found to this part.
const TOLERANCE: f64 = 1e-4;
/// Where agents are looked at beside their start.
struct Later {
    /// Those under (6)–(7) after this part of the time.
    part: f64,
    /// Those under other laws after so many periods.
    periods: u32,
}
const LATER: [Later; 4] = [
    Later { part: 0.25, periods: 64 },
    Later { part: 0.5, periods: 128 },
    Later { part: 0.75, periods: 256 },
    Later { part: 1.0, periods: 512 },
];

/// The loops of agents as a whole, at the start and on their way.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLoop {
    /// h, s.
    pub period_s: f64,
    /// At the start.
    pub start: LoopAt,
    /// Where references lead, evenly spread over the time, or later; empty where that is not known.
    pub led: Vec<LoopAt>,
    /// At the last of these states, with estimates that are wrong; nothing where none move.
    pub astray: Option<LoopAt>,
    /// Who has run away by itself until one of these states, and when that is, s.
    pub lost: Option<(Named, f64)>,
    /// Agents that were looked at.
    pub agents: usize,
    /// Agents without friction.
    pub of: usize,
    /// The end of the run, s.
    end_s: f64,
}

impl WholeLoop {
    /// Of the agents of a setup; `None` when control is continuous, or nothing finite is found.
    pub fn of(setup: &Setup) -> Option<WholeLoop> {
        setup.control.as_ref()?;
        WholeLoop::on(setup, &way(setup))
    }

    /// The same with states on the way of agents under (6)–(7).
    pub(super) fn on(setup: &Setup, way: &[Led]) -> Option<WholeLoop> {
        let (period_s, end_s) = (1.0 / setup.control.as_ref()?.sample_hz, setup.time.end_s);
        let known = known(setup);
        let all: Vec<usize> = (0..setup.agents.len()).filter(|agent| is_smooth(&setup.agents[*agent])).collect();
        let of = all.len();
        let first = *all.first()?;
        let states = Linear::of(&known, first, degree(&known, first), 0).map_or(MOST_STATES, |linear| linear.size());
        let [least, most] = AGENTS;
        let count = (MOST_STATES / states.max(1)).clamp(least, most);
        let others = all.iter().any(|agent| !is_lagrangian(&setup.agents[*agent]));
        let looked: Vec<usize> = all.into_iter().step_by(of.div_ceil(count).max(1)).collect();
        let (start, _) = Place::new(known.clone(), 0.0, 0)?.look(&looked);
        let at = |setup: &Setup, Later { part, periods }: &Later| match on_the_way(setup, way, *part) {
            Some((t_s, there)) => Place::new(there, t_s, *periods),
            None if others => Place::new(setup.clone(), f64::from(*periods) * period_s, *periods),
            None => None,
        };
        // Consensus comes to rest.
        let is_led = setup.following().is_some() || looked.iter().any(|agent| setup.tracks(*agent));
        let [.., last] = &LATER;
        let places = if is_led || way.is_empty() { &LATER[..] } else { core::slice::from_ref(last) };
        let (mut led, mut lost) = (Vec::new(), None);
        for place in places.iter().filter_map(|later| at(&known, later)) {
            let (found, gone) = place.look(&looked);
            led.extend(found);
            lost = lost.or(gone.map(|agent| (Named::of(setup, agent), place.t_s)));
        }
        let astray = astray(setup).and_then(|wrong| at(&wrong, last).or_else(|| Place::new(wrong, 0.0, 0)));
        let astray = astray.and_then(|place| place.look(&looked).0);
        Some(WholeLoop { period_s, start: start?, led, astray, lost, agents: looked.len(), of, end_s })
    }

    /// The period near `near_s` from which on a mode of `setup` grows in the long run, s, where `sampled` samples it with a period: the end of the
    /// interval of periods without such a mode that holds `near_s`, or of the next one below it. Infinity where none was found; `None`
    /// where there is nothing to linearise, or a mode grows however short periods are.
    pub fn longest_period_s(near_s: f64, sampled: impl Fn(f64) -> Setup) -> Option<f64> {
        // Where nothing finite is found no mode decays.
        let decays = |period_s: f64| {
            WholeLoop::of(&sampled(period_s)).is_some_and(|it| it.lost.is_none() && it.lasting_per_s().is_none())
        };
        let (step, most) = SCAN;
        let (mut low, mut high, mut left) = (near_s, near_s, most);
        while !decays(low) {
            left = left.checked_sub(1)?;
            (high, low) = (low, low / step);
        }
        while low == high {
            let longer = high * step;
            match left.checked_sub(1) {
                None => return Some(f64::INFINITY),
                Some(fewer) => left = fewer,
            }
            if decays(longer) { (low, high) = (longer, longer) } else { high = longer }
        }
        while high > (1.0 + TOLERANCE) * low {
            let middle = 0.5 * (low + high);
            if decays(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }

    /// Inadequate where a mode grows in the long run or an agent runs away by itself, marginal where it does so at the start, with wrong estimates, or too slowly to be
    /// seen, or where one overshoots or is slowed; not shown where one may grow in some network.
    pub fn answer(&self) -> PracticalAnswer {
        if self.lost.is_some() {
            return PracticalAnswer::Inadequate;
        }
        let lasting = self.lasting_per_s();
        let is_slower = || self.start.overshoot().is_some() || self.start.slowed_per_s().is_some();
        match lasting {
            Some(rate) if rate * self.end_s > 1.0 => PracticalAnswer::Inadequate,
            _ if self.amplified().is_some() => PracticalAnswer::NotShown,
            None if self.start_per_s().or(self.astray_per_s()).is_none() && !is_slower() => PracticalAnswer::Adequate,
            _ => PracticalAnswer::Marginal,
        }
    }

    /// How fast the worst mode grows by sampling in the long run, 1/s, if it does.
    pub fn lasting_per_s(&self) -> Option<f64> {
        match &self.led[..] {
            [] => self.growth(core::slice::from_ref(&self.start)),
            led => self.growth(led),
        }
    }

    /// The same at the start.
    pub fn start_per_s(&self) -> Option<f64> {
        self.growth(core::slice::from_ref(&self.start))
    }

    /// The same with estimates that are wrong.
    pub fn astray_per_s(&self) -> Option<f64> {
        self.growth(self.astray.as_slice())
    }

    /// The mean, where it is more than rounding.
    fn growth(&self, at: &[LoopAt]) -> Option<f64> {
        let rate = at.iter().map(|at| at.rate().added_per_s()).sum::<f64>() / at.len() as f64;
        (rate * self.period_s > NOISE).then_some(rate)
    }

    /// The last state that was looked at.
    pub fn last(&self) -> &LoopAt {
        self.led.last().unwrap_or(&self.start)
    }

    /// How much of what is heard is passed on at the last state, where that is more than all of it and more than in the ideal loop.
    pub fn amplified(&self) -> Option<f64> {
        let is_more = |[part, ideal]: &[f64; 2]| *part > (1.0 + PART) * ideal.max(1.0);
        self.last().passed_on.filter(is_more).map(|[part, _]| part)
    }
}

/// Without friction, whose slope at rest says nothing of a motion.
fn is_smooth(agent: &AgentSetup) -> bool {
    smoothed_friction(agent, &agent.start.dq).is_none()
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

/// The same with estimates that may be reached, where some move.
fn astray(setup: &Setup) -> Option<Setup> {
    let (mut setup, mut moves) = (setup.clone(), false);
    for agent in &mut setup.agents {
        moves |= agent.change_law(|law: &mut Adaptive| {
            if let Some(bounds) = &law.bounds {
                law.estimate_start.clone_from(&bounds.upper);
            }
        });
    }
    moves.then_some(setup)
}

/// The setup as it would start where the way of its agents is after this part of the time, and when that is, s.
fn on_the_way(setup: &Setup, way: &[Led], part: f64) -> Option<(f64, Setup)> {
    let (mut there, mut when) = (setup.clone(), None);
    for own in way.chunk_by(|a, b| a.agent == b.agent) {
        let led = &own[(part * (own.len() - 1) as f64) as usize];
        let agent = &mut there.agents[led.agent];
        (agent.start.q, agent.start.dq) = (led.q.clone(), led.dq.clone());
        // Left out, z is q̇ and what follows is zero, as at rest.
        let moves = setup.tracks(led.agent) && agent.roots_per_s.len() > 1;
        agent.start.reference = if moves { vec![led.dq.clone(), led.dz.clone()] } else { Vec::new() };
        when = Some(led.t_s);
    }
    Some((when?, there))
}
