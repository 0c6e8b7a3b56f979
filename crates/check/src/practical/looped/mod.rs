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
//! Sampled sixteen times as fast, or as much faster as it takes until a rate changes no more, with measured velocities and commands that
//! act at once, the same agent has a rate and a radius of its own: what is no worse than that is no matter of sampling. A mode that
//! overshoots from sample to sample, Re μ < 0, as 1 − h λ does for h λ > 1, or that decays half as fast as it would, is near to one that
//! grows.
//!
//! All of it is local. It is looked at where a run starts, and where its references lead, with s ≡ 0: what lasts is there. Consensus comes
//! to rest, and its last state counts, of agents under other laws after some periods by themselves; along the motion of a target or a
//! leader deviations are followed as far as little work leads (`way`). A trial of all together (`trial`) sees what no linear map does. In a network that changes every agent is taken with its largest weights;
//! what grows then is not shown to, nor is what would have been seen in the time of a trial. A loop that is bad at
//! the start alone is left before it has grown. Estimates are right, of laws that say what they estimate, and where they move, the last
//! state is looked at again with those that may be reached: at their upper bounds, or without bounds as they start. A loop that grows
//! there may do so after it has drifted, unless the ideal one does too, which adaptation keeps from it. All of it but the trial is without
//! friction.

mod linear;
mod network;
mod place;
mod trial;
mod way;

use forwardstep_sim::{AgentSetup, Periods, Setup, check_setup};

use self::linear::Linear;
pub(super) use self::network::degree;
use self::place::{NOISE, Place};
use super::PracticalAnswer;
use super::led::{Led, Pace, way};
use crate::kinds::is_lagrangian;

pub use self::place::{LoopAt, LoopRate};
pub use self::trial::Trial;
pub use self::way::LoopAlong;

/// How much larger G may be than that of the ideal loop.
const PART: f64 = 0.02;
/// Agents that are looked at, spread evenly: while they have no more states together, between these numbers.
const MOST_STATES: usize = 200;
const AGENTS: [usize; 2] = [3, 16];
/// Factor from one period to the next while one is looked for at which a mode grows, and how many are looked at.
const SCAN: (f64, u32) = (1.25, 48);
/// The period is found to this part.
const TOLERANCE: f64 = 1e-4;
/// The logarithm by which rounding grows beyond everything.
const SEEN: f64 = 60.0;
/// A friction that is none, in N m or N: it has to be positive.
const NO_FRICTION: f64 = 1e-12;
/// When agents under other laws than (6)–(7) are looked at that are not led, in periods.
const LATER: u32 = 512;

/// The loops of agents as a whole, at the start and on their way.
#[derive(Clone, Debug, PartialEq)]
pub struct WholeLoop {
    /// h, s.
    pub period_s: f64,
    /// At the start.
    pub start: LoopAt,
    /// Where references lead those that come to rest, or later; nothing where that is not known.
    pub last: Option<Box<LoopAt>>,
    /// Along the motion of those that are led by a target or a leader.
    pub along: Option<LoopAlong>,
    /// At the last state that is known, with estimates that are wrong; nothing where none move.
    pub astray: Option<Box<LoopAt>>,
    /// What a trial of all agents tells.
    pub trial: Trial,
    /// Whether what is heard by those that were looked at is not always weighed as much, as it is taken where no network is.
    pub changes: bool,
    /// Agents that were looked at.
    pub agents: usize,
    /// All there are.
    pub of: usize,
    /// Whether any adapts.
    pub adapts: bool,
    /// The end of the run, s.
    end_s: f64,
}

impl WholeLoop {
    /// Of the agents of a setup; `None` when control is continuous, or nothing finite is found. Without the trial but where
    /// some adapt under other laws than (6)–(7), or along targets of their own.
    pub fn of(setup: &Setup) -> Option<WholeLoop> {
        setup.control.as_ref()?;
        check_setup(setup).ok()?;
        let along_targets = |index: usize, agent| !is_lagrangian(agent) || setup.tracks(index);
        let mut agents = setup.agents.iter().enumerate();
        let adapts = agents.any(|(index, agent)| agent.estimates() && along_targets(index, agent));
        WholeLoop::found(setup, &way(setup, Pace::Even), adapts)
    }

    /// The same with states on the way of agents under (6)–(7).
    pub(super) fn on(setup: &Setup, way: &[Led]) -> Option<WholeLoop> {
        WholeLoop::found(setup, way, true)
    }

