//! What the shipped scenarios with pushes say of λ: with it agents stay where they are moved to, without it they come back.

use std::ops::ControlFlow;

use crate::support::{folder, forwardstep, stderr, stdout};
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
fn eq_31_carts_that_adapt_stay_where_they_are_pushed_with_lambda_only() {
    let (with, without) = (setup("remark-4-on-a-table", true), setup("remark-4-on-a-table", false));
    let predicted = predict(&without).unwrap().value;
    let (moved, back) = (run(&with), run(&without));
    // 12 N s and 6 N s displace all by the gain of MANIPULABILITY.md for λ = 1, times λ.
    for (axis, (value, impulse)) in predicted.iter().zip([12.0, 6.0]).enumerate() {
        for agent in 0..with.agents.len() {
            let end = |outcome| position(outcome, agent, axis, 60.0) - value;
            assert!(end(&back).abs() < 1e-5, "agent {agent}: {}", end(&back));
            let by = position(&moved, agent, axis, 60.0) - position(&moved, agent, axis, 20.0);
            assert!((by / (impulse * 4.0 * 0.009191) - 1.0).abs() < 0.1, "agent {agent}: {by}");
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

#[test]
fn val_the_table_of_manipulability_is_what_runs_say() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../MANIPULABILITY.md")).unwrap();
    let rows = |text: &str| -> Vec<Vec<String>> {
        let rows = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| Scenario"));
        rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
    };
    let here = folder();
    let arguments = ["manipulability", "remark-4", "remark-4-on-a-table", "teleoperation", "remark-3", "--table"];
    let (written, printed) = (rows(&text), rows(&stdout(&forwardstep(&here, &arguments).success())));
    assert_eq!(written.len(), 16);
    for (written, printed) in written.iter().zip(&printed) {
        assert_eq!(written[..4], printed[..4]);
        // Within what the arms' second order and unfinished adaptation leave.
        for (theory, measured) in [(5, 6), (7, 8)] {
            let [theory, measured] = [theory, measured].map(|cell| {
                assert_eq!(written[cell].ends_with("/s"), printed[cell].ends_with("/s"));
                [written, printed].map(|row| row[cell].trim_end_matches(" /s").parse::<f64>().unwrap())
            });
            assert!(
                (theory[0] - theory[1]).abs() < 1.5e-5 && (measured[0] - measured[1]).abs() < 1.5e-5,
                "{printed:?}"
            );
            assert!((theory[1] - measured[1]).abs() <= 3e-6 + 1e-3 * theory[1].abs(), "{printed:?}");
        }
        let [lambda, degree] = [&printed[2], &printed[3]].map(|cell| cell.parse::<f64>().unwrap());
        // Without λ, (31) has two zeros at the origin where (a1) has one; gravity that is adapted takes away one more of either.
        let without_and_with = match printed[0].as_str() {
            "remark-4" | "teleoperation" => [0.0, 1.0],
            "remark-4-on-a-table" => [-1.0, 1.0],
            name => {
                assert_eq!(name, "remark-3");
                [-2.0, 0.0]
            }
        };
        assert_eq!(degree, without_and_with[usize::from(lambda > 0.0)], "{printed:?}");
    }
    assert_eq!(written.len(), printed.len());
}

#[test]
fn manipulability_says_in_words_what_a_push_does_and_why_it_cannot() {
    let here = folder();
    let said = stdout(&forwardstep(&here, &["manipulability", "--lambda", "0,4", "--on", "arm-3"]).success());
    assert!(
        said.contains("\n  λ = 4: degree 1, gain 0.02604\n") && said.contains("arm-3 is pushed with 0.01 N m on"),
        "{said}"
    );
    assert!(said.contains("theory      0.02604 /s, measured 0.02604 /s"), "{said}");
    assert!(!said.contains("let `--torque`"), "{said}");
    // What is no longer the small push that the theory is of is said to be too large, or too small for numbers.
    for (torque, why) in
        [("1e-15", "lost in rounding: let `--torque` be larger"), ("1e4", "let `--torque` be smaller, or")]
    {
        let said = stdout(&forwardstep(&here, &["manipulability", "--lambda", "1", "--torque", torque]));
        assert!(said.contains(why), "{said}");
    }
    for (arguments, why) in [
        (&["six-arms"][..], "`six-arms`: the graph switches"),
        (&["remark-4", "--on", "arm-9"], "no agent is called `arm-9`; there are arm-1, arm-2"),
        (&["remark-4", "--axis", "3"], "there is no axis 3 of arm-1"),
        (&["remark-4", "--lambda=-1"], "must be a number of at least 0"),
        (&["remark-4", "--torque", "0"], "must be a number above 0"),
    ] {
        let complaint = stderr(&forwardstep(&here, &[&["manipulability"], arguments].concat()).code(2));
        assert!(complaint.contains(why), "{complaint}");
    }
}
