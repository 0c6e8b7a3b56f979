//! Forward dynamics by articulated bodies, O(n).
//!
//! The wrenches w⁰ that the motion would take at q̈ = 0, gravity and all products of velocities included, come from the
//! same sweep as the torque of the law. What is left is linear in q̈: with δ the accelerations that q̈ adds, a body needs
//! w⁰ + I δ, and the outermost first
//!
//! ```text
//! I_A = I + Σ X I_a Xᵀ        p = w⁰ + Σ X p_a          over the children
//! U = I_A S,  D = Sᵀ U,  e = τ − Sᵀ p
//! I_a = I_A − U Uᵀ / D        p_a = p + U e / D
//! ```
//!
//! then outwards q̈ = (e − Uᵀ Xᵀδ_parent) / D, δ = Xᵀδ_parent + S q̈. This is Featherstone's recursion with the velocity
//! terms moved out of it.

use super::model::{Slot, Tree};
use super::motion::{Seat, Wrench};
use super::spatial::{Inertia, Mat3, Sym3, Vec3};
use super::{JointKind, TreeScratch};
use crate::robot::TwoVelocity;
use crate::{LengthError, Scalar};

/// What the way in leaves for the way out, and the inertia gathered so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Articulated<S> {
    inertia: Coupled<S>,
    /// U: moment and force per unit of joint acceleration.
    u: Wrench<S>,
    /// 1 / D
    inverse: S,
    /// e / D
    drive: S,
    /// δ: what q̈ adds to α and to a.
    delta: [Vec3<S>; 2],
}

impl<S: Scalar> Articulated<S> {
    pub(super) const ZERO: Self = Articulated {
        inertia: Coupled::ZERO,
        u: Wrench::ZERO,
        inverse: S::ZERO,
        drive: S::ZERO,
        delta: [Vec3::ZERO; 2],
    };
}

/// What a body hands to its parent: I_a and p_a about the parent's origin.
#[derive(Clone, Copy, Debug)]
struct Handed<S> {
    inertia: Coupled<S>,
    wrench: Wrench<S>,
}

impl<S: Scalar> Handed<S> {
    const ZERO: Self = Handed { inertia: Coupled::ZERO, wrench: Wrench::ZERO };
}

impl<S: Scalar> Articulated<S> {
    /// Lets the joint of this body go under `force`, and says what the parent feels, if there is one.
    #[inline(always)]
    fn release(&mut self, slot: &Slot<S>, carried: &Handed<S>, kind: JointKind, force: S, held: bool) -> Handed<S> {
        let inertia = self.inertia.plus(&carried.inertia);
        let reaction = self.drive(slot, carried, &inertia, kind, force, None);
        if !held {
            return Handed::ZERO;
        }
        let Seat { e, p } = slot.seat;
        let free = match kind {
            JointKind::Revolute => inertia.released_and_turned(&self.u, self.inverse, &e),
            JointKind::Prismatic => inertia.minus_outer(&self.u, self.inverse).turned(&e),
        };
        Handed { inertia: free.shifted(p), wrench: slot.seat.on_parent(&reaction) }
    }

    /// The same for a joint with an armature: what is left along it does not vanish.
    #[inline(always)]
    fn release_geared(
        &mut self,
        slot: &Slot<S>,
        carried: &Handed<S>,
        kind: JointKind,
        force: S,
        armature: S,
        held: bool,
    ) -> Handed<S> {
        let inertia = self.inertia.plus(&carried.inertia);
        let reaction = self.drive(slot, carried, &inertia, kind, force, Some(armature));
        if !held {
            return Handed::ZERO;
        }
        let Seat { e, p } = slot.seat;
        let free = inertia.minus_outer(&self.u, self.inverse).turned(&e);
        Handed { inertia: free.shifted(p), wrench: slot.seat.on_parent(&reaction) }
    }

    /// U, 1/(SᵀU + I_a) and what the joint does without the body that carries it; returns what reaches that body.
    #[inline(always)]
    fn drive(
        &mut self,
        slot: &Slot<S>,
        carried: &Handed<S>,
        inertia: &Coupled<S>,
        kind: JointKind,
        force: S,
        armature: Option<S>,
    ) -> Wrench<S> {
        let wrench = slot.wrench.plus(&carried.wrench);
        let u = inertia.column(kind);
        let along = armature.map_or(u.along(kind), |armature| u.along(kind) + armature);
        let inverse = S::splat(1.0) / along;
        let drive = (force - wrench.along(kind)) * inverse;
        self.u = u;
        self.inverse = inverse;
        self.drive = drive;
        Wrench { f: u.f.scaled_plus(drive, wrench.f), n: u.n.scaled_plus(drive, wrench.n) }
    }
}

