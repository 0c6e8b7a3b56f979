//! What enters as a function of time is met, however long steps have become before it.

use std::ops::ControlFlow;

use crate::common::{column, last, run};
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::recording::{Breakdown, BreakdownCause};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Spline, Trajectory};
use forwardstep_sim::{AgentSetup, Ending, Known, Network, Outcome, RobotSetup, Setup, Signal, simulate};

/// height · exp(−((t − at)/width)²).
fn bump(height: f64, at: f64, width: f64) -> Expression {
    let u = (Expression::variable(0) - Expression::number(at)) * (1.0 / width);
    (-(u.clone() * u)).exp_of() * height
}

fn mass(name: &str, at: f64) -> AgentSetup {
    AgentSetup::new(name, RobotSetup::point_mass(1, 1.0), Known::gain(5.0)).roots([1.0, 2.0]).at(&[at])
}

/// Two masses that hear each other and start `apart`.
fn pair(apart: f64, end_s: f64) -> Setup {
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::constant(0.0));
    let mut setup = Setup::consensus(vec![mass("a", 0.0), mass("b", apart)], network, end_s);
    setup.time.record_every_s = 0.5;
    setup
}

fn pushed(mut setup: Setup, formula: Expression) -> Setup {
    let effect = Effect::Torque(Course::Each(vec![Function::Formula(formula)]));
    setup.agents[0].pushes = vec![Push { effect, from_s: 0.0, until_s: f64::INFINITY }];
    setup
}

/// The same with steps that are short enough for anything of this width.
fn finely(setup: &Setup, width: f64) -> Outcome {
    let mut setup = setup.clone();
    setup.solver.max_step_s = Some(0.2 * width);
    run(&setup)
}

/// The run comes to what short steps come to, which is something else than without the function.
fn is_met(setup: &Setup, without: &Setup, width: f64, case: &str) {
    let (found, fine, without) = (run(setup), finely(setup, width), run(without));
    let q = |outcome: &Outcome| column(outcome, 0, Signal::Position, 0).to_vec();
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (error, effect) = (apart(&q(&found), &q(&fine)), apart(&q(&fine), &q(&without)));
    assert!(effect > 1e-4 && error < 1e-6 * (1.0 + effect), "{case}: off by {error:e}, effect {effect:e}");
    assert!(found.statistics.steps < fine.statistics.steps, "{case}: {} steps", found.statistics.steps);
}

#[test]
fn regress_a_push_that_comes_while_all_rest_is_met() {
    for (k, width) in [5.0, 2.0, 1.0, 0.3, 0.05, 0.01].into_iter().enumerate() {
        let at = 120.3 + 0.37 * k as f64;
        let setup = pushed(pair(0.0, 200.0), bump(20.0 / width, at, width));
        is_met(&setup, &pair(0.0, 200.0), width, &format!("a push of {width} s"));
        // As far from the first motion as one likes; and beside a constant that is large.
        let moving = pushed(pair(1.0, 200.0), bump(20.0 / width, at, width));
        is_met(&moving, &pair(1.0, 200.0), width, &format!("a push of {width} s after a start"));
        let beside = |f: Expression| pushed(pair(0.0, 200.0), f + 100.0);
        is_met(&beside(bump(20.0 / width, at, width)), &beside(bump(0.0, at, width)), width, "beside a constant");
    }
}

/// Its kinks are too many to be told apart, so that values decide. A ripple that error control sees in long steps, which amplify what
/// is left of it, would keep them short; and a stage may stand within the bump by chance, but not wherever it comes.
#[test]
fn a_push_with_more_kinks_than_can_be_told_apart_is_met_where_it_is_no_narrower_than_a_step_is_long() {
    let ripple = (Expression::variable(0) * 1e5).sin_of().abs_of() * 1e-200;
    let cases = [5.0, 2.0].into_iter().flat_map(|width| [120.0, 130.0, 140.0, 150.0].map(|at| (width, at)));
    for (width, at) in cases {
        let setup = pushed(pair(0.0, 200.0), bump(20.0 / width, at, width) + ripple.clone());
        let mut fine = setup.clone();
        fine.solver.max_step_s = Some(0.1 * width);
        let [found, fine] = [setup, fine].map(|setup| column(&run(&setup), 0, Signal::Position, 0).to_vec());
        let error = found.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let effect = fine.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
        assert!(effect > 1e-3 && error < 1e-5 * (1.0 + effect), "{width} s at {at}: {error:e} of {effect:e}");
    }
}

