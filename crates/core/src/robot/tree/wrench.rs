//! What acts on a point of a link, and how that point moves: Jᵀw and J q̇ without J.
//!
//! Let r be the point and f, n force and moment in the inner frame of the body that carries it. Walking to the base, the
//! moment about each origin is n + r × f, its part along the joint is that joint's torque, and origin and axes change as
//! every wrench's do (`Seat::on_parent`). The velocity of the point is gathered on the same walk: seen from the frame that a joint
//! moves in, a point at r that moves with v within the body moves with v + z q̇ × r (revolute) or v + z q̇ (prismatic). Both
//! take one pass over the joints that carry the link, and the power is the same on both sides: (Jᵀw)ᵀ q̇ = wᵀ (J q̇).

use super::model::{Tree, TreeScratch};
use super::motion::Wrench;
use super::spatial::{Mat3, Vec3};
use super::{Anchor, JointKind};
use crate::{Kernel, LengthError, Scalar, dispatch};

/// A point that is fixed to a link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkPoint {
    /// Where the link is held.
    pub link: Anchor,
    /// The point in the link's frame, m.
    pub at: [f64; 3],
}

/// The axes that the components of a force refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Those of the base frame: the direction stays while the link turns.
    Base,
    /// Those of the link: the direction turns with it.
    Link,
}

/// A force that acts at a point, and a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointWrench<S> {
    /// In N.
    pub force: [S; 3],
    /// In N m.
    pub moment: [S; 3],
    /// What the components refer to.
    pub axes: Axes,
}

/// Where a point is and how it moves, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion<S> {
    /// In m.
    pub position: [S; 3],
    /// In m/s.
    pub velocity: [S; 3],
}

impl Tree {
    /// Adds Jᵀw to `tau`: the joint torques or forces that do what `wrench` does at `point`.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length, or `scratch` is another tree's.
    pub fn add_wrench<S: Scalar>(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        point: &LinkPoint,
        wrench: &PointWrench<S>,
        tau: &mut [S],
    ) -> Result<(), LengthError> {
        dispatch(AddWrench { tree: self, scratch, q, point, wrench, tau })
    }

    /// Where `point` is and how it moves.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length, or `scratch` is another tree's.
    pub fn point_motion<S: Scalar>(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        dq: &[S],
        point: &LinkPoint,
    ) -> Result<PointMotion<S>, LengthError> {
        dispatch(Moves { tree: self, scratch, q, dq, point })
    }

    /// The body that carries the point, and the point in the body's inner frame; `None` on the base.
    #[inline(always)]
    fn carried<S: Scalar>(&self, point: &LinkPoint) -> Option<(usize, Vec3<S>)> {
        let body = point.link.body.filter(|body| *body < self.bodies.len())?;
        Some((body, self.bodies[body].inner_vector(Vec3::splat(point.link.x_body_link.point(point.at)))))
    }
}

struct AddWrench<'a, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    q: &'a [S],
    point: &'a LinkPoint,
    wrench: &'a PointWrench<S>,
    tau: &'a mut [S],
}

impl<S: Scalar> Kernel for AddWrench<'_, S> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let AddWrench { tree, scratch, q, point, wrench, tau } = self;
        let n = tree.bodies.len();
        LengthError::check("q", n, q.len())?;
        LengthError::check("tau", n, tau.len())?;
        LengthError::check("scratch", n, scratch.unit.len())?;
        let Some((mut body, r)) = tree.carried(point) else { return Ok(()) };
        tree.seat(scratch, q);
        let slots = &scratch.slots;
        let vector = |[x, y, z]: [S; 3]| Vec3 { x, y, z };
        let (mut f, mut moment) = (vector(wrench.force), vector(wrench.moment));
        match wrench.axes {
            Axes::Link => {
                let turn: Mat3<S> = Mat3::splat(&point.link.x_body_link.rotation);
                f = tree.bodies[body].inner_vector(turn.times(f));
                moment = tree.bodies[body].inner_vector(turn.times(moment));
            }
            Axes::Base => {
                let mut e = slots[body + 1].seat.e;
                let mut slot = tree.bodies[body].parent_slot;
                while slot > 0 {
                    e = slots[slot].seat.e.product(&e);
                    slot = tree.bodies[slot - 1].parent_slot;
                }
                f = e.transpose_times(f);
                moment = e.transpose_times(moment);
            }
        }
        let mut wrench = Wrench { f, n: r.cross_plus(f, moment) };
        loop {
            let joint = &tree.bodies[body];
            tau[body] = wrench.along(joint.kind).mul_add(S::splat(joint.sign), tau[body]);
            if joint.parent_slot == 0 {
                return Ok(());
            }
            wrench = slots[body + 1].seat.on_parent(&wrench);
            body = joint.parent_slot - 1;
        }
    }
}

struct Moves<'a, S> {
    tree: &'a Tree,
    scratch: &'a mut TreeScratch<S>,
    q: &'a [S],
    dq: &'a [S],
    point: &'a LinkPoint,
}

impl<S: Scalar> Kernel for Moves<'_, S> {
    type Output = Result<PointMotion<S>, LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Moves { tree, scratch, q, dq, point } = self;
        let n = tree.bodies.len();
        LengthError::check("q", n, q.len())?;
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("scratch", n, scratch.unit.len())?;
        let Some((mut body, mut r)) = tree.carried::<S>(point) else {
            let position = point.link.x_body_link.point(point.at).map(S::splat);
            return Ok(PointMotion { position, velocity: [S::ZERO; 3] });
        };
        tree.seat(scratch, q);
        let mut v = Vec3::ZERO;
        loop {
            let joint = &tree.bodies[body];
            let rate = dq[body] * S::splat(joint.sign);
            match joint.kind {
                // z q̇ × r = q̇ (−y, x, 0)
                JointKind::Revolute => {
                    v.x = r.y.neg_mul_add(rate, v.x);
                    v.y = r.x.mul_add(rate, v.y);
                }
                JointKind::Prismatic => v.z = v.z + rate,
            }
            let seat = &scratch.slots[body + 1].seat;
            r = seat.e.times_plus(r, seat.p);
            v = seat.e.times(v);
            if joint.parent_slot == 0 {
                return Ok(PointMotion { position: [r.x, r.y, r.z], velocity: [v.x, v.y, v.z] });
            }
            body = joint.parent_slot - 1;
        }
    }
}
