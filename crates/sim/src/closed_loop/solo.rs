//! One agent by itself: any [`Plant`] under any [`Controller`], as a block of the closed loop.
//!
//! Its state is
//!
//! ```text
//! plant's state   controller's state   ∫ dissipation [1, if the balance is on]
//! ```
//!
//! and everything that is particular to a system is said by the two traits. An agent with an offset d(t) is described
//! relative to it: what stands in the block and what is sent is x − d, followed by ẋ − ḋ where there is a velocity, so that
//! agents with offsets agree like any others. The plant and the controller see x and ẋ.
//!
//! Under digital control the plant's state flows and everything else stands still between two samples, when it jumps.

use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::LengthError;
use forwardstep_core::agent::VelocityFilter;
use forwardstep_core::controller::{Asked, Controller, Given, Jet, Trouble, Truth};
use forwardstep_core::plant::{Plant, total};
use forwardstep_core::reference::Heard;
use forwardstep_core::sampled::{self, Recipe, Sampled, StartState};
use forwardstep_core::signal::Block;

use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::injected::{Energy, Outside, Pair, Tracing};
use super::recipes::used;
use super::sampler::Digital;
use crate::recording::{GainRates, Signal};
use crate::setup::{AgentSetup, Control, Setup, VelocitySensor};
use crate::trajectory::Pieces;

/// A plant and its controller.
pub(crate) struct Solo<C: Controller> {
    agent: usize,
    plant: C::Plant,
    controller: C,
    target: Option<Target>,
    effort_limits: Option<Vec<f64>>,
    digital: Option<Digital>,
    /// What commands came from, where that is asked for.
    tracing: Option<Tracing>,
    layout: Layout,
    plant_scratch: <C::Plant as Plant>::Scratch,
    scratch: C::Scratch,
    now: Now,
    /// What the controller shows, when control is digital.
    shown: Vec<Block>,
    row: Vec<f64>,
}

/// What a trajectory means to an agent.
pub(crate) struct Target {
    /// The trajectory.
    pub(crate) trajectory: Pieces,
    /// It is an offset from where all agree; otherwise it is to be followed.
    pub(crate) is_offset: bool,
}

/// Sizes of the block.
#[derive(Clone, Copy)]
struct Layout {
    /// m.
    m: usize,
    /// A velocity of so many numbers follows the position; zero for none.
    velocities: usize,
    plant: usize,
    controller: usize,
    balance: bool,
    /// Where the torques stand in the input, and how many they are.
    torque: (usize, usize),
}

impl Layout {
    fn controller_end(&self) -> usize {
        self.plant + self.controller
    }
}

/// Everything about the instant at hand.
struct Now {
    jets: Vec<Jet>,
    state: Vec<f64>,
    output: Vec<f64>,
    input: Vec<f64>,
    shown: Vec<f64>,
    d_controller: Vec<f64>,
}

impl<C: Controller> Solo<C> {
    /// The agent number `agent`. What a held input does is not what the balance balances, so there is none where it will be
    /// `sampled`.
    pub(crate) fn new(
        agent: usize,
        plant: C::Plant,
        controller: C,
        target: Option<Target>,
        effort_limits: Option<Vec<f64>>,
        sampled: bool,
        balance: bool,
    ) -> Self {
        let (states, inputs) = (plant.states(), plant.inputs());
        let torque = inputs.iter().position(|(signal, _)| *signal == Signal::Torque);
        let layout = Layout {
            m: plant.axes(),
            velocities: states.get(1).filter(|(signal, _)| *signal == Signal::Velocity).map_or(0, |(_, count)| *count),
            plant: total(&states),
            controller: total(&controller.states()),
            balance: balance && !sampled,
            torque: torque.map_or((0, 0), |at| (total(&inputs[..at]), inputs[at].1)),
        };
        let input = total(&inputs);
        let now = Now {
            jets: vec![[0.0; 5]; target.as_ref().map_or(0, |target| target.trajectory.axes())],
            state: vec![0.0; layout.plant],
            output: vec![0.0; plant.output_len()],
            input: vec![0.0; input],
            shown: vec![0.0; total(&controller.shown())],
            d_controller: vec![0.0; layout.controller],
        };
        Solo {
            agent,
            plant_scratch: plant.scratch(),
            scratch: controller.scratch(),
            plant,
            controller,
            target,
            effort_limits,
            digital: None,
            tracing: None,
            layout,
            now,
            shown: Vec::new(),
            row: Vec::new(),
        }
    }

    fn is_offset(&self) -> bool {
        self.target.as_ref().is_some_and(|target| target.is_offset)
    }

