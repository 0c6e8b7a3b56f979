//! Targets and laws without velocity: what is read, and what every mistake gets.

use forwardstep_io::scenario::Goal;
use forwardstep_sim::{PositionOnlyLaw, ReferenceKind};

use super::{Case, read, refused};

/// A mass that follows a target.
const SOUND: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "mass"
robot.point_mass = { dimension = 2, mass_kg = 2.0 }
target.formulas = ["sin(t)", 0.5]

[reference.tracking]
roots_per_s = [1.0, 1.5, 2.0]

[law.position_only]
damping = 20
adaptation_gain = 5

[goal]
error_below = 1e-3
"#;

#[rustfmt::skip]
const CASES: &[Case] = &[
    ("[\"sin(t)\", 0.5]", "[\"sin(t)\"]",
        "test.toml:7:19: `formulas` has 1 entry, but `mass` needs 2", ""),
    ("[\"sin(t)\", 0.5]", "[\"sin(t)\", \"sine(t)\"]",
        "test.toml:7:31: there is no function `sine`", "did you mean `sin`?"),
    ("[\"sin(t)\", 0.5]", "[\"sin(t)\", \"1/(t - 5)\"]",
        "test.toml:7:30: this has no finite value everywhere from 0 s to 10 s, or that could not be shown", "where they have values"),
    ("[\"sin(t)\", 0.5]", "[\"sin(t)\", \"abs(sin(1e5*t))\"]",
        "test.toml:7:30: a motion must be smooth between kinks that are known, but it has more than 10000 kinks", "shorten the run"),
    ("[\"sin(t)\", 0.5]", "[\"max(sin(t)^2 + cos(t)^2, 1)\", 0.5]",
        "test.toml:7:20: a motion must be smooth between kinks that are known, but its kinks near 0 cannot be told apart: \
         what `abs`, `min` or `max` compares stays too close together there", "write something smooth"),
    ("target.formulas = [\"sin(t)\", 0.5]\n", "",
        "test.toml:5:8: agent `mass` is to track a target, but has none", "give it a `target`"),
    ("target.formulas", "target.formula",
        "test.toml:7:8: unknown choice `formula`", "did you mean `formulas`?"),
    ("[1.0, 1.5, 2.0]", "[1.0, 1.5]",
        "test.toml:10:15: agent `mass`: the list of roots has 2 entries where 3 are needed", "this law takes 3 roots"),
    ("[1.0, 1.5, 2.0]", "[1.0, -1.5, 2.0]",
        "test.toml:10:21: `roots_per_s` is -1.5, but must be positive", ""),
    ("damping = 20", "damping = 0",
        "test.toml:13:11: `damping` is 0, but must be positive", ""),
    ("damping = 20", "dampening = 20",
        "test.toml:13:1: unknown key `dampening`", "did you mean `damping`?"),
    ("adaptation_gain = 5", "adaptation_gain = -5",
        "test.toml:14:19: `adaptation_gain` is -5, but must not be negative", ""),
    ("robot.point_mass = { dimension = 2, mass_kg = 2.0 }", "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }",
        "test.toml:12:2: agent `mass`: the law `position_only` is made for point masses", "`adaptive`, `known` and `task_space`"),
    ("[law.position_only]\ndamping = 20\nadaptation_gain = 5", "[law.known]\n",
        "test.toml:9:2: agent `mass`: the law with known parameters does not follow a target of its own; it goes with consensus", "laws that track are"),
    ("error_below", "disagreement_below",
        "test.toml:17:22: `disagreement_below` is about agreement, but every agent follows a target or a leader", "error_below"),
    ("error_below = 1e-3", "error_below = 1e-3\ndisagreement_below = 1e-3",
        "test.toml:17:15: `disagreement_below` and `error_below` are both given", "delete one of the two"),
    ("[reference.tracking]\nroots_per_s = [1.0, 1.5, 2.0]", "[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"",
        "test.toml:9:2: there is no network, but the agents are to agree", "who hears whom"),
    ("[goal]", "[[external_wrenches]]\non = [\"mass\"]\nby.force_n = [1, 2]\n[goal]",
        "test.toml:17:7: agent `mass`: pushes act on robots under the adaptive or the known law, not on the law without velocity", "leave `mass` out of `on`"),
];

#[test]
fn a_target_and_its_law_are_read() {
    let scenario = read(SOUND).unwrap();
    let agent = &scenario.setup.agents[0];
    assert_eq!(scenario.setup.reference, ReferenceKind::Tracking);
    assert_eq!(scenario.goal, Some(Goal::ErrorBelow(1e-3)));
    let law = PositionOnlyLaw { damping: 20.0, filter_per_s: 10.0, adaptation: 5.0, estimate_start: 0.0 };
    assert_eq!(agent.law.downcast(), Some(&law));
    let mut jets = [[0.0; 5]; 2];
    agent.target.as_ref().unwrap().jets(0.0, &mut jets);
    assert_eq!(jets, [[0.0, 1.0, 0.0, -1.0, 0.0], [0.5, 0.0, 0.0, 0.0, 0.0]]);
}

#[test]
fn every_mistake_about_a_target_is_reported_at_its_place() {
    refused(SOUND, CASES);
}
