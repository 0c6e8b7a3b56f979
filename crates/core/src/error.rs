//! Errors of building laws and gains.

use alloc::boxed::Box;

use thiserror::Error;

use crate::Indefinite;

/// A slice of the wrong length was handed to a checked entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{what} has {got} entries where {need} are needed")]
pub struct LengthError {
    /// What the slice holds, for example `"joint positions"`.
    pub what: &'static str,
    /// The length that was needed.
    pub need: usize,
    /// The length that was given.
    pub got: usize,
}

impl LengthError {
    /// `Ok` when `got == need`.
    pub fn check(what: &'static str, need: usize, got: usize) -> Result<(), Self> {
        if got == need { Ok(()) } else { Err(LengthError { what, need, got }) }
    }
}

/// A gain that is not symmetric positive definite, or not of the right size.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GainError {
    /// The matrix or list has the wrong number of entries.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// An entry that must be positive and finite is not.
    #[error("entry {index} is {value}, but must be positive and finite")]
    NotPositive {
        /// Position in the list, from zero.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// The matrix differs from its transpose.
    #[error(
        "entries ({row}, {column}) and ({column}, {row}) differ: {upper} and {lower}; the matrix must be symmetric"
    )]
    NotSymmetric {
        /// Row, from zero.
        row: usize,
        /// Column, from zero.
        column: usize,
        /// Entry (row, column).
        upper: f64,
        /// Entry (column, row).
        lower: f64,
    },
    /// The matrix A is not positive definite, as a direction v shows.
    #[error("the matrix is not positive definite: {0}")]
    NotPositiveDefinite(Box<Indefinite>),
    /// Whatever the matrix is, rounding leaves no Cholesky factor of it.
    #[error("the matrix is so close to a singular one that its leading minor of order {order} is lost to rounding")]
    NearlySingular {
        /// Order of the first minor that is lost, from one.
        order: usize,
    },
    /// A bandwidth was given where nothing says what it should be multiplied by.
    #[error("a bandwidth of {bandwidth_per_s} per second needs a scale of {need} entries, but {got} were given")]
    NoScale {
        /// The bandwidth asked for.
        bandwidth_per_s: f64,
        /// How many scale entries are needed.
        need: usize,
        /// How many were given.
        got: usize,
    },
}