    fn found(setup: &Setup, way: &[Led], is_tried: bool) -> Option<WholeLoop> {
        let (period_s, end_s) = (1.0 / setup.control.as_ref()?.sample_hz, setup.time.end_s);
        let smooth = rubbed_by_nothing(setup);
        let (known, of) = (known(&smooth), setup.agents.len());
        let states = Linear::of(&known, 0, degree(&known, 0), Periods::FIRST);
        let states = states.map_or(MOST_STATES, |linear| linear.size());
        let [least, most] = AGENTS;
        let count = (MOST_STATES / states.max(1)).clamp(least, most);
        let others = setup.agents.iter().any(|agent| !is_lagrangian(agent));
        let looked: Vec<usize> = (0..of).step_by(of.div_ceil(count).max(1)).collect();
        let start = Place::new(known.clone(), 0.0, 0)?.look(&looked);
        let at_last = |setup: &Setup| match at_the_end(setup, way) {
            Some((t_s, there)) => Place::new(there, t_s, LATER),
            None if others => Place::new(setup.clone(), f64::from(LATER) * period_s, LATER),
            None => None,
        };
        let is_led = |agent: &usize| setup.following().is_some() || setup.tracks(*agent);
        let (led, free): (Vec<usize>, Vec<usize>) = looked.iter().partition(|agent| is_led(agent));
        let along = LoopAlong::of(&known, way, &led);
        let rests = if along.is_some() { &free } else { &looked };
        let last = if rests.is_empty() { None } else { at_last(&known).and_then(|place| place.look(rests)) };
        let astray = astray(&smooth).and_then(|wrong| at_last(&wrong).or_else(|| Place::new(wrong, 0.0, 0)));
        let astray = astray.and_then(|place| place.look(&looked));
        let trial = if is_tried { Trial::of(setup) } else { None }.unwrap_or_default();
        let changes = looked.iter().any(|agent| network::changes(setup, *agent));
        let adapts = moves(setup);
        Some(WholeLoop {
            period_s,
            start: start?,
            last: last.map(Box::new),
            along,
            astray: astray.map(Box::new),
            trial,
            changes,
            agents: looked.len(),
            of,
            adapts,
            end_s,
        })
    }

