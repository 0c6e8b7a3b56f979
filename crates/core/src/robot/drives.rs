//! What acts at the joints of a robot besides its bodies: damping, rotors and Coulomb friction.
//!
//! **Rotors.** One that turns n times as fast as its joint and has the inertia J about its own axis brings the kinetic energy
//! ½ n²J q̇² (the products of its own and the carrying body's rates, smaller by 1/n, are left out, as usual). The armature n²J is
//! added to the diagonal of M and is constant, so that it brings nothing into C: Ṁ − 2C stays skew, M stays positive definite,
//! and its column of Y is ż.
//!
//! **Coulomb friction** F σ, σ ∈ Sgn q̇. Its column of Y is tanh(z/ε) with a width ε that is chosen: a function of the reference
//! velocity, which is smooth, so that it closes no fast loop. The error of the law loses
//!
//! ```text
//! smooth plant, F tanh(q̇/ε):   sᵀF [tanh(q̇/ε) − tanh(z/ε)] ≥ 0     since tanh rises and s = q̇ − z
//! dry plant, F σ:               sᵀF [σ − tanh(z/ε)] ≥ −κ ε ΣF        κ = max x (1 − tanh x) = 0.2785
//! ```
//!
//! beside sᵀ(K + D)s. The first is what the theorems need. The second, joint by joint: let q̇ > 0, so that σ = 1. For s ≥ 0 the product
//! is not negative. For s < 0, z = q̇ − s > 0 and −s < z, hence s (1 − tanh(z/ε)) ≥ −z (1 − tanh(z/ε)) ≥ −κ ε. For q̇ < 0 all signs
//! turn. Where the joint sticks, s = −z, and s (σ − tanh(z/ε)) ≥ −|z| (1 − tanh(|z|/ε)) ≥ −κ ε for whatever σ in \[−1, 1\].
//!
//! All three are linear in their parameters, which close ϑ: dampings, armatures, frictions, each in the order of the joints.

use alloc::vec::Vec;
use core::ops::Range;

use super::TwoVelocity;
use crate::Scalar;

/// max x (1 − tanh x), rounded up.
pub const SMOOTHING_LOSS: f64 = 0.278_464_543;

/// Coulomb friction at a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// The joint.
    pub joint: usize,
    /// ε, rad/s or m/s; positive.
    pub width: f64,
}

/// What acts at the joints of a robot. By default nothing does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drives {
    /// The joints with viscous damping.
    pub damped: Vec<usize>,
    /// The joints with an armature.
    pub geared: Vec<usize>,
    /// The joints with Coulomb friction.
    pub friction: Vec<Friction>,
    /// The friction of the plant is set-valued: [`Lagrangian::forward_dynamics`](super::Lagrangian::forward_dynamics) leaves it to
    /// [`Stick`](super::Stick), which holds it over periods of so many seconds at most. Otherwise it is F tanh(q̇/ε).
    pub dry_s: Option<f64>,
}

/// Why drives have no meaning.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// There is no such joint.
    #[error("there is no joint {joint}: the robot has {joints}")]
    NoJoint {
        /// The joint.
        joint: usize,
        /// How many joints there are.
        joints: usize,
    },
    /// Joints do not follow one another.
    #[error("joint {joint} is named twice, or after a later one")]
    Order {
        /// The joint.
        joint: usize,
    },
    /// A period is not positive.
    #[error("dry friction is held over periods of {period_s} s, which must be positive and finite")]
    Period {
        /// The period, s.
        period_s: f64,
    },
    /// A width is not positive.
    #[error("the width of the friction of joint {joint} is {width}, but must be positive and finite")]
    Width {
        /// The joint.
        joint: usize,
        /// ε.
        width: f64,
    },
}

impl Drives {
    /// How many parameters they have.
    pub fn count(&self) -> usize {
        self.damped.len() + self.geared.len() + self.friction.len()
    }

    /// Where the dampings, the armatures and the frictions stand among their parameters.
    #[inline(always)]
    pub fn ranges(&self) -> [Range<usize>; 3] {
        let armature = self.damped.len();
        let friction = armature + self.geared.len();
        [0..armature, armature..friction, friction..friction + self.friction.len()]
    }

    /// Where the dampings, the armatures and the frictions stand in a ϑ of so many entries, which they close; `None` when it is too short.
    pub fn ranges_in(&self, theta_len: usize) -> Option<[Range<usize>; 3]> {
        let first = theta_len.checked_sub(self.count())?;
        Some(self.ranges().map(|own| first + own.start..first + own.end))
    }

    /// Checks that they have a meaning for a robot with so many joints.
    ///
    /// # Errors
    /// [`DriveError`] when a joint does not exist or is out of order, or a width or the period is not positive.
    pub fn check(&self, joints: usize) -> Result<(), DriveError> {
        let frictions: Vec<usize> = self.friction.iter().map(|friction| friction.joint).collect();
        for list in [&self.damped, &self.geared, &frictions] {
            let mut least = 0;
            for &joint in list {
                match joint {
                    _ if joint >= joints => return Err(DriveError::NoJoint { joint, joints }),
                    _ if joint < least => return Err(DriveError::Order { joint }),
                    _ => least = joint + 1,
                }
            }
        }
        let usable = |x: f64| x > 0.0 && x.is_finite();
        if let Some(&Friction { joint, width }) = self.friction.iter().find(|friction| !usable(friction.width)) {
            return Err(DriveError::Width { joint, width });
        }
        match self.dry_s.filter(|period_s| !usable(*period_s)) {
            Some(period_s) => Err(DriveError::Period { period_s }),
            None => Ok(()),
        }
    }

