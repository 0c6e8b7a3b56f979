//! Any controller, sampled.
//!
//! Between two samples nothing is measured and nothing is heard, so both are held; time goes on, and a target moves on by its Taylor
//! polynomial. Over such a period the state of the controller is stepped by the classical Runge–Kutta method, whose error is
//! of order five in a period and lost beside the first order of the hold, and brought back to its manifold.

use alloc::vec;
use alloc::vec::Vec;

use super::{Controller, ControllerInput, ControllerOutput, Jets, JetsBuffer, Singularity};
use crate::LengthError;
use crate::agent::{Inbox, StepError, finite};
use crate::plant::{Plant, total};
use crate::reference::{Exchange, Heard};

/// One agent's controller, stepped at samples.
///
/// **Guarantees**: no allocation and no panic in [`Stepped::step`]; the continuous controller in the limit of short periods.
///
/// Samples in, inputs to hold out; with short periods the state is that of the continuous law:
///
/// ```
/// use forwardstep_core::agent::Inbox;
/// use forwardstep_core::controller::{ReferenceModel, Jets, PositionOnly, Stepped};
/// use forwardstep_core::plant::Mechanical;
/// use forwardstep_core::reference::Consensus;
/// use forwardstep_core::robot::PointMass;
///
/// let guide = ReferenceModel::Consensus(Consensus::new([(&[1.0, 2.0][..], 0.0)])?);
/// let law = PositionOnly { axes: 1, guide, damping: 8.0, filter_per_s: 20.0, adaptation: 0.0, estimate_start: 2.0, bounds: None };
/// let plant = Mechanical { robot: PointMass { dimension: 1 }, theta: vec![2.0] };
/// // z, ż, p, I of a mass that is held at 1 m and has no neighbours: z̈ = −(κ₀ + κ₁) ż − κ₀ κ₁ z, and p follows.
/// let mut stepped = Stepped::new(law, &plant, 0, &[1.0, -1.0, 1.0, 0.0])?;
/// for k in 0..=1000 {
///     stepped.step(1e-3 * f64::from(k), &[1.0, 0.0], Inbox { degree: 0.0, sums: &[0.0] }, Jets::NONE)?;
/// }
/// // The root that this start leaves in is κ₀ = 1.
/// assert!((stepped.state()[0] - (-1.0_f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Stepped<C: Controller> {
    controller: C,
    scratch: C::Scratch,
    last_s: Option<f64>,
    /// The state has been set.
    started: bool,
    /// What z(0), ż(0), … shall be where the first sample sets it.
    wanted: Vec<Vec<f64>>,
    state: Vec<f64>,
    held: Held,
    work: Work,
    input: Vec<f64>,
    shown: Vec<f64>,
}

/// Inputs of the last sample.
#[derive(Clone, Debug)]
struct Held {
    output: Vec<f64>,
    degree: [f64; 1],
    sums: Vec<f64>,
    target: JetsBuffer,
    time_s: f64,
}

impl Held {
    /// A time `later_s` after the sample, when the target has moved on.
    fn given<'a, C: Controller>(
        &'a self,
        controller: &C,
        target: Jets<'a>,
        later_s: f64,
    ) -> Result<ControllerInput<'a, C>, LengthError> {
        let heard = Heard::new(&self.degree, &self.sums, self.sums.len() / C::Exchange::CHANNELS)?;
        let heard = heard.at(self.time_s + later_s);
        Ok(ControllerInput { measured: controller.see(&self.output)?, heard, target })
    }
}

/// Numbers of a plant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lengths {
    pub(crate) axes: usize,
    pub(crate) output: usize,
    pub(crate) input: usize,
}

/// Working memory of the Runge–Kutta method.
#[derive(Clone, Debug)]
struct Work {
    stage: Vec<f64>,
    k: Vec<f64>,
    sum: Vec<f64>,
    target: JetsBuffer,
}

impl<C: Controller> Stepped<C> {
    /// For a controller of `plant` with `targets` axes of a target; `state` is its state at the first sample.
    ///
    /// # Errors
    /// [`LengthError`] when the state is not the controller's.
    pub fn new(controller: C, plant: &C::Plant, targets: usize, state: &[f64]) -> Result<Self, LengthError> {
        let lengths = Lengths { axes: plant.axes(), output: plant.output_len(), input: total(&plant.inputs()) };
        LengthError::check("state of the controller", total(&controller.states()), state.len())?;
        let mut stepped = Stepped::started_by(controller, lengths, targets, Vec::new());
        stepped.start_at(state)?;
        Ok(stepped)
    }

    /// The same, but the first sample sets the state, with z(0), ż(0), … as far as `wanted`.
    pub(crate) fn started_by(controller: C, lengths: Lengths, targets: usize, wanted: Vec<Vec<f64>>) -> Self {
        let n = total(&controller.states());
        let target = JetsBuffer::new(targets, controller.target_derivatives());
        Stepped {
            scratch: controller.scratch(),
            last_s: None,
            started: false,
            wanted,
            state: vec![0.0; n],
            held: Held {
                output: vec![0.0; lengths.output],
                degree: [0.0],
                sums: vec![0.0; C::Exchange::CHANNELS * lengths.axes],
                target: target.clone(),
                time_s: 0.0,
            },
            work: Work { stage: vec![0.0; n], k: vec![0.0; n], sum: vec![0.0; n], target },
            input: vec![0.0; lengths.input],
            shown: vec![0.0; total(&controller.shown())],
            controller,
        }
    }

