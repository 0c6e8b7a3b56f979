//! Do the numbers describe bodies that can exist, and a robot that can move?
//!
//! Two questions apart. A single body's ten numbers can be impossible (negative moments, a broken triangle inequality)
//! and the robot still moves: that deserves a warning. A mass matrix that is not positive definite makes the equations
//! of motion meaningless: that has to be refused.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::spatial::{Inertia, Sym3, Vec3};
use super::{JointKind, Tree};
use crate::robot::Lagrangian;
use crate::{LengthError, Scalar};

/// What is wrong with the ten inertial parameters of one body, with the numbers that say so.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InertiaDefect {
    /// The mass is negative.
    #[error("the mass is {mass_kg} kg, but a mass must not be negative")]
    NegativeMass {
        /// The mass.
        mass_kg: f64,
    },
    /// There is a first moment or an inertia, but no mass.
    #[error(
        "the mass is zero, but the body has first moment {first_moment_kg_m} kg m and inertia {inertia_kg_m2} kg m²"
    )]
    WithoutMass {
        /// The length of m c.
        first_moment_kg_m: f64,
        /// The largest entry of the inertia, by magnitude.
        inertia_kg_m2: f64,
    },
    /// The centre of mass is far from where the body is.
    #[error(
        "the centre of mass is {distance_m} m from the joint, but the body measures about {size_m} m; \
         {plausible_m} m would be plausible"
    )]
    FarCentre {
        /// Distance from the joint frame's origin to the centre of mass.
        distance_m: f64,
        /// The size the body was taken to have.
        size_m: f64,
        /// The middle of a body of that size.
        plausible_m: f64,
    },
    /// There is mass but no inertia about the centre of mass.
    #[error(
        "the inertia about the centre of mass is zero for a mass of {mass_kg} kg; \
         {plausible_kg_m2} kg m² would be plausible"
    )]
    ZeroInertia {
        /// The mass.
        mass_kg: f64,
        /// The moment of inertia of a solid sphere of that mass and of the body's size.
        plausible_kg_m2: f64,
    },
    /// A principal moment is negative.
    #[error(
        "the principal moments of inertia are {}, {} and {} kg m², but none may be negative; \
         {plausible_kg_m2} kg m² each would be plausible",
        .moments_kg_m2[0], .moments_kg_m2[1], .moments_kg_m2[2]
    )]
    NegativeMoment {
        /// About the centre of mass, the least first.
        moments_kg_m2: [f64; 3],
        /// The moment of inertia of a solid sphere of that mass and of the body's size.
        plausible_kg_m2: f64,
    },
    /// The largest principal moment exceeds the sum of the two others.
    #[error(
        "the largest principal moment of inertia, {} kg m², exceeds the sum of the two others, {} + {}; no body has \
         that, at most {plausible_kg_m2} kg m² would be plausible",
        .moments_kg_m2[2], .moments_kg_m2[0], .moments_kg_m2[1]
    )]
    TriangleInequality {
        /// About the centre of mass, the least first.
        moments_kg_m2: [f64; 3],
        /// The sum of the two smaller ones.
        plausible_kg_m2: f64,
    },
}

/// A body whose size nothing tells is taken to measure this much, in m.
const DEFAULT_SIZE: f64 = 0.1;
/// A centre of mass farther than this many sizes from the joint is reported.
const FAR: f64 = 5.0;
/// Moments in files are rounded to six digits or so; a rod or a plate meets the triangle inequality with equality.
const ROUNDING: f64 = 1.0e-6;

