//! A tip with uncertain lengths (76)–(82), and an attitude without angular velocity (97)–(105): the identities of the proofs
//! along real runs, sampled runs, and what ends a run.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::controller::ParameterBounds;
use forwardstep_core::plant::{Wheel, Wheels};
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, Uncertain};
use forwardstep_core::robot::{PlanarLinks, PlanarTip};
use forwardstep_sim::recording::{Breakdown, BreakdownCause};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Spline, Trajectory};
use forwardstep_sim::{
    AgentSetup, AttitudeLaw, Axis, AxisUnit, Control, Ending, Exchange, Law, Method, Network, Outcome, ReferenceKind,
    RobotKind, RobotSetup, Setup, Signal, Solver, Start, TaskSpaceLaw, TimeSpan, TipSetup, simulate,
};

const RTOL: f64 = 1e-8;

fn axes(names: &[&str], unit: AxisUnit) -> Vec<Axis> {
    let axis = |name: &&str| Axis {
        name: (*name).into(),
        unit,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    names.iter().map(axis).collect()
}

fn alone(robot: RobotSetup, law: Law, start: Start, target: Vec<Path>, end_s: f64) -> Setup {
    let agent = AgentSetup {
        name: "agent".into(),
        robot,
        roots_per_s: Vec::new(),
        manipulability: 0.0,
        law,
        target: Some(Trajectory::new(target).unwrap()),
        start,
        enforce_limits: false,
        pushes: Vec::new(),
    };
    Setup {
        agents: vec![agent],
        reference: ReferenceKind::Tracking,
        exchange: Exchange::Position,
        network: Network {
            agents: 1,
            schedule: Schedule::Fixed(Vec::new()),
            delays: Vec::new(),
            weights: Vec::new(),
            coupling: Default::default(),
        },
        time: TimeSpan { end_s, record_every_s: 0.05 },
        solver: Solver { method: Method::Adaptive { rtol: RTOL, atol: 1e-11 }, ..Solver::default() },
        control: None,
    }
}

fn wave(offset: f64, amplitude: f64, rad_per_s: f64, phase_rad: f64) -> Path {
    Path::Sinusoids { offset, waves: vec![Sinusoid { amplitude, rad_per_s, phase_rad }] }
}

fn fixed(offset: f64) -> Path {
    Path::Sinusoids { offset, waves: Vec::new() }
}

fn through(values: [f64; 3]) -> Path {
    Path::Spline(Spline::new(vec![1.0, 6.0, 12.0], values.to_vec()).unwrap())
}

fn planar(bounds: Option<ParameterBounds>, kinematic_gain: f64) -> Setup {
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let robot = RobotSetup {
        kind: RobotKind::PlanarArm,
        theta: links.theta().to_vec(),
        theta_names: (0..5).map(|k| format!("p{k}")).collect(),
        axes: axes(&["shoulder", "elbow"], AxisUnit::Radian),
    };
    let law = TaskSpaceLaw {
        tip: TipSetup::Planar(PlanarTip { length_m: links.length_m }),
        damping: Gain::Number(20.0),
        adaptation: Gain::Number(30.0),
        estimate_start: vec![0.0; 5],
        task_gain: Gain::Number(20.0),
        kappa: 5.0,
        alpha_per_s: 3.0,
        kinematic_adaptation: Some(Gain::Number(kinematic_gain)),
        kinematic_names: vec!["length_1_m".into(), "length_2_m".into()],
        kinematic_start: vec![1.2, 0.96],
        bounds,
        determinant_floor: 0.01,
    };
    let start = Start { q: vec![0.2, 1.4], dq: vec![0.1, -0.2], rest: Vec::new(), reference: Vec::new() };
    let circle = vec![wave(0.8, 0.3, 1.0, FRAC_PI_2), wave(0.6, 0.3, 1.0, 0.0)];
    alone(robot, Law::TaskSpace(Box::new(law)), start, circle, 20.0)
}

/// Three joints, z up: a turntable, a shoulder and an elbow; damping in the shoulder.
fn anthropomorphic(uncertain: Uncertain) -> Setup {
    let link = |parent, offset: [f64; 3], axis, damping, reach: f64| LinkSpec {
        parent,
        x_parent_joint: Placement { translation: offset, ..Placement::IDENTITY },
        joint: LinkJoint::Moving { kind: JointKind::Revolute, axis, damping },
        inertia: [3.0, 3.0 * reach / 2.0, 0.0, 0.0, 0.02, 0.0, reach * reach + 0.02, 0.0, 0.0, reach * reach + 0.02],
    };
    let y = [0.0, 1.0, 0.0];
    let assembled = Tree::assemble(
        &[
            link(None, [0.0, 0.0, 0.3], [0.0, 0.0, 1.0], 0.0, 0.1),
            link(Some(0), [0.05, 0.1, 0.1], y, 2.0, 0.6),
            link(Some(1), [0.6, 0.0, 0.0], y, 0.0, 0.5),
        ],
        [0.0, 0.0, -9.81],
    )
    .unwrap();
    let point = LinkPoint { link: assembled.anchors[2], at: [0.5, 0.0, 0.02] };
    let (theta, p) = match uncertain {
        Uncertain::Tool => (vec![0.6, 0.05, 0.0], 3),
        Uncertain::Chain => (vec![0.05, 0.1, 0.1, 0.7, 0.0, 0.0, 0.6, 0.0, 0.02], 9),
    };
    let law = TaskSpaceLaw {
        tip: TipSetup::Point { point, coordinates: vec![0, 1, 2], uncertain },
        damping: Gain::Bandwidth(20.0),
        adaptation: Gain::Bandwidth(3.0),
        estimate_start: vec![0.0; assembled.theta.len()],
        task_gain: Gain::Diagonal(vec![20.0, 25.0, 15.0]),
        kappa: 5.0,
        alpha_per_s: 3.0,
        kinematic_adaptation: Some(Gain::Number(0.3)),
        kinematic_names: (0..p).map(|k| format!("t{k}")).collect(),
        kinematic_start: theta,
        bounds: None,
        determinant_floor: 0.01,
    };
    let robot = RobotSetup {
        theta_names: (0..assembled.theta.len()).map(|k| format!("p{k}")).collect(),
        theta: assembled.theta,
        kind: RobotKind::Tree(Arc::new(assembled.tree)),
        axes: axes(&["turntable", "shoulder", "elbow"], AxisUnit::Radian),
    };
    let start = Start { q: vec![0.3, -0.8, 1.5], dq: vec![0.0; 3], rest: Vec::new(), reference: Vec::new() };
    let path = vec![wave(0.6, 0.1, 1.0, 0.0), wave(0.25, 0.1, 0.7, 0.5), wave(0.3, 0.1, 1.3, 1.0)];
    alone(robot, Law::TaskSpace(Box::new(law)), start, path, 10.0)
}

fn craft(start: Start, target: Vec<Path>, torque_limit_n_m: f64) -> Setup {
    let wheel = |axis| Wheel { axis, torque_limit_n_m: Some(torque_limit_n_m), momentum_limit_n_m_s: Some(20.0) };
    let wheels =
        Wheels::new(&[[1.0, 0.0, 0.8], [-1.0, 0.0, 0.8], [0.0, 1.0, 0.8], [0.0, -1.0, 0.8]].map(wheel)).unwrap();
    let robot = RobotSetup {
        kind: RobotKind::Spacecraft { inertia_kg_m2: [[10.0, 0.5, -0.3], [0.5, 8.0, 0.2], [-0.3, 0.2, 6.0]], wheels },
        theta: Vec::new(),
        theta_names: Vec::new(),
        axes: axes(&["x", "y", "z", "o"], AxisUnit::One),
    };
    let law = AttitudeLaw { alpha: [0.5, 1.2], filter: Gain::Number(1.0), damping: Gain::Number(3.0) };
    alone(robot, Law::Attitude(Box::new(law)), start, target, 60.0)
}

fn half_a_turn(rate: [f64; 3]) -> Start {
    let half = 179.9_f64.to_radians() / 2.0;
    let axis = [1.0, 2.0, -1.0].map(|x| x / 6.0_f64.sqrt() * half.sin());
    Start {
        q: vec![axis[0], axis[1], axis[2], half.cos()],
        dq: rate.to_vec(),
        rest: vec![0.3, -0.2, 0.1, 0.4],
        reference: Vec::new(),
    }
}

/// Rest, a swing of sinusoids, and a path through points of a table.
fn targets() -> Vec<Vec<Path>> {
    let rest = vec![fixed(0.0), fixed(0.0), fixed(0.0), fixed(2.0)];
    let swing = vec![wave(0.1, 0.3, 0.4, 0.0), wave(0.0, 0.2, 0.3, 1.0), wave(0.0, 0.2, 0.5, 2.0), fixed(1.0)];
    // Half a turn and back to a quarter, rest before and after.
    let [x, z, o] = [[0.0, 0.6, 0.0], [0.0, 0.2, 0.7], [1.0, 0.8, 0.7]];
    let table = vec![through(x), fixed(0.0), through(z), through(o)];
    vec![rest, swing, table]
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn column(outcome: &Outcome, signal: Signal, axis: usize) -> &[f64] {
    let is_it = |c: &&forwardstep_sim::Column| c.signal == signal && c.axis == axis;
    &outcome.recording.columns.iter().find(is_it).unwrap().values
}

/// max |V + ∫ loss − V(0)| / V(0), and how much of V(0) was lost.
fn ledger(outcome: &Outcome) -> (f64, f64) {
    let (v, lost) = (column(outcome, Signal::Lyapunov, 0), column(outcome, Signal::Dissipation, 0));
    let error = v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs() / v[0]).fold(0.0, f64::max);
    (error, lost.last().unwrap() / v[0])
}

#[test]
fn thm6_identity_holds_along_real_runs() {
    let bounds = ParameterBounds { lower: vec![0.9, 0.7], upper: vec![1.1, 0.9], margin: 0.2 };
    let runs = [
        planar(None, 0.3),
        planar(Some(bounds), 0.3),
        anthropomorphic(Uncertain::Tool),
        anthropomorphic(Uncertain::Chain),
    ];
    for (index, setup) in runs.iter().enumerate() {
        let (error, lost) = ledger(&run(setup));
        assert!(error <= 10.0 * RTOL, "run {index}: {error}");
        assert!(lost > 0.01, "run {index} lost {lost}");
    }
}

#[test]
fn thm7_identity_holds_along_real_runs() {
    for (index, target) in targets().into_iter().enumerate() {
        let outcome = run(&craft(half_a_turn([0.1, -0.05, 0.08]), target, 5.0));
        let (error, lost) = ledger(&outcome);
        assert!(error <= 10.0 * RTOL, "target {index}: {error}");
        assert!(lost > 0.9, "target {index} lost {lost}");
        let angle = column(&outcome, Signal::Angle, 0);
        let (first, last) = (angle[0], *angle.last().unwrap());
        assert!(last < 1e-3 * first, "target {index}: {first} rad to {last} rad");
    }
}

/// From rest z and ω stay together, so that ẏ has nothing to do and V stays zero.
#[test]
fn thm7_from_rest_the_reference_is_followed_exactly() {
    let outcome = run(&craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0));
    let v = column(&outcome, Signal::Lyapunov, 0).iter().fold(0.0_f64, |most, v| most.max(*v));
    assert!(v < 1e-12, "{v}");
    assert!(column(&outcome, Signal::Angle, 0).last().unwrap() < &3e-3);
}

