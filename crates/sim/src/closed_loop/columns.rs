//! What the closed loop asks of its parts: agents of one kind side by side, one agent by itself, the leader.
//!
//! No method has a default body, so that a part which forgets one does not compile.

use std::ops::Range;

use forwardstep_core::LengthError;
use forwardstep_core::controller::Singularity;
use forwardstep_core::sampled::{Recipe, Sampled};

use super::error::SetupError;
use super::injected::Energy;
use super::sampler::Digital;
use crate::recording::{GainRates, Signal};
use crate::setup::{AgentSetup, Control, Setup};

/// What reaches a population from outside at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inputs<'a> {
    /// Σ_j w_ij, one entry per agent.
    pub(crate) degree: &'a [f64],
    /// The sums of messages.
    pub(crate) sums: &'a [f64],
    /// What acts from outside, a column per entry of [`crate::Attachments::blocks`], when anybody is pushed.
    pub(crate) external: Option<&'a [f64]>,
}

/// What the closed loop asks of a population, whatever its robots and its exchange.
pub(crate) trait Columns {
    /// Numbers of state.
    fn state_len(&self) -> usize;
    /// Where in its block the first column of what it tells stands; the others follow.
    fn message(&self) -> usize;
    /// Appends the initial state to `x`, but for what depends on the first messages.
    fn append_start(&self, agents: &[AgentSetup], x: &mut Vec<f64>);
    /// Completes the block `x` of the initial state with what is heard at t = 0: z(0), ż(0), … become what is wanted.
    fn start(&mut self, agents: &[AgentSetup], x: &mut [f64], degree: &[f64], sums: &[f64]) -> Result<(), LengthError>;
    /// d/dt of the block `x`.
    fn rates(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, dx: &mut [f64]);
    /// Hands the signals of every member in turn to `write`, in the order of [`Columns::signals`].
    fn record(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, write: &mut dyn FnMut(usize, &[f64]));
    /// q and q̇ of a member, the one with the number `agent` among all, as far as there is room; what acts on it may depend on them.
    fn motion(&mut self, agent: usize, t_s: f64, x: &[f64], q: &mut [f64], dq: &mut [f64]);
    /// Measures the state `x` and puts everybody's message into `sent`, laid out like the sums. Does nothing, like the
    /// two below, when the controllers work in continuous time.
    fn sense(&mut self, t_s: f64, x: &[f64], sent: &mut [f64]);
    /// The recipes of the sampled controllers of its agents, by their numbers; `x` is its block of the initial state.
    fn recipes(&self, setup: &Setup, x: &[f64]) -> Result<Vec<(usize, Recipe)>, SetupError>;
    /// Takes the controllers built from these recipes: from now on control is digital.
    fn sample(&mut self, control: &Control, controllers: Vec<Box<dyn Sampled>>);
    /// Steps the controllers at the sample of time `now_s` and puts their new state into `x`.
    fn command(&mut self, now_s: f64, inputs: Inputs<'_>, x: &mut [f64]);
    /// Hands every agent under digital control to `each`.
    fn taken(&self, each: &mut dyn FnMut(&Digital));
    /// From now on commands under digital control are traced to what they came from, where [`Columns::energies`] asks for it.
    fn trace(&mut self, control: &Control);
    /// Hands V and the parts of V̇ of every agent whose commands are traced to `each`, by its number.
    fn energies(&mut self, t_s: f64, x: &[f64], inputs: Inputs<'_>, each: &mut dyn FnMut(usize, Energy));
    /// Applies the torques that were commanded last.
    fn apply(&mut self);
    /// Makes the actuators hold these commands, agent by agent.
    fn hold(&mut self, commands: &[f64]);
    /// Brings the block `x`, which a step has just reached, back to its manifold.
    fn settle(&mut self, x: &mut [f64]);
    /// Which member is in trouble in the state `x`, which has just been evaluated.
    fn trouble(&mut self, x: &[f64]) -> Option<(usize, Singularity)>;
    /// When its right-hand side jumps of itself for the first time after `after_s`.
    fn next_event_s(&self, after_s: f64) -> f64;
    /// Goes past what jumps until `until_s`; may change the block `x`.
    fn pass_kink(&mut self, until_s: f64, x: &mut [f64]);
    /// Where the values of its set-valued signs stand in its block, if it has any.
    fn selection(&self) -> Option<Range<usize>>;
    /// What a sign is taken of besides what is heard, q̈ or ż, in a column per axis; `dx` is what [`Columns::rates`] gave.
    fn transmit(&mut self, t_s: f64, dx: &[f64], transmitted: &mut [f64]);
    /// What the signs are taken of, from what everybody tells and its weighted sums.
    fn argument(&mut self, x: &[f64], inputs: Inputs<'_>, transmitted: [&[f64]; 2], e: &mut [f64]);
    /// Adds to the rates `dx` what these values of the signs do, where they are functions of the instant.
    fn add_sign_terms(&mut self, selection: &[f64], dx: &mut [f64]);
    /// Signals and axes of one member, in the order in which they are recorded.
    fn signals(&self) -> Vec<(Signal, usize)>;
    /// What the inputs of one member's plant are, and where each stands among its [`Columns::signals`].
    fn inputs(&self) -> Vec<(Signal, Range<usize>)>;
    /// Which member, signal and axis a state of the block is.
    fn locate(&self, state: usize) -> (usize, Signal, usize);
    /// The rates that its gains give to a member, the one with the number `agent` among all, in the state `x`, which has just
    /// been evaluated; `None` for other laws than (6)–(7), and for gains that act at samples.
    fn gain_rates(&mut self, agent: usize, x: &[f64]) -> Option<GainRates>;
}
