//! Lower bounds of the positive operator, cell of time by cell.
//!
//! What the operator makes of a start is bounded entry by entry: column m holds, for every component, how much of component m at the
//! beginning it has for certain. A component obeys ẋ = Σⱼ wⱼ(t) (uⱼ(t) − x) with wⱼ in [w̲ⱼ, w̄ⱼ] over the cell and uⱼ ≥ Hⱼ, a straight line. With d = Σ w̲ⱼ,
//! x is no less than the solution y of
//!
//! ```text
//! ẏ = Σⱼ w̲ⱼ (Hⱼ − y) − E        E = Σⱼ (w̄ⱼ − w̲ⱼ) max(0, Y − min Hⱼ)        Y = y(0) + h Σⱼ w̄ⱼ max(0, max Hⱼ − y(0))
//! ```
//!
//! since y ≤ Y, so that where x = y the rate of x is Σ w̲ⱼ (uⱼ − y) + Σ (wⱼ − w̲ⱼ)(uⱼ − y) ≥ ẏ. Its value is
//! y + h (G e₁ + D e₂) with G = Σ w̲ⱼ (Hⱼ(0) − y) − E, D = Σ w̲ⱼ (Hⱼ(h) − Hⱼ(0)), e₁ = (1 − e⁻ˣ)/x, e₂ = (1 − e₁)/x, x = d h; its second derivative
//! has the sign of D − x G and is at most |D − x G|/h, which says how far the straight line between its ends has to be lowered.
//! Where all entries of a column are equal nothing is lost, so that what is lost in all stays bounded when agreement comes.
//!
//! An input of the same cell is bounded at first by what all inputs and all components are not below, and then, a few times, by what was
//! found: each time from valid bounds to valid bounds.
//!
//! Every rounding is paid for by more than it can be, as a part of the size of what is added up.

use std::collections::VecDeque;

use forwardstep_core::expression::Interval;
use forwardstep_sim::delay::DelayPiece;

use super::heard::{Grid, Place, Point};
use super::network::{Input, Network};

/// Passes over a cell in which somebody hears somebody of the same cell.
const PASSES: usize = 4;
/// What one rounding may cost, generously, as a part.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A past cell.
#[derive(Debug)]
struct Past {
    /// The ends of the lines of all components that are sent.
    lines: Vec<f64>,
    /// What a place in it may be off by, as a part of it.
    rounding: f64,
}

/// What a place in a cell may be off by, as a part of it: times are off by a unit in their last place, which is more of a short cell.
fn rounding(from_s: f64, to_s: f64) -> f64 {
    ROUNDING * (1.0 + to_s.abs() / (to_s - from_s))
}

/// Lower bounds from one time to another.
#[derive(Debug)]
pub(super) struct Cells<'a> {
    network: &'a Network,
    /// Whether what was sent before the beginning is the beginning itself, as before t = 0; otherwise nothing is known of it.
    from_start: bool,
    begin_s: f64,
    pub(super) t_s: f64,
    /// The end of the cell that is made, s.
    to_s: f64,
    /// Component by component, column by column.
    y: Vec<f64>,
    /// Both ends of the line of every component over the cell that is made.
    lines: Vec<f64>,
    starts_s: Vec<f64>,
    past: VecDeque<Past>,
    /// The number of the first past cell that is kept.
    number: u64,
    pieces: Vec<DelayPiece>,
    points: Vec<Vec<Point>>,
    work: Work,
}

/// Columns to work with.
#[derive(Debug)]
struct Work {
    /// Both ends of the lines of all inputs of a component.
    inputs: Vec<f64>,
    value: Vec<f64>,
    low: Vec<f64>,
    shift: Vec<f64>,
    least: Vec<f64>,
}

impl<'a> Cells<'a> {
    pub(super) fn new(network: &'a Network, begin_s: f64, from_start: bool) -> Self {
        let n = network.components();
        let mut y = vec![0.0; n * n];
        y.iter_mut().step_by(n + 1).for_each(|entry| *entry = 1.0);
        let delays = &network.ideal.network.delays;
        let columns = || vec![0.0; n];
        let work = Work { inputs: Vec::new(), value: columns(), low: columns(), shift: columns(), least: columns() };
        Cells {
            network,
            from_start,
            begin_s,
            t_s: begin_s,
            to_s: begin_s,
            y,
            lines: vec![0.0; 2 * n * n],
            starts_s: Vec::new(),
            past: VecDeque::new(),
            number: 0,
            pieces: delays.iter().map(|delay| delay.piece_at(begin_s)).collect(),
            points: vec![Vec::new(); delays.len()],
            work,
        }
    }

