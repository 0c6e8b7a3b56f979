//! What acts from outside does what it says, when it says so, and the Lyapunov balance holds all the same.

use forwardstep_sim::reference::Consensus;
use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{
    Axes, JointKind, LinkJoint, LinkPoint, LinkSpec, Placement, Tree, inertia_about_frame,
};
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip, PointMass};
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::push::{AttachmentPoint, Between, Course, Effect, Function, Push, PushError, Table};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Ending, Exchange, Known, Law, Method, Network, Outcome, Robot, RobotSetup,
    Setup, SetupError, Signal, Solver, Start, TimeSpan, simulate,
};

const MASS: f64 = 2.0;
const DAMPING: f64 = 6.0;

fn agent(kind: Arc<dyn Robot>, theta: Vec<f64>, axes: usize, law: Arc<dyn Law>) -> AgentSetup {
    let axis = |k: usize| Axis {
        name: format!("{k}"),
        unit: AxisUnit::Radian,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    AgentSetup {
        name: "agent".into(),
        robot: RobotSetup {
            kind,
            theta_names: vec![String::new(); theta.len()],
            theta,
            axes: (0..axes).map(axis).collect(),
        },
        roots_per_s: vec![1.0, 2.0].into(),
        manipulability: 0.0,
        law,
        start: Start { q: vec![0.0; axes], dq: vec![0.0; axes], rest: Vec::new(), reference: Vec::new() },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

/// A mass on a line whose parameters are known: m ṡ = −K s + τ_ext.
fn mass(pushes: Vec<Push>) -> AgentSetup {
    let law = Arc::new(Known { damping: Gain::Number(DAMPING) });
    AgentSetup { pushes, ..agent(Arc::new(PointMass { dimension: 1 }), vec![MASS], 1, law) }
}

fn alone(agents: Vec<AgentSetup>, end_s: f64) -> Setup {
    Setup {
        network: Network {
            agents: agents.len(),
            schedule: Schedule::fixed(Vec::new()),
            delays: Vec::new(),
            weights: Vec::new(),
            coupling: Default::default(),
        },
        agents,
        reference: Arc::new(Consensus),
        exchange: Exchange::Position,
        time: TimeSpan { end_s, record_every_s: 0.125, record_at: forwardstep_sim::RecordAt::Intervals },
        solver: Solver { method: Method::Adaptive { rtol: 1e-10, atol: 1e-12 }, ..Solver::default() },
        control: None,
    }
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let found = outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, signal, axis));
    &found.unwrap().values
}

fn constant(values: &[f64]) -> Course {
    Course::Each(values.iter().map(|value| Function::Constant(*value)).collect())
}

fn torque(course: Course, from_s: f64, until_s: f64) -> Push {
    Push { effect: Effect::Torque(course), from_s, until_s }
}

fn table(times_s: &[f64], values: &[f64], between: Between) -> Course {
    Course::Table(Table { times_s: times_s.to_vec(), values: values.to_vec(), between })
}

/// s at the end of pieces of which each lasts so long with τ_ext = a + b t.
fn exact(pieces: &[(f64, f64, f64)]) -> f64 {
    let lag = MASS / DAMPING;
    pieces.iter().fold(0.0, |s, &(lasts_s, a, b)| {
        let follows = |t: f64| a / DAMPING + b / DAMPING * (t - lag);
        follows(lasts_s) + (s - follows(0.0)) * (-lasts_s / lag).exp()
    })
}

fn close(outcome: &Outcome, t_s: f64, want: f64) {
    let row = outcome.recording.t_s.iter().position(|t| *t == t_s).unwrap();
    let s = column(outcome, 0, Signal::TrackingError, 0)[row];
    assert!((s - want).abs() < 1e-9, "s({t_s}) is {s}, not {want}");
}

#[test]
fn a_pulse_does_what_linear_systems_say() {
    let outcome = run(&alone(vec![mass(vec![torque(constant(&[5.0]), 1.0, 1.5)])], 4.0));
    close(&outcome, 1.0, 0.0);
    close(&outcome, 1.25, exact(&[(0.25, 5.0, 0.0)]));
    close(&outcome, 3.0, exact(&[(0.5, 5.0, 0.0), (1.5, 0.0, 0.0)]));
    // Rows hold values from the right where it jumps.
    let external = column(&outcome, 0, Signal::External, 0);
    assert_eq!(external[7..14], [0.0, 5.0, 5.0, 5.0, 5.0, 0.0, 0.0]);
}

#[test]
fn tables_are_straight_or_held_between_their_rows_and_nothing_outside() {
    let (times, values) = ([0.5, 1.5, 2.0], [1.0, 4.0, -2.0]);
    let line = run(&alone(vec![mass(vec![torque(table(&times, &values, Between::Linear), 0.0, 9.0)])], 4.0));
    close(&line, 0.5, 0.0);
    close(&line, 1.0, exact(&[(0.5, 1.0, 3.0)]));
    close(&line, 3.0, exact(&[(1.0, 1.0, 3.0), (0.5, 4.0, -12.0), (1.0, 0.0, 0.0)]));

    let steps = torque(table(&times, &values, Between::Hold), 0.0, f64::INFINITY);
    let held = run(&alone(vec![mass(vec![steps.clone()])], 4.0));
    close(&held, 3.0, exact(&[(1.0, 1.0, 0.0), (0.5, 4.0, 0.0), (1.0, 0.0, 0.0)]));
    // The same as pulses one after the other, which add where they overlap.
    let pulses = vec![torque(constant(&[1.0]), 0.5, 2.0), torque(constant(&[3.0]), 1.5, 2.0)];
    let pulses = run(&alone(vec![mass(pulses)], 4.0));
    assert_eq!(pulses.recording, held.recording);

    // Cut to the times of the push.
    let cut = run(&alone(vec![mass(vec![Push { from_s: 1.0, until_s: 1.75, ..steps }])], 4.0));
    close(&cut, 3.0, exact(&[(0.5, 1.0, 0.0), (0.25, 4.0, 0.0), (1.25, 0.0, 0.0)]));
}

#[test]
fn formulas_are_functions_of_the_time_of_the_run() {
    let formula = (Expression::variable(0) * 2.0).sin_of() * 3.0;
    let push = torque(Course::Each(vec![Function::Formula(formula)]), 0.0, f64::INFINITY);
    let outcome = run(&alone(vec![mass(vec![push])], 4.0));
    let (reactance, lag) = (2.0 * MASS, MASS / DAMPING);
    let share = 3.0 / (DAMPING * DAMPING + reactance * reactance);
    let s = |t: f64| {
        share * (DAMPING * (2.0 * t).sin() - reactance * (2.0 * t).cos()) + share * reactance * (-t / lag).exp()
    };
    for t_s in [0.5, 1.0, 3.5] {
        close(&outcome, t_s, s(t_s));
    }
}

#[test]
fn a_virtual_spring_pulls_and_damps() {
    // Held against the law: at rest q = z = 0 gives nothing back for λ = 0, so the mass settles elsewhere.
    let spring = Push {
        effect: Effect::SpringOnAxes {
            axes: vec![0],
            stiffness: vec![30.0],
            damping: vec![2.0],
            target: table(&[0.0, 2.0], &[0.0, 1.0], Between::Linear),
        },
        from_s: 0.0,
        until_s: 2.0,
    };
    let outcome = run(&alone(vec![mass(vec![spring])], 3.0));
    let (q, dq) = (column(&outcome, 0, Signal::Position, 0), column(&outcome, 0, Signal::Velocity, 0));
    let external = column(&outcome, 0, Signal::External, 0);
    for (row, t_s) in outcome.recording.t_s.iter().enumerate() {
        let want = if *t_s < 2.0 { 30.0 * (0.5 * t_s - q[row]) - 2.0 * dq[row] } else { 0.0 };
        assert!((external[row] - want).abs() < 1e-12, "at {t_s} s: {} is not {want}", external[row]);
    }
    assert!(external.iter().any(|f| *f > 1.0));
}

#[test]
fn steps_land_on_the_edges_of_a_pulse() {
    // With fixed steps that know nothing of the edges the error would fall like the step, not like its fourth power.
    let want = exact(&[(0.38, 5.0, 0.0), (0.59, 0.0, 0.0)]);
    let error = |step_s: f64| {
        let mut setup = alone(vec![mass(vec![torque(constant(&[5.0]), 1.03, 1.41)])], 2.0);
        setup.solver.method = Method::Fixed { step_s };
        let outcome = run(&setup);
        (column(&outcome, 0, Signal::TrackingError, 0).last().unwrap() - want).abs()
    };
    let (coarse, fine) = (error(0.08), error(0.04));
    let order = (coarse / fine).log2();
    assert!(order > 3.5 && coarse < 1e-4, "errors {coarse:e} and {fine:e}, order {order}");
}

fn arm() -> AgentSetup {
    let links = PlanarLinks::uniform([1.2, 1.0], [1.0, 0.8]);
    let law = Arc::new(Adaptive {
        damping: Gain::Number(8.0),
        adaptation: Gain::Number(10.0),
        estimate_start: vec![0.0; 5],
        bounds: None,
    });
    let mut arm = agent(Arc::new(PlanarArm), links.theta().to_vec(), 2, law);
    arm.start.q = vec![0.4, -0.3];
    arm
}

/// Two joints and a tool that is rigid with the second link.
fn jointed() -> (AgentSetup, LinkPoint) {
    let link = |parent, xyz: [f64; 3], joint| LinkSpec {
        parent,
        x_parent_joint: Placement::from_xyz_rpy(xyz, [0.3, -0.2, 0.1]),
        joint,
        inertia: inertia_about_frame(1.5, [0.1, 0.05, 0.2], [0.02, 0.0, 0.03, 0.0, 0.0, 0.025]),
    };
    let moving = |axis| LinkJoint::Moving { kind: JointKind::Revolute, axis, damping: 0.4 };
    let links = [
        link(None, [0.0; 3], moving([0.0, 0.0, 1.0])),
        link(Some(0), [0.1, 0.0, 0.3], moving([0.0, 1.0, 0.0])),
        link(Some(1), [0.0, 0.0, 0.4], LinkJoint::Fixed),
    ];
    let assembled = Tree::assemble(&links, [0.0, 0.0, -9.81]).unwrap();
    let law = Arc::new(Adaptive {
        damping: Gain::Bandwidth(15.0),
        adaptation: Gain::Bandwidth(5.0),
        estimate_start: vec![0.0; assembled.theta.len()],
        bounds: None,
    });
    let point = LinkPoint { link: assembled.anchors[2], at: [0.0, 0.1, 0.2] };
    (agent(Arc::new(Arc::new(assembled.tree)), assembled.theta, 2, law), point)
}

#[test]
fn thm_the_lyapunov_balance_holds_while_pushed() {
    let rtol = 1e-8;
    let tip = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 0.8] });
    let (tree, point) = jointed();
    let link = |axes| AttachmentPoint::Link { point, axes };
    let spring =
        |at, target: &[f64], stiffness| Effect::SpringOnPoint { at, stiffness, damping: 3.0, target: constant(target) };
    let pulse = |effect| Push { effect, from_s: 0.7, until_s: 2.2 };
    let cases = [
        (arm(), pulse(Effect::Torque(constant(&[6.0, -3.0])))),
        (arm(), pulse(Effect::Wrench { at: tip, wrench: constant(&[5.0, 4.0, 1.0]) })),
        (arm(), pulse(spring(tip, &[0.5, 1.0], 25.0))),
        (
            tree.clone(),
            pulse(Effect::Wrench { at: link(Axes::Base), wrench: constant(&[9.0, 4.0, 2.0, 0.0, 1.0, 1.0]) }),
        ),
        (
            tree.clone(),
            pulse(Effect::Wrench { at: link(Axes::Link), wrench: constant(&[9.0, 4.0, 2.0, 0.0, 1.0, 1.0]) }),
        ),
        (tree, pulse(spring(link(Axes::Base), &[0.3, 0.3, 0.4], 60.0))),
    ];
    for (robot, push) in cases {
        let mut agents = vec![robot.clone(), robot];
        agents[1].name = "other".into();
        agents[1].start.q = vec![-0.2, 0.5];
        agents[0].pushes = vec![push];
        let edge = |from, to| Edge { from, to, weight: 1.0.into(), delay: 0 };
        let mut setup = alone(agents, 4.0);
        setup.network.schedule = Schedule::fixed(vec![edge(0, 1), edge(1, 0)]);
        setup.network.delays = vec![Delay::new(SawTooth { min_s: 0.1, max_s: 0.3, period_s: 0.4, offset_s: 0.0 })];
        setup.exchange = Exchange::PositionVelocity;
        setup.solver.method = Method::Adaptive { rtol, atol: 1e-10 };
        let outcome = run(&setup);
        for agent in 0..2 {
            let v = column(&outcome, agent, Signal::Lyapunov, 0);
            let lost = column(&outcome, agent, Signal::Dissipation, 0);
            let scale = v.iter().fold(0.0, |most: f64, v| most.max(*v));
            let gaps = v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs());
            let worst = gaps.fold(0.0, f64::max) / scale;
            assert!(worst <= 10.0 * rtol, "{:?}: {worst:e}", setup.agents[0].pushes[0].effect);
        }
        // Only who is pushed has the column, and what was done to it is not nothing.
        let pushed: Vec<usize> =
            outcome.recording.columns.iter().filter(|c| c.signal == Signal::External).map(|c| c.agent).collect();
        assert_eq!(pushed, [0, 0]);
        assert!((0..2).any(|axis| column(&outcome, 0, Signal::External, axis).iter().any(|f| f.abs() > 0.5)));
    }
}

