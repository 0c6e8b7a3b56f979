//! A surface ship with three degrees of freedom, fully actuated: q = (x, y, ψ) in the earth frame.
//!
//! In the body, ν = Rᵀ q̇ with R = R(ψ) obeys M ν̇ + C(ν) ν + D ν = Rᵀ τ, with M = Mᵀ ≻ 0 (rigid body and added mass together)
//! and linear damping D. In the earth frame that is (1):
//!
//! ```text
//! M_q(ψ) q̈ + C_q(q, q̇) q̇ + D_q(ψ) q̇ = τ        M_q = R M Rᵀ        D_q = R D Rᵀ
//! M = [m₁₁ 0 0; 0 m₂₂ m₂₃; 0 m₂₃ m₃₃]          D = [d₁₁ 0 0; 0 d₂₂ d₂₃; 0 d₃₂ d₃₃]
//! ```
//!
//! **Coriolis terms.** Only ψ enters M_q. With R' = R J, J = [0 −1 0; 1 0 0; 0 0 0], its derivative is N = dM_q/dψ = R P Rᵀ,
//! P = J M − M J: P₁₂ = P₂₁ = m₁₁ − m₂₂, P₁₃ = P₃₁ = −m₂₃, all else zero. Christoffel's symbols then give, for any z,
//!
//! ```text
//! C_q(q, q̇) z = ½ [ψ̇ N z + z₃ N q̇ − e₃ zᵀ N q̇]
//! ```
//!
//! and Ṁ_q − 2 C_q is skew. With z in the place of q̇ the body's form is recovered: z = q̇, d̃ = Rᵀ q̈ = ν̇ + ψ̇ J ν.
//!
//! **Damping.** D_q q̇ is linear in ϑ and enters Y through z, as the damping of a joint does: the law compensates D_q z, and
//! V̇ = −sᵀ(K + ½ (D_q + D_qᵀ)) s, which asks for D + Dᵀ ⪰ 0.
//!
//! ψ is an angle that is not wrapped, and there is no current.

use alloc::vec;
use alloc::vec::Vec;

use super::enclosed::Enclosed;
use super::inertia_bound::{Definiteness, InertiaBound};
use super::{Lagrangian, TwoVelocity};
use crate::expression::Interval;
use crate::{LengthError, Scalar};

/// m₁₁, m₂₂, m₂₃, m₃₃, d₁₁, d₂₂, d₂₃, d₃₂, d₃₃.
const P: usize = 9;

/// How many of them are inertias.
const INERTIAS: usize = 4;

/// A fully actuated surface ship with ϑ = \[m₁₁, m₂₂, m₂₃, m₃₃, d₁₁, d₂₂, d₂₃, d₃₂, d₃₃\] in kg, kg m, kg m² and N s/m, N s,
/// N m s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ship;

impl Ship {
    /// A bound of M_q(ψ) for all ψ; `None` where M is not positive definite.
    ///
    /// R is a rotation, so the eigenvalues of M_q = R M Rᵀ are those of M at every ψ, and the bound is attained. With
    /// 2 |c y z| ≤ |c| (s y² + z²/s) for any s > 0, M⁻¹ is at most some diag(ν, ν, δ), which R leaves as it is.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn inertia_bound(self, theta: &[f64]) -> Result<Option<InertiaBound>, LengthError> {
        LengthError::check("theta", P, theta.len())?;
        let [m11, m22, m23, m33] = [theta[0], theta[1], theta[2], theta[3]].map(Interval::point);
        let Some(least) = in_body(theta).least() else { return Ok(None) };
        let determinant = m22 * m33 - m23 * m23;
        let (sway, both, yaw) = (m33 / determinant, m23 / determinant, m22 / determinant);
        let [both, share] = [both.size(), libm::sqrt(sway.high / yaw.high)].map(Interval::point);
        let plane = (sway + both * share).high.max((Interval::point(1.0) / m11).high);
        let inverse = Enclosed::diagonal(&[Interval::point(plane), Interval::point(plane), yaw + both / share]);
        Ok(InertiaBound::by_inverses(vec![inverse]).map(|bound| bound.at_least(least)))
    }

    /// Whether M_q(ψ) is positive definite uniformly.
    ///
    /// # Errors
    /// [`LengthError`] when `theta` has the wrong length.
    pub fn definiteness(self, theta: &[f64]) -> Result<Definiteness, LengthError> {
        Ok(Definiteness::of(self.inertia_bound(theta)?, &in_body(theta)))
    }
}

