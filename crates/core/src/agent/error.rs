//! Why a step fails, and what is checked before one.

use thiserror::Error;

use crate::LengthError;
use crate::signal::Signal;

/// Why an agent could not step. Its state is what it was, unless a variant says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StepError {
    /// A slice of the wrong length.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// Time did not move on.
    #[error("the sample at {now_s} s does not come after the one at {last_s} s")]
    Time {
        /// The time handed over, s.
        now_s: f64,
        /// The time of the sample before, s.
        last_s: f64,
    },
    /// A measurement or a message that is not a number; or a command, and then the state has moved on.
    #[error("{what} has the entry {value}, which is not a finite number")]
    NotFinite {
        /// Which one.
        what: &'static str,
        /// The entry.
        value: f64,
    },
    /// The law divides by a number that has come too close to zero. The state has moved on all the same.
    #[error("{} on axis {axis} is {value}, too close to zero: the law divides by it and means nothing within {floor}", .signal.name())]
    Singular {
        /// What it is.
        signal: Signal,
        /// Its axis.
        axis: usize,
        /// Its value.
        value: f64,
        /// How close it may come.
        floor: f64,
    },
}

/// `now_s` if it is a time after `last_s`, else `last_s`.
pub(crate) fn later(last_s: Option<f64>, now_s: f64) -> Option<f64> {
    if now_s.is_finite() && last_s.is_none_or(|last_s| now_s > last_s) { Some(now_s) } else { last_s }
}

/// Checks that all values are numbers.
pub(crate) fn finite(what: &'static str, values: &[f64]) -> Result<(), StepError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(StepError::NotFinite { what, value: *value }),
        None => Ok(()),
    }
}
