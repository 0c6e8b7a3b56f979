//! Robots under (6)–(7) that follow trajectories of their own: the balance of the proof, arrival, closed forms, sampled control.

use std::ops::ControlFlow;

use crate::common::single::anthropomorphic;
use crate::common::{RTOL, assert_first_order, balance_residual, column, fixed, last, run, sampled, wave};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{RootPair, RootSet};
use forwardstep_core::robot::PlanarLinks;
use forwardstep_core::robot::tree::Uncertain;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::trajectory::{Path, Spline, Trajectory};
use forwardstep_sim::{
    Adaptive, AgentSetup, Ending, Known, Law, Method, Network, Observers, RobotSetup, Setup, SetupError, Signal, Start,
    recipe, simulate, simulate_with,
};

/// Every robot of Section II-B that is shipped, with ϑ̂(0) = 0 or with the true parameters.
fn robots(adapts: bool) -> Vec<AgentSetup> {
    let of = |name: &str, robot: RobotSetup, damping: Gain, adaptation: Gain| {
        let estimate_start = vec![0.0; robot.theta.len()];
        if adapts {
            AgentSetup::new(name, robot, Adaptive { damping, adaptation, estimate_start, bounds: None })
        } else {
            AgentSetup::new(name, robot, Known { damping })
        }
    };
    let links = PlanarLinks::uniform([2.0, 1.0], [1.0, 0.8]);
    let tree = anthropomorphic(Uncertain::Tool).agents.swap_remove(0).robot;
    let ship = RobotSetup::ship([25.8, 33.8, 1.1, 2.8, 12.0, 17.0, 0.4, 0.7, 1.5]);
    vec![
        of("arm", RobotSetup::planar_arm(&links), Gain::Number(20.0), Gain::Number(30.0)).at(&[0.2, 1.4]),
        of("tree", tree, Gain::Bandwidth(20.0), Gain::Bandwidth(4.0)).at(&[0.3, -0.8, 1.5]),
        of("mass", RobotSetup::point_mass(2, 2.0), Gain::Number(12.0), Gain::Number(6.0)).at(&[1.0, -0.5]),
        of("ship", ship, Gain::Diagonal(vec![60.0, 60.0, 12.0]), Gain::Bandwidth(1.5)).at(&[1.0, 0.5, 0.4]),
    ]
}

/// A swing on every axis, other on each.
fn swing(axes: usize) -> Trajectory {
    let path = |k: usize| wave(0.2 * k as f64, 0.4, 0.7 + 0.3 * k as f64, 0.5);
    Trajectory::new((0..axes).map(path).collect::<Vec<_>>()).unwrap()
}

const ROOTS: [f64; 4] = [2.0, 3.0, 2.5, 1.5];

/// All robots side by side with so many roots.
fn follow(adapts: bool, roots: usize, end_s: f64) -> Setup {
    let agents = robots(adapts).into_iter().map(|agent| {
        let axes = agent.robot.axes.len();
        agent.roots(&ROOTS[..roots]).following(swing(axes))
    });
    // Kinds with other numbers of axes do not agree with each other, and need not.
    let mut agents: Vec<AgentSetup> = agents.collect();
    agents.iter_mut().for_each(|agent| agent.start.dq.iter_mut().for_each(|dq| *dq = 0.1));
    alone(agents, end_s)
}

fn alone(agents: Vec<AgentSetup>, end_s: f64) -> Setup {
    let mut setup = Setup::tracking(agents, end_s);
    setup.time.record_every_s = 0.05;
    setup.solver.method = Method::Adaptive { rtol: RTOL, atol: 1e-11 };
    setup
}

/// One setup for each robot: agents of one setup have as many axes.
fn apart(setup: Setup) -> Vec<Setup> {
    let one = |agent: &AgentSetup| Setup { agents: vec![agent.clone()], network: Network::silent(1), ..setup.clone() };
    setup.agents.iter().map(one).collect()
}

