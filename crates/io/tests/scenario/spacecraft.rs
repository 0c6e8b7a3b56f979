//! Spacecraft: every mistake in a scenario, where it is reported and what is said.

use super::{Case, read, refused};

/// A spacecraft with three wheels.
pub(super) const SPACECRAFT: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "craft"
target.formulas = [0, 0, "sin(t)", 1]

[agents.start.spacecraft]
axis = [1, 2, -1]
angle_rad = 3.1
rate_rad_s = [0.05, -0.03, 0.04]
wheel_momentum_n_m_s = [0.3, -0.2, 0.1]

[agents.robot.spacecraft]
inertia_kg_m2 = [[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]
wheels = [
    { axis = [1, 0, 0], torque_limit_n_m = 5, momentum_limit_n_m_s = 20 },
    { axis = [0, 1, 0] },
    { axis = [0, 0, 2] },
]

[reference.tracking]

[law.attitude]
error_gain_per_s2 = 0.5
rate_gain_per_s = 1.2
filter_gain_per_s = [1, 1, 1, 2]
damping = 3

[goal]
error_below = 1e-3
"#;

/// Its law.
pub(super) const LAW: &str =
    "[law.attitude]\nerror_gain_per_s2 = 0.5\nrate_gain_per_s = 1.2\nfilter_gain_per_s = [1, 1, 1, 2]\ndamping = 3";

#[rustfmt::skip]
const SPACECRAFT_CASES: &[Case] = &[
    ("[agents.robot.spacecraft]", "[agents.robot.spacecaft]",
        "test.toml:14:15: unknown choice `spacecaft`", "did you mean `spacecraft`? choose one of `urdf`, `planar_arm`, `point_mass`, `ship`, `vehicle`, `rotorcraft`, `spacecraft`, `chain`, `vector_chain`, `strict_feedback`, `pure_feedback`"),
    ("inertia_kg_m2 = [[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]\n", "",
        "test.toml:14:1: the key `inertia_kg_m2` is missing", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "[10, 0, 6]",
        "test.toml:15:22: `inertia_kg_m2` is 0, but must be positive", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "[10, 8]",
        "test.toml:15:17: `inertia_kg_m2` has 2 entries, but `spacecraft` needs 3", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "-10",
        "test.toml:15:17: `inertia_kg_m2` is -10, but must be positive", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "[[10, 9, 0], [9, 8, 0], [0, 0, 6]]",
        "test.toml:15:17: `inertia_kg_m2` of `craft`: the matrix is not positive definite: vᵀ A v = -1/10 for v = (-9/10, 1, 0)", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "[[10, 1, 0], [2, 8, 0], [0, 0, 6]]",
        "test.toml:15:17: `inertia_kg_m2` of `craft`: entries (0, 1) and (1, 0) differ: 1 and 2; the matrix must be symmetric", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "[[10, 1], [1, 8]]",
        "test.toml:15:17: `inertia_kg_m2` has 2 entries, but `spacecraft` needs 3", ""),
    ("[[10, 0.5, 0], [0.5, 8, 0], [0, 0, 6]]", "\"round\"",
        "test.toml:15:17: found \"round\" where a number, a list (the diagonal) or a list of rows should stand", ""),
    ("inertia_kg_m2 =", "inertia_kg_m =",
        "test.toml:15:1: unknown key `inertia_kg_m`", "did you mean `inertia_kg_m2`? allowed here: `inertia_kg_m2`, `wheels`"),
    ("    { axis = [0, 0, 2] },\n", "",
        "test.toml:16:10: the axes of the 2 wheels span no volume (det A Aᵀ = 0e0), so some torque cannot be made; give at least three wheels whose axes are not in one plane", ""),
    ("axis = [0, 0, 2]", "axis = [1, 1, 0]",
        "test.toml:16:10: the axes of the 3 wheels span no volume (det A Aᵀ = 0e0), so some torque cannot be made; give at least three wheels whose axes are not in one plane", ""),
    ("axis = [0, 0, 2]", "axis = [0, 0, 0]",
        "test.toml:19:14: the axis of wheel 3 is [0, 0, 0], which has no direction", "[1, 0, 0] is the first axis of the body"),
    ("axis = [0, 0, 2]", "axis = [0, 0]",
        "test.toml:19:14: found a list of 2 where 3 are needed", ""),
    ("axis = [0, 0, 2]", "axes = [0, 0, 1]",
        "test.toml:19:7: unknown key `axes`", "did you mean `axis`? allowed here: `axis`, `torque_limit_n_m`, `momentum_limit_n_m_s`"),
    ("{ axis = [0, 0, 2] }", "{ torque_limit_n_m = 1 }",
        "test.toml:19:5: the key `axis` is missing", ""),
    ("torque_limit_n_m = 5", "torque_limit_n_m = 0",
        "test.toml:17:44: `torque_limit_n_m` is 0, but must be positive", ""),
    ("torque_limit_n_m = 5", "torque_limit = 5",
        "test.toml:17:25: unknown key `torque_limit`", "did you mean `torque_limit_n_m`? allowed here: `axis`, `torque_limit_n_m`, `momentum_limit_n_m_s`"),
    ("momentum_limit_n_m_s = 20", "momentum_limit_n_m_s = -20",
        "test.toml:17:70: `momentum_limit_n_m_s` is -20, but must be positive", ""),
    ("momentum_limit_n_m_s = 20", "momentum_limit_n_m_s = inf",
        "test.toml:17:70: inf is not a finite number", ""),
    ("axis = [1, 2, -1]", "axis = [0, 0, 0]",
        "test.toml:9:8: this is zero and has no direction", "[0, 0, 1] is the third axis; for no turn let `angle_rad` be 0"),
    ("axis = [1, 2, -1]\n", "",
        "test.toml:9:13: an attitude is `axis` with `angle_rad`, or `quaternion`", "write `axis = [0, 0, 1]` and `angle_rad = 1.5`, or `quaternion = [0, 0, 0, 1]` alone"),
    ("angle_rad = 3.1\n", "",
        "test.toml:9:8: an attitude is `axis` with `angle_rad`, or `quaternion`", "write `axis = [0, 0, 1]` and `angle_rad = 1.5`, or `quaternion = [0, 0, 0, 1]` alone"),
    ("angle_rad = 3.1", "angle_deg = 179",
        "test.toml:10:1: unknown key `angle_deg`", "did you mean `angle_rad`? allowed here: `axis`, `angle_rad`, `quaternion`, `rate_rad_s`, `wheel_momentum_n_m_s`"),
    ("angle_rad = 3.1", "angle_rad = \"half\"",
        "test.toml:10:13: found \"half\" where a number should stand", ""),
    ("axis = [1, 2, -1]\nangle_rad = 3.1", "quaternion = [0, 0, 0, 0]",
        "test.toml:9:14: this is zero and has no direction", "[0, 0, 0, 1] is no turn"),
    ("axis = [1, 2, -1]\nangle_rad = 3.1", "quaternion = [0, 0, 1]",
        "test.toml:9:14: found a list of 3 where 4 are needed", ""),
    ("angle_rad = 3.1", "angle_rad = 3.1\nquaternion = [0, 0, 0, 1]",
        "test.toml:11:14: an attitude is `axis` with `angle_rad`, or `quaternion`", "write `axis = [0, 0, 1]` and `angle_rad = 1.5`, or `quaternion = [0, 0, 0, 1]` alone"),
    ("rate_rad_s = [0.05, -0.03, 0.04]", "rate_rad_s = [0.05, -0.03]",
        "test.toml:11:14: found a list of 2 where 3 are needed", ""),
    ("rate_rad_s = [0.05, -0.03, 0.04]", "rate_rad_s = [0.05, -0.03, nan]",
        "test.toml:11:28: nan is not a finite number", ""),
    ("rate_rad_s = [0.05, -0.03, 0.04]", "rate = [0.05, -0.03, 0.04]",
        "test.toml:11:1: unknown key `rate`", "allowed here: `axis`, `angle_rad`, `quaternion`, `rate_rad_s`, `wheel_momentum_n_m_s`"),
    ("[0.3, -0.2, 0.1]", "[0.3, -0.2]",
        "test.toml:12:24: `wheel_momentum_n_m_s` has 2 entries, but `craft` needs 3", ""),
    ("[0.3, -0.2, 0.1]", "0.3",
        "test.toml:12:24: found 0.3 where a list should stand", ""),
    ("[agents.start.spacecraft]", "[agents.start]\nattitude = [0, 0, 0, 1]\n[agents.start.spacecraft]",
        "test.toml:9:12: both `spacecraft` and `attitude` are given, but they say the same", ""),
    ("[agents.start.spacecraft]", "[agents.start]\nangular_velocity_rad_s = [0, 0, 0]\n[agents.start.spacecraft]",
        "test.toml:9:26: both `rate_rad_s` and `angular_velocity_rad_s` are given, but they say the same", ""),
    ("[agents.start.spacecraft]", "[agents.start]\nposition = [0, 0, 0, 1]\n[agents.start.spacecraft]",
        "test.toml:9:12: `position` says nothing about `craft`", "spacecraft start by `attitude`, `angular_velocity_rad_s` and `spacecraft`"),
    ("[agents.start.spacecraft]", "[agents.start]\nhigher_states = [0, 0, 0]\n[agents.start.spacecraft]",
        "test.toml:9:17: `higher_states` says nothing about `craft`", "only chains of order two or more in feedback form, else of order three or more, have any"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "",
        "test.toml:5:8: agent `craft` is to track a target, but has none", "give it a `target`"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.formulas = [0, 0, 0, 0]",
        "test.toml:6:1: this is no attitude at 0 s: its four entries are zero there", "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.formulas = [0, 0, \"t\", \"t\"]",
        "test.toml:6:1: this is no attitude at 0 s: its four entries are zero there", "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.formulas = [0, 0, 1]",
        "test.toml:6:19: `formulas` has 3 entries, but `craft` needs 4", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.formulas = [0, 0, \"sin(q)\", 1]",
        "test.toml:6:31: there is no `q` in a formula", "did you mean `t`? there are `t`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.sinusoids = [{}, {}, {}]",
        "test.toml:6:20: `sinusoids` has 3 entries, but `craft` needs 4", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.sinusoids = [{}, {}, {}, {}]",
        "test.toml:6:1: this is no attitude at 0 s: its four entries are zero there", "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.sinusoids = [{}, {}, {}, { offset = 1, waves = [{ amplitude = 1 }] }]",
        "test.toml:6:56: the key `rad_per_s` is missing", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.sinusoids = [{}, {}, {}, { offset = 1, wave = 2 }]",
        "test.toml:6:47: unknown key `wave`", "did you mean `waves`? allowed here: `offset`, `waves`"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [], positions = [] }",
        "test.toml:6:29: `times_s` is empty", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 1], positions = [[0, 0, 0, 1]] }",
        "test.toml:6:49: `positions` has 1 entry, but `times_s` has 2 entries", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 1], positions = [[0, 0, 0, 1], [0, 0, 1]] }",
        "test.toml:6:64: `positions` has 3 entries, but `craft` needs 4", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 1, 1], positions = [[0, 0, 0, 1], [0, 0, 1, 1], [0, 0, 1, 1]] }",
        "test.toml:6:36: `times_s` goes from 1 to 1, but must rise", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 10], positions = [[0, 0, 0, 1], [0, 0, 0, -1]] }",
        "test.toml:6:1: this is no attitude at 5 s: its four entries are zero there", "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 1e-100], positions = [[0, 0, 0, 1], [0, 0, 1, 1]] }",
        "test.toml:6:30: the points around row 1 are too close in time, or too far apart in value, for a smooth curve", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.points = { times_s = [0, 1] }",
        "test.toml:6:17: the key `positions` is missing", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.csv = \"slew.csv\"",
        "test.toml:6:14: found \"slew.csv\" where a table of file should stand", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.csv.file = \"slew.csv\"",
        "test.toml:6:19: cannot read the table `slew.csv`: there is no such file", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.csv = {}",
        "test.toml:6:14: the key `file` is missing", ""),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.csv.fiel = \"slew.csv\"",
        "test.toml:6:12: unknown key `fiel`", "did you mean `file`? allowed here: `file`"),
    ("target.formulas = [0, 0, \"sin(t)\", 1]", "target.file = \"slew.csv\"",
        "test.toml:6:8: unknown choice `file`", "choose one of `formulas`, `sinusoids`, `points`, `csv`"),
    ("[reference.tracking]\n", "[reference.tracking]\nroots = [1]\n",
        "test.toml:23:1: unknown key `roots`", "allowed here: `roots_per_s`"),
    ("[reference.tracking]\n", "[reference.tracking]\nroots_per_s = [0]\n",
        "test.toml:23:15: agent `craft`: the list of roots has 1 entries where 0 are needed", "leave `roots_per_s` out"),
    ("[reference.tracking]\n", "[reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"\n[network]\nedges = []\n",
        "test.toml:22:2: agent `craft`: the law for an attitude follows a target of its own; it does not agree with others", "write `reference.tracking`, and give it a `target`"),
    ("[law.attitude]", "[law.atitude]",
        "test.toml:24:6: unknown choice `atitude`", "did you mean `attitude`? choose one of `adaptive`, `known`, `position_only`, `model_reference`, `thrust`, `task_space`, `attitude`, `passivity_filter`, `linearising`, `linear_adaptive`, `immersion`, `adaptive_backstepping`"),
    ("error_gain_per_s2 = 0.5", "error_gain_per_s2 = 0",
        "test.toml:25:21: `error_gain_per_s2` is 0, but must be positive", ""),
    ("error_gain_per_s2 = 0.5", "error_gain_per_s = 0.5",
        "test.toml:25:1: unknown key `error_gain_per_s`", "did you mean `error_gain_per_s2`? allowed here: `error_gain_per_s2`, `rate_gain_per_s`, `filter_gain_per_s`, `damping`"),
    ("rate_gain_per_s = 1.2", "rate_gain_per_s = -1.2",
        "test.toml:26:19: `rate_gain_per_s` is -1.2, but must be positive", ""),
    ("rate_gain_per_s = 1.2", "rate_gain_per_s = [1.2, 1, 1]",
        "test.toml:26:19: found a list where a number should stand", ""),
    ("[1, 1, 1, 2]", "[1, 1, 2]",
        "test.toml:27:21: `filter_gain_per_s` has 3 entries, but `craft` needs 4", ""),
    ("[1, 1, 1, 2]", "[1, 0, 1, 2]",
        "test.toml:27:25: `filter_gain_per_s` is 0, but must be positive", ""),
    ("[1, 1, 1, 2]", "[[1, 0], [0, 1]]",
        "test.toml:27:21: `filter_gain_per_s` has 2 entries, but `craft` needs 4", ""),
    ("damping = 3", "damping = 0",
        "test.toml:28:11: `damping` is 0, but must be positive", ""),
    ("damping = 3", "damping = [[1, 2, 0, 0], [2, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "test.toml:28:11: `damping` of `craft`: the matrix is not positive definite: vᵀ A v = -3 for v = (-2, 1, 0, 0)", ""),
    ("damping = 3", "damping = { bandwidth_per_s = 3 }",
        "test.toml:28:11: found a table where a number, a list (the diagonal) or a list of rows should stand", ""),
    (LAW, "[law.thrust]",
        "test.toml:24:2: agent `craft`: the law `thrust` is made for vehicles and rotorcraft", "for this robot there is `attitude` and `passivity_filter`"),
    (LAW, "[law.adaptive]",
        "test.toml:24:2: agent `craft`: the law `adaptive` is made for arms and point masses", "for this robot there is `attitude` and `passivity_filter`"),
    ("[goal]", "[[external_wrenches]]\non = [\"craft\"]\nby.torque_n_m = [1, 0, 0]\n[goal]",
        "test.toml:32:17: `torque_n_m` does not act on `craft`", "what acts on it is `body_torque_n_m`"),
    ("[goal]", "[[external_wrenches]]\non = [\"craft\"]\nby.virtual_spring_on_axes = { stiffness = 1, target = [0, 0, 0, 1] }\n[goal]",
        "test.toml:32:1: `virtual_spring_on_axes` does not act on `craft`", "what acts on it is `body_torque_n_m`"),
    ("[goal]", "[[external_wrenches]]\non = [\"craft\"]\nby.body_torque_n_m = [1, 0, 0, 0]\n[goal]",
        "test.toml:32:22: `body_torque_n_m` has 4 entries, but `craft` needs 3", ""),
    ("[goal]", "[control]\nsample_hz = 10\ntorque_limit = [1, 1, 1]\n[goal]",
        "test.toml:32:16: agent `craft`: the limit of torques has 3 entries where 0 are needed", "leave it out: what this robot does is not asked of it as torques of its axes"),
    ("[goal]", "[control]\nsample_hz = 10\ntorque_rate_limit_per_s = [1, 1, 1, 1]\n[goal]",
        "test.toml:32:27: agent `craft`: the limit of torque rates has 4 entries where 0 are needed", "leave it out: what this robot does is not asked of it as torques of its axes"),
    ("[goal]", "[network]\nedges = [[\"craft\", \"craft\"]]\n[goal]",
        "test.toml:31:10: `craft` cannot hear itself", ""),
    ("error_below", "disagreement_below",
        "test.toml:31:22: `disagreement_below` is about agreement, but every agent follows a target or a leader", "write `error_below`"),
    ("name = \"craft\"", "name = \"craft\"\nparameter_variation = { seed = 1, relative = 0.1 }",
        "test.toml:6:23: `parameter_variation` is given, but there is no `count`", "a population of `count = 1` may have a spread, too"),
];

