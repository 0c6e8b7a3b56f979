//! Point masses without velocity.

use forwardstep_sim::reference::{Consensus, Tracking};
use std::sync::Arc;

use forwardstep_core::robot::PointMass;
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AgentSetup, AxisUnit, ModelReferenceLaw, PositionOnlyLaw, RobotSetup, Setup, Signal, Start};

use super::{axes, setup, silent, switching, wave};

pub fn mass(index: usize, kg: f64, q: [f64; 2], roots: &[f64]) -> AgentSetup {
    AgentSetup {
        name: format!("mass-{index}"),
        robot: RobotSetup {
            kind: Arc::new(PointMass { dimension: 2 }),
            theta: vec![kg],
            theta_names: vec!["mass".into()],
            axes: axes(&["x", "y"], AxisUnit::Metre),
        },
        roots_per_s: roots.to_vec().into(),
        manipulability: 0.0,
        law: Arc::new(PositionOnlyLaw {
            damping: 20.0,
            filter_per_s: 20.0,
            adaptation: 5.0,
            estimate_start: 0.3,
            bounds: None,
        }),
        target: None,
        start: Start { q: q.to_vec(), dq: vec![0.2, -0.1], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// Its target is reached, and is rich enough for its mass, 2 kg, to be found.
pub fn is_reached(setup: &Setup) {
    let outcome = super::run(setup);
    for axis in 0..2 {
        let error = super::column(&outcome, 0, Signal::Error, axis);
        let last = error.last().unwrap().abs();
        assert!(last < 1e-3 * error[0].abs(), "axis {axis}: {} to {last}", error[0]);
    }
    let estimate = super::last(&outcome, 0, Signal::Estimate, 0);
    assert!((estimate - 2.0).abs() < 1e-2, "{estimate}");
}

pub fn tracking() -> Setup {
    let mut agent = mass(1, 2.0, [0.4, -0.3], &[1.0, 1.5, 2.0]);
    agent.target = Some(Trajectory::new(vec![wave(0.1, 1.0, 1.0, 0.4), wave(0.1, 0.5, 1.7, 0.4)]).unwrap());
    setup(vec![agent], Arc::new(Tracking), silent(1), 40.0)
}

/// The same by a model in the place of (a9).
pub fn by_model() -> Setup {
    let mut setup = tracking();
    setup.agents[0].roots_per_s = vec![1.0, 2.0].into();
    setup.agents[0].law = Arc::new(ModelReferenceLaw { filter_per_s: 20.0, adaptation: 20.0, estimate_start: 0.3 });
    setup
}

pub fn consensus(order: usize) -> Setup {
    let roots = &[1.0, 2.0, 1.5][..order];
    let starts = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.5]];
    let agents = (0..3).map(|k| mass(k + 1, 1.0 + 0.7 * k as f64, starts[k], roots)).collect();
    setup(agents, Arc::new(Consensus), switching(), 40.0)
}
