//! What a run needs to know of the control of vehicles with one thrust, as plain data.

use forwardstep_core::controller::{Floor, Yaw};

/// The control of a vehicle or a rotorcraft; its roots are those of its agent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustLaw {
    /// Which of the paper's controllers.
    pub design: ThrustKind,
    /// What ω₃ is used for.
    pub yaw: Yaw,
    /// What happens near σ = 0.
    pub floor: Floor,
    /// σ(0), N; m g, or m̂(0) g where the mass is adapted, when it is not given.
    pub thrust_start: Option<f64>,
    /// b, 1/s: how fast a rotorcraft's torques bring about its angular velocity. Vehicles have no use for it.
    pub bandwidth_per_s: f64,
}

/// Which controller of Section V-B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThrustKind {
    /// (46), of order two.
    Continuous,
    /// (50), of order three.
    Differentiable {
        /// α*, 1/s.
        alpha_star: f64,
        /// k, kg/s².
        stiffness: f64,
    },
    /// (57), (58), of order three.
    Adaptive {
        /// α*, 1/s.
        alpha_star: f64,
        /// γ*, kg s²/m²; zero to keep the estimate as it is.
        gamma_star: f64,
        /// m̂(0), kg.
        estimate_start: f64,
    },
}

impl ThrustKind {
    /// How many roots it needs.
    pub fn order(self) -> usize {
        match self {
            ThrustKind::Continuous => 2,
            ThrustKind::Differentiable { .. } | ThrustKind::Adaptive { .. } => 3,
        }
    }
}
