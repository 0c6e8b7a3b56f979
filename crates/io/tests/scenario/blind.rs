//! A mass without velocity: every mistake in a scenario, where it is reported and what is said.

use forwardstep_sim::ModelReferenceLaw;

use super::{Case, refused};

/// Two masses whose velocities nobody measures.
pub(super) const BLIND: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "mass"
count = 2
robot.point_mass = { dimension = 2, mass_kg = 2.0 }
start = { position_m = [[1, 0], [0, 1]], velocity_m_s = [0.1, 0] }

[reference.consensus]
roots_per_s = [1.0, 1.5]
exchange = "position"

[law.position_only]
damping = 20
filter_per_s = 15
adaptation_gain = 5
estimate_start_kg = 1

[network]
edges.ring = {}

[goal]
disagreement_below = 1e-3
"#;

#[rustfmt::skip]
const BLIND_CASES: &[Case] = &[
    ("[law.position_only]", "[law.position_olny]",
        "test.toml:14:6: unknown choice `position_olny`", "did you mean `position_only`? choose one of `adaptive`, `known`, `position_only`, `model_reference`, `thrust`, `task_space`, `attitude`, `passivity_filter`, `linearising`, `linear_adaptive`, `immersion`, `adaptive_backstepping`"),
    ("damping = 20", "damping = -20",
        "test.toml:15:11: `damping` is -20, but must be positive", ""),
    ("damping = 20", "damping = [20, 20]",
        "test.toml:15:11: found a list where a number should stand", ""),
    ("damping = 20", "damping = inf",
        "test.toml:15:11: inf is not a finite number", ""),
    ("filter_per_s = 15", "filter_per_s = 0",
        "test.toml:16:16: `filter_per_s` is 0, but must be positive", ""),
    ("filter_per_s = 15", "filter_s = 15",
        "test.toml:16:1: unknown key `filter_s`", "did you mean `filter_per_s`? allowed here: `damping`, `filter_per_s`, `adaptation_gain`, `estimate_start_kg`, `bounds`"),
    ("filter_per_s = 15", "filter_per_s = \"fast\"",
        "test.toml:16:16: found \"fast\" where a number should stand", ""),
    ("adaptation_gain = 5", "adaptation_gain = -5",
        "test.toml:17:19: `adaptation_gain` is -5, but must not be negative", ""),
    ("adaptation_gain = 5", "adaptation_gain = { bandwidth_per_s = 5 }",
        "test.toml:17:19: found a table where a number should stand", ""),
    ("adaptation_gain = 5", "adaption_gain = 5",
        "test.toml:17:1: unknown key `adaption_gain`", "did you mean `adaptation_gain`? allowed here: `damping`, `filter_per_s`, `adaptation_gain`, `estimate_start_kg`, `bounds`"),
    ("estimate_start_kg = 1", "estimate_start_kg = nan",
        "test.toml:18:21: nan is not a finite number", ""),
    ("estimate_start_kg = 1", "estimate_start = \"zero\"",
        "test.toml:18:1: unknown key `estimate_start`", "did you mean `estimate_start_kg`? allowed here: `damping`, `filter_per_s`, `adaptation_gain`, `estimate_start_kg`, `bounds`"),
    ("[1.0, 1.5]", "[1.0]",
        "test.toml:11:15: agent `mass-1`: its reference dynamics have order 1, but its law needs 2 roots or more", "give it 2 roots or more"),
    ("[1.0, 1.5]", "[1.0, inf]",
        "test.toml:11:21: inf is not a finite number", ""),
    ("exchange = \"position\"", "exchange = \"position_velocity\"",
        "test.toml:12:12: agent `mass-1`: the law without velocity sends its position only, but the agents exchange positions and velocities", "write `exchange = \"position\"`"),
    ("exchange = \"position\"", "exchange = \"velocity\"",
        "test.toml:12:12: unknown choice `velocity`", "choose one of `position_velocity`, `position`"),
    ("[reference.consensus]\nroots_per_s = [1.0, 1.5]", "[reference.pure_integral]\nroots_per_s = [1.0, 1.5]",
        "test.toml:10:2: agent `mass-1`: the law without velocity does not go with these reference dynamics", "write `reference.consensus` with `exchange = \"position\"`"),
    ("[network]", "[[external_wrenches]]\non = [\"mass-2\"]\nby.body_torque_n_m = [1, 0, 0]\n[network]",
        "test.toml:22:22: `body_torque_n_m` does not act on `mass-2`", "what acts on it is `effort`, `force_n` or `torque_n_m`, and `virtual_spring_on_axes`"),
    ("count = 2", "count = 2\ntarget.formulas = [0, 1]",
        "test.toml:7:1: agent `mass-1`: the law without velocity knows no offsets", "leave its `target` out; only vehicles and rotorcraft agree up to offsets"),
    ("count = 2", "count = 2\nenforce_limits = true",
        "test.toml:7:18: `enforce_limits` is true, but axis `x` of `mass-1` has no effort limit", "only a URDF states limits, as <limit effort=\"…\"> of a joint"),
    ("velocity_m_s = [0.1, 0] ", "attitude = [0, 0, 0, 1] ",
        "test.toml:8:53: `attitude` says nothing about `mass-1`", "vehicles, rotorcraft and spacecraft have an attitude"),
    ("velocity_m_s = [0.1, 0] ", "velocity_m_s = [0.1] ",
        "test.toml:8:57: `velocity_m_s` has 1 entry, but `mass-1` needs 2", ""),
    ("[network]", "[control]\nsample_hz = 100\ntorque_limit = [1, 1, 1]\n[network]",
        "test.toml:22:16: agent `mass-1`: the limit of torques has 3 entries where 2 are needed", "a single number stands for all axes"),
    ("[network]", "[control]\nsample_hz = 0\n[network]",
        "test.toml:21:13: `sample_hz` is 0, but must be positive", ""),
];

