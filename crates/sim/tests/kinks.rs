//! Formulas with kinks: leaders, targets, offsets, delays, weights and pushes. Steps end there, and derivatives are one-sided.

use std::ops::ControlFlow;

use crate::common::following::{COMPOSITE, DESIGNS, masses};
use crate::common::{apart, column, columns, consensus_of_masses, last, run, sampled, vehicles};
use forwardstep_core::expression::{Expression, KinkError};
use forwardstep_core::reference::Choice;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Spline, Trajectory, TrajectoryError};
use forwardstep_sim::{Exchange, Method, Outcome, Setup, SetupError, Signal, ThrustKind, simulate};

fn t() -> Expression {
    Expression::variable(0)
}

/// |sin ω t|, with kinks at the multiples of π/ω.
fn bounce(rad_per_s: f64) -> Expression {
    (t() * rad_per_s).sin_of().abs_of()
}

fn along(axes: Vec<Expression>) -> Trajectory {
    Trajectory::new(axes.into_iter().map(Path::Formula).collect()).unwrap()
}

fn led_along(design: FollowingDesign, path: Expression, end_s: f64) -> Setup {
    let mut setup = masses(design);
    assert!(setup.change_reference(|following: &mut Following| following.leader =
        Leading::Motion(Leader { name: "leader".into(), trajectory: along(vec![path]) })));
    setup.time.end_s = end_s;
    setup
}

/// The same system from where the run has ended.
fn continued(mut setup: Setup, from: &Outcome) -> Setup {
    for (k, agent) in setup.agents.iter_mut().enumerate() {
        agent.start.q = vec![last(from, k, Signal::Position, 0)];
        agent.start.dq = vec![last(from, k, Signal::Velocity, 0)];
        for (order, wanted) in agent.start.reference.iter_mut().enumerate() {
            *wanted = vec![last(from, k, Signal::Reference(order as u8), 0)];
        }
    }
    setup
}

/// The largest gap between a run with a leader along `path`, and three runs one after the other along `piece`, `piece` shifted
/// by `turn_s`, and so on, each beginning at a time zero of its own.
fn gap_to_pieces(design: FollowingDesign, path: &Expression, pieces: &[Expression], turn_s: f64) -> f64 {
    let end_s = (pieces.len() as f64 - 0.7) * turn_s;
    let whole = run(&led_along(design, path.clone(), end_s));
    // The leader itself is where it says: an error is measured against its motion.
    for (row, t_s) in whole.recording.t_s.iter().enumerate() {
        let leader = column(&whole, 0, Signal::Position, 0)[row] - column(&whole, 0, Signal::Error, 0)[row];
        assert!((leader - path.eval(*t_s)).abs() < 1e-8, "{design:?} at {t_s}: {leader} {}", path.eval(*t_s));
    }
    let mut before: Option<Outcome> = None;
    for (k, path) in pieces.iter().enumerate() {
        let lasts_s = if k + 1 < pieces.len() { turn_s } else { 0.3 * turn_s };
        let piece = led_along(design, path.clone(), lasts_s);
        before = Some(run(&before.map_or_else(|| piece.clone(), |before| continued(piece.clone(), &before))));
    }
    apart(&whole, &before.unwrap())
}

#[test]
fn a_follower_of_a_leader_with_kinks_ends_where_the_run_in_pieces_ends() {
    let omega = 0.8;
    let turn_s = core::f64::consts::PI / omega;
    let swing = || (t() * omega).sin_of();
    let hop = swing() * 0.6 + 0.1;
    let gap = gap_to_pieces(
        FollowingDesign::Continuous,
        &(bounce(omega) * 0.6 + 0.1),
        &[hop.clone(), hop.clone(), hop],
        turn_s,
    );
    assert!(gap < 1e-7, "{gap:e}");
    // Reference accelerations of the others hold the leader's velocity, so that theirs must be continuous: its acceleration jumps.
    let (up, down) = (swing() * swing() * 0.6, -(swing() * swing() * 0.6));
    for design in [DESIGNS[0], DESIGNS[1], DESIGNS[2], COMPOSITE] {
        let gap =
            gap_to_pieces(design, &(swing() * bounce(omega) * 0.6), &[up.clone(), down.clone(), up.clone()], turn_s);
        assert!(gap < 1e-7, "{design:?}: {gap:e}");
    }
}

