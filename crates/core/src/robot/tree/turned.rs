//! The orientation of the end of a chain as a quaternion that is continuous in the joint positions.
//!
//! A joint at q about the inner +z turns by the quaternion (0, 0, sin(q/2), cos(q/2)), which is continuous in q ∈ ℝ where the
//! quaternion of a rotation matrix is not: that has to choose between q and −q. Between two joints stand rotations that do not
//! depend on q. The product of all is therefore continuous along every motion, through any number of turns.

use alloc::vec::Vec;

use super::JointKind;
use super::model::Tree;
use super::spatial::Vec3;
use crate::attitude::{Quaternion, from_matrix, normalized, product};
use crate::trig;

/// The turns of a chain that do not depend on the joints.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    /// From each inner frame, its joint at zero, to the one before it.
    seats: Vec<Quaternion>,
    /// From the link to the last inner frame.
    tool: Quaternion,
}

impl Turned {
    /// Of a chain and the orientation of the link in the joint frame of its last body.
    pub(super) fn of(tree: &Tree, link: &[[f64; 3]; 3]) -> Self {
        let columns: [[f64; 3]; 3] = core::array::from_fn(|k| link.map(|row| row[k]));
        let inner = columns.map(|column| {
            let column = Vec3::splat(column);
            let held = tree.bodies.last().map_or(column, |body| body.inner_vector(column));
            [held.x, held.y, held.z]
        });
        Turned {
            seats: tree.bodies.iter().map(|body| from_matrix(&body.rotation)).collect(),
            tool: from_matrix(&core::array::from_fn(|row| inner.map(|column| column[row]))),
        }
    }

    /// The quaternion of the link in the base.
    pub(super) fn attitude(&self, tree: &Tree, q: &[f64]) -> Quaternion {
        let mut attitude = crate::attitude::IDENTITY;
        for ((body, seat), q) in tree.bodies.iter().zip(&self.seats).zip(q) {
            attitude = product(attitude, *seat);
            if body.kind == JointKind::Revolute {
                let (sin, cos) = trig::sin_cos(0.5 * q);
                attitude = product(attitude, [0.0, 0.0, body.sign * sin, cos]);
            }
        }
        let attitude = product(attitude, self.tool);
        // What is not a number stays so: it must not pass for no turn at all.
        if attitude.iter().all(|x| x.is_finite()) { normalized(attitude) } else { attitude }
    }
}