    /// Goes on to `to_s`, in one cell, during which one graph is in force.
    pub(super) fn advance(&mut self, to_s: f64, graph: usize) {
        let n = self.network.components();
        self.to_s = to_s;
        let over = Interval { low: self.t_s, high: to_s };
        let inputs = self.network.inputs(graph, over);
        let inner = self.look(&inputs);
        if inner {
            self.guess(&inputs);
        }
        let mut ends = vec![0.0; n * n];
        for _ in 0..if inner { PASSES } else { 1 } {
            for (agent, heard) in inputs.iter().enumerate() {
                let first = self.network.first[agent];
                let last = self.network.first.get(agent + 1).map_or(n, |next| *next) - 1;
                self.hear(heard);
                self.step(last, heard.iter().map(|(_, input)| input.rate), &mut ends);
                for component in (first..last).rev() {
                    let kappa = self.network.kappa[component].unwrap_or(0.0);
                    self.work.inputs.clear();
                    self.work.inputs.extend_from_slice(&self.lines[2 * n * (component + 1)..2 * n * (component + 2)]);
                    self.step(component, [Interval::point(kappa)].into_iter(), &mut ends);
                }
            }
        }
        self.keep(ends);
    }

    /// Where everything that is heard over the cell was sent; whether some of it is sent in the cell itself.
    fn look(&mut self, inputs: &[Vec<(usize, Input)>]) -> bool {
        let grid = Grid {
            starts_s: &self.starts_s,
            number: self.number,
            begin_s: self.begin_s,
            cell_s: [self.t_s, self.to_s],
        };
        let mut used = vec![false; self.pieces.len()];
        inputs.iter().flatten().for_each(|(_, input)| used[input.delay] = true);
        let delays = &self.network.ideal.network.delays;
        let mut inner = false;
        for (index, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            grid.points(&delays[index], &mut self.pieces[index], &mut self.points[index]);
            inner |= self.points[index].iter().any(|point| matches!(point.place, Place::Current(_)));
        }
        inner
    }

    /// Valid lines for the cell before anything is known of it: no component comes below all components and all that is heard.
    fn guess(&mut self, inputs: &[Vec<(usize, Input)>]) {
        let h_s = self.to_s - self.t_s;
        let n = self.network.components();
        let mut least = std::mem::take(&mut self.work.least);
        least.fill(f64::INFINITY);
        for component in 0..n {
            lower(&mut least, &self.y[component * n..(component + 1) * n]);
        }
        for (place, input) in inputs.iter().flatten() {
            for point in &self.points[input.delay] {
                if !matches!(point.place, Place::Current(_)) {
                    let mut value = std::mem::take(&mut self.work.value);
                    self.value(*place, input.of, point.place, &mut value);
                    lower(&mut least, &value);
                    self.work.value = value;
                }
            }
        }
        for component in 0..n {
            let degree = |agent: usize| inputs[agent].iter().map(|(_, input)| input.rate.high).sum::<f64>();
            let rate = self.network.kappa[component].unwrap_or_else(|| degree(self.agent_of(component)));
            let stays = libm::exp(-rate * h_s) * (1.0 - ROUNDING);
            for (m, least) in least.iter().enumerate() {
                let value = (1.0 - ROUNDING) * (least + (self.y[component * n + m] - least) * stays);
                let value = value.max(0.0);
                self.lines[2 * n * component + m] = value;
                self.lines[2 * n * component + n + m] = value;
            }
        }
        self.work.least = least;
    }

    fn agent_of(&self, component: usize) -> usize {
        self.network.first.partition_point(|first| *first <= component) - 1
    }

    /// The lines of what an agent hears, input by input.
    fn hear(&mut self, heard: &[(usize, Input)]) {
        let n = self.network.components();
        let mut inputs = std::mem::take(&mut self.work.inputs);
        inputs.clear();
        inputs.resize(2 * n * heard.len(), 0.0);
        let mut value = std::mem::take(&mut self.work.value);
        let rounding = rounding(self.t_s, self.to_s);
        for ((place, input), line) in heard.iter().zip(inputs.chunks_exact_mut(2 * n)) {
            let (first, last) = line.split_at_mut(n);
            first.fill(f64::INFINITY);
            last.fill(f64::INFINITY);
            self.work.low.fill(f64::INFINITY);
            for point in &self.points[input.delay] {
                self.value(*place, input.of, point.place, &mut value);
                lower(&mut self.work.low, &value);
                if point.at == 0.0 {
                    lower(first, &value);
                }
                if point.at == 1.0 {
                    lower(last, &value);
                }
            }
            self.work.shift.fill(0.0);
            for point in self.points[input.delay].iter().filter(|point| point.at > 0.0 && point.at < 1.0) {
                self.value(*place, input.of, point.place, &mut value);
                let ends = first.iter().zip(last.iter());
                for ((shift, (first, last)), value) in self.work.shift.iter_mut().zip(ends).zip(&value) {
                    *shift = shift.max(first + (last - first) * point.at - value);
                }
            }
            for m in 0..n {
                let paid = self.work.shift[m] + 2.0 * rounding * (first[m] + last[m]);
                // Where nothing was found of a message nothing is known of it.
                let low = if self.work.low[m].is_finite() { self.work.low[m] } else { 0.0 };
                // The straight line, or the least of all, whichever is more in the mean.
                if 0.5 * (first[m] + last[m]) - paid > low && first[m].min(last[m]) >= paid {
                    (first[m], last[m]) = (first[m] - paid, last[m] - paid);
                } else {
                    (first[m], last[m]) = (low, low);
                }
            }
        }
        (self.work.inputs, self.work.value) = (inputs, value);
    }

