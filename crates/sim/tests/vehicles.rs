//! Vehicles with one thrust, (44)–(58), and rotorcraft: the identities of the proofs along real runs, agreement, formations.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;

use forwardstep_core::Gain;
use forwardstep_core::controller::{Floor, Yaw};
use forwardstep_core::plant::Rotors;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::vehicles::{ThrustKind, ThrustLaw};
use forwardstep_sim::{
    AgentSetup, Axis, AxisUnit, BreakdownCause, Control, Ending, Exchange, Law, Method, Network, Outcome,
    ReferenceKind, RobotKind, RobotSetup, Setup, SetupError, Signal, Solver, Start, TimeSpan, simulate,
};

const G: f64 = 9.81;
const RTOL: f64 = 1e-8;
const DIFFERENTIABLE: ThrustKind = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
const ADAPTIVE: ThrustKind = ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 0.8 };

fn rotorcraft() -> RobotKind {
    RobotKind::Rotorcraft {
        gravity: G,
        inertia: Gain::Matrix(vec![0.02, 0.001, 0.0, 0.001, 0.02, 0.0, 0.0, 0.0, 0.04]),
        rotors: None,
    }
}

fn agent(index: usize, kind: RobotKind, design: ThrustKind) -> AgentSetup {
    let axis = |name: &str| Axis {
        name: name.into(),
        unit: AxisUnit::Metre,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    let kg = 1.0 + 0.3 * index as f64;
    let q = [[1.0, 0.0, -1.0], [0.0, 1.5, -2.0], [-1.0, 0.5, -1.5]][index];
    let mut rest = vec![0.0, 0.0, 0.0, 1.0];
    rest.resize(kind.rest_len(), 0.0);
    AgentSetup {
        name: format!("craft-{index}"),
        robot: RobotSetup {
            kind,
            theta: vec![kg],
            theta_names: vec!["mass".into()],
            axes: vec![axis("x"), axis("y"), axis("z")],
        },
        roots_per_s: vec![1.0, 1.5, 2.0][..design.order()].to_vec(),
        manipulability: 0.0,
        law: Law::Thrust(ThrustLaw {
            design,
            yaw: Yaw { heading: 0.5, rate: 0.0, gain: 1.0 },
            floor: Floor::Stops(1.0),
            thrust_start: None,
            bandwidth_per_s: 30.0,
        }),
        target: None,
        start: Start { q: q.to_vec(), dq: vec![0.2, -0.1, 0.1], rest, reference: vec![vec![0.0; 3]] },
        enforce_limits: false,
        pushes: Vec::new(),
    }
}

/// A circle of radius one about where all agree, and a drift.
fn turning(index: usize) -> Trajectory {
    let phase_rad = 2.1 * index as f64;
    let wave = |phase_rad| Sinusoid { amplitude: 1.0, rad_per_s: 0.4, phase_rad };
    let path = |offset, waves| Path::Sinusoids { offset, waves };
    Trajectory::new(vec![
        path(0.0, vec![wave(phase_rad)]),
        path(0.0, vec![wave(phase_rad + core::f64::consts::FRAC_PI_2)]),
        path(-0.2 * index as f64, Vec::new()),
    ])
    .unwrap()
}

fn setup(agents: Vec<AgentSetup>, end_s: f64) -> Setup {
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let phase = |edges| Phase { dwell_s: 0.8, edges };
    let schedule = Schedule::Periodic(vec![phase(vec![edge(0, 1), edge(1, 0)]), phase(vec![edge(1, 2), edge(2, 0)])]);
    let network = Network {
        agents: agents.len(),
        schedule,
        delays: vec![Delay::SawTooth { min_s: 0.05, max_s: 0.3, period_s: 0.5, offset_s: 0.0 }],
        weights: Vec::new(),
    };
    Setup {
        agents,
        reference: ReferenceKind::Consensus,
        exchange: Exchange::Position,
        network,
        time: TimeSpan { end_s, record_every_s: 0.05 },
        solver: Solver { method: Method::Adaptive { rtol: RTOL, atol: 1e-10 }, ..Solver::default() },
        control: None,
    }
}

fn three(kind: &RobotKind, design: ThrustKind, in_formation: bool, end_s: f64) -> Setup {
    let agents =
        (0..3).map(|k| AgentSetup { target: in_formation.then(|| turning(k)), ..agent(k, kind.clone(), design) });
    setup(agents.collect(), end_s)
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

fn last(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> f64 {
    *column(outcome, agent, signal, axis).last().unwrap()
}

/// max |V + ∫ dissipation − V(0)| / V(0).
fn ledger_error(outcome: &Outcome, agent: usize) -> f64 {
    let v = column(outcome, agent, Signal::Lyapunov, 0);
    let lost = column(outcome, agent, Signal::Dissipation, 0);
    v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs() / v[0]).fold(0.0, f64::max)
}

/// max over agents and axes of the spread of x − d, at the end.
fn spread(setup: &Setup, outcome: &Outcome) -> f64 {
    let centre = |agent: usize, axis: usize| {
        let away = setup.agents[agent].target.as_ref().map_or(0.0, |_| last(outcome, agent, Signal::Offset, axis));
        last(outcome, agent, Signal::Position, axis) - away
    };
    let axes = (0..3).map(|axis| {
        let all = (0..setup.agents.len()).map(|agent| centre(agent, axis));
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    });
    axes.fold(0.0, f64::max)
}

#[test]
fn thm4_and_thm5_lyapunov_functions_lose_what_their_proofs_say_along_real_runs() {
    for kind in [RobotKind::Vehicle { gravity: G }, rotorcraft()] {
        for design in [DIFFERENTIABLE, ADAPTIVE] {
            for in_formation in [false, true] {
                let setup = three(&kind, design, in_formation, 15.0);
                let outcome = run(&setup);
                for agent in 0..3 {
                    let error = ledger_error(&outcome, agent);
                    assert!(error <= 10.0 * RTOL, "{kind:?} {design:?} {in_formation} {agent}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn thm4_and_thm5_vehicles_agree_over_switching_delayed_links() {
    for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE] {
        let setup = three(&RobotKind::Vehicle { gravity: G }, design, false, 60.0);
        let outcome = run(&setup);
        assert!(spread(&setup, &outcome) < 2e-3, "{design:?}: {}", spread(&setup, &outcome));
        for agent in 0..3 {
            let speed = (0..3).map(|axis| last(&outcome, agent, Signal::Velocity, axis).abs()).fold(0.0, f64::max);
            assert!(speed < 2e-3, "{design:?}: {speed}");
            let norm: f64 = (0..4).map(|k| last(&outcome, agent, Signal::Attitude, k).powi(2)).sum();
            assert!((norm - 1.0).abs() < 1e-14, "{norm}");
            if let ThrustKind::Adaptive { .. } = design {
                // Gravity excites the estimate for ever: the mass is found, and s tends to a constant.
                let (mass, found) = (setup.agents[agent].robot.theta[0], last(&outcome, agent, Signal::Estimate, 0));
                assert!((mass - found).abs() < 1e-3, "{found} for {mass}");
            }
        }
    }
}

#[test]
fn formations_turn_about_a_point_that_is_agreed_upon() {
    for kind in [RobotKind::Vehicle { gravity: G }, rotorcraft()] {
        for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE] {
            if matches!((&kind, design), (RobotKind::Rotorcraft { .. }, ThrustKind::Continuous)) {
                // Its ω jumps and its rate cannot be foreseen: the rate loop lags behind for ever.
                continue;
            }
            let setup = three(&kind, design, true, 60.0);
            let outcome = run(&setup);
            assert!(spread(&setup, &outcome) < 3e-3, "{kind:?} {design:?}: {}", spread(&setup, &outcome));
        }
    }
}

#[test]
fn prop_sampled_vehicles_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for (kind, design) in [
        (RobotKind::Vehicle { gravity: G }, ThrustKind::Continuous),
        (RobotKind::Vehicle { gravity: G }, DIFFERENTIABLE),
        (RobotKind::Vehicle { gravity: G }, ADAPTIVE),
        (rotorcraft(), DIFFERENTIABLE),
        (rotorcraft(), ADAPTIVE),
    ] {
        let mut setup = three(&kind, design, true, 2.0);
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
                let each = (0..9).map(|k| {
                    let end = |outcome: &Outcome| last(outcome, k / 3, Signal::Position, k % 3);
                    (end(&sampled) - end(&continuous)).abs()
                });
                each.fold(0.0, f64::max)
            })
            .collect();
        for pair in gaps.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.7..1.3).contains(&order), "{kind:?} {design:?}: {gaps:?}");
        }
    }
}

