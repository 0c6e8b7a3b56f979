//! The outer law on a rigid body: torques bring about the ω that it asks for.
//!
//! With ω_r the angular velocity asked for and ε = ω − ω_r,
//!
//! ```text
//! τ = ω × J ω + J (ω̇_r − b ε)     ⇒     ε̇ = −b ε
//! ```
//!
//! for a known inertia J and the true ω̇_r. Under (50) ω̇_r is u̇ and what follows from it: z⃛ is the rate of (49), and ẍ is that
//! of the model, whose mass is known. Under (57) the part m̂' w is left out; it vanishes with ṡ. Under (46) ω_r jumps and
//! its derivative is left out.
//!
//! The vehicle then misses by m x⃛ − … = −R (σ ε₂, −σ ε₁, 0) what u says. Under (50) the miss decays like exp(−b t), an
//! integrable input of (52). The paper has no body with inertia: Theorems 4 and 5 do not cover it, nor limits of rotors.
//! V balances all the same, the miss being known: −V̇ = α* m |ṡ|² − ṡᵀ(miss), and a force from outside as in the head of
//! `thrust`. A torque from outside makes the rates miss.

use alloc::vec::Vec;

use super::Thrust;
use crate::LengthError;
use crate::attitude::{cross, rotate, times};
use crate::controller::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::plant::{Rotorcraft, VehicleState};
use crate::reference::Position;
use crate::signal::{Block, Signal};

/// What brings about an angular velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLoop {
    /// J as the controller knows it, kg m², row by row.
    pub inertia: [[f64; 3]; 3],
    /// b, 1/s: well above the roots of the outer law.
    pub bandwidth_per_s: f64,
}

/// What is seen of a rotorcraft.
#[derive(Clone, Copy, Debug)]
pub struct RotorcraftMeasured<'a> {
    /// What the outer law sees.
    pub vehicle: VehicleState<'a>,
    /// ω, which only the rate loop sees.
    pub omega: &'a [f64; 3],
}

/// Control of a rotorcraft by its thrust and its torques.
///
/// State and what is shown: those of [`Thrust`], then ω_r.
///
/// **Source**: [`Thrust`], with a rate loop of our own. **Measures**: x, ẋ, attitude, ω. **Transmits**: as [`Thrust`].
/// **Requires**: as [`Thrust`]; J known; a bandwidth well above the roots.
/// **Guarantees**: nothing that the paper states. With unlimited rotors and (50) the cascade converges as in the head of this
/// file.
///
/// A rotorcraft that hovers and turns about its vertical axis, which is not commanded, is slowed down at the rate b:
///
/// ```
/// use forwardstep_core::Gain;
/// use forwardstep_core::controller::{ControllerOutput, Controller, ControllerInput, Jets, RateLoop, Thrust, ThrustCascade, ThrustDesign};
/// use forwardstep_core::plant::{Plant, Rotorcraft, Vehicle};
/// use forwardstep_core::reference::Heard;
///
/// let design = ThrustDesign::Differentiable { alpha_star: 4.0, stiffness: 20.0 };
/// let vehicle = Vehicle { mass: 1.5, gravity: 9.81 };
/// let plant = Rotorcraft::new(vehicle, &Gain::Diagonal(vec![0.02, 0.03, 0.04]), None)?;
/// let mut outer = Thrust::new(design, [1.0, 2.0, 3.0], vehicle.mass, vehicle.gravity)?;
/// outer.yaw.gain = 0.0;
/// let law = ThrustCascade { outer, rates: RateLoop { inertia: *plant.inertia(), bandwidth_per_s: 30.0 } };
/// let turning = [0.5, 1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.7];
/// let given = ControllerInput { measured: law.see(&turning)?, heard: Heard::new(&[1.0], &turning[..3], 3)?, target: Jets::NONE };
/// let size = |blocks: Vec<(_, usize)>| blocks.iter().map(|(_, n)| n).sum::<usize>();
/// let (mut state, mut d_state) = (vec![0.0; size(law.states())], vec![0.0; size(law.states())]);
/// law.start(&mut (), given, &[], &mut state)?;
/// let (mut input, mut shown, mut rate) = ([0.0; 4], vec![0.0; size(law.shown())], [0.0; 13]);
/// law.evaluate(&mut (), given, &state, ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown })?;
/// plant.rate(&mut plant.scratch(), &turning, &input, &[], &mut rate)?;
/// assert!((rate[12] + 30.0 * 0.7).abs() < 1e-12 && rate[10].abs() + rate[11].abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ThrustCascade {
    /// What asks for thrust and angular velocity.
    pub outer: Thrust,
    /// What turns the body.
    pub rates: RateLoop,
}

impl Controller for ThrustCascade {
    type Plant = Rotorcraft;
    type Exchange = Position;
    type Measured<'a> = RotorcraftMeasured<'a>;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["position", "velocity", "attitude", "angular velocity"];
    const KNOWS_OFFSETS: bool = true;

    fn target_derivatives(&self) -> usize {
        // Those that the reference dynamics are differentiated into.
        self.outer.design.order() + 1
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Block> {
        self.outer.state_blocks()
    }

    fn shown(&self) -> Vec<Block> {
        let mut shown = self.outer.shown_blocks();
        shown.push((Signal::AngularVelocityWanted, 3));
        shown
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Attitude | Signal::AngularVelocity)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<RotorcraftMeasured<'a>, LengthError> {
        let (vehicle, omega) = VehicleState::read(output)?;
        let short = LengthError { what: "angular velocity", need: 3, got: omega.len() };
        Ok(RotorcraftMeasured { vehicle, omega: <&[f64; 3]>::try_from(omega).map_err(|_| short)? })
    }

    fn start(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        self.outer.begin(given.measured.vehicle, given.target, wanted, state)
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("input", 4, asked.input.len())?;
        let outer = self.outer.shown_len();
        LengthError::check("shown", outer + 3, asked.shown.len())?;
        let (shown, wanted) = asked.shown.split_at_mut(outer);
        let RotorcraftMeasured { vehicle, omega } = given.measured;
        let flight = self.outer.fly(vehicle, given.heard, given.target, state, [asked.d_state, shown])?;
        wanted.copy_from_slice(&flight.omega);
        let ahead = self.outer.foresee(&flight, vehicle, state, *omega);
        let RateLoop { inertia, bandwidth_per_s } = &self.rates;
        let push = core::array::from_fn(|k| ahead[k] - bandwidth_per_s * (omega[k] - flight.omega[k]));
        let (tau, gyroscopic) = (times(inertia, push), cross(*omega, times(inertia, *omega)));
        asked.input[0] = flight.sigma;
        for k in 0..3 {
            asked.input[1 + k] = tau[k] + gyroscopic[k];
        }
        Ok(())
    }

    fn trouble(&self, state: &[f64], _: &[f64]) -> Option<Singularity> {
        self.outer.vanishing(state)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, Rotorcraft>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let (moving, omega) = VehicleState::read(truth.state)?;
        LengthError::check("angular velocity", 3, omega.len())?;
        LengthError::check("shown", self.outer.shown_len() + 3, shown.len())?;
        let wanted = &shown[shown.len() - 3..];
        let sigma = self.outer.sigma(state).unwrap_or_default();
        let miss = [-sigma * (omega[1] - wanted[1]), sigma * (omega[0] - wanted[0]), 0.0];
        let slip = rotate(*moving.attitude, miss);
        self.outer.translation_balance(&truth.plant.vehicle, moving, given.target, state, [&slip, truth.external])
    }
}
