//! A spacecraft that turns itself by reaction wheels: (94) and its kinematics.
//!
//! Wheel k spins about the unit axis a_k, fixed in the body; A = [a_1 … a_n] is the distribution matrix and h_w holds the
//! momenta of the wheels about their own axes. With M the inertia of the whole without the axial inertias of the wheels,
//! the total angular momentum in coordinates of the body is
//!
//! ```text
//! h = M ω + A h_w
//! ```
//!
//! Motor k turns its wheel with the torque u_k, so ḣ_w = u. While nothing acts from outside R h = h_I is constant:
//! ḣ = −ω × h = S(h) ω. A torque n about the axes of the body adds to ḣ. Hence
//!
//! ```text
//! M ω̇ = ḣ − A ḣ_w = S(h) ω + τ + n,  τ = −A u                                   (94), n = 0
//! q̇_v = ½ (q_o I + S(q_v)) ω,         q̇_o = −½ q_vᵀω
//! ```
//!
//! The torque on the body is minus the rate of the wheels' momentum. For n > 3 wheels u is the shortest of all vectors that
//! give τ: u = −Aᵀ (A Aᵀ)⁻¹ τ.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::{Plant, check_external};
use crate::attitude::{cross, dot, normalized, rate, rotate, times};
use crate::linear::invert;
use crate::signal::{Block, Signal};
use crate::{Gain, GainError, LengthError};

/// One reaction wheel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// Its axis in the body, of any length but zero.
    pub axis: [f64; 3],
    /// The largest torque of its motor, N m.
    pub torque_limit_n_m: Option<f64>,
    /// The largest momentum it can hold, N m s.
    pub momentum_limit_n_m_s: Option<f64>,
}

/// Why wheels or a spacecraft make no sense.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SpacecraftError {
    /// The inertia matrix is not symmetric positive definite.
    #[error("the inertia matrix is no inertia: {0}")]
    Inertia(#[source] GainError),
    /// An axis is zero or not finite.
    #[error("the axis of wheel {} is [{}, {}, {}], which has no direction", .wheel + 1, .axis[0], .axis[1], .axis[2])]
    Axis {
        /// The wheel, from zero.
        wheel: usize,
        /// What was given.
        axis: [f64; 3],
    },
    /// The axes do not span all directions.
    #[error(
        "the axes of the {wheels} wheels span no volume (det A Aᵀ = {determinant:e}), so some torque cannot be made; \
         give at least three wheels whose axes are not in one plane"
    )]
    Rank {
        /// How many wheels.
        wheels: usize,
        /// det A Aᵀ of unit axes.
        determinant: f64,
    },
    /// A limit is not positive.
    #[error("the {what} of wheel {} is {value}; a limit must be positive", .wheel + 1)]
    Limit {
        /// The wheel, from zero.
        wheel: usize,
        /// `torque limit` or `momentum limit`.
        what: &'static str,
        /// What was given.
        value: f64,
    },
}

/// The wheels of a spacecraft with what is computed from them once.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheels {
    /// With axes of length one.
    wheels: Vec<Wheel>,
    /// Row k of Aᵀ (A Aᵀ)⁻¹.
    allocation: Vec<[f64; 3]>,
}

/// det A Aᵀ below which the axes are taken to lie in a plane; it is 1 for three wheels at right angles.
const FLAT: f64 = 1.0e-9;

