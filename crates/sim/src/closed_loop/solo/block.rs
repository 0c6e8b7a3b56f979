//! What the closed loop asks of one agent by itself.

use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::agent::VelocityFilter;
use forwardstep_core::controller::{JetsBuffer, Singularity};
use forwardstep_core::sampled::{self, Recipe, Sampled, StartState};
use forwardstep_core::signal::Block;

use super::{Layout, Solo, Target};
use crate::closed_loop::columns::{Columns, Inputs};
use crate::closed_loop::error::SetupError;
use crate::closed_loop::injected::{Energy, Tracing};
use crate::closed_loop::pair::{Lengths, Outside};
use crate::closed_loop::recipes::used;
use crate::closed_loop::sampler::Digital;
use crate::recording::{GainRates, Signal};
use crate::setup::{AgentSetup, Control, Setup, VelocitySensor};
use crate::trajectory::Pieces;

impl Columns for Solo {
    fn state_len(&self) -> usize {
        self.layout.controller_end() + usize::from(self.layout.balance)
    }

    // Its state begins with what is measured.
    fn message(&self) -> usize {
        0
    }

    fn append_start(&self, agents: &[AgentSetup], x: &mut Vec<f64>) {
        let first = x.len();
        let own = &agents[self.agent];
        let start = &own.start;
        x.extend(start.q.iter().chain(&start.dq).chain(&start.rest));
        x.extend(own.interface().into_iter().flat_map(|interface| interface.actuator_start));
        x.resize(first + self.state_len(), 0.0);
        if let Some(target) = self.target.as_ref().filter(|target| target.is_offset) {
            let Layout { m, velocities, .. } = self.layout;
            let mut jets = JetsBuffer::new(m, 0);
            target.trajectory.jets(0.0, &mut jets);
            for (k, jet) in jets.jets().iter().enumerate() {
                x[first + k] -= jet[0];
                if velocities == m {
                    x[first + m + k] -= jet[1];
                }
            }
        }
    }

    fn start(&mut self, agents: &[AgentSetup], x: &mut [f64], degree: &[f64], sums: &[f64]) -> Result<(), LengthError> {
        let (plant, end) = (self.layout.plant, self.layout.controller_end());
        self.pair.settle(&mut x[..plant]);
        self.look(0.0, x)?;
        let outside = Outside { degree, sums, jets: self.now.jets.jets(), time_s: 0.0 };
        self.pair.start(&self.now.output, outside, &agents[self.agent].start.reference, &mut x[plant..end])
    }

