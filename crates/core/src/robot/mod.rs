//! Lagrangian robots: M(q) q̈ + C(q, q̇) q̇ + g(q) + D q̇ = τ, linear in the parameters ϑ.
//!
//! Viscous damping D, where a robot has it, is part of ϑ: its regressor is diag of the reference velocity, so the law
//! compensates D z and the loop dissipates K + D.

mod called;
mod driven;
mod drives;
mod enclosed;
mod inertia_bound;
mod kinematics;
mod planar;
mod point_mass;
mod ship;
mod stick;
pub mod tree;

pub use called::Called;
pub use driven::{Driven, DrivenScratch};
pub use drives::{DriveError, Drives, Friction, SMOOTHING_LOSS};
pub use inertia_bound::{Definiteness, InertiaBound};
pub use kinematics::{Posture, TipKinematics};
pub use planar::{PlanarArm, PlanarLinks, PlanarTip};
pub use point_mass::PointMass;
pub use ship::Ship;
pub use stick::Stick;

use alloc::vec::Vec;

use crate::{LengthError, Scalar};

/// The arguments of the two-velocity regressor Y(q, q̇, z, ż), `dof` entries each.
#[derive(Clone, Copy, Debug)]
pub struct TwoVelocity<'a, S> {
    /// Joint positions q, in rad or m.
    pub q: &'a [S],
    /// Joint velocities q̇.
    pub dq: &'a [S],
    /// Reference velocity z.
    pub z: &'a [S],
    /// Reference acceleration ż.
    pub dz: &'a [S],
}

impl<S> TwoVelocity<'_, S> {
    /// Checks that all four vectors have `dof` entries.
    ///
    /// # Errors
    /// [`LengthError`] for the first that has not.
    #[inline(always)]
    pub fn check(&self, dof: usize) -> Result<(), LengthError> {
        LengthError::check("q", dof, self.q.len())?;
        LengthError::check("dq", dof, self.dq.len())?;
        LengthError::check("z", dof, self.z.len())?;
        LengthError::check("dz", dof, self.dz.len())
    }
}

/// A robot with the three properties of Section II-B: M(q) symmetric positive definite, Ṁ − 2C skew, linear in ϑ.
///
/// **Source**: (1) and Properties 1–3.
///
/// The model holds what is known for certain (geometry, gravity); every dynamic parameter comes in as `theta`, so the
/// same functions serve the plant with the true ϑ and the law with the estimate ϑ̂, whatever its values. All methods
/// leave outputs unspecified, never panic, when they return an error.
pub trait Lagrangian<S: Scalar> {
    /// Working memory of one call, allocated once by [`Lagrangian::scratch`].
    type Scratch: Send + Sync;

    /// Number of joints (or axes) m.
    fn dof(&self) -> usize;

    /// Length of ϑ.
    fn parameter_count(&self) -> usize;

    /// Allocates working memory for this model.
    fn scratch(&self) -> Self::Scratch;

    /// `y_theta` = Y(q, q̇, z, ż) ϑ = M ż + C(q, q̇) z + g + D z, and `yt_s` = Y(q, q̇, z, ż)ᵀ s, without forming Y.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn regressor_products(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        s: &[S],
        y_theta: &mut [S],
        yt_s: &mut [S],
    ) -> Result<(), LengthError>;

    /// `ddq` solves M(q) q̈ = `tau` − C(q, q̇) q̇ − g(q) − D q̇.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length. A mass matrix that is singular for this ϑ gives non-finite
    /// accelerations, not an error.
    fn forward_dynamics(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) -> Result<(), LengthError>;

    /// M(q), row by row, `dof`² entries.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn mass_matrix(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], m: &mut [S]) -> Result<(), LengthError>;

    /// The Coriolis matrix C(q, q̇) of Christoffel symbols, row by row, for which Ṁ − 2C is skew. D is not in it.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn coriolis_matrix(
        &self,
        scratch: &mut Self::Scratch,
        q: &[S],
        dq: &[S],
        theta: &[S],
        c: &mut [S],
    ) -> Result<(), LengthError>;

    /// Adds to `out` what damping and friction take of the motion at q̇ less what Y has of them at z: D(q) s, s = q̇ − z, and of a friction
    /// F [tanh(q̇/ε) − tanh(z/ε)]. Times s it is what the proof loses by them beside sᵀK s. ż is not used. D need not be symmetric;
    /// D + Dᵀ ⪰ 0.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn add_damping(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        theta: &[S],
        out: &mut [S],
    ) -> Result<(), LengthError>;

    /// The gravity torque g(q).
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn gravity(&self, scratch: &mut Self::Scratch, q: &[S], theta: &[S], g: &mut [S]) -> Result<(), LengthError>;

    /// Y(q, q̇, z, ż) itself, row by row, `dof` × `parameter_count`. Slow; for inspection and tests.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn regressor(
        &self,
        scratch: &mut Self::Scratch,
        motion: TwoVelocity<'_, S>,
        y: &mut [S],
    ) -> Result<(), LengthError>;

    /// A natural scale of every parameter for an adaptation gain stated as a bandwidth ω: Γ = ω² · diag(scale).
    ///
    /// It is chosen so that M⁻¹ Y Γ Yᵀ is about ω² for the gravity and inertia columns of every body, whatever its mass
    /// and size: with m the mass and r its radius of gyration about the joint, m/g₀² for the mass, m r²/g₀² for the first
    /// moments and m r⁴/g₀² for the inertias, g₀ = 9.81 m/s². `theta` is the nominal ϑ.
    fn adaptation_scale(&self, q: &[f64], theta: &[f64]) -> Vec<f64>;
}
