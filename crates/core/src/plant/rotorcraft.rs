//! What flies: (44) as a rigid body with inertia, torques for input, and four rotors with limits.
//!
//! ```text
//! m ẍ = −σ R e₃ + m g e₃ + f,   Ṙ = R S(ω),   J ω̇ + ω × J ω = τ + n
//! ```
//!
//! f in the inertial frame and n about the axes of the body act from outside.
//!
//! **Rotors.** Four of them stand at the corners of a square, at (±a, ±a) in the body's x and y axes; rotor k pushes with
//! t_k ≥ 0 along −e₃ and leaves a drag of c t_k about e₃, one sign on each diagonal:
//!
//! ```text
//! σ = Σ t_k,   τ = Σ (−y_k t_k, x_k t_k, c_k t_k),   t_k = ¼ (σ − y_k τ₁/a² + x_k τ₂/a² + c_k τ₃/c²)
//! ```
//!
//! with (x, y, c)_k = (a, a, c), (−a, −a, c), (a, −a, −c), (−a, a, −c): the four columns are orthogonal, which is the
//! inverse. Every t_k stays between two limits. What is asked for beyond them is given up in this order: first yaw, then
//! thrust, and tilt last, for a vehicle that cannot tilt cannot be led back. Tilt is scaled until its spread fits between
//! the limits, thrust is moved to where the tilted rotors fit, and yaw gets what is left.

use alloc::vec;
use alloc::vec::Vec;

use super::vehicle::{self, Vehicle, VehicleState};
use super::{Plant, check_external};
use crate::attitude::{cross, times};
use crate::linear::invert;
use crate::signal::{Block, Signal};
use crate::{Gain, GainError, LengthError};

/// A rotorcraft with its true mass and inertia. State and output: x, ẋ, (q_v, q_o), ω. Input: σ, τ. From
/// outside: f, n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotorcraft {
    /// Mass and gravity.
    pub vehicle: Vehicle,
    inertia: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    /// Its rotors; without them every σ and τ can be had.
    pub rotors: Option<Rotors>,
}

/// Four rotors on the corners of a square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotors {
    /// a, how far a rotor is from the body's x axis and from its y axis, m.
    pub offset: f64,
    /// c, drag torque for thrust, m.
    pub drag: f64,
    /// What the thrust of one rotor lies between, N.
    pub thrust: [f64; 2],
}

/// Signs of x, y and c of the four rotors.
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0]];

impl Rotors {
    /// The thrusts that make up σ and τ, within the limits or not.
    pub fn thrusts(&self, sigma: f64, tau: [f64; 3]) -> [f64; 4] {
        CORNERS.map(|[x, y, c]| 0.25 * (sigma + (x * tau[1] - y * tau[0]) / self.offset + c * tau[2] / self.drag))
    }

    /// What is left of σ and τ, continuous in both.
    pub fn limit(&self, sigma: f64, tau: [f64; 3]) -> (f64, [f64; 3]) {
        let [least, most] = self.thrust;
        // Tilt: opposite rotors share it oppositely, ±u on one diagonal and ±v on the other.
        let [u, _, v, _] = self.thrusts(0.0, [tau[0], tau[1], 0.0]).map(f64::abs);
        let half = 0.5 * (most - least);
        let scale = if u.max(v) > half { half / u.max(v) } else { 1.0 };
        let (u, v) = (scale * u, scale * v);
        // Thrust: where some yaw from none to all of it lets the tilted rotors fit. Yaw adds y on one diagonal and takes it
        // from the other.
        let yaw = 0.25 * tau[2] / self.drag;
        let (low, high) = (yaw.min(0.0), yaw.max(0.0));
        let above = (most - u - low).min(most - v + high).min(most - 0.5 * (u + v));
        let below = (least + u - high).max(least + v + low).max(least + 0.5 * (u + v));
        let base = (0.25 * sigma).min(above).max(below);
        // Yaw: as much as fits then.
        let y = yaw.min((most - base - u).min(base - v - least)).max((least - base + u).max(base + v - most));
        (4.0 * base, [scale * tau[0], scale * tau[1], 4.0 * self.drag * y])
    }
}

impl Rotorcraft {
    /// From the inertia J about the centre of mass, kg m², in the body's axes.
    ///
    /// # Errors
    /// [`GainError`] when J is not symmetric positive definite.
    pub fn new(vehicle: Vehicle, inertia: &Gain, rotors: Option<Rotors>) -> Result<Self, GainError> {
        let resolved = inertia.resolve(3, &[])?;
        let (mut rows, mut inverse) = ([0.0; 9], [0.0; 9]);
        for (k, row) in rows.chunks_exact_mut(3).enumerate() {
            // J is symmetric: its rows are its columns.
            let mut unit = [0.0; 3];
            unit[k] = 1.0;
            resolved.apply(&unit, row);
        }
        let matrix = |rows: &[f64; 9]| core::array::from_fn(|i| core::array::from_fn(|j| rows[3 * i + j]));
        let inertia = matrix(&rows);
        invert(3, &mut rows, &mut inverse);
        Ok(Rotorcraft { vehicle, inertia, inverse: matrix(&inverse), rotors })
    }

    /// J, row by row.
    pub fn inertia(&self) -> &[[f64; 3]; 3] {
        &self.inertia
    }
}

/// Numbers in a state: x, ẋ, (q_v, q_o), ω.
const LEN: usize = VehicleState::LEN + 3;

impl Plant for Rotorcraft {
    type Scratch = ();

