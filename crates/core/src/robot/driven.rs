//! A robot in closed form with what acts at its joints: damping, rotors and friction beside an inner model that knows none.
//!
//! ϑ is that of the inner model, then dampings, armatures and frictions, as for a tree. With A = diag of the armatures and r what the
//! drives take, the plant and the law are
//!
//! ```text
//! (M + A) q̈ = τ − C q̇ − g − r(q̇)          Y ϑ = Y₀ ϑ₀ + A ż + D z + F tanh(z/ε)
//! ```
//!
//! A is constant and brings nothing into C, so Ṁ − 2C stays skew, and M + A ⪰ M: what bounds M from below bounds both. Without an
//! armature the inner model's own forward dynamics are asked; with one, M + A = L Δ Lᵀ is solved, which needs no pivots where it is positive
//! definite.

use alloc::vec;
use alloc::vec::Vec;

use super::{Definiteness, DriveError, Drives, Lagrangian, TwoVelocity};
use crate::{LengthError, Scalar};

/// The robot `K` with drives.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven<K> {
    inner: K,
    axes: usize,
    /// How many parameters the inner model has.
    first: usize,
    drives: Drives,
}

/// Working memory of a driven robot.
#[derive(Clone, Debug)]
pub struct DrivenScratch<S, I> {
    inner: I,
    /// M + A, then its factors.
    mass: Vec<S>,
    /// τ less what the drives take, or C q̇ + g.
    torque: Vec<S>,
    still: Vec<S>,
    /// Yᵀs or a row of Y of the inner model.
    columns: Vec<S>,
}

impl<K> Driven<K> {
    /// `inner`, which has no drives of its own, with `drives`.
    ///
    /// # Errors
    /// [`DriveError`] when a joint does not exist or is out of order, or a width is not positive.
    pub fn new(inner: K, drives: Drives) -> Result<Self, DriveError>
    where
        K: Lagrangian<f64>,
    {
        let (axes, first) = (inner.dof(), inner.parameter_count());
        drives.check(axes)?;
        Ok(Driven { inner, axes, first, drives })
    }

    /// The robot without them.
    pub fn inner(&self) -> &K {
        &self.inner
    }

    /// What acts at its joints.
    pub fn drives(&self) -> &Drives {
        &self.drives
    }

    /// Length of ϑ.
    #[inline(always)]
    fn theta_len(&self) -> usize {
        self.first + self.drives.count()
    }

    /// Whether M + A is positive definite uniformly, by what `inner` says of M: a bound of M is one of M + A ⪰ M.
    pub fn definiteness(&self, inner: Definiteness) -> Definiteness {
        match inner {
            Definiteness::Not { q, .. } if !self.drives.geared.is_empty() => Definiteness::Unknown { q, least: 0.0 },
            found => found,
        }
    }

    /// ϑ of the inner model, and the parameters of the drives.
    #[inline(always)]
    fn parts<'a, S>(&self, theta: &'a [S]) -> Result<(&'a [S], &'a [S]), LengthError> {
        LengthError::check("theta", self.theta_len(), theta.len())?;
        Ok(theta.split_at(self.first))
    }
}

impl<S: Scalar, K: Lagrangian<S> + Lagrangian<f64>> Lagrangian<S> for Driven<K> {
    type Scratch = DrivenScratch<S, <K as Lagrangian<S>>::Scratch>;

    fn dof(&self) -> usize {
        self.axes
    }

    fn parameter_count(&self) -> usize {
        self.theta_len()
    }

    fn scratch(&self) -> Self::Scratch {
        let n = self.axes;
        let each = || vec![S::ZERO; n];
        DrivenScratch {
            inner: Lagrangian::<S>::scratch(&self.inner),
            mass: vec![S::ZERO; n * n],
            torque: each(),
            still: each(),
            columns: vec![S::ZERO; self.first],
        }
    }

    #[inline(always)]
    fn regressor_products(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        let (inner, own) = self.parts(theta)?;
        LengthError::check("yt_s", self.theta_len(), yt_s.len())?;
        let (bodies, drives) = yt_s.split_at_mut(self.first);
        self.inner.regressor_products(&mut scratch.inner, motion, inner, s, y_theta, bodies)?;
        self.drives.add(motion, own, y_theta);
        self.drives.pair(motion, s, drives);
        Ok(())
    }

