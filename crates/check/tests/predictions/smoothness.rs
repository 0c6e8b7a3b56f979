//! Jumps of the torque by truncated Taylor series, against differences of runs and closed forms.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::smoothness::{
    Covered, NoFilters, NoOrders, NoSmoothness, NotCovered, Smoothness, filters, orders, smoothness,
};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::polynomial;
use forwardstep_core::robot::TwoVelocity;
use forwardstep_core::robot::tree::{JointKind, Uncertain};
use forwardstep_sim::delay::{Delay, PiecewiseConstant};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral, Tracking};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Adaptive, AgentSetup, Exchange, Known, Method, Outcome, Progress, Setup, Signal, Start};

use crate::common::kinds::{blind_mass, rest_at, tracking, tree_tip};
use crate::common::{arm, column, edge, noise, setup};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn found(setup: &Setup) -> Smoothness {
    smoothness(setup, &mut go_on).unwrap()
}

pub(crate) fn refused(setup: &Setup) -> NoSmoothness {
    smoothness(setup, &mut go_on).unwrap_err()
}

pub(crate) fn roots(order: usize) -> Vec<f64> {
    (0..order).map(|r| 1.0 + 0.4 * r as f64).collect()
}

/// A delay that jumps at 0.55 s, and from then on every two seconds.
fn steps() -> Delay {
    Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.55], values_s: vec![0.1, 0.35], period_s: Some(2.0) })
}

/// Two graphs that take turns every second.
fn turns() -> Schedule {
    let phase = |edges| Phase { edges, dwell_s: 1.0 };
    let first = vec![edge(0, 1, 1.0, 0), edge(2, 0, 1.5, 1), edge(1, 2, 0.7, 0)];
    Schedule::periodic(vec![phase(first), phase(vec![edge(1, 0, 2.0, 0), edge(2, 0, 1.0, 1), edge(0, 2, 1.2, 1)])])
}

/// Three robots of different kinds of dynamics: planar arms, one of them with known parameters.
pub(crate) fn arms(exchange: Exchange, order: usize) -> Setup {
    let mut agents: Vec<AgentSetup> = (0..3).map(|i| arm(i, &roots(order))).collect();
    agents[2].law = Arc::new(Known { damping: Gain::Number(6.0) });
    let delays = vec![Delay::constant(0.2), steps()];
    let mut setup = setup(agents, exchange, turns(), delays, 2.0);
    setup.time.record_every_s = APART_S;
    setup.solver.method = Method::Adaptive { rtol: 1e-12, atol: 1e-13 };
    setup.solver.max_step_s = Some(APART_S);
    setup.solver.balance = false;
    setup
}

/// Three trees of links that gravity acts on, with prismatic and revolute joints.
fn trees(order: usize) -> Setup {
    let mut setup = arms(Exchange::PositionVelocity, order);
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        let kinds = [JointKind::Revolute, JointKind::Prismatic, JointKind::Revolute];
        let tip = tree_tip(kinds, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], Uncertain::Tool);
        let parameters = tip.robot.theta.len();
        let law = Adaptive {
            damping: Gain::Bandwidth(6.0),
            adaptation: Gain::Bandwidth(2.0),
            estimate_start: tip.robot.theta.iter().map(|theta| 0.7 * theta).collect(),
            bounds: None,
        };
        assert_eq!(law.estimate_start.len(), parameters);
        let q = (0..3).map(|k| noise(3 * i + k)).collect();
        let start = Start { q, dq: vec![0.1; 3], rest: Vec::new(), reference: Vec::new() };
        *agent = AgentSetup { robot: tip.robot, law: Arc::new(law), start, ..agent.clone() };
    }
    setup
}

/// How far apart rows are from which differences are taken, s: the fastest motion has some 100/s.
const APART_S: f64 = 5e-4;