    /// The bound at a place of what is sent there.
    fn value(&self, sent: usize, component: usize, place: Place, value: &mut [f64]) {
        let n = self.network.components();
        let (line, at, rounding) = match place {
            Place::History => {
                value.fill(0.0);
                if self.from_start {
                    value[component] = 1.0;
                }
                return;
            }
            Place::Current(at) => {
                (&self.lines[2 * n * component..2 * n * (component + 1)], at, rounding(self.t_s, self.to_s))
            }
            Place::Past(number, at) => {
                let past = number.checked_sub(self.number).and_then(|index| self.past.get(index as usize));
                let Some(past) = past else { return value.fill(0.0) };
                (&past.lines[2 * n * sent..2 * n * (sent + 1)], at, past.rounding)
            }
        };
        let (first, last) = line.split_at(n);
        for ((value, first), last) in value.iter_mut().zip(first).zip(last) {
            let between = first + (last - first) * at - rounding * (first + last);
            *value = between.max(first.min(*last));
        }
    }

    /// One component over the cell, from the lines of its inputs and their rates.
    fn step(&mut self, component: usize, rates: impl Iterator<Item = Interval> + Clone, ends: &mut [f64]) {
        let n = self.network.components();
        let h_s = self.to_s - self.t_s;
        let d: f64 = rates.clone().map(|rate| rate.low).sum();
        let x = d * h_s;
        let [e1, e2] = relaxation(x);
        let (count, varies) = (rates.clone().count() as f64, rates.clone().any(|rate| rate.low < rate.high));
        let rounding = (count + 4.0) * rounding(self.t_s, self.to_s);
        let y = &self.y[component * n..(component + 1) * n];
        let line = &mut self.lines[2 * n * component..2 * n * (component + 1)];
        for m in 0..n {
            let own = y[m];
            let (mut g, mut rise, mut size, mut rises) = (0.0, 0.0, 0.0, 0.0);
            for (rate, input) in rates.clone().zip(self.work.inputs.chunks_exact(2 * n)) {
                let (first, last) = (input[m], input[n + m]);
                g += rate.low * (first - own);
                rise += rate.low * (last - first);
                size += rate.high * (first + last + own);
                rises += rate.high * (first.max(last) - own).max(0.0);
            }
            if varies {
                let top = own + h_s * rises;
                for (rate, input) in rates.clone().zip(self.work.inputs.chunks_exact(2 * n)) {
                    g -= (rate.high - rate.low) * (top - input[m].min(input[n + m])).max(0.0);
                }
            }
            let paid = ROUNDING * own + rounding * h_s * size;
            let end = own + h_s * (g * e1 + rise * e2) - paid;
            let lowered = 0.125 * h_s * (rise - x * g).max(0.0) + paid;
            // Below zero nothing is known but that.
            ends[component * n + m] = end.max(0.0);
            let (first, last) = (own - lowered, end - lowered);
            (line[m], line[n + m]) = if first >= 0.0 && last >= 0.0 { (first, last) } else { (0.0, 0.0) };
        }
    }

    fn keep(&mut self, ends: Vec<f64>) {
        let to_s = self.to_s;
        let n = self.network.components();
        let mut lines = Vec::with_capacity(2 * n * self.network.sent * self.network.first.len());
        for component in self.network.all_sent() {
            lines.extend_from_slice(&self.lines[2 * n * component..2 * n * (component + 1)]);
        }
        self.past.push_back(Past { lines, rounding: rounding(self.t_s, to_s) });
        self.starts_s.push(self.t_s);
        (self.y, self.t_s) = (ends, to_s);
        let oldest_s = to_s - self.network.window_s;
        // The first that is kept holds the oldest time that matters, with the one before it for rounding.
        let over = self.starts_s.partition_point(|start_s| *start_s < oldest_s).saturating_sub(2);
        // Not one by one, since what is kept moves up.
        if 4 * over >= self.starts_s.len() {
            self.starts_s.drain(..over);
            self.past.drain(..over);
            self.number += over as u64;
        }
    }

