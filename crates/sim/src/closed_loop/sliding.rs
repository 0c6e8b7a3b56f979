//! Sets the set-valued sign in continuous time.
//!
//! With s (ṡ for (119)) held over a period h the sign ς moves what it is taken of by −hγ L ς, where L is the Laplacian of the
//! followers with their weights to the leader (`forwardstep_core::reference::Sliding`). The value that suits the end of the
//! period solves, axis by axis,
//!
//! ```text
//! ς ∈ Sgn(r),   r = e − hγ L ς        that is   −1 ≤ ς ≤ 1,   r_i = 0 where ς_i is inside, r_i ≥ 0 where it is 1, ≤ 0 where −1
//! ```
//!
//! a box complementarity problem. L is a nonsingular M-matrix when the leader reaches everybody, and there is one solution.
//! Projected Gauss–Seidel, ς_i ← sat[(e_i + hγ Σ_j w_ij ς_j)/(hγ d_i)], comes closer to it with every sweep, since what is
//! inside the bracket is a mean of the neighbours' values with weights whose sum is at most one; it starts from the last
//! solution, or from zero where the graph is new: a group that hears no agent outside itself has many solutions. Links with a delay bring nothing of this period, and stand in e only.
//!
//! The motion of the robots between two settings is what it is, whatever was held here: for (110) and (119) the sign reaches
//! the motion through M⁻¹M̂. So nothing is claimed beyond the largest |r − e| that sweeping left, which is reported.

use forwardstep_core::reference::{Choice, Sliding, saturated};

use super::assemble::Block;
use crate::engine::{EventOutcome, Heard};
use crate::graph::Weight;
use crate::network::Network;
use crate::schedule::{Segment, Segments};

/// Sweeps at one instant.
const MOST_SWEEPS: usize = 400;
/// Values that change by less are settled.
const SETTLED: f64 = 1e-13;

/// The signs of the whole network.
pub(crate) struct Slider<'a> {
    network: &'a Network,
    sliding: Sliding,
    period_s: f64,
    axes: usize,
    /// Where the columns of every vertex begin, how far apart they are, and its place among the degrees.
    places: Vec<Place>,
    segments: Segments<'a>,
    segment: Segment,
    links: Vec<Link>,
    /// How many times the signs were set.
    set: u64,
    own: Vec<f64>,
    sums: Vec<f64>,
    e: Vec<f64>,
    selection: Vec<f64>,
    rates: Vec<f64>,
    residual: f64,
}

/// Where the columns of one vertex stand: axis c at `first + c · stride`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) first: usize,
    pub(super) stride: usize,
    pub(super) degree: usize,
}

/// What is heard, and what acts from outside.
type Outside<'a> = (&'a Heard, Option<&'a [f64]>);

/// An edge in force.
#[derive(Clone, Copy, Debug)]
struct Link {
    from: Place,
    to: Place,
    weight: Weight,
    /// w_ij at the instant at hand.
    now: f64,
    delayed: bool,
}

impl<'a> Slider<'a> {
    /// `states` is how many numbers of state there are.
    pub(super) fn new(
        network: &'a Network,
        sliding: Sliding,
        period_s: f64,
        axes: usize,
        places: Vec<Place>,
        states: usize,
    ) -> Self {
        let mut segments = network.schedule.segments();
        let for_ever = Segment { start_s: 0.0, end_s: f64::INFINITY, graph: 0 };
        let segment = segments.next().unwrap_or(for_ever);
        let columns = || vec![0.0; places.len() * axes];
        let mut slider = Slider {
            network,
            sliding,
            period_s,
            axes,
            segments,
            segment,
            links: Vec::new(),
            set: 0,
            own: columns(),
            sums: columns(),
            e: columns(),
            selection: columns(),
            rates: vec![0.0; states],
            residual: 0.0,
            places,
        };
        slider.rewire();
        slider
    }

    fn rewire(&mut self) {
        self.links.clear();
        // An agent that hears no other is pulled nowhere, not where it was pulled before.
        self.selection.fill(0.0);
        for edge in self.network.schedule.graph(self.segment.graph) {
            let (from, to) = (self.places[edge.from], self.places[edge.to]);
            let delayed = self.network.delays.get(edge.delay).is_some_and(|delay| delay.max_s() > 0.0);
            self.links.push(Link { from, to, weight: edge.weight, now: 0.0, delayed });
        }
        // Receivers in order, senders in order within: values do not depend on how a file lists its edges.
        self.links.sort_by_key(|link| (link.to.degree, link.from.degree));
    }

