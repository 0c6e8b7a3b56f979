//! How far derivatives of inputs jump where what is heard jumps, for any plant under any law: by the first variation of the closed loop.
//!
//! Derived for this software. Let ẋ = F(t, x, w) be one agent with what it hears in w, and u = g(t, x, w) its input; at t* w jumps and x does not. An
//! entry of x has *order k* if x_i⁽ᵏ⁾ is the first of its derivatives that needs the value of w: k = 1 if F_i reads w, and k + 1 if F_i
//! reads an entry of order k, and neither w nor an entry of a lower order. Then every derivative of x_i below k is continuous, and, since
//! d^k/dt^k F_i(t, x) contains the k-th derivatives of x linearly,
//!
//! ```text
//! Δx_i⁽¹⁾ = F_i(t*, x, w⁺) − F_i(t*, x, w⁻)
//! Δx_i⁽ᵏ⁺¹⁾ = Σ_j ∂F_i/∂x_j Δx_j⁽ᵏ⁾        over the entries j of order k
//! Δu⁽⁰⁾ = g(t*, x, w⁺) − g(t*, x, w⁻),      Δu⁽ᵏ⁾ = Σ_j ∂g/∂x_j Δx_j⁽ᵏ⁾
//! ```
//!
//! up to the order of u, at which w's value enters for the first time; above it derivatives of w would be needed. Both sums are one derivative of the
//! vector field that runs, along one direction, taken by central differences and extrapolated. What does not read an entry has the same bits on both
//! sides, so what does not jump is exactly zero. Most entries are affine in those before them, and there the difference is as good as the rounding.
//!
//! Orders are found by changing what is read, at the start of the run and near it, and again wherever a jump reaches an entry earlier than was found.

use std::ops::Range;

use crate::closed_loop::ClosedLoop;
use crate::engine::Heard;
use crate::recording::Signal;

/// How an input of one agent depends on what the agent hears.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputOrder {
    /// What it is.
    pub signal: Signal,
    /// How many entries it has.
    pub entries: usize,
    /// The order of its first derivative that needs the value of what is heard; `None` where none does.
    pub order: Option<usize>,
}

/// The jumps of derivatives of one input of an agent.
#[derive(Clone, Debug, PartialEq)]
pub struct InputJump {
    /// What it is.
    pub signal: Signal,
    /// By how much the r-th derivative of every entry jumps, for r = 0, 1, … up to [`InputOrder::order`]; nothing where no derivative needs what is heard.
    pub derivatives: Vec<Vec<f64>>,
}

/// The first variation of a closed loop.
pub(super) struct Variation {
    agents: Vec<Own>,
    /// Of every state; a balance has none.
    orders: Vec<Option<usize>>,
    u: [Vec<f64>; 2],
    dx: [Vec<f64>; 2],
}

/// One agent.
struct Own {
    states: Vec<usize>,
    inputs: Vec<Input>,
}

/// One signal of its input.
struct Input {
    order: InputOrder,
    /// Where it stands in a row of the recording.
    row: Range<usize>,
    /// Where it stands among all inputs.
    at: Range<usize>,
}

/// How far from its value an entry is moved to take a derivative, relative to 1 + |value|.
const STEP: f64 = 1.0 / 256.0;
/// How far from the start the states are at which orders are found, relative to 1 + |value|.
const PROBES: [f64; 3] = [0.0, 0.02, 0.3];

