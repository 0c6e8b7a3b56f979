//! Synthetic runs in closed form, of any shape.
#![allow(dead_code, unreachable_pub, reason = "shared by several test programs")]

use forwardstep_sim::reference::Consensus;
use std::sync::Arc;
use std::time::Duration;

use forwardstep_check::hypothesis::{GraphEvidence, LinkEvidence, Named, ReferenceEvidence, Subject};
use forwardstep_check::{Hypothesis, Id, Report, Theorem, practical};
use forwardstep_core::Gain;
use forwardstep_core::robot::PointMass;
use forwardstep_io::output::{GoalOutcome, RunRecord};
use forwardstep_io::scenario::{Goal, Scenario};
use forwardstep_sim::delay::{Basis, Delay, SawTooth, Sinusoid};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::recording::{Column, Statistics};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Ending, Exchange, Method, Network, Outcome, Recording, RobotSetup, Setup,
    Signal, Solver, Start, TimeSpan,
};

/// Two carts that hear each other.
pub const CARTS: &str = r#"format = 2
title = "Two carts"
time = { end_s = 0.5, record_every_s = 0.1 }
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = [[0], [1]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges = [["cart-1", "cart-2"], ["cart-2", "cart-1"]]
"#;

/// Every so many of these, and all of them where `.ci/long` asks for that.
pub fn some<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if std::env::var_os("FORWARDSTEP_LONG").is_some() { 1 } else { every })
}

