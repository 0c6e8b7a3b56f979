//! What an actuator can do: torque limits and rates.

use alloc::vec;
use alloc::vec::Vec;

use thiserror::Error;

use crate::{LengthError, Scalar};

/// Limits that cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LimiterError {
    /// A limit that is not positive.
    #[error("axis {axis} has the {what} {value}, but it must be positive")]
    NotPositive {
        /// `torque limit` or `torque rate limit`.
        what: &'static str,
        /// The axis, from zero.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// Not one rate for each limit.
    #[error(transparent)]
    Length(#[from] LengthError),
}

/// Clips torques and the speed at which they change, axis by axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Limiter {
    /// N m or N; infinity for none.
    limit: Vec<f64>,
    /// N m/s or N/s; infinity for none.
    rate: Vec<f64>,
    /// The last torque.
    last: Vec<f64>,
}

impl Limiter {
    /// No limits on `axes` axes.
    pub fn none(axes: usize) -> Self {
        Limiter { limit: vec![f64::INFINITY; axes], rate: vec![f64::INFINITY; axes], last: vec![0.0; axes] }
    }

    /// Limits of torque, N m or N, and of its rate, N m/s or N/s, one entry per axis each; infinity for none.
    ///
    /// # Errors
    /// [`LimiterError`] when there are not as many rates as limits, or for the first that is not positive.
    pub fn new(limit: Vec<f64>, rate: Vec<f64>) -> Result<Self, LimiterError> {
        LengthError::check("torque rate limits", limit.len(), rate.len())?;
        for (what, values) in [("torque limit", &limit), ("torque rate limit", &rate)] {
            for (axis, &value) in values.iter().enumerate() {
                if value.is_nan() || value <= 0.0 {
                    return Err(LimiterError::NotPositive { what, axis, value });
                }
            }
        }
        let last = vec![0.0; limit.len()];
        Ok(Limiter { limit, rate, last })
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.limit.len()
    }

    /// Clips `tau`, `passed_s` after the last torque; the first one may be anything within the limits.
    #[inline(always)]
    pub fn apply(&mut self, passed_s: Option<f64>, tau: &mut [f64]) {
        for ((tau, last), (limit, rate)) in tau.iter_mut().zip(&mut self.last).zip(self.limit.iter().zip(&self.rate)) {
            let mut torque = tau.saturate(*limit);
            if let Some(h) = passed_s {
                torque = *last + (torque - *last).saturate(h * rate);
            }
            *last = torque;
            *tau = torque;
        }
    }

    /// Takes `torque` for the last one.
    pub fn hold(&mut self, torque: &[f64]) {
        for (last, torque) in self.last.iter_mut().zip(torque) {
            *last = *torque;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torques_stay_within_limits_and_change_no_faster_than_they_may() {
        let mut limiter = Limiter::new(vec![5.0, f64::INFINITY], vec![100.0, f64::INFINITY]).unwrap();
        let mut steps = Vec::new();
        for wanted in [-9.0, 9.0, 9.0, 9.0] {
            let mut tau = [wanted, wanted];
            limiter.apply((!steps.is_empty()).then_some(0.04), &mut tau);
            assert_eq!(tau[1], wanted);
            steps.push(tau[0]);
        }
        assert_eq!(steps, [-5.0, -1.0, 3.0, 5.0]);
    }

    #[test]
    fn limits_that_are_not_positive_are_refused() {
        let error = Limiter::new(vec![1.0, 0.0], vec![1.0, 1.0]).unwrap_err();
        assert_eq!(error, LimiterError::NotPositive { what: "torque limit", axis: 1, value: 0.0 });
        assert!(Limiter::new(vec![1.0], vec![]).is_err());
    }
}
