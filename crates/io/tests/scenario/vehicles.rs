//! Vehicles with one thrust and rotorcraft: every mistake in a scenario, where it is reported and what is said.

use super::{Case, refused};

/// Two vehicles and a rotorcraft that keep a formation.
pub(super) const VEHICLES: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "vehicle"
count = 2
robot.vehicle = { mass_kg = 1.5, gravity_m_s2 = 9.8 }
start.position_m = [[2, 0, -1], [1, 2, -3]]
start.attitude = [0, 0, 0, 1]

[[agents]]
name = "rotor"
start.angular_velocity_rad_s = [0, 0, 0.1]
target.formulas = ["sin(t)", 0, 0]

[agents.robot.rotorcraft]
mass_kg = 1.2
inertia_kg_m2 = [0.012, 0.013, 0.022]
rotors = { offset_m = 0.15, drag_m = 0.02, thrust_n = [0.2, 8] }

[reference.consensus]
roots_per_s = [1.0, 1.5, 2.0]
exchange = "position"

[law.thrust]
design.differentiable = { damping_per_s = 3, stiffness = 4 }
yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }
floor.kept = { thrust_n = 1, approach_s = 0.2 }
thrust_start_n = 12
rate_bandwidth_per_s = 30

[network]
edges.ring = {}

[goal]
disagreement_below = 1e-3
"#;