/// Weights of the derivative of order `r` at zero of the polynomial through values at `at`.
fn weights(at: &[f64], r: usize) -> Vec<f64> {
    // Lagrange's polynomials, expanded.
    let factorial: f64 = (1..=r).map(|k| k as f64).product();
    let weight = |i: usize| {
        let mut polynomial = vec![1.0];
        for (j, x) in at.iter().enumerate().filter(|(j, _)| *j != i) {
            let scale = 1.0 / (at[i] - x);
            let mut next = vec![0.0; polynomial.len() + 1];
            for (k, c) in polynomial.iter().enumerate() {
                next[k + 1] += c * scale;
                next[k] -= c * x * scale;
            }
            polynomial = next;
            assert!(j < at.len());
        }
        polynomial[r] * factorial
    };
    (0..at.len()).map(weight).collect()
}

/// The derivative of order `r` of a column at `t_s`, from rows on one side of it.
fn one_sided(outcome: &Outcome, values: &[f64], t_s: f64, side: f64, r: usize) -> f64 {
    let row = |t_s: f64| (t_s / APART_S).round() as usize;
    let at: Vec<f64> = (1..=7).map(|k| side * APART_S * f64::from(k)).collect();
    at.iter()
        .zip(weights(&at, r))
        .map(|(at, weight)| {
            assert!((outcome.recording.t_s[row(t_s + at)] - t_s - at).abs() < 1e-9);
            weight * values[row(t_s + at)]
        })
        .sum()
}

/// Holds both sides of every derivative against differences of the run; with a push only their jumps.
pub(crate) fn compare(setup: &Setup, instants: usize, pushed: bool) -> Smoothness {
    let smoothness = found(setup);
    let outcome = &smoothness.outcome;
    let mut times: Vec<f64> = smoothness.jumps.iter().map(|jump| jump.t_s).collect();
    times.dedup();
    assert_eq!(times.len(), instants, "{times:?}");
    for jump in &smoothness.jumps {
        for (r, axes) in jump.derivatives.iter().enumerate().take(3) {
            for (axis, change) in axes.iter().enumerate() {
                let torque = column(outcome, jump.agent, jump.signal, axis);
                let [before, after] = [-1.0, 1.0].map(|side| one_sided(outcome, torque, jump.t_s, side, r));
                let close = |found: f64, truth: f64| {
                    let scale = 1.0 + before.abs().max(after.abs());
                    assert!((found - truth).abs() < 1e-4 * scale, "{} s, r = {r}: {found} {truth}", jump.t_s);
                };
                close(change.jump, after - before);
                if let Some(sides) = change.sides.filter(|_| !pushed) {
                    close(sides.before, before);
                    close(sides.after, after);
                }
            }
        }
    }
    smoothness
}

#[test]
fn val_one_sided_differences_of_runs_are_the_derivatives_of_the_series() {
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=3 {
            let smoothness = compare(&arms(exchange, order), 2, false);
            assert_eq!((smoothness.switches, smoothness.delay_jumps), (1, 1));
            let expected = Covered { signal: Signal::Torque, derivatives: order, continuous: Some(order - 1) };
            assert_eq!(smoothness.agents, vec![Ok(vec![expected]); 3]);
            assert!(smoothness.kept() && smoothness.kinds() == [expected]);
            // Everybody hears something else after the switch; one agent through the delay that jumps.
            assert_eq!(smoothness.jumps.iter().map(|jump| jump.agent).collect::<Vec<_>>(), [0, 0, 1, 2]);
        }
    }
    for order in 2..=3 {
        assert!(compare(&trees(order), 2, false).kept());
    }
}

#[test]
fn val_a_push_moves_both_sides_alike() {
    for order in 1..=3 {
        let mut setup = arms(Exchange::PositionVelocity, order);
        let wave = (Expression::variable(0) * 5.0).sin_of() * 3.0;
        let course = Course::Each(vec![Function::Formula(wave), Function::Constant(1.5)]);
        setup.agents[0].pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.0, until_s: f64::INFINITY }];
        assert!(compare(&setup, 2, true).kept());
    }
}

