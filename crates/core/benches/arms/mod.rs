//! The arms of `validation/pinocchio/fixtures/arms.json` and motions for them.

use forwardstep_core::robot::tree::{Assembled, JointKind, LinkJoint, LinkSpec, Placement, Tree, TreeScratch};
use forwardstep_core::robot::{Called, Lagrangian, TwoVelocity};
use forwardstep_core::{Lanes, Scalar};
use serde::Deserialize;

#[derive(Deserialize)]
struct Fixture {
    models: Vec<Model>,
}

#[derive(Deserialize)]
struct Model {
    name: String,
    gravity: [f64; 3],
    links: Vec<Link>,
}

#[derive(Deserialize)]
struct Link {
    parent: Option<usize>,
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    kind: String,
    axis: [f64; 3],
    inertia: [f64; 10],
}

/// Name and model of the UR5e-like and the Panda-like arm.
pub(crate) fn arms() -> Vec<(String, Assembled)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/pinocchio/fixtures/arms.json");
    let text = std::fs::read_to_string(path).unwrap();
    let fixture: Fixture = serde_json::from_str(&text).unwrap();
    fixture
        .models
        .into_iter()
        .map(|model| {
            let links: Vec<LinkSpec> = model.links.iter().map(spec).collect();
            (model.name, Tree::assemble(&links, model.gravity).unwrap())
        })
        .collect()
}

fn spec(link: &Link) -> LinkSpec {
    let joint = match link.kind.as_str() {
        "fixed" => LinkJoint::Fixed,
        _ => LinkJoint::Moving { kind: JointKind::Revolute, axis: link.axis, damping: 0.0 },
    };
    let x_parent_joint = Placement { rotation: link.rotation, translation: link.translation };
    LinkSpec { parent: link.parent, x_parent_joint, joint, inertia: link.inertia }
}

/// Everything one Slotine–Li step reads and writes, for one robot or for several in lanes.
pub(crate) struct Step<S> {
    tree: Tree,
    scratch: TreeScratch<S>,
    states: Vec<[Vec<S>; 5]>,
    theta: Vec<S>,
    y_theta: Vec<S>,
    yt_s: Vec<S>,
    next: usize,
}

/// How many different motions are walked through, so that no branch or value is learnt by heart.
const STATES: usize = 64;

impl<S: Scalar> Step<S> {
    pub(crate) fn new(assembled: &Assembled, splat: impl Fn(&mut dyn FnMut() -> f64) -> S) -> Self {
        let tree = assembled.tree.clone();
        let n = tree.joint_count();
        let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut column = || (0..n).map(|_| splat(&mut random)).collect::<Vec<S>>();
        let states = (0..STATES).map(|_| [column(), column(), column(), column(), column()]).collect();
        Step {
            scratch: tree.scratch(),
            states,
            theta: assembled.theta.iter().map(|x| S::splat(*x)).collect(),
            y_theta: vec![S::ZERO; n],
            yt_s: vec![S::ZERO; tree.theta_len()],
            next: 0,
            tree,
        }
    }

    /// Yϑ and Yᵀs of the next motion.
    pub(crate) fn slotine_li(&mut self) -> S {
        self.next = (self.next + 1) % STATES;
        let [q, dq, z, dz, s] = &self.states[self.next];
        let motion = TwoVelocity { q, dq, z, dz };
        let Step { tree, scratch, theta, y_theta, yt_s, .. } = self;
        Called(tree).regressor_products(scratch, motion, theta, s, y_theta, yt_s).unwrap();
        y_theta[0]
    }

    /// Forward dynamics of the next motion.
    pub(crate) fn acceleration(&mut self) -> S {
        self.next = (self.next + 1) % STATES;
        let [q, dq, tau, ..] = &self.states[self.next];
        let Step { tree, scratch, theta, y_theta: ddq, .. } = self;
        Called(tree).forward_dynamics(scratch, q, dq, theta, tau, ddq).unwrap();
        ddq[0]
    }
}

pub(crate) fn one(assembled: &Assembled) -> Step<f64> {
    Step::new(assembled, |random| random())
}

pub(crate) fn lanes<const N: usize>(assembled: &Assembled) -> Step<Lanes<N>> {
    Step::new(assembled, |random| Lanes(std::array::from_fn(|_| random())))
}
