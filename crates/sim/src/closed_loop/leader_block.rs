//! The leader as a block of the closed loop.
//!
//! Its state is q₀, q̇₀, and y₀ = q̈₀ + β q̇₀ + α q₀ where that is what is told, so that delays, history and samples treat what it says like what anybody says. The rates are the
//! derivatives of its motion in closed form; at every event the state is put back on the motion itself.

use std::ops::Range;

use forwardstep_core::LengthError;
use forwardstep_core::controller::{JetsBuffer, Singularity};
use forwardstep_core::sampled::{Recipe, Sampled};

use super::columns::{Columns, Inputs};
use super::error::SetupError;
use super::injected::Energy;
use super::sampler::Digital;
use crate::leader::Leader;
use crate::recording::{GainRates, Signal};
use crate::setup::{AgentSetup, Control, Setup};
use crate::trajectory::Pieces;

/// The leader.
pub(crate) struct LeaderBlock {
    pieces: Pieces,
    /// Its vertex.
    vertex: usize,
    jets: JetsBuffer,
    /// α and β, where it tells y₀.
    composite: Option<[f64; 2]>,
}

impl LeaderBlock {
    pub(crate) fn new(
        leader: &Leader,
        composite: Option<[f64; 2]>,
        vertex: usize,
        end_s: f64,
    ) -> Result<Self, SetupError> {
        let wrong = |error| SetupError::Trajectory { agent: leader.name.clone(), error };
        let pieces = Pieces::new(leader.trajectory.clone(), end_s).map_err(wrong)?;
        let jets = JetsBuffer::new(pieces.axes(), 0);
        Ok(LeaderBlock { pieces, vertex, jets, composite })
    }

    /// Puts the k-th derivatives of every axis at `t_s` into `out`, from k = `first` on.
    fn put(&mut self, t_s: f64, first: usize, out: &mut [f64]) {
        self.pieces.jets(t_s, &mut self.jets);
        let jets = self.jets.jets();
        for (k, out) in out.iter_mut().enumerate() {
            *out = jets.get(k % jets.len()).and_then(|jet| jet.get(first + k / jets.len())).copied().unwrap_or(0.0);
        }
    }

    /// Puts the state at `t_s` into `out`, differentiated `first` times.
    fn put_state(&mut self, t_s: f64, first: usize, out: &mut [f64]) {
        let (motion, composite) = out.split_at_mut(2 * self.pieces.axes());
        self.put(t_s, first, motion);
        self.put_composite(first, composite);
    }

    /// Puts y₀ of the instant at hand into `out`, differentiated `first` times.
    fn put_composite(&mut self, first: usize, out: &mut [f64]) {
        let Some([alpha, beta]) = self.composite else { return };
        for (out, jet) in out.iter_mut().zip(self.jets.jets()) {
            let of = |k: usize| jet.get(first + k).copied().unwrap_or(0.0);
            *out = beta.mul_add(of(1), alpha.mul_add(of(0), of(2)));
        }
    }
}

impl Columns for LeaderBlock {
    fn state_len(&self) -> usize {
        (2 + usize::from(self.composite.is_some())) * self.pieces.axes()
    }

    // Its state begins with what is measured, and ends with what is not.
    fn message(&self) -> usize {
        if self.composite.is_some() { 2 * self.pieces.axes() } else { 0 }
    }

    fn append_start(&self, _: &[AgentSetup], x: &mut Vec<f64>) {
        let mut jets = self.jets.clone();
        self.pieces.jets(0.0, &mut jets);
        x.extend(jets.jets().iter().map(|jet| jet[0]));
        x.extend(jets.jets().iter().map(|jet| jet[1]));
        if let Some([alpha, beta]) = self.composite {
            x.extend(jets.jets().iter().map(|jet| beta.mul_add(jet[1], alpha.mul_add(jet[0], jet[2]))));
        }
    }

    fn start(&mut self, _: &[AgentSetup], _: &mut [f64], _: &[f64], _: &[f64]) -> Result<(), LengthError> {
        Ok(())
    }

    fn rates(&mut self, t_s: f64, _: &[f64], _: Inputs<'_>, dx: &mut [f64]) {
        self.put_state(t_s, 1, dx);
    }

    fn record(&mut self, _: f64, _: &[f64], _: Inputs<'_>, _: &mut dyn FnMut(usize, &[f64])) {}

    // Nothing acts on it.
    fn motion(&mut self, _: usize, _: f64, _: &[f64], _: &mut [f64], _: &mut [f64]) {}

    fn sense(&mut self, t_s: f64, _: &[f64], sent: &mut [f64]) {
        // A message is q₀, q̇₀, then q̈₀ where something derived is sent; or y₀.
        self.put(t_s, 0, sent);
        self.put_composite(0, sent);
    }

    fn recipes(&self, _: &Setup, _: &[f64]) -> Result<Vec<(usize, Recipe)>, SetupError> {
        Ok(Vec::new())
    }

    fn sample(&mut self, _: &Control, _: Vec<Box<dyn Sampled>>) {}

    fn command(&mut self, now_s: f64, _: Inputs<'_>, x: &mut [f64]) {
        self.put_state(now_s, 0, x);
    }

    fn taken(&self, _: &mut dyn FnMut(&Digital)) {}

    // A leader has no command.
    fn trace(&mut self, _: &Control) {}

    fn energies(&mut self, _: f64, _: &[f64], _: Inputs<'_>, _: &mut dyn FnMut(usize, Energy)) {}

    fn apply(&mut self) {}

    fn hold(&mut self, _: &[f64]) {}

    fn transmit(&mut self, t_s: f64, _: &[f64], transmitted: &mut [f64]) {
        self.put(t_s, 2, transmitted);
    }

    fn next_event_s(&self, after_s: f64) -> f64 {
        self.pieces.next_kink_s(after_s)
    }

    fn pass_kink(&mut self, until_s: f64, x: &mut [f64]) {
        // y₀ jumps there with q̈₀; a table begins and ends without an acceleration.
        let jump_s = self.pieces.next_jump_s(until_s);
        self.pieces.pass(until_s);
        if let Some(jump_s) = jump_s {
            self.put_state(jump_s, 0, x);
        }
    }

    fn settle(&mut self, _: &mut [f64]) {}

    fn trouble(&mut self, _: &[f64]) -> Option<(usize, Singularity)> {
        None
    }

    // Signs stand in the dynamics of those that follow.
    fn selection(&self) -> Option<Range<usize>> {
        None
    }

    fn argument(&mut self, _: &[f64], _: Inputs<'_>, _: [&[f64]; 2], _: &mut [f64]) {}

    fn add_sign_terms(&mut self, _: &[f64], _: &mut [f64]) {}

    fn signals(&self) -> Vec<(Signal, usize)> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<(Signal, Range<usize>)> {
        Vec::new()
    }

    fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let m = self.pieces.axes();
        let signal = [Signal::Position, Signal::Velocity, Signal::Composite].get(state / m).copied();
        (self.vertex, signal.unwrap_or(Signal::Position), state % m)
    }

    fn gain_rates(&mut self, _: usize, _: &[f64]) -> Option<GainRates> {
        None
    }
}
