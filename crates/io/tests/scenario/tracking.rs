//! Targets and laws without velocity: what is read, and what every mistake gets.

use forwardstep_io::scenario::Goal;
use forwardstep_sim::PositionOnlyLaw;
use forwardstep_sim::reference::Tracking;

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
        "test.toml:10:15: agent `mass`: the list of roots has 2 entries where 3 are needed", "give it 3 roots"),
    ("[1.0, 1.5, 2.0]", "[1.0, -1.5, 2.0]",
        "test.toml:10:21: `roots_per_s` is -1.5, but must be positive", ""),
    ("damping = 20", "damping = 0",
        "test.toml:13:11: `damping` is 0, but must be positive", ""),
    ("damping = 20", "dampening = 20",
        "test.toml:13:1: unknown key `dampening`", "did you mean `damping`?"),
    ("adaptation_gain = 5", "adaptation_gain = -5",
        "test.toml:14:19: `adaptation_gain` is -5, but must not be negative", ""),
    ("robot.point_mass = { dimension = 2, mass_kg = 2.0 }", "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }",
        "test.toml:12:2: agent `mass`: the law `position_only` is made for point masses without damping and friction, of which it knows no velocity to compensate them at", "`adaptive`, `known` and `task_space`"),
    ("robot.point_mass = { dimension = 2, mass_kg = 2.0 }\ntarget.formulas = [\"sin(t)\", 0.5]", "robot.vehicle = { mass_kg = 2.0 }\nlaw.thrust.design.differentiable = {}\ntarget.formulas = [\"sin(t)\", 0.5, 0]",
        "test.toml:10:2: agent `mass`: the thrust law does not follow a target of its own; it goes with consensus", "laws that track are `adaptive`, `known`"),
    ("formulas = [\"sin(t)\", 0.5]\n\n[reference.tracking]\nroots_per_s = [1.0, 1.5, 2.0]\n\n[law.position_only]\ndamping = 20\nadaptation_gain = 5",
        "points = { times_s = [0, 1], positions = [[0, 1], [1, 0]] }\n\n[reference.tracking]\nroots_per_s = [1.0, 1.5, 2.0, 1, 1]\n\n[law.known]\n",
        "test.toml:10:15: `mass` follows its target by 5 derivatives, one for every root of its reference dynamics, but its target has 4",
        "give at most 4 roots, or the target as a formula: a curve through points has 4 derivatives"),
    ("roots_per_s = [1.0, 1.5, 2.0]\n\n[law.position_only]\ndamping = 20\nadaptation_gain = 5", "[law.known]\n",
        "test.toml:9:1: agent `mass`: roots of the reference dynamics: 0, but at least 1 are needed here", "an agent may have `reference` with roots of its own"),
    ("error_below", "disagreement_below",
        "test.toml:17:22: `disagreement_below` is about agreement, but every agent follows a target or a leader", "error_below"),
    ("error_below = 1e-3", "error_below = 1e-3\ndisagreement_below = 1e-3",
        "test.toml:17:15: `disagreement_below` and `error_below` are both given", "delete one of the two"),
    ("[reference.tracking]\nroots_per_s = [1.0, 1.5, 2.0]", "[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"",
        "test.toml:9:2: there is no network, but the agents are to agree", "who hears whom"),
    ("[goal]", "[[external_wrenches]]\non = [\"mass\"]\nby.virtual_spring_on_point = { stiffness_n_per_m = 1, target_m = [1, 2] }\n[goal]",
        "test.toml:18:1: `mass` has no links", "use `by.virtual_spring_on_axes`"),
];

/// A UR5e under (6)–(7) whose elbow is led beyond ±π.
#[test]
fn a_robot_tracks_and_targets_beyond_its_limits_are_noted() {
    let text = SOUND
        .replace("robot.point_mass = { dimension = 2, mass_kg = 2.0 }", "robot.urdf = { file = \"ur5e.urdf\", locked = { shoulder_pan_joint = 0, wrist_1_joint = 0, wrist_2_joint = 0, wrist_3_joint = 0 } }")
        .replace("[law.position_only]\ndamping = 20\nadaptation_gain = 5", "[law.adaptive]")
        .replace("[1.0, 1.5, 2.0]", "[4]");
    let notices = |text: &str| -> Vec<String> {
        let scenario = read(text).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(scenario.setup.agents[0].roots_per_s.real, [4.0]);
        scenario.notices.iter().map(ToString::to_string).filter(|notice| notice.contains("target")).collect()
    };
    assert!(notices(&text).is_empty());
    assert_eq!(
        notices(&text.replace("\"sin(t)\", 0.5", "\"sin(t)\", \"t/2\"")),
        ["the target of `mass` leads `elbow_joint` beyond its position limits: it is at 3.145 at t = 6.29 s, but \
          -3.141592653589793 to 3.141592653589793 are allowed"]
    );
}