/// An inertia with n = A α + H a and f = Hᵀ α + M a.
#[derive(Clone, Copy, Debug)]
struct Coupled<S> {
    a: Sym3<S>,
    h: Mat3<S>,
    m: Sym3<S>,
}

impl<S: Scalar> Coupled<S> {
    const ZERO: Self = Coupled { a: Sym3::ZERO, h: Mat3::ZERO, m: Sym3::ZERO };

    /// n = I α + h × a and f = m a − h × α.
    #[inline(always)]
    fn of(body: &Inertia<S>) -> Self {
        let Vec3 { x, y, z } = body.h;
        let zero = S::ZERO;
        Coupled {
            a: body.i,
            h: Mat3 { x: Vec3::new(zero, z, -y), y: Vec3::new(-z, zero, x), z: Vec3::new(y, -x, zero) },
            m: Sym3 { xx: body.m, yy: body.m, zz: body.m, ..Sym3::ZERO },
        }
    }

    #[inline(always)]
    fn plus(&self, b: &Self) -> Self {
        Coupled { a: self.a.plus(&b.a), h: self.h.plus(&b.h), m: self.m.plus(&b.m) }
    }

    /// U = I_A S
    #[inline(always)]
    fn column(&self, kind: JointKind) -> Wrench<S> {
        match kind {
            JointKind::Revolute => Wrench {
                n: Vec3::new(self.a.xz, self.a.yz, self.a.zz),
                f: Vec3::new(self.h.x.z, self.h.y.z, self.h.z.z),
            },
            JointKind::Prismatic => Wrench { n: self.h.z, f: Vec3::new(self.m.xz, self.m.yz, self.m.zz) },
        }
    }

    /// I_A − U Uᵀ k
    #[inline(always)]
    fn minus_outer(&self, u: &Wrench<S>, k: S) -> Self {
        let n = Vec3::new(-(u.n.x * k), -(u.n.y * k), -(u.n.z * k));
        Coupled {
            a: self.a.minus_outer(u.n, k),
            h: Mat3 {
                x: n.scaled_plus(u.f.x, self.h.x),
                y: n.scaled_plus(u.f.y, self.h.y),
                z: n.scaled_plus(u.f.z, self.h.z),
            },
            m: self.m.minus_outer(u.f, k),
        }
    }

    /// I_A − U Uᵀ k, turned by E, for a revolute joint: A − U Uᵀ k has no z row and column and H no z row, which saves a
    /// third of the work.
    #[inline(always)]
    fn released_and_turned(&self, u: &Wrench<S>, k: S, e: &Mat3<S>) -> Self {
        let (ux, uy) = (u.n.x * k, u.n.y * k);
        let (xx, xy) = (ux.neg_mul_add(u.n.x, self.a.xx), ux.neg_mul_add(u.n.y, self.a.xy));
        let yy = uy.neg_mul_add(u.n.y, self.a.yy);
        // Rows x and y of H.
        let hx = u.f.scaled_plus(-ux, Vec3::new(self.h.x.x, self.h.y.x, self.h.z.x));
        let hy = u.f.scaled_plus(-uy, Vec3::new(self.h.x.y, self.h.y.y, self.h.z.y));
        // E A, the columns x and y; then (E A) Eᵀ.
        let ax = e.y.scaled_plus(xy, e.x.scaled(xx));
        let ay = e.y.scaled_plus(yy, e.x.scaled(xy));
        let a = Sym3 {
            xx: ay.x.mul_add(e.y.x, ax.x * e.x.x),
            xy: ay.x.mul_add(e.y.y, ax.x * e.x.y),
            yy: ay.y.mul_add(e.y.y, ax.y * e.x.y),
            xz: ay.x.mul_add(e.y.z, ax.x * e.x.z),
            yz: ay.y.mul_add(e.y.z, ax.y * e.x.z),
            zz: ay.z.mul_add(e.y.z, ax.z * e.x.z),
        };
        // Rows of H Eᵀ, then E (H Eᵀ) column by column.
        let (hx, hy) = (e.times(hx), e.times(hy));
        let h = Mat3 {
            x: e.y.scaled_plus(hy.x, e.x.scaled(hx.x)),
            y: e.y.scaled_plus(hy.y, e.x.scaled(hx.y)),
            z: e.y.scaled_plus(hy.z, e.x.scaled(hx.z)),
        };
        Coupled { a, h, m: self.m.minus_outer(u.f, k).turned(e) }
    }

