//! Vehicles with one thrust, and rotorcraft.

use forwardstep_sim::reference::Consensus;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::controller::{Floor, Yaw};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{
    AgentSetup, AxisUnit, Robot, RobotSetup, RotorcraftModel, Setup, Start, ThrustKind, ThrustLaw, VehicleModel,
};

use super::{axes, fixed, setup, switching, wave};

pub const G: f64 = 9.81;
pub const DIFFERENTIABLE: ThrustKind = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
pub const ADAPTIVE: ThrustKind =
    ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 0.8, bounds: None };
pub const BY_ACCELERATION: ThrustKind = by_acceleration([0.0; 3]);

/// By a measured acceleration with a bias.
pub const fn by_acceleration(bias: [f64; 3]) -> ThrustKind {
    ThrustKind::ByAcceleration { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 0.8, bounds: None, bias }
}

pub fn vehicle() -> Arc<dyn Robot> {
    Arc::new(VehicleModel { gravity: G })
}

pub fn rotorcraft() -> Arc<dyn Robot> {
    Arc::new(RotorcraftModel {
        gravity: G,
        inertia: Gain::Matrix(vec![0.02, 0.001, 0.0, 0.001, 0.02, 0.0, 0.0, 0.0, 0.04]),
        rotors: None,
    })
}

pub fn agent(index: usize, kind: Arc<dyn Robot>, design: ThrustKind) -> AgentSetup {
    let kg = 1.0 + 0.3 * index as f64;
    let q = [[1.0, 0.0, -1.0], [0.0, 1.5, -2.0], [-1.0, 0.5, -1.5]][index];
    let mut rest = vec![0.0, 0.0, 0.0, 1.0];
    rest.resize(kind.interface(3).rest_len, 0.0);
    AgentSetup {
        name: format!("craft-{index}"),
        robot: RobotSetup {
            kind,
            theta: vec![kg],
            theta_names: vec!["mass".into()],
            axes: axes(&["x", "y", "z"], AxisUnit::Metre),
        },
        roots_per_s: [1.0, 1.5, 2.0][..design.order()].into(),
        manipulability: 0.0,
        law: Arc::new(ThrustLaw {
            design,
            yaw: Yaw { heading: 0.5, rate: 0.0, gain: 1.0 },
            floor: Floor::Stops(1.0),
            thrust_start: None,
            bandwidth_per_s: 30.0,
        }),
        target: None,
        // (46) has no z.
        start: Start {
            q: q.to_vec(),
            dq: vec![0.2, -0.1, 0.1],
            rest,
            reference: vec![vec![0.0; 3]; design.order() - 2],
        },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// A circle of radius one about where all agree, and a drift.
pub fn turning(index: usize) -> Trajectory {
    let phase_rad = 2.1 * index as f64;
    let paths = vec![
        wave(0.0, 1.0, 0.4, phase_rad),
        wave(0.0, 1.0, 0.4, phase_rad + core::f64::consts::FRAC_PI_2),
        fixed(-0.2 * index as f64),
    ];
    Trajectory::new(paths).unwrap()
}

pub fn three(kind: &Arc<dyn Robot>, design: ThrustKind, in_formation: bool, end_s: f64) -> Setup {
    let agents =
        (0..3).map(|k| AgentSetup { target: in_formation.then(|| turning(k)), ..agent(k, kind.clone(), design) });
    setup(agents.collect(), Arc::new(Consensus), switching(), end_s)
}
