//! Rigid placements: composing, inverting, and the motion of a joint.

use super::JointKind;
use super::spatial::{Inertia, Mat3, Vec3};
use crate::trig;

/// A rigid placement: the pose of a frame in another, `p_parent = rotation · p_child + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Row by row.
    pub rotation: [[f64; 3]; 3],
    /// In m.
    pub translation: [f64; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Placement::IDENTITY
    }
}

impl Placement {
    /// The frame itself.
    pub const IDENTITY: Placement =
        Placement { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// As a URDF `<origin xyz rpy>` states it: fixed-axis roll, pitch, yaw in rad, R = Rz(yaw) Ry(pitch) Rx(roll).
    pub fn from_xyz_rpy(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let ((sr, cr), (sp, cp), (sy, cy)) = (trig::sin_cos(roll), trig::sin_cos(pitch), trig::sin_cos(yaw));
        Placement {
            rotation: [
                [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr],
            ],
            translation: xyz,
        }
    }

    /// What a joint does at `value` (rad or m): a turn about, or a shift along, the unit `axis`.
    pub fn of_joint(kind: JointKind, axis: [f64; 3], value: f64) -> Self {
        let [x, y, z] = axis;
        match kind {
            JointKind::Prismatic => Placement { translation: [x * value, y * value, z * value], ..Placement::IDENTITY },
            JointKind::Revolute => {
                // Rodrigues: R = 1 + sin θ [a] + (1 − cos θ) [a]², and [a]² = a aᵀ − 1.
                let (s, c) = trig::sin_cos(value);
                let v = 1.0 - c;
                Placement {
                    rotation: [
                        [c + v * x * x, v * x * y - s * z, v * x * z + s * y],
                        [v * x * y + s * z, c + v * y * y, v * y * z - s * x],
                        [v * x * z - s * y, v * y * z + s * x, c + v * z * z],
                    ],
                    translation: [0.0; 3],
                }
            }
        }
    }

    /// x_a_c = x_a_b · x_b_c
    pub fn compose(&self, x_b_c: &Placement) -> Placement {
        let e = self.matrix().product(&x_b_c.matrix());
        Placement { rotation: rows(&e), translation: self.point(x_b_c.translation) }
    }

    /// x_b_a from x_a_b.
    pub fn inverse(&self) -> Placement {
        let e = self.matrix();
        let p = e.transpose_times(Vec3::splat(self.translation));
        Placement { rotation: rows(&e.transpose()), translation: [-p.x, -p.y, -p.z] }
    }

    /// Where a point of the child frame is in the parent frame.
    pub fn point(&self, p_child: [f64; 3]) -> [f64; 3] {
        let p = self.matrix().times_plus(Vec3::splat(p_child), Vec3::splat(self.translation));
        [p.x, p.y, p.z]
    }

    /// π of a body about the parent frame, from its π about the child frame (order as in
    /// [`LinkSpec::inertia`](super::LinkSpec::inertia)).
    pub fn inertia(&self, pi_child: &[f64; 10]) -> [f64; 10] {
        Inertia::from_array(pi_child).seen_from(&self.matrix(), Vec3::splat(self.translation)).to_array()
    }

    /// The largest entry of |RᵀR − 1|, and whether det R > 0.
    pub(super) fn rotation_error(&self) -> (f64, bool) {
        let e: Mat3<f64> = self.matrix();
        let gram = e.transpose().product(&e);
        let off = gram.y.x.abs().max(gram.z.x.abs()).max(gram.z.y.abs());
        let on = (gram.x.x - 1.0).abs().max((gram.y.y - 1.0).abs()).max((gram.z.z - 1.0).abs());
        (off.max(on), e.x.cross(e.y).dot(e.z) > 0.0)
    }

    pub(super) fn matrix(&self) -> Mat3<f64> {
        Mat3::splat(&self.rotation)
    }
}

/// A matrix row by row.
pub(super) fn rows<S: Copy>(e: &Mat3<S>) -> [[S; 3]; 3] {
    [[e.x.x, e.y.x, e.z.x], [e.x.y, e.y.y, e.z.y], [e.x.z, e.y.z, e.z.z]]
}