/// One agent with `dof` axes and `parameters` estimated parameters.
pub fn agent(name: &str, dof: usize, parameters: usize) -> AgentSetup {
    let axes = (0..dof).map(|k| Axis {
        name: format!("joint_{}", k + 1),
        unit: AxisUnit::Radian,
        position_limits: Some([-2.9, 2.9]),
        velocity_limit: Some(3.0),
        effort_limit: Some(150.0),
    });
    let quantity = ["mass", "mass_x", "mass_y", "mass_z", "xx", "xy", "xz", "yy", "yz", "zz"];
    AgentSetup {
        name: name.into(),
        robot: RobotSetup {
            kind: Arc::new(PointMass { dimension: dof }),
            theta: (0..parameters).map(|k| 2.0 / (1.0 + (k % 10) as f64)).collect(),
            theta_names: (0..parameters).map(|k| format!("link_{}.{}", k / 10 + 1, quantity[k % 10])).collect(),
            axes: axes.collect(),
        },
        roots_per_s: vec![1.0, 2.0].into(),
        manipulability: 0.0,
        law: Arc::new(Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(10.0),
            estimate_start: vec![0.0; parameters],
            bounds: None,
        }),
        start: Start { q: vec![0.0; dof], dq: vec![0.0; dof], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

/// Agents on a switching ring with a saw-tooth and a sinusoidal delay.
pub fn setup(agents: Vec<AgentSetup>, end_s: f64, record_every_s: f64) -> Setup {
    let count = agents.len();
    let edge = |from: usize, to: usize, delay| Edge { from, to, weight: 1.0.into(), delay };
    let ring = |rest: usize| -> Vec<Edge> {
        (0..count.saturating_sub(1)).filter(|k| k % 3 == rest).map(|k| edge(k, k + 1, k % 2)).collect()
    };
    let mut back = ring(2);
    if count > 1 {
        back.push(edge(count - 1, 0, 0));
    }
    let phases = [ring(0), ring(1), back].into_iter().map(|edges| Phase { edges, dwell_s: end_s / 20.0 });
    Setup {
        agents,
        reference: Arc::new(Consensus),
        exchange: Exchange::PositionVelocity,
        network: Network {
            agents: count,
            schedule: Schedule::periodic(phases.collect()),
            delays: vec![
                Delay::new(SawTooth { min_s: 0.05, max_s: 0.4, period_s: end_s / 12.0, offset_s: 0.0 }),
                Delay::new(Sinusoid { mean_s: 0.2, amplitude_s: 0.1, period_s: end_s / 5.0, phase_rad: 0.0 }),
            ],
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s, record_every_s, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver {
            method: Method::Adaptive { rtol: 1e-6, atol: 1e-8 },
            max_step_s: None,
            min_step_s: 1e-12,
            memory_budget_bytes: 1 << 30,
            balance: true,
        },
        control: None,
    }
}

/// A run that looks like consensus: positions decay towards 0.3 (axis + 1), torques jump with the phases.
pub fn outcome(setup: &Setup) -> Outcome {
    let end_s = setup.time.end_s;
    let rows = (end_s / setup.time.record_every_s).round() as usize;
    let t_s: Vec<f64> = (0..=rows).map(|k| k as f64 * setup.time.record_every_s).collect();
    let mut columns = Vec::new();
    for (i, agent) in setup.agents.iter().enumerate() {
        let mut add = |signal, axis, f: &dyn Fn(f64) -> f64| {
            columns.push(Column { agent: i, signal, axis, values: t_s.iter().map(|t| f(*t)).collect() });
        };
        let dof = agent.robot.axes.len();
        let shift = (i as f64 * 2.4).sin();
        let decay = |axis: usize| (5.0 + axis as f64) / end_s;
        let swing = |axis: usize| 2.0 + axis as f64 * 0.7 + 0.1 * i as f64;
        let wave = |t: f64, axis: usize| (-decay(axis) * t).exp() * (swing(axis) * t + i as f64).cos();
        let slope = |t: f64, axis: usize| {
            (-decay(axis) * t).exp()
                * (-decay(axis) * (swing(axis) * t + i as f64).cos() - swing(axis) * (swing(axis) * t + i as f64).sin())
        };
        let phase = |t: f64| ((t / (end_s / 20.0) + 1e-9).floor() as i64).rem_euclid(3) as f64;
        for axis in 0..dof {
            add(Signal::Position, axis, &|t| 0.3 * (axis + 1) as f64 + (shift + 0.4) * wave(t, axis));
        }
        for axis in 0..dof {
            add(Signal::Velocity, axis, &|t| (shift + 0.4) * slope(t, axis));
        }
        for (k, size) in [(0_u8, 1.0), (1, 0.4)] {
            for axis in 0..dof {
                add(Signal::Reference(k), axis, &|t| {
                    size * (shift + 0.4) * slope(t, axis) * (1.0 - 0.5 * (-20.0 * t / end_s).exp())
                });
            }
        }
        for axis in 0..dof {
            add(Signal::TrackingError, axis, &|t| 0.5 * (shift + 0.4) * slope(t, axis) * (-20.0 * t / end_s).exp());
        }
        for axis in 0..dof {
            add(Signal::Torque, axis, &|t| {
                let fading = (-4.0 * t / end_s).exp();
                60.0 / (1.0 + axis as f64)
                    * (1.0 + 3.0 * fading * wave(t, axis) + 0.8 * fading * (phase(t) - 1.0) * shift)
            });
        }
        for (k, truth) in agent.robot.theta.iter().enumerate() {
            add(Signal::Estimate, k, &|t| {
                truth * (1.0 - (-(6.0 + shift) * t / end_s).exp() * (1.0 + 0.2 * (3.0 * t).sin()))
            });
        }
        let v = |t: f64| (2.0 + shift) * (-12.0 * t / end_s).exp() + 0.01;
        add(Signal::Lyapunov, 0, &v);
        add(Signal::Dissipation, 0, &|t| v(0.0) - v(t) + 1e-7 * (1.0 + shift) * (t * 2.0).sin() * (t / end_s));
    }
    Outcome {
        recording: Recording { t_s, columns },
        ending: Ending::Completed,
        statistics: Statistics {
            steps: 41_233,
            rejected: 812,
            evaluations: 252_271,
            break_points: 180,
            sign_residual: None,
            drive: None,
            failed_steps: 0,
            clipped: None,
            wall: Some(Duration::from_millis(1234)),
        },
    }
}

/// What a check might have said.
pub fn verdicts() -> Report {
    let hypothesis = |id, evidence| Hypothesis { id, subject: Subject::Setup, evidence };
    let roots = vec![Named { index: 0, name: "arm-1".into() }];
    let tree = GraphEvidence::Window { length_s: 3.0, worst_start_s: 1.0, roots, for_all_time: true, drawn: false };
    let delays = LinkEvidence::Delays {
        bound_s: 0.4,
        oldest_s: 0.0,
        unknown: Vec::new(),
        end_s: 60.0,
        basis: Basis::Rule,
        holds_packets: false,
    };
    let weights = LinkEvidence::Weights { low: 1.0, high: 2.0, until_s: Some(60.0), bounded_for_ever: false };
    let filter = ReferenceEvidence::FilteredDerivative { filter_s: 0.05 };
    Report {
        theorem: Theorem::Theorem2,
        promises: "All positions converge to one value and all velocities to zero, whatever the delays do.".into(),
        hypotheses: vec![
            hypothesis(Id::SpanningTree, tree.into()),
            hypothesis(Id::BoundedDelays, delays.into()),
            hypothesis(Id::BoundedWeights, weights.into()),
            hypothesis(Id::MeasuredDerivative, filter.into()),
        ],
    }
}

/// Everything about a run, with a goal that was met.
pub fn record<'a>(setup: &'a Setup, outcome: &'a Outcome, verdicts: &'a Report) -> RunRecord<'a> {
    RunRecord {
        title: "Six arms agree over a switching network with jumping delays",
        scenario_name: "theorem-2.toml",
        scenario_text: "format = 2\ntitle = \"Six arms agree over a switching network with jumping delays\"\n",
        inputs: &[],
        version: "0.1.0",
        setup,
        outcome,
        verdicts,
        practical: practical(setup),
        predicted_agreement: Some(
            (0..setup.agents.first().map_or(0, |a| a.robot.axes.len())).map(|axis| 0.3 * (axis + 1) as f64).collect(),
        ),
        prediction: None,
        goal: Some(GoalOutcome { goal: Goal::DisagreementBelow(0.05), met: true }),
        digital: None,
        injected: Vec::new(),
        injected_course: None,
        notices: Vec::new(),
        shapes: None,
    }
}

/// What a run leaves of itself: no goal, nothing that was predicted, nothing beside it.
pub fn plain_record<'a>(scenario: &'a Scenario, outcome: &'a Outcome, verdicts: &'a Report) -> RunRecord<'a> {
    RunRecord {
        title: &scenario.title,
        scenario_name: &scenario.name,
        scenario_text: scenario.source.text(),
        inputs: &scenario.inputs,
        version: "0.1.0",
        setup: &scenario.setup,
        outcome,
        verdicts,
        practical: practical(&scenario.setup),
        predicted_agreement: None,
        prediction: None,
        goal: None,
        digital: None,
        injected: Vec::new(),
        injected_course: None,
        notices: Vec::new(),
        shapes: None,
    }
}

/// Two planar arms that have run for two seconds.
pub fn two_arms() -> (Setup, Outcome) {
    let setup = setup(vec![agent("arm-1", 2, 3), agent("arm-2", 2, 3)], 2.0, 0.01);
    let outcome = outcome(&setup);
    (setup, outcome)
}
