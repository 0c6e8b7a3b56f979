//! The outer law on a vehicle whose angular velocity obeys at once, as in the paper.

use alloc::vec::Vec;

use super::Thrust;
use crate::LengthError;
use crate::controller::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::plant::{Vehicle, VehicleState};
use crate::reference::Position;
use crate::signal::{Block, Signal};

impl Thrust {
    /// What the law divides by, when it is too small.
    pub(super) fn vanishing(&self, state: &[f64]) -> Option<Singularity> {
        self.floor.trouble(self.sigma(state)?)
    }
}

impl Controller for Thrust {
    type Plant = Vehicle;
    type Exchange = Position;
    type Measured<'a> = VehicleState<'a>;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["position", "velocity", "attitude"];
    const KNOWS_OFFSETS: bool = true;

    fn target_derivatives(&self) -> usize {
        // Those that the reference dynamics are differentiated into.
        self.design.order() + 1
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        self.state_blocks()
    }

    fn shown(&self) -> Vec<Block> {
        self.shown_blocks()
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Attitude)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<VehicleState<'a>, LengthError> {
        LengthError::check("output", VehicleState::LEN, output.len())?;
        Ok(VehicleState::read(output)?.0)
    }

    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.begin(given.measured, given.target, wanted, state)
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("input", 4, asked.input.len())?;
        let flight = self.fly(given.measured, given.heard, given.target, state, [asked.d_state, asked.shown])?;
        asked.input[0] = flight.sigma;
        asked.input[1..].copy_from_slice(&flight.omega);
        Ok(())
    }

    fn trouble(&self, state: &[f64], _: &[f64]) -> Option<Singularity> {
        self.vanishing(state)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, Vehicle>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        _: &[f64],
    ) -> Result<Balance, LengthError> {
        let moving = VehicleState::read(truth.state)?.0;
        self.translation_balance(truth.plant, moving, given.target, state, [&[], truth.external])
    }
}