    /// Adds D z, I_a ż and F tanh(z/ε) to `y_theta`. `theta` holds their parameters alone, here and below.
    #[inline(always)]
    pub(super) fn add<S: Scalar>(&self, motion: TwoVelocity<'_, S>, theta: &[S], y_theta: &mut [S]) {
        let [damping, armature, friction] = self.ranges();
        for (own, joint) in theta[damping].iter().zip(&self.damped) {
            y_theta[*joint] = own.mul_add(motion.z[*joint], y_theta[*joint]);
        }
        for (own, joint) in theta[armature].iter().zip(&self.geared) {
            y_theta[*joint] = own.mul_add(motion.dz[*joint], y_theta[*joint]);
        }
        for (own, Friction { joint, width }) in theta[friction].iter().zip(&self.friction) {
            y_theta[*joint] = own.mul_add(smoothed(motion.z[*joint], *width), y_theta[*joint]);
        }
    }

    /// The entries of Yᵀs for their parameters.
    #[inline(always)]
    pub(super) fn pair<S: Scalar>(&self, motion: TwoVelocity<'_, S>, s: &[S], gradients: &mut [S]) {
        let columns = self.damped.iter().map(|joint| motion.z[*joint] * s[*joint]);
        let columns = columns.chain(self.geared.iter().map(|joint| motion.dz[*joint] * s[*joint]));
        let frictions = self.friction.iter();
        let columns = columns.chain(frictions.map(|f| smoothed(motion.z[f.joint], f.width) * s[f.joint]));
        for (gradient, column) in gradients.iter_mut().zip(columns) {
            *gradient = column;
        }
    }

    /// Takes D q̇ from `drive` and, where it is smooth, F tanh(q̇/ε).
    #[inline(always)]
    pub(super) fn resist<S: Scalar>(&self, dq: &[S], theta: &[S], drive: &mut [S]) {
        let [damping, _, friction] = self.ranges();
        for (own, joint) in theta[damping].iter().zip(&self.damped) {
            drive[*joint] = own.neg_mul_add(dq[*joint], drive[*joint]);
        }
        if self.dry_s.is_none() {
            for (own, Friction { joint, width }) in theta[friction].iter().zip(&self.friction) {
                drive[*joint] = own.neg_mul_add(smoothed(dq[*joint], *width), drive[*joint]);
            }
        }
    }

    /// Adds the armatures to the diagonal of `m`, which has `n` rows.
    #[inline(always)]
    pub(super) fn weigh<S: Scalar>(&self, n: usize, theta: &[S], m: &mut [S]) {
        let [_, armature, _] = self.ranges();
        for (own, joint) in theta[armature].iter().zip(&self.geared) {
            m[joint * (n + 1)] = m[joint * (n + 1)] + *own;
        }
    }

    /// Adds D s and, of the friction, what the plant has at q̇ less what Y has at z.
    #[inline(always)]
    pub(super) fn add_losses<S: Scalar>(&self, motion: TwoVelocity<'_, S>, theta: &[S], out: &mut [S]) {
        let [damping, _, friction] = self.ranges();
        for (own, &joint) in theta[damping].iter().zip(&self.damped) {
            out[joint] = own.mul_add(motion.dq[joint] - motion.z[joint], out[joint]);
        }
        for (own, &Friction { joint, width }) in theta[friction].iter().zip(&self.friction) {
            let plant = if self.dry_s.is_some() { S::ZERO } else { smoothed(motion.dq[joint], width) };
            out[joint] = own.mul_add(plant - smoothed(motion.z[joint], width), out[joint]);
        }
    }

    /// Natural scales of their parameters, as [`Lagrangian::adaptation_scale`](super::Lagrangian::adaptation_scale) says: that of a
    /// damping is the inertia M_jj(q) of its joint, that of an armature is `armature` of its joint. A friction has nothing to do with M: its
    /// scale is 0.16 s² F, with which the usual 5/s make Γ = 4 F per rad; `fallback` stands for an F of zero. `theta` may be short.
    pub(super) fn scales(
        &self,
        theta: &[f64],
        inertia: impl Fn(usize) -> f64,
        armature: impl Fn(usize) -> f64,
        fallback: f64,
    ) -> Vec<f64> {
        const FRICTION_S2: f64 = 0.16;
        let [_, _, frictions] = self.ranges();
        let force = |own: &f64| if own.abs() > 0.0 && own.is_finite() { own.abs() } else { fallback };
        let mut scale: Vec<f64> = self.damped.iter().map(|joint| inertia(*joint)).collect();
        scale.extend(self.geared.iter().map(|joint| armature(*joint)));
        scale.extend(theta.get(frictions).unwrap_or_default().iter().map(|own| FRICTION_S2 * force(own)));
        scale
    }
}

/// tanh(v/ε).
#[inline(always)]
fn smoothed<S: Scalar>(v: S, width: f64) -> S {
    Scalar::tanh(v * S::splat(1.0 / width))
}