impl Wheels {
    /// Checks the wheels and inverts the distribution.
    ///
    /// # Errors
    /// [`SpacecraftError`] for the first thing that makes no sense.
    pub fn new(wheels: &[Wheel]) -> Result<Self, SpacecraftError> {
        let mut wheels = wheels.to_vec();
        for (index, wheel) in wheels.iter_mut().enumerate() {
            let norm = libm::sqrt(dot(wheel.axis, wheel.axis));
            if !(norm > 0.0 && norm.is_finite()) {
                return Err(SpacecraftError::Axis { wheel: index, axis: wheel.axis });
            }
            wheel.axis = wheel.axis.map(|x| x / norm);
            let limits = [("torque limit", wheel.torque_limit_n_m), ("momentum limit", wheel.momentum_limit_n_m_s)];
            for (what, limit) in limits {
                match limit {
                    Some(value) if value.is_nan() || value <= 0.0 => {
                        return Err(SpacecraftError::Limit { wheel: index, what, value });
                    }
                    _ => {}
                }
            }
        }
        let mut gram = [0.0; 9];
        for wheel in &wheels {
            for row in 0..3 {
                for column in 0..3 {
                    gram[3 * row + column] += wheel.axis[row] * wheel.axis[column];
                }
            }
        }
        let mut inverse = [0.0; 9];
        let determinant = invert(3, &mut gram, &mut inverse);
        if determinant.is_nan() || determinant < FLAT {
            return Err(SpacecraftError::Rank { wheels: wheels.len(), determinant });
        }
        let inverse = rows(&inverse);
        let allocation = wheels.iter().map(|wheel| times(&inverse, wheel.axis)).collect();
        Ok(Wheels { wheels, allocation })
    }

    /// Three wheels along the axes of the body, without limits.
    pub fn orthogonal() -> Self {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let wheel = |axis| Wheel { axis, torque_limit_n_m: None, momentum_limit_n_m_s: None };
        Wheels { wheels: axes.map(wheel).to_vec(), allocation: axes.to_vec() }
    }

    /// One of them.
    pub fn wheel(&self, index: usize) -> Option<&Wheel> {
        self.wheels.get(index)
    }

    /// Number of wheels n.
    pub fn count(&self) -> usize {
        self.wheels.len()
    }

    /// The wheels, with axes of length one.
    pub fn list(&self) -> &[Wheel] {
        &self.wheels
    }

    /// A x, for wheel torques or momenta x; entries beyond the last wheel do not count.
    pub fn sum(&self, x: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (wheel, x) in self.wheels.iter().zip(x) {
            for k in 0..3 {
                sum[k] += wheel.axis[k] * x;
            }
        }
        sum
    }

    /// u = −Aᵀ (A Aᵀ)⁻¹ τ: the motor torques that put τ on the body.
    pub fn allocate(&self, tau: [f64; 3], u: &mut [f64]) {
        for (u, row) in u.iter_mut().zip(&self.allocation) {
            *u = -dot(*row, tau);
        }
    }
}

/// A 3 × 3 matrix from its nine entries.
fn rows(entries: &[f64; 9]) -> [[f64; 3]; 3] {
    core::array::from_fn(|row| core::array::from_fn(|column| entries[3 * row + column]))
}

/// A spacecraft with reaction wheels.
///
/// State and output: q = (q_v, q_o), ω in rad/s in coordinates of the body, h_w in N m s. Input: u in N m.
/// From outside: n in N m.
///
/// **Source**: (94) and the two equations after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Spacecraft {
    inertia: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    wheels: Wheels,
    /// Whether motors and wheels keep to their limits, or only report that they are beyond.
    enforced: bool,
}

impl Spacecraft {
    /// A spacecraft with inertia M in kg m². `enforced` says whether wheels keep to their limits.
    ///
    /// # Errors
    /// [`SpacecraftError`] when M is not symmetric positive definite.
    pub fn new(inertia: [[f64; 3]; 3], wheels: Wheels, enforced: bool) -> Result<Self, SpacecraftError> {
        let mut entries = inertia.as_flattened().to_vec();
        Gain::Matrix(entries.clone()).resolve(3, &[]).map_err(SpacecraftError::Inertia)?;
        let mut inverse = [0.0; 9];
        invert(3, &mut entries, &mut inverse);
        Ok(Spacecraft { inertia, inverse: rows(&inverse), wheels, enforced })
    }

    /// M, kg m².
    pub fn inertia(&self) -> &[[f64; 3]; 3] {
        &self.inertia
    }

    /// The wheels.
    pub fn wheels(&self) -> &Wheels {
        &self.wheels
    }