fn error(outcome: &forwardstep_sim::Outcome, axes: usize) -> f64 {
    (0..axes).map(|axis| last(outcome, 0, Signal::Error, axis).abs()).fold(0.0, f64::max)
}

#[test]
fn eq_6_balance_holds_along_real_runs_of_every_robot_and_order_that_tracks() {
    for adapts in [false, true] {
        for roots in 1..=4 {
            for setup in apart(follow(adapts, roots, 4.0)) {
                let outcome = run(&setup);
                let residual = balance_residual(&outcome, 0, 1e-3);
                assert!(residual <= 20.0 * RTOL, "{}, {roots} roots: {residual:e}", setup.agents[0].name);
                if adapts {
                    assert!(last(&outcome, 0, Signal::Dissipation, 0) > 1e-3, "{}", setup.agents[0].name);
                }
            }
        }
    }
}

/// Three of one model and one order would be one batch if they were to agree.
#[test]
fn prop_like_robots_follow_targets_of_their_own_as_each_does_alone() {
    let mut setup = apart(follow(true, 2, 3.0)).swap_remove(0);
    let first = setup.agents[0].clone();
    setup.agents = (0..3)
        .map(|k| {
            let mut agent = first.clone();
            agent.name = format!("arm-{k}");
            agent.start.q[0] += 0.3 * f64::from(k);
            agent.following(Trajectory::new(vec![wave(0.1 * f64::from(k), 0.4, 0.7, 0.5); 2]).unwrap())
        })
        .collect();
    setup.network = Network::silent(3);
    setup.solver.method = Method::Fixed { step_s: 1e-3 };
    let together = run(&setup);
    for k in 0..3 {
        let alone = run(&Setup { agents: vec![setup.agents[k].clone()], network: Network::silent(1), ..setup.clone() });
        for (signal, axis) in [(Signal::Position, 0), (Signal::Position, 1), (Signal::Torque, 1)] {
            assert_eq!(column(&together, k, signal, axis), column(&alone, 0, signal, axis), "{k}: {signal:?}");
        }
    }
}

#[test]
fn eq_6_balance_counts_pushes_on_robots_that_track() {
    for mut setup in apart(follow(true, 2, 4.0)) {
        let all = (0..setup.agents[0].robot.axes.len()).map(|k| Function::Constant(3.0 - 2.0 * k as f64)).collect();
        setup.agents[0].pushes = vec![Push { effect: Effect::Torque(Course::Each(all)), from_s: 1.0, until_s: 2.0 }];
        let outcome = run(&setup);
        assert!(balance_residual(&outcome, 0, 1e-3) <= 20.0 * RTOL, "{}", setup.agents[0].name);
        assert!(column(&outcome, 0, Signal::External, 0).contains(&3.0));
    }
}

#[test]
fn thm_robots_of_every_kind_reach_their_targets() {
    for adapts in [false, true] {
        for roots in 1..=4 {
            for setup in apart(follow(adapts, roots, 40.0)) {
                let axes = setup.agents[0].robot.axes.len();
                let outcome = run(&setup);
                // What is not known is learnt on the way.
                let (end, bound) = (error(&outcome, axes), if adapts { 3e-2 } else { 1e-6 });
                assert!(end < bound, "{}, {roots} roots, {adapts}: {end}", setup.agents[0].name);
                // It is the distance of what is recorded from the target.
                let mut jets = vec![[0.0; 5]; axes];
                setup.agents[0].target.as_ref().unwrap().jets(40.0, &mut jets);
                for (axis, jet) in jets.iter().enumerate() {
                    let gap = last(&outcome, 0, Signal::Position, axis) - jet[0];
                    assert!((gap - last(&outcome, 0, Signal::Error, axis)).abs() < 1e-12);
                }
            }
        }
    }
}

