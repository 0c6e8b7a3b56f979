//! Robots of a population with a spread differ, reproducibly, and are robots still.

use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Lagrangian, PlanarArm, PlanarLinks};
use forwardstep_io::SourceText;
use forwardstep_io::scenario::read_scenario;
use forwardstep_sim::{AgentSetup, RobotSetup};

use super::read;

const SEEDS: u64 = 20;

/// A population with this robot and this spread.
fn population(count: usize, robot: &str, spread: &str) -> String {
    format!(
        "format = 2\ntime = {{ end_s = 1 }}\n[[agents]]\nname = \"a\"\ncount = {count}\n{robot}\n{spread}\n\
         [reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"\n[network]\nedges.path = {{}}\n"
    )
}

fn agents(count: usize, robot: &str, seed: u64) -> Vec<AgentSetup> {
    let text = population(count, robot, &format!("parameter_variation = {{ seed = {seed}, relative = 0.2 }}"));
    read(&text).unwrap_or_else(|error| panic!("{error}")).setup.agents
}

fn thetas(agents: &[AgentSetup]) -> Vec<Vec<f64>> {
    agents.iter().map(|agent| agent.robot.theta.clone()).collect()
}

const ROBOTS: [&str; 4] = [
    "robot.point_mass = { dimension = 2, mass_kg = 3 }",
    "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }",
    "robot.planar_arm = { mass_kg = [2, 1], length_m = [1, 2], com_m = [0.3, 0.9], inertia_kg_m2 = [0, 0.2] }",
    "robot.urdf.file = \"panda.urdf\"",
];

#[test]
fn spreads_repeat_and_stay_when_agents_are_added() {
    for robot in ROBOTS {
        let few = thetas(&agents(3, robot, 7));
        assert_eq!(few, thetas(&agents(3, robot, 7)));
        assert_eq!(few[..], thetas(&agents(9, robot, 7))[..3]);
        assert_ne!(few, thetas(&agents(3, robot, 8)));
        assert!(few[0] != few[1] && few[1] != few[2], "{robot}: each its own");
    }
}

#[test]
fn no_spread_is_what_is_written() {
    for robot in ROBOTS {
        let plain = read(&population(2, robot, "")).unwrap().setup.agents;
        let none =
            read(&population(2, robot, "parameter_variation = { seed = 1, relative = 0 }")).unwrap().setup.agents;
        assert_eq!(thetas(&plain), thetas(&none), "{robot}");
    }
}

#[test]
fn point_masses_are_spread_uniformly() {
    let masses: Vec<f64> = thetas(&agents(2000, ROBOTS[0], 3)).concat();
    assert!(masses.iter().all(|mass| (2.4..=3.6).contains(mass)));
    let count = |low: f64| masses.iter().filter(|mass| (low..low + 0.3).contains(*mass)).count();
    // 500 ± 19 in each quarter.
    assert!([2.4, 2.7, 3.0, 3.3].into_iter().all(|low| count(low).abs_diff(500) < 100));
}