#[test]
fn thrust_that_vanishes_stops_the_run_before_it_is_zero_or_is_kept_away() {
    let mut setup = three(&RobotKind::Vehicle { gravity: G }, DIFFERENTIABLE, false, 6.0);
    // One far above the others: it wants to fall faster than it can.
    setup.agents[0].start.q[2] = -150.0;
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let Ending::BrokeDown(breakdown) = outcome.ending else { panic!("{:?}", outcome.ending) };
    assert_eq!((breakdown.agent, breakdown.signal), (0, Signal::Thrust));
    let BreakdownCause::Vanished { value, floor } = breakdown.cause else { panic!("{:?}", breakdown.cause) };
    assert!(floor == 1.0 && value > 0.0 && value <= floor, "{value}");
    for agent in &mut setup.agents {
        let Law::Thrust(law) = &mut agent.law else { panic!() };
        law.floor = Floor::Kept { floor: 1.0, approach_s: 0.1 };
    }
    let kept = run(&setup);
    let least = column(&kept, 0, Signal::Thrust, 0).iter().copied().fold(f64::MAX, f64::min);
    assert!(least > 1.0 && least < 2.0, "the floor is approached, never crossed: {least}");
}

#[test]
fn prop_rotors_stay_within_their_limits_and_slow_the_formation_down() {
    let RobotKind::Rotorcraft { gravity, inertia, .. } = rotorcraft() else { panic!() };
    let rotors = Rotors { offset: 0.15, drag: 0.02, thrust: [0.3, 4.5] };
    let kind = RobotKind::Rotorcraft { gravity, inertia, rotors: Some(rotors) };
    let setup = three(&kind, DIFFERENTIABLE, false, 60.0);
    let outcome = run(&setup);
    let rows = outcome.recording.t_s.len();
    let mut reached = false;
    for agent in 0..3 {
        for row in 0..rows {
            let tau = [0, 1, 2].map(|axis| column(&outcome, agent, Signal::Torque, axis)[row]);
            let thrusts = rotors.thrusts(column(&outcome, agent, Signal::Thrust, 0)[row], tau);
            assert!(thrusts.iter().all(|t| (0.3 - 1e-9..=4.5 + 1e-9).contains(t)), "{thrusts:?}");
            reached |= thrusts.iter().any(|t| !(0.3 + 1e-9..=4.5 - 1e-9).contains(t));
        }
    }
    assert!(reached, "limits that bite");
    assert!(spread(&setup, &outcome) < 5e-3, "{}", spread(&setup, &outcome));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = three(&RobotKind::Vehicle { gravity: G }, DIFFERENTIABLE, false, 1.0);
    let refused = |change: &dyn Fn(&mut Setup)| {
        let mut setup = good.clone();
        change(&mut setup);
        simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    let law = |setup: &mut Setup, change: &dyn Fn(&mut ThrustLaw)| {
        let Law::Thrust(law) = &mut setup.agents[1].law else { panic!() };
        change(law);
    };
    assert!(matches!(refused(&|s| s.exchange = Exchange::PositionVelocity), SetupError::SendsPositionOnly { .. }));
    assert!(matches!(refused(&|s| s.agents[1].roots_per_s.truncate(2)), SetupError::Length { .. }));
    assert!(matches!(refused(&|s| s.agents[1].robot.kind = RobotKind::PlanarArm), SetupError::LawOfAnother { .. }));
    assert!(matches!(refused(&|s| s.agents[1].manipulability = 0.5), SetupError::LawNumber { .. }));
    assert!(matches!(refused(&|s| s.agents[1].start.rest = vec![0.0; 3]), SetupError::Length { .. }));
    assert!(matches!(refused(&|s| s.agents[1].robot.theta[0] = -1.0), SetupError::LawNumber { .. }));
    assert!(matches!(refused(&|s| law(s, &|law| law.floor = Floor::Stops(0.0))), SetupError::LawNumber { .. }));
    assert!(matches!(refused(&|s| s.reference = ReferenceKind::Tracking), SetupError::NotTracking { .. }));
    let known = Law::Known { damping: Gain::Number(1.0) };
    assert!(matches!(refused(&|s| s.agents[1].law = known.clone()), SetupError::LawOfAnother { .. }));
    let flat = RobotKind::Rotorcraft { gravity: G, inertia: Gain::Diagonal(vec![1.0, 1.0, 0.0]), rotors: None };
    let refused_flat = refused(&|s| {
        s.agents[1].robot.kind = flat.clone();
        s.agents[1].start.rest = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    });
    assert!(matches!(refused_flat, SetupError::Gain { .. }));
}
