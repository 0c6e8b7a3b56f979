//! The fused sweep: Y(q, q̇, z, ż) ϑ and Yᵀs in one pass up the tree and one back. The derivation is in `motion.rs`.

use super::model::{Slot, Tree, TreeScratch};
use super::motion::{Motion, Rates, Seat, Wrench};
use crate::robot::TwoVelocity;
use crate::{LengthError, Scalar};

impl Tree {
    /// `y_theta` = Yϑ and `yt_s` = Yᵀs.
    #[inline(always)]
    pub(super) fn fused<S: Scalar>(
        &self,
        slots: &mut [Slot<S>],
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
        LengthError::check("scratch", n + 1, slots.len())?;

        slots[0].motion = self.base();
        let (inertias, dampings) = theta.split_at(10 * n);
        let (gradients, damping_gradients) = yt_s.split_at_mut(10 * n);
        let (inertias, gradients) = (inertias.as_chunks::<10>().0, gradients.as_chunks_mut::<10>().0);
        let half = S::splat(0.5);
        let mut i = 0;
        while i < n {
            let body = &self.bodies[i];
            let sign = S::splat(body.sign);
            let rates = Rates { dq: motion.dq[i] * sign, half_z: motion.z[i] * sign * half, dz: motion.dz[i] * sign };
            let parent = slots[body.parent_slot].motion;
            let seat = Seat::of(body, motion.q[i]);
            let moved = parent.child(&seat, body.kind, rates).with_test(&parent, &seat, body.kind, s[i] * sign);
            gradients[i] = body.outer(moved.gradient());
            slots[i + 1] = Slot { seat, motion: moved, wrench: moved.wrench(&body.inner(&inertias[i])) };
            i += 1;
        }
        self.fold_back(slots, y_theta);
        for (k, joint) in self.damped.iter().enumerate() {
            y_theta[*joint] = dampings[k].mul_add(motion.z[*joint], y_theta[*joint]);
            damping_gradients[k] = motion.z[*joint] * s[*joint];
        }
        Ok(())
    }

    /// Yᵀs alone.
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
        let (gradients, damping_gradients) = yt_s.split_at_mut(10 * n);
        let gradients = gradients.as_chunks_mut::<10>().0;
        let half = S::splat(0.5);
        let mut i = 0;
        while i < n {
            let body = &self.bodies[i];
            let sign = S::splat(body.sign);
            let rates = Rates { dq: motion.dq[i] * sign, half_z: motion.z[i] * sign * half, dz: motion.dz[i] * sign };
            let parent = slots[body.parent_slot].motion;
            let seat = Seat::of(body, motion.q[i]);
            let moved = parent.child(&seat, body.kind, rates).with_test(&parent, &seat, body.kind, s[i] * sign);
            gradients[i] = body.outer(moved.gradient());
            slots[i + 1] = Slot { seat, motion: moved, wrench: Wrench::ZERO };
            i += 1;
        }
        for (gradient, joint) in damping_gradients.iter_mut().zip(&self.damped) {
            *gradient = motion.z[*joint] * s[*joint];
        }
    }

    /// M ż + C z + g, without damping and without the test motion; `fold` says whether to go back down for the torque
    /// or to leave the wrenches of single bodies in `slots`.
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
        let half = S::splat(0.5);
        let mut i = 0;
        while i < self.bodies.len() {
            let body = &self.bodies[i];
            let sign = S::splat(body.sign);
            let rates = Rates { dq: motion.dq[i] * sign, half_z: motion.z[i] * sign * half, dz: motion.dz[i] * sign };
            let seat = Seat::of(body, motion.q[i]);
            let moved = slots[body.parent_slot].motion.child(&seat, body.kind, rates);
            slots[i + 1] = Slot { seat, motion: moved, wrench: moved.wrench(&body.inner(&inertias[i])) };
            i += 1;
        }
    }

    /// Adds every body's wrench to its parent's, outermost first, and reads off the joint torques.
    #[inline(always)]
    pub(super) fn fold_back<S: Scalar>(&self, slots: &mut [Slot<S>], torque: &mut [S]) {
        let mut i = self.bodies.len();
        while i > 0 {
            i -= 1;
            let body = &self.bodies[i];
            let Slot { seat, wrench, .. } = slots[i + 1];
            torque[i] = wrench.along(body.kind) * S::splat(body.sign);
            if body.parent_slot > 0 {
                let parent = &mut slots[body.parent_slot].wrench;
                *parent = parent.plus(&seat.felt_by_parent(&wrench));
            }
        }
    }
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