#[test]
fn mistakes_about_spacecraft_are_reported_at_their_place() {
    refused(SPACECRAFT, SPACECRAFT_CASES);
}

#[test]
fn of_two_quaternions_the_start_takes_the_one_nearer_to_the_target() {
    let start = "axis = [1, 2, -1]\nangle_rad = 3.1\n";
    for (quaternion, expected) in [("[0, 0, 0, -2]", 1.0), ("[0, 0, 0, 2]", 1.0)] {
        let text = SPACECRAFT.replace(start, &format!("quaternion = {quaternion}\n"));
        assert_eq!(read(&text).unwrap().setup.agents[0].start.q, [0.0, 0.0, 0.0, expected]);
    }
}

#[test]
fn its_limits_are_those_of_its_wheels() {
    let text = SPACECRAFT.replace("name = \"craft\"", "name = \"craft\"\nenforce_limits = true");
    assert!(read(&text).unwrap().setup.agents[0].enforce_limits);
}

/// A quaternion at 1 rad from the target, and −q.
const STATED: &str = "attitude = [0, 0, 0.479425538604203, 0.877582561890373]\n";

fn started(start: &str) -> forwardstep_io::scenario::Scenario {
    let text = SPACECRAFT.split_once("[agents.start.spacecraft]").unwrap();
    let (_, rest) = text.1.split_once("[agents.robot").unwrap();
    let text = format!("{}[agents.start]\n{start}[agents.robot{rest}", text.0);
    read(&text).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_way_round_is_the_one_that_is_asked_for_and_is_said() {
    let minus = STATED
        .replace("[0, 0, 0.479425538604203, 0.877582561890373]", "[0, 0, -0.479425538604203, -0.877582561890373]");
    let short = "craft turns by 57° to its target, the short way; from −q it would be 303°";
    let long = "craft turns by 303° to its target, the long way; from −q it would be 57°";
    for (key, plus_sign, minus_sign) in
        [("", 1.0, 1.0), ("shortest", 1.0, 1.0), ("longest", -1.0, -1.0), ("as_stated", 1.0, -1.0)]
    {
        for (stated, sign) in [(STATED, plus_sign), (&minus, minus_sign)] {
            let rotation = if key.is_empty() { String::new() } else { format!("rotation = \"{key}\"\n") };
            let scenario = started(&format!("{stated}{rotation}"));
            let o = scenario.setup.agents[0].start.q[3];
            assert!((o - sign * 0.877582561890373_f64).abs() < 1e-12, "{key} {stated}: {o}");
            let said: Vec<String> = scenario.notices.iter().map(ToString::to_string).collect();
            assert_eq!(said, [if sign > 0.0 { short } else { long }]);
        }
    }
    // Half a turn is as long either way, and stays as it is written.
    for key in ["shortest", "longest", "as_stated"] {
        let scenario = started(&format!("attitude = [0, 1, 0, 0]\nrotation = \"{key}\"\n"));
        assert_eq!(scenario.setup.agents[0].start.q, [0.0, 1.0, 0.0, 0.0]);
        assert!(scenario.notices[0].to_string().contains("turns by 180° to its target, which is as far either way"));
    }
    let nearly = started("attitude = { axis = [0, 1, 0], angle_rad = 3.1398473 }\n").notices[0].to_string();
    assert!(nearly.contains("turns by 179.90° to its target, the short way; from −q it would be 180.10°"), "{nearly}");
}

#[test]
fn the_states_of_the_law_start_as_they_are_stated() {
    let state =
        "reference = { z = [0.1, 0.2, 0.3], attitude = { axis = [0, 0, 2], angle_rad = 0 }, filter = [1, 2, 3, 4] }\n";
    let reference = started(&format!("{STATED}{state}")).setup.agents[0].start.reference.clone();
    assert_eq!(reference, [vec![0.1, 0.2, 0.3], vec![0.0, 0.0, 0.0, 1.0], vec![1.0, 2.0, 3.0, 4.0]]);
    // The attitude of the reference turns its sign with that of the craft.
    let reference =
        started(&format!("{STATED}rotation = \"longest\"\n{state}")).setup.agents[0].start.reference.clone();
    assert_eq!(reference[1], [0.0, 0.0, 0.0, -1.0]);
    let alone = started(&format!("{STATED}reference.filter.random = {{ seed = 1, within = [-1, 1] }}\n"));
    let reference = &alone.setup.agents[0].start.reference;
    assert_eq!((reference[0].as_slice(), reference[1].len(), reference[2].len()), (&[0.0; 3][..], 0, 4));
    assert!(reference[2].iter().all(|y| y.abs() <= 1.0 && *y != 0.0));
}

#[rustfmt::skip]
const STATES: &[Case] = &[
    ("[agents.robot.spacecraft]", "[agents.start]\nreference.z = [0, 0, 0, 0]\n[agents.robot.spacecraft]",
        "test.toml:15:15: `z` has 4 entries, but `craft` needs 3", ""),
    ("[agents.robot.spacecraft]", "[agents.start]\nreference.derivatives = [[0, 0, 0]]\n[agents.robot.spacecraft]",
        "test.toml:15:26: `derivatives` says nothing about `craft`", "spacecraft have `z` alone"),
    ("[agents.robot.spacecraft]", "[agents.start]\nreference.attitude = [0, 0, 0, 0]\n[agents.robot.spacecraft]",
        "test.toml:15:22: this is zero and has no direction", "[0, 0, 0, 1] is no turn"),
    ("[agents.robot.spacecraft]", "[agents.start]\nreference.filter = [0, 0, 0]\n[agents.robot.spacecraft]",
        "test.toml:15:20: `filter` has 3 entries, but `craft` needs 4", ""),
    ("[agents.robot.spacecraft]", "[agents.start]\nrotation = \"long\"\n[agents.robot.spacecraft]",
        "test.toml:15:12: unknown choice `long`", "did you mean"),
];

#[test]
fn mistakes_about_states_are_reported_at_their_place() {
    super::refused(SPACECRAFT, STATES);
}
