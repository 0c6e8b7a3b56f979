//! The immutable model of a tree, and the working memory of its kernels.
//!
//! Every body has an *inner* frame: its joint frame with the coordinates renamed so that the joint axis is z. For an
//! axis along x, y or z, as in most robots, that is a cyclic renaming and costs nothing; any other axis costs a constant
//! rotation of the body's ten parameters. Kernels know nothing but z axes; ϑ and Yᵀs stay in the joint frame.

use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use super::articulated::Articulated;
use super::motion::{Motion, Seat, Wrench};
use super::placement::rows;
use super::spatial::{Inertia, Mat3, Sym3, Vec3};
use super::uniform::enclosed_rotation;
use crate::expression::Interval;
use crate::robot::Drives;
use crate::{LengthError, Scalar};

/// What a moving joint does along its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about the axis, rad. Continuous joints are revolute with an unwrapped real angle.
    Revolute,
    /// Slides along the axis, m.
    Prismatic,
}

/// A fixed-base tree of rigid bodies, ready for the kernels. Built by [`Tree::assemble`].
///
/// It holds geometry, joint axes and gravity; every inertia and coefficient of its joints comes in as `theta`.
#[derive(Clone, Debug)]
pub struct Tree {
    pub(super) bodies: Vec<Body>,
    pub(super) drives: Drives,
    pub(super) gravity: [f64; 3],
    /// Of each body that is held rigidly by it and holds nothing: the farthest; empty where no links are known.
    pub(super) ends: Vec<Option<[f64; 3]>>,
}

/// One moving body.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Zero for the base, else one more than the index of the body that carries this one.
    pub(super) parent_slot: usize,
    pub(super) kind: JointKind,
    /// −1 where the joint turns about, or slides along, −z of the inner frame.
    pub(super) sign: f64,
    /// Orientation and origin of the inner frame, joint at zero, in the inner frame of the parent.
    pub(super) rotation: [[f64; 3]; 3],
    pub(super) translation: [f64; 3],
    coordinates: Coordinates,
    /// Where its joint's armature stands in ϑ, if it has one.
    pub(super) armature: Option<usize>,
}

/// How the coordinates of the inner frame are named in the joint frame.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinates {
    /// The joint axis is ±z: the inner frame is the joint frame.
    Z,
    /// The joint axis is ±x: inner x, y, z are y, z, x of the joint frame.
    X,
    /// The joint axis is ±y: inner x, y, z are z, x, y of the joint frame.
    Y,
    /// Any axis: the orientation of the inner frame in the joint frame, row by row.
    Turned([[f64; 3]; 3]),
}

impl Coordinates {
    /// The coordinates and the sign that make `axis` ±z.
    fn of_axis(axis: [f64; 3]) -> (Self, f64) {
        match axis {
            [0.0, 0.0, z] => (Coordinates::Z, z),
            [x, 0.0, 0.0] => (Coordinates::X, x),
            [0.0, y, 0.0] => (Coordinates::Y, y),
            [x, y, z] => {
                // The coordinate axis that is farthest from `axis` gives a well-conditioned normal.
                let helper = if x.abs() <= y.abs() && x.abs() <= z.abs() {
                    Vec3::new(1.0, 0.0, 0.0)
                } else if y.abs() <= z.abs() {
                    Vec3::new(0.0, 1.0, 0.0)
                } else {
                    Vec3::new(0.0, 0.0, 1.0)
                };
                let c = Vec3::new(x, y, z);
                let normal = helper.cross(c);
                let length = libm::sqrt(normal.dot(normal));
                let a = Vec3::new(normal.x / length, normal.y / length, normal.z / length);
                (Coordinates::Turned(rows(&Mat3 { x: a, y: c.cross(a), z: c })), 1.0)
            }
        }
    }

