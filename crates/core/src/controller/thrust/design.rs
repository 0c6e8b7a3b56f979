//! What can be chosen about the control of a vehicle.

use crate::attitude::{Quaternion, rotate};
use crate::controller::Singularity;
use crate::signal::Signal;
use crate::sine_and_cosine;

/// Which of the paper's controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThrustDesign {
    /// (45), (46): ω and σ̇ jump where the network switches.
    Continuous,
    /// (49), (50), Theorem 4: ω and σ̇ are differentiable.
    Differentiable {
        /// α*, 1/s.
        alpha_star: f64,
        /// k, kg/s².
        stiffness: f64,
    },
    /// (49), (57), (58), Theorem 5: the mass need not be known.
    Adaptive {
        /// α*, 1/s.
        alpha_star: f64,
        /// γ*, kg s²/m².
        gamma_star: f64,
    },
}

/// What ω₃ is used for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Yaw {
    /// ψ_r(0), rad, from the x axis towards the y axis.
    pub heading: f64,
    /// r, rad/s.
    pub rate: f64,
    /// k_ψ, 1/s; zero leaves the heading alone.
    pub gain: f64,
}

/// What happens when σ comes down to a floor σ₀ > 0, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Floor {
    /// The controller reports it.
    Stops(f64),
    /// σ is kept above it.
    Kept {
        /// σ₀.
        floor: f64,
        /// T₀, s: the floor is approached no faster than exponentially with this time constant.
        approach_s: f64,
    },
}

impl Yaw {
    /// ω₃ where the heading to keep is `heading`.
    pub(super) fn turn(self, attitude: Quaternion, heading: f64) -> f64 {
        let (sin, cos) = sine_and_cosine(heading);
        let look = rotate(attitude, [1.0, 0.0, 0.0]);
        self.rate + self.gain * (look[0] * sin - look[1] * cos)
    }
}

impl Floor {
    /// σ₀, N.
    pub fn newtons(self) -> f64 {
        match self {
            Floor::Stops(floor) | Floor::Kept { floor, .. } => floor,
        }
    }

    /// σ̇, where the law wants `d_sigma`.
    pub(super) fn kept(self, sigma: f64, d_sigma: f64) -> f64 {
        match self {
            Floor::Stops(_) => d_sigma,
            Floor::Kept { floor, approach_s } => d_sigma.max((floor - sigma) / approach_s),
        }
    }

    /// What the law divides by, when it is too small.
    pub(super) fn trouble(self, sigma: f64) -> Option<Singularity> {
        let floor = match self {
            Floor::Stops(floor) => floor,
            // Kept above its floor from wherever it started, unless that was no thrust at all.
            Floor::Kept { .. } => 0.0,
        };
        // Not a number is trouble too.
        let enough = sigma > floor;
        (!enough).then_some(Singularity::Vanishes { signal: Signal::Thrust, axis: 0, value: sigma, floor })
    }
}

impl ThrustDesign {
    /// How many roots it has: α, β, and γ where there is one.
    pub fn order(self) -> usize {
        match self {
            ThrustDesign::Continuous => 2,
            ThrustDesign::Differentiable { .. } | ThrustDesign::Adaptive { .. } => 3,
        }
    }

    /// Whether the mass is adapted.
    pub fn adapts(&self) -> bool {
        matches!(self, ThrustDesign::Adaptive { .. })
    }

    /// Numbers in z, ż, z̈; none under (46).
    pub(super) fn reference_len(&self) -> usize {
        match self {
            ThrustDesign::Continuous => 0,
            _ => 9,
        }
    }

    /// α*, k and γ*; zeros under (46).
    pub(super) fn gains(&self) -> [f64; 3] {
        match *self {
            ThrustDesign::Continuous => [0.0; 3],
            ThrustDesign::Differentiable { alpha_star, stiffness, .. } => [alpha_star, stiffness, 0.0],
            ThrustDesign::Adaptive { alpha_star, gamma_star, .. } => [alpha_star, 0.0, gamma_star],
        }
    }
}