    /// h_I = R (M ω + A h_w), which no motion changes, only a torque from outside.
    ///
    /// # Errors
    /// [`LengthError`] when `state` is not a whole state.
    pub fn momentum_inertial(&self, state: &[f64]) -> Result<[f64; 3], LengthError> {
        Ok(rotate(self.parts(state)?.0, self.momentum(state)?))
    }

    /// h = M ω + A h_w.
    ///
    /// # Errors
    /// [`LengthError`] when `state` is not a whole state.
    pub fn momentum(&self, state: &[f64]) -> Result<[f64; 3], LengthError> {
        let (_, omega, h_w) = self.parts(state)?;
        let (own, wheels) = (times(&self.inertia, omega), self.wheels.sum(h_w));
        Ok(core::array::from_fn(|k| own[k] + wheels[k]))
    }

    fn parts<'a>(&self, state: &'a [f64]) -> Result<Parts<'a>, LengthError> {
        LengthError::check("state", 7 + self.wheels.count(), state.len())?;
        let ([a, b, c, d], [x, y, z]) = ([state[0], state[1], state[2], state[3]], [state[4], state[5], state[6]]);
        Ok(([a, b, c, d], [x, y, z], &state[7..]))
    }
}

/// The attitude, ω and the momenta of the wheels.
type Parts<'a> = ([f64; 4], [f64; 3], &'a [f64]);

impl Plant for Spacecraft {
    type Scratch = ();

    fn scratch(&self) {}

    /// The entries of a quaternion.
    fn axes(&self) -> usize {
        4
    }

    fn states(&self) -> Vec<Block> {
        vec![(Signal::Position, 4), (Signal::Velocity, 3), (Signal::WheelMomentum, self.wheels.count())]
    }

    fn inputs(&self) -> Vec<Block> {
        vec![(Signal::WheelTorque, self.wheels.count())]
    }

    fn outputs(&self) -> Vec<Block> {
        self.states()
    }

    fn output_len(&self) -> usize {
        7 + self.wheels.count()
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", self.output_len(), state.len())?;
        LengthError::check("output", self.output_len(), output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    /// Motors give no more than their torque, and a wheel that is full takes no more momentum.
    fn limit(&self, state: &[f64], input: &mut [f64]) {
        if !self.enforced {
            return;
        }
        let h_w = state.get(7..).unwrap_or(&[]);
        for ((u, h_w), wheel) in input.iter_mut().zip(h_w).zip(&self.wheels.wheels) {
            if let Some(limit) = wheel.torque_limit_n_m {
                *u = u.clamp(-limit, limit);
            }
            if wheel.momentum_limit_n_m_s.is_some_and(|limit| h_w.abs() >= limit && *u * h_w > 0.0) {
                *u = 0.0;
            }
        }
    }

    /// The torque on the body is minus what moves the wheels.
    fn acting(&self, signal: Signal, input: &[f64], shown: &mut [f64]) {
        if signal == Signal::Torque {
            let pull = self.wheels.sum(input);
            shown.iter_mut().zip(pull).for_each(|(torque, pull)| *torque = -pull);
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
        let (q, omega, _) = self.parts(state)?;
        LengthError::check("input", self.wheels.count(), input.len())?;
        LengthError::check("rate", state.len(), d_state.len())?;
        check_external(3, external)?;
        d_state[..4].copy_from_slice(&rate(q, omega));
        let (coupling, pull) = (cross(self.momentum(state)?, omega), self.wheels.sum(input));
        let mut net = core::array::from_fn(|k| coupling[k] - pull[k]);
        for (net, torque) in net.iter_mut().zip(external) {
            *net += torque;
        }
        d_state[4..7].copy_from_slice(&times(&self.inverse, net));
        d_state[7..].copy_from_slice(input);
        Ok(())
    }

    fn settle(&self, state: &mut [f64]) {
        if let Some(q) = state.first_chunk_mut::<4>() {
            *q = normalized(*q);
        }
    }
}