    /// Cells that are kept, which [`Self::left`] goes through.
    pub(super) fn kept(&self) -> usize {
        self.past.len()
    }

    /// What is left at most of the length of the interval that all components and all that is on its way lie in.
    ///
    /// Let row a hold what component a has for certain of every component at the beginning, now and, if it is sent, all over the last window. Two
    /// values a and b of now then differ by at most 1 − Σₘ min(row a, row b) of that length: what both have of component m cancels.
    pub(super) fn left(&self) -> f64 {
        let n = self.network.components();
        let mut rows = self.y.clone();
        let window_s = self.t_s - self.network.window_s;
        let over = self.starts_s.partition_point(|start_s| *start_s <= window_s).saturating_sub(1);
        for (place, component) in self.network.all_sent().enumerate() {
            let row = &mut rows[component * n..(component + 1) * n];
            for past in self.past.iter().skip(over) {
                let (first, last) = past.lines[2 * n * place..2 * n * (place + 1)].split_at(n);
                lower(row, first);
                lower(row, last);
            }
            if window_s < self.begin_s {
                let history = |m: usize| if self.from_start && m == component { 1.0 } else { 0.0 };
                row.iter_mut().enumerate().for_each(|(m, entry)| *entry = entry.min(history(m)));
            }
        }
        let common = |a: usize, b: usize| -> f64 {
            rows[a * n..(a + 1) * n].iter().zip(&rows[b * n..(b + 1) * n]).map(|(a, b)| a.min(*b)).sum()
        };
        let pairs = (0..n).flat_map(|a| (a..n).map(move |b| (a, b)));
        let least = pairs.map(|(a, b)| common(a, b)).fold(1.0, f64::min);
        (1.0 - least * (1.0 - ROUNDING * n as f64)).next_up().clamp(0.0, 1.0)
    }
}

/// Lowers every entry to that of `other`.
fn lower(entries: &mut [f64], other: &[f64]) {
    entries.iter_mut().zip(other).for_each(|(entry, other)| *entry = entry.min(*other));
}

/// e₁ = (1 − e⁻ˣ)/x and e₂ = (1 − e₁)/x for x ≥ 0, each with an error of a few units in its last place.
fn relaxation(x: f64) -> [f64; 2] {
    // Where the quotients cancel, Σ (−x)ᵏ/(k + 1)! and Σ (−x)ᵏ/(k + 2)!.
    if x < 0.5 {
        return [nested(x, 2.0), 0.5 * nested(x, 3.0)];
    }
    let e1 = -libm::expm1(-x) / x;
    [e1, (1.0 - e1) / x]
}

/// 1 − x/n (1 − x/(n+1) (1 − …)).
fn nested(x: f64, n: f64) -> f64 {
    (0..18).rev().fold(1.0, |rest, k| 1.0 - x / (n + f64::from(k)) * rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use forwardstep_sim::{AgentSetup, Known, Network as Links, RobotSetup, Setup, delay::Delay};

    #[test]
    fn lines_lie_nowhere_above_a_solution_that_bends_upwards() {
        let mass = || AgentSetup::new("mass", RobotSetup::point_mass(1, 1.0), Known::gain(1.0)).roots([1.0]).at(&[0.0]);
        let links = Links::fixed(2, [(0, 1)], Delay::constant(0.0));
        let network = Network::of(&Setup::consensus([mass(), mass()], links, 2.0)).unwrap();
        let mut cells = Cells::new(&network, 0.0, true);
        // All rates are 1/s: what components 0, 3 and 2 have of component 1 is a step behind one, one and two lags.
        let step = |more: f64, t: f64| 1.0 - libm::exp(-t) * (1.0 + more * t);
        while cells.t_s < 2.0 {
            let (from_s, cell_s) = (cells.t_s, (0.5 * cells.t_s).clamp(1e-6, 0.05));
            cells.advance(from_s + cell_s, 0);
            for (component, more) in [(0, 0.0), (3, 0.0), (2, 1.0)] {
                let [first, last] = [1, 5].map(|at| cells.lines[8 * component + at]);
                for at in [0.0, 0.25, 0.5, 0.75, 1.0] {
                    let (bound, exact) = (first + at * (last - first), step(more, from_s + cell_s * at));
                    assert!(
                        bound <= exact + 1e-15 && bound > exact - 2e-3,
                        "{component} from {from_s} s: {bound}, not {exact}"
                    );
                }
            }
        }
    }
}
