//! What acts at the joints of a tree besides its bodies: damping, rotors and Coulomb friction.
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

use super::model::Tree;
use crate::Scalar;
use crate::robot::TwoVelocity;

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

/// What acts at the joints besides damping.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drives {
    /// The joints with an armature.
    pub geared: Vec<usize>,
    /// The joints with Coulomb friction.
    pub friction: Vec<Friction>,
    /// The friction of the plant is set-valued: [`Lagrangian::forward_dynamics`](crate::robot::Lagrangian::forward_dynamics) leaves it to
    /// [`Stick`](super::Stick), which holds it over periods of so many seconds at most. Otherwise it is F tanh(q̇/ε).
    pub dry_s: Option<f64>,
}

/// Why drives have no meaning.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// There is no such joint.
    #[error("there is no joint {joint}: the tree has {joints}")]
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

impl Tree {
    /// The same tree with `drives`, whose parameters close ϑ: an armature in kg m² or kg for each geared joint, then F in N m or N for
    /// each with friction. What it had of either is replaced.
    ///
    /// # Errors
    /// [`DriveError`] when a joint does not exist or is out of order, or a width is not positive.
    pub fn with_drives(mut self, drives: Drives) -> Result<Tree, DriveError> {
        let joints = self.joint_count();
        let frictions: Vec<usize> = drives.friction.iter().map(|friction| friction.joint).collect();
        for list in [&drives.geared, &frictions] {
            let mut least = 0;
            for &joint in list {
                match joint {
                    _ if joint >= joints => return Err(DriveError::NoJoint { joint, joints }),
                    _ if joint < least => return Err(DriveError::Order { joint }),
                    _ => least = joint + 1,
                }
            }
        }
        if let Some(&Friction { joint, width }) =
            drives.friction.iter().find(|f| !(f.width > 0.0 && f.width.is_finite()))
        {
            return Err(DriveError::Width { joint, width });
        }
        if let Some(period_s) = drives.dry_s.filter(|period_s| !(*period_s > 0.0 && period_s.is_finite())) {
            return Err(DriveError::Period { period_s });
        }
        let first = 10 * joints + self.damped.len();
        for (joint, body) in self.bodies.iter_mut().enumerate() {
            body.armature = drives.geared.iter().position(|geared| *geared == joint).map(|k| first + k);
        }
        self.drives = drives;
        Ok(self)
    }

    /// What acts at the joints besides damping.
    pub fn drives(&self) -> &Drives {
        &self.drives
    }

    /// Where the parameters begin that follow the inertias: dampings, armatures, frictions, and the end.
    fn layout(&self) -> [usize; 4] {
        let damping = 10 * self.bodies.len();
        let armature = damping + self.damped.len();
        let friction = armature + self.drives.geared.len();
        [damping, armature, friction, friction + self.drives.friction.len()]
    }

    /// Length of ϑ.
    pub fn theta_len(&self) -> usize {
        self.layout()[3]
    }

    /// Where the armatures and the frictions stand in ϑ.
    pub fn drive_parameters(&self) -> [core::ops::Range<usize>; 2] {
        let [_, armature, friction, end] = self.layout();
        [armature..friction, friction..end]
    }

    /// Adds D z, I_a ż and F tanh(z/ε) to `y_theta`.
    #[inline(always)]
    pub(super) fn add_drives<S: Scalar>(&self, motion: TwoVelocity<'_, S>, theta: &[S], y_theta: &mut [S]) {
        let [damping, armature, friction, _] = self.layout();
        for (own, joint) in theta[damping..].iter().zip(&self.damped) {
            y_theta[*joint] = own.mul_add(motion.z[*joint], y_theta[*joint]);
        }
        for (own, joint) in theta[armature..].iter().zip(&self.drives.geared) {
            y_theta[*joint] = own.mul_add(motion.dz[*joint], y_theta[*joint]);
        }
        for (own, Friction { joint, width }) in theta[friction..].iter().zip(&self.drives.friction) {
            y_theta[*joint] = own.mul_add(smoothed(motion.z[*joint], *width), y_theta[*joint]);
        }
    }

    /// The entries of Yᵀs that close ϑ.
    #[inline(always)]
    pub(super) fn pair_drives<S: Scalar>(&self, motion: TwoVelocity<'_, S>, s: &[S], gradients: &mut [S]) {
        let columns = self.damped.iter().map(|joint| motion.z[*joint] * s[*joint]);
        let columns = columns.chain(self.drives.geared.iter().map(|joint| motion.dz[*joint] * s[*joint]));
        let frictions = self.drives.friction.iter();
        let columns = columns.chain(frictions.map(|f| smoothed(motion.z[f.joint], f.width) * s[f.joint]));
        for (gradient, column) in gradients.iter_mut().zip(columns) {
            *gradient = column;
        }
    }

    /// Takes D q̇ from `drive` and, where it is smooth, F tanh(q̇/ε).
    #[inline(always)]
    pub(super) fn resist<S: Scalar>(&self, dq: &[S], theta: &[S], drive: &mut [S]) {
        let [damping, _, friction, _] = self.layout();
        for (own, joint) in theta[damping..].iter().zip(&self.damped) {
            drive[*joint] = own.neg_mul_add(dq[*joint], drive[*joint]);
        }
        if self.drives.dry_s.is_none() {
            for (own, Friction { joint, width }) in theta[friction..].iter().zip(&self.drives.friction) {
                drive[*joint] = own.neg_mul_add(smoothed(dq[*joint], *width), drive[*joint]);
            }
        }
    }

    /// Adds D s and, of the friction, what the plant has at q̇ less what Y has at z.
    #[inline(always)]
    pub(super) fn add_losses<S: Scalar>(&self, motion: TwoVelocity<'_, S>, theta: &[S], out: &mut [S]) {
        let [damping, _, friction, _] = self.layout();
        for (own, &joint) in theta[damping..].iter().zip(&self.damped) {
            out[joint] = own.mul_add(motion.dq[joint] - motion.z[joint], out[joint]);
        }
        for (own, &Friction { joint, width }) in theta[friction..].iter().zip(&self.drives.friction) {
            let plant = if self.drives.dry_s.is_some() { S::ZERO } else { smoothed(motion.dq[joint], width) };
            out[joint] = own.mul_add(plant - smoothed(motion.z[joint], width), out[joint]);
        }
    }
}

/// tanh(v/ε).
#[inline(always)]
fn smoothed<S: Scalar>(v: S, width: f64) -> S {
    Scalar::tanh(v * S::splat(1.0 / width))
}
