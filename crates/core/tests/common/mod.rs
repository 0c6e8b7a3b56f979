//! Models and states that Pinocchio has computed, and plain linear algebra to compare with.
#![allow(dead_code, clippy::unwrap_used)] // Every test binary uses its own part; a broken fixture should stop a test.

pub(crate) mod dual;
pub(crate) mod looped;
pub(crate) mod random;

use forwardstep_core::robot::tree::{Assembled, JointKind, LinkJoint, LinkSpec, Placement, Tree};
use serde::Deserialize;

#[derive(Deserialize)]
pub(crate) struct Fixture {
    pub(crate) models: Vec<Model>,
}

#[derive(Deserialize)]
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) gravity: [f64; 3],
    pub(crate) links: Vec<Link>,
    pub(crate) theta: Vec<f64>,
    pub(crate) states: Vec<State>,
}

#[derive(Deserialize)]
pub(crate) struct Link {
    pub(crate) parent: Option<usize>,
    pub(crate) rotation: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
    pub(crate) kind: String,
    pub(crate) axis: [f64; 3],
    pub(crate) inertia: [f64; 10],
}

#[derive(Deserialize)]
pub(crate) struct State {
    pub(crate) q: Vec<f64>,
    pub(crate) dq: Vec<f64>,
    pub(crate) z: Vec<f64>,
    pub(crate) dz: Vec<f64>,
    pub(crate) tau: Vec<f64>,
    pub(crate) mass_matrix: Vec<f64>,
    pub(crate) coriolis_matrix: Vec<f64>,
    pub(crate) gravity: Vec<f64>,
    pub(crate) rnea: Vec<f64>,
    pub(crate) two_velocity: Vec<f64>,
    pub(crate) aba: Vec<f64>,
    pub(crate) regressor: Option<Vec<f64>>,
}

/// All models of both fixture files.
pub(crate) fn models() -> Vec<Model> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/pinocchio/fixtures/");
    ["arms.json", "trees.json"]
        .into_iter()
        .flat_map(|file| {
            let text = std::fs::read_to_string(format!("{folder}{file}")).unwrap();
            serde_json::from_str::<Fixture>(&text).unwrap().models
        })
        .collect()
}

pub(crate) fn model(name: &str) -> Model {
    models().into_iter().find(|model| model.name == name).unwrap()
}

impl Model {
    pub(crate) fn links(&self) -> Vec<LinkSpec> {
        self.links
            .iter()
            .map(|link| {
                let kind = match link.kind.as_str() {
                    "revolute" => Some(JointKind::Revolute),
                    "prismatic" => Some(JointKind::Prismatic),
                    _ => None,
                };
                LinkSpec {
                    parent: link.parent,
                    x_parent_joint: Placement { rotation: link.rotation, translation: link.translation },
                    joint: match kind {
                        Some(kind) => LinkJoint::Moving { kind, axis: link.axis, damping: 0.0 },
                        None => LinkJoint::Fixed,
                    },
                    inertia: link.inertia,
                }
            })
            .collect()
    }

    pub(crate) fn assemble(&self) -> Assembled {
        Tree::assemble(&self.links(), self.gravity).unwrap()
    }
}

/// The largest difference, relative to the largest entry of `want` (at least 1).
pub(crate) fn error(got: &[f64], want: &[f64]) -> f64 {
    assert_eq!(got.len(), want.len());
    let scale = want.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
    got.iter().zip(want).fold(0.0_f64, |worst, (got, want)| {
        let error = (got - want).abs() / scale;
        if error.is_nan() { f64::INFINITY } else { worst.max(error) }
    })
}

/// a · x, a row by row.
pub(crate) fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
    a.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
}

/// aᵀ · x, a row by row.
pub(crate) fn transpose_times(a: &[f64], x: &[f64]) -> Vec<f64> {
    let width = a.len() / x.len();
    (0..width).map(|column| x.iter().enumerate().map(|(row, x)| a[row * width + column] * x).sum()).collect()
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