#[test]
fn pushes_without_meaning_are_refused() {
    let refused = |agent: AgentSetup, push: Push| {
        let mut setup = alone(vec![agent], 1.0);
        setup.agents[0].pushes = vec![torque(constant(&[0.0; 2][..setup.agents[0].robot.axes.len()]), 0.0, 1.0), push];
        match simulate(&setup, &mut |_| ControlFlow::Continue(())) {
            Err(SetupError::Push { push: 2, error, .. }) => error,
            other => panic!("{other:?}"),
        }
    };
    let one = || mass(Vec::new());
    let always = |effect| Push { effect, from_s: 0.0, until_s: f64::INFINITY };
    let spring = |axes: &[usize], k: f64, target| {
        let (stiffness, damping) = (vec![k; axes.len()], vec![0.0; axes.len()]);
        always(Effect::SpringOnAxes { axes: axes.to_vec(), stiffness, damping, target })
    };
    assert_eq!(refused(one(), torque(constant(&[1.0]), 2.0, 1.0)), PushError::Times { from_s: 2.0, until_s: 1.0 });
    assert_eq!(
        refused(one(), always(Effect::Torque(constant(&[1.0, 2.0])))),
        PushError::Length { what: "the torque", need: 1, got: 2 }
    );
    assert_eq!(refused(one(), spring(&[1], 1.0, constant(&[1.0]))), PushError::NoSuchAxis { axis: 1, axes: 1 });
    assert_eq!(refused(one(), spring(&[0], -1.0, constant(&[1.0]))), PushError::Negative { value: -1.0 });
    let tip = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 1.0] });
    assert_eq!(
        refused(one(), always(Effect::Wrench { at: tip, wrench: constant(&[0.0; 3]) })),
        PushError::AttachmentPoint
    );
    let (tree, mut point) = jointed();
    point.link.body = Some(7);
    let at = AttachmentPoint::Link { point, axes: Axes::Base };
    assert_eq!(
        refused(tree, always(Effect::Wrench { at, wrench: constant(&[0.0; 6]) })),
        PushError::NoSuchBody { body: 7, bodies: 2 }
    );
    for (times, values) in [(vec![0.0], vec![1.0]), (vec![0.0, 0.0], vec![1.0, 2.0]), (vec![0.0, 1.0], vec![1.0; 3])] {
        let course = Course::Table(Table { times_s: times, values, between: Between::Hold });
        assert_eq!(refused(one(), torque(course, 0.0, 1.0)), PushError::Table);
    }
    assert!(matches!(
        refused(one(), torque(table(&[0.0, 1.0], &[1.0, f64::NAN], Between::Hold), 0.0, 1.0)),
        PushError::NotFinite { .. }
    ));
}