/// With known parameters and s(0) = 0 the error obeys its polynomial alone: e^(N) + Σ α_r e^(r) = 0.
#[test]
fn eq_43_for_robots_the_error_obeys_the_roots_exactly() {
    let target = Trajectory::new(vec![fixed(0.3), fixed(-0.2)]).unwrap();
    for roots in [1, 2] {
        let arm = robots(false).swap_remove(0).roots(&ROOTS[..roots]).following(target.clone());
        let mut arm = arm.at(&[1.3, 0.8]);
        // z = −2 (q − q_d) where there is one root, so let q̇ be that; where z is a state it starts with q̇.
        arm.start.dq = if roots == 1 { vec![-2.0, -2.0] } else { vec![0.5, 0.0] };
        let outcome = run(&alone(vec![arm], 3.0));
        for axis in 0..2 {
            let v = [0.5, 0.0][axis];
            for (row, t) in outcome.recording.t_s.iter().enumerate() {
                // e(0) = 1; with roots 2 and 3: e = a exp(−2t) + b exp(−3t).
                let (a, b) = if roots == 1 { (1.0, 0.0) } else { (3.0 + v, -2.0 - v) };
                let want = a * (-2.0 * t).exp() + b * (-3.0 * t).exp();
                let got = column(&outcome, 0, Signal::Error, axis)[row];
                assert!((got - want).abs() < 1e-7, "{roots} roots, axis {axis} at {t} s: {got} is not {want}");
            }
            assert!(column(&outcome, 0, Signal::TrackingError, axis).iter().all(|s| s.abs() < 1e-7));
        }
    }
}

/// e(0) = 1, ė(0) = v and ë + 2 a ė + (a² + b²) e = 0.
#[test]
fn eq_43_complex_roots_swing_as_they_say() {
    let target = Trajectory::new(vec![fixed(0.3), fixed(-0.2)]).unwrap();
    let (a, b) = (0.4, 3.0);
    let roots = RootSet { real: Vec::new(), pairs: vec![RootPair { real: a, imaginary: b }] };
    let arm = robots(false).swap_remove(0).roots(roots).following(target);
    let mut arm = arm.at(&[1.3, 0.8]);
    arm.start.dq = vec![0.5, 0.0];
    let outcome = run(&alone(vec![arm], 6.0));
    for (axis, v) in [0.5, 0.0].into_iter().enumerate() {
        for (row, t) in outcome.recording.t_s.iter().enumerate() {
            let want = (-a * t).exp() * ((b * t).cos() + (v + a) / b * (b * t).sin());
            let got = column(&outcome, 0, Signal::Error, axis)[row];
            assert!((got - want).abs() < 1e-7, "axis {axis} at {t} s: {got} is not {want}");
        }
    }
}

#[test]
fn prop_sampled_robots_that_track_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for roots in [1, 3] {
        for setup in apart(follow(true, roots, 2.0)) {
            assert_first_order(&setup, 400.0);
        }
    }
}

#[test]
fn digest_a_recipe_of_a_robot_that_tracks_has_the_bits_of_the_simulator() {
    let mut setup = sampled(apart(follow(true, 3, 1.0)).swap_remove(1), 200.0);
    setup.solver.method = Method::Fixed { step_s: 0.001 };
    let mut controller = recipe(&setup, 0).unwrap().build().unwrap();
    let mut samples = 0;
    let outcome = simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers {
            samples: Some(&mut |taken| {
                controller.step(taken.now_s, taken.measured, taken.inbox).unwrap();
                assert_eq!(controller.command(), taken.command, "sample {}", taken.sample);
                samples += 1;
            }),
            ..Observers::default()
        },
    );
    assert_eq!((outcome.unwrap().ending, samples), (Ending::Completed, 200));
}

