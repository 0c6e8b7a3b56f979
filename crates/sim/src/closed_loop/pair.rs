//! A plant and its controller, whatever they are: what one agent by itself asks of both. Two indirect calls of an instant are lost beside
//! what they compute, and everything around them is compiled once.

use forwardstep_core::LengthError;
use forwardstep_core::controller::{Balance, Controller, ControllerInput, ControllerOutput, Jets, Singularity, Truth};
use forwardstep_core::plant::{Plant, total};
use forwardstep_core::reference::{Exchange, Heard};
use forwardstep_core::sampled::Recipe;
use forwardstep_core::signal::{Block, Signal};

/// What a controller hears and where it should be.
#[derive(Clone, Copy)]
pub(super) struct Outside<'a> {
    pub(super) degree: &'a [f64],
    pub(super) sums: &'a [f64],
    pub(super) jets: Jets<'a>,
    pub(super) time_s: f64,
}

/// A [`Plant`] under a [`Controller`].
pub(super) trait Pair {
    /// m, the numbers of a position.
    fn axes(&self) -> usize;
    /// The states of the plant and of the controller.
    fn states(&self) -> [Vec<Block>; 2];
    /// Of the plant.
    fn inputs(&self) -> Vec<Block>;
    /// Of the plant.
    fn outputs(&self) -> Vec<Block>;
    /// What the controller tells of itself.
    fn shown(&self) -> Vec<Block>;
    /// Whether the controller sees a part of the output.
    fn reads(&self, signal: Signal) -> bool;
    /// Up to which derivative the controller reads its target.
    fn target_derivatives(&self) -> usize;
    /// What could be seen of the plant in `state`.
    fn output(&mut self, state: &[f64], output: &mut [f64]) -> Result<(), LengthError>;
    /// Limits `input` to what the actuators can give in `state`.
    fn limit(&self, state: &[f64], input: &mut [f64]);
    /// Writes what `input` does over the block of what is shown of the command.
    fn acting(&self, signal: Signal, input: &[f64], shown: &mut [f64]);
    /// d/dt of the plant's state under an input and what acts from outside.
    fn rate(&mut self, state: &[f64], by: [&[f64]; 2], d_state: &mut [f64]) -> Result<(), LengthError>;
    /// Brings the state of the plant back to its manifold.
    fn settle(&self, state: &mut [f64]);
    /// Brings the state of the controller back to its manifold.
    fn settle_controller(&self, own: &mut [f64]);
    /// The controller's state at the start.
    fn start(
        &mut self,
        output: &[f64],
        outside: Outside<'_>,
        wanted: &[Vec<f64>],
        own: &mut [f64],
    ) -> Result<(), LengthError>;
    /// What the controller asks for, how its state moves, and what it shows.
    fn evaluate(
        &mut self,
        output: &[f64],
        outside: Outside<'_>,
        own: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError>;
    /// V and what it loses in the plant's true state, under what acts on it from outside.
    fn balance(
        &mut self,
        truth: [&[f64]; 2],
        output: &[f64],
        outside: Outside<'_>,
        own: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError>;
    /// What is wrong although all numbers are finite.
    fn trouble(&self, own: &[f64], shown: &[f64]) -> Option<Singularity>;
    /// The sampled controller.
    fn recipe(&self) -> Recipe;
}

/// A plant with a controller made for it, and room to work in.
pub(super) struct Joined<C: Controller> {
    plant: C::Plant,
    controller: C,
    plant_scratch: <C::Plant as Plant>::Scratch,
    scratch: C::Scratch,
}

impl<C: Controller> Joined<C> {
    pub(super) fn new(plant: C::Plant, controller: C) -> Self {
        Joined { plant_scratch: plant.scratch(), scratch: controller.scratch(), plant, controller }
    }
}

/// Others may be told more than this law hears.
fn given<'g, C: Controller>(
    controller: &C,
    axes: usize,
    output: &'g [f64],
    outside: Outside<'g>,
) -> Result<ControllerInput<'g, C>, LengthError> {
    let sums = outside.sums.get(..C::Exchange::CHANNELS * axes).unwrap_or(outside.sums);
    let heard = Heard::new(outside.degree, sums, axes)?.at(outside.time_s);
    Ok(ControllerInput { measured: controller.see(output)?, heard, target: outside.jets })
}

impl<C: Controller> Pair for Joined<C> {
    fn axes(&self) -> usize {
        self.plant.axes()
    }

    fn states(&self) -> [Vec<Block>; 2] {
        [self.plant.states(), self.controller.states()]
    }

    fn inputs(&self) -> Vec<Block> {
        self.plant.inputs()
    }

    fn outputs(&self) -> Vec<Block> {
        self.plant.outputs()
    }

    fn shown(&self) -> Vec<Block> {
        self.controller.shown()
    }

    fn reads(&self, signal: Signal) -> bool {
        self.controller.reads(signal)
    }

    fn target_derivatives(&self) -> usize {
        self.controller.target_derivatives()
    }

    fn output(&mut self, state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        self.plant.output(&mut self.plant_scratch, state, output)
    }

    fn limit(&self, state: &[f64], input: &mut [f64]) {
        self.plant.limit(state, input);
    }

    fn acting(&self, signal: Signal, input: &[f64], shown: &mut [f64]) {
        self.plant.acting(signal, input, shown);
    }

    fn rate(&mut self, state: &[f64], [input, external]: [&[f64]; 2], d_state: &mut [f64]) -> Result<(), LengthError> {
        self.plant.rate(&mut self.plant_scratch, state, input, external, d_state)
    }

    fn settle(&self, state: &mut [f64]) {
        self.plant.settle(state);
    }

    fn settle_controller(&self, own: &mut [f64]) {
        self.controller.settle(own);
    }

    fn start(
        &mut self,
        output: &[f64],
        outside: Outside<'_>,
        wanted: &[Vec<f64>],
        own: &mut [f64],
    ) -> Result<(), LengthError> {
        let given = given(&self.controller, self.plant.axes(), output, outside)?;
        self.controller.start(&mut self.scratch, given, wanted, own)
    }

    fn evaluate(
        &mut self,
        output: &[f64],
        outside: Outside<'_>,
        own: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let given = given(&self.controller, self.plant.axes(), output, outside)?;
        self.controller.evaluate(&mut self.scratch, given, own, asked)
    }

    fn balance(
        &mut self,
        [state, external]: [&[f64]; 2],
        output: &[f64],
        outside: Outside<'_>,
        own: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let given = given(&self.controller, self.plant.axes(), output, outside)?;
        let truth = Truth { plant: &self.plant, state, external };
        self.controller.balance(&mut self.scratch, truth, given, own, shown)
    }

    fn trouble(&self, own: &[f64], shown: &[f64]) -> Option<Singularity> {
        self.controller.trouble(own, shown)
    }

    fn recipe(&self) -> Recipe {
        Recipe::feedback(&self.plant, self.controller.clone())
    }
}

/// Numbers that a pair works on.
#[derive(Clone, Copy)]
pub(super) struct Lengths {
    pub(super) output: usize,
    pub(super) input: usize,
    pub(super) shown: usize,
    pub(super) controller: usize,
}

impl Lengths {
    pub(super) fn of(pair: &dyn Pair) -> Lengths {
        let [_, controller] = pair.states().map(|blocks| total(&blocks));
        Lengths {
            output: total(&pair.outputs()),
            input: total(&pair.inputs()),
            shown: total(&pair.shown()),
            controller,
        }
    }
}
