//! From links and joints as a file lists them to the moving bodies that the kernels walk.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::model::{Body, Tree};
use super::{JointKind, Placement};

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

impl LinkSpec {
    /// The same link with its joint frozen at `value` (rad or m); a fixed joint stays as it is.
    pub fn locked(&self, value: f64) -> LinkSpec {
        let x_parent_joint = match self.joint {
            LinkJoint::Fixed => self.x_parent_joint,
            LinkJoint::Moving { kind, axis, .. } => {
                self.x_parent_joint.compose(&Placement::of_joint(kind, axis, value))
            }
        };
        LinkSpec { x_parent_joint, joint: LinkJoint::Fixed, ..*self }
    }
}

/// Why links do not make a tree. Links are numbered from zero.
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
    /// No link is carried by a moving joint.
    #[error("none of the {links} links is carried by a moving joint")]
    NothingMoves {
        /// How many links there are.
        links: usize,
    },
    /// A number is infinite or not a number.
    #[error("the {what} of link {link} holds {value}, which is not a finite number")]
    NotFinite {
        /// The link.
        link: usize,
        /// `"placement"`, `"axis"`, `"damping"` or `"inertia"`.
        what: &'static str,
        /// The first offending value.
        value: f64,
    },
    /// The gravity vector is infinite or not a number.
    #[error("gravity is [{}, {}, {}] m/s², which is not finite", .gravity[0], .gravity[1], .gravity[2])]
    Gravity {
        /// The vector given.
        gravity: [f64; 3],
    },
    /// The matrix of a placement is no rotation.
    #[error(
        "the placement of link {link} is no rotation: RᵀR differs from 1 by {error:e}{}",
        if *.mirrored { " and det R is negative" } else { "" }
    )]
    NotRotation {
        /// The link.
        link: usize,
        /// The largest entry of |RᵀR − 1|.
        error: f64,
        /// Whether the determinant is negative.
        mirrored: bool,
    },
    /// The joint axis is the zero vector.
    #[error("the joint axis of link {link} is zero")]
    ZeroAxis {
        /// The link.
        link: usize,
    },
    /// The joint axis is not of unit length.
    #[error("the joint axis of link {link} has length {length}, but must be a unit vector")]
    AxisLength {
        /// The link.
        link: usize,
        /// Its length.
        length: f64,
    },
    /// A damping coefficient is negative.
    #[error("the joint of link {link} has damping {damping}, but damping must not be negative")]
    NegativeDamping {
        /// The link.
        link: usize,
        /// The coefficient given.
        damping: f64,
    },
}

/// Where a link is held: by a moving body, or by the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// The moving body that carries the link, from zero; `None` for the base.
    pub body: Option<usize>,
    /// Pose of the link frame in the joint frame of that body, or in the base frame.
    pub x_body_link: Placement,
}

/// A tree with its nominal parameters.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// Geometry, joints and gravity.
    pub tree: Tree,
    /// ϑ: ten numbers per moving body about its joint frame, then the damping of every joint that has some.
    pub theta: Vec<f64>,
    /// For every moving body, the index of the link its joint carries.
    pub moving: Vec<usize>,
    /// For every link, where it ended up.
    pub anchors: Vec<Anchor>,
}

/// |RᵀR − 1| of a placement and | |axis| − 1 | may be this large: decimals in files are rounded.
const TOLERANCE: f64 = 1.0e-6;

