//! One agent by itself: any plant under any controller, as a block of the closed loop.
//!
//! Its state is
//!
//! ```text
//! plant's state   controller's state   ∫ dissipation [1, if the balance is on]
//! ```
//!
//! and everything that is particular to a system is said by its [`Pair`]. An agent with an offset d(t) is described
//! relative to it: what stands in the block and what is sent is x − d, followed by ẋ − ḋ where there is a velocity, so that
//! agents with offsets agree like any others. The plant and the controller see x and ẋ.
//!
//! Under digital control the plant's state flows and everything else stands still between two samples, when it jumps.

mod block;

use forwardstep_core::agent::Inbox;
use forwardstep_core::controller::{Balance, ControllerOutput, JetsBuffer};
use forwardstep_core::plant::total;
use forwardstep_core::signal::Block;
use forwardstep_core::{LengthError, Scalar};

use super::columns::Inputs;
use super::injected::{Energy, Tracing};
use super::pair::{Lengths, Outside, Pair};
use super::sampler::Digital;
use crate::recording::Signal;
use crate::trajectory::Pieces;

/// A plant and its controller.
pub(crate) struct Solo {
    agent: usize,
    pair: Box<dyn Pair>,
    target: Option<Target>,
    effort_limits: Option<Vec<f64>>,
    digital: Option<Digital>,
    /// What commands came from, where that is asked for.
    tracing: Option<Tracing>,
    layout: Layout,
    now: Now,
    /// What the controller shows, when control is digital.
    shown: Vec<Block>,
    /// Where what it divides by stands in what it shows, and its value after the last step.
    divisor: (Option<usize>, Option<f64>),
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
    /// The same in what the controller shows, where it shows what it asks of its actuators.
    shown_torque: (usize, usize),
}

impl Layout {
    fn controller_end(&self) -> usize {
        self.plant + self.controller
    }
}

/// Everything about the instant at hand.
struct Now {
    t_s: f64,
    jets: JetsBuffer,
    state: Vec<f64>,
    output: Vec<f64>,
    input: Vec<f64>,
    /// What the controller showed when it was evaluated last: at the last sample, when control is digital.
    shown: Vec<f64>,
    /// What a row shows of it.
    seen: Vec<f64>,
    /// What is asked of the actuators, before they limit it.
    asked: Vec<f64>,
    d_controller: Vec<f64>,
}

/// Where the numbers of a signal stand among blocks, and how many they are.
fn block_of(signal: Signal, blocks: &[Block]) -> Option<(usize, usize)> {
    let at = blocks.iter().position(|(own, _)| *own == signal)?;
    Some((total(&blocks[..at]), blocks[at].1))
}

/// Whether a signal is what a controller that samples went by at its last sample, and goes by until the next: what it commands, how fast its reference
/// moves, and what it takes parameters for. Others are of the plant's state.
fn stands(signal: Signal) -> bool {
    match signal {
        Signal::Reference(order) => order > 0,
        Signal::Estimate | Signal::AngularVelocityWanted => true,
        _ => false,
    }
}

impl Solo {
    /// The agent number `agent`. What a held input does is not what the balance balances, so there is none where it will be
    /// `sampled`.
    pub(super) fn new(
        agent: usize,
        pair: Box<dyn Pair>,
        target: Option<Target>,
        effort_limits: Option<Vec<f64>>,
        sampled: bool,
        balance: bool,
    ) -> Self {
        let ([states, _], shown, lengths) = (pair.states(), pair.shown(), Lengths::of(&*pair));
        let layout = Layout {
            m: pair.axes(),
            velocities: states.get(1).filter(|(signal, _)| *signal == Signal::Velocity).map_or(0, |(_, count)| *count),
            plant: total(&states),
            controller: lengths.controller,
            balance: balance && !sampled,
            torque: block_of(Signal::Torque, &pair.inputs()).unwrap_or_default(),
            shown_torque: block_of(Signal::Torque, &shown).unwrap_or_default(),
        };
        let now = Now {
            t_s: 0.0,
            jets: JetsBuffer::new(
                target.as_ref().map_or(0, |target| target.trajectory.axes()),
                pair.target_derivatives(),
            ),
            state: vec![0.0; layout.plant],
            output: vec![0.0; lengths.output],
            input: vec![0.0; lengths.input],
            shown: vec![0.0; lengths.shown],
            seen: vec![0.0; lengths.shown],
            asked: vec![0.0; lengths.input],
            d_controller: vec![0.0; lengths.controller],
        };
        let divisor = (block_of(Signal::Divisor, &shown).map(|(first, _)| first), None);
        let (digital, tracing, shown, row) = (None, None, Vec::new(), Vec::new());
        Solo { agent, pair, target, effort_limits, digital, tracing, layout, now, shown, divisor, row }
    }

    fn is_offset(&self) -> bool {
        self.target.as_ref().is_some_and(|target| target.is_offset)
    }

    /// The target, the plant's state and what sensors could see at `t_s`.
    fn look(&mut self, t_s: f64, x: &[f64]) -> Result<(), LengthError> {
        if let Some(target) = &self.target {
            target.trajectory.jets(t_s, &mut self.now.jets);
        }
        self.see(t_s, x)
    }

    /// The same without the target, unless the state is what is away from it.
    fn see(&mut self, t_s: f64, x: &[f64]) -> Result<(), LengthError> {
        let Layout { m, velocities, plant, .. } = self.layout;
        self.now.t_s = t_s;
        self.now.state.copy_from_slice(&x[..plant]);
        if self.is_offset() {
            for (k, jet) in self.now.jets.jets().iter().enumerate().take(m) {
                self.now.state[k] += jet[0];
                if velocities == m {
                    self.now.state[m + k] += jet[1];
                }
            }
        }
        self.pair.output(&self.now.state, &mut self.now.output)
    }