#[test]
fn targets_come_from_formulas_with_kinks_and_from_points_of_a_table() {
    let points = |values: [f64; 3]| Path::Spline(Spline::new(vec![1.0, 3.0, 5.0], values.to_vec()).unwrap());
    let kinked = || Path::Formula((Expression::variable(0) - 2.0).abs_of() * 0.2);
    for target in [vec![points([0.2, 0.9, 0.1]), points([1.4, 0.8, 1.2])], vec![kinked(), fixed(1.0)]] {
        let arm = robots(true).swap_remove(0).roots([2.0, 3.0]).following(Trajectory::new(target).unwrap());
        let outcome = run(&alone(vec![arm], 25.0));
        assert!(error(&outcome, 2) < 5e-3, "{}", error(&outcome, 2));
        assert!(balance_residual(&outcome, 0, 1e-3) <= 20.0 * RTOL);
    }
}

#[test]
fn limits_of_axes_hold_for_robots_that_track() {
    let mut arm = robots(false).swap_remove(0).roots([2.0]).following(swing(2));
    arm.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(15.0));
    arm.enforce_limits = true;
    for setup in [alone(vec![arm.clone()], 3.0), sampled(alone(vec![arm.clone()], 3.0), 500.0)] {
        let outcome = run(&setup);
        let largest = column(&outcome, 0, Signal::Torque, 0).iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        assert_eq!(largest, 15.0);
    }
    // The target leads beyond what the second axis may reach.
    arm.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(500.0));
    arm.robot.axes[1].position_limits = Some([0.0, 2.0]);
    let outcome = simulate(&alone(vec![arm], 10.0), &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(matches!(outcome.ending, Ending::BrokeDown(_)), "{:?}", outcome.ending);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let sound = || robots(true).swap_remove(0).roots([2.0, 3.0]).following(swing(2));
    let refused = |agent: AgentSetup| {
        simulate(&alone(vec![agent], 1.0), &mut |_| ControlFlow::Continue(())).map(|_| ()).unwrap_err().to_string()
    };
    assert!(simulate(&alone(vec![sound()], 0.1), &mut |_| ControlFlow::Continue(())).is_ok());
    assert!(refused(AgentSetup { roots_per_s: Vec::new().into(), ..sound() }).contains("at least 1"));
    assert!(simulate(&alone(vec![sound().roots([1.0; 5])], 0.1), &mut |_| ControlFlow::Continue(())).is_ok());
    let points = || Path::Spline(Spline::new(vec![0.0, 1.0], vec![0.1, 0.3]).unwrap());
    let curve = || Trajectory::new(vec![points(), points()]).unwrap();
    assert!(
        simulate(&alone(vec![sound().roots([1.0; 4]).following(curve())], 0.1), &mut |_| ControlFlow::Continue(()))
            .is_ok()
    );
    assert!(refused(sound().roots([1.0; 5]).following(curve())).contains("its target has 4"));
    assert!(refused(sound().roots([1.0, -1.0])).contains("positive"));
    assert!(refused(AgentSetup { target: None, ..sound() }).contains("none"));
    assert!(refused(sound().following(swing(3))).contains("needs 2"));
    assert!(refused(AgentSetup { manipulability: 1.0, ..sound() }).contains("following a target"));
    let given = |vectors: usize| {
        let agent = sound();
        AgentSetup { start: Start { reference: vec![vec![0.0; 2]; vectors], ..agent.start.clone() }, ..agent }
    };
    assert!(simulate(&alone(vec![given(1)], 0.1), &mut |_| ControlFlow::Continue(())).is_ok());
    let error = simulate(&alone(vec![given(2)], 0.1), &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert!(matches!(error, SetupError::StartOfReference { .. }), "{error}");
}

/// Laws are data: whichever tracks says so.
#[test]
fn what_tracks_says_so() {
    for agent in robots(true).iter().chain(&robots(false)) {
        let interface = Law::interface(&*agent.law, &agent.robot).unwrap();
        assert!(interface.tracks_by_roots && !interface.offsets, "{}", agent.name);
    }
}
