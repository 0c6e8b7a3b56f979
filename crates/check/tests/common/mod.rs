//! Setups, runs and columns that several tests of verdicts share.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub, reason = "each test uses its own part")]

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Ending, Exchange, Known, Method, Network, Outcome, ReferenceKind, RobotSetup,
    Setup, Signal, Solver, Start, TimeSpan, simulate,
};

/// Numbers that look arbitrary but are always the same.
pub fn noise(seed: usize) -> f64 {
    (12.9898 * seed as f64 + 0.7).sin()
}

pub fn arm(index: usize, roots_per_s: &[f64]) -> AgentSetup {
    let links = PlanarLinks::uniform([1.0 + 0.2 * index as f64, 1.0], [1.0, 0.8]);
    AgentSetup {
        name: format!("arm-{}", index + 1),
        robot: RobotSetup {
            kind: Arc::new(PlanarArm),
            theta: links.theta().to_vec(),
            theta_names: vec![String::new(); 5],
            axes: vec![axis("shoulder"), axis("elbow")],
        },
        roots_per_s: roots_per_s.to_vec(),
        manipulability: 0.0,
        law: Arc::new(Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(10.0),
            estimate_start: vec![0.0; 5],
        }),
        start: Start {
            q: vec![noise(index), noise(index + 10)],
            dq: vec![0.3 * noise(index + 20), 0.3 * noise(index + 30)],
            rest: Vec::new(),
            reference: Vec::new(),
        },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

pub fn axis(name: &str) -> Axis {
    Axis { name: name.into(), unit: AxisUnit::Radian, position_limits: None, velocity_limit: None, effort_limit: None }
}

pub fn edge(from: usize, to: usize, weight: f64, delay: usize) -> Edge {
    Edge { from, to, weight: weight.into(), delay }
}

pub fn setup(agents: Vec<AgentSetup>, exchange: Exchange, schedule: Schedule, delays: Vec<Delay>, end_s: f64) -> Setup {
    Setup {
        network: Network { agents: agents.len(), schedule, delays, weights: Vec::new(), coupling: Default::default() },
        agents,
        reference: ReferenceKind::Consensus,
        exchange,
        time: TimeSpan { end_s, record_every_s: 0.01 },
        solver: Solver { method: Method::Adaptive { rtol: 1e-9, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

pub fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

pub fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let found = outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, signal, axis));
    &found.unwrap().values
}

/// Five point masses in motion with ϑ known and z(0) = q̇(0), so that s ≡ 0.
pub fn masses(exchange: Exchange, order: usize, schedule: Schedule, delays: Vec<Delay>) -> Setup {
    let agents = (0..5)
        .map(|i| {
            let mut agent = arm(i, &(0..order).map(|r| 1.0 + 0.7 * r as f64).collect::<Vec<_>>());
            agent.robot.kind = Arc::new(PointMass { dimension: 2 });
            agent.robot.theta = vec![1.0 + i as f64];
            agent.robot.theta_names = vec!["mass".into()];
            agent.law = Arc::new(Known { damping: Gain::Number(5.0) });
            agent
        })
        .collect();
    let mut setup = setup(agents, exchange, schedule, delays, 12.0);
    setup.time.record_every_s = 0.004;
    setup
}
