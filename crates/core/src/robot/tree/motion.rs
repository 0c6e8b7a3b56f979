//! How one body moves, what it takes to move it, and how that depends on its ten parameters.
//!
//! # The two-velocity torque without a regressor
//!
//! Write Γ(x, y) for the symmetric bilinear form with C(q, x) y = Γ(x, y) (Christoffel symbols are symmetric in their
//! last two indices). A standard recursion computes Γ(x, x); the one below computes Γ(q̇, z) by *polarising* it, that is
//! by replacing every product of two velocities by the mean of the two ways to take one factor from q̇ and one from z.
//! Hence also the identity
//! Y(q, q̇, z, ż) = Y(q, (q̇+z)/2, ż) − Y(q, (q̇−z)/2, 0)|g=0 with the standard regressors on the right.
//!
//! The material point at r of a body whose frame moves with angular velocity ω, angular acceleration α and whose origin
//! accelerates with a (the ordinary second derivative, not the spatial one) accelerates with a + α×r + ω×(ω×r).
//! Polarised with v the angular velocity due to q̇ and u that due to z this is a + B r with
//!
//! ```text
//! B = [α] + ½ ([v][u] + [u][v]) = [α] + ½ (u vᵀ + v uᵀ) − (u·v) 1
//! ```
//!
//! so that *no linear velocity is needed*. From parent (unprimed) to child with origin at p, orientation E, axis z:
//!
//! ```text
//! revolute    v′ = Eᵀv + z q̇     u′ = Eᵀu + z z_i     α′ = Eᵀα + z ż_i + ½ (v′×z z_i + u′×z q̇)     a′ = Eᵀ(a + B p)
//! prismatic   v′ = Eᵀv           u′ = Eᵀu             α′ = Eᵀα           a′ = Eᵀ(a + B p) + z ż_i + (v′×z z_i + u′×z q̇)
//! ```
//!
//! Summing (a + B r) dm and r × (a + B r) dm over the body gives force and moment about the origin, linear in m, h and I:
//!
//! ```text
//! f = m a + B h          n = h × a + ∫ r × (B r) dm
//! ```
//!
//! and the power of the test motion that s drives (angular velocity σ, velocity w of the origin; linear in s) is
//! w·f + σ·n = sᵀ Y ϑ. Its gradient by (m, h, I) is the body's part of Yᵀs, and f, n folded back along the tree give Yϑ:
//! O(n), for any ϑ, and Y is never formed.

use super::model::{Body, JointKind};
use super::spatial::{Inertia, Mat3, Sym3, Vec3};
use crate::Scalar;

/// The pose of a body's inner frame in that of its parent, at the present joint position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat<S> {
    pub(super) e: Mat3<S>,
    pub(super) p: Vec3<S>,
}

impl<S: Scalar> Seat<S> {
    pub(super) const AT_PARENT: Self = Seat { e: Mat3::ZERO, p: Vec3::ZERO };

    #[inline(always)]
    pub(super) fn of(body: &Body, q: S, sin: S, cos: S) -> Self {
        let Mat3 { x, y, z }: Mat3<S> = Mat3::splat(&body.rotation);
        let p = Vec3::splat(body.translation);
        let sign = S::splat(body.sign);
        match body.kind {
            JointKind::Revolute => {
                let sin = sin * sign;
                let turned_x =
                    Vec3::new(y.x.mul_add(sin, x.x * cos), y.y.mul_add(sin, x.y * cos), y.z.mul_add(sin, x.z * cos));
                let turned_y = Vec3::new(
                    x.x.neg_mul_add(sin, y.x * cos),
                    x.y.neg_mul_add(sin, y.y * cos),
                    x.z.neg_mul_add(sin, y.z * cos),
                );
                Seat { e: Mat3 { x: turned_x, y: turned_y, z }, p }
            }
            JointKind::Prismatic => Seat { e: Mat3 { x, y, z }, p: z.scaled_plus(q * sign, p) },
        }
    }