/// M, from all of ϑ.
fn in_body(theta: &[f64]) -> Enclosed {
    let [m11, m22, m23, m33] = [theta[0], theta[1], theta[2], theta[3]].map(Interval::point);
    let mut whole = Enclosed::diagonal(&[m11, m22, m33]);
    whole.set(2, 1, m23);
    whole
}

/// The axes of the body at one heading.
#[derive(Clone, Copy)]
struct Heading<S> {
    sin: S,
    cos: S,
}

impl<S: Scalar> Heading<S> {
    #[inline(always)]
    fn of(psi: S) -> Self {
        let (sin, cos) = psi.sin_cos();
        Heading { sin, cos }
    }

    /// Rᵀ v.
    #[inline(always)]
    fn to_body(self, v: &[S]) -> [S; 3] {
        [self.cos.mul_add(v[0], self.sin * v[1]), self.sin.neg_mul_add(v[0], self.cos * v[1]), v[2]]
    }

    /// R v.
    #[inline(always)]
    fn to_earth(self, v: [S; 3]) -> [S; 3] {
        [self.sin.neg_mul_add(v[1], self.cos * v[0]), self.sin.mul_add(v[0], self.cos * v[1]), v[2]]
    }
}

/// Rᵀ Y: the rows of the regressor in the axes of the body, from q̇, z and ż in them.
#[inline(always)]
fn rows<S: Scalar>(dq: [S; 3], z: [S; 3], dz: [S; 3]) -> [[S; P]; 3] {
    let (zero, half, r) = (S::ZERO, S::splat(0.5), dq[2]);
    // ½ (ψ̇ P z + z₃ P q̇ − e₃ zᵀ P q̇) for P₁₂ = P₂₁ = 1.
    let surge = half * r.mul_add(z[1], z[2] * dq[1]);
    let sway = half * r.mul_add(z[0], z[2] * dq[0]);
    let yaw = half * z[0].mul_add(dq[1], z[1] * dq[0]);
    [
        [dz[0] + surge, -surge, -(r * z[2]), zero, z[0], zero, zero, zero, zero],
        [sway, dz[1] - sway, dz[2], zero, zero, z[1], z[2], zero, zero],
        [-yaw, yaw, dz[1], dz[2], zero, zero, zero, z[1], z[2]],
    ]
}

/// Y ϑ in the axes of the body, over the first `count` parameters.
#[inline(always)]
fn times<S: Scalar>(rows: &[[S; P]; 3], theta: &[S], count: usize) -> [S; 3] {
    let mut out = [S::ZERO; 3];
    let mut k = 0;
    while k < count {
        let mut i = 0;
        while i < 3 {
            out[i] = rows[i][k].mul_add(theta[k], out[i]);
            i += 1;
        }
        k += 1;
    }
    out
}

impl<S: Scalar> Lagrangian<S> for Ship {
    type Scratch = ();

    fn dof(&self) -> usize {
        3
    }

    fn parameter_count(&self) -> usize {
        P
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
        motion.check(3)?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("s", 3, s.len())?;
        LengthError::check("y_theta", 3, y_theta.len())?;
        LengthError::check("yt_s", P, yt_s.len())?;
        let heading = Heading::of(motion.q[2]);
        let rows = rows(heading.to_body(motion.dq), heading.to_body(motion.z), heading.to_body(motion.dz));
        y_theta.copy_from_slice(&heading.to_earth(times(&rows, theta, P)));
        let s = heading.to_body(s);
        let mut k = 0;
        while k < P {
            yt_s[k] = rows[0][k].mul_add(s[0], rows[1][k].mul_add(s[1], rows[2][k] * s[2]));
            k += 1;
        }
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
        LengthError::check("q", 3, q.len())?;
        LengthError::check("dq", 3, dq.len())?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("tau", 3, tau.len())?;
        LengthError::check("ddq", 3, ddq.len())?;
        let heading = Heading::of(q[2]);
        let (velocity, tau) = (heading.to_body(dq), heading.to_body(tau));
        let held = times(&rows(velocity, velocity, [S::ZERO; 3]), theta, P);
        let net = [tau[0] - held[0], tau[1] - held[1], tau[2] - held[2]];
        let [m11, m22, m23, m33] = [theta[0], theta[1], theta[2], theta[3]];
        let inverse = S::splat(1.0) / m23.neg_mul_add(m23, m22 * m33);
        let sway = m23.neg_mul_add(net[2], m33 * net[1]) * inverse;
        let yaw = m23.neg_mul_add(net[1], m22 * net[2]) * inverse;
        ddq.copy_from_slice(&heading.to_earth([net[0] / m11, sway, yaw]));
        Ok(())
    }