    /// Whether ς is a function of the instant, and nothing is ever set.
    fn is_layer(&self) -> Option<f64> {
        match self.sliding.choice {
            Choice::Layer { width } => Some(width),
            _ => None,
        }
    }

    /// The largest rest that sweeping left, in the unit of what the sign is taken of.
    pub(super) fn residual(&self) -> Option<f64> {
        (self.sliding.choice == Choice::Implicit).then_some(self.residual)
    }

    /// The next event, s.
    pub(super) fn next_s(&self) -> f64 {
        let set_s = if self.is_layer().is_some() { f64::INFINITY } else { self.set as f64 * self.period_s };
        set_s.min(self.segment.end_s)
    }

    /// Everything that is due until `until_s`: a new graph, then new values of all signs, by what is heard over it.
    pub(super) fn happen(
        &mut self,
        until_s: f64,
        heard: &Heard,
        external: Option<&[f64]>,
        blocks: &mut [Block],
        x: &mut [f64],
    ) -> EventOutcome {
        while self.segment.end_s <= until_s {
            match self.segments.next() {
                Some(segment) => self.segment = segment,
                None => self.segment.end_s = f64::INFINITY,
            }
            self.rewire();
        }
        let now_s = self.set as f64 * self.period_s;
        if self.is_layer().is_some() || now_s > until_s {
            return EventOutcome::Nothing;
        }
        self.set += 1;
        if self.sliding.transmitted() > 0 {
            for block in blocks.iter_mut() {
                let (inputs, rates) = (block.inputs(heard, external), &mut self.rates[block.state.clone()]);
                block.columns.rates(now_s, &x[block.state.clone()], inputs, rates);
            }
        }
        self.weigh(now_s);
        self.take_arguments(now_s, (heard, external), blocks, x, None);
        match self.sliding.choice {
            Choice::Implicit => self.solve(&heard.degree),
            _ => {
                for (selection, e) in self.selection.iter_mut().zip(&self.e) {
                    *selection = saturated(*e, 0.0);
                }
            }
        }
        for block in blocks {
            if let Some(range) = block.columns.selection() {
                x[block.state.clone()][range].copy_from_slice(&self.selection[block.columns_range(self.axes)]);
            }
        }
        EventOutcome::Sampled
    }

    /// The sign as a function of the instant: −γ ς is added to the rates `dx` of the state `x`.
    pub(super) fn add_sign_terms(
        &mut self,
        t_s: f64,
        outside: Outside<'_>,
        blocks: &mut [Block],
        x: &[f64],
        dx: &mut [f64],
    ) {
        // A sign taken of what is heard alone was dealt with before the torque.
        let Some(width) = self.is_layer().filter(|_| self.sliding.transmitted() > 0) else { return };
        self.weigh(t_s);
        self.take_arguments(t_s, outside, blocks, x, Some(dx));
        for (selection, e) in self.selection.iter_mut().zip(&self.e) {
            *selection = saturated(*e, width);
        }
        for block in blocks {
            let range = block.columns_range(self.axes);
            block.columns.add_sign_terms(&self.selection[range], &mut dx[block.state.clone()]);
        }
    }

    /// Has the signs ready to be recorded where they are functions of the instant and of what was computed.
    pub(super) fn look(&mut self, t_s: f64, heard: &Heard, external: Option<&[f64]>, blocks: &mut [Block], x: &[f64]) {
        if self.is_layer().is_none() || self.sliding.transmitted() == 0 {
            return;
        }
        let mut rates = std::mem::take(&mut self.rates);
        for block in blocks.iter_mut() {
            let (inputs, rates) = (block.inputs(heard, external), &mut rates[block.state.clone()]);
            block.columns.rates(t_s, &x[block.state.clone()], inputs, rates);
        }
        self.add_sign_terms(t_s, (heard, external), blocks, x, &mut rates);
        self.rates = rates;
    }

    /// Evaluates the weights.
    fn weigh(&mut self, t_s: f64) {
        for link in &mut self.links {
            link.now = self.network.weight_at(link.weight, t_s);
        }
    }

