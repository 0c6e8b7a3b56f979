//! A point mass without velocity, (a7)–(a9), and many of them: the identity of the proof along real runs.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;

use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    AgentSetup, Axis, AxisUnit, Control, Ending, Exchange, Law, Method, Network, Outcome, ReferenceKind, RobotKind,
    RobotSetup, Setup, Signal, Solver, Start, TimeSpan, simulate,
};

fn mass(index: usize, kg: f64, q: [f64; 2], roots: &[f64]) -> AgentSetup {
    let axis = |name: &str| Axis {
        name: name.into(),
        unit: AxisUnit::Metre,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    AgentSetup {
        name: format!("mass-{index}"),
        robot: RobotSetup {
            kind: RobotKind::PointMass { dimension: 2 },
            theta: vec![kg],
            theta_names: vec!["mass".into()],
            axes: vec![axis("x"), axis("y")],
        },
        roots_per_s: roots.to_vec(),
        manipulability: 0.0,
        law: Law::PositionOnly { damping: 20.0, filter_per_s: 20.0, adaptation: 5.0, estimate_start: 0.3 },
        target: None,
        start: Start { q: q.to_vec(), dq: vec![0.2, -0.1], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

fn setup(agents: Vec<AgentSetup>, reference: ReferenceKind, network: Network, end_s: f64) -> Setup {
    Setup {
        agents,
        reference,
        exchange: Exchange::Position,
        network,
        time: TimeSpan { end_s, record_every_s: 0.05 },
        solver: Solver { method: Method::Adaptive { rtol: 1e-8, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

fn tracking() -> Setup {
    let mut agent = mass(1, 2.0, [0.4, -0.3], &[1.0, 1.5, 2.0]);
    let wave = |amplitude, rad_per_s| Path::Sinusoids {
        offset: 0.1,
        waves: vec![Sinusoid { amplitude, rad_per_s, phase_rad: 0.4 }],
    };
    agent.target = Some(Trajectory::new(vec![wave(1.0, 1.0), wave(0.5, 1.7)]).unwrap());
    let nobody = Network {
        agents: 1,
        schedule: Schedule::Fixed(Vec::new()),
        delays: Vec::new(),
        weights: Vec::new(),
        coupling: Default::default(),
    };
    setup(vec![agent], ReferenceKind::Tracking, nobody, 40.0)
}

fn consensus(order: usize) -> Setup {
    let roots = &[1.0, 2.0, 1.5][..order];
    let starts = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.5]];
    let agents = (0..3).map(|k| mass(k + 1, 1.0 + 0.7 * k as f64, starts[k], roots)).collect();
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let phase = |edges| Phase { dwell_s: 0.8, edges };
    let network = Network {
        agents: 3,
        schedule: Schedule::Periodic(vec![phase(vec![edge(0, 1), edge(1, 0)]), phase(vec![edge(1, 2), edge(2, 0)])]),
        delays: vec![Delay::SawTooth { min_s: 0.05, max_s: 0.3, period_s: 0.5, offset_s: 0.0 }],
        weights: Vec::new(),
        coupling: Default::default(),
    };
    setup(agents, ReferenceKind::Consensus, network, 40.0)
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let is_it = |c: &&forwardstep_sim::Column| c.agent == agent && c.signal == signal && c.axis == axis;
    &outcome.recording.columns.iter().find(is_it).unwrap().values
}

/// max |V + ∫ k yᵀy − V(0)| / V(0).
fn ledger_error(outcome: &Outcome, agent: usize) -> f64 {
    let v = column(outcome, agent, Signal::Lyapunov, 0);
    let lost = column(outcome, agent, Signal::Dissipation, 0);
    v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs() / v[0]).fold(0.0, f64::max)
}

#[test]
fn eq_a8_loses_exactly_k_y_squared_along_real_runs() {
    for setup in [tracking(), consensus(2), consensus(3)] {
        let outcome = run(&setup);
        for agent in 0..setup.agents.len() {
            let error = ledger_error(&outcome, agent);
            assert!(error <= 10.0 * 1e-8, "agent {agent}: {error}");
        }
    }
}

#[test]
fn eq_a9_a_mass_of_unknown_weight_reaches_its_target() {
    let outcome = run(&tracking());
    for axis in 0..2 {
        let error = column(&outcome, 0, Signal::Error, axis);
        let last = error.last().unwrap().abs();
        assert!(last < 1e-3 * error[0].abs(), "axis {axis}: {} to {last}", error[0]);
    }
    // The target is rich enough for the mass to be found.
    let estimate = *column(&outcome, 0, Signal::Estimate, 0).last().unwrap();
    assert!((estimate - 2.0).abs() < 1e-2, "{estimate}");
}

#[test]
fn remark_7_masses_agree_over_switching_delayed_links_without_velocities() {
    for order in [2, 3] {
        let outcome = run(&consensus(order));
        for axis in 0..2 {
            let last: Vec<f64> =
                (0..3).map(|agent| *column(&outcome, agent, Signal::Position, axis).last().unwrap()).collect();
            let speed = (0..3).map(|agent| column(&outcome, agent, Signal::Velocity, axis).last().unwrap().abs());
            let spread = last.iter().fold(f64::MIN, |a, b| a.max(*b)) - last.iter().fold(f64::MAX, |a, b| a.min(*b));
            assert!(spread < 2e-3, "order {order}, axis {axis}: {last:?}");
            assert!(speed.fold(0.0, f64::max) < 2e-3);
        }
    }
}

#[test]
fn prop_sampled_masses_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for setup in [tracking(), consensus(2)] {
        let mut setup = setup;
        setup.time.end_s = 4.0;
        let continuous = run(&setup);
        let gaps: Vec<f64> = [500.0, 1000.0, 2000.0]
            .into_iter()
            .map(|sample_hz| {
                setup.control = Some(Control {
                    sample_hz,
                    computation_delay_s: 0.0,
                    sensors: Default::default(),
                    actuators: Default::default(),
                });
                let sampled = run(&setup);
                let end = |outcome: &Outcome| *column(outcome, 0, Signal::Position, 0).last().unwrap();
                (end(&sampled) - end(&continuous)).abs()
            })
            .collect();
        for pair in gaps.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.8..1.2).contains(&order), "{gaps:?}");
        }
    }
}