#[test]
fn a_target_and_its_law_are_read() {
    let scenario = read(SOUND).unwrap();
    let agent = &scenario.setup.agents[0];
    assert!(scenario.setup.reference.is::<Tracking>());
    assert_eq!(scenario.goal, Some(Goal::ErrorBelow(1e-3)));
    let law = PositionOnlyLaw { damping: 20.0, filter_per_s: 10.0, adaptation: 5.0, estimate_start: 0.0, bounds: None };
    assert_eq!(agent.law.downcast(), Some(&law));
    let mut jets = [[0.0; 5]; 2];
    agent.target.as_ref().unwrap().jets(0.0, &mut jets);
    assert_eq!(jets, [[0.0, 1.0, 0.0, -1.0, 0.0], [0.5, 0.0, 0.0, 0.0, 0.0]]);
}

#[test]
fn every_mistake_about_a_target_is_reported_at_its_place() {
    refused(SOUND, CASES);
}

#[test]
fn starts_beyond_limits_and_damping_too_fast_for_the_steps_are_noted() {
    let arm = SOUND
        .replace("robot.point_mass = { dimension = 2, mass_kg = 2.0 }", "robot.urdf = { file = \"ur5e.urdf\", locked = { shoulder_pan_joint = 0, wrist_1_joint = 0, wrist_2_joint = 0, wrist_3_joint = 0 } }")
        .replace("[law.position_only]\ndamping = 20\nadaptation_gain = 5", "[law.adaptive]")
        .replace("[1.0, 1.5, 2.0]", "[4]");
    let notices = |text: &str| -> Vec<String> {
        let scenario = read(text).unwrap_or_else(|error| panic!("{error}"));
        scenario.notices.iter().map(ToString::to_string).filter(|notice| !notice.contains("does not move")).collect()
    };
    assert_eq!(notices(&arm), Vec::<String>::new());
    let at = |start: &str| arm.replacen("[[agents]]", &format!("[[agents]]\nstart.position_rad = {start}"), 1);
    assert_eq!(notices(&at("[-6.2, 3.1]")), Vec::<String>::new(), "on this side of the limits");
    assert_eq!(
        notices(&at("[0.1, 3.5]")),
        [
            "`elbow_joint` of `mass` starts at 3.5 rad, beyond its position limits: -3.141592653589793 to 3.141592653589793 are allowed"
        ]
    );
    let kept = at("[-7, 3.5]").replacen("[[agents]]", "[[agents]]\nenforce_limits = true", 1);
    assert_eq!(
        notices(&kept),
        [
            "`shoulder_lift_joint` of `mass` starts at -7 rad, beyond its position limits: -6.283185307179586 to 6.283185307179586 are \
          allowed, and the run ends there; so does 1 more axis"
        ]
    );
    let gain = |gain: &str| arm.replace("[law.adaptive]", &format!("[law.adaptive]\ndamping.gain = {gain}"));
    assert_eq!(notices(&gain("1e4")), Vec::<String>::new());
    let many = notices(&gain("1e9"));
    assert!(
        many.len() == 1 && many[0].starts_with("the gain K is stiff: at the start of mass s decays at"),
        "{many:?}"
    );
    let fixed = |step: &str| format!("{}\n[solver]\nmethod.fixed.step_s = {step}\n", gain("100"));
    let long = notices(&fixed("0.1"));
    assert!(
        long.len() == 1 && long[0].starts_with("`solver.step_s` is 0.1 s, which is too long for the gain K"),
        "{long:?}"
    );
    assert_eq!(notices(&fixed("1e-5")), Vec::<String>::new());
    // Sampled torques are held: they do not limit the steps.
    assert_eq!(notices(&format!("{}\n[control]\nsample_hz = 1e5\n", gain("1e4"))), Vec::<String>::new());
}
