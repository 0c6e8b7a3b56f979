//! What is wrong with limits of actuators.

use forwardstep_core::LengthError;
use forwardstep_core::agent::LimiterError;
use thiserror::Error;

/// Why limits of actuators have no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LimitError {
    /// Limits of torques where the robot has another number of torques.
    #[error(transparent)]
    Torques(LengthError),
    /// The same of how fast torques change.
    #[error(transparent)]
    Rates(LengthError),
    /// Limits are to be enforced, but an axis has none.
    #[error("limits are to be enforced, but axis `{axis}` has no effort limit")]
    NoEffortLimit {
        /// The axis.
        axis: String,
    },
    /// An effort limit that cannot be enforced.
    #[error("the effort limit of `{axis}` is {value}, but it must be positive where limits are enforced")]
    EffortLimit {
        /// The axis.
        axis: String,
        /// The limit, N m or N.
        value: f64,
    },
    /// A torque limit that no step of the torques lies within.
    #[error(
        "axis {axis} has the torque limit {limit}, which is below the step of the torques, {step}: no torque but zero can be given; raise the \
         limit, or make the step smaller"
    )]
    BelowStep {
        /// The axis, from zero.
        axis: usize,
        /// The limit, N m or N.
        limit: f64,
        /// The step, N m or N.
        step: f64,
    },
    /// A torque limit, or how fast a torque may change.
    #[error(transparent)]
    Limiter(LimiterError),
}
