//! Kinds outside (6)–(7) under digital control: the multipliers of one agent's period, linearised at its start.
//!
//! Not from the paper, derived for this software. Near a state at rest a period takes a small deviation ξ of plant and controller to J ξ,
//! and J is that of the run itself, by differences ([`sampled_jacobian`]). As h → 0 all its eigenvalues μ tend to 1: those near 1 are the
//! modes of the continuous design, slow as its reference dynamics are, and what they do is no matter of sampling. The others are fast.
//! A fast one outside the unit circle grows from sample to sample; one to the left of the imaginary axis overshoots from sample to
//! sample, as 1 − h λ does for h λ > 1, where the margin of (6)–(7) exceeds one half. All of it is local, and speaks of one agent by itself.

use forwardstep_sim::{Setup, sampled_jacobian};
use nalgebra::DMatrix;

use super::PracticalAnswer;
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;
use crate::prediction::roots::eigenvalues::eigenvalues;

/// Multipliers farther than this from 1 are fast.
const FAST: f64 = 0.1;
/// Smaller multipliers are zero: what is brought back to a manifold, and commands that are remembered.
const FORGOTTEN: f64 = 1e-6;
/// Agents that are looked at, spread evenly: all, while they have no more states together, and so many at least.
const MOST_STATES: usize = 4000;
const LEAST: usize = 16;

/// Factor from one period to the next while one is looked for at which a mode grows, and how many are looked at.
const SCAN: (f64, u32) = (1.25, 48);
/// The period is found to this part.
const TOLERANCE: f64 = 1e-4;

/// The multipliers of the agent for which sampling is worst.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearisedSampling {
    /// The agent.
    pub agent: Named,
    /// h, s.
    pub period_s: f64,
    /// The largest size of a fast multiplier; zero where none is fast.
    pub radius: f64,
    /// The smallest real part of those that are not zero.
    pub leftmost: f64,
    /// Agents that were looked at.
    pub agents: usize,
    /// Agents outside (6)–(7).
    pub of: usize,
}

impl LinearisedSampling {
    /// Of the agents of a setup outside (6)–(7); `None` when control is continuous, there are none, velocities are filtered differences,
    /// or nothing finite is found.
    pub fn of(setup: &Setup) -> Option<LinearisedSampling> {
        let period_s = 1.0 / setup.control.as_ref()?.sample_hz;
        let others: Vec<usize> =
            (0..setup.agents.len()).filter(|agent| !is_lagrangian(&setup.agents[*agent])).collect();
        let of = others.len();
        let states = sampled_jacobian(setup, *others.first()?).ok()?.map_or(1, |jacobian| jacobian.size);
        let stride = of.div_ceil((MOST_STATES / states.max(1)).max(LEAST)).max(1);
        let mut worst: Option<LinearisedSampling> = None;
        let mut agents = 0;
        for &agent in others.iter().step_by(stride) {
            let Some((radius, leftmost)) = multipliers(setup, agent) else { continue };
            agents += 1;
            let found = LinearisedSampling { agent: Named::of(setup, agent), period_s, radius, leftmost, agents, of };
            worst = match worst.take() {
                Some(worst) if found.is_no_worse_than(&worst) => Some(worst),
                _ => Some(found),
            };
        }
        worst.map(|found| LinearisedSampling { agents, ..found })
    }

    /// The period near `near_s` from which on a fast mode of `setup` grows, s, where `sampled` samples it with a period: the end of the interval
    /// of periods without such a mode that holds `near_s`, or of the next one below it. Infinity where none was found; `None` where there
    /// is nothing to linearise, or a mode grows however short periods are.
    pub fn longest_period_s(near_s: f64, sampled: impl Fn(f64) -> Setup) -> Option<f64> {
        let radius = |period_s: f64| LinearisedSampling::of(&sampled(period_s)).map(|found| found.radius);
        radius(near_s)?;
        // Where nothing finite is found no mode decays.
        let decays = |period_s: f64| radius(period_s).is_some_and(|radius| radius < 1.0);
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

    /// Inadequate where a fast mode grows, marginal where one overshoots.
    pub fn answer(&self) -> PracticalAnswer {
        if self.radius >= 1.0 {
            PracticalAnswer::Inadequate
        } else if self.leftmost < 0.0 {
            PracticalAnswer::Marginal
        } else {
            PracticalAnswer::Adequate
        }
    }

    fn is_no_worse_than(&self, other: &LinearisedSampling) -> bool {
        if self.radius.max(other.radius) >= 1.0 { self.radius <= other.radius } else { self.leftmost >= other.leftmost }
    }
}

/// The largest size of a fast multiplier, and the smallest real part of those that are not zero.
fn multipliers(setup: &Setup, agent: usize) -> Option<(f64, f64)> {
    let jacobian = sampled_jacobian(setup, agent).ok()??;
    let n = jacobian.size;
    // J is close to 1 with all its eigenvalues when a period is short, and the QR algorithm then stalls on it, but not on what is left.
    let away = eigenvalues(&(DMatrix::from_row_slice(n, n, &jacobian.entries) - DMatrix::identity(n, n)))?;
    let all: Vec<_> = away.into_iter().map(|mu| mu + 1.0).collect();
    let kept = || all.iter().filter(|mu| mu.norm() > FORGOTTEN);
    let fast = kept().filter(|mu| (*mu - 1.0).norm() > FAST);
    let radius = fast.map(|mu| mu.norm()).fold(0.0, f64::max);
    let leftmost = kept().map(|mu| mu.re).fold(1.0, f64::min);
    (radius.is_finite() && leftmost.is_finite()).then_some((radius, leftmost))
}
