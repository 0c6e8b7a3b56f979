//! The kernels of a tree against Pinocchio; `validation/pinocchio/` says how the fixtures came about.

use crate::common::{dot, error, model, models, times, transpose_times};
use forwardstep_core::robot::tree::{Axes, LinkPoint, PointWrench};
use forwardstep_core::robot::{Called, Lagrangian, TwoVelocity};

const TOLERANCE: f64 = 1.0e-11;

#[test]
fn val_pinocchio_lumped_inertias() {
    for model in models() {
        let assembled = model.assemble();
        assert!(error(&assembled.theta, &model.theta) < 1.0e-14, "{}", model.name);
    }
}

#[test]
fn val_pinocchio_matrices() {
    for model in models() {
        let assembled = model.assemble();
        let (tree, theta) = (&assembled.tree, &assembled.theta);
        let n = tree.joint_count();
        let mut scratch = tree.scratch::<f64>();
        for state in &model.states {
            let mut out = vec![0.0; n * n];
            tree.mass_matrix(&mut scratch, &state.q, theta, &mut out).unwrap();
            assert!(error(&out, &state.mass_matrix) < TOLERANCE, "M of {}", model.name);
            tree.coriolis_matrix(&mut scratch, &state.q, &state.dq, theta, &mut out).unwrap();
            assert!(error(&out, &state.coriolis_matrix) < TOLERANCE, "C of {}", model.name);
            tree.gravity(&mut scratch, &state.q, theta, &mut out[..n]).unwrap();
            assert!(error(&out[..n], &state.gravity) < TOLERANCE, "g of {}", model.name);
        }
    }
}

#[test]
fn val_pinocchio_torque_and_gradient() {
    for model in models() {
        let assembled = model.assemble();
        let (tree, theta) = (&assembled.tree, &assembled.theta);
        let mut scratch = tree.scratch::<f64>();
        let (mut tau, mut yt_s) = (vec![0.0; tree.joint_count()], vec![0.0; theta.len()]);
        for state in &model.states {
            let one = TwoVelocity { q: &state.q, dq: &state.dq, z: &state.dq, dz: &state.dz };
            let two = TwoVelocity { z: &state.z, ..one };
            Called(tree).regressor_products(&mut scratch, one, theta, &state.tau, &mut tau, &mut yt_s).unwrap();
            assert!(error(&tau, &state.rnea) < TOLERANCE, "rnea of {}", model.name);
            Called(tree).regressor_products(&mut scratch, two, theta, &state.tau, &mut tau, &mut yt_s).unwrap();
            assert!(error(&tau, &state.two_velocity) < TOLERANCE, "two-velocity torque of {}", model.name);
            if let Some(regressor) = &state.regressor {
                assert!(error(&yt_s, &transpose_times(regressor, &state.tau)) < TOLERANCE, "Yᵀs of {}", model.name);
                let mut y = vec![0.0; regressor.len()];
                tree.regressor(&mut scratch, two, &mut y).unwrap();
                assert!(error(&y, regressor) < TOLERANCE, "Y of {}", model.name);
            }
            // Where no regressor is stored: sᵀ(Yϑ) = ϑᵀ(Yᵀs).
            let (left, right) = (dot(&state.tau, &tau), dot(theta, &yt_s));
            assert!((left - right).abs() < TOLERANCE * left.abs().max(1.0), "pairing of {}", model.name);
        }
    }
}

/// By its residual: τ − M q̈ − C q̇ − g with Pinocchio's own matrices, against Pinocchio's residual.
#[test]
fn val_pinocchio_forward_dynamics() {
    for model in models() {
        let assembled = model.assemble();
        let (tree, theta) = (&assembled.tree, &assembled.theta);
        let mut scratch = tree.scratch::<f64>();
        let mut ddq = vec![0.0; tree.joint_count()];
        for state in &model.states {
            Called(tree).forward_dynamics(&mut scratch, &state.q, &state.dq, theta, &state.tau, &mut ddq).unwrap();
            let torque = |ddq: &[f64]| {
                let (inertial, coriolis) = (times(&state.mass_matrix, ddq), times(&state.coriolis_matrix, &state.dq));
                let sum = inertial.iter().zip(&coriolis).zip(&state.gravity).map(|((m, c), g)| m + c + g);
                sum.collect::<Vec<_>>()
            };
            let (ours, theirs) = (error(&torque(&ddq), &state.tau), error(&torque(&state.aba), &state.tau));
            assert!(ours < TOLERANCE.max(3.0 * theirs), "{}: {ours:e}, Pinocchio {theirs:e}", model.name);
        }
    }
}

#[derive(serde::Deserialize)]
struct Pushes {
    cases: Vec<Push>,
}

#[derive(serde::Deserialize)]
struct Push {
    model: String,
    link: usize,
    axes: String,
    at: [f64; 3],
    force: [f64; 3],
    moment: [f64; 3],
    q: Vec<f64>,
    dq: Vec<f64>,
    tau: Vec<f64>,
    position: Vec<f64>,
    velocity: Vec<f64>,
}

#[test]
fn val_pinocchio_wrenches_and_points_of_links() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/pinocchio/fixtures/wrenches.json");
    let pushes: Pushes = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert!(pushes.cases.len() > 50);
    for push in &pushes.cases {
        let assembled = model(&push.model).assemble();
        let tree = &assembled.tree;
        let axes = if push.axes == "base" { Axes::Base } else { Axes::Link };
        let point = LinkPoint { link: assembled.anchors[push.link], at: push.at };
        let wrench = PointWrench { force: push.force, moment: push.moment, axes };
        let (mut scratch, mut tau) = (tree.scratch::<f64>(), vec![0.0; tree.joint_count()]);
        tree.add_wrench(&mut scratch, &push.q, &point, &wrench, &mut tau).unwrap();
        let what = format!("link {} of {}", push.link, push.model);
        assert!(error(&tau, &push.tau) < TOLERANCE, "Jᵀw at {what}: {:e}", error(&tau, &push.tau));
        let motion = tree.point_motion(&mut scratch, &push.q, &push.dq, &point).unwrap();
        assert!(error(&motion.position, &push.position) < TOLERANCE, "position of {what}");
        assert!(error(&motion.velocity, &push.velocity) < TOLERANCE, "velocity of {what}");
    }
}
