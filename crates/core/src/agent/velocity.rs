//! Velocity from encoders alone.
//!
//! The filter is the usual one: a derivative with a first-order lag of cut-off ω, v̂ = p ω/(p + ω) q, for samples h apart
//!
//! ```text
//! v̂_k = a v̂_{k−1} + (1 − a) (q_k − q_{k−1})/h,      a = exp(−ω h)
//! ```
//!
//! It is exact for constant velocities, and v̂ lags behind by about 1/ω + h/2.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use crate::{LengthError, Scalar};

/// A filter that cannot be built or fed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FilterError {
    /// ω is not positive.
    #[error("the cut-off of the velocity filter is {value} rad/s, but it must be positive and finite")]
    CutOff {
        /// ω, rad/s.
        value: f64,
    },
    /// A slice of the wrong length.
    #[error(transparent)]
    Length(#[from] LengthError),
}

/// Estimates velocities from sampled positions.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityFilter {
    cut_off_rad_s: f64,
    last_q: Vec<f64>,
    velocity: Vec<f64>,
    fed: bool,
}

impl VelocityFilter {
    /// A filter with the cut-off ω, rad/s, for `axes` axes; velocities start at zero.
    ///
    /// # Errors
    /// [`FilterError::CutOff`] when ω is not positive.
    pub fn new(cut_off_rad_s: f64, axes: usize) -> Result<Self, FilterError> {
        if !(cut_off_rad_s > 0.0 && cut_off_rad_s.is_finite()) {
            return Err(FilterError::CutOff { value: cut_off_rad_s });
        }
        Ok(VelocityFilter { cut_off_rad_s, last_q: vec![0.0; axes], velocity: vec![0.0; axes], fed: false })
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.last_q.len()
    }

    /// Puts into `velocity` what [`VelocityFilter::feed`] would return, and takes nothing.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    pub fn peek(&self, passed_s: f64, q: &[f64], velocity: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("velocity", self.last_q.len(), velocity.len())?;
        velocity.copy_from_slice(&self.velocity);
        self.advance(passed_s, q, velocity)
    }

    /// Moves `velocity` on from the last sample to one `passed_s` later.
    fn advance(&self, passed_s: f64, q: &[f64], velocity: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("q", self.last_q.len(), q.len())?;
        if self.fed && passed_s > 0.0 {
            let a = libm::exp(-self.cut_off_rad_s * passed_s);
            for axis in 0..q.len() {
                let slope = (q[axis] - self.last_q[axis]) / passed_s;
                velocity[axis] = Scalar::mul_add(a, velocity[axis] - slope, slope);
            }
        }
        Ok(())
    }

    /// Takes the positions `q`, `passed_s` after the last ones, and returns the velocities.
    ///
    /// # Errors
    /// [`LengthError`] when `q` has the wrong length; nothing has changed then.
    pub fn feed(&mut self, passed_s: f64, q: &[f64]) -> Result<&[f64], LengthError> {
        let mut velocity = core::mem::take(&mut self.velocity);
        let fed = self.advance(passed_s, q, &mut velocity);
        self.velocity = velocity;
        fed?;
        self.fed = true;
        self.last_q.copy_from_slice(q);
        Ok(&self.velocity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_is_known_after_a_few_time_constants_and_not_before() {
        let (omega, h) = (100.0, 0.002);
        let mut filter = VelocityFilter::new(omega, 1).unwrap();
        let mut seen = Vec::new();
        for k in 0..60 {
            let t = h * f64::from(k);
            seen.push((t, filter.feed(h, &[1.0 + 3.0 * t]).unwrap()[0]));
        }
        for (t, v) in seen {
            // The first sample has no difference; from then on 3 (1 − e^(−ω t)).
            assert!((v - 3.0 * (1.0 - libm::exp(-omega * t))).abs() < 1e-10, "{v} at {t}");
        }
    }

    #[test]
    fn a_cut_off_that_is_not_positive_is_refused() {
        assert_eq!(VelocityFilter::new(0.0, 1), Err(FilterError::CutOff { value: 0.0 }));
    }
}