    /// A wrench about the child's origin in the child's axes, as one about the parent's origin in the parent's axes.
    #[inline(always)]
    pub(super) fn on_parent(&self, wrench: &Wrench<S>) -> Wrench<S> {
        let f = self.e.times(wrench.f);
        Wrench { f, n: self.p.cross_plus(f, self.e.times(wrench.n)) }
    }
}

/// The rates of one joint, in the direction of inner +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates<S> {
    pub(super) dq: S,
    /// z / 2
    pub(super) half_z: S,
    pub(super) dz: S,
}

/// Velocities and accelerations of a body in its inner frame; see the head of this file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<S> {
    /// v: angular velocity due to q̇.
    pub(super) omega: Vec3<S>,
    /// u / 2: half the angular velocity due to z.
    pub(super) half_u: Vec3<S>,
    /// α
    pub(super) alpha: Vec3<S>,
    /// a: acceleration of the origin, gravity included.
    pub(super) accel: Vec3<S>,
    /// The symmetric part of B.
    pub(super) centripetal: Sym3<S>,
    /// B
    pub(super) field: Mat3<S>,
    /// σ: angular velocity due to s.
    pub(super) turn: Vec3<S>,
    /// w: velocity of the origin due to s.
    pub(super) slide: Vec3<S>,
}

impl<S: Scalar> Motion<S> {
    pub(super) const STILL: Self = Motion {
        omega: Vec3::ZERO,
        half_u: Vec3::ZERO,
        alpha: Vec3::ZERO,
        accel: Vec3::ZERO,
        centripetal: Sym3::ZERO,
        field: Mat3::ZERO,
        turn: Vec3::ZERO,
        slide: Vec3::ZERO,
    };

    /// The motion of the body that sits on this one by a joint of this kind.
    #[inline(always)]
    pub(super) fn child(&self, seat: &Seat<S>, kind: JointKind, rates: Rates<S>) -> Self {
        let Rates { dq, half_z, dz } = rates;
        let mut omega = seat.e.transpose_times(self.omega);
        let mut half_u = seat.e.transpose_times(self.half_u);
        let mut alpha = seat.e.transpose_times(self.alpha);
        let mut accel = seat.e.transpose_times(self.field.times_plus(seat.p, self.accel));
        // ½ (v×z z_i + u×z q̇), where (x, y, ·) × z = (y, −x, 0).
        let cross_x = omega.y.mul_add(half_z, half_u.y * dq);
        let cross_y = omega.x.mul_add(half_z, half_u.x * dq);
        match kind {
            JointKind::Revolute => {
                omega.z = omega.z + dq;
                half_u.z = half_u.z + half_z;
                alpha = Vec3::new(alpha.x + cross_x, alpha.y - cross_y, alpha.z + dz);
            }
            JointKind::Prismatic => {
                accel = Vec3::new(accel.x + (cross_x + cross_x), accel.y - (cross_y + cross_y), accel.z + dz);
            }
        }
        let (v, u) = (omega, half_u);
        let (xx, yy, zz) = (v.x * u.x, v.y * u.y, v.z * u.z);
        let (yz, xz, xy) = (yy + zz, xx + zz, xx + yy);
        let centripetal = Sym3 {
            xx: -(yz + yz),
            xy: v.x.mul_add(u.y, v.y * u.x),
            yy: -(xz + xz),
            xz: v.x.mul_add(u.z, v.z * u.x),
            yz: v.y.mul_add(u.z, v.z * u.y),
            zz: -(xy + xy),
        };
        let c = &centripetal;
        let field = Mat3 {
            x: Vec3::new(c.xx, c.xy + alpha.z, c.xz - alpha.y),
            y: Vec3::new(c.xy - alpha.z, c.yy, c.yz + alpha.x),
            z: Vec3::new(c.xz + alpha.y, c.yz - alpha.x, c.zz),
        };
        Motion { omega, half_u, alpha, accel, centripetal, field, turn: Vec3::ZERO, slide: Vec3::ZERO }
    }

