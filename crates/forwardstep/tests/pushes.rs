//! What the shipped scenarios with pushes say of λ: with it agents stay where they are moved to, without it they come back.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ops::ControlFlow;

use forwardstep::check::predict;
use forwardstep::io::scenario::open_scenario;
use forwardstep::sim::{Ending, Outcome, Setup, Signal, simulate};

/// The scenario as it is, or without λ.
fn setup(name: &str, lambda: bool) -> Setup {
    let mut setup = open_scenario(name).unwrap_or_else(|error| panic!("{error}")).setup;
    for agent in &mut setup.agents {
        assert!(agent.manipulability > 0.0 && !setup.network.schedule.graphs.is_empty());
        if !lambda {
            agent.manipulability = 0.0;
        }
    }
    setup
}

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

/// q of an agent at the last row before `t_s`.
fn position(outcome: &Outcome, agent: usize, axis: usize, t_s: f64) -> f64 {
    let found =
        outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, Signal::Position, axis));
    let row = outcome.recording.t_s.iter().rposition(|t| *t <= t_s).unwrap();
    found.unwrap().values[row]
}

#[test]
fn remark_4_agents_stay_where_they_are_pushed_with_lambda_only() {
    let (with, without) = (setup("remark-4", true), setup("remark-4", false));
    let predicted = predict(&without).unwrap().value;
    let (moved, back) = (run(&with), run(&without));
    for agent in 0..with.agents.len() {
        for (axis, value) in predicted.iter().enumerate() {
            let at =
                |outcome| (position(outcome, agent, axis, 20.0) - value, position(outcome, agent, axis, 60.0) - value);
            let (before, after) = at(&back);
            assert!(before.abs() < 1e-3 && after.abs() < 1e-5, "agent {agent}: {before}, {after}");
            let (before, after) = at(&moved);
            assert!(before.abs() < 1e-3 && after.abs() > 0.1, "agent {agent}: {before}, {after}");
        }
    }
}

#[test]
fn teleoperated_arms_follow_with_lambda_only() {
    let (with, without) = (setup("teleoperation", true), setup("teleoperation", false));
    let (followed, back) = (run(&with), run(&without));
    for (axis, start, target) in [(0, 0.0, 0.8), (2, 1.2, 0.7)] {
        for agent in 0..3 {
            let led = position(&followed, agent, axis, 40.0);
            assert!((led - target).abs() < 0.1, "agent {agent}, axis {axis}: {led}");
            let returned = position(&back, agent, axis, 40.0);
            assert!((returned - start).abs() < 1e-3, "agent {agent}, axis {axis}: {returned}");
        }
    }
    // While it is led, the first arm is where the hand wants it; without λ it slides back under the hand.
    assert!((position(&followed, 0, 0, 15.0) - 0.8).abs() < 0.1);
    assert!((position(&back, 0, 0, 15.0) - 0.8).abs() > 0.3);
}