    /// e of everybody, from the rates `dx` or those at hand.
    fn take_arguments(
        &mut self,
        t_s: f64,
        (heard, external): Outside<'_>,
        blocks: &mut [Block],
        x: &[f64],
        dx: Option<&[f64]>,
    ) {
        if self.sliding.transmitted() > 0 {
            let rates = dx.unwrap_or(&self.rates);
            for block in blocks.iter_mut() {
                let range = block.columns_range(self.axes);
                block.columns.transmit(t_s, &rates[block.state.clone()], &mut self.own[range]);
            }
            self.sums.fill(0.0);
            for Link { from, to, now, .. } in &self.links {
                for c in 0..self.axes {
                    self.sums[to.first + c * to.stride] += now * self.own[from.first + c * from.stride];
                }
            }
        }
        for block in blocks {
            let range = block.columns_range(self.axes);
            let (own, sums) = (&self.own[range.clone()], &self.sums[range.clone()]);
            let inputs = block.inputs(heard, external);
            block.columns.argument(&x[block.state.clone()], inputs, [own, sums], &mut self.e[range]);
        }
    }

    /// ς ∈ Sgn(e − hγ L ς), with the sums of the weights of all that everybody hears.
    fn solve(&mut self, degree: &[f64]) {
        let step = self.period_s * self.sliding.gamma;
        let mut left = 0.0_f64;
        for _ in 0..MOST_SWEEPS {
            let (mut change, mut rest) = (0.0_f64, 0.0_f64);
            for receiver in self.links.chunk_by(|a, b| a.to.degree == b.to.degree) {
                let to = receiver[0].to;
                let width = step * degree[to.degree];
                for c in 0..self.axes {
                    let at = to.first + c * to.stride;
                    let near = receiver.iter().filter(|link| !link.delayed);
                    let received: f64 =
                        near.map(|link| link.now * self.selection[link.from.first + c * link.from.stride]).sum();
                    let value = saturated(self.e[at] + step * received, width);
                    let moved = (value - self.selection[at]).abs();
                    change = change.max(moved);
                    rest = rest.max(width * moved);
                    self.selection[at] = value;
                }
            }
            left = rest;
            if change <= SETTLED || change.is_nan() {
                break;
            }
        }
        self.residual = self.residual.max(left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delay::Delay;
    use crate::graph::Edge;
    use crate::schedule::Schedule;
    use forwardstep_core::reference::Derived;

    /// A path 3 → 0 → 1 → 2 from the leader 3, with a link back from 2 to 0.
    #[test]
    fn the_solution_is_complementary() {
        let edge = |from, to, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
        let edges = vec![edge(3, 0, 1.0), edge(0, 1, 2.0), edge(1, 2, 0.5), edge(2, 0, 0.7)];
        let network = Network {
            agents: 4,
            schedule: Schedule::fixed(edges.clone()),
            delays: vec![Delay::constant(0.0)],
            weights: Vec::new(),
            coupling: Default::default(),
        };
        let sliding =
            Sliding { derived: Derived::Nothing, alpha: 1.0, beta: 1.0, gamma: 3.0, choice: Choice::Implicit };
        let degree = vec![1.7, 2.0, 0.5, 0.0];
        let places = (0..4).map(|i| Place { first: i, stride: 4, degree: i }).collect();
        let mut slider = Slider::new(&network, sliding, 1e-3, 1, places, 0);
        slider.weigh(0.0);
        for e in [[1e-4, -2e-4, 3e-5, 0.0], [0.5, 1e-3, -1e-3, 0.0], [-4e-3, 4e-3, 4e-3, 0.0], [0.0; 4]] {
            slider.e.copy_from_slice(&e);
            slider.solve(&degree);
            let selection = &slider.selection;
            for i in 0..3 {
                let received: f64 = edges
                    .iter()
                    .filter(|edge| edge.to == i)
                    .map(|edge| edge.weight.constant().unwrap() * selection[edge.from])
                    .sum();
                let r = e[i] - 3e-3 * (degree[i] * selection[i] - received);
                let holds = if selection[i].abs() < 1.0 { r.abs() < 1e-15 } else { r * selection[i] >= -1e-15 };
                assert!(holds && selection[i].abs() <= 1.0, "{e:?}: {selection:?} {r}");
            }
            assert_eq!(selection[3], 0.0);
        }
        assert!(slider.residual().unwrap() < 1e-15);
    }
}
