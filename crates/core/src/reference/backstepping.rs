//! (aa6): the backstepping baseline, which needs the derivative of what it hears.
//!
//! ```text
//! z = q̇_r = −Σ_j w_ij [ q − q_j(t−T_ij) ]           ż = q̈_r
//! ```
//!
//! At a switch or a delay jump q̇_r jumps and q̈_r is infinite. What a user would do is differentiate through a filter and
//! limit the result:
//!
//! ```text
//! ε ḟ = q̇_r − f        ż ≈ sat( (q̇_r − f)/ε )
//! ```
//!
//! f(0) = q̇_r(0), as of a filter that has settled, unless another is stated.
//!
//! At a jump of size Δ that is Δ/ε for a while: the torque grows as the filter narrows, which is the point.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use super::{Exchange, Heard, Measured, Position, Reference, ReferenceOut, Sliding, check};
use crate::{LengthError, Scalar};

/// A filter that cannot differentiate.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BacksteppingError {
    /// ε is not positive.
    #[error("the filter of the derivative has the time constant {value} s, but it must be positive and finite")]
    Filter {
        /// ε, s.
        value: f64,
    },
    /// The limit is not positive.
    #[error("the derivative is limited to {value}, but the limit must be positive")]
    Limit {
        /// The limit, rad/s² or m/s²; infinity for none.
        value: f64,
    },
}

/// The backstepping baseline for a population of agents. State: `[f]`.
///
/// **Source**: (aa6) and the display before it; the filter is ours.
/// **Measures**: q (and q̇, for the tracking law). **Transmits**: q.
/// **Guarantees**: nothing that the paper states: its derivative does not exist at switches and delay jumps.
/// **Deviates from the paper**: q̈_r comes from a filter with the time constant ε, and is limited.
///
/// ```
/// use forwardstep_core::reference::{Backstepping, Heard, Measured, Reference, ReferenceOut};
///
/// // ε = 0.1 s and no limit; one neighbour at 1 of weight 0.8.
/// let design = Backstepping::new([(0.1, f64::INFINITY)])?;
/// let (mut z, mut dz, mut rate) = ([0.0], [0.0], [0.0]);
/// let out = ReferenceOut { z: &mut z, dz: &mut dz, d_state: &mut rate };
/// design.evaluate(1, Measured { q: &[0.3], dq: &[0.0] }, &[0.2], Heard::new(&[0.8], &[0.8], 1)?, out)?;
/// // (aa6) and its filtered derivative.
/// assert!((z[0] + 0.8 * (0.3 - 1.0)).abs() < 1e-12);
/// assert!((dz[0] - (z[0] - 0.2) / 0.1).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Backstepping {
    /// 1/ε of every agent.
    rate: Vec<f64>,
    /// Limit of ż of every agent.
    limit: Vec<f64>,
    /// f(0) of every agent, where it is stated.
    starts: Vec<Option<Vec<f64>>>,
}

impl Backstepping {
    /// Builds the dynamics from the time constant ε of the filter, s, and the limit of ż (infinity for none) of every
    /// agent.
    ///
    /// # Errors
    /// [`BacksteppingError`] when one of them is not positive.
    pub fn new(filters: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, BacksteppingError> {
        let (mut rate, mut limit) = (Vec::new(), Vec::new());
        for (epsilon, bound) in filters {
            if !(epsilon > 0.0 && epsilon.is_finite()) {
                return Err(BacksteppingError::Filter { value: epsilon });
            }
            if bound.is_nan() || bound <= 0.0 {
                return Err(BacksteppingError::Limit { value: bound });
            }
            rate.push(1.0 / epsilon);
            limit.push(bound);
        }
        let starts = vec![None; rate.len()];
        Ok(Backstepping { rate, limit, starts })
    }

    /// The same with f(0), rad/s or m/s on every axis, of the agents that state it; further ones start settled.
    pub fn starting_at(mut self, starts: impl IntoIterator<Item = Option<Vec<f64>>>) -> Self {
        self.starts.iter_mut().zip(starts).for_each(|(own, start)| *own = start);
        self
    }
}

impl Reference for Backstepping {
    type Exchange = Position;

    fn agents(&self) -> usize {
        self.rate.len()
    }

    fn vectors(&self) -> usize {
        1
    }

    fn derivatives(&self) -> usize {
        0
    }

    fn sliding(&self) -> Option<&Sliding> {
        None
    }

    fn is_affine(&self) -> bool {
        true
    }

    #[inline(always)]
    fn evaluate(
        &self,
        axes: usize,
        measured: Measured<'_>,
        state: &[f64],
        heard: Heard<'_, Position>,
        out: ReferenceOut<'_>,
    ) -> Result<(), LengthError> {
        let n = self.rate.len();
        check([axes, n, 1], measured, state, heard, &out)?;
        for k in 0..axes * n {
            let i = k % n;
            let z = heard.degree[i].neg_mul_add(measured.q[k], heard.sums.q[k]);
            let rate = self.rate[i] * (z - state[k]);
            out.z[k] = z;
            out.dz[k] = rate.saturate(self.limit[i]);
            out.d_state[k] = rate;
        }
        Ok(())
    }

    fn start(
        &self,
        axes: usize,
        measured: Measured<'_>,
        _: &[f64],
        heard: Heard<'_, Position>,
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        let block = axes * self.rate.len();
        LengthError::check("q", block, measured.q.len())?;
        LengthError::check("reference state", block, state.len())?;
        LengthError::check("degree", self.rate.len(), heard.degree.len())?;
        Position::check(heard.sums, block)?;
        self.starts
            .iter()
            .flatten()
            .try_for_each(|start| LengthError::check("start of the filter", axes, start.len()))?;
        for k in 0..block {
            let (agent, axis) = (k % self.rate.len(), k / self.rate.len());
            // Else the filter has settled: no derivative at the start.
            state[k] = match &self.starts[agent] {
                Some(start) => start[axis],
                None => heard.sums.q[k] - heard.degree[agent] * measured.q[k],
            };
        }
        Ok(())
    }
}
