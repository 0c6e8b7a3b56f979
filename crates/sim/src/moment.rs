//! Agents at the rows of a run in continuous time, with their rates and what they hear: what identities are evaluated from.

use crate::closed_loop::ClosedLoop;
use crate::engine::{Integrator, Port, Step};
use crate::recording::Signal;
use crate::setup::Setup;
use crate::simulate::Rows;

/// One agent at one instant. All agents of an instant come in order.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Index of the agent.
    pub agent: usize,
    /// The instant, s.
    pub t_s: f64,
    /// Its signals, as [`crate::recorded_columns`] lists them.
    pub values: &'a [f64],
    /// What is integrated of it. An agent with an offset is described relative to it.
    pub states: &'a [StateRate],
    /// The same of all agents at this instant.
    pub agents: &'a [Vec<StateRate>],
    /// Σ_j w_ij.
    pub degree: f64,
    /// Σ_j w_ij times the messages of its neighbours, as they arrive now: an entry per axis of q_j, then of q̇_j if velocities are sent.
    /// Under a nonlinear coupling φ it is q_i − φ(q_i − q_j) that is added up.
    pub sums: &'a [f64],
}

/// An entry of what is integrated, with its derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateRate {
    /// What it is. States of reference dynamics count as [`Signal::Reference`] one after the other, the integrated variable of (3) and
    /// (119) too.
    pub signal: Signal,
    /// Its entry.
    pub entry: usize,
    /// Its value.
    pub value: f64,
    /// d/dt of it.
    pub rate: f64,
}

/// Shows moments as steps go by.
pub(crate) struct Moments {
    rows: Rows,
    entries: usize,
    /// What each agent is made of, and its states by their index.
    agents: Vec<(Port, Vec<usize>)>,
    states: Vec<Vec<StateRate>>,
    values: Vec<Vec<f64>>,
    sums: Vec<f64>,
    dx: Vec<f64>,
}

impl Moments {
    pub(crate) fn new(setup: &Setup, closed_loop: &ClosedLoop<'_>) -> Self {
        let (ports, entries) = closed_loop.ports();
        let count = setup.agents.len();
        let mut agents: Vec<(Port, Vec<usize>)> =
            ports.into_iter().take(count).map(|port| (port, Vec::new())).collect();
        let mut states = vec![Vec::new(); count];
        let len = closed_loop.start().len();
        for state in 0..len {
            let (agent, signal, entry) = closed_loop.locate(state);
            // The motion of a leader is no agent's.
            if let (Some((_, own)), Some(states)) = (agents.get_mut(agent), states.get_mut(agent)) {
                own.push(state);
                states.push(StateRate { signal, entry, value: 0.0, rate: 0.0 });
            }
        }
        let (rows, sums, dx) = (Rows::new(setup.time.clone()), vec![0.0; entries], vec![0.0; len]);
        Moments { rows, entries, agents, states, values: vec![Vec::new(); count], sums, dx }
    }

    /// Shows the rows that fall into `step`, the last that was made.
    pub(crate) fn show(
        &mut self,
        integrator: &mut Integrator<'_>,
        closed_loop: &mut ClosedLoop<'_>,
        step: Step,
        each: &mut dyn FnMut(Moment<'_>),
    ) {
        if closed_loop.samples().is_some() {
            return;
        }
        while let Some(t_s) = self.rows.next_in(step) {
            let (x, heard) = integrator.look_inside(t_s);
            let values = &mut self.values;
            closed_loop.record(t_s, x, heard, |agent, row| {
                values[agent].clear();
                values[agent].extend_from_slice(row);
            });
            closed_loop.rates_inside(t_s, x, heard, &mut self.dx);
            for (states, (_, indices)) in self.states.iter_mut().zip(&self.agents) {
                for (state, index) in states.iter_mut().zip(indices) {
                    (state.value, state.rate) = (x[*index], self.dx[*index]);
                }
            }
            for (agent, (port, _)) in self.agents.iter().enumerate() {
                for c in 0..self.entries {
                    self.sums[c] = heard.sums[port.entry + c * port.stride];
                }
                let (values, states, sums) = (&self.values[agent], &self.states[agent], &self.sums);
                let (agents, degree) = (&self.states, heard.degree[port.degree]);
                each(Moment { agent, t_s, values, states, agents, degree, sums });
            }
        }
    }
}