    fn scratch(&self) {}

    fn axes(&self) -> usize {
        3
    }

    fn states(&self) -> Vec<Block> {
        let mut states = self.vehicle.states();
        states.push((Signal::AngularVelocity, 3));
        states
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::Thrust, 1), (Signal::Torque, 3)]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        LEN
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", LEN, state.len())?;
        LengthError::check("output", LEN, output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], input: &mut [f64]) {
        if let (Some(rotors), [sigma, tau @ ..]) = (&self.rotors, input)
            && let Some(tau) = tau.first_chunk_mut()
        {
            (*sigma, *tau) = rotors.limit(*sigma, *tau);
        }
    }

    fn rate(
        &self,
        (): &mut (),
        state: &[f64],
        input: &[f64],
        external: &[f64],
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", LEN, state.len())?;
        LengthError::check("rate", LEN, d_state.len())?;
        LengthError::check("input", 4, input.len())?;
        check_external(6, external)?;
        let (force, torque) = external.split_at(external.len() / 2);
        let (moving, omega) = VehicleState::read(state)?;
        let (Some(omega), [sigma, tau @ ..]) = (omega.first_chunk::<3>(), input) else { return Ok(()) };
        self.vehicle.motion(moving, (*sigma, *omega), force, d_state);
        let gyroscopic = cross(*omega, times(&self.inertia, *omega));
        let mut net = core::array::from_fn(|k| tau[k] - gyroscopic[k]);
        for (net, torque) in net.iter_mut().zip(torque) {
            *net += torque;
        }
        d_state[VehicleState::LEN..].copy_from_slice(&times(&self.inverse, net));
        Ok(())
    }

    fn settle(&self, state: &mut [f64]) {
        vehicle::settle(state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attitude::dot;

    const ROTORS: Rotors = Rotors { offset: 0.15, drag: 0.02, thrust: [0.2, 6.0] };

    /// σ and τ of four thrusts, from where the rotors stand.
    fn made_of(t: [f64; 4]) -> (f64, [f64; 3]) {
        let mut tau = [0.0; 3];
        for ([x, y, c], t) in CORNERS.iter().zip(t) {
            let force = [0.0, 0.0, -t];
            let lever = cross([x * ROTORS.offset, y * ROTORS.offset, 0.0], force);
            for k in 0..3 {
                tau[k] += lever[k];
            }
            tau[2] += c * ROTORS.drag * t;
        }
        (t.iter().sum(), tau)
    }

    #[test]
    fn prop_thrusts_make_up_what_was_asked() {
        let (sigma, tau) = (9.0, [0.11, -0.07, 0.013]);
        let (back, turned) = made_of(ROTORS.thrusts(sigma, tau));
        assert!((back - sigma).abs() < 1e-14);
        assert!((0..3).all(|k| (turned[k] - tau[k]).abs() < 1e-15));
    }

    #[test]
    fn prop_no_rotor_leaves_its_limits_and_within_them_nothing_changes() {
        let mut touched = [0; 2];
        for n in 0..4000_i32 {
            // Spread over both sides of every limit, without a pattern.
            let draw = |k: i32| f64::from((n * (7919 + 104_729 * k) + 31 * k).rem_euclid(2003)) / 1001.5 - 1.0;
            let (sigma, tau) = (12.0 + 16.0 * draw(0), [1.2 * draw(1), 1.2 * draw(2), 0.2 * draw(3)]);
            let (limited, torque) = ROTORS.limit(sigma, tau);
            let within = |t: &f64| *t >= 0.2 - 1e-12 && *t <= 6.0 + 1e-12;
            assert!(ROTORS.thrusts(limited, torque).iter().all(within), "{sigma} {tau:?}");
            let free = ROTORS.thrusts(sigma, tau).iter().all(within);
            touched[usize::from(free)] += 1;
            if free {
                assert!((limited - sigma).abs() < 1e-12 && (0..3).all(|k| (torque[k] - tau[k]).abs() < 1e-12));
            }
            // Tilt keeps its direction, and yaw never turns round.
            assert!((torque[0] * tau[1] - torque[1] * tau[0]).abs() < 1e-12 && torque[2] * tau[2] >= -1e-12);
        }
        assert!(touched.iter().all(|count| *count > 50), "{touched:?}");
    }

    #[test]
    fn prop_free_body_keeps_its_angular_momentum_and_energy() {
        let vehicle = Vehicle { mass: 1.0, gravity: 0.0 };
        let j = Gain::Matrix(vec![0.02, 0.001, 0.0, 0.001, 0.03, -0.002, 0.0, -0.002, 0.04]);
        let craft = Rotorcraft::new(vehicle, &j, None).unwrap();
        let state = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.3, -0.2, 0.9, 1.0, -2.0, 0.5];
        let mut rate = [0.0; 13];
        craft.rate(&mut (), &state, &[0.0; 4], &[], &mut rate).unwrap();
        let (omega, d_omega) = ([1.0, -2.0, 0.5], [rate[10], rate[11], rate[12]]);
        let h = times(craft.inertia(), omega);
        let dh = times(craft.inertia(), d_omega);
        // d/dt (R h) = R (ω × h + ḣ)
        let kept = cross(omega, h);
        assert!((0..3).all(|k| (kept[k] + dh[k]).abs() < 1e-16));
        assert!(dot(omega, dh).abs() < 1e-16);
        assert!(Rotorcraft::new(vehicle, &Gain::Number(-1.0), None).is_err());
    }
}