#[test]
fn thm3_no_derivative_below_the_last_jumps_and_the_last_does() {
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=8 {
            let mut setup = arms(exchange, order);
            setup.solver.max_step_s = None;
            let smoothness = found(&setup);
            for jump in &smoothness.jumps {
                assert_eq!(jump.derivatives.len(), order);
                for (r, axes) in jump.derivatives.iter().enumerate() {
                    for change in axes {
                        assert_eq!(change.jump == 0.0, r + 1 < order, "order {order}, r = {r}");
                        assert!(change.sides.unwrap().before != 0.0);
                    }
                }
            }
            let [kind] = smoothness.kinds()[..] else { panic!("one kind") };
            let largest = |r: usize| smoothness.largest(kind, r).map(|jump| jump.size);
            assert!(largest(order - 1).unwrap() > 0.01 && largest(order).is_none());
            assert_eq!(order.checked_sub(2).and_then(largest), (order > 1).then_some(0.0));
        }
    }
}

/// Rows of a run at an instant, on one axis: q, q̇, z, ż, … of an agent.
fn own(outcome: &Outcome, agent: usize, axis: usize, order: usize, row: usize) -> Vec<f64> {
    let at = |signal| column(outcome, agent, signal, axis)[row];
    let above = (0..order).map(|r| at(Signal::Reference(r as u8)));
    [at(Signal::Position), at(Signal::Velocity)].into_iter().chain(above).collect()
}

#[test]
fn eq_a5_the_last_derivative_jumps_by_the_inertia_of_the_estimates_times_the_jump_of_z() {
    for order in 1..=4 {
        let mut setup = arms(Exchange::PositionVelocity, order);
        // Without delay everything that is heard is in the row of the switch.
        setup.network.delays = vec![Delay::constant(0.0); 2];
        let smoothness = found(&setup);
        let (outcome, alpha) = (&smoothness.outcome, polynomial(roots(order)).unwrap());
        let row = 2000;
        assert_eq!(outcome.recording.t_s[row], 1.0);
        let graphs = &setup.network.schedule.graphs;
        assert_eq!(smoothness.jumps.len(), 3);
        for jump in &smoothness.jumps {
            let i = jump.agent;
            let z = |axis: usize, graph: usize| -> f64 {
                let x = own(outcome, i, axis, order, row);
                // x₀ = q, x₁ = q̇, xᵣ = z⁽ʳ⁻¹⁾
                let x = |r: usize| if r < 2 { x[r] } else { x[r + 1] };
                let own_part: f64 = (0..=order).map(|r| alpha[r] * x(r)).sum();
                let heard = |j: usize| {
                    let q = own(outcome, j, axis, order, row);
                    alpha[0] * q[0] + alpha[0] / roots(order)[0] * q[1]
                };
                let edges = graphs[graph].iter().filter(|edge| edge.to == i);
                -edges.map(|edge| edge.weight.constant().unwrap() * (own_part - heard(edge.from))).sum::<f64>()
            };
            let dz = [0, 1].map(|axis| z(axis, 1) - z(axis, 0));
            let at = |signal| [0, 1].map(|axis| column(outcome, i, signal, axis)[row]);
            let theta: Vec<f64> = match setup.agents[i].law.is::<Adaptive>() {
                true => (0..5).map(|k| column(outcome, i, Signal::Estimate, k)[row]).collect(),
                false => setup.agents[i].robot.theta.clone(),
            };
            let (q, zero) = (at(Signal::Position), [0.0; 2]);
            let robot = setup.agents[i].robot.kind.lagrangian().unwrap();
            let motion = TwoVelocity { q: &q, dq: &zero, z: &zero, dz: &zero };
            let mass = robot.dynamics_at(&theta, motion).unwrap().mass;
            for axis in 0..2 {
                let expected = mass[2 * axis] * dz[0] + mass[2 * axis + 1] * dz[1];
                let found = jump.derivatives[order - 1][axis].jump;
                assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "order {order}: {found} {expected}");
            }
        }
    }
}