    /// The period near `near_s` from which on a mode of `setup` grows within its run, s, where `sampled` samples it with a period: the end of the
    /// interval of periods without such a mode that holds `near_s`, or of the next one below it. Infinity where none was found; `None`
    /// where there is nothing to linearise, or a mode grows however short periods are.
    pub fn longest_period_s(near_s: f64, sampled: impl Fn(f64) -> Setup) -> Option<f64> {
        // Where nothing finite is found no mode decays.
        let decays = |period_s: f64| {
            WholeLoop::of(&sampled(period_s)).is_some_and(|it| it.trial.lost_s.is_none() && it.seen_per_s().is_none())
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

    /// Inadequate where a mode grows in the long run or a trial runs away, marginal where it does so at the start, with wrong estimates, or
    /// too slowly to be seen, or where one overshoots or is slowed; not shown where one may grow in some network, would if the largest
    /// weights stayed, or would have been seen to in the trial.
    pub fn answer(&self) -> PracticalAnswer {
        if self.trial.lost_s.is_some() {
            return PracticalAnswer::Inadequate;
        }
        let is_slower = || self.start.overshoot().is_some() || self.start.slowed_per_s().is_some();
        match (self.seen_per_s(), self.lasting_per_s()) {
            (Some(rate), _) => match self.changes || self.is_contradicted(rate) {
                true => PracticalAnswer::NotShown,
                false => PracticalAnswer::Inadequate,
            },
            _ if self.amplified().is_some() => PracticalAnswer::NotShown,
            (None, None) if self.start_per_s().or(self.astray_per_s()).is_none() && !is_slower() => {
                PracticalAnswer::Adequate
            }
            _ => PracticalAnswer::Marginal,
        }
    }

    /// Whether nothing in it grows, fast or slowly, as it begins or further on.
    pub(super) fn decays(&self) -> bool {
        let grows = self.lasting_per_s().or(self.start_per_s()).or(self.astray_per_s());
        self.answer() <= PracticalAnswer::Marginal && grows.is_none()
    }

    /// Whether what grows so fast would have been seen in the trial, from whatever it begins with. What is linearised along all of a motion grows with it, though
    /// it need not run away, unless estimates are elsewhere than where it was linearised.
    pub(super) fn is_contradicted(&self, rate_per_s: f64) -> bool {
        let is_known =
            self.along.as_ref().is_some_and(|along| along.is_gapless && along.grows_per_s() >= Some(rate_per_s));
        rate_per_s * self.trial.lasted_s > SEEN && (self.adapts || !is_known)
    }

    /// How fast the worst mode grows by sampling in the long run, 1/s, if it does.
    pub fn lasting_per_s(&self) -> Option<f64> {
        let along = self.along.as_ref().and_then(LoopAlong::grows_per_s);
        let last = match (&self.last, &self.along) {
            (None, Some(_)) => None,
            (last, _) => self.growth(last.as_deref().unwrap_or(&self.start)),
        };
        along.into_iter().chain(last).reduce(f64::max)
    }

    /// The same where it grows e-fold within the run: more slowly it is not seen.
    fn seen_per_s(&self) -> Option<f64> {
        self.lasting_per_s().filter(|rate| rate * self.end_s > 1.0)
    }

    /// The same at the start.
    pub fn start_per_s(&self) -> Option<f64> {
        self.growth(&self.start)
    }

    /// The same with estimates that are wrong, unless a mode grows with them in the ideal loop, where adaptation moves them before it has.
    pub fn astray_per_s(&self) -> Option<f64> {
        let astray =
            self.astray.as_ref().filter(|at| at.rate().ideal_per_s.is_none_or(|ideal| ideal * self.period_s <= NOISE));
        astray.and_then(|at| self.growth(at))
    }

    /// Where it is more than rounding.
    fn growth(&self, at: &LoopAt) -> Option<f64> {
        Some(at.rate().added_per_s()).filter(|rate| rate * self.period_s > NOISE)
    }

    /// The last state that was looked at.
    pub fn last(&self) -> &LoopAt {
        self.last.as_deref().unwrap_or(&self.start)
    }

    /// How much of what is heard is passed on at the last state, where that is more than all of it and more than in the ideal loop.
    pub fn amplified(&self) -> Option<f64> {
        let is_more = |[part, ideal]: &[f64; 2]| *part > (1.0 + PART) * ideal.max(1.0);
        self.last().passed_on.filter(is_more).map(|[part, _]| part)
    }
}

/// The same without friction, whose slope at rest is that of no motion, and which holds back what grows only while it is small.
fn rubbed_by_nothing(setup: &Setup) -> Setup {
    let mut setup = setup.clone();
    for agent in &mut setup.agents {
        let drives = agent.robot.interface().drives;
        let those = drives.ranges_in(agent.robot.theta.len()).map(|[.., frictions]| frictions);
        let forces = those.filter(|_| !drives.friction.is_empty()).and_then(|those| agent.robot.theta.get_mut(those));
        forces.into_iter().flatten().for_each(|force| *force = NO_FRICTION);
    }
    setup
}

/// Whether any estimates move.
fn moves(setup: &Setup) -> bool {
    setup.agents.iter().any(AgentSetup::estimates)
}

/// The same with estimates that are right.
fn known(setup: &Setup) -> Setup {
    let mut known = setup.clone();
    for agent in &mut known.agents {
        let law = agent.law.with_estimate(&agent.robot.theta, &agent.robot);
        agent.law = law.unwrap_or_else(|| agent.law.clone());
    }
    known
}

/// The same with estimates that may be reached, where some move.
fn astray(setup: &Setup) -> Option<Setup> {
    let (mut setup, mut moves) = (setup.clone(), false);
    for agent in &mut setup.agents {
        moves |= agent.estimates();
        let law = agent.law.kept_within().and_then(|bounds| agent.law.with_estimate(&bounds.upper, &agent.robot));
        agent.law = law.unwrap_or_else(|| agent.law.clone());
    }
    moves.then_some(setup)
}

/// The setup as it would start where the way of its agents ends, and when that is, s.
fn at_the_end(setup: &Setup, way: &[Led]) -> Option<(f64, Setup)> {
    let ends = way.chunk_by(|a, b| a.agent == b.agent).filter_map(<[Led]>::last);
    ends.fold(None, |there: Option<(f64, Setup)>, led| {
        Some((led.t_s, led.put_into(there.as_ref().map_or(setup, |(_, there)| there))))
    })
}
