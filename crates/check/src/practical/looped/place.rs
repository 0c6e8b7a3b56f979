//! The loops of agents at one state, as they are deployed and as the ideal loop has them.

use std::collections::BTreeMap;

use forwardstep_sim::{Control, Periods, Setup, VelocitySensor};
use nalgebra::Complex;

use super::linear::{Linear, fastest};
use super::network::{self, degree};
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;

/// How much faster what is compared with is sampled.
pub(super) const FASTER: u32 = 16;
/// How much faster yet, while a mode grows in it too: it is no ideal loop until that changes no more, by this part.
pub(super) const STILL_FASTER: [u32; 4] = [64, 256, 1024, 4096];
const SETTLED: f64 = 0.1;
/// How many periods pass for that at most, times numbers of state: what takes more is taken as it is.
const MOST_WORK: f64 = 6e5;
/// By how much differences miss a multiplier of one.
pub(super) const NOISE: f64 = 3e-5;
/// Smaller multipliers are zero: what is brought back to a manifold, and commands that are remembered.
const FORGOTTEN: f64 = 1e-6;
/// A mode that decays at less than this part of the rate that it has in the ideal loop is slowed.
const SLOWED: f64 = 0.5;

/// What the modes of a map say, or the map itself.
type Told<'a> = dyn Fn(&[Complex<f64>], &Linear) -> Option<f64> + 'a;

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
    pub(super) fn added_per_s(self) -> f64 {
        self.per_s - self.ideal_per_s.map_or(0.0, |ideal| ideal.max(0.0))
    }
}

/// A setup whose agents are looked at: at its start, or those under other laws than (6)–(7) so many periods `later`.
pub(super) struct Place {
    known: Setup,
    ideal: Setup,
    pub(super) t_s: f64,
    later: u32,
}

impl Place {
    /// Of a setup that samples.
    pub(super) fn new(known: Setup, t_s: f64, later: u32) -> Option<Place> {
        Some(Place { ideal: ideal(&known, FASTER)?, known, t_s, later })
    }

    fn sample_hz(&self) -> f64 {
        self.known.control.as_ref().map_or(0.0, |control| control.sample_hz)
    }

    /// One period of an agent as it is deployed.
    fn deployed(&self, agent: usize) -> Option<Linear> {
        self.linear(&self.known, agent, 1)
    }

    /// One period of the ideal loop, at the same time.
    fn ideal(&self, agent: usize) -> Option<Linear> {
        self.linear(&self.ideal, agent, FASTER)
    }

    /// A rate of the ideal loop, by that of a setup which samples so much faster, where one period as often as the deployed one takes this `work`;
    /// `None` where it changes for as long as that is looked at.
    fn settled(&self, work: f64, rate: impl Fn(&Setup, u32) -> Option<f64>) -> Option<f64> {
        let mut found = rate(&self.ideal, FASTER)?;
        let noise_per_s = f64::from(FASTER) * NOISE * self.sample_hz();
        for faster in STILL_FASTER {
            if found <= noise_per_s || work * f64::from(faster) > MOST_WORK {
                return Some(found);
            }
            let finer = rate(&ideal(&self.known, faster)?, faster)?;
            if (finer - found).abs() <= SETTLED * found {
                return Some(finer);
            }
            found = finer;
        }
        (found <= noise_per_s).then_some(found)
    }

    /// The periods of an agent that are looked at.
    fn periods(&self, agent: usize) -> Periods {
        if is_lagrangian(&self.known.agents[agent]) {
            return Periods { begin_s: self.t_s, ..Periods::FIRST };
        }
        Periods { after: self.later, ..Periods::FIRST }
    }

    fn linear(&self, setup: &Setup, agent: usize, faster: u32) -> Option<Linear> {
        let periods = self.periods(agent);
        let after = periods.after * faster;
        Linear::of(setup, agent, degree(setup, agent), Periods { after, ..periods })
    }

    /// How many periods pass to find what an agent of so many numbers of state does, times these.
    fn work(&self, agent: usize, size: usize) -> f64 {
        (f64::from(self.periods(agent).after) + 2.0 * size as f64) * size as f64
    }

    /// What is found at it of `agents`.
    pub(super) fn look(&self, agents: &[usize]) -> Option<LoopAt> {
        let own: BTreeMap<usize, Linear> =
            agents.iter().filter_map(|agent| Some((*agent, self.deployed(*agent)?))).collect();
        let noise_per_s = NOISE * self.sample_hz();
        let deployed = |agent: usize| own.get(&agent).cloned().or_else(|| self.deployed(agent));
        let all = own.iter().map(|(agent, own)| self.work(*agent, own.size())).sum();
        let network = network::rate(&self.known, deployed).map(|per_s| {
            let ideal = |setup: &Setup, faster: u32| network::rate(setup, |agent| self.linear(setup, agent, faster));
            LoopRate { per_s, ideal_per_s: if per_s > noise_per_s { self.settled(all, ideal) } else { None } }
        });
        let mut found: Option<LoopAt> = None;
        for (&agent, own) in &own {
            let Some(modes) = own.multipliers() else { continue };
            let per_s = fastest(&modes, own.period_s);
            let is_asked = network.is_none() && degree(&self.known, agent) > 0.0;
            let is_other = !is_lagrangian(&self.known.agents[agent]);
            // Long after the start it takes long to find.
            let is_needed = self.later == 0 || !is_other || per_s > noise_per_s || is_asked;
            let ideal = if is_needed { self.ideal(agent) } else { None };
            let ideal = ideal.and_then(|linear| Some((linear.multipliers()?, linear)));
            // What the deployed loop and the ideal one have in common to compare.
            let pair = |of: &Told<'_>| {
                let (ideal_modes, ideal) = ideal.as_ref()?;
                Some([of(&modes, own)?, of(ideal_modes, ideal)?])
            };
            let least_per_s = 1.0 / self.known.time.end_s;
            let grows = |setup: &Setup, faster: u32| {
                let linear = self.linear(setup, agent, faster)?;
                Some(fastest(&linear.multipliers()?, linear.period_s))
            };
            let work = self.work(agent, own.size());
            let ideal_per_s = if per_s > noise_per_s { self.settled(work, grows) } else { None };
            let alone = LoopRate { per_s, ideal_per_s };
            let passed_on = if is_asked { pair(&|_, linear| Some(linear.passed_on())) } else { None };
            let leftmost = if is_other { pair(&|modes, _| Some(leftmost(modes))) } else { None };
            let decay_per_s = pair(&|modes, linear| slowest(modes, linear.period_s, least_per_s));
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
        found
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

/// The same with measured velocities, commands that act at once, and samples that are fast.
pub(super) fn ideal(setup: &Setup, faster: u32) -> Option<Setup> {
    let control = setup.control.as_ref()?;
    let mut sensors = control.sensors;
    sensors.velocity = VelocitySensor::Measured;
    let sample_hz = f64::from(faster) * control.sample_hz;
    let control = Control { sample_hz, computation_delay_s: 0.0, sensors, ..control.clone() };
    Some(Setup { control: Some(control), ..setup.clone() })
}
