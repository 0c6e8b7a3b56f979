//! Why digital control is refused.

use thiserror::Error;

use crate::wording::number;

/// Why digital control has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ControlProblem {
    /// A computation that takes longer than a period.
    #[error("`computation_delay_s` is {}, but the next sample is taken after {} s", number(*.delay_s), number(*.period_s))]
    ComputationDelay {
        /// The delay, s.
        delay_s: f64,
        /// The period, s.
        period_s: f64,
    },
    /// A property of measured velocities where none are measured.
    #[error("`{key}` has no effect: velocities are not measured, but come from filtered differences")]
    VelocityNotMeasured {
        /// The key.
        key: &'static str,
    },
    /// A list with an entry for each axis has another length.
    #[error("`{key}` has {found} where the agents have {need} {}", if *.need == 1 { "axis" } else { "axes" })]
    AxisCount {
        /// The key.
        key: &'static str,
        /// Entries that were found.
        found: usize,
        /// Axes.
        need: usize,
    },
}

impl ControlProblem {
    /// What to do about it.
    pub fn help(&self) -> Option<String> {
        let text = match self {
            ControlProblem::ComputationDelay { .. } => {
                "a computation must be done before the next begins; sample more slowly, or compute faster".into()
            }
            ControlProblem::VelocityNotMeasured { .. } => {
                "delete it, or let `velocity` be \"measured\"; noise and steps of positions count".into()
            }
            ControlProblem::AxisCount { .. } => "a single number stands for all axes".into(),
        };
        Some(text)
    }
}
