//! Responses to a unit of s of one agent over one cell of time, all at once, and what they add up to.

use super::NoReferenceGains;
use super::agent::{Agent, Step};
use super::grid::{Cut, Tap};

/// Multiplications that are spent at most.
const MOST_WORK: f64 = 4e8;
/// Numbers that are remembered at most.
const MOST_NUMBERS: f64 = 1e7;
/// A response that is below this share of the largest is over.
const OVER: f64 = 1e-5;

/// What the responses add up to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sums {
    /// The largest Σ over cells and agents of a difference of two positions, over pairs and nodes, s.
    pub(super) at_once_s: f64,
    /// The largest integral of the largest difference that one impulse leads to.
    pub(super) of_one_s: f64,
    /// Where everybody ends after a unit of s over a cell, by cell, then agent, s.
    pub(super) shift: Vec<f64>,
    /// How long every cell lasts, s.
    pub(super) lengths_s: Vec<f64>,
    /// How far a unit of b for every agent has moved everybody over the last round, s.
    pub(super) bias: f64,
}

impl Sums {
    /// Whether every response was a number to the end.
    pub(super) fn is_finite(&self) -> bool {
        let all = [self.at_once_s, self.of_one_s, self.bias];
        all.iter().chain(&self.shift).all(|value| value.is_finite())
    }
}

/// Rows of one number per column: the first is b, then follow the agents of the first cell, those of the second, ….
struct March<'a> {
    agents: &'a [Agent],
    cuts: &'a [Cut],
    columns: usize,
    /// Columns of cells that have begun.
    begun: usize,
    /// Where the rows of an agent begin.
    rows: Vec<usize>,
    state: Vec<f64>,
    next: Vec<f64>,
    heard: Vec<f64>,
    /// Positions at nodes, agent by agent, the last ones only.
    past: Vec<f64>,
    nodes: usize,
}

impl March<'_> {
    /// Where the positions of an agent at a node begin.
    fn slot(&self, node: i64, agent: usize) -> usize {
        (node.rem_euclid(self.nodes as i64) as usize * self.agents.len() + agent) * self.columns
    }

    /// Positions of an agent at a node.
    fn at(&self, node: i64, agent: usize) -> &[f64] {
        &self.past[self.slot(node, agent)..][..self.begun]
    }

    /// The mean over all agents at a node, column by column.
    fn means(&self, node: i64) -> Vec<f64> {
        let n = self.agents.len();
        let mut sum = vec![0.0; self.begun];
        for agent in 0..n {
            sum.iter_mut().zip(self.at(node, agent)).for_each(|(sum, q)| *sum += q / n as f64);
        }
        sum
    }

    /// Continues all positions in a straight line to `node`.
    fn guess(&mut self, node: i64) {
        for agent in 0..self.agents.len() {
            let [to, now, before] = [node, node - 1, node - 2].map(|node| self.slot(node, agent));
            for c in 0..self.begun {
                self.past[to + c] = 2.0 * self.past[now + c] - self.past[before + c];
            }
        }
    }

    /// Keeps the positions that a step has led to.
    fn keep(&mut self, node: i64) {
        for agent in 0..self.agents.len() {
            let (to, row) = (self.slot(node, agent), self.rows[agent] * self.columns);
            self.past[to..to + self.begun].copy_from_slice(&self.next[row..row + self.begun]);
        }
    }

    /// The step that begins at `node`, and the cell in which s acts, if one still does.
    fn step(&mut self, node: i64, cell: Option<usize>) {
        let cut = &self.cuts[node.rem_euclid(self.cuts.len() as i64) as usize];
        if let Some(cell) = cell {
            self.begun = 1 + (cell + 1) * self.agents.len();
        }
        // What is heard at once needs the end of the step: first a guess, then what comes of it.
        let at_once = cut.agents.iter().any(|(_, taps)| taps.iter().any(|tap| tap.back < 0));
        if at_once {
            self.guess(node + 1);
        }
        for _ in 0..if at_once { 3 } else { 1 } {
            for (agent, (step, taps)) in cut.agents.iter().enumerate() {
                self.agent(agent, (step, taps), node, cell);
            }
            self.keep(node + 1);
        }
        core::mem::swap(&mut self.state, &mut self.next);
    }

    /// The same of one agent.
    fn agent(&mut self, agent: usize, (step, taps): (&Step, &[Tap]), node: i64, cell: Option<usize>) {
        let mut heard = core::mem::take(&mut self.heard);
        heard.fill(0.0);
        for Tap { from, back, share } in taps {
            heard.iter_mut().zip(self.at(node - back, *from)).for_each(|(sum, q)| *sum += share * q);
        }
        let (m, first, columns, begun) = (self.agents[agent].size(), self.rows[agent], self.columns, self.begun);
        for r in 0..m {
            let next = &mut self.next[(first + r) * columns..][..begun];
            next.iter_mut().zip(&heard).for_each(|(next, heard)| *next = step.heard[r] * heard);
            for k in 0..m {
                let (entry, state) = (step.state[r * m + k], &self.state[(first + k) * columns..][..begun]);
                next.iter_mut().zip(state).for_each(|(next, state)| *next += entry * state);
            }
            next[0] += step.bias[r];
            if let Some(cell) = cell {
                next[1 + cell * self.agents.len() + agent] += step.error[r];
            }
        }
        self.heard = heard;
    }
}

/// What has been found so far.
struct Found {
    /// By node of a round, then pair: Σ over columns of their difference.
    at_once: Vec<f64>,
    /// By column: the integral of the largest difference.
    of_one: Vec<f64>,
    largest: f64,
    /// The same over this round alone.
    of_round: f64,
}

