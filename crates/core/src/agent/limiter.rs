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

/// How many commands a limiter changed, on one axis or more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clipped {
    /// Because a torque was beyond its limit.
    pub torque: u64,
    /// Because it would have changed faster than it may.
    pub rate: u64,
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
    clipped: Clipped,
}

impl Limiter {
    /// No limits on `axes` axes.
    pub fn none(axes: usize) -> Self {
        let none = || vec![f64::INFINITY; axes];
        Limiter { limit: none(), rate: none(), last: vec![0.0; axes], clipped: Clipped::default() }
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
        Ok(Limiter { limit, rate, last, clipped: Clipped::default() })
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.limit.len()
    }

    /// How many commands it has changed.
    pub fn clipped(&self) -> Clipped {
        self.clipped
    }

    /// Clips `tau`, `passed_s` after the last torque; the first one may be anything within the limits.
    #[inline(always)]
    pub fn apply(&mut self, passed_s: Option<f64>, tau: &mut [f64]) {
        let (mut beyond, mut too_fast) = (false, false);
        for ((tau, last), (limit, rate)) in tau.iter_mut().zip(&mut self.last).zip(self.limit.iter().zip(&self.rate)) {
            let mut torque = tau.saturate(*limit);
            beyond |= tau.abs() > *limit;
            if let Some(h) = passed_s {
                too_fast |= (torque - *last).abs() > h * rate;
                torque = *last + (torque - *last).saturate(h * rate);
            }
            *last = torque;
            *tau = torque;
        }
        self.clipped.torque += u64::from(beyond);
        self.clipped.rate += u64::from(too_fast);
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
        assert_eq!(limiter.clipped(), Clipped { torque: 4, rate: 2 });
    }

    #[test]
    fn a_command_that_is_clipped_on_several_axes_counts_once_and_one_at_its_limit_not_at_all() {
        let mut limiter = Limiter::new(vec![5.0; 3], vec![100.0; 3]).unwrap();
        limiter.apply(None, &mut [5.0, -5.0, 5.0]);
        limiter.apply(Some(0.04), &mut [1.0, -1.0, 5.0]);
        assert_eq!(limiter.clipped(), Clipped::default());
        limiter.apply(Some(1.0), &mut [6.0, -7.0, 5.0]);
        assert_eq!(limiter.clipped(), Clipped { torque: 1, rate: 0 });
        limiter.apply(Some(0.01), &mut [0.0, 0.0, f64::NAN]);
        assert_eq!(limiter.clipped(), Clipped { torque: 1, rate: 1 });
    }

    #[test]
    fn limits_that_are_not_positive_are_refused() {
        let error = Limiter::new(vec![1.0, 0.0], vec![1.0, 1.0]).unwrap_err();
        assert_eq!(error, LimiterError::NotPositive { what: "torque limit", axis: 1, value: 0.0 });
        assert!(Limiter::new(vec![1.0], vec![]).is_err());
    }
}
