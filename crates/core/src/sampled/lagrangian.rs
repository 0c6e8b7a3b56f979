//! A robot under (6)–(7), sampled.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;

use super::Sampled;
use super::recipe::{Assemble, Recipe, RecipeError, StartState};
use super::safe::Standing;
use super::sensing::Sensing;
use crate::LengthError;
use crate::agent::{Agent, Clipped, Inbox, StepError, finite};
use crate::law::SlotineLi;
use crate::reference::{Exchange, Measured, Reference};
use crate::robot::Lagrangian;
use crate::signal::{Block, Signal};

/// A robot with its reference dynamics and its gains.
pub(super) struct TrackingLaw<R, F> {
    pub(super) robot: R,
    pub(super) reference: F,
    pub(super) law: SlotineLi,
    pub(super) theta_hat: Vec<f64>,
}

impl<R, F> Assemble for TrackingLaw<R, F>
where
    R: Lagrangian<f64> + Clone + Send + Sync + 'static,
    F: Reference + Clone,
{
    fn assemble(&self, recipe: &Recipe) -> Result<Box<dyn Sampled>, RecipeError> {
        if recipe.target.is_some() {
            return Err(RecipeError::NoTarget);
        }
        let (m, adapts) = (self.robot.dof(), self.law.adaptation.is_some());
        let reference = self.reference.vectors() * m;
        let theta_hat = match &recipe.start {
            StartState::State(state) => {
                let estimates = if adapts { self.robot.parameter_count() } else { 0 };
                LengthError::check("the state at the start", reference + estimates, state.len())?;
                if adapts { state[reference..].to_vec() } else { self.theta_hat.clone() }
            }
            StartState::FirstSample { .. } => self.theta_hat.clone(),
        };
        let limiter = recipe.limiter(m, 0, m)?;
        let mut agent = Agent::new(self.robot.clone(), self.reference.clone(), self.law.clone(), theta_hat, limiter)?;
        match &recipe.start {
            StartState::State(state) => agent.set_reference(&state[..reference])?,
            StartState::FirstSample { wanted } => agent.start_with(wanted.clone())?,
        }
        let outputs = [(Signal::Position, m), (Signal::Velocity, m)];
        let sent = F::Exchange::CHANNELS * m;
        let mut sampled = SampledAgent {
            axes: m,
            sent,
            derivatives: self.reference.derivatives(),
            sliding: self.reference.sliding().is_some(),
            adapts,
            inputs: [(Signal::Torque, m)],
            sensing: Sensing::new(&outputs, sent, |_| true, recipe.filter.as_ref())?,
            standing: Standing::new(recipe.safe.clone(), m),
            state: vec![0.0; reference + if adapts { agent.estimate().len() } else { 0 }],
            agent,
        };
        sampled.copy_state();
        Ok(Box::new(sampled))
    }
}

/// An [`Agent`] with its sensors and its safe command.
struct SampledAgent<R: Lagrangian<f64>, F> {
    agent: Agent<R, F>,
    axes: usize,
    /// Numbers of a message that are measured, or blocks of the reference state.
    sent: usize,
    /// Blocks of the state that are z, ż, …; whether the last is a sign; whether estimates follow.
    derivatives: usize,
    sliding: bool,
    adapts: bool,
    inputs: [Block; 1],
    sensing: Sensing,
    standing: Standing,
    state: Vec<f64>,
}

impl<R: Lagrangian<f64>, F: Reference> SampledAgent<R, F> {
    fn try_step(&mut self, now_s: f64, measured: &[f64], inbox: Inbox<'_>) -> Result<(), StepError> {
        self.sensing.look(now_s, measured)?;
        let (q, dq) = self.sensing.output().split_at(self.axes);
        self.agent.step(now_s, Measured { q, dq }, inbox)?;
        self.sensing.accept(now_s)?;
        self.copy_state();
        let tau = self.agent.last().tau;
        finite("the command", tau)?;
        self.standing.take(tau);
        Ok(())
    }

    fn copy_state(&mut self) {
        let (reference, theta_hat) = self.state.split_at_mut(self.agent.reference_state().len());
        reference.copy_from_slice(self.agent.reference_state());
        if self.adapts {
            theta_hat.copy_from_slice(self.agent.estimate());
        }
    }
}

impl<R, F> Sampled for SampledAgent<R, F>
where
    R: Lagrangian<f64> + Send + Sync,
    F: Reference,
{
    fn measures(&self) -> &[Block] {
        self.sensing.measures()
    }

    fn inputs(&self) -> &[Block] {
        &self.inputs
    }

    fn message_len(&self) -> usize {
        self.sent + self.agent.transmitted().len()
    }

    fn message(&self, now_s: f64, measured: &[f64], out: &mut [f64]) -> Result<(), StepError> {
        LengthError::check("message", self.message_len(), out.len())?;
        let (own, computed) = out.split_at_mut(self.sent);
        self.sensing.head(now_s, measured, own)?;
        self.agent.transmit(own)?;
        computed.copy_from_slice(self.agent.transmitted());
        Ok(())
    }

    fn step(&mut self, now_s: f64, measured: &[f64], inbox: Inbox<'_>) -> Result<(), StepError> {
        let stepped = self.try_step(now_s, measured, inbox);
        if stepped.is_err() {
            self.standing.fail();
            self.agent.overridden(now_s, self.standing.command())?;
        }
        stepped
    }

    fn command(&self) -> &[f64] {
        self.standing.command()
    }

    fn clipped(&self) -> Clipped {
        self.agent.clipped()
    }

    fn state(&self) -> &[f64] {
        &self.state
    }

    fn diagnostics(&self, signal: Signal) -> Option<&[f64]> {
        let m = self.axes;
        let last = self.agent.last();
        let reference = self.agent.reference_state();
        match signal {
            Signal::Reference(0) => Some(last.z),
            Signal::Reference(1) => Some(last.dz),
            Signal::Reference(r) if usize::from(r) < self.derivatives => {
                reference.get(usize::from(r) * m..(usize::from(r) + 1) * m)
            }
            signal if let Some(block) = F::Exchange::held(signal) => reference.get(block * m..(block + 1) * m),
            Signal::Selection if self.sliding => reference.get(reference.len().saturating_sub(m)..),
            Signal::TrackingError => Some(last.s),
            Signal::Torque => Some(self.standing.command()),
            Signal::Estimate if self.adapts => Some(self.agent.estimate()),
            signal => self.sensing.known(signal),
        }
    }
}
