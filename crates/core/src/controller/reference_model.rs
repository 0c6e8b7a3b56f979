//! Where z leads: reference dynamics for a plant of any order, and for tracking as for consensus.
//!
//! Let z follow d^(k−1)x/dt^(k−1) of a plant of order k, and let ℓ ≥ 1 differentiators be added, so that x takes part in
//! dynamics of order N = k + ℓ − 1. Write
//!
//! ```text
//! x_r = d^r x/dt^r where it is measured, r < p        x_r = z^(r−k+1) above                      (Remark 6)
//!
//! z^(ℓ) = x_d^(N) − Σ_{r<N} α_r (x_r − x_d^(r))                                 tracking, roots N
//! z^(ℓ) = −Σ_{r<N−1} α_r x_{r+1} − Σ_j w_ij [Σ_{r<N} α_r x_r − α₀ x_j(t−T_ij)]    consensus, roots N − 1, α_{N−1} = 1
//! ```
//!
//! The first is (a9) for k = ℓ = 2, p = 1. The second is (24): for k = 2 that of robots, and of a point mass without velocity
//! when p = 1. p is k, or k − 1 where the highest derivative is not measured.
//!
//! **Degree reduction** of (43), for p = k. With s = d^(k−1)x/dt^(k−1) − z the upper subsystem is
//! d^N x/dt^N = z^(ℓ) + s^(ℓ): the interconnection F of (43) is s^(ℓ), and the cascade has degree ℓ. In the state
//! x, …, x_{k−2}, z, …, z^(ℓ−1) it reads
//!
//! ```text
//! d/dt x_{k−2} = z + s,    d/dt z^(ℓ−1) = as above with z in place of x_{k−1}, and with −c s,
//! c = α_{k−1} for tracking,    c = α_{k−2} + α_{k−1} Σ_j w_ij for consensus (α₋₁ = 0)
//! ```
//!
//! so no derivative of s is left, the degree is zero, and what is added to the linear dynamics is square-integrable if s is.
//! For k = 1 there is no x_{k−2}; there x = z + s stands in the sums, own and heard, and enters as −α₀ Σ_j w_ij (s_i − s_j(t−T)).
//! For consensus let X = Σ_{r<N} α_r x_r. Then d/dt (X − α_{k−1} s) = −Σ_j w_ij (X − α₀ x_j(t−T)) whatever s does, which
//! predicts the agreed value as for robots.
//!
//! **A nonlinear protocol.** Where the network hands over x_i − φ(x_i − x_j(t−T)) in place of x_j(t−T), the equation above has
//! α₀ Σ_j w_ij φ(x_i − x_j(t−T)) where it had α₀ Σ_j w_ij (x_i − x_j(t−T)), and nothing here changes.
//!
//! **Desired dynamics** of which both are instances are those of [`DesiredDynamics`], of any order N ≥ k.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::Jets;
use crate::LengthError;
use crate::reference::{
    Consensus, DesiredDynamics, Exchange, Heard, Measured, Place, Position, Reference, ReferenceOut, WrittenIn,
};
use crate::signal::Signal;

/// Where z leads.
#[derive(Clone, Debug)]
pub enum ReferenceModel {
    /// To a desired trajectory.
    Tracking {
        /// α₀ … α_{N−1} of the Hurwitz polynomial θ^N + Σ α_r θ^r.
        alpha: Vec<f64>,
    },
    /// To agreement with the neighbours: (24) for one agent.
    Consensus(Consensus<Position>),
    /// Where desired dynamics that a user writes down lead, with x as far as the order of the plant measured.
    Desired(DesiredDynamics),
}

/// Why a guide does not suit a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ReferenceModelError {
    /// ℓ would be less than it has to be.
    #[error("roots of the reference dynamics: {got}, but at least {least} are needed here")]
    TooFew {
        /// How many roots there must be.
        least: usize,
        /// How many there are.
        got: usize,
    },
    /// A law that uses derivatives of z, which are no states there.
    #[error(
        "the desired dynamics are written in x, so that derivatives of z are integrated and no states, but the law uses them: \
         write the dynamics in what is measured or in z"
    )]
    NoDerivatives,
}