    #[inline(always)]
    fn forward_dynamics(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        let (inner, own) = self.parts(theta)?;
        let (n, drives) = (self.axes, &self.drives);
        LengthError::check("dq", n, dq.len())?;
        LengthError::check("tau", n, tau.len())?;
        LengthError::check("ddq", n, ddq.len())?;
        LengthError::check("scratch", n, scratch.torque.len())?;
        let DrivenScratch { inner: inside, mass, torque, still, columns } = scratch;
        if drives.geared.is_empty() {
            torque.copy_from_slice(tau);
            drives.resist(dq, own, torque);
            return self.inner.forward_dynamics(inside, q, dq, inner, torque, ddq);
        }
        still.fill(S::ZERO);
        let motion = TwoVelocity { q, dq, z: dq, dz: still };
        self.inner.regressor_products(inside, motion, inner, still, torque, columns)?;
        for ((ddq, tau), taken) in ddq.iter_mut().zip(tau).zip(torque.iter()) {
            *ddq = *tau - *taken;
        }
        drives.resist(dq, own, ddq);
        self.inner.mass_matrix(inside, q, inner, mass)?;
        drives.weigh(n, own, mass);
        solve(n, mass, ddq);
        Ok(())
    }

    #[inline(always)]
    fn mass_matrix(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        let (inner, own) = self.parts(theta)?;
        self.inner.mass_matrix(&mut scratch.inner, q, inner, m)?;
        self.drives.weigh(self.axes, own, m);
        Ok(())
    }

    fn coriolis_matrix(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        c: &mut [S],
    ) -> Result<(), LengthError> {
        self.inner.coriolis_matrix(&mut scratch.inner, q, dq, self.parts(theta)?.0, c)
    }

    #[inline(always)]
    fn add_damping(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        let (inner, own) = self.parts(theta)?;
        self.inner.add_damping(&mut scratch.inner, motion, inner, out)?;
        self.drives.add_losses(motion, own, out);
        Ok(())
    }

    fn gravity(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        self.inner.gravity(&mut scratch.inner, q, self.parts(theta)?.0, g)
    }

    fn regressor(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        y: &mut [S],
    ) -> Result<(), LengthError> {
        let (n, first, width) = (self.axes, self.first, self.theta_len());
        motion.check(n)?;
        LengthError::check("regressor", n * width, y.len())?;
        let mut inner = vec![S::ZERO; n * first];
        self.inner.regressor(&mut scratch.inner, motion, &mut inner)?;
        let mut along = vec![S::ZERO; n];
        for i in 0..n {
            let row = &mut y[i * width..(i + 1) * width];
            row[..first].copy_from_slice(&inner[i * first..(i + 1) * first]);
            along.fill(S::ZERO);
            along[i] = S::splat(1.0);
            self.drives.pair(motion, &along, &mut row[first..]);
        }
        Ok(())
    }

    /// That of the inner model; M_jj(q) for dampings and armatures, as ż ≈ 1 rad/s² has it, and 0.16 s² F for frictions.
    fn adaptation_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64> {
        let (inner, own) = theta.split_at(self.first.min(theta.len()));
        let mut scale = Lagrangian::<f64>::adaptation_scale(&self.inner, q, inner);
        let mut mass = vec![0.0; self.axes * self.axes];
        // A wrong length leaves zeros, for which the scale of the first parameter stands, an inertia.
        let _ = self.inner.mass_matrix(&mut Lagrangian::<f64>::scratch(&self.inner), q, inner, &mut mass);
        let usable = |x: f64| (x > 0.0 && x.is_finite()).then_some(x);
        let fallback = scale.first().copied().and_then(usable).unwrap_or(1.0);
        let inertia = |joint: usize| mass.get(joint * (self.axes + 1)).copied().and_then(usable).unwrap_or(fallback);
        scale.extend(self.drives.scales(own, inertia, inertia, fallback));
        scale
    }
}

/// Solves `m` x = b in place for a symmetric `m`, of which the lower triangle is read, by m = L Δ Lᵀ.
#[inline(always)]
fn solve<S: Scalar>(n: usize, m: &mut [S], x: &mut [S]) {
    let mut j = 0;
    while j < n {
        let inverse = S::splat(1.0) / m[j * (n + 1)];
        let mut i = j + 1;
        while i < n {
            let factor = m[i * n + j] * inverse;
            let mut k = j + 1;
            while k <= i {
                m[i * n + k] = factor.neg_mul_add(m[k * n + j], m[i * n + k]);
                k += 1;
            }
            x[i] = factor.neg_mul_add(x[j], x[i]);
            i += 1;
        }
        // Later columns read this one unscaled, so it is scaled when they are done with it.
        let mut i = j + 1;
        while i < n {
            m[i * n + j] = m[i * n + j] * inverse;
            i += 1;
        }
        x[j] = x[j] * inverse;
        j += 1;
    }
    while j > 0 {
        j -= 1;
        let mut i = j + 1;
        while i < n {
            x[j] = m[i * n + j].neg_mul_add(x[i], x[j]);
            i += 1;
        }
    }
}
