//! The same files read by Pinocchio: `validation/urdf/generate.py`.

use std::sync::Arc;

use forwardstep_core::robot::{Lagrangian, TwoVelocity};
use forwardstep_io::urdf::shipped_robot;
use forwardstep_io::{UrdfOptions, UrdfRobot};
use serde_json::Value;

use super::read_with;
use super::robots::TREE;

const TRUTH: &str = include_str!("../../../../validation/urdf/pinocchio.json");

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Calls `compare` with the robot and each state of each case.
fn for_every_state(mut compare: impl FnMut(&str, &UrdfRobot, &Value)) {
    let truth: Value = serde_json::from_str(TRUTH).unwrap();
    for case in truth["cases"].as_array().unwrap() {
        let name = case["robot"].as_str().unwrap();
        let text = shipped_robot(name).unwrap_or(TREE);
        let held = case["locked"].as_object().unwrap();
        let locked = held.iter().map(|(joint, value)| (joint.clone(), value.as_f64().unwrap())).collect();
        let robot = read_with(text, &UrdfOptions { locked, ..UrdfOptions::default() }).unwrap();
        let axes: Vec<&str> = robot.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        let joints: Vec<&str> =
            case["joints"].as_array().unwrap().iter().map(|joint| joint.as_str().unwrap()).collect();
        assert_eq!(axes, joints);
        for state in case["states"].as_array().unwrap() {
            compare(name, &robot, state);
        }
    }
}

/// Within 1e-11 of the largest entry.
fn assert_close(what: &str, ours: &[f64], theirs: &[f64]) {
    let size = theirs.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    assert_eq!(ours.len(), theirs.len());
    for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!((a - b).abs() <= 1e-11 * size, "{what}, entry {k}: {a} against {b}");
    }
}

fn tree(robot: &UrdfRobot) -> &forwardstep_core::robot::tree::Tree {
    robot.robot.kind.downcast::<Arc<_>>().unwrap()
}

#[test]
fn val_pinocchio_urdf_mass_matrix() {
    for_every_state(|name, robot, state| {
        let (tree, q, theirs) = (tree(robot), numbers(&state["q"]), numbers(&state["mass"]));
        let mut ours = vec![0.0; q.len() * q.len()];
        let mut scratch = Lagrangian::<f64>::scratch(tree);
        tree.mass_matrix(&mut scratch, &q, &robot.robot.theta, &mut ours).unwrap();
        assert_close(name, &ours, &theirs);
    });
}

#[test]
fn val_pinocchio_urdf_gravity() {
    for_every_state(|name, robot, state| {
        let (tree, q, theirs) = (tree(robot), numbers(&state["q"]), numbers(&state["gravity"]));
        let mut ours = vec![0.0; q.len()];
        let mut scratch = Lagrangian::<f64>::scratch(tree);
        tree.gravity(&mut scratch, &q, &robot.robot.theta, &mut ours).unwrap();
        assert_close(name, &ours, &theirs);
    });
}

#[test]
fn val_pinocchio_urdf_two_velocity_torque() {
    for_every_state(|name, robot, state| {
        let (tree, theta) = (tree(robot), &robot.robot.theta);
        let [q, dq, z, dz] = ["q", "dq", "z", "dz"].map(|key| numbers(&state[key]));
        let motion = TwoVelocity { q: &q, dq: &dq, z: &z, dz: &dz };
        let (mut ours, mut unused) = (vec![0.0; q.len()], vec![0.0; theta.len()]);
        let mut scratch = Lagrangian::<f64>::scratch(tree);
        tree.regressor_products(&mut scratch, motion, theta, &q, &mut ours, &mut unused).unwrap();
        assert_close(name, &ours, &numbers(&state["torque"]));
    });
}

#[test]
fn val_pinocchio_urdf_forward_dynamics() {
    for_every_state(|name, robot, state| {
        let tree = tree(robot);
        let [q, dq, tau] = ["q", "dq", "tau"].map(|key| numbers(&state[key]));
        let mut ours = vec![0.0; q.len()];
        let mut scratch = Lagrangian::<f64>::scratch(tree);
        tree.forward_dynamics(&mut scratch, &q, &dq, &robot.robot.theta, &tau, &mut ours).unwrap();
        assert_close(name, &ours, &numbers(&state["ddq"]));
    });
}
