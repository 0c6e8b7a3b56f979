//! Scenario files: what is read, and what every mistake gets.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod control;
mod edges;
mod leader;
mod links;
mod malformed;
mod meaning;
mod mutated;
mod pushes;
#[path = "../support/seeds.rs"]
mod seeds;
mod shipped;
mod spread;
mod tracking;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};

/// A small scenario without mistakes, which the tests change.
const SOUND: &str = r#"format = 1
title = "test"

[time]
end_s = 10
record_every_s = 0.1

[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]

[[agents]]
name = "cart"
robot.point_mass = { dimension = 2, mass_kg = 4.0 }

[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"

[law.adaptive]
damping.gain = 8
adaptation_gain = 10
estimate_start = "zero"

[network]
weight = 1.0
delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }
[[network.phases]]
dwell_s = 1.0
edges = [["arm-1", "arm-2"]]
[[network.phases]]
dwell_s = 2.0
edges = [["arm-2", "cart"], ["cart", "arm-1"]]

[goal]
disagreement_below = 1e-3
"#;

/// [`SOUND`] with one passage replaced.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(SOUND.matches(from).count(), 1, "{from:?} must occur once");
    SOUND.replace(from, to)
}

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    seeds::keep("scenario", text);
    read_scenario("test", &SourceText::new("test.toml", text), None)
}