/// A curve through points begins and ends at rest without an acceleration, so that what the leader tells has no jump there, and nothing of it
/// stays with those who agree on that.
#[test]
fn nothing_of_the_last_acceleration_of_a_table_stays_in_what_is_told() {
    for sample_hz in [None, Some(200.0)] {
        let mut setup = masses(COMPOSITE);
        let curve = || Path::Spline(Spline::new(vec![0.5, 2.0, 3.0], vec![0.0, 0.4, 1.0]).unwrap());
        assert!(setup.change_reference(|following: &mut Following| {
            let trajectory = Trajectory::new(vec![curve()]).unwrap();
            for t_s in [0.5, 3.0] {
                let [mut before, mut after] = [[[0.0; 5]]; 2];
                trajectory.jets(t_s - 1e-9, &mut before);
                trajectory.jets(t_s + 1e-9, &mut after);
                assert!((0..3).all(|k| (before[0][k] - after[0][k]).abs() < 1e-6), "{before:?} {after:?}");
            }
            following.leader = Leading::Motion(Leader { name: "leader".into(), trajectory });
            following.gain = 20.0;
        }));
        setup.time.end_s = 25.0;
        let outcome = run(&sample_hz.map_or(setup.clone(), |hz| sampled(setup, hz)));
        for agent in 0..3 {
            let error = last(&outcome, agent, Signal::Error, 0).abs();
            assert!(error < 1e-3, "{sample_hz:?}, {agent}: {error}");
        }
    }
}

fn in_steps_of(setup: &Setup, step_s: f64) -> Outcome {
    let mut setup = setup.clone();
    setup.solver.method = Method::Fixed { step_s };
    run(&setup)
}

/// Halving the step makes the error a sixteenth, as it does for smooth systems; with a step across a kink it would be a half
/// to an eighth, at random.
fn has_order_four(name: &str, mut setup: Setup, step_s: f64) {
    setup.time.record_every_s = setup.time.end_s;
    let mut exact = setup.clone();
    exact.solver.method = Method::Adaptive { rtol: 1e-12, atol: 1e-13 };
    let exact = run(&exact);
    let errors = [1.0, 0.5, 0.25].map(|part| apart(&in_steps_of(&setup, step_s * part), &exact));
    assert!(errors[2] < 1e-2 * errors[0] && errors[2] > 1e-13, "{name}: {errors:?}");
}

#[test]
fn fixed_steps_keep_their_order_across_the_kinks_of_everything() {
    let mut tracking = crate::common::masses::tracking();
    tracking.agents[0].target = Some(along(vec![bounce(1.3), (t() - 1.3).abs_of().smaller(t() * 0.3)]));
    tracking.time.end_s = 6.0;
    has_order_four("target", tracking, 0.02);
    let mut led = led_along(FollowingDesign::Continuous, bounce(1.3), 6.0);
    // So wide a layer has no corners where the run goes.
    assert!(led.change_reference(|following: &mut Following| following.choice = Choice::Layer { width: 50.0 }));
    has_order_four("leader", led, 0.02);

    let mut weighted = consensus_of_masses(2.3);
    weighted.network.weights = vec![BoundedFormula::new(bounce(2.0) + 0.5, 4.0)];
    let edges = &mut weighted.network.schedule.graphs[0];
    edges.iter_mut().for_each(|edge| edge.weight = Weight::Formula(0));
    has_order_four("weight", weighted, 0.04);

    let mut delayed = consensus_of_masses(2.3);
    delayed.network.delays[0] = Delay::new(BoundedFormula::new(bounce(2.0) * 0.3 + 0.4, 4.0));
    has_order_four("delay", delayed, 0.04);

    let mut pushed = consensus_of_masses(2.3);
    let course = || Course::Each(vec![Function::Formula(bounce(2.0) * 3.0), Function::Formula(t().smaller(0.7))]);
    // One begins and ends between kinks.
    for (agent, from_s, until_s) in [(0, 0.0, f64::INFINITY), (1, 0.9, 1.9)] {
        pushed.agents[agent].pushes = vec![Push { effect: Effect::Torque(course()), from_s, until_s }];
    }
    has_order_four("push", pushed, 0.04);
}