#[test]
fn planar_arms_stay_similar_link_by_link() {
    // ϑ₃/ϑ₂ = l₁ l_c₂ m₂ / (I₂ + m₂ l_c₂²) is 3 l₁ / (2 l₂) for rods, whatever they weigh, and ϑ₃/ϑ₅ = l₁/g.
    for seed in 0..SEEDS {
        for agent in agents(20, ROBOTS[1], seed) {
            let theta: [f64; 5] = agent.robot.theta.try_into().unwrap();
            let l1 = 9.81 * theta[2] / theta[4];
            let l2 = 1.5 * l1 * theta[1] / theta[2];
            let m2 = 3.0 * theta[1] / (l2 * l2);
            let m1 = (theta[0] - theta[1] - m2 * l1 * l1) * 3.0 / (l1 * l1);
            for (value, nominal) in [(l1, 1.0), (l2, 0.8), (m1, 2.0), (m2, 1.5)] {
                assert!((value / nominal - 1.0).abs() <= 0.2 + 1e-9, "{value} of {nominal}");
            }
            let again = PlanarLinks::uniform([m1, m2], [l1, l2]).theta();
            assert!(theta.iter().zip(again).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{theta:?} {again:?}");
        }
    }
}

/// Whether a symmetric matrix is positive definite.
fn positive_definite(n: usize, mut m: Vec<f64>) -> bool {
    for k in 0..n {
        if m[k * n + k] <= 0.0 {
            return false;
        }
        for i in k + 1..n {
            let factor = m[i * n + k] / m[k * n + k];
            for j in k..n {
                m[i * n + j] -= factor * m[k * n + j];
            }
        }
    }
    true
}

#[test]
fn mass_matrices_stay_positive_definite() {
    for seed in 0..SEEDS {
        for robot in &ROBOTS[1..] {
            for agent in agents(4, robot, seed) {
                let theta = &agent.robot.theta;
                let n = agent.robot.axes.len();
                for step in 0..8 {
                    let q: Vec<f64> = (0..n).map(|axis| f64::from(step) * (0.4 + 0.3 * axis as f64)).collect();
                    let mut m = vec![0.0; n * n];
                    match agent.robot.kind.downcast::<Arc<Tree>>() {
                        Some(tree) => tree.mass_matrix(&mut tree.scratch::<f64>(), &q, theta, &mut m).unwrap(),
                        None => PlanarArm.mass_matrix(&mut (), &q, theta, &mut m).unwrap(),
                    }
                    assert!(positive_definite(n, m), "{} with seed {seed}", agent.name);
                }
            }
        }
    }
}

#[test]
fn bodies_of_a_urdf_scale_as_a_whole_and_dampings_stay() {
    let plain = read(&population(1, ROBOTS[3], "")).unwrap().setup.agents.remove(0).robot;
    for agent in agents(5, ROBOTS[3], 11) {
        let (bodies, dampings) = agent.robot.theta.split_at(10 * plain.axes.len());
        assert_eq!(dampings, &plain.theta[bodies.len()..]);
        let mut factors = Vec::new();
        for (body, nominal) in bodies.chunks_exact(10).zip(plain.theta.chunks_exact(10)) {
            let factor = body[0] / nominal[0];
            assert!((0.8..=1.2).contains(&factor));
            assert!(body.iter().zip(nominal).all(|(a, b)| (a - factor * b).abs() <= 1e-12 * b.abs()));
            factors.push(factor);
        }
        factors.dedup();
        assert_eq!(factors.len(), plain.axes.len(), "each body has its own factor");
        let joints = |robot: &RobotSetup| robot.kind.downcast::<Arc<Tree>>().unwrap().joint_count();
        assert_eq!(joints(&agent.robot), joints(&plain));
    }
}

/// Two links that turn about parallel axes; the first has an inertia that no body has.
const UNSOUND: &str = r#"<robot name="unsound">
  <link name="base"/>
  <link name="upper"><inertial><mass value="0"/>
    <inertia ixx="0" iyy="0" izz="-0.9" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="fore"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/></joint>
</robot>"#;

#[test]
fn a_robot_that_its_spread_makes_impossible_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("unsound.urdf"), UNSOUND).unwrap();
    let message = |relative: f64| {
        let spread = format!("parameter_variation = {{ seed = 1, relative = {relative} }}");
        let text = population(50, "robot.urdf.file = \"unsound.urdf\"", &spread);
        read_scenario("test", &SourceText::new("test.toml", text), Some(folder.path()))
            .map_err(|error| error.to_string())
    };
    assert!(message(0.01).is_ok());
    let error = message(0.8).unwrap_err();
    let (before, after) = ("test.toml:7:23: with this spread the mass matrix of `a-", "` is not positive definite");
    assert!(error.starts_with(before) && error.ends_with(after), "{error}");
}