#[test]
fn mistakes_about_masses_without_velocity_are_reported_at_their_place() {
    refused(BLIND, BLIND_CASES);
}

/// A mass whose velocity nobody measures behind a target, by a model.
pub(super) const BY_MODEL: &str = r#"format = 2
time = { end_s = 10 }

[[agents]]
name = "mass"
robot.point_mass = { dimension = 1, mass_kg = 2.0 }
target.formulas = ["sin(t)"]

[reference.tracking]
roots_per_s = [1.0, 1.5]

[law.model_reference]
filter_per_s = 15
adaptation_gain = 5
estimate_start_kg = 1
"#;

#[rustfmt::skip]
const MODEL_CASES: &[Case] = &[
    ("[law.model_reference]", "[law.model_refrence]",
        "test.toml:12:6: unknown choice `model_refrence`", "did you mean `model_reference`?"),
    ("filter_per_s = 15", "filter_per_s = 0",
        "test.toml:13:16: `filter_per_s` is 0, but must be positive", ""),
    ("filter_per_s = 15", "damping = 15",
        "test.toml:13:1: unknown key `damping`", "allowed here: `filter_per_s`, `adaptation_gain`, `estimate_start_kg`"),
    ("adaptation_gain = 5", "adaptation_gain = -5",
        "test.toml:14:19: `adaptation_gain` is -5, but must not be negative", ""),
    ("estimate_start_kg = 1", "estimate_start_kg = nan",
        "test.toml:15:21: nan is not a finite number", ""),
    ("[1.0, 1.5]", "[1.0, 1.5, 2.0]",
        "test.toml:10:15: agent `mass`: the list of roots has 3 entries where 2 are needed", "give it 2 roots"),
    ("mass_kg = 2.0 }", "mass_kg = 2.0, damping = 1 }",
        "test.toml:12:2: agent `mass`: the law `model_reference` is made for point masses without damping and friction, of which it knows no velocity to compensate them at", "for this robot there is `adaptive` and `known`"),
    ("target.formulas = [\"sin(t)\"]\n\n[reference.tracking]", "\n[network]\nedges = []\n[reference.consensus]\nexchange = \"position\"",
        "test.toml:10:2: agent `mass`: the law by a model follows a target of its own; it does not agree with others", "write `reference.tracking`"),
];

#[test]
fn mistakes_about_masses_by_a_model_are_reported_at_their_place() {
    refused(BY_MODEL, MODEL_CASES);
}

#[test]
fn what_is_not_written_of_a_law_by_a_model_is_as_its_keys_say() {
    let law = |text: &str| *super::read(text).unwrap().setup.agents[0].law.downcast::<ModelReferenceLaw>().unwrap();
    assert_eq!(law(BY_MODEL), ModelReferenceLaw { filter_per_s: 15.0, adaptation: 5.0, estimate_start: 1.0 });
    let bare = BY_MODEL.split("filter_per_s").next().unwrap();
    assert_eq!(law(bare), ModelReferenceLaw { filter_per_s: 10.0, adaptation: 10.0, estimate_start: 0.0 });
}