impl Tree {
    /// Lumps rigidly held links into the moving body that carries them, or drops them with the base, and numbers the
    /// moving bodies in the order of their links. `gravity` in the base frame, m/s², usually `[0, 0, -9.81]`.
    ///
    /// Whether the inertias make physical sense is another question: see [`inertia_defects`](super::inertia_defects) and
    /// [`Tree::check_mass_matrix`].
    ///
    /// # Errors
    /// [`TreeError`] for the first link that is malformed.
    pub fn assemble(links: &[LinkSpec], gravity: [f64; 3]) -> Result<Assembled, TreeError> {
        if gravity.iter().any(|g| !g.is_finite()) {
            return Err(TreeError::Gravity { gravity });
        }
        let mut anchors: Vec<Anchor> = Vec::with_capacity(links.len());
        let (mut bodies, mut inertias) = (Vec::new(), Vec::<[f64; 10]>::new());
        let (mut damped, mut dampings) = (Vec::new(), Vec::new());
        let mut moving = Vec::new();
        for (link, spec) in links.iter().enumerate() {
            check_link(link, spec)?;
            let held_by = match spec.parent {
                None => Anchor { body: None, x_body_link: Placement::IDENTITY },
                Some(parent) => match anchors.get(parent) {
                    Some(anchor) => *anchor,
                    None => return Err(TreeError::ParentOrder { link, parent }),
                },
            };
            let x_body_joint = held_by.x_body_link.compose(&spec.x_parent_joint);
            let anchor = match spec.joint {
                LinkJoint::Fixed => {
                    if let Some(lumped) = held_by.body.and_then(|body| inertias.get_mut(body)) {
                        let added = x_body_joint.inertia(&spec.inertia);
                        for (sum, part) in lumped.iter_mut().zip(added) {
                            *sum += part;
                        }
                    }
                    Anchor { body: held_by.body, x_body_link: x_body_joint }
                }
                LinkJoint::Moving { kind, axis, damping } => {
                    let axis = checked_axis(link, axis)?;
                    if damping != 0.0 {
                        damped.push(bodies.len());
                        dampings.push(damping);
                    }
                    let body = Body::new(held_by.body, &x_body_joint, kind, axis, &bodies);
                    bodies.push(body);
                    inertias.push(spec.inertia);
                    moving.push(link);
                    Anchor { body: Some(bodies.len() - 1), x_body_link: Placement::IDENTITY }
                }
            };
            anchors.push(anchor);
        }
        if bodies.is_empty() {
            return Err(TreeError::NothingMoves { links: links.len() });
        }
        let mut theta: Vec<f64> = inertias.into_iter().flatten().collect();
        theta.extend(dampings);
        let ends = ends(links, &anchors, bodies.len());
        let tree = Tree { ends, ..Tree::new(bodies, damped, gravity) };
        Ok(Assembled { tree, theta, moving, anchors })
    }

    /// Where a moving body ends, in its frame: the origin of the farthest of the links that are held rigidly by it and hold none themselves, such
    /// as a flange; `None` where there is none but at its own origin.
    pub fn end_of(&self, body: usize) -> Option<[f64; 3]> {
        self.ends.get(body).copied().flatten()
    }
}

/// See [`Tree::end_of`].
fn ends(links: &[LinkSpec], anchors: &[Anchor], bodies: usize) -> Vec<Option<[f64; 3]>> {
    let mut holds = vec![false; links.len()];
    for parent in links.iter().filter_map(|spec| spec.parent) {
        if let Some(holds) = holds.get_mut(parent) {
            *holds = true;
        }
    }
    let square = |[x, y, z]: [f64; 3]| x * x + y * y + z * z;
    let mut ends = vec![None; bodies];
    for (anchor, _) in anchors.iter().zip(&holds).filter(|(_, holds)| !**holds) {
        let at = anchor.x_body_link.translation;
        if let Some(end) = anchor.body.and_then(|body| ends.get_mut(body))
            && square(at) > end.map_or(0.0, square)
        {
            *end = Some(at);
        }
    }
    ends
}

fn check_link(link: usize, spec: &LinkSpec) -> Result<(), TreeError> {
    let finite = |what, values: &[f64]| match values.iter().find(|x| !x.is_finite()) {
        Some(value) => Err(TreeError::NotFinite { link, what, value: *value }),
        None => Ok(()),
    };
    finite("placement", spec.x_parent_joint.rotation.as_flattened())?;
    finite("placement", &spec.x_parent_joint.translation)?;
    finite("inertia", &spec.inertia)?;
    let (error, proper) = spec.x_parent_joint.rotation_error();
    if error > TOLERANCE || !proper {
        return Err(TreeError::NotRotation { link, error, mirrored: !proper });
    }
    if let LinkJoint::Moving { axis, damping, .. } = spec.joint {
        finite("axis", &axis)?;
        finite("damping", &[damping])?;
        if damping < 0.0 {
            return Err(TreeError::NegativeDamping { link, damping });
        }
    }
    Ok(())
}

/// The axis at exactly unit length.
fn checked_axis(link: usize, [x, y, z]: [f64; 3]) -> Result<[f64; 3], TreeError> {
    let length = libm::hypot(libm::hypot(x, y), z);
    if length == 0.0 {
        return Err(TreeError::ZeroAxis { link });
    }
    if (length - 1.0).abs() > TOLERANCE {
        return Err(TreeError::AxisLength { link, length });
    }
    Ok([x / length, y / length, z / length])
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
