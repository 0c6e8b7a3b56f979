//! Any controller, sampled.

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use super::Sampled;
use super::recipe::{Assemble, Recipe, RecipeError, StartState, Target};
use super::safe::Standing;
use super::sensing::Sensing;
use crate::LengthError;
use crate::agent::{Clipped, Inbox, Limiter, StepError, finite, later};
use crate::controller::{Controller, Jet, JetsBuffer, Lengths, Singularity, Stepped};
use crate::plant::total;
use crate::reference::Exchange;
use crate::signal::{Block, Signal};

/// A controller, and what goes in and out of the plants that it is for.
pub(super) struct Feedback<C> {
    pub(super) axes: usize,
    pub(super) outputs: Vec<Block>,
    pub(super) inputs: Vec<Block>,
    pub(super) controller: C,
}

impl<C: Controller> Assemble for Feedback<C> {
    fn assemble(&self, recipe: &Recipe) -> Result<Box<dyn Sampled>, RecipeError> {
        let targets = match &recipe.target {
            None => 0,
            Some(Target::Offset(_)) if !C::KNOWS_OFFSETS => return Err(RecipeError::NoOffsets),
            Some(target) => {
                let entries = self.controller.target_len(self.axes);
                LengthError::check("the target", entries, target.motion().axes())?;
                let (needed, known) = (self.controller.target_derivatives(), target.motion().known_derivatives());
                if known < needed {
                    return Err(RecipeError::Derivatives { needed, known });
                }
                entries
            }
        };
        let input = total(&self.inputs);
        let torque = self.inputs.iter().position(|(signal, _)| *signal == Signal::Torque);
        let first = total(&self.inputs[..torque.unwrap_or(0)]);
        let torque = first..first + torque.map_or(0, |at| self.inputs[at].1);
        let lengths = Lengths { axes: self.axes, output: total(&self.outputs), input };
        let wanted = match &recipe.start {
            StartState::FirstSample { wanted } => wanted.clone(),
            StartState::State(_) => Vec::new(),
        };
        let mut stepped = Stepped::started_by(self.controller.clone(), lengths, targets, wanted);
        if let StartState::State(state) = &recipe.start {
            stepped.start_at(state)?;
        }
        stepped.check()?;
        let transmitted = C::Exchange::CHANNELS.max(recipe.transmits) * self.axes;
        let reads = |signal| self.controller.reads(signal);
        Ok(Box::new(SampledFeedback {
            axes: self.axes,
            transmitted,
            sensing: Sensing::new(&self.outputs, transmitted, reads, recipe.filter.as_ref())?,
            inputs: self.inputs.clone(),
            shown: self.controller.shown(),
            target: recipe.target.clone(),
            jets: JetsBuffer::new(targets, self.controller.target_derivatives()),
            limiter: recipe.limiter(input, torque.start, torque.len())?,
            torque,
            last_s: None,
            asked: vec![0.0; input],
            standing: Standing::new(recipe.safe.clone(), input),
            stepped,
        }))
    }
}

/// A [`Stepped`] controller with its sensors, its target, its limits and its safe command.
struct SampledFeedback<C: Controller> {
    stepped: Stepped<C>,
    axes: usize,
    /// Numbers of a message.
    transmitted: usize,
    sensing: Sensing,
    inputs: Vec<Block>,
    shown: Vec<Block>,
    target: Option<Target>,
    jets: JetsBuffer,
    limiter: Limiter,
    /// Where the torques stand among the inputs.
    torque: Range<usize>,
    /// When the command changed last, s.
    last_s: Option<f64>,
    asked: Vec<f64>,
    standing: Standing,
}

impl<C: Controller> SampledFeedback<C> {
    fn try_step(&mut self, now_s: f64, measured: &[f64], inbox: Inbox<'_>) -> Result<(), StepError> {
        self.sensing.look(now_s, measured)?;
        if let Some(target) = &self.target {
            for (axis, jet) in self.jets.iter_mut().enumerate() {
                target.motion().derivatives(axis, now_s, jet);
            }
        }
        // Others may be told more than this law hears.
        let heard = (C::Exchange::CHANNELS * self.axes).min(inbox.sums.len());
        let inbox = Inbox { sums: &inbox.sums[..heard], ..inbox };
        self.asked.copy_from_slice(self.stepped.step(now_s, self.sensing.output(), inbox, self.jets.jets())?);
        self.sensing.accept(now_s)?;
        if let Some(Singularity::Vanishes { signal, axis, value, floor }) = self.stepped.trouble() {
            return Err(StepError::Singular { signal, axis, value, floor });
        }
        let passed_s = self.last_s.map(|last_s| (now_s - last_s).max(0.0));
        self.limiter.apply(passed_s, &mut self.asked[self.torque.clone()]);
        finite("the command", &self.asked)?;
        self.last_s = Some(now_s);
        self.standing.take(&self.asked);
        Ok(())
    }
}

impl<C: Controller> Sampled for SampledFeedback<C> {
    fn measures(&self) -> &[Block] {
        self.sensing.measures()
    }

    fn inputs(&self) -> &[Block] {
        &self.inputs
    }

    fn message_len(&self) -> usize {
        self.transmitted
    }

    fn message(&self, now_s: f64, measured: &[f64], out: &mut [f64]) -> Result<(), StepError> {
        LengthError::check("message", self.transmitted, out.len())?;
        self.sensing.head(now_s, measured, out)?;
        if let Some(Target::Offset(offset)) = &self.target {
            for axis in 0..self.axes {
                let mut jet = Jet::default();
                offset.derivatives(axis, now_s, &mut jet);
                for (sent, offset) in out[axis..].iter_mut().step_by(self.axes).zip(jet) {
                    *sent -= offset;
                }
            }
        }
        Ok(())
    }

    fn step(&mut self, now_s: f64, measured: &[f64], inbox: Inbox<'_>) -> Result<(), StepError> {
        let stepped = self.try_step(now_s, measured, inbox);
        if stepped.is_err() {
            self.standing.fail();
            self.limiter.hold(&self.standing.command()[self.torque.clone()]);
            self.last_s = later(self.last_s, now_s);
        }
        stepped
    }

    fn command(&self) -> &[f64] {
        self.standing.command()
    }

    fn clipped(&self) -> Clipped {
        self.limiter.clipped()
    }

    fn state(&self) -> &[f64] {
        self.stepped.state()
    }

    fn diagnostics(&self, signal: Signal) -> Option<&[f64]> {
        find(&self.shown, self.stepped.shown(), signal)
            .or_else(|| find(&self.inputs, self.standing.command(), signal))
            .or_else(|| self.sensing.known(signal))
    }
}

/// The numbers of one signal among blocks.
fn find<'a>(blocks: &[Block], values: &'a [f64], signal: Signal) -> Option<&'a [f64]> {
    let at = blocks.iter().position(|(own, _)| *own == signal)?;
    let first = total(&blocks[..at]);
    values.get(first..first + blocks[at].1)
}
