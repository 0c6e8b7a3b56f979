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
//! with time. Agents under other laws are looked at again where they are after some periods by themselves. A loop that is bad at the start alone is left before it has grown. Estimates are right, and where they move, the last
//! state is looked at again with those that may be reached: at their upper bounds, or without bounds as they start. A loop that grows
//! there may do so after it has drifted. Agents with friction are left out, since its slope at rest is that of no motion.

mod linear;
mod network;

use forwardstep_sim::{Adaptive, AgentSetup, Control, Setup, VelocitySensor};
use nalgebra::Complex;

use self::linear::Linear;
use self::network::degree;
use super::PracticalAnswer;
use super::led::{Led, way};
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;
use crate::surroundings::smoothed_friction;

/// How much faster what is compared with is sampled.
const FASTER: f64 = 16.0;
/// By how much differences miss a multiplier of one.
const NOISE: f64 = 3e-5;
/// How much larger G may be than that of the ideal loop.
const PART: f64 = 0.02;
/// Agents that are looked at, spread evenly: while they have no more states together, between these numbers.
const MOST_STATES: usize = 200;
const AGENTS: [usize; 2] = [3, 16];
/// Periods after which an agent under another law is looked at again.
const LATER: [u32; 4] = [64, 128, 256, 512];
/// Smaller multipliers are zero: what is brought back to a manifold, and commands that are remembered.
const FORGOTTEN: f64 = 1e-6;
/// A mode that decays at less than this part of the rate that it has in the ideal loop is slowed.
const SLOWED: f64 = 0.5;
/// Factor from one period to the next while one is looked for at which a mode grows, and how many are looked at.
const SCAN: (f64, u32) = (1.25, 48);
/// The period is found to this part.
const TOLERANCE: f64 = 1e-4;
/// Where an agent is looked at along the motion of a target or of a leader, as parts of the time.
const ALONG: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

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
    /// Agents that were looked at.
    pub agents: usize,
    /// Agents without friction.
    pub of: usize,
    /// The end of the run, s.
    end_s: f64,
}

/// The loops at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopAt {
    /// When it is reached, s.
    pub t_s: f64,
    /// The agent whose rate by itself is largest.
    pub agent: Named,
    /// That rate.
    pub alone: LoopRate,
    /// The largest rate of all modes of the network, where they can be told.
    pub network: Option<LoopRate>,
    /// The largest spectral radius of G, and that of the ideal loop, where agents hear others and the network does not tell.
    pub passed_on: Option<[f64; 2]>,
    /// The smallest Re μ of an agent under another law than (6)–(7), by itself, and that of the ideal loop.
    pub leftmost: Option<[f64; 2]>,
    /// How fast the slowest mode that decays within the run does so, by itself, and in the ideal loop, 1/s, for the agent where it is most slowed.
    pub decay_per_s: Option<[f64; 2]>,
}

/// The largest ln|μ|/h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopRate {
    /// Of the loop as it is deployed, 1/s.
    pub per_s: f64,
    /// Of the ideal loop, 1/s, where the deployed one grows and this could be found.
    pub ideal_per_s: Option<f64>,
}

impl LoopRate {
    /// What sampling adds.
    fn added_per_s(self) -> f64 {
        self.per_s - self.ideal_per_s.map_or(0.0, |ideal| ideal.max(0.0))
    }
}

/// A setup whose agents are looked at: at its start, or those under other laws than (6)–(7) so many periods `later`.
struct Place {
    known: Setup,
    ideal: Setup,
    t_s: f64,
    later: u32,
}

impl Place {
    fn new(known: Setup, t_s: f64, later: u32) -> Option<Place> {
        Some(Place { ideal: ideal(&known)?, known, t_s, later })
    }

    /// One period of an agent as it is deployed.
    fn deployed(&self, agent: usize) -> Option<Linear> {
        self.linear(&self.known, agent, 1)
    }

    /// One period of the ideal loop, at the same time.
    fn ideal(&self, agent: usize) -> Option<Linear> {
        self.linear(&self.ideal, agent, FASTER as u32)
    }

    fn linear(&self, setup: &Setup, agent: usize, faster: u32) -> Option<Linear> {
        let later = if is_lagrangian(&setup.agents[agent]) { 0 } else { self.later * faster };
        Linear::of(setup, agent, degree(setup, agent), later)
    }

