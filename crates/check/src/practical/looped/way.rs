//! How fast small deviations of an agent grow along the motion that its target or a leader leads it through.
//!
//! A loop that changes with time may decay at every instant by itself and grow, and the other way round. So the map of one part of
//! the way is put behind that of the part before, P ← J P, and r is by how much more ln|P| is at most in the last quarter of the
//! time than in the second one, per time: how a motion turns and stretches P while it comes back is in both. The parts begin where
//! the agent is with s ≡ 0, or under other laws than (6)–(7) where the part before ended.
//!
//! Where all of that takes too much work, or deviations leave all bounds within a part, r is the mean of ln ρ(J) per time of single periods
//! that are spread over it, an estimate that is good while the motion is slow beside its modes.

use forwardstep_sim::{Periods, Setup};
use nalgebra::DMatrix;

use super::linear::{self, Linear};
use super::place::{FASTER, LoopRate, STILL_FASTER, ideal};
use crate::hypothesis::Named;
use crate::kinds::is_lagrangian;
use crate::practical::led::Led;

/// Parts of the way at least, and single periods that are spread over it at most.
const LEAST: usize = 16;
const MOST: usize = 64;
/// Periods of a part, where parts are not longer because there would be too many: the longer it is, the farther does what samples leave of s
/// carry it from the way.
const PERIODS: usize = 16;
/// A period takes as long as these numbers of state and its own do.
const SMALL: usize = 16;
/// Periods that pass, times numbers of state, for all agents together, and how much more of it an ideal loop may take.
const WORK: f64 = 1.5e6;
const IDEAL: f64 = 4.0;
/// The ideal loop is found when samples that are faster yet change its rate by no more than this part of the deployed one's.
const SETTLED: f64 = 0.1;

/// The loop of the agent that grows fastest along its way.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopAlong {
    /// Who.
    pub agent: Named,
    /// How fast.
    pub rate: LoopRate,
    /// Along how much of the way this is known, s.
    pub over_s: f64,
    /// Whether nothing was left out between.
    pub is_gapless: bool,
}

impl LoopAlong {
    /// Of these agents, which are led; `None` where none are, or nothing finite is found.
    pub(super) fn of(setup: &Setup, way: &[Led], agents: &[usize]) -> Option<LoopAlong> {
        let work = WORK / agents.len() as f64;
        let along = |agent: &usize| {
            let way: Vec<&Led> = way.iter().filter(|led| led.agent == *agent).collect();
            Course { setup, agent: *agent, way }.along(work)
        };
        agents.iter().filter_map(along).max_by(|a, b| a.rate.added_per_s().total_cmp(&b.rate.added_per_s()))
    }

    /// What sampling adds, where deviations grow e-fold by it: what they do by the motion alone comes and goes.
    pub(in crate::practical) fn grows_per_s(&self) -> Option<f64> {
        Some(self.rate.added_per_s()).filter(|rate| rate * self.over_s > 1.0)
    }
}

/// The way of one agent.
struct Course<'a> {
    setup: &'a Setup,
    agent: usize,
    /// Its states on it, where they are predicted.
    way: Vec<&'a Led>,
}

/// How a way is divided.
#[derive(Clone, Copy)]
struct Parts {
    count: usize,
    periods: u32,
}

/// What is found along a way.
#[derive(Clone, Copy)]
struct Growth {
    per_s: f64,
    over_s: f64,
    is_gapless: bool,
}