impl Found {
    /// Looks at all positions at a node that a step of `length_s` leads to, the `k`th of its round.
    fn look(&mut self, march: &March<'_>, node: i64, k: usize, length_s: f64) {
        let n = march.agents.len();
        let pairs = n * (n - 1) / 2;
        let mut sums = self.at_once[k * pairs..(k + 1) * pairs].iter_mut();
        for i in 1..n {
            for (j, sum) in (0..i).zip(&mut sums) {
                let both = march.at(node, i).iter().zip(march.at(node, j)).skip(1);
                *sum += both.map(|(a, b)| (a - b).abs()).sum::<f64>();
            }
        }
        for c in 1..march.begun {
            let all = || (0..n).map(|agent| march.at(node, agent)[c]);
            let apart = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
            self.of_one[c] += apart * length_s;
            self.of_round = self.of_round.max(apart);
        }
        self.largest = self.largest.max(self.of_round);
    }
}

/// Marches over so many whole rounds of `cuts` as it takes until nothing was left for `quiet_s`, or over one where they do not repeat.
///
/// # Errors
/// [`NoReferenceGains::TooLarge`] and [`NoReferenceGains::Stays`].
pub(super) fn sums(
    agents: &[Agent],
    cuts: &[Cut],
    per_cell: usize,
    quiet_s: Option<f64>,
) -> Result<Sums, NoReferenceGains> {
    let (n, steps) = (agents.len(), cuts.len());
    let mut march = March::new(agents, cuts, per_cell);
    let rounds =
        march.rounds(quiet_s.is_some()).filter(|rounds| *rounds > 0).ok_or(NoReferenceGains::TooLarge { agents: n })?;
    let pairs = n * (n - 1) / 2;
    let mut found =
        Found { at_once: vec![0.0; pairs * steps], of_one: vec![0.0; march.columns], largest: 0.0, of_round: 0.0 };
    let round_s: f64 = cuts.iter().map(|cut| cut.length_s).sum();
    let mut silence_s = 0.0;
    for round in 0..rounds {
        let first = (round * steps) as i64;
        let before = march.means(first)[0];
        found.of_round = 0.0;
        for (k, cut) in cuts.iter().enumerate() {
            march.step(first + k as i64, (round == 0).then_some(k / per_cell));
            found.look(&march, first + k as i64 + 1, k, cut.length_s);
        }
        let is_silent = round > 0 && found.of_round <= OVER * found.largest;
        silence_s = if is_silent { silence_s + round_s } else { 0.0 };
        if quiet_s.is_none_or(|quiet_s| silence_s > quiet_s) {
            let means = march.means(first + steps as i64);
            let lengths_s: Vec<f64> =
                cuts.chunks(per_cell).map(|cell| cell.iter().map(|cut| cut.length_s).sum()).collect();
            let of_one =
                found.of_one[1..].iter().zip(lengths_s.iter().flat_map(|length| core::iter::repeat_n(length, n)));
            return Ok(Sums {
                at_once_s: found.at_once.iter().copied().fold(0.0, f64::max),
                of_one_s: of_one.map(|(integral, length_s)| integral / length_s).fold(0.0, f64::max),
                shift: means[1..].to_vec(),
                lengths_s,
                bias: means[0] - before,
            });
        }
    }
    Err(NoReferenceGains::Stays)
}

impl<'a> March<'a> {
    /// Everybody at rest at zero, now and before.
    fn new(agents: &'a [Agent], cuts: &'a [Cut], per_cell: usize) -> March<'a> {
        let columns = 1 + cuts.len().div_ceil(per_cell) * agents.len();
        let back = cuts.iter().flat_map(|cut| &cut.agents).flat_map(|(_, taps)| taps).map(|tap| tap.back);
        let nodes = back.max().unwrap_or(0).max(1) as usize + 3;
        let rows: Vec<usize> =
            agents.iter().scan(0, |sum, agent| Some(core::mem::replace(sum, *sum + agent.size()))).collect();
        March {
            agents,
            cuts,
            columns,
            begun: 1,
            rows,
            state: Vec::new(),
            next: Vec::new(),
            heard: Vec::new(),
            past: Vec::new(),
            nodes,
        }
    }

    /// How many rounds are affordable; makes room for them. `None` where not even the memory is.
    fn rounds(&mut self, repeats: bool) -> Option<usize> {
        let (n, steps) = (self.agents.len(), self.cuts.len());
        let size: usize = self.agents.iter().map(Agent::size).sum();
        let own: usize = self.agents.iter().map(|agent| agent.size() * (agent.size() + 1)).sum();
        let taps = self.cuts.iter().flat_map(|cut| &cut.agents).map(|(_, taps)| taps.len()).sum::<usize>() / steps;
        let pairs = n * (n - 1) / 2;
        let round = (own + taps + pairs + 2 * n) as f64 * self.columns as f64 * steps as f64;
        // In the first round half of the columns have begun.
        let rounds = if repeats { MOST_WORK / round } else { f64::from(u8::from(0.5 * round <= MOST_WORK)) };
        if ((2 * size + self.nodes * n + 3) * self.columns + pairs * steps) as f64 > MOST_NUMBERS {
            return None;
        }
        self.state = vec![0.0; size * self.columns];
        self.next = self.state.clone();
        self.heard = vec![0.0; self.columns];
        self.past = vec![0.0; self.nodes * n * self.columns];
        Some(rounds.min(1e6) as usize)
    }
}