    fn rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) {
        let checked = self.try_rates(t_s, x, inputs, dx);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the agent is built");
        if checked.is_err() {
            dx.fill(f64::NAN);
        }
    }

    fn record(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, write: &mut dyn FnMut(usize, &[f64])) {
        let checked = self.try_record(t_s, x, inputs);
        debug_assert_eq!(checked, Ok(()), "lengths are fixed when the agent is built");
        write(self.agent, &self.row);
    }

    fn motion(&mut self, _: usize, t_s: f64, x: &[f64], q: &mut [f64], dq: &mut [f64]) {
        let looked = self.look(t_s, x);
        debug_assert_eq!(looked, Ok(()), "lengths are fixed when the agent is built");
        // A velocity is the second block of the state, if it is one.
        for (own, value) in q.iter_mut().chain(dq).zip(&self.now.state) {
            *own = *value;
        }
    }

    fn sense(&mut self, t_s: f64, x: &[f64], sent: &mut [f64]) {
        let looked = self.look(t_s, x);
        debug_assert_eq!(looked, Ok(()), "lengths are fixed when the agent is built");
        if let Some(digital) = &mut self.digital {
            digital.sense(t_s, &self.now.output, sent);
        }
        if let Some(tracing) = &mut self.tracing {
            tracing.exact.copy_from_slice(&self.now.output);
        }
    }

    fn recipes(&self, setup: &Setup, x: &[f64]) -> Result<Vec<(usize, Recipe)>, SetupError> {
        let Layout { plant, torque: (_, torques), .. } = self.layout;
        let mut recipe = self.pair.recipe();
        recipe.transmits = setup.exchange.words().len();
        recipe.start = StartState::State(x[plant..self.layout.controller_end()].to_vec());
        recipe.target = self.target.as_ref().map(|Target { trajectory, is_offset }| {
            let motion = Arc::new(trajectory.trajectory().clone());
            if *is_offset { sampled::Target::Offset(motion) } else { sampled::Target::Follow(motion) }
        });
        Ok(vec![(self.agent, used(recipe, setup, self.agent, torques)?)])
    }

    fn sample(&mut self, control: &Control, controllers: Vec<Box<dyn Sampled>>) {
        let controller = controllers.into_iter().next();
        self.digital = controller.map(|controller| Digital::new(control, self.agent, &self.pair.outputs(), controller));
        self.shown = self.pair.shown();
    }

    fn command(&mut self, now_s: f64, inputs: Inputs<'_>, x: &mut [f64]) {
        let (plant, end) = (self.layout.plant, self.layout.controller_end());
        let Some(digital) = &mut self.digital else { return };
        digital.command(now_s, inputs.degree[0], inputs.sums);
        let controller = digital.controller();
        x[plant..end].copy_from_slice(controller.state());
        let mut first = 0;
        for (signal, count) in &self.shown {
            if let Some(values) = controller.diagnostics(*signal) {
                self.now.shown[first..first + count].copy_from_slice(values);
            }
            first += count;
        }
        let traced = self.trace_command(now_s, &x[plant..end], inputs);
        debug_assert_eq!(traced, Ok(()), "lengths are fixed when the agent is built");
    }

    fn trace(&mut self, control: &Control) {
        // A chain of order one has no velocity, though its controller would read one.
        let reads =
            self.pair.reads(Signal::Velocity) && self.pair.outputs().contains(&(Signal::Velocity, self.layout.m));
        let filtered = match control.sensors.velocity {
            VelocitySensor::Filtered { cut_off_hz } if reads => Some(cut_off_hz),
            VelocitySensor::Filtered { .. } | VelocitySensor::Measured => None,
        };
        let filter = filtered.and_then(|hz| VelocityFilter::new(core::f64::consts::TAU * hz, self.layout.m).ok());
        self.tracing = Some(Tracing::new(filter, Lengths::of(&*self.pair)));
    }

    fn energies(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, each: &mut dyn FnMut(usize, Energy)) {
        let energy = self.try_energy(t_s, x, inputs);
        debug_assert!(energy.is_ok(), "lengths are fixed when the agent is built");
        if let Ok(Some(energy)) = energy {
            each(self.agent, energy);
        }
    }

    fn taken(&self, each: &mut dyn FnMut(&Digital)) {
        self.digital.iter().for_each(each);
    }

    fn apply(&mut self) {
        if let Some(digital) = &mut self.digital {
            digital.apply();
        }
        if let Some(tracing) = &mut self.tracing {
            tracing.applied();
        }
    }

    fn hold(&mut self, commands: &[f64]) {
        if let Some(digital) = &mut self.digital {
            digital.hold(commands);
        }
    }

    fn settle(&mut self, x: &mut [f64]) {
        let Layout { plant, .. } = self.layout;
        self.pair.settle(&mut x[..plant]);
        if self.digital.is_none() {
            self.pair.settle_controller(&mut x[plant..plant + self.layout.controller]);
        }
    }

    fn trouble(&mut self, x: &[f64]) -> Option<(usize, Singularity)> {
        // A safe command stands where the law fails.
        if self.digital.as_ref().is_some_and(|digital| digital.failures().0) {
            self.divisor.1 = None;
            return None;
        }
        let own = &x[self.layout.plant..self.layout.controller_end()];
        let close = self.pair.trouble(own, &self.now.shown);
        // What changed its sign was zero in between, where it is not evaluated.
        let (place, before) = self.divisor;
        let now = place.and_then(|place| self.now.shown.get(place)).copied();
        self.divisor.1 = now;
        let passed = before.zip(now).is_some_and(|(before, now)| before * now < 0.0);
        let at_zero = || {
            let mut shown = self.now.shown.clone();
            *shown.get_mut(place?)? = 0.0;
            self.pair.trouble(own, &shown)
        };
        let trouble = if passed { close.or_else(at_zero) } else { close };
        trouble.map(|trouble| (self.agent, trouble))
    }

    fn next_event_s(&self, after_s: f64) -> f64 {
        self.target.as_ref().map_or(f64::INFINITY, |target| target.trajectory.next_kink_s(after_s))
    }

    fn pass_kink(&mut self, until_s: f64, x: &mut [f64]) {
        let Layout { m, velocities, .. } = self.layout;
        let (Some(target), jets) = (&mut self.target, &mut self.now.jets) else { return };
        // The velocity of what moves with an offset is the agent's less the offset's, which jumps.
        let jump_s = target.trajectory.next_jump_s(until_s).filter(|_| target.is_offset && velocities == m);
        let mut add = |pieces: &Pieces, sign: f64| {
            if let Some(jump_s) = jump_s {
                pieces.jets(jump_s, jets);
                x[m..].iter_mut().zip(jets.jets()).for_each(|(velocity, jet)| *velocity += sign * jet[1]);
            }
        };
        add(&target.trajectory, 1.0);
        target.trajectory.pass(until_s);
        add(&target.trajectory, -1.0);
    }

    // Set-valued signs stand in the reference dynamics of (6)–(7) alone.
    fn selection(&self) -> Option<Range<usize>> {
        None
    }

    /// q̈, of one that leads.
    fn transmit(&mut self, _: f64, dx: &[f64], transmitted: &mut [f64]) {
        let Layout { m, velocities, .. } = self.layout;
        if velocities == m {
            transmitted.copy_from_slice(&dx[m..2 * m]);
        }
    }

    fn argument(&mut self, _: &[f64], _: Inputs<'_>, _: [&[f64]; 2], _: &mut [f64]) {}

    fn add_sign_terms(&mut self, _: &[f64], _: &mut [f64]) {}

    fn signals(&self) -> Vec<(Signal, usize)> {
        let axes = |(signal, count)| (0..count).map(move |axis| (signal, axis));
        self.all_signals().into_iter().flat_map(axes).collect()
    }

    fn inputs(&self) -> Vec<(Signal, Range<usize>)> {
        let mut at = self.layout.plant;
        let place = |(signal, count): Block| {
            let first = at;
            at += count;
            (signal, first..at)
        };
        self.pair.inputs().into_iter().map(place).collect()
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let mut first = 0;
        for (signal, count) in self.pair.states().into_iter().flatten() {
            if state < first + count {
                return (self.agent, signal, state - first);
            }
            first += count;
        }
        (self.agent, Signal::Dissipation, 0)
    }

    fn gain_rates(&mut self, _: usize, _: &[f64]) -> Option<GainRates> {
        None
    }
}