impl Course<'_> {
    fn along(&self, work: f64) -> Option<LoopAlong> {
        let Growth { per_s, over_s, is_gapless } = self.growth(self.setup, 1, work)?;
        // Under (6)–(7) V falls along all of the way of the ideal loop.
        let is_asked = per_s * over_s > 1.0 && !is_lagrangian(&self.setup.agents[self.agent]);
        let ideal_per_s = if is_asked { self.settled(per_s, work) } else { None };
        let agent = Named::of(self.setup, self.agent);
        Some(LoopAlong { agent, rate: LoopRate { per_s, ideal_per_s }, over_s, is_gapless })
    }

    /// The rate of the ideal loop, when that of the deployed one is this.
    fn settled(&self, per_s: f64, work: f64) -> Option<f64> {
        let rate = |faster: u32| {
            let found = self.growth(&ideal(self.setup, faster)?, faster, IDEAL * work)?;
            Some(if found.per_s * found.over_s > 1.0 { found.per_s } else { 0.0 })
        };
        let mut found = rate(FASTER)?;
        for faster in STILL_FASTER {
            let Some(finer) = rate(faster).filter(|_| found > 0.0) else { break };
            let is_settled = (finer - found).abs() <= SETTLED * per_s;
            found = finer;
            if is_settled {
                break;
            }
        }
        Some(found)
    }

    fn growth(&self, setup: &Setup, faster: u32, work: f64) -> Option<Growth> {
        let size = self.part(setup, 0, Parts { count: LEAST, periods: 1 })?.size();
        // What leads there is run before every part where it is not predicted: half of the count in the mean.
        let [most, before] = if self.way.is_empty() { [2 * size, size] } else { [self.way.len(), 0] };
        let affordable = (work / ((2 * size + before) * (size + SMALL)) as f64).max(LEAST as f64);
        let whole = (setup.time.end_s * setup.control.as_ref()?.sample_hz).floor();
        let maps = |parts: Parts| (0..parts.count).map(move |part| self.part(setup, part, parts));
        let followed = || {
            let taken = whole.min(affordable) as usize;
            let count = taken.div_ceil(PERIODS * faster as usize).min(most).max(LEAST);
            // What has run away within a part says no more.
            product(maps(Parts { count, periods: (taken / count) as u32 }).map_while(|map| map))
        };
        let is_gapless = self.way.is_empty() || (affordable >= whole && self.way.len() >= LEAST);
        let spread = || self.mean(maps(Parts { count: (affordable as usize).min(MOST), periods: 1 }).flatten());
        if is_gapless { followed() } else { None }.or_else(|| if self.way.is_empty() { None } else { spread() })
    }

    /// The map of a part.
    fn part(&self, setup: &Setup, part: usize, Parts { count, periods }: Parts) -> Option<Linear> {
        let led = self.way.get(part * self.way.len() / count);
        let there = led.map(|led| led.put_into(setup));
        let (begin_s, after) = led.map_or((0.0, part as u32 * periods), |led| (led.t_s, 0));
        Linear::of(there.as_ref().unwrap_or(setup), self.agent, 0.0, Periods { begin_s, after, over: periods })
    }

    /// Of single periods.
    fn mean(&self, maps: impl Iterator<Item = Linear>) -> Option<Growth> {
        let rates: Vec<f64> = maps.filter_map(|map| Some(linear::fastest(&map.multipliers()?, map.period_s))).collect();
        let per_s = rates.iter().sum::<f64>() / rates.len() as f64;
        per_s.is_finite().then_some(Growth { per_s, over_s: self.setup.time.end_s, is_gapless: false })
    }
}

/// Of one part after the other.
fn product(maps: impl Iterator<Item = Linear>) -> Option<Growth> {
    let (mut sizes, mut part_s) = (Vec::new(), 0.0);
    let (mut product, mut size) = (None::<DMatrix<f64>>, 0.0);
    for Linear { own, period_s, .. } in maps {
        let grown = product.map_or_else(|| own.clone(), |product| &own * product);
        let norm = grown.norm();
        size += libm::log(norm);
        sizes.push(size);
        (product, part_s) = (Some(grown / norm), period_s);
    }
    let quarter = sizes.len() / 4;
    let most = |from: usize| sizes.get(from..from + quarter)?.iter().copied().reduce(f64::max);
    let (early, late) = (most(quarter)?, most(sizes.len() - quarter)?);
    let between_s = (sizes.len() - 2 * quarter) as f64 * part_s;
    let per_s = (late - early) / between_s;
    per_s.is_finite().then_some(Growth { per_s, over_s: part_s * sizes.len() as f64, is_gapless: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(own: [f64; 4]) -> Linear {
        let none = || DMatrix::zeros(0, 0);
        Linear { period_s: 0.5, own: DMatrix::from_row_slice(2, 2, &own), tells: none(), hears: [none(), none()] }
    }

    /// What stretches by e^a along an axis that turns on from part to part grows at a, and by what every part does alone, or in another order, at
    /// another rate.
    #[test]
    fn deviations_are_followed_from_part_to_part() {
        let turned = |k: usize| {
            let ((s, c), (s_after, c_after)) = (libm::sincos(k as f64), libm::sincos(k as f64 + 1.0));
            let (long, short) = (libm::exp(0.2), libm::exp(-0.4));
            map([
                c_after * long * c + s_after * short * s,
                c_after * long * s - s_after * short * c,
                s_after * long * c - c_after * short * s,
                s_after * long * s + c_after * short * c,
            ])
        };
        let found = product((0..40).map(turned)).unwrap();
        assert!((found.per_s - 0.4).abs() < 1e-9 && found.over_s == 20.0, "{}", found.per_s);
    }

    /// What falls at the beginning is no rate of what comes later.
    #[test]
    fn the_beginning_of_a_way_does_not_count() {
        let own = |k: usize| libm::exp(if k < 10 { -3.0 } else { 0.05 });
        let found = product((0..40).map(|k| map([own(k), 0.0, 0.0, own(k)]))).unwrap();
        assert!((found.per_s - 0.1).abs() < 1e-9, "{}", found.per_s);
        let along = |per_s: f64| {
            let rate = LoopRate { per_s, ideal_per_s: None };
            LoopAlong { agent: Named { index: 0, name: String::new() }, rate, over_s: 20.0, is_gapless: true }
        };
        assert_eq!([0.049, 0.051].map(|per_s| along(per_s).grows_per_s()), [None, Some(0.051)]);
        assert!(product((0..3).map(|_| map([1.0; 4]))).is_none(), "too few");
    }
}