#[test]
fn eq_3_stays_continuous_where_a_delay_jumps_and_not_where_the_graph_does() {
    let mut setup = arms(Exchange::PositionVelocity, 2);
    setup.reference = Arc::new(PureIntegral);
    setup.agents.iter_mut().for_each(|agent| {
        agent.change_law(|law: &mut Adaptive| law.adaptation = Gain::Number(0.5));
    });
    let switching = compare(&setup, 2, false);
    let kind = Covered { signal: Signal::Torque, derivatives: 2, continuous: None };
    assert_eq!(switching.kinds(), [kind]);
    assert!(switching.largest(kind, 0).unwrap().switched && switching.largest(kind, 0).unwrap().size > 0.1);
    let at_delay = switching.jumps.iter().find(|jump| !jump.switched).unwrap();
    assert!(at_delay.derivatives[0].iter().all(|change| change.jump == 0.0));

    setup.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.0, 1), edge(1, 0, 1.5, 0), edge(1, 2, 0.7, 1)]);
    let fixed = compare(&setup, 1, false);
    let kind = Covered { signal: Signal::Torque, derivatives: 2, continuous: Some(1) };
    assert!(fixed.kept() && fixed.kinds() == [kind] && fixed.largest(kind, 1).unwrap().size > 0.1);
    assert!(!fixed.largest(kind, 1).unwrap().switched);
    // A weight that changes enters ż of (3) with its derivative.
    setup.network.weights = vec![BoundedFormula::new(Expression::variable(0).sin_of() * 0.5 + 1.0, 60.0)];
    let mut edges = setup.network.schedule.graphs[0].clone();
    edges[1].weight = Weight::Formula(0);
    setup.network.schedule = Schedule::fixed(edges);
    // Its torque reads Σw, so that nothing is said of derivatives; the torque itself does not jump with a delay.
    let (varied, kind) = (found(&setup), Covered { derivatives: 1, ..kind });
    assert!(varied.kept() && varied.kinds() == [kind]);
    assert_eq!(varied.largest(kind, 0).map(|jump| jump.size), Some(0.0));
    // That of the consensus family does not.
    setup.reference = Arc::new(Consensus);
    assert!(compare(&setup, 1, false).kept());
}

#[test]
fn eq_aa6_the_torque_jumps_by_the_more_the_narrower_the_filter_is() {
    let mut setup = arms(Exchange::Position, 2);
    setup.solver.max_step_s = None;
    let epsilon = [0.02, 0.01, 0.005, 0.002, 0.001];
    let found = filters(&setup, &epsilon, &mut go_on).unwrap();
    assert!((found.slope + 1.0).abs() < 0.03, "{}", found.slope);
    assert!(found.jumps.windows(2).all(|pair| pair[1].jump.size > 1.6 * pair[0].jump.size));
    // The largest of them is a jump of the run.
    let baseline = |filter_s: f64| {
        let mut setup = setup.clone();
        setup.reference = Arc::new(Backstepping { filter_s, acceleration_limit: None });
        setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        setup.solver.max_step_s = Some(APART_S);
        setup
    };
    let (jumps, kind) =
        (self::found(&baseline(0.02)), Covered { signal: Signal::Torque, derivatives: 1, continuous: None });
    let (one, other) = (jumps.largest(kind, 0).unwrap(), found.jumps[0].jump);
    assert!((one.size - other.size).abs() < 1e-6 * one.size && (one.agent, one.t_s) == (other.agent, other.t_s));
    assert!(jumps.kinds() == [kind] && jumps.kept(), "nothing is promised");
    // What follows is slow enough for differences with a wide filter.
    compare(&baseline(0.3), 2, false);

    assert_eq!(filters(&setup, &[0.1, 0.1], &mut go_on), Err(NoFilters::TooFew));
    setup.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.0, 0)]);
    assert_eq!(filters(&setup, &epsilon, &mut go_on), Err(NoFilters::NoJump));
    let zero = filters(&setup, &[0.1, 0.0], &mut go_on).unwrap_err();
    assert!(matches!(zero, NoFilters::Smoothness(NoSmoothness::Setup(_))), "{zero}");
}