#[rustfmt::skip]
const VEHICLES_CASES: &[Case] = &[
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ mas_kg = 1.5 }",
        "test.toml:7:19: unknown key `mas_kg`", "did you mean `mass_kg`? allowed here: `mass_kg`, `gravity_m_s2`"),
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ gravity_m_s2 = 9.8 }",
        "test.toml:7:17: the key `mass_kg` is missing", ""),
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ mass_kg = 0 }",
        "test.toml:7:29: `mass_kg` is 0, but must be positive", ""),
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ mass_kg = \"heavy\" }",
        "test.toml:7:29: found \"heavy\" where a number should stand", ""),
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ mass_kg = [1.5, 2] }",
        "test.toml:7:29: found a list where a number should stand", ""),
    ("{ mass_kg = 1.5, gravity_m_s2 = 9.8 }", "{ mass_kg = inf }",
        "test.toml:7:29: inf is not a finite number", ""),
    ("gravity_m_s2 = 9.8", "gravity_m_s2 = -9.8",
        "test.toml:7:49: `gravity_m_s2` is -9.8, but must be positive", ""),
    ("gravity_m_s2 = 9.8", "gravity_m_s = 9.8",
        "test.toml:7:34: unknown key `gravity_m_s`", "did you mean `gravity_m_s2`? allowed here: `mass_kg`, `gravity_m_s2`"),
    ("robot.vehicle =", "robot.vehicel =",
        "test.toml:7:7: unknown choice `vehicel`", "did you mean `vehicle`? choose one of `urdf`, `planar_arm`, `point_mass`, `ship`, `vehicle`, `rotorcraft`, `spacecraft`, `chain`, `vector_chain`, `strict_feedback`, `pure_feedback`"),
    ("[[2, 0, -1], [1, 2, -3]]", "[[2, 0, -1]]",
        "test.toml:8:20: `position_m` has 1 list, but there are 2 agents", ""),
    ("[[2, 0, -1], [1, 2, -3]]", "[[2, 0], [1, 2, -3]]",
        "test.toml:8:21: `position_m` has 2 entries, but `vehicle-1` needs 3", ""),
    ("start.position_m =", "start.position_rad =",
        "test.toml:8:22: `position_rad` does not fit `vehicle-1`, whose axis `x` is measured in m", "`position` takes rad or m as each axis has it"),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = [0, 0, 0, 0]",
        "test.toml:9:18: this is zero and has no direction", "[0, 0, 0, 1] is no turn"),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = [0, 0, 1]",
        "test.toml:9:18: found a list of 3 where a quaternion of four numbers, vector part first, or { axis = [x, y, z], angle_rad = … } should stand", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = [0, 0, 0, 1, 0]",
        "test.toml:9:18: found a list of 5 where a quaternion of four numbers, vector part first, or { axis = [x, y, z], angle_rad = … } should stand", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = [0, 0, 0, \"up\"]",
        "test.toml:9:28: found \"up\" where a number should stand", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = \"upright\"",
        "test.toml:9:18: found \"upright\" where a quaternion of four numbers, vector part first, or { axis = [x, y, z], angle_rad = … } should stand", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = { axis = [0, 0, 0], angle_rad = 1 }",
        "test.toml:9:27: this is zero and has no direction", "[0, 0, 1] is the third axis; for no turn let `angle_rad` be 0"),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = { axis = [0, 0, 1] }",
        "test.toml:9:18: the key `angle_rad` is missing", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = { axis = [0, 1], angle_rad = 1 }",
        "test.toml:9:27: found a list of 2 where 3 are needed", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.attitude = { axis = [0, 0, 1], angle_deg = 1 }",
        "test.toml:9:38: unknown key `angle_deg`", "did you mean `angle_rad`? allowed here: `axis`, `angle_rad`"),
    ("start.attitude = [0, 0, 0, 1]", "start.atitude = [0, 0, 0, 1]",
        "test.toml:9:7: unknown key `atitude`", "did you mean `attitude`? allowed here: `position_rad`, `position_m`, `position`, `velocity_rad_s`, `velocity_m_s`, `velocity`, `attitude`, `angular_velocity_rad_s`, `spacecraft`, `rotation`, `higher_states`, `reference`"),
    ("start.attitude = [0, 0, 0, 1]", "start.angular_velocity_rad_s = [0, 0, 1]",
        "test.toml:9:32: `angular_velocity_rad_s` says nothing about `vehicle-1`", "rotorcraft and spacecraft have an angular velocity"),
    ("start.attitude = [0, 0, 0, 1]", "start.spacecraft = { angle_rad = 1, axis = [0, 0, 1] }",
        "test.toml:9:20: `spacecraft` says nothing about `vehicle-1`", "only spacecraft start by it"),
    ("start.attitude = [0, 0, 0, 1]", "start.position = [0, 0, 0]",
        "test.toml:9:18: both `position_m` and `position` are given, but they say the same", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.higher_states = [1]",
        "test.toml:9:23: `higher_states` says nothing about `vehicle-1`", "only chains of order two or more in feedback form, else of order three or more, have any"),
    ("start.attitude = [0, 0, 0, 1]", "start.reference.z = [1]",
        "test.toml:9:21: `z` has 1 entry, but `vehicle-1` needs 3", ""),
    ("start.attitude = [0, 0, 0, 1]", "start.reference = { z = [1, 0, 0], derivatives = [[0, 0, 0], [0, 0, 0], [0, 0, 0]] }",
        "test.toml:9:73: `derivatives` has 3 entries, but the reference of `vehicle-1` is of order 3", "an order of l has the derivatives 1 to l − 1"),
    ("start.angular_velocity_rad_s = [0, 0, 0.1]", "start.angular_velocity_rad_s = [0, 0.1]",
        "test.toml:13:32: found a list of 2 where 3 are needed", ""),
    ("start.angular_velocity_rad_s = [0, 0, 0.1]", "start.angular_velocity_rad_s = 0.1",
        "test.toml:13:32: found 0.1 where a list should stand", ""),
    ("[\"sin(t)\", 0, 0]", "[\"sin(t)\", 0]",
        "test.toml:14:19: `formulas` has 2 entries, but `rotor` needs 3", ""),
    ("[\"sin(t)\", 0, 0]", "[\"sin(x)\", 0, 0]",
        "test.toml:14:25: there is no `x` in a formula", "did you mean `t`? there are `t`, `pi`, `e`, `sin`, `cos`, `exp`, `log`, `sqrt`, `abs`, `tanh`, `atan`, `min`, `max`"),
    ("mass_kg = 1.2", "mass_kg = -1.2",
        "test.toml:17:11: `mass_kg` is -1.2, but must be positive", ""),
    ("mass_kg = 1.2\n", "",
        "test.toml:16:1: the key `mass_kg` is missing", ""),
    ("inertia_kg_m2 = [0.012, 0.013, 0.022]\n", "",
        "test.toml:16:1: the key `inertia_kg_m2` is missing", ""),
    ("[0.012, 0.013, 0.022]", "0",
        "test.toml:18:17: `inertia_kg_m2` is 0, but must be positive", ""),
    ("[0.012, 0.013, 0.022]", "[0.012, 0.013]",
        "test.toml:18:17: `inertia_kg_m2` has 2 entries, but `rotor` needs 3", ""),
    ("[0.012, 0.013, 0.022]", "[0.012, 0, 0.022]",
        "test.toml:18:25: `inertia_kg_m2` is 0, but must be positive", ""),
    ("[0.012, 0.013, 0.022]", "[[1, 2, 0], [2, 1, 0], [0, 0, 1]]",
        "test.toml:18:17: `inertia_kg_m2` of `rotor`: the matrix is not positive definite: vᵀ A v = -3 for v = (-2, 1, 0)", ""),
    ("[0.012, 0.013, 0.022]", "[[1, 1, 0], [0, 1, 0], [0, 0, 1]]",
        "test.toml:18:17: `inertia_kg_m2` of `rotor`: entries (0, 1) and (1, 0) differ: 1 and 0; the matrix must be symmetric", ""),
    ("[0.012, 0.013, 0.022]", "[[1, 0], [0, 1, 0], [0, 0, 1]]",
        "test.toml:18:18: `inertia_kg_m2` has 3 rows, but row 1 has 2 entries", ""),
    ("offset_m = 0.15", "ofset_m = 0.15",
        "test.toml:19:12: unknown key `ofset_m`", "did you mean `offset_m`? allowed here: `offset_m`, `drag_m`, `thrust_n`"),
    ("offset_m = 0.15", "offset_m = 0",
        "test.toml:19:23: `offset_m` is 0, but must be positive", ""),
    ("drag_m = 0.02", "drag_m = -0.02",
        "test.toml:19:38: `drag_m` is -0.02, but must be positive", ""),
    ("drag_m = 0.02, ", "",
        "test.toml:19:10: the key `drag_m` is missing", ""),
    ("thrust_n = [0.2, 8]", "thrust_n = [8, 0.2]",
        "test.toml:19:59: `thrust_n` is 0.2, but must be above the least thrust", ""),
    ("thrust_n = [0.2, 8]", "thrust_n = [-0.2, 8]",
        "test.toml:19:56: `thrust_n` is -0.2, but must not be negative", ""),
    ("thrust_n = [0.2, 8]", "thrust_n = [8, 8]",
        "test.toml:19:59: `thrust_n` is 8, but must be above the least thrust", ""),
    ("thrust_n = [0.2, 8]", "thrust_n = 8",
        "test.toml:19:55: found 8 where a list should stand", ""),
    ("thrust_n = [0.2, 8]", "thrust_n = [0.2, 8, 8]",
        "test.toml:19:55: found a list of 3 where 2 are needed", ""),
    ("[1.0, 1.5, 2.0]", "[1.0, 1.5]",
        "test.toml:22:15: agent `vehicle-1`: the list of roots has 2 entries where 3 are needed", "give it 3 roots; an agent may have `reference` with roots of its own"),
    ("[1.0, 1.5, 2.0]", "[1.0, 0, 2.0]",
        "test.toml:22:21: `roots_per_s` is 0, but must be positive", ""),
    ("exchange = \"position\"", "exchange = \"position_velocity\"",
        "test.toml:23:12: agent `vehicle-1`: the thrust law sends its position only, but the agents exchange positions and velocities", "write `exchange = \"position\"`"),
    ("exchange = \"position\"", "exchange = \"position\"\nmanipulability_gain = 2",
        "test.toml:24:23: agent `vehicle-1`: the thrust law has no manipulability gain, but 2 is given", "leave `manipulability_gain` out"),
    ("[reference.consensus]\nroots_per_s = [1.0, 1.5, 2.0]\nexchange = \"position\"", "[reference.pure_integral]\nroots_per_s = [1.0, 1.5]\nexchange = \"position\"",
        "test.toml:21:2: agent `vehicle-1`: the thrust law does not go with these reference dynamics", "write `reference.consensus` with `exchange = \"position\"`"),
    ("[reference.consensus]\nroots_per_s = [1.0, 1.5, 2.0]\nexchange = \"position\"", "[reference.backstepping]\nfilter_s = 0.1",
        "test.toml:21:2: agent `vehicle-1`: the thrust law does not go with these reference dynamics", "write `reference.consensus` with `exchange = \"position\"`"),
    ("[reference.consensus]\nroots_per_s = [1.0, 1.5, 2.0]\nexchange = \"position\"", "[reference.tracking]\nroots_per_s = [1.0, 1.5, 2.0]",
        "test.toml:21:2: agent `vehicle-1`: the thrust law does not follow a target of its own; it goes with consensus", "write `reference.consensus`; laws that track are `adaptive`, `known`, `position_only`, `task_space`, `attitude`, `passivity_filter` and those of chains"),
    ("[law.thrust]", "[law.thurst]",
        "test.toml:25:6: unknown choice `thurst`", "did you mean `thrust`? choose one of `adaptive`, `known`, `position_only`, `thrust`, `task_space`, `attitude`, `passivity_filter`, `linearising`, `linear_adaptive`, `immersion`, `adaptive_backstepping`"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.diferentiable = {}",
        "test.toml:26:8: unknown choice `diferentiable`", "did you mean `differentiable`? choose one of `continuous`, `differentiable`, `adaptive`"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design = \"differentiable\"",
        "test.toml:26:10: `differentiable` needs a value", "write it with its value: { differentiable = … }"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design = 4",
        "test.toml:26:10: found 4 where a choice of continuous, differentiable, adaptive should stand", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.continuous = { damping_per_s = 3 }",
        "test.toml:26:8: `continuous` takes no value", "write it as a text: \"continuous\""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design = \"continuous\"",
        "test.toml:22:15: agent `vehicle-1`: the list of roots has 3 entries where 2 are needed", "give it 2 roots; an agent may have `reference` with roots of its own"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.differentiable = { damping_per_s = 0 }",
        "test.toml:26:43: `damping_per_s` is 0, but must be positive", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.differentiable = { damping = 3 }",
        "test.toml:26:27: unknown key `damping`", "did you mean `damping_per_s`? allowed here: `damping_per_s`, `stiffness`"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.differentiable = { stiffness = -4 }",
        "test.toml:26:39: `stiffness` is -4, but must be positive", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.differentiable = { stiffness = \"stiff\" }",
        "test.toml:26:39: found \"stiff\" where a number should stand", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.differentiable = { estimate_start_kg = 1 }",
        "test.toml:26:27: unknown key `estimate_start_kg`", "allowed here: `damping_per_s`, `stiffness`"),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.adaptive = {}",
        "test.toml:26:19: the key `estimate_start_kg` is missing", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.adaptive = { estimate_start_kg = 0 }",
        "test.toml:26:41: `estimate_start_kg` is 0, but must be positive", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.adaptive = { estimate_start_kg = 1, adaptation_gain = -1 }",
        "test.toml:26:62: `adaptation_gain` is -1, but must not be negative", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.adaptive = { estimate_start_kg = 1, damping_per_s = -1 }",
        "test.toml:26:60: `damping_per_s` is -1, but must be positive", ""),
    ("design.differentiable = { damping_per_s = 3, stiffness = 4 }", "design.adaptive = { estimate_start_kg = 1, stiffness = 1 }",
        "test.toml:26:44: unknown key `stiffness`", "allowed here: `damping_per_s`, `adaptation_gain`, `estimate_start_kg`, `bounds`"),
    ("yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }", "yaw = { gain_per_s = -1 }",
        "test.toml:27:22: `gain_per_s` is -1, but must not be negative", ""),
    ("yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }", "yaw = { heading_rad = \"north\" }",
        "test.toml:27:23: found \"north\" where a number should stand", ""),
    ("yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }", "yaw = { heading = 1 }",
        "test.toml:27:9: unknown key `heading`", "did you mean `heading_rad`? allowed here: `heading_rad`, `rate_rad_s`, `gain_per_s`"),
    ("yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }", "yaw = { rate_rad_s = nan }",
        "test.toml:27:22: nan is not a finite number", ""),
    ("yaw = { heading_rad = 0.8, rate_rad_s = 0.1, gain_per_s = 2 }", "yaw = 0.8",
        "test.toml:27:7: found 0.8 where a table of heading_rad, rate_rad_s, gain_per_s should stand", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.stops_n = 0",
        "test.toml:28:17: `stops_n` is 0, but must be positive", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.stops_n = -1",
        "test.toml:28:17: `stops_n` is -1, but must be positive", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.stops_n = { thrust_n = 1 }",
        "test.toml:28:17: found a table where a number should stand", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.kept = 1",
        "test.toml:28:14: found 1 where a table of thrust_n, approach_s should stand", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.kept = { thrust_n = 0 }",
        "test.toml:28:27: `thrust_n` is 0, but must be positive", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.kept = { approach_s = 0.2 }",
        "test.toml:28:14: the key `thrust_n` is missing", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.kept = { thrust_n = 1, approach_s = 0 }",
        "test.toml:28:43: `approach_s` is 0, but must be positive", ""),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor.keeps = { thrust_n = 1 }",
        "test.toml:28:7: unknown choice `keeps`", "choose one of `stops_n`, `kept`"),
    ("floor.kept = { thrust_n = 1, approach_s = 0.2 }", "floor = 1",
        "test.toml:28:9: found 1 where a choice of stops_n, kept should stand", ""),
    ("thrust_start_n = 12", "thrust_start_n = 0",
        "test.toml:29:18: `thrust_start_n` is 0, but must be positive", ""),
    ("thrust_start_n = 12", "thrust_start = 12",
        "test.toml:29:1: unknown key `thrust_start`", "did you mean `thrust_start_n`? allowed here: `design`, `yaw`, `floor`, `thrust_start_n`, `rate_bandwidth_per_s`"),
    ("rate_bandwidth_per_s = 30", "rate_bandwidth_per_s = -30",
        "test.toml:30:24: `rate_bandwidth_per_s` is -30, but must be positive", ""),
    ("rate_bandwidth_per_s = 30", "rate_bandwidth = 30",
        "test.toml:30:1: unknown key `rate_bandwidth`", "did you mean `rate_bandwidth_per_s`? allowed here: `design`, `yaw`, `floor`, `thrust_start_n`, `rate_bandwidth_per_s`"),
    ("[network]", "[[external_wrenches]]\non = [\"rotor\"]\nby.torque_n_m = [1, 0, 0]\n[network]",
        "test.toml:34:17: `torque_n_m` does not fit `rotor`, whose axis `x` is measured in m", "`effort` takes N m or N as each axis has it"),
    ("[network]", "[[external_wrenches]]\non = [\"vehicle\"]\nby.body_torque_n_m = [1, 0, 0]\n[network]",
        "test.toml:34:22: `body_torque_n_m` does not act on `vehicle-1`", "what acts on it is `effort`, `force_n` or `torque_n_m`, and `virtual_spring_on_axes`"),
    ("[network]", "[leader]\nmotion.formulas = [0, 0, 0]\n[network]",
        "test.toml:32:1: there is a leader, but `reference.consensus` does not follow one", "write `reference.leader`, or delete the leader"),
    ("[network]", "[control]\nsample_hz = 100\ntorque_limit = 0\n[network]",
        "test.toml:34:16: `torque_limit` is 0, but must be positive", ""),
    ("[network]", "[control]\nsample_hz = 100\ntorque_limit = 1\n[network]",
        "test.toml:34:16: agent `vehicle-1`: the limit of torques has 3 entries where 0 are needed", "leave it out: this robot has another number of torques than of axes"),
    ("[network]", "[control]\nsample_hz = 100\ntorque_limit = [1, 1]\n[network]",
        "test.toml:34:16: agent `vehicle-1`: the limit of torques has 2 entries where 3 are needed", "a single number stands for all axes"),
    ("[network]", "[control]\nsample_hz = 100\nnoise = { seed = -1 }\n[network]",
        "test.toml:34:18: `seed` is -1, but must not be negative", ""),
    ("count = 2", "count = 2\nenforce_limits = true",
        "test.toml:7:18: `enforce_limits` is true, but axis `x` of `vehicle-1` has no effort limit", "only a URDF states limits, as <limit effort=\"…\"> of a joint"),
    ("count = 2", "parameter_variation = { seed = 1, relative = 0.1 }",
        "test.toml:6:23: `parameter_variation` is given, but there is no `count`", "a population of `count = 1` may have a spread, too"),
    ("count = 2", "count = 2\nlaw.adaptive = {}",
        "test.toml:7:1: agent `vehicle-1`: the law `adaptive` is made for arms and point masses", "for this robot there is `thrust`"),
    ("count = 2", "count = 2\nlaw.attitude = {}",
        "test.toml:7:1: agent `vehicle-1`: the law `attitude` is made for spacecraft", "for this robot there is `thrust`"),
];

#[test]
fn mistakes_about_vehicles_are_reported_at_their_place() {
    refused(VEHICLES, VEHICLES_CASES);
}
