//! Vectors, matrices and inertias of the kernels, on any scalar.
//!
//! Small enough to stay in registers, and nothing but explicit multiply-adds in a fixed order: that is what makes the
//! bits the same in every lane and on every instruction set.

use crate::Scalar;

/// A vector in ℝ³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vec3<S> {
    pub(super) x: S,
    pub(super) y: S,
    pub(super) z: S,
}

impl<S: Scalar> Vec3<S> {
    pub(super) const ZERO: Self = Vec3 { x: S::ZERO, y: S::ZERO, z: S::ZERO };

    #[inline(always)]
    pub(super) fn new(x: S, y: S, z: S) -> Self {
        Vec3 { x, y, z }
    }

    #[inline(always)]
    pub(super) fn splat([x, y, z]: [f64; 3]) -> Self {
        Vec3 { x: S::splat(x), y: S::splat(y), z: S::splat(z) }
    }

    #[inline(always)]
    pub(super) fn plus(self, b: Self) -> Self {
        Vec3 { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }

    /// self · k
    #[inline(always)]
    pub(super) fn scaled(self, k: S) -> Self {
        Vec3 { x: self.x * k, y: self.y * k, z: self.z * k }
    }

    /// self · k + b
    #[inline(always)]
    pub(super) fn scaled_plus(self, k: S, b: Self) -> Self {
        Vec3 { x: self.x.mul_add(k, b.x), y: self.y.mul_add(k, b.y), z: self.z.mul_add(k, b.z) }
    }

    #[inline(always)]
    pub(super) fn dot(self, b: Self) -> S {
        self.x.mul_add(b.x, self.y.mul_add(b.y, self.z * b.z))
    }

    #[inline(always)]
    pub(super) fn cross(self, b: Self) -> Self {
        Vec3 {
            x: self.z.neg_mul_add(b.y, self.y * b.z),
            y: self.x.neg_mul_add(b.z, self.z * b.x),
            z: self.y.neg_mul_add(b.x, self.x * b.y),
        }
    }

    /// self × b + c
    #[inline(always)]
    pub(super) fn cross_plus(self, b: Self, c: Self) -> Self {
        Vec3 {
            x: self.z.neg_mul_add(b.y, self.y.mul_add(b.z, c.x)),
            y: self.x.neg_mul_add(b.z, self.z.mul_add(b.x, c.y)),
            z: self.y.neg_mul_add(b.x, self.x.mul_add(b.y, c.z)),
        }
    }
}

/// A 3 × 3 matrix by its columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mat3<S> {
    pub(super) x: Vec3<S>,
    pub(super) y: Vec3<S>,
    pub(super) z: Vec3<S>,
}

impl<S: Scalar> Mat3<S> {
    pub(super) const ZERO: Self = Mat3 { x: Vec3::ZERO, y: Vec3::ZERO, z: Vec3::ZERO };

    /// From rows.
    #[inline(always)]
    pub(super) fn splat(rows: &[[f64; 3]; 3]) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = *rows;
        Mat3 { x: Vec3::splat([a, d, g]), y: Vec3::splat([b, e, h]), z: Vec3::splat([c, f, i]) }
    }

    /// self · v
    #[inline(always)]
    pub(super) fn times(&self, v: Vec3<S>) -> Vec3<S> {
        Vec3 {
            x: self.x.x.mul_add(v.x, self.y.x.mul_add(v.y, self.z.x * v.z)),
            y: self.x.y.mul_add(v.x, self.y.y.mul_add(v.y, self.z.y * v.z)),
            z: self.x.z.mul_add(v.x, self.y.z.mul_add(v.y, self.z.z * v.z)),
        }
    }

    /// self · v + c
    #[inline(always)]
    pub(super) fn times_plus(&self, v: Vec3<S>, c: Vec3<S>) -> Vec3<S> {
        self.x.scaled_plus(v.x, self.y.scaled_plus(v.y, self.z.scaled_plus(v.z, c)))
    }

    /// selfᵀ · v
    #[inline(always)]
    pub(super) fn transpose_times(&self, v: Vec3<S>) -> Vec3<S> {
        Vec3 { x: self.x.dot(v), y: self.y.dot(v), z: self.z.dot(v) }
    }

    #[inline(always)]
    pub(super) fn transpose(&self) -> Self {
        let Mat3 { x, y, z } = *self;
        Mat3 { x: Vec3::new(x.x, y.x, z.x), y: Vec3::new(x.y, y.y, z.y), z: Vec3::new(x.z, y.z, z.z) }
    }

    /// self · b
    #[inline(always)]
    pub(super) fn product(&self, b: &Self) -> Self {
        Mat3 { x: self.times(b.x), y: self.times(b.y), z: self.times(b.z) }
    }

    #[inline(always)]
    pub(super) fn plus(&self, b: &Self) -> Self {
        Mat3 { x: self.x.plus(b.x), y: self.y.plus(b.y), z: self.z.plus(b.z) }
    }

    /// \[p\]× · self, where \[p\]× v = p × v.
    #[inline(always)]
    pub(super) fn crossed_by(&self, p: Vec3<S>) -> Self {
        Mat3 { x: p.cross(self.x), y: p.cross(self.y), z: p.cross(self.z) }
    }
}

