//! The two-link planar arm in closed form.
//!
//! q₁ is measured from the horizontal, q₂ from the first link, gravity points down. With l_c the distance from joint to
//! centre of mass and I the inertia about it,
//!
//! ```text
//! ϑ = [ I₁ + I₂ + m₁ l_c₁² + m₂ (l₁² + l_c₂²),  I₂ + m₂ l_c₂²,  m₂ l₁ l_c₂,  g (m₁ l_c₁ + m₂ l₁),  g m₂ l_c₂ ]
//!
//! M = [ ϑ₁ + 2 ϑ₃ cos q₂    ϑ₂ + ϑ₃ cos q₂ ]     C = ϑ₃ sin q₂ [ −q̇₂   −(q̇₁ + q̇₂) ]     g = [ ϑ₄ cos q₁ + ϑ₅ cos(q₁+q₂) ]
//!     [ ϑ₂ + ϑ₃ cos q₂            ϑ₂       ]                   [  q̇₁        0       ]         [ ϑ₅ cos(q₁+q₂)             ]
//! ```

use alloc::vec;
use alloc::vec::Vec;

use super::enclosed::Enclosed;
use super::inertia_bound::{Definiteness, InertiaBound};
use super::{Lagrangian, TwoVelocity};
use crate::expression::Interval;
use crate::{LengthError, Scalar};

/// The two-link planar arm; all that distinguishes one from another is in ϑ, see [`PlanarLinks::theta`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanarArm;

/// Masses and lengths of a two-link planar arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarLinks {
    /// m₁, m₂ in kg.
    pub mass_kg: [f64; 2],
    /// l₁, l₂ in m.
    pub length_m: [f64; 2],
    /// l_c₁, l_c₂ in m, from the joint to the centre of mass.
    pub com_m: [f64; 2],
    /// I₁, I₂ in kg m², about the centre of mass.
    pub inertia_kg_m2: [f64; 2],
    /// g in m/s².
    pub gravity_m_s2: f64,
}

impl PlanarLinks {
    /// Two uniform rods: l_c = l/2, I = m l²/12, g = 9.81 m/s².
    pub fn uniform(mass_kg: [f64; 2], length_m: [f64; 2]) -> Self {
        let rod = |k: usize| mass_kg[k] * length_m[k] * length_m[k] / 12.0;
        PlanarLinks {
            mass_kg,
            length_m,
            com_m: [length_m[0] / 2.0, length_m[1] / 2.0],
            inertia_kg_m2: [rod(0), rod(1)],
            gravity_m_s2: 9.81,
        }
    }

    /// The five parameters ϑ of this arm.
    pub fn theta(&self) -> [f64; 5] {
        let ([m1, m2], [l1, _], [c1, c2], [i1, i2]) = (self.mass_kg, self.length_m, self.com_m, self.inertia_kg_m2);
        let g = self.gravity_m_s2;
        [
            i1 + i2 + m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2),
            i2 + m2 * c2 * c2,
            m2 * l1 * c2,
            g * (m1 * c1 + m2 * l1),
            g * m2 * c2,
        ]
    }
}

/// The tip of a planar arm whose links have the lengths `[l₁, l₂]`, m.
///
/// ```text
/// x = l₁ cos q₁ + l₂ cos(q₁+q₂)     y = l₁ sin q₁ + l₂ sin(q₁+q₂)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarTip {
    /// l₁, l₂ in m.
    pub length_m: [f64; 2],
}

impl PlanarTip {
    /// Jᵀw: the joint torques that do what the `force` (x, y) at the tip and the `moment` on the outer link do.
    pub fn torques<S: Scalar>(&self, q: [S; 2], force: [S; 2], moment: S) -> [S; 2] {
        let [inner, outer] = self.links(q);
        // Moments of the force about the elbow and, with the inner link as lever on top, about the shoulder.
        let elbow = outer[1].neg_mul_add(force[0], outer[0].mul_add(force[1], moment));
        [inner[1].neg_mul_add(force[0], inner[0].mul_add(force[1], elbow)), elbow]
    }

    /// Position and velocity of the tip, from the shoulder.
    pub fn motion<S: Scalar>(&self, q: [S; 2], dq: [S; 2]) -> ([S; 2], [S; 2]) {
        let [inner, outer] = self.links(q);
        let both = dq[0] + dq[1];
        let velocity = [-(inner[1].mul_add(dq[0], outer[1] * both)), inner[0].mul_add(dq[0], outer[0] * both)];
        ([inner[0] + outer[0], inner[1] + outer[1]], velocity)
    }

