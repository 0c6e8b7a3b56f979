//! The mass matrix by composite rigid bodies.
//!
//! Column j of M is the torque of a unit acceleration of joint j alone: everything beyond j moves as one rigid body of
//! inertia I_c, which takes the wrench I_c S_j, and that wrench acts on j and by every joint between j and the base.

use super::JointKind;
use super::model::{Tree, TreeScratch};
use super::motion::Wrench;
use super::spatial::Vec3;
use crate::{LengthError, Scalar};

impl Tree {
    /// M(q), row by row.
    #[inline(always)]
    pub(super) fn composite<S: Scalar>(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        theta: &[S],
        m: &mut [S],
    ) -> Result<(), LengthError> {
        let n = self.bodies.len();
        LengthError::check("q", n, q.len())?;
        LengthError::check("theta", self.theta_len(), theta.len())?;
        LengthError::check("mass matrix", n * n, m.len())?;
        LengthError::check("scratch", n, scratch.composite.len())?;
        self.seat(scratch, q);
        let TreeScratch { slots, composite, .. } = scratch;

        let inertias = theta.as_chunks::<10>().0;
        let mut i = 0;
        while i < n {
            composite[i] = self.bodies[i].inner(&inertias[i]);
            i += 1;
        }
        m.fill(S::ZERO);
        while i > 0 {
            i -= 1;
            let body = &self.bodies[i];
            let whole = composite[i];
            let Vec3 { x, y, .. } = whole.h;
            // I_c S, with n = I α + h × a and f = m a − h × α.
            let mut wrench = match body.kind {
                JointKind::Revolute => {
                    Wrench { n: Vec3::new(whole.i.xz, whole.i.yz, whole.i.zz), f: Vec3::new(-y, x, S::ZERO) }
                }
                JointKind::Prismatic => {
                    Wrench { n: Vec3::new(y, -x, S::ZERO), f: Vec3::new(S::ZERO, S::ZERO, whole.m) }
                }
            };
            m[i * n + i] = wrench.along(body.kind);
            if let Some(armature) = body.armature {
                m[i * n + i] = m[i * n + i] + theta[armature];
            }
            let mut ancestor = i;
            loop {
                let slot = self.bodies[ancestor].parent_slot;
                if slot == 0 {
                    break;
                }
                wrench = slots[ancestor + 1].seat.on_parent(&wrench);
                ancestor = slot - 1;
                let other = &self.bodies[ancestor];
                let entry = wrench.along(other.kind) * S::splat(body.sign * other.sign);
                m[i * n + ancestor] = entry;
                m[ancestor * n + i] = entry;
            }
            if body.parent_slot > 0 {
                let seat = &slots[i + 1].seat;
                let parent = body.parent_slot - 1;
                composite[parent] = composite[parent].plus(&whole.seen_from(&seat.e, seat.p));
            }
        }
        Ok(())
    }
}