impl Variation {
    /// Of the first `agents` vertices, which are not the leader.
    pub(super) fn new(closed_loop: &mut ClosedLoop<'_>, agents: usize) -> Self {
        let mut placed = 0;
        let own = |inputs: Vec<(Signal, Range<usize>)>| {
            let input = |(signal, row): (Signal, Range<usize>)| {
                let at = placed..placed + row.len();
                placed = at.end;
                Input { order: InputOrder { signal, entries: row.len(), order: None }, row, at }
            };
            Own { states: Vec::new(), inputs: inputs.into_iter().map(input).collect() }
        };
        let mut own: Vec<Own> = closed_loop.inputs(agents).into_iter().map(own).collect();
        let x = closed_loop.start();
        for state in 0..x.len() {
            let (agent, signal, _) = closed_loop.locate(state);
            if let Some(own) = own.get_mut(agent).filter(|_| signal != Signal::Dissipation) {
                own.states.push(state);
            }
        }
        let (u, dx) = (vec![0.0; placed], vec![0.0; x.len()]);
        let mut variation =
            Variation { agents: own, orders: vec![None; x.len()], u: [u.clone(), u], dx: [dx.clone(), dx] };
        // Set-valued signs answer to what is heard at instants of their own, and held inputs to nothing.
        if !closed_loop.has_signs() && closed_loop.samples().is_none() {
            PROBES.iter().for_each(|size| variation.probe(closed_loop, *size));
        }
        variation
    }

    /// Of every agent, its inputs.
    pub(super) fn inputs(&self) -> Vec<Vec<InputOrder>> {
        let own = |own: &Own| own.inputs.iter().map(|input| input.order.clone()).collect();
        self.agents.iter().map(own).collect()
    }

    /// Finds orders around a state that is so far from the start.
    fn probe(&mut self, closed_loop: &mut ClosedLoop<'_>, size: f64) {
        let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
        let mut x = closed_loop.start();
        x.iter_mut().for_each(|x| *x += size * (1.0 + x.abs()) * noise.next());
        let (ports, entries) = closed_loop.ports();
        let mut heard = || Heard {
            degree: ports.iter().map(|_| 2.0 + noise.next()).collect(),
            sums: (0..ports.len() * entries).map(|_| noise.next()).collect(),
        };
        let (before, after) = (heard(), heard());
        self.propagate(closed_loop, 0.0, &x, [&before, &after], &mut |_, _| {});
    }

    /// The jumps of every agent in the state `x` at `t_s`, where what is heard goes from the first to the second.
    pub(super) fn jumps(
        &mut self,
        closed_loop: &mut ClosedLoop<'_>,
        t_s: f64,
        x: &[f64],
        heard: [&Heard; 2],
    ) -> Vec<Vec<InputJump>> {
        let of = |input: &Input| InputJump { signal: input.order.signal, derivatives: Vec::new() };
        let mut found: Vec<Vec<InputJump>> =
            self.agents.iter().map(|own| own.inputs.iter().map(of).collect()).collect();
        self.propagate(closed_loop, t_s, x, heard, &mut |[agent, input], jumps| {
            found[agent][input].derivatives.push(jumps.to_vec());
        });
        found
    }

    /// Goes from order to order and hands the jumps of every input to `each`, by its agent and its number, up to the order of the input.
    fn propagate(
        &mut self,
        closed_loop: &mut ClosedLoop<'_>,
        t_s: f64,
        x: &[f64],
        [before, after]: [&Heard; 2],
        each: &mut dyn FnMut([usize; 2], &[f64]),
    ) {
        self.evaluate(closed_loop, t_s, [(x, before), (x, after)]);
        let difference = |[a, b]: &[Vec<f64>; 2]| a.iter().zip(b).map(|(a, b)| b - a).collect::<Vec<f64>>();
        let mut rates = difference(&self.dx);
        let mut inputs = difference(&self.u);
        for k in 0.. {
            self.found(k, &inputs, each);
            let direction = self.direction(k + 1, &rates);
            if direction.iter().all(|d| *d == 0.0) && self.orders.iter().flatten().all(|order| *order <= k) {
                break;
            }
            (rates, inputs) = self.derivative(closed_loop, t_s, (x, before), &direction);
        }
    }