#[test]
fn a_higher_order_is_smoother_and_slower() {
    let mut setup = arms(Exchange::PositionVelocity, 2);
    setup.solver = Default::default();
    setup.time.end_s = 120.0;
    setup.time.record_every_s = 0.1;
    let found = orders(&setup, &[1, 2, 3, 4], &mut go_on).unwrap();
    assert_eq!(found.iter().map(|of| of.order).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(found.iter().all(|of| of.kept && of.jump.unwrap().size > 0.0));
    let settled: Vec<f64> = found.iter().map(|of| of.settled_s.unwrap()).collect();
    assert!(settled.windows(2).all(|pair| pair[1] > 1.05 * pair[0]), "{settled:?}");
    // Order two has the roots of the scenario.
    let own = self::found(&setup);
    let [kind] = own.kinds()[..] else { panic!("one kind") };
    assert_eq!(found[1].jump, own.largest(kind, 1));

    assert_eq!(orders(&setup, &[2, 9], &mut go_on), Err(NoOrders::Order { order: 9 }));
    assert_eq!(orders(&setup, &[0], &mut go_on), Err(NoOrders::Order { order: 0 }));
    setup.agents[1] = AgentSetup { roots_per_s: roots(2).into(), ..blind_mass(1.0, 1.0) };
    assert!(matches!(orders(&setup, &[1], &mut go_on), Err(NoOrders::Agent { reason: NotCovered::Law { .. }, .. })));
    setup.reference = Arc::new(Tracking);
    assert!(matches!(orders(&setup, &[1], &mut go_on), Err(NoOrders::Family { .. })));
}

#[test]
fn who_is_not_covered_is_told_why() {
    let mut sampled = arms(Exchange::Position, 2);
    sampled = sampled.sampled(100.0);
    assert_eq!(refused(&sampled), NoSmoothness::Sampled);
    let nobody = |name: &str, reason| NoSmoothness::NoAgent { name: name.into(), reason };
    let alone = tracking(arm(0, &roots(2)), vec![rest_at(0.3), rest_at(0.1)]);
    assert_eq!(refused(&alone), nobody("arm-1", NotCovered::OwnTarget));
    let mut broken = arms(Exchange::Position, 2);
    broken.agents[0].roots_per_s.real[0] = -1.0;
    assert!(matches!(refused(&broken), NoSmoothness::Setup(_)));
    let mut stopped = arms(Exchange::Position, 2);
    stopped.time.end_s = 1.5;
    let stop = |progress: Progress| if progress.t_s > 0.5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let early = smoothness(&stopped, &mut { stop }).unwrap_err();
    assert!(matches!(early, NoSmoothness::Early { t_s } if t_s > 0.5 && t_s < 0.6), "{early}");
}

/// What (6) asks for at every row, whatever limits leave of it; K = 8.
fn asked(setup: &Setup, outcome: &Outcome, agent: usize, axis: usize) -> Vec<f64> {
    let mut robot = setup.agents[agent].robot.kind.lagrangian().unwrap().evaluator();
    let row = |row: usize| {
        let at = |signal| [0, 1].map(|axis| column(outcome, agent, signal, axis)[row]);
        let (q, dq) = (at(Signal::Position), at(Signal::Velocity));
        let (z, dz, s) = (at(Signal::Reference(0)), at(Signal::Reference(1)), at(Signal::TrackingError));
        let theta: Vec<f64> = (0..5).map(|k| column(outcome, agent, Signal::Estimate, k)[row]).collect();
        robot.at(&theta, TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz }, &s).unwrap().model[axis] - 8.0 * s[axis]
    };
    (0..outcome.recording.t_s.len()).map(row).collect()
}

#[test]
fn limits_of_torques_act_on_the_motion_and_not_on_what_is_asked_for() {
    let mut setup = arms(Exchange::PositionVelocity, 2);
    setup.agents.iter_mut().for_each(|agent| {
        agent.enforce_limits = true;
        agent.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(1.0));
    });
    let limited = found(&setup);
    assert!(limited.kept());
    let mut clipped = 0;
    for jump in limited.jumps.iter().filter(|jump| jump.agent < 2) {
        for axis in 0..2 {
            let asked = asked(&setup, &limited.outcome, jump.agent, axis);
            clipped += usize::from(jump.derivatives[0][axis].sides.unwrap().before.abs() > 1.1);
            for (r, changes) in jump.derivatives.iter().enumerate() {
                let sides = changes[axis].sides.unwrap();
                let [before, after] = [-1.0, 1.0].map(|side| one_sided(&limited.outcome, &asked, jump.t_s, side, r));
                let close = |found: f64, truth: f64| (found - truth).abs() < 1e-4 * (1.0 + truth.abs());
                assert!(close(sides.before, before) && close(sides.after, after), "{sides:?} {before} {after}");
            }
        }
    }
    assert!(clipped > 2);
}
