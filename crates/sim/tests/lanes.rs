//! A population large enough for lanes computes, bit for bit, what its members compute one at a time.

use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip};
use forwardstep_sim::delay::{Delay, SawTooth, Sinusoid};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::push::{AttachmentPoint, Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Actuators, Adaptive, AgentSetup, Axis, AxisUnit, Control, Exchange, Method, Network, RobotSetup, Sensors, Setup,
    Solver, Start, TimeSpan, simulate,
};

fn arm(index: usize, order: usize) -> AgentSetup {
    let some = |k: usize| (12.9898 * (index + 10 * k) as f64 + 0.7).sin();
    let theta = PlanarLinks::uniform([1.0 + 0.2 * index as f64, 1.0], [1.0, 0.8]).theta().to_vec();
    let axis = |name: &str| Axis {
        name: name.into(),
        unit: AxisUnit::Radian,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    let at = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 0.8] });
    let wrench = Course::Each([2.0, -3.0, 0.5].map(Function::Constant).to_vec());
    let wrench = Push { effect: Effect::Wrench { at, wrench }, from_s: 0.45, until_s: 1.25 };
    AgentSetup {
        name: format!("arm-{}", index + 1),
        robot: RobotSetup {
            kind: Arc::new(PlanarArm),
            theta,
            theta_names: vec![String::new(); 5],
            axes: vec![axis("shoulder"), axis("elbow")],
        },
        roots_per_s: (0..order).map(|r| 1.0 + 0.7 * r as f64 + 0.1 * index as f64).collect::<Vec<_>>().into(),
        manipulability: 0.0,
        law: Arc::new(Adaptive {
            // One agent with a full matrix beside others with a diagonal.
            damping: if index == 1 { Gain::Matrix(vec![9.0, 1.0, 1.0, 7.0]) } else { Gain::Number(8.0 + index as f64) },
            adaptation: Gain::Number(10.0),
            estimate_start: vec![0.1 * index as f64; 5],
            bounds: None,
        }),
        start: Start {
            q: vec![some(1), some(2)],
            dq: vec![0.3 * some(3), 0.3 * some(4)],
            rest: Vec::new(),
            reference: Vec::new(),
        },
        enforce_limits: false,
        target: None,
        pushes: if index == 1 { vec![wrench] } else { Vec::new() },
    }
}

/// The first two of `agents` arms hear each other, the others nobody. Fixed steps, so that the others have no say.
fn bits_of_the_first_two(agents: usize, order: usize, control: &Option<Control>) -> Vec<u64> {
    let edge = |from, to, delay| Edge { from, to, weight: 1.3.into(), delay };
    let phase = |edges, dwell_s| Phase { edges, dwell_s };
    let setup = Setup {
        agents: (0..agents).map(|index| arm(index, order)).collect(),
        reference: Arc::new(Consensus),
        exchange: Exchange::PositionVelocity,
        network: Network {
            agents,
            schedule: Schedule::periodic(vec![phase(vec![edge(0, 1, 0)], 0.4), phase(vec![edge(1, 0, 1)], 0.3)]),
            delays: vec![
                Delay::new(SawTooth { min_s: 0.0, max_s: 0.3, period_s: 0.25, offset_s: 0.1 }),
                Delay::new(Sinusoid { mean_s: 0.2, amplitude_s: 0.1, period_s: 0.9, phase_rad: 0.3 }),
            ],
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s: 3.0, record_every_s: 0.1, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver { method: Method::Fixed { step_s: 0.01 }, ..Solver::default() },
        control: control.clone(),
    };
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let columns = outcome.recording.columns.iter().filter(|column| column.agent < 2);
    columns.flat_map(|column| column.values.iter().map(|value| value.to_bits())).collect()
}

#[test]
fn digest_lanes_carry_the_bits_of_single_agents() {
    let noisy = Sensors { position_noise: 1e-4, velocity_noise: 1e-3, seed: 5, ..Sensors::default() };
    let sampled = Control {
        failures: Default::default(),
        sample_hz: 250.0,
        computation_delay_s: 0.001,
        sensors: noisy,
        actuators: Actuators { torque_rate_limit: Some(vec![900.0, 500.0]), ..Actuators::default() },
    };
    for (order, control) in [(1, None), (3, None), (2, Some(sampled))] {
        let alone = bits_of_the_first_two(2, order, &control);
        assert!(alone.len() > 2 * 31);
        // Lanes that are partly idle, full, and full with a second pack.
        for agents in [3, 8, 11] {
            let together = bits_of_the_first_two(agents, order, &control);
            assert!(together == alone, "{agents} agents, order {order}, {control:?}");
        }
    }
}
