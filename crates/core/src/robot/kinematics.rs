//! Where the tip of a robot is and how it moves, when lengths are uncertain: (71), (72) and Property 4.
//!
//! With the true kinematic parameters θ or an estimate of them,
//!
//! ```text
//! x = f(q; θ)      ẋ = J(q; θ) q̇      J(q; θ) ξ = Z(q, ξ) θ + J(q; 0) ξ
//! ```
//!
//! The last term is what is known for certain; it vanishes when all of J is made of θ, and Property 4 stands as the paper
//! prints it. Only differences Ĵ − J enter the proof of Theorem 6, so the known part changes nothing there.
//!
//! **The rate of Ĵ** in (78) has two terms, because the estimate moves too:
//!
//! ```text
//! dĴ/dt = Σ_k (∂J/∂q_k)(q; θ̂) q̇_k + (J(q; θ̂') − J(q; 0))
//! ```
//!
//! Without the second one ż_r would not be the derivative of z_r, and V̇ of Theorem 6 would have a remainder.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use super::PlanarTip;
use crate::attitude::Quaternion;
use crate::{LengthError, trig};

/// What the Jacobian and its rate depend on.
#[derive(Clone, Copy, Debug)]
pub struct Posture<'a> {
    /// Joint positions q.
    pub q: &'a [f64],
    /// Joint velocities q̇.
    pub dq: &'a [f64],
    /// θ or θ̂.
    pub theta: &'a [f64],
    /// Its rate; zero for θ.
    pub d_theta: &'a [f64],
}

impl Posture<'_> {
    /// Checks all lengths.
    ///
    /// # Errors
    /// [`LengthError`] for the first that is wrong.
    pub fn check(&self, axes: usize, parameters: usize) -> Result<(), LengthError> {
        LengthError::check("q", axes, self.q.len())?;
        LengthError::check("dq", axes, self.dq.len())?;
        LengthError::check("kinematic parameters", parameters, self.theta.len())?;
        LengthError::check("rate of kinematic parameters", parameters, self.d_theta.len())
    }
}

/// A tip of which the position, or the position and the orientation, are to follow a target.
///
/// The rows of J are those of the position and, of a pose, three of the angular velocity in coordinates of the base. The latter hold
/// no length, so θ is in the former alone.
///
/// **Source**: (71), (72), Property 4; poses are not in the paper. Nothing panics, whatever the numbers.
pub trait TipKinematics: Send + Sync + 'static {
    /// n: joints of the robot, columns of J.
    fn joints(&self) -> usize;

    /// Coordinates of the position.
    fn axes(&self) -> usize;

    /// Whether the orientation is to follow too.
    fn turns(&self) -> bool;

    /// Rows of J: three more than coordinates of the position where the orientation is to follow.
    fn rows(&self) -> usize {
        self.axes() + if self.turns() { 3 } else { 0 }
    }

    /// Where the orientation is to follow: the quaternion of the tip in the base, **continuous** in q ∈ ℝⁿ, of norm one. It changes
    /// its sign with every full turn of a joint.
    fn attitude(&self, q: &[f64]) -> Option<Quaternion>;

    /// Length of θ.
    fn parameter_count(&self) -> usize;

    /// Names with units for the entries of θ.
    fn parameter_names(&self) -> Vec<String>;

    /// x = f(q; θ), the position, an entry per coordinate.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn position(&self, q: &[f64], theta: &[f64], x: &mut [f64]) -> Result<(), LengthError>;

    /// J(q; θ) and dJ/dt, row by row, [`TipKinematics::rows`] times n entries each.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn jacobian(&self, posture: Posture<'_>, j: &mut [f64], dj: &mut [f64]) -> Result<(), LengthError>;

    /// Z(q, ξ)ᵀ v, an entry per parameter, without forming Z; v has an entry per row of J.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn regressor_transposed(&self, q: &[f64], xi: &[f64], v: &[f64], zt_v: &mut [f64]) -> Result<(), LengthError>;
}

/// θ = [l₁, l₂], and nothing else is in J; the lengths of the value itself are not used.
///
/// ```text
/// J = [ −l₁ sin q₁ − l₂ sin(q₁+q₂)   −l₂ sin(q₁+q₂) ]      det J = l₁ l₂ sin q₂
///     [  l₁ cos q₁ + l₂ cos(q₁+q₂)    l₂ cos(q₁+q₂) ]
/// ```
impl TipKinematics for PlanarTip {
    fn joints(&self) -> usize {
        2
    }

    fn axes(&self) -> usize {
        2
    }

    fn turns(&self) -> bool {
        false
    }

    fn attitude(&self, _: &[f64]) -> Option<Quaternion> {
        None
    }

    fn parameter_count(&self) -> usize {
        2
    }

    fn parameter_names(&self) -> Vec<String> {
        vec!["length_1_m".into(), "length_2_m".into()]
    }

    fn position(&self, q: &[f64], theta: &[f64], x: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("q", 2, q.len())?;
        LengthError::check("kinematic parameters", 2, theta.len())?;
        LengthError::check("x", 2, x.len())?;
        let tip = PlanarTip { length_m: [theta[0], theta[1]] };
        x.copy_from_slice(&tip.motion([q[0], q[1]], [0.0; 2]).0);
        Ok(())
    }

    fn jacobian(&self, posture: Posture<'_>, j: &mut [f64], dj: &mut [f64]) -> Result<(), LengthError> {
        posture.check(2, 2)?;
        LengthError::check("Jacobian", 4, j.len())?;
        LengthError::check("rate of the Jacobian", 4, dj.len())?;
        let Posture { q, dq, theta: l, d_theta: dl } = posture;
        let ((s1, c1), (s12, c12)) = (trig::sine_and_cosine(q[0]), trig::sine_and_cosine(q[0] + q[1]));
        let both = dq[0] + dq[1];
        // The links as vectors and how these move; J turns them by a right angle.
        let (inner, outer) = ([l[0] * c1, l[0] * s1], [l[1] * c12, l[1] * s12]);
        let d_inner = [dl[0] * c1 - inner[1] * dq[0], dl[0] * s1 + inner[0] * dq[0]];
        let d_outer = [dl[1] * c12 - outer[1] * both, dl[1] * s12 + outer[0] * both];
        j.copy_from_slice(&[-inner[1] - outer[1], -outer[1], inner[0] + outer[0], outer[0]]);
        dj.copy_from_slice(&[-d_inner[1] - d_outer[1], -d_outer[1], d_inner[0] + d_outer[0], d_outer[0]]);
        Ok(())
    }

    fn regressor_transposed(&self, q: &[f64], xi: &[f64], v: &[f64], zt_v: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("q", 2, q.len())?;
        LengthError::check("xi", 2, xi.len())?;
        LengthError::check("v", 2, v.len())?;
        LengthError::check("kinematic gradient", 2, zt_v.len())?;
        let ((s1, c1), (s12, c12)) = (trig::sine_and_cosine(q[0]), trig::sine_and_cosine(q[0] + q[1]));
        zt_v[0] = xi[0] * (c1 * v[1] - s1 * v[0]);
        zt_v[1] = (xi[0] + xi[1]) * (c12 * v[1] - s12 * v[0]);
        Ok(())
    }
}
