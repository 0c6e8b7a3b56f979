//! The tip of a robot: every mistake in a scenario, where it is reported and what is said.

use super::{Case, refused};

/// The tip of a UR5e with three joints free.
pub(super) const TIP: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "arm"
start.position_rad = [0.4, -1.2, 1.6]
target.formulas = ["-0.6 + 0.1*cos(t)", -0.4, 0.45]

[agents.robot.urdf]
file = "ur5e.urdf"
locked = { wrist_1_joint = -3.14, wrist_2_joint = -1.57, wrist_3_joint = 0 }

[reference.tracking]

[law.task_space]
damping.bandwidth_per_s = 40
adaptation_gain.bandwidth_per_s = 10
estimate_start.scaled = 0.8
task_gain = 200
torque_share = 2
reference_gain_per_s = 6
kinematic_gain = 1
kinematic_start.scaled = 1.2
determinant_floor = 0.02
end_effector = { link = "tool0", at_m = [0, 0, 0.15], coordinates = ["x", "y", "z"], uncertain = "tool" }
bounds = { lower_m = [0.1, 0.1, 0.1], upper_m = [1, 1, 1], margin_m = 0.02 }

[goal]
error_below = 1e-3
"#;

#[rustfmt::skip]
const TIP_CASES: &[Case] = &[
    ("[law.task_space]", "[law.taskspace]",
        "test.toml:15:6: unknown choice `taskspace`", "did you mean `task_space`? choose one of `adaptive`, `known`, `position_only`, `model_reference`, `thrust`, `task_space`, `attitude`, `passivity_filter`, `linearising`, `linear_adaptive`, `immersion`, `adaptive_backstepping`"),
    ("damping.bandwidth_per_s = 40", "damping.bandwidth_per_s = 0",
        "test.toml:16:27: `damping.bandwidth_per_s` is 0, but must be positive", ""),
    ("damping.bandwidth_per_s = 40", "damping.bandwidth = 40",
        "test.toml:16:9: unknown choice `bandwidth`", "did you mean `bandwidth_per_s`? choose one of `gain`, `bandwidth_per_s`"),
    ("damping.bandwidth_per_s = 40", "damping = 40",
        "test.toml:16:11: found 40 where a choice of gain, bandwidth_per_s should stand", "say which it is, behind the key and a dot, such as `.gain = 40`"),
    ("damping.bandwidth_per_s = 40", "damping.gain = [1, 2]",
        "test.toml:16:16: `damping.gain` has 2 entries, but `arm` needs 3", ""),
    ("adaptation_gain.bandwidth_per_s = 10", "adaptation_gain.bandwidth_per_s = -10",
        "test.toml:17:35: `adaptation_gain.bandwidth_per_s` is -10, but must be positive", ""),
    ("adaptation_gain.bandwidth_per_s = 10", "adaptation_gain = [1, 2]",
        "test.toml:17:19: `adaptation_gain` has 2 entries, but `arm` needs 30", ""),
    ("adaptation_gain.bandwidth_per_s = 10", "adaptation_gain = \"fast\"",
        "test.toml:17:19: found \"fast\" where a number, a list (the diagonal), a list of rows or { bandwidth_per_s = … } should stand", ""),
    ("estimate_start.scaled = 0.8", "estimate_start.given = [1, 2]",
        "test.toml:18:24: `estimate_start.given` has 2 entries, but `arm` needs 30", ""),
    ("estimate_start.scaled = 0.8", "estimate_start = \"none\"",
        "test.toml:18:18: unknown choice `none`", "choose one of `zero`, `true`, `scaled`, `given`"),
    ("estimate_start.scaled = 0.8", "estimate_start.scaled = \"0.8\"",
        "test.toml:18:25: found \"0.8\" where a number should stand", "write 0.8, without quotes"),
    ("task_gain = 200", "task_gain = 0",
        "test.toml:19:13: `task_gain` is 0, but must be positive", ""),
    ("task_gain = 200", "task_gain = [1, 2]",
        "test.toml:19:13: `task_gain` has 2 entries, but `arm` needs 3", ""),
    ("task_gain = 200", "task_gain = [[1, 2, 0], [2, 1, 0], [0, 0, 1]]",
        "test.toml:19:13: `task_gain` of `arm`: the matrix is not positive definite: vᵀ A v = -3 for v = (-2, 1, 0)", ""),
    ("task_gain = 200", "task_gains = 200",
        "test.toml:19:1: unknown key `task_gains`", "did you mean `task_gain`? allowed here: `end_effector`, `tip_velocity`, `damping`, `adaptation_gain`, `estimate_start`, `estimate_bounds`, `task_gain`, `attitude_gain`, `null_space`, `torque_share`, `reference_gain_per_s`, `kinematic_gain`, `kinematic_start`, `bounds`, `determinant_floor`"),
    ("torque_share = 2", "torque_share = 0",
        "test.toml:20:16: `torque_share` is 0, but must be positive", ""),
    ("torque_share = 2", "torque_share = [2, 2, 2]",
        "test.toml:20:16: found a list where a number should stand", ""),
    ("reference_gain_per_s = 6", "reference_gain_per_s = -6",
        "test.toml:21:24: `reference_gain_per_s` is -6, but must be positive", ""),
    ("reference_gain_per_s = 6", "reference_gain = 6",
        "test.toml:21:1: unknown key `reference_gain`", "did you mean `reference_gain_per_s`? allowed here: `end_effector`, `tip_velocity`, `damping`, `adaptation_gain`, `estimate_start`, `estimate_bounds`, `task_gain`, `attitude_gain`, `null_space`, `torque_share`, `reference_gain_per_s`, `kinematic_gain`, `kinematic_start`, `bounds`, `determinant_floor`"),
    ("kinematic_gain = 1", "kinematic_gain = -1",
        "test.toml:22:18: `kinematic_gain` is -1, but must be positive", ""),
    ("kinematic_gain = 1", "kinematic_gain = [1, 2]",
        "test.toml:22:18: `kinematic_gain` has 2 entries, but `arm` needs 3", ""),
    ("kinematic_gain = 1", "kinematic_gain = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
        "test.toml:26:10: `bounds` need `kinematic_gain` to be a number or a diagonal, not a matrix", ""),
    ("kinematic_start.scaled = 1.2", "kinematic_start.given = [1, 2]",
        "test.toml:23:25: `kinematic_start.given` has 2 entries, but `arm` needs 3", ""),
    ("kinematic_start.scaled = 1.2", "kinematic_start = \"guess\"",
        "test.toml:23:19: unknown choice `guess`", "choose one of `zero`, `true`, `scaled`, `given`"),
    ("determinant_floor = 0.02", "determinant_floor = 1",
        "test.toml:24:21: `determinant_floor` is 1, but must be from 0 to 0.999", ""),
    ("determinant_floor = 0.02", "determinant_floor = -0.1",
        "test.toml:24:21: `determinant_floor` is -0.1, but must be from 0 to 0.999", ""),
    ("end_effector = { link = \"tool0\", at_m = [0, 0, 0.15], coordinates = [\"x\", \"y\", \"z\"], uncertain = \"tool\" }\n", "",
        "test.toml:15:2: the law `task_space` needs `end_effector` for a robot from a URDF", "add end_effector = { link = \"…\" } with a link of the URDF"),
    ("link = \"tool0\"", "link = \"tool1\"",
        "test.toml:25:25: `arm` has no link `tool1`", "did you mean `tool0`? its links are `base_link`, `shoulder_link`, `upper_arm_link`, `forearm_link`, `wrist_1_link`, `wrist_2_link`, `wrist_3_link`, `tool0`"),
    ("link = \"tool0\"", "links = \"tool0\"",
        "test.toml:25:18: unknown key `links`", "did you mean `link`? allowed here: `link`, `at_m`, `coordinates`, `follows`, `uncertain`"),
    ("link = \"tool0\", ", "",
        "test.toml:25:16: the key `link` is missing", ""),
    ("at_m = [0, 0, 0.15]", "at_m = [0, 0.15]",
        "test.toml:25:41: found a list of 2 where 3 are needed", ""),
    ("at_m = [0, 0, 0.15]", "at_m = 0.15",
        "test.toml:25:41: found 0.15 where a list should stand", ""),
    ("coordinates = [\"x\", \"y\", \"z\"]", "coordinates = [\"x\", \"y\"]",
        "test.toml:25:16: 3 joints move and 2 coordinates of the end-effector are to be controlled; task-space control needs as many joints as coordinates (a redundant Jacobian has no inverse): lock joints or choose other coordinates", "`locked` of the robot holds joints of a URDF"),
    ("coordinates = [\"x\", \"y\", \"z\"]", "coordinates = [\"x\", \"y\", \"y\"]",
        "test.toml:25:69: coordinate 1 (of x = 0, y = 1, z = 2 of the base) is chosen twice, or there is none", "choose `x`, `y` and `z`, each at most once"),
    ("coordinates = [\"x\", \"y\", \"z\"]", "coordinates = [\"x\", \"y\", \"w\"]",
        "test.toml:25:80: unknown choice `w`", "did you mean `x`? choose one of `x`, `y`, `z`"),
    ("coordinates = [\"x\", \"y\", \"z\"]", "coordinates = []",
        "test.toml:25:69: `coordinates` is empty", ""),
    ("coordinates = [\"x\", \"y\", \"z\"]", "coordinates = [\"x\", \"y\", \"z\", \"x\"]",
        "test.toml:25:69: coordinate 0 (of x = 0, y = 1, z = 2 of the base) is chosen twice, or there is none", "choose `x`, `y` and `z`, each at most once"),
    ("uncertain = \"tool\"", "uncertain = \"all\"",
        "test.toml:25:98: unknown choice `all`", "choose one of `tool`, `chain`"),
    ("link = \"tool0\"", "link = \"upper_arm_link\"",
        "test.toml:25:25: `elbow_joint` moves, but does not carry `upper_arm_link`", "add `elbow_joint` to `locked`, or choose a link behind it"),
    ("lower_m = [0.1, 0.1, 0.1]", "lower_m = [0.1, 0.1]",
        "test.toml:26:22: `lower_m` has 2 entries, but `arm` needs 3", ""),
    ("upper_m = [1, 1, 1]", "upper_m = [1, 1, 0]",
        "test.toml:26:56: `upper_m` is 0, but must not be less than `lower_m`, which is 0.1", ""),
    ("upper_m = [1, 1, 1], ", "",
        "test.toml:26:10: the key `upper_m` is missing", ""),
    ("upper_m = [1, 1, 1]", "uper_m = [1, 1, 1]",
        "test.toml:26:39: unknown key `uper_m`", "did you mean `upper_m`? allowed here: `lower_m`, `upper_m`, `margin_m`"),
    ("margin_m = 0.02", "margin_m = 0",
        "test.toml:26:71: `margin_m` is 0, but must be positive", ""),
    ("wrist_1_joint = -3.14, ", "",
        "test.toml:25:16: 4 joints move and 3 coordinates of the end-effector are to be controlled; task-space control needs as many joints as coordinates (a redundant Jacobian has no inverse): lock joints or choose other coordinates", "`locked` of the robot holds joints of a URDF"),
    ("[\"-0.6 + 0.1*cos(t)\", -0.4, 0.45]", "[\"-0.6 + 0.1*cos(t)\", -0.4]",
        "test.toml:7:19: `formulas` has 2 entries, but `arm` needs 3", ""),
    ("[\"-0.6 + 0.1*cos(t)\", -0.4, 0.45]", "[\"-0.6 + 0.1*cos(t\", -0.4, 0]",
        "test.toml:7:35: this parenthesis is not closed", ""),
    ("target.formulas = [\"-0.6 + 0.1*cos(t)\", -0.4, 0.45]\n", "",
        "test.toml:5:8: agent `arm` is to track a target, but has none", "give it a `target`"),
    ("[reference.tracking]", "[reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"\n[network]\nedges = []",
        "test.toml:13:2: agent `arm`: the law for an end-effector follows a target of its own; it does not agree with others", "write `reference.tracking`, and give it a `target`"),
    ("[goal]", "[[external_wrenches]]\non = [\"arm\"]\nby.disturbance = [1, 0, 0]\n[goal]",
        "test.toml:30:18: `disturbance` does not act on `arm`", "what acts on it is `effort`, `force_n` or `torque_n_m`, `wrench`"),
    ("[goal]", "[control]\nsample_hz = 1000\nnoise = { seed = 1, tip_velocity = 0.01 }\n[goal]",
        "test.toml:30:36: the noise of the velocities of end-effectors is 0.01, but no law measures the velocity of an end-effector", "leave it out"),
    ("[goal]", "[control]\nsample_hz = 1000\nnoise = { seed = 1, velocity = -1 }\n[goal]",
        "test.toml:30:32: `noise.velocity` is -1, but must not be negative", ""),
];

