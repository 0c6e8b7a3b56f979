//! From links and joints as a file lists them to the moving bodies that the kernels walk.

use thiserror::Error;

/// A rigid placement: the pose of a frame in another, `p_parent = rotation · p_child + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Row by row.
    pub rotation: [[f64; 3]; 3],
    /// In m.
    pub translation: [f64; 3],
}

/// What a moving joint does along its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about the axis, rad. Continuous joints are revolute with an unwrapped real angle.
    Revolute,
    /// Slides along the axis, m.
    Prismatic,
}

/// How a link is held by its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkJoint {
    /// Rigidly: the link is lumped into its parent.
    Fixed,
    /// By a joint with one degree of freedom.
    Moving {
        /// Revolute or prismatic.
        kind: JointKind,
        /// Unit axis in the joint frame.
        axis: [f64; 3],
        /// Viscous damping in N m s/rad or N s/m.
        damping: f64,
    },
}

/// One link with the joint that carries it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkSpec {
    /// Index of the parent link, which must come earlier; `None` for the fixed base.
    pub parent: Option<usize>,
    /// Pose of the joint frame (joint at zero) in the parent link's frame.
    pub x_parent_joint: Placement,
    /// The joint.
    pub joint: LinkJoint,
    /// π = [m, m c, I] of the link about its own frame, in Pinocchio's order
    /// `m, mx, my, mz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz`.
    pub inertia: [f64; 10],
}

/// Why links do not make a tree.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TreeError {
    /// A link names a parent that does not come before it.
    #[error("link {link} names link {parent} as its parent, which does not come before it")]
    ParentOrder {
        /// The link.
        link: usize,
        /// Its supposed parent.
        parent: usize,
    },
}

/// π about the link frame from mass, centre of mass and the rotational inertia about the centre of mass
/// (`[Ixx, Ixy, Iyy, Ixz, Iyz, Izz]`, axes of the link frame).
pub fn inertia_about_frame(mass: f64, com: [f64; 3], inertia_com: [f64; 6]) -> [f64; 10] {
    let [x, y, z] = com;
    let [xx, xy, yy, xz, yz, zz] = inertia_com;
    [
        mass,
        mass * x,
        mass * y,
        mass * z,
        xx + mass * (y * y + z * z),
        xy - mass * x * y,
        yy + mass * (x * x + z * z),
        xz - mass * x * z,
        yz - mass * y * z,
        zz + mass * (x * x + y * y),
    ]
}