    /// The orientation of the inner frame in the joint frame.
    fn matrix(&self) -> Mat3<f64> {
        Mat3::splat(match self {
            Coordinates::Z => &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Coordinates::X => &[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            Coordinates::Y => &[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
            Coordinates::Turned(rows) => rows,
        })
    }
}

impl<S: Scalar> Inertia<S> {
    /// From Pinocchio's order.
    #[inline(always)]
    pub(super) fn from_array(pi: &[S; 10]) -> Self {
        let [m, x, y, z, xx, xy, yy, xz, yz, zz] = *pi;
        Inertia { m, h: Vec3 { x, y, z }, i: Sym3 { xx, xy, yy, xz, yz, zz } }
    }

    /// To Pinocchio's order.
    #[inline(always)]
    pub(super) fn to_array(self) -> [S; 10] {
        let Sym3 { xx, xy, yy, xz, yz, zz } = self.i;
        [self.m, self.h.x, self.h.y, self.h.z, xx, xy, yy, xz, yz, zz]
    }

    /// Inner x, y, z are y, z, x of the joint frame.
    #[inline(always)]
    fn renamed(self) -> Self {
        let (h, i) = (self.h, self.i);
        Inertia {
            m: self.m,
            h: Vec3 { x: h.y, y: h.z, z: h.x },
            i: Sym3 { xx: i.yy, xy: i.yz, yy: i.zz, xz: i.xy, yz: i.xz, zz: i.xx },
        }
    }

    #[inline(always)]
    fn turned(self, e: &Mat3<S>) -> Self {
        Inertia { m: self.m, h: e.times(self.h), i: self.i.turned(e) }
    }

    /// Off-diagonal inertias times `k`.
    #[inline(always)]
    fn weighted(mut self, k: f64) -> Self {
        let k = S::splat(k);
        self.i.xy = self.i.xy * k;
        self.i.xz = self.i.xz * k;
        self.i.yz = self.i.yz * k;
        self
    }
}

impl Body {
    pub(super) fn new(
        parent: Option<usize>,
        x_parent_joint: &super::Placement,
        kind: JointKind,
        axis: [f64; 3],
        bodies: &[Body],
    ) -> Self {
        let (coordinates, sign) = Coordinates::of_axis(axis);
        let parent_inner = match parent.and_then(|parent| bodies.get(parent)) {
            Some(parent) => parent.coordinates.matrix(),
            None => Coordinates::Z.matrix(),
        };
        let p = parent_inner.transpose_times(Vec3::splat(x_parent_joint.translation));
        let e = parent_inner.transpose().product(&x_parent_joint.matrix()).product(&coordinates.matrix());
        Body {
            parent_slot: parent.map_or(0, |parent| parent + 1),
            kind,
            sign,
            rotation: rows(&e),
            translation: [p.x, p.y, p.z],
            coordinates,
            armature: None,
        }
    }

    /// A vector of the joint frame in the inner frame.
    #[inline(always)]
    pub(super) fn inner_vector<S: Scalar>(&self, v: Vec3<S>) -> Vec3<S> {
        match &self.coordinates {
            Coordinates::Z => v,
            Coordinates::X => Vec3 { x: v.y, y: v.z, z: v.x },
            Coordinates::Y => Vec3 { x: v.z, y: v.x, z: v.y },
            Coordinates::Turned(e) => Mat3::splat(e).transpose_times(v),
        }
    }

    /// A vector of the inner frame in the joint frame.
    #[inline(always)]
    pub(super) fn outer_vector(&self, v: Vec3<f64>) -> Vec3<f64> {
        self.coordinates.matrix().times(v)
    }

    /// The body's parameters in its inner frame.
    #[inline(always)]
    pub(super) fn inner<S: Scalar>(&self, pi: &[S; 10]) -> Inertia<S> {
        let pi = Inertia::from_array(pi);
        match &self.coordinates {
            Coordinates::Z => pi,
            Coordinates::X => pi.renamed(),
            Coordinates::Y => pi.renamed().renamed(),
            Coordinates::Turned(e) => pi.turned(&Mat3::splat(e).transpose()),
        }
    }

    /// The body's parameters in its inner frame, enclosed.
    pub(super) fn enclosed_inertia(&self, pi: &[f64; 10]) -> Inertia<Interval> {
        match &self.coordinates {
            Coordinates::Z | Coordinates::X | Coordinates::Y => self.inner(&pi.map(Interval::point)),
            Coordinates::Turned(e) => {
                Inertia::from_array(&pi.map(Interval::point)).turned(&enclosed_rotation(e).transpose())
            }
        }
    }

    /// A gradient by inner parameters as a gradient by the body's parameters.
    #[inline(always)]
    pub(super) fn outer<S: Scalar>(&self, gradient: Inertia<S>) -> [S; 10] {
        let gradient = match &self.coordinates {
            Coordinates::Z => gradient,
            Coordinates::X => gradient.renamed().renamed(),
            Coordinates::Y => gradient.renamed(),
            // An off-diagonal parameter stands at two places of its matrix, so its derivative is twice the matrix entry.
            Coordinates::Turned(e) => gradient.weighted(0.5).turned(&Mat3::splat(e)).weighted(2.0),
        };
        gradient.to_array()
    }
}

impl Tree {
    pub(super) fn new(bodies: Vec<Body>, damped: Vec<usize>, gravity: [f64; 3]) -> Self {
        Tree { bodies, drives: Drives { damped, ..Drives::default() }, gravity, ends: Vec::new() }
    }

    /// Number of joints, which is the number of moving bodies.
    pub fn joint_count(&self) -> usize {
        self.bodies.len()
    }

    /// What the joint of every moving body does.
    pub fn joint_kinds(&self) -> impl ExactSizeIterator<Item = JointKind> + '_ {
        self.bodies.iter().map(|body| body.kind)
    }

    /// The body that carries each body; `None` for the base.
    pub fn parents(&self) -> impl ExactSizeIterator<Item = Option<usize>> + '_ {
        self.bodies.iter().map(|body| body.parent_slot.checked_sub(1))
    }