    fn mass_matrix(&self, (): &mut (), q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 3, q.len())?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("mass matrix", 9, m.len())?;
        let still = [S::ZERO; 3];
        columns(q[2], m, |unit| times(&rows(still, still, unit), theta, INERTIAS));
        Ok(())
    }

    fn coriolis_matrix(&self, (): &mut (), q: &[S], dq: &[S], theta: &[S], c: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 3, q.len())?;
        LengthError::check("dq", 3, dq.len())?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("Coriolis matrix", 9, c.len())?;
        let velocity = Heading::of(q[2]).to_body(dq);
        columns(q[2], c, |unit| times(&rows(velocity, unit, [S::ZERO; 3]), theta, INERTIAS));
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
        motion.check(3)?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("damping torque", 3, out.len())?;
        let TwoVelocity { q, dq, z, .. } = motion;
        let heading = Heading::of(q[2]);
        let [u, v, r] = heading.to_body(&[dq[0] - z[0], dq[1] - z[1], dq[2] - z[2]]);
        let [d11, d22, d23, d32, d33] = [theta[4], theta[5], theta[6], theta[7], theta[8]];
        let damped = heading.to_earth([d11 * u, d22.mul_add(v, d23 * r), d32.mul_add(v, d33 * r)]);
        out[0] = out[0] + damped[0];
        out[1] = out[1] + damped[1];
        out[2] = out[2] + damped[2];
        Ok(())
    }

    fn gravity(&self, (): &mut (), q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError> {
        LengthError::check("q", 3, q.len())?;
        LengthError::check("theta", P, theta.len())?;
        LengthError::check("gravity", 3, g.len())?;
        g.fill(S::ZERO);
        Ok(())
    }

    fn regressor(&self, (): &mut (), motion: TwoVelocity<'_, S>, y: &mut [S]) -> Result<(), LengthError> {
        motion.check(3)?;
        LengthError::check("regressor", 3 * P, y.len())?;
        let heading = Heading::of(motion.q[2]);
        let rows = rows(heading.to_body(motion.dq), heading.to_body(motion.z), heading.to_body(motion.dz));
        for k in 0..P {
            let column = heading.to_earth([rows[0][k], rows[1][k], rows[2][k]]);
            for (i, entry) in column.into_iter().enumerate() {
                y[i * P + k] = entry;
            }
        }
        Ok(())
    }

    fn adaptation_scale(&self, _q: &[f64], theta: &[f64]) -> Vec<f64> {
        // Column k acts on M⁻¹ Y Γ Yᵀ as γ/m of the axes that it moves: forces by m₁₁ and m₂₂, moments by m₃₃, and what couples
        // sway and yaw by both.
        let inertia = |k: usize| theta.get(k).copied().filter(|m| *m > 0.0 && m.is_finite()).unwrap_or(1.0);
        let (surge, sway, yaw) = (inertia(0), inertia(1), inertia(3));
        let both = libm::sqrt(sway * yaw);
        vec![surge, sway, both, yaw, surge, sway, both, both, yaw]
    }
}

/// Fills a matrix of the earth frame column by column; `of` gives, in the axes of the body, what it makes of a vector in them.
fn columns<S: Scalar>(psi: S, matrix: &mut [S], of: impl Fn([S; 3]) -> [S; 3]) {
    let heading = Heading::of(psi);
    for j in 0..3 {
        let mut unit = [S::ZERO; 3];
        unit[j] = S::splat(1.0);
        let column = heading.to_earth(of(heading.to_body(&unit)));
        for (i, entry) in column.into_iter().enumerate() {
            matrix[3 * i + j] = entry;
        }
    }
}