    /// What is found at it, and of how many of `agents`.
    fn look(&self, agents: &[usize]) -> Option<(LoopAt, usize)> {
        let noise_per_s = NOISE / period_s(&self.known)?;
        let network = network::rate(&self.known, |agent| self.deployed(agent)).map(|per_s| {
            let ideal = || network::rate(&self.ideal, |agent| self.ideal(agent));
            LoopRate { per_s, ideal_per_s: if per_s > noise_per_s { ideal() } else { None } }
        });
        let mut found: Option<LoopAt> = None;
        let mut looked = 0;
        for &agent in agents {
            let Some(own) = self.deployed(agent) else { continue };
            let Some((modes, per_s)) = own.multipliers().zip(own.rate()) else { continue };
            looked += 1;
            let is_asked = network.is_none() && degree(&self.known, agent) > 0.0;
            let is_other = !is_lagrangian(&self.known.agents[agent]);
            // Long after the start it takes long to find.
            let is_needed = self.later == 0 || !is_other || per_s > noise_per_s || is_asked;
            let ideal = if is_needed { self.ideal(agent) } else { None };
            let ideal_modes = ideal.as_ref().and_then(Linear::multipliers);
            let ideal_per_s = ideal.as_ref().and_then(Linear::rate).filter(|_| per_s > noise_per_s);
            let alone = LoopRate { per_s, ideal_per_s };
            let passed_on = ideal.as_ref().filter(|_| is_asked).map(|ideal| [own.passed_on(), ideal.passed_on()]);
            let leftmost = ideal_modes.as_ref().filter(|_| is_other).map(|ideal| [leftmost(&modes), leftmost(ideal)]);
            let least_per_s = 1.0 / self.known.time.end_s;
            let decay = |modes: &[Complex<f64>], linear: &Linear| slowest(modes, linear.period_s, least_per_s);
            let ideal_decay = ideal_modes.as_ref().zip(ideal.as_ref()).and_then(|(modes, ideal)| decay(modes, ideal));
            let decay_per_s = decay(&modes, &own).zip(ideal_decay).map(<[f64; 2]>::from);
            let one = LoopAt {
                t_s: self.t_s,
                agent: Named::of(&self.known, agent),
                alone,
                network,
                passed_on,
                leftmost,
                decay_per_s,
            };
            found = Some(match found {
                None => one,
                Some(worst) => worst.and(one),
            });
        }
        Some((found?, looked))
    }
}

/// The smallest Re μ of those that are not zero.
fn leftmost(multipliers: &[Complex<f64>]) -> f64 {
    multipliers.iter().filter(|mu| mu.norm() > FORGOTTEN).map(|mu| mu.re).fold(1.0, f64::min)
}

/// The smallest −ln|μ|/h of modes that decay at this rate at least.
fn slowest(multipliers: &[Complex<f64>], period_s: f64, least_per_s: f64) -> Option<f64> {
    let rates = multipliers.iter().map(|mu| -libm::log(mu.norm()) / period_s);
    rates.filter(|rate| *rate > least_per_s).reduce(f64::min)
}

impl LoopAt {
    /// That of its network, or of an agent by itself.
    pub fn rate(&self) -> LoopRate {
        self.network.unwrap_or(self.alone)
    }

    /// The worst of both in everything.
    fn and(self, other: LoopAt) -> LoopAt {
        let share = |pair: Option<[f64; 2]>| pair.map_or(f64::INFINITY, |[own, ideal]| own / ideal);
        let grows = other.alone.added_per_s() > self.alone.added_per_s();
        let is_left = other.leftmost.map(|[own, _]| -own) > self.leftmost.map(|[own, _]| -own);
        LoopAt {
            passed_on: if other.passed_on > self.passed_on { other.passed_on } else { self.passed_on },
            leftmost: if is_left { other.leftmost } else { self.leftmost },
            decay_per_s: if share(other.decay_per_s) < share(self.decay_per_s) {
                other.decay_per_s
            } else {
                self.decay_per_s
            },
            agent: if grows { other.agent } else { self.agent },
            alone: if grows { other.alone } else { self.alone },
            ..self
        }
    }

    /// The smallest Re μ where it is negative, and is not in the ideal loop.
    pub fn overshoot(&self) -> Option<f64> {
        self.leftmost.filter(|[own, ideal]| *own < 0.0 && *ideal >= 0.0).map(|[own, _]| own)
    }

    /// The rate of the slowest mode and that which it has in the ideal loop, where sampling slows it.
    pub fn slowed_per_s(&self) -> Option<[f64; 2]> {
        self.decay_per_s.filter(|[own, ideal]| *own < SLOWED * ideal)
    }
}

impl WholeLoop {
    /// Of the agents of a setup; `None` when control is continuous, or nothing finite is found.
    pub fn of(setup: &Setup) -> Option<WholeLoop> {
        setup.control.as_ref()?;
        WholeLoop::on(setup, &way(setup))
    }