    /// Adds the test motion due to s.
    #[inline(always)]
    pub(super) fn with_test(mut self, parent: &Self, seat: &Seat<S>, kind: JointKind, s: S) -> Self {
        self.turn = seat.e.transpose_times(parent.turn);
        self.slide = seat.e.transpose_times(parent.turn.cross_plus(seat.p, parent.slide));
        match kind {
            JointKind::Revolute => self.turn.z = self.turn.z + s,
            JointKind::Prismatic => self.slide.z = self.slide.z + s,
        }
        self
    }

    /// The force and moment that this motion takes.
    ///
    /// With the second moments Σ = ½ tr(I) 1 − I the moment ∫ r × (B r) dm has x = (BΣ)_zy − (BΣ)_yz, which in terms of
    /// I and of the symmetric part c of B is
    /// α_x I_xx + c_yz (I_zz − I_yy) − B_zx I_xy + B_yx I_xz + (B_yy − B_zz) I_yz; y and z by cyclic renaming.
    #[inline(always)]
    pub(super) fn wrench(&self, body: &Inertia<S>) -> Wrench<S> {
        let Inertia { m, h, i } = *body;
        let (b, c, alpha) = (&self.field, &self.centripetal, self.alpha);
        let f = self.accel.scaled_plus(m, b.times(h));
        let quadratic = Vec3 {
            x: alpha.x.mul_add(
                i.xx,
                c.yz.mul_add(i.zz - i.yy, b.x.z.neg_mul_add(i.xy, b.x.y.mul_add(i.xz, (b.y.y - b.z.z) * i.yz))),
            ),
            y: alpha.y.mul_add(
                i.yy,
                c.xz.mul_add(i.xx - i.zz, b.y.x.neg_mul_add(i.yz, b.y.z.mul_add(i.xy, (b.z.z - b.x.x) * i.xz))),
            ),
            z: alpha.z.mul_add(
                i.zz,
                c.xy.mul_add(i.yy - i.xx, b.z.y.neg_mul_add(i.xz, b.z.x.mul_add(i.yz, (b.x.x - b.y.y) * i.xy))),
            ),
        };
        Wrench { f, n: h.cross_plus(self.accel, quadratic) }
    }

    /// The gradient of w·f + σ·n by the parameters: the coefficients of m, h and I in [`Motion::wrench`].
    #[inline(always)]
    pub(super) fn gradient(&self) -> Inertia<S> {
        let (b, c, alpha, s) = (&self.field, &self.centripetal, self.alpha, self.turn);
        Inertia {
            m: self.slide.dot(self.accel),
            // w·(B h) + σ·(h × a) = h·(Bᵀw + a × σ)
            h: self.accel.cross_plus(s, b.transpose_times(self.slide)),
            i: Sym3 {
                xx: s.x.mul_add(alpha.x, s.z.neg_mul_add(c.xy, s.y * c.xz)),
                xy: s.z.mul_add(b.x.x - b.y.y, s.x.neg_mul_add(b.x.z, s.y * b.y.z)),
                yy: s.y.mul_add(alpha.y, s.x.neg_mul_add(c.yz, s.z * c.xy)),
                xz: s.y.mul_add(b.z.z - b.x.x, s.z.neg_mul_add(b.z.y, s.x * b.x.y)),
                yz: s.x.mul_add(b.y.y - b.z.z, s.y.neg_mul_add(b.y.x, s.z * b.z.x)),
                zz: s.z.mul_add(alpha.z, s.y.neg_mul_add(c.xz, s.x * c.yz)),
            },
        }
    }
}

/// Force, and moment about the frame's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wrench<S> {
    pub(super) f: Vec3<S>,
    pub(super) n: Vec3<S>,
}

impl<S: Scalar> Wrench<S> {
    pub(super) const ZERO: Self = Wrench { f: Vec3::ZERO, n: Vec3::ZERO };

    #[inline(always)]
    pub(super) fn plus(&self, b: &Self) -> Self {
        Wrench { f: self.f.plus(b.f), n: self.n.plus(b.n) }
    }

    /// The part that the joint's drive has to provide.
    #[inline(always)]
    pub(super) fn along(&self, kind: JointKind) -> S {
        match kind {
            JointKind::Revolute => self.n.z,
            JointKind::Prismatic => self.f.z,
        }
    }
}