/// All that is wrong with a body of about `size_m` (for example from its joint to the next one; a size that is not
/// positive and finite counts as 0.1 m). `inertia` in the order of [`LinkSpec::inertia`](super::LinkSpec::inertia), finite.
///
/// A body without mass and inertia is in order: frames are often stated as links.
pub fn inertia_defects(inertia: &[f64; 10], size_m: f64) -> Vec<InertiaDefect> {
    let size_m = if size_m > 0.0 && size_m.is_finite() { size_m } else { DEFAULT_SIZE };
    let Inertia { m, h, i } = Inertia::from_array(inertia);
    let first_moment = libm::sqrt(h.dot(h));
    if m < 0.0 {
        return vec![InertiaDefect::NegativeMass { mass_kg: m }];
    }
    if m == 0.0 {
        let largest = inertia[4..].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if first_moment == 0.0 && largest == 0.0 {
            return Vec::new();
        }
        return vec![InertiaDefect::WithoutMass { first_moment_kg_m: first_moment, inertia_kg_m2: largest }];
    }
    let mut defects = Vec::new();
    let distance = first_moment / m;
    if distance > FAR * size_m {
        defects.push(InertiaDefect::FarCentre { distance_m: distance, size_m, plausible_m: size_m / 2.0 });
    }
    // A solid sphere of that diameter: 2/5 m (size/2)².
    let sphere = 0.1 * m * size_m * size_m;
    let moments = principal_moments(&about_centre(m, h, i));
    let [least, middle, largest] = moments;
    // What is left of a point mass after the inertia has been moved to the joint and back.
    let noise = 1.0e-12 * (sphere + m * distance * distance);
    if least.abs() <= noise && largest.abs() <= noise {
        defects.push(InertiaDefect::ZeroInertia { mass_kg: m, plausible_kg_m2: sphere });
    } else if least < -noise - ROUNDING * largest {
        defects.push(InertiaDefect::NegativeMoment { moments_kg_m2: moments, plausible_kg_m2: sphere });
    } else if largest > (least + middle) * (1.0 + ROUNDING) + noise {
        defects.push(InertiaDefect::TriangleInequality { moments_kg_m2: moments, plausible_kg_m2: least + middle });
    }
    defects
}

/// I about the joint less what m c adds: m (c² 1 − c cᵀ) with h = m c.
pub(super) fn about_centre<S: Scalar>(m: S, h: Vec3<S>, i: Sym3<S>) -> Sym3<S> {
    let (x, y, z) = (h.x / m, h.y / m, h.z / m);
    Sym3 {
        xx: i.xx - (h.y * y + h.z * z),
        xy: i.xy + h.x * y,
        yy: i.yy - (h.x * x + h.z * z),
        xz: i.xz + h.x * z,
        yz: i.yz + h.y * z,
        zz: i.zz - (h.x * x + h.y * y),
    }
}

/// Eigenvalues, the least first, by Jacobi rotations; six sweeps are plenty for three rows.
fn principal_moments(i: &Sym3<f64>) -> [f64; 3] {
    let mut a = [[i.xx, i.xy, i.xz], [i.xy, i.yy, i.yz], [i.xz, i.yz, i.zz]];
    for _ in 0..6 {
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            if a[p][q] == 0.0 {
                continue;
            }
            // The smaller root of t² + 2 t cot 2φ = 1 turns the off-diagonal entry to zero.
            let cot = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = libm::copysign(1.0, cot) / (cot.abs() + libm::sqrt(cot * cot + 1.0));
            let c = 1.0 / libm::sqrt(t * t + 1.0);
            let s = t * c;
            let (apq, arp, arq) = (a[p][q], a[r][p], a[r][q]);
            a[p][p] -= t * apq;
            a[q][q] += t * apq;
            (a[p][q], a[q][p]) = (0.0, 0.0);
            (a[r][p], a[r][q]) = (c * arp - s * arq, s * arp + c * arq);
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
        }
    }
    let mut moments = [a[0][0], a[1][1], a[2][2]];
    moments.sort_by(f64::total_cmp);
    moments
}

