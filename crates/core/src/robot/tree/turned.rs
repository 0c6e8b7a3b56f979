//! The orientation of the end of a chain as a quaternion that is continuous in the joint positions.
//!
//! A joint at q about the inner +z turns by the quaternion (0, 0, sin(q/2), cos(q/2)), which is continuous in q ∈ ℝ where the
//! quaternion of a rotation matrix is not: that has to choose between q and −q. Between two joints stand rotations that do not
//! depend on q. The product of all is therefore continuous along every motion, through any number of turns.

use alloc::vec::Vec;

use super::JointKind;
use super::model::Tree;
use super::placement::rows;
use super::spatial::{Mat3, Vec3};
use crate::attitude::{Quaternion, from_matrix, normalized, product};
use crate::expression::Interval;
use crate::{Scalar, trig};

/// Rotations that do not depend on the joints are products of a few rotations by angles of a file; no entry is rounded by more.
const ROOM: f64 = 1e-12;

/// The turns of a chain that do not depend on the joints.
#[derive(Clone, Debug)]
pub(super) struct Turned {
    /// From each inner frame, its joint at zero, to the one before it.
    seats: Vec<Quaternion>,
    /// From the link to the last inner frame.
    tool: Quaternion,
    /// The same as a matrix, row by row.
    tool_rows: [[f64; 3]; 3],
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
        let tool_rows = core::array::from_fn(|row| inner.map(|column| column[row]));
        Turned {
            seats: tree.bodies.iter().map(|body| from_matrix(&body.rotation)).collect(),
            tool: from_matrix(&tool_rows),
            tool_rows,
        }
    }

    /// The rotation matrix of the link in the base, row by row, by intervals that hold that of the angles as they are written.
    pub(super) fn enclosed(&self, tree: &Tree, q: &[f64]) -> [[Interval; 3]; 3] {
        let one = Interval::point(1.0);
        let none = Interval::point(0.0);
        let mut whole = Mat3::<Interval>::splat(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        for (body, q) in tree.bodies.iter().zip(q) {
            whole = whole.product(&with_room(&body.rotation));
            if body.kind == JointKind::Revolute {
                let (sin, cos) = Scalar::sin_cos(Interval::point(body.sign * q));
                whole = whole.product(&Mat3 {
                    x: Vec3 { x: cos, y: sin, z: none },
                    y: Vec3 { x: -sin, y: cos, z: none },
                    z: Vec3 { x: none, y: none, z: one },
                });
            }
        }
        rows(&whole.product(&with_room(&self.tool_rows)))
    }

    /// The quaternion of the link in the base.
    pub(super) fn attitude(&self, tree: &Tree, q: &[f64]) -> Quaternion {
        let mut attitude = crate::attitude::IDENTITY;
        for ((body, seat), q) in tree.bodies.iter().zip(&self.seats).zip(q) {
            attitude = product(attitude, *seat);
            if body.kind == JointKind::Revolute {
                let (sin, cos) = trig::sine_and_cosine(0.5 * q);
                attitude = product(attitude, [0.0, 0.0, body.sign * sin, cos]);
            }
        }
        let attitude = product(attitude, self.tool);
        // What is not a number stays so: it must not pass for no turn at all.
        if attitude.iter().all(|x| x.is_finite()) { normalized(attitude) } else { attitude }
    }
}

/// A rotation as computed, with room for what was rounded; ones and zeros that are exact stay so, where all entries are.
fn with_room(rotation: &[[f64; 3]; 3]) -> Mat3<Interval> {
    let e = Mat3::<Interval>::splat(rotation);
    if rotation.iter().flatten().all(|entry| *entry == 0.0 || *entry == 1.0 || *entry == -1.0) {
        return e;
    }
    let wide = |v: Vec3<Interval>| Vec3 { x: v.x.with_room(ROOM), y: v.y.with_room(ROOM), z: v.z.with_room(ROOM) };
    Mat3 { x: wide(e.x), y: wide(e.y), z: wide(e.z) }
}
