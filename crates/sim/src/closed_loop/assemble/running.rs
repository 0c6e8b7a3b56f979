//! The closed loop as the engine runs it: its right-hand side, its events and its rows.

use super::ClosedLoop;
use crate::closed_loop::frictions::Frictions;
use crate::closed_loop::sampling::Sampling;
use crate::closed_loop::sliding::Slider;
use crate::engine::{DelaySystem, EventOutcome, Heard, Port};

impl ClosedLoop<'_> {
    /// The rates of the state `x` at an instant inside the last step; what its end needs stays as it is.
    pub(crate) fn rates_inside(&mut self, t_s: f64, x: &[f64], heard: &Heard, dx: &mut [f64]) {
        self.pushes.evaluate(t_s, x, &mut self.blocks);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, self.pushes.external());
            block.columns.rates(t_s, &x[block.state.clone()], inputs, &mut dx[block.state.clone()]);
        }
        if let Some(slider) = &mut self.slider {
            slider.add_sign_terms(t_s, (heard, self.pushes.external()), &mut self.blocks, x, dx);
        }
    }

    /// Works out what acts on all agents from outside, for [`ClosedLoop::external_on`].
    pub(crate) fn push(&mut self, t_s: f64, x: &[f64]) {
        self.pushes.evaluate(t_s, x, &mut self.blocks);
    }

    /// What acts on an agent as it was worked out last; empty when it is never pushed.
    pub(crate) fn external_on(&self, agent: usize) -> &[f64] {
        self.pushes.external_on(agent)
    }

    /// Hands every agent's signals at one instant to `write`.
    pub(crate) fn record(&mut self, t_s: f64, x: &[f64], heard: &Heard, mut write: impl FnMut(usize, &[f64])) {
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        self.pushes.evaluate(t_s, x, &mut self.blocks);
        if let Some(slider) = &mut self.slider {
            slider.look(t_s, heard, self.pushes.external(), &mut self.blocks, x);
        }
        let (pushes, row) = (&self.pushes, &mut self.row);
        let leads = self.driven.as_ref().map(|driven| driven.agent);
        let (leader, axes) = (self.leader, self.axes);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, pushes.external());
            let (columns, state) = (&mut block.columns, &x[block.state.clone()]);
            columns.record(t_s, state, inputs, &mut |agent, values| {
                let leader = leader.filter(|_| Some(agent) != leads);
                match (pushes.external_on(agent), leader) {
                    ([], None) => write(agent, values),
                    (external, leader) => {
                        row.clear();
                        row.extend_from_slice(values);
                        row.extend_from_slice(external);
                        if let Some(Port { state, stride, .. }) = leader {
                            // Positions are an agent's first values.
                            let positions = values.iter().take(axes).enumerate();
                            row.extend(positions.map(|(axis, q)| q - x[state + axis * stride]));
                        }
                        write(agent, row);
                    }
                }
            });
        }
    }
}

impl DelaySystem for ClosedLoop<'_> {
    fn rates(&mut self, t_s: f64, x: &[f64], heard: &Heard, dx: &mut [f64]) {
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        self.pushes.evaluate(t_s, x, &mut self.blocks);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, self.pushes.external());
            block.columns.rates(t_s, &x[block.state.clone()], inputs, &mut dx[block.state.clone()]);
        }
        if let Some(slider) = &mut self.slider {
            slider.add_sign_terms(t_s, (heard, self.pushes.external()), &mut self.blocks, x, dx);
        }
        if let (Some(driven), Some(port)) = (&mut self.driven, self.leader) {
            driven.evaluated(t_s, &dx[port.state..]);
        }
    }

    fn settle(&mut self, x: &mut [f64]) {
        for block in &mut self.blocks {
            block.columns.settle(&mut x[block.state.clone()]);
        }
    }

    fn next_event_s(&self) -> f64 {
        let sample_s = self.sampling.as_ref().map_or(f64::INFINITY, Sampling::next_s);
        let set_s = self.slider.as_ref().map_or(f64::INFINITY, Slider::next_s);
        let rubs_s = self.frictions.as_ref().map_or(f64::INFINITY, Frictions::next_s);
        sample_s.min(self.pushes.next_event_s()).min(self.kink_s).min(set_s).min(rubs_s)
    }

    fn happen(&mut self, until_s: f64, x: &mut [f64], heard: &Heard, network: EventOutcome) -> EventOutcome {
        let mut happened = self.pushes.happen(until_s);
        if self.kink_s <= until_s {
            for block in &mut self.blocks {
                block.columns.pass_kink(until_s, &mut x[block.state.clone()]);
            }
            self.kink_s = self.next_kink_s(until_s);
            happened = EventOutcome::Jumped;
        }
        if let Some(slider) = &mut self.slider {
            if slider.next_s() <= until_s {
                self.pushes.evaluate(until_s, x, &mut self.blocks);
            }
            happened = happened.max(slider.happen(until_s, heard, self.pushes.external(), &mut self.blocks, x));
        }
        if let Some(sampling) = &mut self.sampling {
            happened = happened.max(sampling.happen(until_s, &mut self.blocks, x));
        }
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        if let Some(frictions) = &mut self.frictions
            && (frictions.next_s() <= until_s || happened.max(network) > EventOutcome::Nothing)
        {
            frictions.set(until_s, heard, &mut self.pushes, &mut self.blocks, x);
            happened = happened.max(EventOutcome::Sampled);
        }
        happened
    }
}
