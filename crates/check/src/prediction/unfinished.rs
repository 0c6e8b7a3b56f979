//! A simulation of the reference dynamics alone, to its end.

use std::ops::ControlFlow;

use forwardstep_sim::{Ending, Progress, Recording, Setup, SetupError, simulate};
use thiserror::Error;

/// Why the reference dynamics alone were not simulated to the end.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unfinished {
    /// The setup has no meaning.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// They could not be integrated.
    #[error("the reference dynamics alone break down at {t_s} s")]
    BrokeDown {
        /// When, s.
        t_s: f64,
    },
    /// The observer asked to stop.
    #[error("the prediction was interrupted")]
    Interrupted,
}

/// What a simulation of `ideal` records.
pub(super) fn completed(
    ideal: &Setup,
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Recording, Unfinished> {
    let outcome = simulate(ideal, observer)?;
    match outcome.ending {
        Ending::Completed => Ok(outcome.recording),
        Ending::Interrupted { .. } | Ending::CutOff { .. } => Err(Unfinished::Interrupted),
        Ending::BrokeDown(breakdown) => Err(Unfinished::BrokeDown { t_s: breakdown.t_s }),
    }
}
