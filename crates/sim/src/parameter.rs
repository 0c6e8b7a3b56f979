//! Parameters that make no sense.

use thiserror::Error;

/// A parameter of a delay or of a switching signal that makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{parameter} is {value}, but {requirement}")]
pub struct ParameterError {
    /// The parameter, in words.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

impl ParameterError {
    /// The parameter must be finite and not negative.
    ///
    /// # Errors
    /// When it is not.
    pub fn unless_non_negative(parameter: &'static str, value: f64) -> Result<(), ParameterError> {
        ParameterError::unless(value >= 0.0 && value.is_finite(), parameter, value, "must be finite and not negative")
    }

    /// The parameter must be positive and finite.
    ///
    /// # Errors
    /// When it is not.
    pub fn unless_positive(parameter: &'static str, value: f64) -> Result<(), ParameterError> {
        ParameterError::unless(value > 0.0 && value.is_finite(), parameter, value, "must be positive and finite")
    }

    /// The parameter must be what makes `good` true.
    ///
    /// # Errors
    /// When it is not.
    pub fn unless(
        good: bool,
        parameter: &'static str,
        value: f64,
        requirement: &'static str,
    ) -> Result<(), ParameterError> {
        if good { Ok(()) } else { Err(ParameterError { parameter, value, requirement }) }
    }
}