/// A symmetric 3 × 3 matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sym3<S> {
    pub(super) xx: S,
    pub(super) xy: S,
    pub(super) yy: S,
    pub(super) xz: S,
    pub(super) yz: S,
    pub(super) zz: S,
}

impl<S: Scalar> Sym3<S> {
    pub(super) const ZERO: Self = Sym3 { xx: S::ZERO, xy: S::ZERO, yy: S::ZERO, xz: S::ZERO, yz: S::ZERO, zz: S::ZERO };

    #[inline(always)]
    pub(super) fn full(&self) -> Mat3<S> {
        let Sym3 { xx, xy, yy, xz, yz, zz } = *self;
        Mat3 { x: Vec3::new(xx, xy, xz), y: Vec3::new(xy, yy, yz), z: Vec3::new(xz, yz, zz) }
    }

    #[inline(always)]
    pub(super) fn plus(&self, b: &Self) -> Self {
        Sym3 {
            xx: self.xx + b.xx,
            xy: self.xy + b.xy,
            yy: self.yy + b.yy,
            xz: self.xz + b.xz,
            yz: self.yz + b.yz,
            zz: self.zz + b.zz,
        }
    }

    /// e · self · eᵀ
    #[inline(always)]
    pub(super) fn turned(&self, e: &Mat3<S>) -> Self {
        // With G = self · eᵀ, the wanted e · G is symmetric and half of it is enough.
        let g = self.full().product(&e.transpose());
        let rows = e.transpose();
        Sym3 {
            xx: rows.x.dot(g.x),
            xy: rows.x.dot(g.y),
            yy: rows.y.dot(g.y),
            xz: rows.x.dot(g.z),
            yz: rows.y.dot(g.z),
            zz: rows.z.dot(g.z),
        }
    }

    /// self − v vᵀ · k
    #[inline(always)]
    pub(super) fn minus_outer(&self, v: Vec3<S>, k: S) -> Self {
        let (x, y, z) = (v.x * k, v.y * k, v.z * k);
        Sym3 {
            xx: x.neg_mul_add(v.x, self.xx),
            xy: x.neg_mul_add(v.y, self.xy),
            yy: y.neg_mul_add(v.y, self.yy),
            xz: x.neg_mul_add(v.z, self.xz),
            yz: y.neg_mul_add(v.z, self.yz),
            zz: z.neg_mul_add(v.z, self.zz),
        }
    }
}

/// The ten inertial parameters of one body, or the gradient of a number by them: m, h = m c and the rotational inertia
/// about the frame's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia<S> {
    pub(super) m: S,
    pub(super) h: Vec3<S>,
    pub(super) i: Sym3<S>,
}

impl<S: Scalar> Inertia<S> {
    pub(super) const ZERO: Self = Inertia { m: S::ZERO, h: Vec3::ZERO, i: Sym3::ZERO };

    #[inline(always)]
    pub(super) fn plus(&self, b: &Self) -> Self {
        Inertia { m: self.m + b.m, h: self.h.plus(b.h), i: self.i.plus(&b.i) }
    }

    /// The same body seen from a frame in which its own frame has orientation `e` and origin `p`.
    ///
    /// Points move as r′ = E r + p, so with I = −Σ m \[r\]²:  I′ = E I Eᵀ − \[p\]\[Eh\] − \[Eh\]\[p\] − m \[p\]², and
    /// \[a\]\[b\] = b aᵀ − (a·b) 1.
    #[inline(always)]
    pub(super) fn seen_from(&self, e: &Mat3<S>, p: Vec3<S>) -> Self {
        let eh = e.times(self.h);
        let i = self.i.turned(e);
        // Half of what m p adds: h̃ = Eh + m p / 2 gives −\[p\]\[h̃\] − \[h̃\]\[p\] in one go.
        let half = p.scaled_plus(S::splat(0.5) * self.m, eh);
        let (x, y, z) = (half.x * p.x, half.y * p.y, half.z * p.z);
        let twice = S::splat(2.0);
        Inertia {
            m: self.m,
            h: p.scaled_plus(self.m, eh),
            i: Sym3 {
                xx: twice.mul_add(y + z, i.xx),
                xy: half.x.neg_mul_add(p.y, half.y.neg_mul_add(p.x, i.xy)),
                yy: twice.mul_add(x + z, i.yy),
                xz: half.x.neg_mul_add(p.z, half.z.neg_mul_add(p.x, i.xz)),
                yz: half.y.neg_mul_add(p.z, half.z.neg_mul_add(p.y, i.yz)),
                zz: twice.mul_add(x + y, i.zz),
            },
        }
    }
}
