//! Networks of several kinds of agents: who cannot agree with whom, where it is reported and what is said.

use super::{Case, refused};

/// A mass, one without velocity, and a vehicle.
pub(super) const MIXED: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "mass"
robot.point_mass = { dimension = 3, mass_kg = 3 }

[[agents]]
name = "blind"
robot.point_mass = { dimension = 3, mass_kg = 2 }
law.position_only = { damping = 20 }

[[agents]]
name = "vehicle"
robot.vehicle = { mass_kg = 1.5 }
law.thrust.design.differentiable = { damping_per_s = 3 }

[reference.consensus]
roots_per_s = [1.0, 1.5, 2.0]
exchange = "position"

[network]
edges.ring = {}

[goal]
disagreement_below = 1e-3
"#;

#[rustfmt::skip]
const MIXED_CASES: &[Case] = &[
    ("dimension = 3, mass_kg = 3", "dimension = 2, mass_kg = 3",
        "test.toml:10:1: `mass` has 2 axes and `blind` has 3, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("robot.point_mass = { dimension = 3, mass_kg = 3 }", "robot.urdf = { file = \"ur5e.urdf\", locked = { wrist_1_joint = 0, wrist_2_joint = 0, wrist_3_joint = 0 } }",
        "test.toml:6:1: agent `vehicle` moves in space and exchanges positions in m, but axis `shoulder_pan_joint` of `mass` is an angle; they have nothing to agree on", "point masses, vehicles and robots with three prismatic joints have a position in space"),
    ("robot.point_mass = { dimension = 3, mass_kg = 3 }", "robot.planar_arm = { mass_kg = [1, 1], length_m = [1, 1] }",
        "test.toml:10:1: `mass` has 2 axes and `blind` has 3, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("robot.point_mass = { dimension = 3, mass_kg = 3 }", "robot.spacecraft = { inertia_kg_m2 = [1, 1, 1] }",
        "test.toml:10:1: `mass` has 4 axes and `blind` has 3, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("robot.point_mass = { dimension = 3, mass_kg = 3 }", "robot.chain = { order = 2 }",
        "test.toml:10:1: `mass` has 1 axis and `blind` has 3, but all agents of a scenario need as many", "references, the network and goals are of one vector of axes; `locked` removes joints of a URDF"),
    ("exchange = \"position\"", "exchange = \"position_velocity\"",
        "test.toml:20:12: agent `blind`: the law without velocity sends its position only, but the agents exchange positions and velocities", "write `exchange = \"position\"`"),
    ("law.position_only = { damping = 20 }", "law.thrust = {}",
        "test.toml:11:1: agent `blind`: the law `thrust` is made for vehicles and rotorcraft", "for this robot there is `adaptive`, `known`, `position_only` and `model_reference`"),
    ("law.position_only = { damping = 20 }", "law.linear_adaptive = {}",
        "test.toml:11:1: agent `blind`: the law `linear_adaptive` is made for `chain` and `vector_chain`, plants of derivatives", "for this robot there is `adaptive`, `known`, `position_only` and `model_reference`"),
    ("law.position_only = { damping = 20 }", "law.position_only = { damping = 20 }\ntarget.formulas = [0, 0, \"t\"]",
        "test.toml:12:1: agent `blind`: the law without velocity knows no offsets", "leave its `target` out; only vehicles and rotorcraft agree up to offsets"),
    ("robot.point_mass = { dimension = 3, mass_kg = 3 }", "robot.point_mass = { dimension = 3, mass_kg = 3 }\ntarget.formulas = [0, 0, \"t\"]",
        "test.toml:7:1: agent `mass`: the adaptive law knows no offsets", "leave its `target` out; only vehicles and rotorcraft agree up to offsets"),
    ("law.thrust.design.differentiable = { damping_per_s = 3 }", "law.known = {}",
        "test.toml:16:1: agent `vehicle`: the law `known` is made for arms and point masses", "for this robot there is `thrust`"),
    ("law.thrust.design.differentiable = { damping_per_s = 3 }", "law.thrust.design = \"continuous\"",
        "test.toml:19:15: agent `vehicle`: the list of roots has 3 entries where 2 are needed", "give it 2 roots; an agent may have `reference` with roots of its own"),
    ("law.thrust.design.differentiable = { damping_per_s = 3 }", "law.thrust.design.differentiable = {}\nreference.consensus.roots_per_s = [1, 2]",
        "test.toml:17:35: agent `vehicle`: the list of roots has 2 entries where 3 are needed", "give it 3 roots; an agent may have `reference` with roots of its own"),
    ("law.thrust.design.differentiable = { damping_per_s = 3 }", "law.thrust.design.differentiable = {}\nreference.tracking = {}",
        "test.toml:17:1: `vehicle` cannot have reference dynamics of its own kind; those of all are `consensus`", "an agent may have `reference.consensus` with roots and a gain of its own"),
    ("law.position_only = { damping = 20 }", "law.position_only = { damping = 20 }\nreference.consensus.roots_per_s = [1]",
        "test.toml:12:35: agent `blind`: its reference dynamics have order 1, but its law needs 2 roots or more", "give it 2 roots or more"),
    ("[network]", "[network]\ncoupling.tanh = 0",
        "test.toml:23:17: `tanh` is 0, but must be positive", ""),
    ("[network]", "[[external_wrenches]]\non = [\"mass\", \"blind\"]\nby.body_torque_n_m = [1, 0, 0]\n[network]",
        "test.toml:24:22: `body_torque_n_m` does not act on `mass`", "what acts on it is `effort`"),
    ("edges.ring = {}", "edges = [[\"mass\", \"blind\"], [\"blind\", \"vehicles\"]]",
        "test.toml:23:39: there is no agent `vehicles`", "did you mean `vehicle`? the agents are `mass`, `blind`, `vehicle`"),
    ("[reference.consensus]\nroots_per_s = [1.0, 1.5, 2.0]\nexchange = \"position\"", "[leader]\nmotion.formulas = [0, 0, \"t\"]\n[reference.leader]\ndesign = \"continuous\"\nroots_per_s = [1]\ngain = 2",
        "test.toml:20:2: agent `blind`: the law without velocity does not go with these reference dynamics", "write `reference.consensus` with `exchange = \"position\"`"),
];

#[test]
fn mistakes_about_mixed_networks_are_reported_at_their_place() {
    refused(MIXED, MIXED_CASES);
}