    /// The target, the plant's state and what sensors could see at `t_s`.
    fn look(&mut self, t_s: f64, x: &[f64]) -> Result<(), LengthError> {
        let Layout { m, velocities, plant, .. } = self.layout;
        if let Some(target) = &self.target {
            target.trajectory.jets(t_s, &mut self.now.jets);
        }
        self.now.state.copy_from_slice(&x[..plant]);
        if self.is_offset() {
            for (k, jet) in self.now.jets.iter().enumerate().take(m) {
                self.now.state[k] += jet[0];
                if velocities == m {
                    self.now.state[m + k] += jet[1];
                }
            }
        }
        self.plant.output(&mut self.plant_scratch, &self.now.state, &mut self.now.output)
    }

    /// The input that reaches the plant, what is shown, and the rate of the controller's state.
    fn control(&mut self, x: &[f64], inputs: Inputs<'_>) -> Result<(), LengthError> {
        let Layout { m, plant, .. } = self.layout;
        let Now { jets, state, output, input, shown, d_controller } = &mut self.now;
        if let Some(digital) = &self.digital {
            input.copy_from_slice(digital.held());
            d_controller.fill(0.0);
        } else {
            let own = &x[plant..self.layout.controller_end()];
            let heard = Heard::new(inputs.degree, inputs.sums, m)?;
            let given = Given { measured: self.controller.see(output)?, heard, target: jets };
            self.controller.evaluate(&mut self.scratch, given, own, Asked { input, d_state: d_controller, shown })?;
        }
        let (first, count) = self.layout.torque;
        for (torque, limit) in input[first..first + count].iter_mut().zip(self.effort_limits.iter().flatten()) {
            *torque = torque.clamp(-limit, *limit);
        }
        self.plant.limit(state, input);
        Ok(())
    }

    fn try_rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) -> Result<(), LengthError> {
        self.look(t_s, x)?;
        self.control(x, inputs)?;
        let Layout { m, velocities, plant, .. } = self.layout;
        let end = self.layout.controller_end();
        let external = inputs.external.unwrap_or_default();
        self.plant.rate(&mut self.plant_scratch, &self.now.state, &self.now.input, external, &mut dx[..plant])?;
        if self.is_offset() {
            for (k, jet) in self.now.jets.iter().enumerate().take(m) {
                dx[k] -= jet[1];
                if velocities == m {
                    dx[m + k] -= jet[2];
                }
            }
        }
        dx[plant..end].copy_from_slice(&self.now.d_controller);
        if self.layout.balance {
            dx[end] = self.balance(x, inputs)?.1;
        }
        Ok(())
    }

    /// V and what it loses; needs what [`Solo::control`] left.
    fn balance(&mut self, x: &[f64], inputs: Inputs<'_>) -> Result<(f64, f64), LengthError> {
        let Layout { m, plant, .. } = self.layout;
        let own = &x[plant..self.layout.controller_end()];
        let heard = Heard::new(inputs.degree, inputs.sums, m)?;
        let given = Given { measured: self.controller.see(&self.now.output)?, heard, target: &self.now.jets };
        let truth = Truth { plant: &self.plant, state: &self.now.state, external: inputs.external.unwrap_or_default() };
        let balance = self.controller.balance(&mut self.scratch, truth, given, own, &self.now.shown)?;
        Ok((balance.value, balance.dissipation))
    }

    fn try_record(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>) -> Result<(), LengthError> {
        self.look(t_s, x)?;
        self.plant.settle(&mut self.now.state);
        self.control(x, inputs)?;
        let (value, _) = self.balance(x, inputs)?;
        self.row.clear();
        self.row.extend_from_slice(&self.now.state);
        self.row.extend_from_slice(&self.now.input);
        self.row.extend_from_slice(&self.now.shown);
        if self.is_offset() {
            self.row.extend(self.now.jets.iter().map(|jet| jet[0]));
        }
        self.row.push(value);
        if self.layout.balance {
            self.row.push(x[self.layout.controller_end()]);
        }
        Ok(())
    }

    /// Traces the command of a sample that has just been taken, if that is asked for.
    fn trace_command(&mut self, now_s: f64, own: &[f64], inputs: Inputs<'_>) -> Result<(), LengthError> {
        let (Some(tracing), Some(digital)) = (&mut self.tracing, &self.digital) else { return Ok(()) };
        let mut jets = self.now.jets.clone();
        if let Some(target) = &self.target {
            target.trajectory.trajectory().jets(now_s, &mut jets);
        }
        let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: &jets };
        let mut pair = Pair {
            plant: &self.plant,
            controller: &self.controller,
            plant_scratch: &mut self.plant_scratch,
            scratch: &mut self.scratch,
            lengths: [self.now.input.len(), self.now.shown.len(), self.layout.controller],
        };
        tracing.sampled(&mut pair, now_s, own, digital.output(), outside, self.layout.m)
    }

    fn try_energy(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>) -> Result<Option<Energy>, LengthError> {
        if self.tracing.is_none() {
            return Ok(None);
        }
        self.look(t_s, x)?;
        self.control(x, inputs)?;
        let Some(tracing) = &self.tracing else { return Ok(None) };
        let own = &x[self.layout.plant..self.layout.controller_end()];
        let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: &self.now.jets };
        let mut pair = Pair {
            plant: &self.plant,
            controller: &self.controller,
            plant_scratch: &mut self.plant_scratch,
            scratch: &mut self.scratch,
            lengths: [self.now.input.len(), self.now.shown.len(), self.layout.controller],
        };
        let acting = [&self.now.input[..], inputs.external.unwrap_or_default()];
        tracing.energy(&mut pair, [&self.now.state, own], outside, acting).map(Some)
    }

    fn all_signals(&self) -> Vec<Block> {
        let mut blocks = self.plant.states();
        blocks.extend(self.plant.inputs());
        blocks.extend(self.controller.shown());
        if self.is_offset() {
            blocks.push((Signal::Offset, self.layout.m));
        }
        blocks.push((Signal::Lyapunov, 1));
        if self.layout.balance {
            blocks.push((Signal::Dissipation, 1));
        }
        blocks
    }
}