/// The tip of a planar arm.
pub(super) const PLANAR: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "arm"
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [0.5, 1.0]
target.formulas = ["1 + 0.1*cos(t)", 0.5]

[reference.tracking]

[law.task_space]
kinematic_gain = [0.3, 0.2]
bounds = { lower_m = [0.9, 0.7], upper_m = [1.1, 0.9] }

[goal]
error_below = 1e-3
"#;

#[rustfmt::skip]
const PLANAR_CASES: &[Case] = &[
    ("kinematic_gain = [0.3, 0.2]", "end_effector = { link = \"tool0\" }",
        "test.toml:13:16: the end-effector of a planar arm is the end of its second link; `end_effector` is for robots from a URDF", "leave `end_effector` out"),
    ("kinematic_gain = [0.3, 0.2]", "kinematic_gain = [0.3]",
        "test.toml:13:18: `kinematic_gain` has 1 entry, but `arm` needs 2", ""),
    ("kinematic_gain = [0.3, 0.2]", "kinematic_gain = [[0.3, 0], [0, 0.2]]",
        "test.toml:14:10: `bounds` need `kinematic_gain` to be a number or a diagonal, not a matrix", ""),
    ("kinematic_gain = [0.3, 0.2]", "kinematic_start.given = [1.0]",
        "test.toml:13:25: `kinematic_start.given` has 1 entry, but `arm` needs 2", ""),
    ("lower_m = [0.9, 0.7]", "lower_m = [1.2, 0.7]",
        "test.toml:14:45: `upper_m` is 1.1, but must not be less than `lower_m`, which is 1.2", ""),
    ("lower_m = [0.9, 0.7]", "lower_m = 0.9",
        "test.toml:14:22: found 0.9 where a list should stand", ""),
    ("lower_m = [0.9, 0.7], ", "",
        "test.toml:14:10: the key `lower_m` is missing", ""),
    ("robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }\nstart.position_rad", "robot.point_mass = { dimension = 2, mass_kg = 1 }\nstart.position_m",
        "test.toml:12:2: agent `arm`: the law `task_space` is made for planar arms and robots from a URDF", "for this robot there is `adaptive`, `known`, `position_only` and `model_reference`"),
    ("robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }\nstart.position_rad", "robot.urdf = { file = \"ur5e.urdf\" }\nstart.position_rad",
        "test.toml:12:2: the law `task_space` needs `end_effector` for a robot from a URDF", "add end_effector = { link = \"…\" } with a link of the URDF"),
    ("[law.task_space]\nkinematic_gain = [0.3, 0.2]\nbounds = { lower_m = [0.9, 0.7], upper_m = [1.1, 0.9] }", "[law.adaptive]",
        "test.toml:10:1: agent `arm`: roots of the reference dynamics: 0, but at least 1 are needed here", "an agent may have `reference` with roots of its own"),
];