impl ReferenceModel {
    /// How many roots it was made from: N for tracking and for desired dynamics, N − 1 for consensus.
    pub fn roots(&self) -> usize {
        match self {
            ReferenceModel::Tracking { alpha } => alpha.len(),
            ReferenceModel::Consensus(consensus) => consensus.order(),
            ReferenceModel::Desired(desired) => desired.order(),
        }
    }

    /// ℓ for a plant of order `k`: the blocks z, ż, …, z^(ℓ−1).
    pub fn vectors(&self, k: usize) -> usize {
        match self {
            ReferenceModel::Tracking { alpha } => (alpha.len() + 1).saturating_sub(k),
            ReferenceModel::Consensus(consensus) => (consensus.order() + 2).saturating_sub(k),
            ReferenceModel::Desired(desired) => desired.vectors(k),
        }
    }

    /// Whether it leads to a trajectory.
    pub fn tracks(&self) -> bool {
        match self {
            ReferenceModel::Tracking { .. } => true,
            ReferenceModel::Consensus(_) => false,
            ReferenceModel::Desired(desired) => desired.tracks(),
        }
    }

    /// Up to which derivative it reads a trajectory: the order N of what follows it.
    pub fn target_derivatives(&self) -> usize {
        if self.tracks() { self.roots() } else { 0 }
    }

    /// ℓ for a plant of order `k`, if it is at least `least`.
    ///
    /// # Errors
    /// [`ReferenceModelError`] when there are too few roots.
    pub fn check(&self, k: usize, least: usize) -> Result<usize, ReferenceModelError> {
        let got = self.roots();
        let least = match self {
            ReferenceModel::Tracking { .. } | ReferenceModel::Desired(_) => (least + k).saturating_sub(1),
            ReferenceModel::Consensus(_) => (least + k).saturating_sub(2),
        };
        if got < least {
            return Err(ReferenceModelError::TooFew { least, got });
        }
        Ok(self.vectors(k))
    }

    /// Room for one call of [`ReferenceModel::rate`].
    pub fn work(&self, axes: usize) -> ReferenceModelWork {
        let blocks = if let ReferenceModel::Consensus(consensus) = self { consensus.order() } else { 0 };
        let axis = || vec![0.0; axes];
        let all = || vec![0.0; blocks * axes];
        let steps = if let ReferenceModel::Desired(desired) = self { desired.steps() } else { 0 };
        let protocol = vec![0.0; steps];
        ReferenceModelWork { q: axis(), dq: axis(), z: axis(), dz: axis(), state: all(), rate: all(), protocol }
    }