/// Why a mass matrix is no mass matrix.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MassMatrixError {
    /// A slice has the wrong length.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// At a configuration, what is carried by some joint has no positive inertia about it.
    #[error(
        "the mass matrix is not positive definite: with all joints further out free, body {body} and what it carries \
         have inertia {pivot} about their joint (leading minor of order {order}, counted from the last joint, at \
         q = {q:?})"
    )]
    NotPositiveDefinite {
        /// The moving body, from zero.
        body: usize,
        /// The order of the first leading minor that fails when joints are counted from the last to the first.
        order: usize,
        /// The ratio of that minor to the one before, in kg m² or kg: the articulated inertia about the joint.
        pivot: f64,
        /// The configuration, in rad or m.
        q: Vec<f64>,
    },
}

impl Tree {
    /// Checks that M(q) is positive definite at `samples` configurations spread evenly over `range`, the `[least,
    /// largest]` position of every joint; a range that is not finite counts as ±π rad or ±1 m. The first sample is the
    /// middle.
    ///
    /// M is factored from the last joint to the first, so that a pivot is the inertia which a joint feels while those
    /// further out hang free, and the body named is the outermost one to blame.
    ///
    /// # Errors
    /// [`MassMatrixError`] at the first configuration that fails.
    pub fn check_mass_matrix(&self, theta: &[f64], range: &[[f64; 2]], samples: usize) -> Result<(), MassMatrixError> {
        let n = self.joint_count();
        LengthError::check("joint ranges", n, range.len())?;
        let mut scratch = self.scratch::<f64>();
        let (mut q, mut m) = (vec![0.0; n], vec![0.0; n * n]);
        let step = even_steps(n);
        for sample in 0..samples {
            for (joint, kind) in self.joint_kinds().enumerate() {
                let [least, largest] = match range[joint] {
                    [least, largest] if (largest - least).is_finite() => [least, largest],
                    _ if kind == JointKind::Revolute => [-core::f64::consts::PI, core::f64::consts::PI],
                    _ => [-1.0, 1.0],
                };
                let share = 0.5 + sample as f64 * step[joint];
                q[joint] = least + (largest - least) * (share - libm::floor(share));
            }
            self.mass_matrix(&mut scratch, &q, theta, &mut m)?;
            if let Err((body, pivot)) = outermost_pivot(n, &mut m) {
                return Err(MassMatrixError::NotPositiveDefinite { body, order: n - body, pivot, q });
            }
        }
        Ok(())
    }

    /// How large every body is, as far as the tree tells: the distance from its joint to the farthest joint it carries,
    /// in m; zero for a body that carries none.
    pub fn body_sizes(&self) -> Vec<f64> {
        let mut sizes = vec![0.0_f64; self.joint_count()];
        for body in &self.bodies {
            let [x, y, z] = body.translation;
            if let Some(size) = body.parent_slot.checked_sub(1).and_then(|parent| sizes.get_mut(parent)) {
                *size = size.max(libm::sqrt(x * x + y * y + z * z));
            }
        }
        sizes
    }
}

/// Powers of 1/φ with φ^(n+1) = φ + 1: the additive sequence that spreads most evenly over n dimensions.
pub(super) fn even_steps(n: usize) -> Vec<f64> {
    let mut phi = 2.0_f64;
    for _ in 0..64 {
        phi = libm::pow(1.0 + phi, 1.0 / (n as f64 + 1.0));
    }
    let mut power = 1.0;
    (0..n)
        .map(|_| {
            power /= phi;
            power
        })
        .collect()
}

/// Factors M = Lᵀ D L in place from the last row up; the first row whose pivot is not positive, with that pivot.
fn outermost_pivot(n: usize, m: &mut [f64]) -> Result<(), (usize, f64)> {
    let largest = (0..n).fold(0.0_f64, |largest, i| largest.max(m[i * n + i].abs()));
    for k in (0..n).rev() {
        let pivot = m[k * n + k];
        // A body without inertia about its joint leaves rounding of the sums it was computed from.
        if !pivot.is_finite() || pivot <= 1.0e-14 * largest {
            return Err((k, pivot));
        }
        for i in 0..k {
            let factor = m[k * n + i] / pivot;
            for j in 0..=i {
                m[i * n + j] -= factor * m[k * n + j];
            }
        }
    }
    Ok(())
}