    /// The same for any joint.
    #[inline(always)]
    fn turned(&self, e: &Mat3<S>) -> Self {
        let h = e.product(&self.h.product(&e.transpose()));
        Coupled { a: self.a.turned(e), h, m: self.m.turned(e) }
    }

    /// About the origin of the parent, with the axes of the parent already.
    ///
    /// Turning all blocks by E leaves the shift α, a − \[p\]α of the arguments and n + \[p\]f of the results:
    /// M′ = M, H′ = H + \[p\]M, A′ = A − H\[p\] + \[p\]H′ᵀ, where −H\[p\] = (\[p\]Hᵀ)ᵀ.
    #[inline(always)]
    fn shifted(&self, p: Vec3<S>) -> Self {
        let Coupled { a, h, m } = self;
        let shifted = h.plus(&m.full().crossed_by(p));
        let left = h.transpose().crossed_by(p);
        let right = shifted.transpose().crossed_by(p);
        let a = Sym3 {
            xx: a.xx + (left.x.x + right.x.x),
            xy: a.xy + (left.x.y + right.y.x),
            yy: a.yy + (left.y.y + right.y.y),
            xz: a.xz + (left.x.z + right.z.x),
            yz: a.yz + (left.y.z + right.z.y),
            zz: a.zz + (left.z.z + right.z.z),
        };
        Coupled { a, h: shifted, m: *m }
    }
}

impl Tree {
    /// `ddq` solves M q̈ = τ − C q̇ − g − D q̇, less the friction where it is smooth.
    #[inline(always)]
    pub(super) fn articulated<S: Scalar>(
        &self,
        scratch: &mut TreeScratch<S>,
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        let n = self.bodies.len();
        LengthError::check("q", n, q.len())?;
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("theta", self.theta_len(), theta.len())?;
        LengthError::check("tau", n, tau.len())?;
        LengthError::check("ddq", n, ddq.len())?;
        LengthError::check("scratch", n, scratch.articulated.len())?;
        self.seat(scratch, q);
        let TreeScratch { slots, articulated, unit: still, column: drive, .. } = scratch;

        still.fill(S::ZERO);
        self.wrenches(slots, self.base(), TwoVelocity { q, dq, z: dq, dz: still }, theta);
        drive.copy_from_slice(tau);
        self.drives.resist(dq, &theta[self.body_parameters()..], drive);

        let inertias = theta.as_chunks::<10>().0;
        let mut i = 0;
        while i < n {
            articulated[i].inertia = Coupled::of(&self.bodies[i].inner(&inertias[i]));
            i += 1;
        }
        // Along a chain, what a body hands to its parent never waits for memory.
        let mut carried = Handed::ZERO;
        while i > 0 {
            i -= 1;
            let body = &self.bodies[i];
            let (slot, here) = (&slots[i + 1], &mut articulated[i]);
            let force = drive[i] * S::splat(body.sign);
            // One copy of the code per kind: a choice per number would cost more than the branch.
            let held = body.parent_slot > 0;
            let handed = match (body.kind, body.armature) {
                (JointKind::Revolute, None) => here.release(slot, &carried, JointKind::Revolute, force, held),
                (JointKind::Prismatic, None) => here.release(slot, &carried, JointKind::Prismatic, force, held),
                (kind, Some(at)) => here.release_geared(slot, &carried, kind, force, theta[at], held),
            };
            carried = Handed::ZERO;
            if body.parent_slot == i {
                carried = handed;
            } else if body.parent_slot > 0 {
                let (inertia, wrench) =
                    (&mut articulated[body.parent_slot - 1].inertia, &mut slots[body.parent_slot].wrench);
                *inertia = inertia.plus(&handed.inertia);
                *wrench = wrench.plus(&handed.wrench);
            }
        }
        while i < n {
            let body = &self.bodies[i];
            let seat = &slots[i + 1].seat;
            let Articulated { u, inverse, drive, .. } = &articulated[i];
            let [alpha, accel] = match body.parent_slot {
                0 => [Vec3::ZERO; 2],
                slot => articulated[slot - 1].delta,
            };
            let mut accel = seat.e.transpose_times(alpha.cross_plus(seat.p, accel));
            let mut alpha = seat.e.transpose_times(alpha);
            let resisted = u.n.dot(alpha) + u.f.dot(accel);
            let joint = resisted.neg_mul_add(*inverse, *drive);
            match body.kind {
                JointKind::Revolute => alpha.z = alpha.z + joint,
                JointKind::Prismatic => accel.z = accel.z + joint,
            }
            articulated[i].delta = [alpha, accel];
            ddq[i] = joint * S::splat(body.sign);
            i += 1;
        }
        Ok(())
    }
}