    /// d/dt of z, ż, …, z^(ℓ−1) for a plant of order `k` with `axes` axes.
    ///
    /// `measured` holds x, ẋ, …, as many blocks as are measured, k or k − 1; the target has [`ReferenceModel::target_derivatives`].
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn rate(
        &self,
        k: usize,
        axes: usize,
        leads: ReferenceModelInput<'_, '_>,
        work: &mut ReferenceModelWork,
        d_state: &mut [f64],
    ) -> Result<(), LengthError> {
        let ReferenceModelInput { measured, state: own, heard, target } = leads;
        let len = self.vectors(k) * axes;
        LengthError::check("reference state", len, own.len())?;
        LengthError::check("reference rate", len, d_state.len())?;
        let p = measured.len() / axes.max(1);
        LengthError::check("what is measured", if p < k { (k - 1) * axes } else { k * axes }, measured.len())?;
        let Some(top) = len.checked_sub(axes) else { return Ok(()) };
        d_state[..top].copy_from_slice(&own[axes..]);
        // Entry `axis` of x_r.
        let entry = |r: usize, axis: usize| {
            if r < p { measured[r * axes + axis] } else { own[(r + 1 - k) * axes + axis] }
        };
        match self {
            ReferenceModel::Tracking { alpha } => {
                LengthError::check("target", axes, target.len())?;
                for (axis, jet) in target.iter().enumerate() {
                    let mut rate = jet.get(alpha.len()).copied().unwrap_or(f64::NAN);
                    for (r, alpha) in alpha.iter().enumerate().rev() {
                        rate -= alpha * (entry(r, axis) - jet[r]);
                    }
                    d_state[top + axis] = rate;
                }
            }
            ReferenceModel::Consensus(consensus) => {
                // As a robot would call it: x₀ is its position, x₁ its velocity, x₂ its ż, …. Its z is not used.
                let ReferenceModelWork { q, dq, z, dz, state, rate, .. } = work;
                LengthError::check("room for the reference", consensus.vectors() * axes, state.len())?;
                LengthError::check("room for an axis", axes, q.len())?;
                for axis in 0..axes {
                    (q[axis], dq[axis]) = (entry(0, axis), entry(1, axis));
                    // ẋ stands in for z, so that λ (ẋ − z) vanishes.
                    for r in 0..consensus.vectors() {
                        state[r * axes + axis] = entry(r + 1, axis);
                    }
                }
                let out = ReferenceOut { z, dz, d_state: rate };
                consensus.evaluate(axes, Measured { q, dq }, state, heard, out)?;
                d_state[top..].copy_from_slice(&rate[rate.len() - axes..]);
            }
            ReferenceModel::Desired(desired) => {
                LengthError::check("the order of the plant", 1, k.min(1))?;
                LengthError::check("what is measured", k * axes, measured.len())?;
                LengthError::check("target", if desired.tracks() { axes } else { 0 }, target.len())?;
                LengthError::check("degree", 1, heard.degree.len())?;
                Position::check(heard.sums, axes)?;
                for entry in 0..axes {
                    let x = |r: usize| measured[r * axes + entry];
                    let (place, given) = (Place { block: axes, entry }, (own, heard.degree[0], heard));
                    let target = target.get(entry);
                    desired.rate::<Position>(k, place, x, given, target, (&mut work.protocol, d_state))?;
                }
            }
        }
        Ok(())
    }

    /// From z, ż, … in `state`, as they are to start, to what is integrated; `top` is x^(k−1), `degree` Σ_j w_ij.
    ///
    /// # Errors
    /// [`LengthError`] when the state has another length.
    pub fn begin(&self, k: usize, top: &[f64], degree: f64, state: &mut [f64]) -> Result<(), LengthError> {
        let block = top.len();
        LengthError::check("reference state", self.vectors(k) * block, state.len())?;
        match self {
            ReferenceModel::Tracking { .. } | ReferenceModel::Consensus(_) => {}
            ReferenceModel::Desired(desired) => {
                for (entry, top) in top.iter().enumerate() {
                    desired.begin(k, Place { block, entry }, *top, degree, state);
                }
            }
        }
        Ok(())
    }

    /// What block `r` of its state is: z^(r), or what stands in its place where desired dynamics are written in x.
    pub fn signal(&self, r: usize) -> Signal {
        let in_x = matches!(self, ReferenceModel::Desired(desired) if desired.written() == WrittenIn::X);
        if in_x && r > 0 { Signal::ReferenceIntegral(r as u8) } else { Signal::Reference(r as u8) }
    }
}

/// What [`ReferenceModel::rate`] goes by.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceModelInput<'a, 'h> {
    /// x, ẋ, …, as far as measured.
    pub measured: &'a [f64],
    /// z, ż, ….
    pub state: &'a [f64],
    /// What is heard.
    pub heard: Heard<'h, Position>,
    /// The trajectory.
    pub target: Jets<'a>,
}

/// Room for one call of (24), which is written for robots.
#[derive(Clone, Debug)]
pub struct ReferenceModelWork {
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
    state: Vec<f64>,
    rate: Vec<f64>,
    protocol: Vec<f64>,
}
