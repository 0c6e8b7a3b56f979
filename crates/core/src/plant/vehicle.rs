//! (44): a vehicle that a single thrust propels and whose angular velocity is commanded.
//!
//! ```text
//! m ẍ = −σ R e₃ + m g e₃ + f,   Ṙ = R S(ω)
//! ```
//!
//! e₃ points down, in the inertial frame and, through the belly, in the body: an upright vehicle that hovers has R = I and
//! σ = m g. f is what pushes it, in the inertial frame; the paper has none. No torque can turn it but as ω says.

use alloc::vec;
use alloc::vec::Vec;

use super::{Plant, check_external};
use crate::LengthError;
use crate::attitude::{Quaternion, normalized, rate, rotate};
use crate::signal::{Block, Signal};

/// A thrust-propelled vehicle with its true mass. State and output: x, ẋ, (q_v, q_o). Input: σ, ω.
/// From outside: f.
///
/// **Source**: (44).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// m, kg.
    pub mass: f64,
    /// g, m/s².
    pub gravity: f64,
}

/// A state of (44), taken apart.
#[derive(Clone, Copy, Debug)]
pub struct VehicleState<'a> {
    /// x.
    pub x: &'a [f64; 3],
    /// ẋ.
    pub dx: &'a [f64; 3],
    /// (q_v, q_o).
    pub attitude: &'a Quaternion,
}

impl<'a> VehicleState<'a> {
    /// Numbers in it.
    pub const LEN: usize = 10;

    /// The first numbers of `state`; what comes after them is given back too.
    ///
    /// # Errors
    /// [`LengthError`] when they are too few.
    pub fn read(state: &'a [f64]) -> Result<(Self, &'a [f64]), LengthError> {
        let short = LengthError { what: "state of a vehicle", need: Self::LEN, got: state.len() };
        let (x, rest) = state.split_first_chunk().ok_or(short)?;
        let (dx, rest) = rest.split_first_chunk().ok_or(short)?;
        let (attitude, rest) = rest.split_first_chunk().ok_or(short)?;
        Ok((VehicleState { x, dx, attitude }, rest))
    }
}

impl Vehicle {
    /// ẍ under σ and nothing from outside.
    pub fn acceleration(&self, attitude: Quaternion, sigma: f64) -> [f64; 3] {
        let [x, y, z] = rotate(attitude, [0.0, 0.0, -sigma / self.mass]);
        [x, y, z + self.gravity]
    }

    /// d/dt of the ten numbers of [`VehicleState`], pushed by `force`, which may be empty.
    pub(super) fn motion(
        &self,
        state: VehicleState<'_>,
        (sigma, omega): (f64, [f64; 3]),
        force: &[f64],
        d_state: &mut [f64],
    ) {
        let rates = state.dx.iter().copied();
        let rates = rates.chain(self.acceleration(*state.attitude, sigma)).chain(rate(*state.attitude, omega));
        for (d, rate) in d_state.iter_mut().zip(rates) {
            *d = rate;
        }
        for (d, force) in d_state.iter_mut().skip(3).zip(force) {
            *d += force / self.mass;
        }
    }
}

/// Makes the quaternion in a state of (44) a unit one.
pub(super) fn settle(state: &mut [f64]) {
    if let Some(attitude) = state.get_mut(6..).and_then(<[f64]>::first_chunk_mut) {
        *attitude = normalized(*attitude);
    }
}

impl Plant for Vehicle {
    type Scratch = ();

    fn scratch(&self) {}

    fn axes(&self) -> usize {
        3
    }

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Position, 3), (Signal::Velocity, 3), (Signal::Attitude, 4)]
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::Thrust, 1), (Signal::AngularVelocity, 3)]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        VehicleState::LEN
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", VehicleState::LEN, state.len())?;
        LengthError::check("output", VehicleState::LEN, output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn rate(
        &self,
        (): &mut (),
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", VehicleState::LEN, state.len())?;
        LengthError::check("rate", VehicleState::LEN, d_state.len())?;
        check_external(3, external)?;
        let [sigma, omega @ ..] = input.first_chunk::<4>().filter(|_| input.len() == 4).ok_or(LengthError {
            what: "input",
            need: 4,
            got: input.len(),
        })?;
        self.motion(VehicleState::read(state)?.0, (*sigma, *omega), external, d_state);
        Ok(())
    }

    fn settle(&self, state: &mut [f64]) {
        settle(state);
    }
}

/// A thrust-propelled vehicle with an accelerometer, the thrust of which has a rate. State: x, ẋ, (q_v, q_o), σ. Output: the same, and the
/// measured ẍ behind it. Input: σ̇, ω. From outside: f, of which the output has nothing.
///
/// ẍ follows σ at once; as a state of the plant σ is there before anything is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AcceleratedVehicle {
    /// The vehicle with its true mass.
    pub vehicle: Vehicle,
    /// What the accelerometer gives too much, in the inertial frame, m/s².
    pub bias: [f64; 3],
}

/// Numbers in its state: those of [`VehicleState`], and σ.
const WITH_THRUST: usize = VehicleState::LEN + 1;

impl Plant for AcceleratedVehicle {
    type Scratch = ();

