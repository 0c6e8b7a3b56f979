//! Following a leader, (110), (119) and (122): the identity of the proof, convergence, and what the choice of the sign does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::reference::Choice;
use forwardstep_core::robot::PlanarLinks;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    Actuators, AgentSetup, Axis, AxisUnit, Control, Ending, Exchange, Law, Method, Network, Outcome, ReferenceKind,
    RobotKind, RobotSetup, Sensors, Setup, Signal, Solver, Start, TimeSpan, simulate,
};

const DESIGNS: [FollowingDesign; 3] =
    [FollowingDesign::Continuous, FollowingDesign::Differentiable, FollowingDesign::WithoutAcceleration];

fn arm(index: usize, q: [f64; 2], estimate: f64) -> AgentSetup {
    let links = PlanarLinks::uniform([2.0 + 0.2 * index as f64, 1.5], [1.0, 0.8]);
    let theta = links.theta().to_vec();
    let axis = |name: &str| Axis {
        name: name.into(),
        unit: AxisUnit::Radian,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    AgentSetup {
        name: format!("arm-{index}"),
        robot: RobotSetup {
            kind: RobotKind::PlanarArm,
            theta_names: (0..theta.len()).map(|k| format!("theta{k}")).collect(),
            axes: vec![axis("shoulder"), axis("elbow")],
            theta: theta.clone(),
        },
        roots_per_s: Vec::new(),
        manipulability: 0.0,
        law: Law::Adaptive {
            damping: Gain::Number(20.0),
            adaptation: Gain::Number(10.0),
            estimate_start: theta.iter().map(|theta| estimate * theta).collect(),
        },
        target: None,
        start: Start { q: q.to_vec(), dq: vec![0.0; 2], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// Four arms; the leader, vertex 4, is heard by the first alone.
fn setup(design: FollowingDesign, choice: Choice, estimate: f64, end_s: f64) -> Setup {
    let starts = [[0.6, -0.3], [-0.5, 0.4], [0.2, 0.8], [-0.8, -0.6]];
    let wave = |amplitude, rad_per_s, phase_rad| Sinusoid { amplitude, rad_per_s, phase_rad };
    let path = |offset, waves| Path::Sinusoids { offset, waves };
    let trajectory =
        Trajectory::new(vec![path(0.3, vec![wave(0.6, 0.8, 0.0)]), path(-0.2, vec![wave(0.4, 1.1, 0.5)])]).unwrap();
    let edge = |from, to, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    let following = Following {
        leader: Leader { name: "leader".into(), trajectory },
        design,
        alpha: 1.0,
        beta: 2.0,
        gain: 2.0,
        choice,
        period_s: 1e-3,
    };
    Setup {
        agents: starts.iter().enumerate().map(|(k, q)| arm(k + 1, *q, estimate)).collect(),
        reference: ReferenceKind::Following(Arc::new(following)),
        exchange: Exchange::PositionVelocity,
        network: Network {
            agents: 5,
            schedule: Schedule::Fixed(vec![
                edge(4, 0, 1.0),
                edge(0, 1, 1.0),
                edge(1, 2, 1.0),
                edge(2, 3, 1.0),
                edge(3, 0, 0.5),
            ]),
            delays: vec![Delay::Constant { s: 0.0 }],
            weights: Vec::new(),
        },
        time: TimeSpan { end_s, record_every_s: 0.01 },
        solver: Solver { method: Method::Adaptive { rtol: 1e-7, atol: 1e-9 }, ..Solver::default() },
        control: None,
    }
}

fn sampled(mut setup: Setup) -> Setup {
    setup.control = Some(Control {
        sample_hz: 1000.0,
        computation_delay_s: 0.0,
        sensors: Sensors::default(),
        actuators: Actuators::default(),
    });
    setup.time.record_every_s = 1e-3;
    setup
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn columns(outcome: &Outcome, signal: Signal) -> Vec<&[f64]> {
    let wanted = outcome.recording.columns.iter().filter(|column| column.signal == signal);
    wanted.map(|column| &column.values[..]).collect()
}

/// The largest size of a signal at `share` of the rows.
fn size(outcome: &Outcome, signal: Signal, share: f64) -> f64 {
    let row = (share * (outcome.recording.t_s.len() - 1) as f64) as usize;
    columns(outcome, signal).iter().map(|values| values[row].abs()).fold(0.0, f64::max)
}

/// The largest of Σ |differences| of the signals over the rows from `share` on.
fn variation(outcome: &Outcome, signal: Signal, share: f64) -> f64 {
    let first = (share * outcome.recording.t_s.len() as f64) as usize;
    let total = |values: &&[f64]| values[first..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>();
    columns(outcome, signal).iter().map(total).fold(0.0, f64::max)
}

#[test]
fn explore() {
    for design in DESIGNS {
        for choice in [Choice::Implicit, Choice::Explicit, Choice::Layer { width: 0.05 }] {
            for digital in [false, true] {
                let mut it = setup(design, choice, 1.0, 30.0);
                it.time.record_every_s = 1e-3;
                if digital {
                    it = sampled(it);
                }
                let start = std::time::Instant::now();
                let outcome = simulate(&it, &mut |_| ControlFlow::Continue(())).unwrap();
                println!(
                    "{design:?} {choice:?} digital {digital}: {:?} residual {:?} wall {:?} steps {}",
                    outcome.ending,
                    outcome.statistics.sign_residual,
                    start.elapsed(),
                    outcome.statistics.steps
                );
                println!("   error {:?}", [0.0, 0.1, 0.25, 0.5, 0.75, 1.0].map(|s| size(&outcome, Signal::Error, s)));
                println!(
                    "   TV tau {:.4} dz {:.4} sign {:.3}",
                    variation(&outcome, Signal::Torque, 0.75),
                    variation(&outcome, Signal::Reference(1), 0.75),
                    variation(&outcome, Signal::Selection, 0.75)
                );
            }
        }
    }
}