#[test]
fn prop_sampled_systems_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let mut craft = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(1), 5.0);
    let mut arm = planar(None, 0.3);
    for setup in [&mut craft, &mut arm] {
        setup.time.end_s = 3.0;
        let continuous = run(setup);
        let gaps: Vec<f64> = [200.0, 400.0, 800.0]
            .into_iter()
            .map(|sample_hz| {
                setup.control = Some(Control {
                    sample_hz,
                    computation_delay_s: 0.0,
                    sensors: Default::default(),
                    actuators: Default::default(),
                });
                let sampled = run(setup);
                let end = |outcome: &Outcome| *column(outcome, Signal::Position, 0).last().unwrap();
                (end(&sampled) - end(&continuous)).abs()
            })
            .collect();
        for pair in gaps.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((0.8..1.25).contains(&order), "{gaps:?}");
        }
    }
}

#[test]
fn prop_wheels_keep_to_their_limits_when_asked() {
    for enforced in [false, true] {
        let mut setup = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(0), 0.5);
        setup.agents[0].enforce_limits = enforced;
        setup.control = Some(Control {
            sample_hz: 50.0,
            computation_delay_s: 0.0,
            sensors: Default::default(),
            actuators: Default::default(),
        });
        setup.time.end_s = 20.0;
        let outcome = run(&setup);
        let largest = (0..4)
            .flat_map(|wheel| column(&outcome, Signal::WheelTorque, wheel))
            .fold(0.0_f64, |most, u| most.max(u.abs()));
        assert_eq!(largest <= 0.5, enforced, "{largest} N m");
    }
}

#[test]
fn thm6_a_run_ends_when_an_aggressive_gain_drives_the_jacobian_to_singularity() {
    let outcome = simulate(&planar(None, 300.0), &mut |_| ControlFlow::Continue(())).unwrap();
    let Ending::BrokeDown(Breakdown { signal, cause, .. }) = outcome.ending else { panic!("{:?}", outcome.ending) };
    assert_eq!(signal, Signal::Determinant);
    assert!(matches!(cause, BreakdownCause::Vanished { .. }), "{cause:?}");
}
