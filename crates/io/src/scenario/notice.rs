//! What the author of an accepted scenario should know.

use std::fmt;

use crate::urdf;

/// Something in an accepted scenario that the user should know about.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Notice {
    /// A remark of the reader of a robot file.
    Robot {
        /// The agent that has this robot, or the first and last of a population.
        agents: String,
        /// The remark.
        notice: Box<urdf::Notice>,
    },
    /// A `dwell_s` that has no effect: of the last phase of a network that switches once, or under random switching.
    UnusedDwell {
        /// Its line in the scenario.
        line: usize,
    },
    /// A push that has no effect on the run.
    IdlePush {
        /// Its line in the scenario.
        line: usize,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Robot { agents, notice } => write!(f, "{agents}: {notice}"),
            Notice::UnusedDwell { line } => write!(f, "`dwell_s` on line {line} is not used"),
            Notice::IdlePush { line } => write!(f, "the push on line {line} does not act during the run"),
        }
    }
}
