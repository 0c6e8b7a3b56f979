//! The fused sweep: Y(q, q̇, z, ż) ϑ and Yᵀs in one pass up the tree and one back. The derivation is in `motion.rs`.

use super::JointKind;
use super::model::{Body, Slot, Tree, TreeScratch};
use super::motion::{Motion, Rates, Seat, Wrench};
use crate::robot::TwoVelocity;
use crate::{LengthError, Scalar};

impl Tree {
    /// Places every body on its parent.
    #[inline(always)]
    pub(super) fn seat<S: Scalar>(&self, scratch: &mut TreeScratch<S>, q: &[S]) {
        let TreeScratch { slots, sin, cos, .. } = scratch;
        S::sin_cos_each(q, sin, cos);
        let mut i = 0;
        while i < self.bodies.len() {
            slots[i + 1].seat = Seat::of(&self.bodies[i], q[i], sin[i], cos[i]);
            i += 1;
        }
    }

    /// `y_theta` = Yϑ and `yt_s` = Yᵀs.
    #[inline(always)]
    pub(super) fn fused<S: Scalar>(
        &self,
        scratch: &mut TreeScratch<S>,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        let n = self.bodies.len();
        motion.check(n)?;
        LengthError::check("theta", self.theta_len(), theta.len())?;
        LengthError::check("s", n, s.len())?;
        LengthError::check("y_theta", n, y_theta.len())?;
        LengthError::check("yt_s", self.theta_len(), yt_s.len())?;
        LengthError::check("scratch", n, scratch.sin.len())?;

        self.seat(scratch, motion.q);
        let slots = scratch.slots.as_mut_slice();
        slots[0].motion = self.base();
        let (gradients, drive_gradients) = yt_s.split_at_mut(10 * n);
        let (inertias, gradients) = (theta.as_chunks::<10>().0, gradients.as_chunks_mut::<10>().0);
        let mut i = 0;
        while i < n {
            let body = &self.bodies[i];
            let (done, rest) = slots.split_at_mut(i + 1);
            let (parent, slot) = (&done[body.parent_slot].motion, &mut rest[0]);
            let rates = rates(motion, i, body.sign);
            let test = s[i] * S::splat(body.sign);
            // One copy of the code per kind: a choice per number would cost more than the branch.
            gradients[i] = match body.kind {
                JointKind::Revolute => step(body, parent, slot, JointKind::Revolute, rates, test, &inertias[i]),
                JointKind::Prismatic => step(body, parent, slot, JointKind::Prismatic, rates, test, &inertias[i]),
            };
            i += 1;
        }
        self.fold_back(slots, y_theta);
        self.drives.add(motion, &theta[10 * n..], y_theta);
        self.drives.pair(motion, s, drive_gradients);
        Ok(())
    }

    /// Yᵀs alone, with the bodies seated.
    #[inline(always)]
    pub(super) fn pairing<S: Scalar>(
        &self,
        slots: &mut [Slot<S>],
        motion: TwoVelocity<'_, S>,
        s: &[S],
        yt_s: &mut [S],
    ) {
        let n = self.bodies.len();
        slots[0].motion = self.base();
        let (gradients, drive_gradients) = yt_s.split_at_mut(10 * n);
        let gradients = gradients.as_chunks_mut::<10>().0;
        let mut i = 0;
        while i < n {
            let body = &self.bodies[i];
            let (done, rest) = slots.split_at_mut(i + 1);
            let (parent, slot) = (&done[body.parent_slot].motion, &mut rest[0]);
            let test = s[i] * S::splat(body.sign);
            let moved = moved_and_tested(parent, &slot.seat, body.kind, rates(motion, i, body.sign), test);
            gradients[i] = body.outer(moved.gradient());
            slot.motion = moved;
            i += 1;
        }
        self.drives.pair(motion, s, drive_gradients);
    }

    /// M ż + C z + g, without damping and without the test motion: the wrenches of single bodies, seated before.
    #[inline(always)]
    pub(super) fn wrenches<S: Scalar>(
        &self,
        slots: &mut [Slot<S>],
        base: Motion<S>,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
    ) {
        slots[0].motion = base;
        let inertias = theta.as_chunks::<10>().0;
        let mut i = 0;
        while i < self.bodies.len() {
            let body = &self.bodies[i];
            let (done, rest) = slots.split_at_mut(i + 1);
            let (parent, slot) = (&done[body.parent_slot].motion, &mut rest[0]);
            let rates = rates(motion, i, body.sign);
            let moved = match body.kind {
                JointKind::Revolute => parent.child(&slot.seat, JointKind::Revolute, rates),
                JointKind::Prismatic => parent.child(&slot.seat, JointKind::Prismatic, rates),
            };
            slot.wrench = moved.wrench(&body.inner(&inertias[i]));
            slot.motion = moved;
            i += 1;
        }
    }

    /// Adds every body's wrench to its parent's, outermost first, and reads off the joint torques.
    #[inline(always)]
    pub(super) fn fold_back<S: Scalar>(&self, slots: &mut [Slot<S>], torque: &mut [S]) {
        // Along a chain the wrench is handed on and never waits for memory.
        let mut carried = Wrench::ZERO;
        let mut i = self.bodies.len();
        while i > 0 {
            i -= 1;
            let body = &self.bodies[i];
            let Slot { seat, wrench, .. } = &slots[i + 1];
            let wrench = wrench.plus(&carried);
            torque[i] = wrench.along(body.kind) * S::splat(body.sign);
            carried = Wrench::ZERO;
            if body.parent_slot > 0 {
                let handed_on = seat.on_parent(&wrench);
                if body.parent_slot == i {
                    carried = handed_on;
                } else {
                    let parent = &mut slots[body.parent_slot].wrench;
                    *parent = parent.plus(&handed_on);
                }
            }
        }
    }
}

#[inline(always)]
fn rates<S: Scalar>(motion: TwoVelocity<'_, S>, i: usize, sign: f64) -> Rates<S> {
    let sign = S::splat(sign);
    Rates { dq: motion.dq[i] * sign, half_z: motion.z[i] * sign * S::splat(0.5), dz: motion.dz[i] * sign }
}

/// Moves one body, leaves what it takes in `slot`, and returns its part of Yᵀs.
#[inline(always)]
fn step<S: Scalar>(
    body: &Body,
    parent: &Motion<S>,
    slot: &mut Slot<S>,
    kind: JointKind,
    rates: Rates<S>,
    test: S,
    inertia: &[S; 10],
) -> [S; 10] {
    let moved = parent.child(&slot.seat, kind, rates).with_test(parent, &slot.seat, kind, test);
    slot.wrench = moved.wrench(&body.inner(inertia));
    slot.motion = moved;
    body.outer(moved.gradient())
}

#[inline(always)]
fn moved_and_tested<S: Scalar>(
    parent: &Motion<S>,
    seat: &Seat<S>,
    kind: JointKind,
    rates: Rates<S>,
    test: S,
) -> Motion<S> {
    parent.child(seat, kind, rates).with_test(parent, seat, kind, test)
}

/// Builds the rows and columns of matrices: the kernels' results for unit vectors.
impl<S: Scalar> TreeScratch<S> {
    /// Sets `unit` to the `k`-th unit vector.
    #[inline(always)]
    pub(super) fn point_at(&mut self, k: usize) {
        self.unit.fill(S::ZERO);
        self.unit[k] = S::splat(1.0);
    }
}