/// All six joints of a UR5e, for a pose.
pub(super) const POSE: &str = r#"format = 2
time = { end_s = 2 }

[[agents]]
name = "arm"
start.position_rad = [0.4, -1.2, 1.6, -1.9, -1.5, 0.3]

[agents.target.pose]
position = ["-0.6 + 0.1*cos(t)", -0.4, 0.3]
attitude = { axis = [1, 0, 0], angle_rad = 3 }
turning = { axis = [0, 0, 2], rad_per_s = 0.1 }

[agents.robot.urdf]
file = "ur5e.urdf"

[reference.tracking]

[law.task_space]
attitude_gain = 60
end_effector = { link = "tool0", at_m = [0, 0, 0.15], follows = "pose" }
"#;

#[rustfmt::skip]
const POSE_CASES: &[Case] = &[
    ("attitude_gain = 60", "attitude_gain = 0",
        "test.toml:19:17: `attitude_gain` is 0, but must be positive", ""),
    ("attitude_gain = 60", "attitude_gain = -1",
        "test.toml:19:17: `attitude_gain` is -1, but must be positive", ""),
    ("attitude_gain = 60", "attitude_gain = [60, 60, 60]",
        "test.toml:19:17: found a list where a number should stand", ""),
    ("attitude_gain = 60", "tip_velocity = \"measured\"",
        "test.toml:19:16: with a measured velocity of the end-effector the law is derived for positions of as many coordinates as there are joints", "leave `tip_velocity` out: Theorem 6 needs none"),
    ("attitude_gain = 60", "tip_velocity = \"guessed\"",
        "test.toml:19:16: unknown choice `guessed`", "choose one of `measured`"),
    ("attitude_gain = 60", "null_space.posture = [0, 0, 0, 0, 0, 0]",
        "test.toml:19:1: a pose leaves none of its six joints free, and the theorem has no null-space term beside an orientation", "leave `null_space` out"),
    ("follows = \"pose\"", "follows = \"pose\", coordinates = [\"x\", \"y\"]",
        "test.toml:20:87: a pose has the coordinates x, y, z in this order, not others", "leave `coordinates` out"),
    ("file = \"ur5e.urdf\"", "file = \"ur5e.urdf\"\nlocked = { wrist_3_joint = 0 }",
        "test.toml:21:16: 5 joints move; a pose has three coordinates and three angles, and is followed by exactly six joints (with fewer it cannot be reached, and the theorem has no null-space term beside an orientation)", ""),
    ("attitude_gain = 60", "null_space.posture = [0, 0]",
        "test.toml:19:1: a pose leaves none of its six joints free, and the theorem has no null-space term beside an orientation", "leave `null_space` out"),
    ("file = \"ur5e.urdf\"", "file = \"panda.urdf\"",
        "test.toml:20:25: `arm` has no link `tool0`", "its links are `panda_link0`, `panda_link1`, `panda_link2`, `panda_link3`, `panda_link4`, `panda_link5`, `panda_link6`, `panda_link7`, `panda_link8`"),
    ("axis = [1, 0, 0], angle_rad = 3", "axis = [0, 0, 0], angle_rad = 3",
        "test.toml:10:21: this is zero and has no direction", "[0, 0, 1] is the third axis; for no turn let `angle_rad` be 0"),
    ("attitude = { axis = [1, 0, 0], angle_rad = 3 }", "attitude = [0, 0, 0, 0]",
        "test.toml:10:12: this is zero and has no direction", "[0, 0, 0, 1] is no turn"),
    ("position = [\"-0.6 + 0.1*cos(t)\", -0.4, 0.3]", "position = [-0.4, 0.3]",
        "test.toml:9:12: `position` has 2 entries, but `arm` needs 3", ""),
    ("attitude_gain = 60\nend_effector = { link = \"tool0\", at_m = [0, 0, 0.15], follows = \"pose\" }", "null_space.posture = [0, 0, 0, 0, 0, 0]\nend_effector = { link = \"tool0\" }",
        "test.toml:8:9: `pose` is for an end-effector whose position and orientation follow the target", "let `follows` of the law's `end_effector` be \"pose\", or write `formulas`, an entry for each axis"),
];

#[test]
fn mistakes_about_a_pose_are_reported_at_their_place() {
    refused(POSE, POSE_CASES);
}

#[test]
fn mistakes_about_the_tip_of_a_urdf_are_reported_at_their_place() {
    refused(TIP, TIP_CASES);
}

#[test]
fn mistakes_about_the_tip_of_a_planar_arm_are_reported_at_their_place() {
    refused(PLANAR, PLANAR_CASES);
}