    /// Sets the state.
    pub(crate) fn start_at(&mut self, state: &[f64]) -> Result<(), LengthError> {
        LengthError::check("state of the controller", self.state.len(), state.len())?;
        self.state.copy_from_slice(state);
        self.started = true;
        Ok(())
    }

    /// Checks all lengths by starting and evaluating once with zeros.
    pub(crate) fn check(&mut self) -> Result<(), LengthError> {
        let Stepped { controller, scratch, started, wanted, state, held, work, input, shown, .. } = self;
        let target = work.target.jets();
        let mut first = state.clone();
        if !*started {
            controller.start(scratch, held.given(controller, target, 0.0)?, wanted, &mut first)?;
        }
        let asked = ControllerOutput { input, d_state: &mut work.k, shown };
        controller.evaluate(scratch, held.given(controller, target, 0.0)?, &first, asked)?;
        input.fill(0.0);
        shown.fill(0.0);
        Ok(())
    }

    /// What is about to go wrong in the state of the last sample.
    pub(crate) fn trouble(&self) -> Option<Singularity> {
        self.controller.trouble(&self.state, &self.shown)
    }

    /// Its state at the last sample.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// What it asked for at the last sample.
    pub fn input(&self) -> &[f64] {
        &self.input
    }

    /// What it told of itself at the last sample.
    pub fn shown(&self) -> &[f64] {
        &self.shown
    }

    /// Takes the sample of time `now_s` and gives the input to hold until the next one.
    ///
    /// The target has at least as many derivatives as [`Controller::target_derivatives`] says.
    ///
    /// The state is moved from the last sample to this one with the inputs of the last, over the time that really passed;
    /// then the new inputs give the command.
    ///
    /// # Errors
    /// [`StepError`], before anything has changed.
    pub fn step(
        &mut self,
        now_s: f64,
        output: &[f64],
        inbox: Inbox<'_>,
        target: Jets<'_>,
    ) -> Result<&[f64], StepError> {
        LengthError::check("output", self.held.output.len(), output.len())?;
        LengthError::check("sums heard", self.held.sums.len(), inbox.sums.len())?;
        let need = self.held.target.jets();
        LengthError::check("target", need.len(), target.len())?;
        if !target.is_empty() {
            let got = target.derivatives().min(need.derivatives());
            LengthError::check("derivatives of the target", need.derivatives(), got)?;
        }
        finite("time", &[now_s])?;
        finite("what is measured", output)?;
        finite("what is heard", &[inbox.degree])?;
        finite("what is heard", inbox.sums)?;
        match self.last_s {
            Some(last_s) if now_s > last_s => self.advance(now_s - last_s)?,
            Some(last_s) => return Err(StepError::Time { now_s, last_s }),
            None => {}
        }
        self.held.output.copy_from_slice(output);
        self.held.degree = [inbox.degree];
        self.held.sums.copy_from_slice(inbox.sums);
        for ((held, first), given) in self.held.target.iter_mut().zip(self.work.target.iter_mut()).zip(target) {
            held.copy_from_slice(&given[..held.len()]);
            first.copy_from_slice(held);
        }
        self.held.time_s = now_s;
        let Stepped { controller, scratch, started, wanted, state, held, work, input, shown, .. } = self;
        let target = work.target.jets();
        if !*started {
            controller.start(scratch, held.given(controller, target, 0.0)?, wanted, state)?;
        }
        let asked = ControllerOutput { input, d_state: &mut work.k, shown };
        controller.evaluate(scratch, held.given(controller, target, 0.0)?, state, asked)?;
        self.started = true;
        self.last_s = Some(now_s);
        Ok(&self.input)
    }

    /// Moves the state on by `h`.
    fn advance(&mut self, h: f64) -> Result<(), LengthError> {
        let Stepped { controller, scratch, state, held, work, input, shown, .. } = self;
        let Work { stage, k, sum, target } = work;
        sum.fill(0.0);
        stage.copy_from_slice(state);
        for (when, weight, next) in [(0.0, 1.0, 0.5), (0.5, 2.0, 0.5), (0.5, 2.0, 1.0), (1.0, 1.0, 0.0)] {
            for (moved, jet) in target.iter_mut().zip(held.target.jets()) {
                shift(jet, when * h, moved);
            }
            let given = held.given(controller, target.jets(), when * h)?;
            controller.evaluate(scratch, given, stage, ControllerOutput { input, d_state: k, shown })?;
            for i in 0..state.len() {
                sum[i] += weight * k[i];
                stage[i] = state[i] + next * h * k[i];
            }
        }
        for (x, sum) in state.iter_mut().zip(sum) {
            *x += h / 6.0 * *sum;
        }
        controller.settle(state);
        Ok(())
    }
}

/// A value and its derivatives a time `h` later, by their Taylor polynomial.
fn shift(jet: &[f64], h: f64, later: &mut [f64]) {
    for (k, value) in later.iter_mut().enumerate() {
        let mut term = 1.0;
        *value = 0.0;
        for (j, derivative) in jet[k..].iter().enumerate() {
            *value += derivative * term;
            term *= h / (j + 1) as f64;
        }
    }
}
