//! The modes of a network whose graph, weights and delays are fixed: of all agents together where these are few, else of agents that are
//! alike and hear each other at once, by the eigenvalues of D⁻¹W.

use forwardstep_sim::Setup;
use forwardstep_sim::graph::{Edge, Weight};
use nalgebra::DMatrix;

use super::linear::{self, Linear};
use crate::prediction::roots::eigenvalues::eigenvalues;

/// Numbers of state that are looked at together, and of an agent that is one of many alike.
const MOST_TOGETHER: usize = 200;
const MOST_STATES: usize = 80;
/// Agents whose network has its modes worked out.
const MOST_AGENTS: usize = 100;
/// A delay that is a whole number of periods, give or take rounding, is that number.
const SLACK_PERIODS: f64 = 1e-6;

/// The largest Σ_j w_ij of an agent in any phase; zero where it follows a target or a leader, whose sign has no derivative.
pub(in crate::practical) fn degree(setup: &Setup, agent: usize) -> f64 {
    if setup.tracks(agent) || setup.following().is_some() {
        return 0.0;
    }
    let network = &setup.network;
    let weight = |weight: Weight| match weight {
        Weight::Constant(weight) => weight,
        Weight::Formula(index) => network.weights.get(index).map_or(0.0, |formula| formula.within().high),
    };
    let of = |edges: &Vec<Edge>| -> f64 {
        edges.iter().filter(|edge| edge.to == agent).map(|edge| weight(edge.weight)).sum()
    };
    network.schedule.graphs.iter().map(of).fold(0.0, f64::max)
}

/// Whether the weights of what an agent hears sum to something else at other times.
pub(super) fn changes(setup: &Setup, agent: usize) -> bool {
    let is_constant = |edges: &[Edge]| {
        edges.iter().filter(|edge| edge.to == agent).all(|edge| matches!(edge.weight, Weight::Constant(_)))
    };
    degree(setup, agent) > 0.0 && !setup.network.schedule.constant_graph().is_some_and(is_constant)
}

/// The largest ln|μ|/h of all modes of a network of agents that hear others or none; `None` where it changes or is too large.
pub(super) fn rate(setup: &Setup, linear: impl Fn(usize) -> Option<Linear>) -> Option<f64> {
    if setup.following().is_some() || (0..setup.agents.len()).any(|agent| setup.tracks(agent)) {
        return None;
    }
    Fixed::of(setup)?.rate(linear)
}

/// A network that does not change.
struct Fixed {
    links: Vec<Link>,
    agents: usize,
}

/// Who hears whom, with which part of all that is heard, and how many samples late.
struct Link {
    from: usize,
    to: usize,
    share: f64,
    late: usize,
}

impl Fixed {
    fn of(setup: &Setup) -> Option<Fixed> {
        let (network, agents) = (&setup.network, setup.agents.len());
        let edges = network.schedule.constant_graph()?;
        if agents > MOST_AGENTS || edges.is_empty() || !network.coupling.is_linear() {
            return None;
        }
        let sample_hz = setup.control.as_ref()?.sample_hz;
        let degrees: Vec<f64> = (0..agents).map(|agent| degree(setup, agent)).collect();
        let link = |edge: &Edge| {
            let delay = network.delays.get(edge.delay).filter(|delay| delay.is_constant())?;
            let periods = (delay.max_s() * sample_hz - SLACK_PERIODS).ceil();
            let share = edge.weight.constant()? / degrees[edge.to];
            let is_short = periods <= MOST_TOGETHER as f64 && share.is_finite();
            is_short.then_some(Link { from: edge.from, to: edge.to, share, late: periods as usize })
        };
        Some(Fixed { links: edges.iter().map(link).collect::<Option<_>>()?, agents })
    }

    /// With what every agent does.
    fn rate(&self, linear: impl Fn(usize) -> Option<Linear>) -> Option<f64> {
        let first = linear(0)?;
        let late: usize = (0..self.agents).map(|agent| self.longest(agent)).sum();
        if self.agents * first.size() + late * first.tells.nrows() <= MOST_TOGETHER {
            let others = (1..self.agents).map(linear);
            let all = core::iter::once(Some(first)).chain(others).collect::<Option<Vec<_>>>()?;
            return self.together(&all);
        }
        let alike = |agent: usize| linear(agent).is_some_and(|other| first.is_like(&other));
        if late > 0 || first.size() > MOST_STATES || !self.is_even() || !(1..self.agents).all(alike) {
            return None;
        }
        let mut mean = DMatrix::zeros(self.agents, self.agents);
        self.links.iter().for_each(|link| mean[(link.to, link.from)] += link.share);
        eigenvalues(&mean)?.into_iter().try_fold(f64::MIN, |most, share| Some(most.max(first.rate_with(share)?)))
    }

    /// Whether everybody hears somebody: else the maps of those who do differ from the others'.
    fn is_even(&self) -> bool {
        (0..self.agents).all(|agent| self.links.iter().any(|link| link.to == agent))
    }

    /// How many samples late an agent is heard at most.
    fn longest(&self, agent: usize) -> usize {
        self.links.iter().filter(|link| link.from == agent).map(|link| link.late).max().unwrap_or(0)
    }

    /// The state is that of all agents, and behind it what each told at the samples before, the latest first. What is heard at the end
    /// of a period without a delay depends on the state there: (1 − E) X⁺ = A X.
    fn together(&self, all: &[Linear]) -> Option<f64> {
        let states: Vec<usize> = starts(all.iter().map(Linear::size), 0);
        let told = starts((0..all.len()).map(|j| self.longest(j) * all[j].tells.nrows()), *states.last()?);
        let n = *told.last()?;
        let [mut now, mut then] = [DMatrix::<f64>::zeros(n, n), DMatrix::<f64>::zeros(n, n)];
        for (i, own) in all.iter().enumerate() {
            let (size, m) = (own.size(), own.tells.nrows());
            now.view_mut((states[i], states[i]), (size, size)).copy_from(&own.own);
            for age in 0..self.longest(i) {
                let row = told[i] + age * m;
                match age {
                    0 => now.view_mut((row, states[i]), (m, size)).copy_from(&own.tells),
                    _ => now.view_mut((row, row - m), (m, m)).fill_with_identity(),
                }
            }
        }
        for &Link { from, to, share, late } in &self.links {
            let (teller, [begin, end]) = (&all[from], &all[to].hears);
            let (m, size) = teller.tells.shape();
            if begin.ncols() != m {
                return None;
            }
            // What was told `age` samples before now: of the state itself, or kept.
            let add = |matrix: &mut DMatrix<f64>, hears: &DMatrix<f64>, age: usize| {
                let (at, part) = match age.checked_sub(1) {
                    None => (states[from], hears * &teller.tells * share),
                    Some(kept) => (told[from] + kept * m, hears * share),
                };
                let mut view = matrix.view_mut((states[to], at), (hears.nrows(), if age == 0 { size } else { m }));
                view += part;
            };
            add(&mut now, begin, late);
            match late.checked_sub(1) {
                None => add(&mut then, end, 0),
                Some(age) => add(&mut now, end, age),
            }
        }
        let one = DMatrix::<f64>::identity(n, n);
        let period = (&one - then).lu().solve(&now)?;
        linear::rate(&(period - one), all[0].period_s)
    }
}

/// Where blocks of these sizes begin, from `first` on, and where the last one ends.
fn starts(sizes: impl Iterator<Item = usize>, first: usize) -> Vec<usize> {
    let ends = sizes.scan(first, |at, size| {
        *at += size;
        Some(*at)
    });
    core::iter::once(first).chain(ends).collect()
}