    /// The two links as vectors.
    fn links<S: Scalar>(&self, q: [S; 2]) -> [[S; 2]; 2] {
        let [l1, l2] = self.length_m.map(S::splat);
        let ((s1, c1), (s12, c12)) = (q[0].sin_cos(), (q[0] + q[1]).sin_cos());
        [[l1 * c1, l1 * s1], [l2 * c12, l2 * s12]]
    }
}

impl PlanarArm {
    /// A bound of M(q) for all q, from the five parameters; `None` where M is not positive definite everywhere.
    ///
    /// M is ½ (1 + cos q₂) M₊ + ½ (1 − cos q₂) M₋, a mean of what it is at q₂ = 0 and at q₂ = π. λ_min is concave, so it is least at
    /// one of the two and the bound is attained; A ↦ A⁻¹ is convex, so M⁻¹ is at most the same mean of the two inverses.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn inertia_bound(self, theta: &[f64]) -> Result<Option<InertiaBound>, LengthError> {
        LengthError::check("theta", 5, theta.len())?;
        let [t1, t2, t3] = [theta[0], theta[1], theta[2]].map(Interval::point);
        let ends = [t3, -t3].map(|half| [t1 + half + half, t2 + half, t2]);
        let mut least = f64::INFINITY;
        let mut inverses = Vec::with_capacity(2);
        for [m11, m12, m22] in ends {
            let determinant = t1 * t2 - t2 * t2 - t3 * t3;
            let by = |minor: Interval| minor / determinant;
            let whole = Enclosed::from_rows(2, vec![m11, m12, m12, m22]).and_then(|whole| whole.least());
            let Some(own) = whole else { return Ok(None) };
            least = least.min(own);
            inverses.extend(Enclosed::from_rows(2, vec![by(m22), by(-m12), by(-m12), by(m11)]));
        }
        Ok(InertiaBound::by_inverses(inverses).map(|bound| bound.at_least(least)))
    }

    /// Whether M(q) is positive definite uniformly. det M = ϑ₁ϑ₂ − ϑ₂² − ϑ₃² cos² q₂ is least where the arm is stretched.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn definiteness(self, theta: &[f64]) -> Result<Definiteness, LengthError> {
        let bound = self.inertia_bound(theta)?;
        let [t1, t2, t3] = [theta[0], theta[1], theta[2]].map(Interval::point);
        let stretched = Enclosed::from_rows(2, vec![t1 + t3 + t3, t2 + t3, t2 + t3, t2]);
        Ok(Definiteness::of(bound, &stretched.unwrap_or(Enclosed::zero(2))))
    }
}

/// The rows of Y, five columns each.
#[inline(always)]
fn rows<S: Scalar>(motion: TwoVelocity<'_, S>) -> [[S; 5]; 2] {
    let ([q1, q2], [dq1, dq2]) = ([motion.q[0], motion.q[1]], [motion.dq[0], motion.dq[1]]);
    let ([z1, z2], [dz1, dz2]) = ([motion.z[0], motion.z[1]], [motion.dz[0], motion.dz[1]]);
    let (sin2, cos2) = q2.sin_cos();
    let (_, cos1) = q1.sin_cos();
    let (_, cos12) = (q1 + q2).sin_cos();
    // ϑ₃: cos q₂ (2 ż₁ + ż₂) − sin q₂ (q̇₂ z₁ + (q̇₁ + q̇₂) z₂)  and  cos q₂ ż₁ + sin q₂ q̇₁ z₁
    let coriolis = dq2.mul_add(z1, (dq1 + dq2) * z2);
    let first = sin2.neg_mul_add(coriolis, cos2 * (dz1 + dz1 + dz2));
    let second = sin2.mul_add(dq1 * z1, cos2 * dz1);
    [[dz1, dz2, first, cos1, cos12], [S::ZERO, dz1 + dz2, second, S::ZERO, cos12]]
}

impl<S: Scalar> Lagrangian<S> for PlanarArm {
    type Scratch = ();

    fn dof(&self) -> usize {
        2
    }

    fn parameter_count(&self) -> usize {
        5
    }

