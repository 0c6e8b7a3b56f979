//! Which way the revolute joints turn that carry a body: whether lengths and extensions behind them change an inertia.
//!
//! # Whether C and g are bounded
//!
//! M, C and g of a tree depend on the angle of a revolute joint by sines and cosines alone. The extension q_k of a prismatic joint
//! along a shifts all that is behind it by a q_k. Let the revolute joints that carry it turn about axes that are all parallel to a: they
//! are then parallel to each other at every posture, so that the body which holds the joint has an angular velocity ω parallel to a,
//! and ω × a q_k = 0. No velocity depends on q_k, so neither does M, and with it C. The height of what is behind grows by
//! −g·a q_k, but a keeps its direction, so only its own joint and not those that carry it feel that, by a constant force.
//! All is as with q_k = 0, and bounded. Where no revolute joint carries it, ω = 0 and the same is true.
//!
//! Otherwise ω × a is not zero for some posture, and what has mass behind the joint moves as fast as q_k is large: M and C are not
//! bounded, and nor is g in general.

use alloc::vec::Vec;

use super::JointKind;
use super::model::{Body, Tree};
use super::spatial::{Mat3, Vec3};

impl Tree {
    /// The prismatic joints whose extension changes M, C or g: those that a revolute joint carries about another direction than
    /// theirs. Without any, C(q, q̇)/|q̇| and g(q) are bounded independent of q, by the derivation at the head of this file.
    pub fn swung_joints(&self) -> Vec<usize> {
        let mut carried: Vec<Axes> = Vec::with_capacity(self.bodies.len());
        let mut swung = Vec::new();
        for (joint, body) in self.bodies.iter().enumerate() {
            let before = body.parent_slot.checked_sub(1).and_then(|parent| carried.get(parent));
            let axes = before.copied().unwrap_or(Axes::Nothing).carried_by(body);
            let slides = body.kind == JointKind::Prismatic;
            if slides && axes.turn(Vec3::new(0.0, 0.0, 1.0)) {
                swung.push(joint);
            }
            carried.push(axes);
        }
        swung
    }
}

/// The axes of revolute joints from the base up to a body, in the inner frame
/// of that body.
#[derive(Clone, Copy)]
pub(super) enum Axes {
    /// There are none.
    Nothing,
    /// All have this direction, of length one.
    One(Vec3<f64>),
    /// Two differ.
    Several,
}

impl Axes {
    /// The axes up to the next body, which is `body`.
    pub(super) fn carried_by(self, body: &Body) -> Self {
        let z = Vec3::new(0.0, 0.0, 1.0);
        // The joint turns the frame about z, which leaves what is parallel to z and changes all else.
        let (before, turns) = (Mat3::splat(&body.rotation), body.kind == JointKind::Revolute);
        match (self, turns) {
            (Axes::Nothing, true) => Axes::One(z),
            (Axes::Nothing, false) => Axes::Nothing,
            (Axes::One(axis), true) if apart(before.transpose_times(axis), z) => Axes::Several,
            (Axes::One(_), true) => Axes::One(z),
            (Axes::One(axis), false) => Axes::One(before.transpose_times(axis)),
            (Axes::Several, _) => Axes::Several,
        }
    }

    /// Whether a vector of the body's is turned by one of them at least.
    pub(super) fn turn(self, vector: Vec3<f64>) -> bool {
        match self {
            Axes::Nothing => false,
            Axes::One(axis) => apart(vector, axis),
            Axes::Several => true,
        }
    }
}

/// Directions that differ by less than this, rad, do so by the rounding of placements alone.
const PARALLEL: f64 = 1e-12;

/// Whether two vectors of length one have different directions, opposite ones not counted.
fn apart(a: Vec3<f64>, b: Vec3<f64>) -> bool {
    let cross = a.cross(b);
    cross.dot(cross) > PARALLEL * PARALLEL
}