    /// Takes note of the `jumps` of the derivatives of order `k` of all inputs.
    fn found(&mut self, k: usize, jumps: &[f64], each: &mut dyn FnMut([usize; 2], &[f64])) {
        for (agent, own) in self.agents.iter_mut().enumerate() {
            for (number, Input { order, at, .. }) in own.inputs.iter_mut().enumerate() {
                let own = &jumps[at.clone()];
                if own.iter().any(|jump| *jump != 0.0) {
                    order.order = Some(order.order.map_or(k, |known| known.min(k)));
                }
                if order.order.is_some_and(|order| k <= order) {
                    each([agent, number], own);
                }
            }
        }
    }

    /// The jumps of the k-th derivatives of the entries of order `k`, from those of the (k − 1)-th derivatives of all `rates`; zero elsewhere.
    fn direction(&mut self, k: usize, rates: &[f64]) -> Vec<f64> {
        let mut direction = vec![0.0; rates.len()];
        for state in self.agents.iter().flat_map(|own| &own.states).copied() {
            let order = &mut self.orders[state];
            if rates[state] != 0.0 && order.is_none_or(|known| k < known) {
                *order = Some(k);
            }
            if *order == Some(k) {
                direction[state] = rates[state];
            }
        }
        direction
    }

    /// Derivatives of rates and inputs along a direction; every agent moves by as much as its own entries allow.
    fn derivative(
        &mut self,
        closed_loop: &mut ClosedLoop<'_>,
        t_s: f64,
        (x, heard): (&[f64], &Heard),
        direction: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let step = |own: &Own| -> f64 {
            let of = |state: &usize| STEP * (1.0 + x[*state].abs()) / direction[*state].abs();
            let least =
                own.states.iter().filter(|state| direction[**state] != 0.0).map(of).fold(f64::INFINITY, f64::min);
            if least.is_finite() { least } else { 1.0 }
        };
        let steps: Vec<f64> = self.agents.iter().map(step).collect();
        let [wide, narrow] = [1.0, 0.5].map(|part| {
            let [mut below, mut above] = [x.to_vec(), x.to_vec()];
            for (own, step) in self.agents.iter().zip(&steps) {
                for state in own.states.iter().copied() {
                    below[state] -= part * step * direction[state];
                    above[state] += part * step * direction[state];
                }
            }
            self.evaluate(closed_loop, t_s, [(&below, heard), (&above, heard)]);
            let (mut rates, mut inputs) = (vec![0.0; x.len()], vec![0.0; self.u[0].len()]);
            for (own, step) in self.agents.iter().zip(&steps) {
                let of = |[a, b]: &[Vec<f64>; 2], at: usize| (b[at] - a[at]) / (2.0 * part * step);
                own.states.iter().for_each(|state| rates[*state] = of(&self.dx, *state));
                let entries = own.inputs.iter().flat_map(|input| input.at.clone());
                entries.for_each(|at| inputs[at] = of(&self.u, at));
            }
            (rates, inputs)
        });
        let extrapolated = |wide: &[f64], narrow: &[f64]| -> Vec<f64> {
            wide.iter().zip(narrow).map(|(wide, narrow)| narrow + (narrow - wide) / 3.0).collect()
        };
        (extrapolated(&wide.0, &narrow.0), extrapolated(&wide.1, &narrow.1))
    }

    /// Rates and inputs in two states.
    fn evaluate(&mut self, closed_loop: &mut ClosedLoop<'_>, t_s: f64, at: [(&[f64], &Heard); 2]) {
        for (side, (x, heard)) in at.into_iter().enumerate() {
            closed_loop.rates_inside(t_s, x, heard, &mut self.dx[side]);
            let (agents, u) = (&self.agents, &mut self.u[side]);
            closed_loop.record(t_s, x, heard, |agent, row| {
                for Input { row: of_row, at, .. } in agents.get(agent).iter().flat_map(|own| &own.inputs) {
                    u[at.clone()].copy_from_slice(&row[of_row.clone()]);
                }
            });
        }
    }
}

/// Numbers in [−1, 1] that have nothing to do with each other.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