    fn scratch(&self) {}

    #[inline(always)]
    fn regressor_products(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError> {
        motion.check(2)?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("s", 2, s.len())?;
        LengthError::check("y_theta", 2, y_theta.len())?;
        LengthError::check("yt_s", 5, yt_s.len())?;
        let [first, second] = rows(motion);
        let (mut a, mut b) = (S::ZERO, S::ZERO);
        let mut k = 0;
        while k < 5 {
            a = first[k].mul_add(theta[k], a);
            b = second[k].mul_add(theta[k], b);
            yt_s[k] = first[k].mul_add(s[0], second[k] * s[1]);
            k += 1;
        }
        y_theta[0] = a;
        y_theta[1] = b;
        Ok(())
    }

    #[inline(always)]
    fn forward_dynamics(
        &self,
        (): &mut (),
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError> {
        let still = [S::ZERO; 2];
        let motion = TwoVelocity { q, dq, z: dq, dz: &still };
        motion.check(2)?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("tau", 2, tau.len())?;
        LengthError::check("ddq", 2, ddq.len())?;
        let [first, second] = rows(motion);
        let (mut r1, mut r2) = (tau[0], tau[1]);
        let mut k = 2;
        while k < 5 {
            r1 = first[k].neg_mul_add(theta[k], r1);
            r2 = second[k].neg_mul_add(theta[k], r2);
            k += 1;
        }
        let [m11, m12, m22] = mass(q[1], theta);
        let inverse = S::splat(1.0) / m12.neg_mul_add(m12, m11 * m22);
        ddq[0] = m12.neg_mul_add(r2, m22 * r1) * inverse;
        ddq[1] = m12.neg_mul_add(r1, m11 * r2) * inverse;
        Ok(())
    }

    #[inline(always)]
    fn mass_matrix(&self, (): &mut (), q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 2, q.len())?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("mass matrix", 4, m.len())?;
        let [m11, m12, m22] = mass(q[1], theta);
        m.copy_from_slice(&[m11, m12, m12, m22]);
        Ok(())
    }

    fn coriolis_matrix(&self, (): &mut (), q: &[S], dq: &[S], theta: &[S], c: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 2, q.len())?;
        LengthError::check("dq", 2, dq.len())?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("Coriolis matrix", 4, c.len())?;
        let h = theta[2] * q[1].sin_cos().0;
        c.copy_from_slice(&[-(h * dq[1]), -(h * (dq[0] + dq[1])), h * dq[0], S::ZERO]);
        Ok(())
    }

    #[inline(always)]
    fn add_damping(
        &self,
        (): &mut (),
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError> {
        motion.check(2)?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("damping torque", 2, out.len())
    }

    fn gravity(&self, (): &mut (), q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 2, q.len())?;
        LengthError::check("theta", 5, theta.len())?;
        LengthError::check("gravity", 2, g.len())?;
        let elbow = theta[4] * (q[0] + q[1]).sin_cos().1;
        g[0] = theta[3].mul_add(q[0].sin_cos().1, elbow);
        g[1] = elbow;
        Ok(())
    }

    fn regressor(&self, (): &mut (), motion: TwoVelocity<'_, S>, y: &mut [S]) -> Result<(), LengthError> {
        motion.check(2)?;
        LengthError::check("regressor", 10, y.len())?;
        let [first, second] = rows(motion);
        y[..5].copy_from_slice(&first);
        y[5..].copy_from_slice(&second);
        Ok(())
    }

    fn adaptation_scale(&self, _q: &[f64], theta: &[f64]) -> Vec<f64> {
        // ϑ₁…ϑ₃ are inertias, m r²; ϑ₄, ϑ₅ are gravity torques, g m r. With M ≈ ϑ₁ the gravity columns act on M⁻¹YΓYᵀ as
        // Γ/ϑ₁ and the inertia columns as Γ z̈²/ϑ₁ with z̈ ≈ 1 rad/s².
        let m = theta.first().copied().unwrap_or(1.0);
        vec![m; 5]
    }
}

/// M₁₁, M₁₂, M₂₂.
#[inline(always)]
fn mass<S: Scalar>(q2: S, theta: &[S]) -> [S; 3] {
    let (_, cos2) = q2.sin_cos();
    let half = theta[2] * cos2;
    [theta[0] + half + half, theta[1] + half, theta[1]]
}