    /// The same with states on the way of agents under (6)–(7).
    pub(super) fn on(setup: &Setup, way: &[Led]) -> Option<WholeLoop> {
        let (period_s, end_s) = (period_s(setup)?, setup.time.end_s);
        let known = known(setup);
        let all: Vec<usize> = (0..setup.agents.len()).filter(|agent| is_smooth(&setup.agents[*agent])).collect();
        let of = all.len();
        let first = *all.first()?;
        let states = Linear::of(&known, first, degree(&known, first), 0).map_or(MOST_STATES, |linear| linear.size());
        let [least, most] = AGENTS;
        let count = (MOST_STATES / states.max(1)).clamp(least, most);
        let others = all.iter().any(|agent| !is_lagrangian(&setup.agents[*agent]));
        let looked: Vec<usize> = all.into_iter().step_by(of.div_ceil(count).max(1)).collect();
        let (start, agents) = Place::new(known.clone(), 0.0, 0)?.look(&looked)?;
        // Consensus comes to rest.
        let is_led = setup.following().is_some() || looked.iter().any(|agent| setup.tracks(*agent));
        let parts = if is_led || way.is_empty() { &ALONG[..] } else { &ALONG[ALONG.len() - 1..] };
        let there = |setup: &Setup, place: usize| match on_the_way(setup, way, ALONG[place]) {
            Some((t_s, there)) => Some((t_s, there)),
            None if others => Some((f64::from(LATER[place]) * period_s, setup.clone())),
            None => None,
        };
        let at = |known: Setup, t_s: f64, place: usize| Some(Place::new(known, t_s, LATER[place])?.look(&looked)?.0);
        let places = ALONG.len() - parts.len()..ALONG.len();
        let led: Vec<LoopAt> = places
            .filter_map(|place| {
                let (t_s, there) = there(&known, place)?;
                at(there, t_s, place)
            })
            .collect();
        let last = ALONG.len() - 1;
        let (t_s, there) = there(setup, last).unwrap_or_else(|| (0.0, setup.clone()));
        let astray = astray(there).and_then(|there| at(there, t_s, last));
        Some(WholeLoop { period_s, start, led, astray, agents, of, end_s })
    }

    /// The period near `near_s` from which on a mode of `setup` grows in the long run, s, where `sampled` samples it with a period: the end of the
    /// interval of periods without such a mode that holds `near_s`, or of the next one below it. Infinity where none was found; `None`
    /// where there is nothing to linearise, or a mode grows however short periods are.
    pub fn longest_period_s(near_s: f64, sampled: impl Fn(f64) -> Setup) -> Option<f64> {
        // Where nothing finite is found no mode decays.
        let decays = |period_s: f64| WholeLoop::of(&sampled(period_s)).is_some_and(|it| it.lasting_per_s().is_none());
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

    /// Inadequate where a mode grows in the long run, marginal where it does so at the start, with wrong estimates, or too slowly to be
    /// seen, or where one overshoots or is slowed; not shown where one may grow in some network.
    pub fn answer(&self) -> PracticalAnswer {
        let growth = || self.lasting_per_s().or(self.start_per_s()).or(self.astray_per_s());
        match self.lasting_per_s() {
            Some(rate) if rate * self.end_s > 1.0 => PracticalAnswer::Inadequate,
            _ if self.amplified().is_some() => PracticalAnswer::NotShown,
            _ if growth().is_some() => PracticalAnswer::Marginal,
            _ if self.start.overshoot().is_some() || self.start.slowed_per_s().is_some() => PracticalAnswer::Marginal,
            _ => PracticalAnswer::Adequate,
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

fn period_s(setup: &Setup) -> Option<f64> {
    Some(1.0 / setup.control.as_ref()?.sample_hz)
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
fn astray(mut setup: Setup) -> Option<Setup> {
    let mut moves = false;
    for agent in &mut setup.agents {
        moves |= agent.change_law(|law: &mut Adaptive| {
            if let Some(bounds) = &law.bounds {
                law.estimate_start.clone_from(&bounds.upper);
            }
        });
    }
    moves.then_some(setup)
}

/// The same with measured velocities, commands that act at once, and samples that are fast.
fn ideal(setup: &Setup) -> Option<Setup> {
    let control = setup.control.as_ref()?;
    let mut sensors = control.sensors;
    sensors.velocity = VelocitySensor::Measured;
    let sample_hz = FASTER * control.sample_hz;
    let control = Control { sample_hz, computation_delay_s: 0.0, sensors, ..control.clone() };
    Some(Setup { control: Some(control), ..setup.clone() })
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