    /// The input that reaches the plant, what is shown, and the rate of the controller's state.
    fn control(&mut self, x: &[f64], inputs: Inputs<'_>) -> Result<(), LengthError> {
        let plant = self.layout.plant;
        let Now { t_s, jets, state, output, input, asked, shown, d_controller, .. } = &mut self.now;
        if let Some(digital) = &self.digital {
            input.copy_from_slice(digital.held());
            d_controller.fill(0.0);
        } else {
            let own = &x[plant..self.layout.controller_end()];
            let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: jets.jets(), time_s: *t_s };
            self.pair.evaluate(output, outside, own, ControllerOutput { input, d_state: d_controller, shown })?;
        }
        asked.copy_from_slice(input);
        let (first, count) = self.layout.torque;
        for (torque, limit) in input[first..first + count].iter_mut().zip(self.effort_limits.iter().flatten()) {
            *torque = torque.saturate(*limit);
        }
        self.pair.limit(state, input);
        Ok(())
    }

    fn try_rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]) -> Result<(), LengthError> {
        // Between samples a target moves neither the plant nor what is held.
        if self.digital.is_some() && !self.is_offset() {
            self.see(t_s, x)?;
        } else {
            self.look(t_s, x)?;
        }
        self.control(x, inputs)?;
        let Layout { m, velocities, plant, .. } = self.layout;
        let end = self.layout.controller_end();
        let external = inputs.external.unwrap_or_default();
        self.pair.rate(&self.now.state, [&self.now.input, external], &mut dx[..plant])?;
        if self.is_offset() {
            for (k, jet) in self.now.jets.jets().iter().enumerate().take(m) {
                dx[k] -= jet[1];
                if velocities == m {
                    dx[m + k] -= jet[2];
                }
            }
        }
        dx[plant..end].copy_from_slice(&self.now.d_controller);
        if self.layout.balance {
            dx[end] = self.balance(x, inputs, false)?.1;
        }
        Ok(())
    }

    /// What a row shows of the controller: of one that samples, what its law says of the state of the plant at that instant, with what it heard last
    /// and its own state as they stand since; and the torque that is applied. Needs what [`Solo::control`] left.
    fn show(&mut self, x: &[f64]) -> Result<(), LengthError> {
        let own = &x[self.layout.plant..self.layout.controller_end()];
        let Now { t_s, jets, output, input, shown, seen, asked, d_controller, .. } = &mut self.now;
        let limited = *input != *asked;
        seen.copy_from_slice(shown);
        if let Some(digital) = &self.digital {
            let Inbox { degree, sums } = digital.inbox();
            let outside = Outside { degree: &[degree], sums, jets: jets.jets(), time_s: *t_s };
            let asked = ControllerOutput { input: asked, d_state: d_controller, shown: seen };
            self.pair.evaluate(output, outside, own, asked)?;
            let mut first = 0;
            for (signal, count) in &self.shown {
                let block = first..first + count;
                if stands(*signal) {
                    seen[block.clone()].copy_from_slice(&shown[block]);
                }
                first += count;
            }
        }
        let (first, count) = self.layout.shown_torque;
        if limited || self.digital.is_some() {
            self.pair.acting(Signal::Torque, input, &mut seen[first..first + count]);
        }
        Ok(())
    }

    /// V and what it loses, where `shown` is what the controller shows; needs what [`Solo::look`] left.
    fn balance(&mut self, x: &[f64], inputs: Inputs<'_>, at_row: bool) -> Result<(f64, f64), LengthError> {
        let own = &x[self.layout.plant..self.layout.controller_end()];
        let Now { t_s, jets, state, output, shown, seen, .. } = &self.now;
        let shown = if at_row { seen } else { shown };
        let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: jets.jets(), time_s: *t_s };
        let truth = [&state[..], inputs.external.unwrap_or_default()];
        let Balance { value, dissipation } = self.pair.balance(truth, output, outside, own, shown)?;
        Ok((value, dissipation))
    }

    fn try_record(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>) -> Result<(), LengthError> {
        self.look(t_s, x)?;
        self.pair.settle(&mut self.now.state);
        self.control(x, inputs)?;
        self.show(x)?;
        let (value, _) = self.balance(x, inputs, true)?;
        self.row.clear();
        self.row.extend_from_slice(&self.now.state);
        self.row.extend_from_slice(&self.now.input);
        self.row.extend_from_slice(&self.now.seen);
        if self.is_offset() {
            self.row.extend(self.now.jets.jets().iter().map(|jet| jet[0]));
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
            target.trajectory.trajectory().jets_into(now_s, &mut jets);
        }
        let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: jets.jets(), time_s: now_s };
        tracing.sampled(&mut *self.pair, now_s, own, digital.output(), outside)
    }

    fn try_energy(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>) -> Result<Option<Energy>, LengthError> {
        if self.tracing.is_none() {
            return Ok(None);
        }
        self.look(t_s, x)?;
        self.control(x, inputs)?;
        let Some(tracing) = &self.tracing else { return Ok(None) };
        let own = &x[self.layout.plant..self.layout.controller_end()];
        let outside = Outside { degree: inputs.degree, sums: inputs.sums, jets: self.now.jets.jets(), time_s: t_s };
        let acting = [&self.now.input[..], inputs.external.unwrap_or_default()];
        tracing.energy(&mut *self.pair, [&self.now.state, own], outside, acting).map(Some)
    }

    fn all_signals(&self) -> Vec<Block> {
        let [mut blocks, _] = self.pair.states();
        blocks.extend(self.pair.inputs());
        blocks.extend(self.pair.shown());
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