    fn scratch(&self) {}

    fn axes(&self) -> usize {
        3
    }

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Position, 3), (Signal::Velocity, 3), (Signal::Attitude, 4), (Signal::Thrust, 1)]
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::ThrustRate, 1), (Signal::AngularVelocity, 3)]
    }

    fn outputs(&self) -> Vec<Block> {
        let mut outputs = self.states();
        outputs.push((Signal::Acceleration, 3));
        outputs
    }

    fn output_len(&self) -> usize {
        WITH_THRUST + 3
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", WITH_THRUST, state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        let (same, measured) = output.split_at_mut(WITH_THRUST);
        same.copy_from_slice(state);
        let ddx = self.vehicle.acceleration(*VehicleState::read(state)?.0.attitude, state[WITH_THRUST - 1]);
        for ((measured, ddx), bias) in measured.iter_mut().zip(ddx).zip(self.bias) {
            *measured = ddx + bias;
        }
        Ok(())
    }

    fn limit(&self, _: &[f64], _: &mut [f64]) {}

    fn rate(
        &self,
        (): &mut (),
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", WITH_THRUST, state.len())?;
        LengthError::check("rate", WITH_THRUST, d_state.len())?;
        LengthError::check("input", 4, input.len())?;
        let (own, d_own) = (&state[..VehicleState::LEN], &mut d_state[..VehicleState::LEN]);
        self.vehicle.rate(&mut (), own, &[state[WITH_THRUST - 1], input[1], input[2], input[3]], external, d_own)?;
        d_state[WITH_THRUST - 1] = input[0];
        Ok(())
    }

    fn settle(&self, state: &mut [f64]) {
        settle(state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_44_hovers_upright_and_falls_without_thrust() {
        let vehicle = Vehicle { mass: 1.7, gravity: 9.81 };
        let mut state = [1.0, 2.0, -3.0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0];
        let mut rate = [9.0; 10];
        vehicle.rate(&mut (), &state, &[1.7 * 9.81, 0.0, 0.0, 0.0], &[], &mut rate).unwrap();
        assert!(rate[3..].iter().all(|x| x.abs() < 1e-15), "{rate:?}");
        assert_eq!(rate[..3], state[3..6]);
        vehicle.rate(&mut (), &state, &[0.0; 4], &[], &mut rate).unwrap();
        assert_eq!(rate[3..6], [0.0, 0.0, 9.81]);
        // Belly forward, a quarter turn about y: thrust pushes back along −x.
        let half = libm::sqrt(0.5);
        state[6..].copy_from_slice(&[0.0, half, 0.0, half]);
        vehicle.rate(&mut (), &state, &[1.7, 0.0, 0.0, 0.0], &[], &mut rate).unwrap();
        assert!((rate[3] + 1.0).abs() < 1e-15 && (rate[5] - 9.81).abs() < 1e-15, "{rate:?}");
    }

    #[test]
    fn eq_44_an_accelerometer_gives_the_rate_of_the_velocity_and_a_rate_moves_the_thrust() {
        let mut vehicle = AcceleratedVehicle { vehicle: Vehicle { mass: 1.7, gravity: 9.81 }, bias: [0.0; 3] };
        let state = [1.0, 2.0, -3.0, 0.1, 0.2, 0.3, 0.1, -0.2, 0.1, 0.97, 12.0];
        let (mut output, mut rate) = ([0.0; 14], [0.0; 11]);
        vehicle.output(&mut (), &state, &mut output).unwrap();
        vehicle.rate(&mut (), &state, &[-4.0, 0.3, 0.2, 0.1], &[], &mut rate).unwrap();
        assert_eq!((&output[..11], &output[11..], rate[10]), (&state[..], &rate[3..6], -4.0));
        let mut whole = [0.0; 10];
        vehicle.vehicle.rate(&mut (), &state[..10], &[12.0, 0.3, 0.2, 0.1], &[], &mut whole).unwrap();
        assert_eq!(rate[..10], whole);
        vehicle.bias = [0.1, 0.0, -0.2];
        vehicle.output(&mut (), &state, &mut output).unwrap();
        assert_eq!([output[11], output[12], output[13]], [rate[3] + 0.1, rate[4], rate[5] - 0.2]);
        assert!(vehicle.output(&mut (), &state[1..], &mut output).is_err());
        assert!(vehicle.rate(&mut (), &state, &[0.0; 3], &[], &mut rate).is_err());
        assert!(vehicle.rate(&mut (), &state, &[0.0; 4], &[1.0], &mut rate).is_err());
    }

    #[test]
    fn prop_settling_changes_no_rotation() {
        let vehicle = Vehicle { mass: 1.0, gravity: 9.81 };
        let mut state = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2, -0.4, 0.1, 0.95];
        let turned = |q| [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(|v| rotate(q, v));
        let before = turned([0.2, -0.4, 0.1, 0.95]);
        vehicle.settle(&mut state);
        let (settled, _) = VehicleState::read(&state).unwrap();
        assert!((settled.attitude.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
        let after = turned(*settled.attitude);
        assert!(before.iter().flatten().zip(after.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15));
        assert!(VehicleState::read(&state[1..]).is_err());
    }
}