#[test]
fn regress_targets_weights_and_delays_that_change_for_a_moment_are_met() {
    let tracking = |path: Path| {
        let agent = mass("a", 0.0).following(Trajectory::new(vec![path]).unwrap());
        let mut setup = Setup::tracking(vec![agent], 60.0);
        setup.time.record_every_s = 0.02;
        setup
    };
    let still = tracking(Path::Formula(Expression::number(0.0)));
    for width in [1.0, 0.3, 0.05] {
        is_met(&tracking(Path::Formula(bump(1.0, 40.3, width))), &still, width, &format!("a target of {width} s"));
    }
    // A curve that leaves its place between two of its points.
    let times = vec![0.0, 40.0, 40.1, 40.2, 60.0];
    let curve = |top: f64| Path::Spline(Spline::new(times.clone(), vec![0.0, 0.0, top, 0.0, 0.0]).unwrap());
    is_met(&tracking(curve(1.0)), &tracking(curve(0.0)), 0.05, "a curve");
    let weighted = |height: f64, width: f64| {
        let mut setup = pair(1.0, 60.0);
        let formula = bump(height, 40.3, width) + 1e-5;
        setup.network.weights = vec![BoundedFormula::new(formula, 60.0)];
        let edge = |from, to| Edge { from, to, weight: Weight::Formula(0), delay: 0 };
        setup.network.schedule = Schedule::fixed(vec![edge(0, 1), edge(1, 0)]);
        setup
    };
    for width in [0.3, 0.05, 0.01] {
        is_met(&weighted(2.5 / width, width), &weighted(0.0, width), width, &format!("a weight of {width} s"));
    }
}

/// What is a function of time through and through costs no more steps than its own course asks for.
#[test]
fn a_wave_is_followed_by_the_steps_of_the_error_control() {
    let wave = (Expression::variable(0) * 3.0).sin_of() * 2.0;
    let setup = pushed(pair(1.0, 100.0), wave);
    let steps = run(&setup).statistics.steps;
    // 48 turns; by error control alone it takes as many to a tenth.
    assert!(steps < 3000, "{steps}");
}

/// A joint that leaves its limits ends the run when it does, whatever is recorded.
#[test]
fn regress_limits_are_enforced_wherever_rows_are() {
    let ending = |record_every_s: f64| {
        let mut setup = pushed(pair(0.0, 12.0), (Expression::variable(0) * 2.0).sin_of() * 30.0);
        setup.time.record_every_s = record_every_s;
        let axis = &mut setup.agents[0].robot.axes[0];
        (axis.position_limits, axis.effort_limit) = (Some([-0.5, 0.5]), Some(1e6));
        setup.agents[0].enforce_limits = true;
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        let Ending::BrokeDown(Breakdown { t_s, agent: 0, signal: Signal::Position, axis: 0, cause }) = outcome.ending
        else {
            panic!("{:?}", outcome.ending)
        };
        let BreakdownCause::PositionLimit { value, .. } = cause else { panic!("{cause:?}") };
        assert!((value.abs() - 0.5).abs() < 1e-9, "{value}");
        assert!(outcome.recording.t_s.iter().all(|row_s| *row_s <= t_s));
        assert!(last(&outcome, 0, Signal::Position, 0).abs() <= 0.5 + 1e-9);
        t_s
    };
    let times = [0.001, 0.1, 1.0, 4.0, 12.0].map(ending);
    assert!(times.iter().all(|t_s| (t_s - times[0]).abs() < 1e-6), "{times:?}");
}