impl<C: Controller> Columns for Solo<C> {
    fn state_len(&self) -> usize {
        self.layout.controller_end() + usize::from(self.layout.balance)
    }

    fn append_start(&self, agents: &[AgentSetup], x: &mut Vec<f64>) {
        let first = x.len();
        let start = &agents[self.agent].start;
        x.extend(start.q.iter().chain(&start.dq).chain(&start.rest));
        x.resize(first + self.state_len(), 0.0);
        if let Some(target) = self.target.as_ref().filter(|target| target.is_offset) {
            let Layout { m, velocities, .. } = self.layout;
            let mut jets = vec![[0.0; 5]; m];
            target.trajectory.jets(0.0, &mut jets);
            for (k, jet) in jets.iter().enumerate() {
                x[first + k] -= jet[0];
                if velocities == m {
                    x[first + m + k] -= jet[1];
                }
            }
        }
    }

    fn start(&mut self, agents: &[AgentSetup], x: &mut [f64], degree: &[f64], sums: &[f64]) -> Result<(), LengthError> {
        let Layout { m, plant, .. } = self.layout;
        self.plant.settle(&mut x[..plant]);
        self.look(0.0, x)?;
        let heard = Heard::new(degree, sums, m)?;
        let given = Given { measured: self.controller.see(&self.now.output)?, heard, target: &self.now.jets };
        let own = &mut x[plant..plant + self.layout.controller];
        self.controller.start(&mut self.scratch, given, &agents[self.agent].start.reference, own)
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
        let mut recipe = Recipe::feedback(&self.plant, self.controller.clone());
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
        self.digital =
            controller.map(|controller| Digital::new(control, self.agent, &self.plant.outputs(), controller));
        self.shown = self.controller.shown();
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
        let filtered = match control.sensors.velocity {
            VelocitySensor::Filtered { cut_off_hz } if self.controller.reads(Signal::Velocity) => Some(cut_off_hz),
            VelocitySensor::Filtered { .. } | VelocitySensor::Measured => None,
        };
        let filter = filtered.and_then(|hz| VelocityFilter::new(core::f64::consts::TAU * hz, self.layout.m).ok());
        self.tracing = Some(Tracing::new(filter, self.now.output.len(), self.now.input.len()));
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
        self.plant.settle(&mut x[..plant]);
        if self.digital.is_none() {
            self.controller.settle(&mut x[plant..plant + self.layout.controller]);
        }
    }

    fn trouble(&self, x: &[f64]) -> Option<(usize, Trouble)> {
        // A safe command stands where the law fails.
        if self.digital.as_ref().is_some_and(|digital| digital.failures().0) {
            return None;
        }
        let own = &x[self.layout.plant..self.layout.controller_end()];
        self.controller.trouble(own, &self.now.shown).map(|trouble| (self.agent, trouble))
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
                x[m..].iter_mut().zip(jets.iter()).for_each(|(velocity, jet)| *velocity += sign * jet[1]);
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
    fn tell(&mut self, _: f64, dx: &[f64], told: &mut [f64]) {
        let Layout { m, velocities, .. } = self.layout;
        if velocities == m {
            told.copy_from_slice(&dx[m..2 * m]);
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
        self.plant.inputs().into_iter().map(place).collect()
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let mut first = 0;
        for (signal, count) in self.plant.states().into_iter().chain(self.controller.states()) {
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