    /// The gravity vector in the base frame, m/s².
    pub fn gravity_m_s2(&self) -> [f64; 3] {
        self.gravity
    }

    /// Names with units for the entries of ϑ, from the names of the moving bodies.
    ///
    /// # Errors
    /// [`LengthError`] when there are not as many names as bodies.
    pub fn theta_names(&self, bodies: &[&str]) -> Result<Vec<String>, LengthError> {
        const ENTRIES: [&str; 10] = [
            "mass_kg",
            "mass_com_x_kg_m",
            "mass_com_y_kg_m",
            "mass_com_z_kg_m",
            "inertia_xx_kg_m2",
            "inertia_xy_kg_m2",
            "inertia_yy_kg_m2",
            "inertia_xz_kg_m2",
            "inertia_yz_kg_m2",
            "inertia_zz_kg_m2",
        ];
        LengthError::check("body names", self.bodies.len(), bodies.len())?;
        let inertias = bodies.iter().flat_map(|body| ENTRIES.iter().map(move |entry| format!("{body}.{entry}")));
        let of = |joint: usize, revolute: &str, prismatic: &str| match self.bodies[joint].kind {
            JointKind::Revolute => format!("{}.{revolute}", bodies[joint]),
            JointKind::Prismatic => format!("{}.{prismatic}", bodies[joint]),
        };
        let dampings = self.drives.damped.iter().map(|joint| of(*joint, "damping_n_m_s", "damping_n_s_m"));
        let armatures = self.drives.geared.iter().map(|joint| of(*joint, "armature_kg_m2", "armature_kg"));
        let frictions = self.drives.friction.iter().map(|f| of(f.joint, "friction_n_m", "friction_n"));
        Ok(inertias.chain(dampings).chain(armatures).chain(frictions).collect())
    }

    /// Allocates working memory for this tree.
    pub fn scratch<S: Scalar>(&self) -> TreeScratch<S> {
        let n = self.bodies.len();
        TreeScratch {
            slots: vec![Slot::BASE; n + 1],
            articulated: vec![Articulated::ZERO; n],
            composite: vec![Inertia::ZERO; n],
            sin: vec![S::ZERO; n],
            cos: vec![S::ZERO; n],
            unit: vec![S::ZERO; n],
            column: vec![S::ZERO; n],
            row: vec![S::ZERO; self.theta_len()],
        }
    }

    /// The base: it stands still, and gravity is an upward acceleration of it.
    #[inline(always)]
    pub(super) fn base<S: Scalar>(&self) -> Motion<S> {
        let [x, y, z] = self.gravity;
        Motion { accel: Vec3::splat([-x, -y, -z]), ..Motion::STILL }
    }
}

/// Working memory of the kernels of one tree; nothing in it outlives a call.
#[derive(Clone, Debug)]
pub struct TreeScratch<S> {
    /// The base, then the bodies.
    pub(super) slots: Vec<Slot<S>>,
    pub(super) articulated: Vec<Articulated<S>>,
    pub(super) composite: Vec<Inertia<S>>,
    pub(super) sin: Vec<S>,
    pub(super) cos: Vec<S>,
    /// A unit vector or zeros, for columns of the Coriolis matrix and rows of Y.
    pub(super) unit: Vec<S>,
    pub(super) column: Vec<S>,
    pub(super) row: Vec<S>,
}

/// What a sweep leaves at a body for its children and for the way back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<S> {
    pub(super) seat: Seat<S>,
    pub(super) motion: Motion<S>,
    pub(super) wrench: Wrench<S>,
}

impl<S: Scalar> Slot<S> {
    const BASE: Self = Slot { seat: Seat::AT_PARENT, motion: Motion::STILL, wrench: Wrench::ZERO };
}