/// What is heard late jumps late, and the error control sees to it.
#[test]
fn a_leader_with_kinks_is_followed_through_a_delay_to_the_tolerance() {
    let mut late = led_along(FollowingDesign::Continuous, bounce(1.3), 6.0);
    late.network.delays = vec![Delay::constant(0.37)];
    let with = |rtol: f64| {
        let mut setup = late.clone();
        setup.solver.method = Method::Adaptive { rtol, atol: 0.01 * rtol };
        run(&setup)
    };
    let gap = apart(&with(1e-6), &with(1e-10));
    assert!(gap < 1e-5, "{gap:e}");
}

/// Beside a kink at which a delay nearly vanishes a piece of history is as short as the delay, 4e-12 s at t = 8π. The step after it
/// must not take over what continuing that piece gives.
#[test]
fn regress_steps_longer_than_a_delay_are_iterated_until_they_agree() {
    let mut setup = consensus_of_masses(27.0);
    setup.exchange = Exchange::PositionVelocity;
    let shrinking = (-t()).exp_of() * 0.3 + bounce(1.0) * 0.1;
    setup.network.delays = vec![Delay::new(BoundedFormula::new(shrinking, 27.0))];
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
    let phase = |edges| Phase { dwell_s: 2.5, edges };
    setup.network.schedule =
        Schedule::periodic(vec![phase(vec![edge(0, 1), edge(1, 2)]), phase(vec![edge(1, 0), edge(2, 1)])]);
    let with = |rtol: f64| {
        let mut setup = setup.clone();
        setup.solver.method = Method::Adaptive { rtol, atol: 0.01 * rtol };
        run(&setup)
    };
    let gap = apart(&with(1e-6), &with(1e-10));
    assert!(gap < 1e-6, "{gap:e}");
}

/// The state of an agent with an offset is its motion less the offset's; what it is itself does not jump.
#[test]
fn an_agent_with_a_bouncing_offset_keeps_its_velocity_at_the_kinks() {
    let mut setup = vehicles::three(&vehicles::vehicle(), ThrustKind::Continuous, true, 4.0);
    let still = || Expression::number(0.0);
    setup.agents[0].target = Some(along(vec![bounce(2.0) * 0.3, still(), still()]));
    setup.time.record_every_s = 0.002;
    let outcome = run(&setup);
    let rows = &outcome.recording.t_s;
    let (position, velocity) = [Signal::Position, Signal::Velocity].map(|signal| column(&outcome, 0, signal, 0)).into();
    for row in 1..rows.len() {
        let h = rows[row] - rows[row - 1];
        let mean = (position[row] - position[row - 1]) / h;
        let speed = 0.5 * (velocity[row] + velocity[row - 1]);
        assert!((mean - speed).abs() < 1e-3, "at {}: {mean} {speed}", rows[row]);
    }
    assert!(columns(&outcome, Signal::Offset).iter().any(|offset| offset.iter().any(|x| x.abs() > 0.29)));
}

#[test]
fn a_motion_whose_kinks_cannot_be_told_apart_is_refused() {
    let refuse = |setup: &Setup| simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap_err();
    let many = bounce(1e5);
    let error = refuse(&led_along(FollowingDesign::Continuous, many.clone(), 3.0));
    let wanted = |agent: &str, axis| SetupError::Trajectory {
        agent: agent.into(),
        error: TrajectoryError::Kinks { axis, error: KinkError::TooMany },
    };
    assert_eq!(error, wanted("leader", 0));
    let mut tracking = crate::common::masses::tracking();
    tracking.agents[0].target = Some(along(vec![t(), many.clone()]));
    assert_eq!(refuse(&tracking), wanted("mass-1", 1));
    // A push is continuous: there the error control is enough.
    let mut pushed = consensus_of_masses(0.01);
    let course = Course::Each(vec![Function::Formula((t() * 1e7).sin_of().abs_of() * 1e-3), Function::Constant(0.0)]);
    pushed.agents[0].pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.0, until_s: f64::INFINITY }];
    pushed.solver.method = Method::Adaptive { rtol: 1e-3, atol: 1e-3 };
    run(&pushed);
}
