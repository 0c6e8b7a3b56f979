//! What the author of an accepted scenario should know.

use std::fmt;

use crate::urdf;
use crate::wording::enumerate;

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
    /// A log has packets of edges that the network does not have.
    UnusedInLog {
        /// The log.
        file: String,
        /// Names of sender and receiver.
        links: Vec<(String, String)>,
    },
    /// Links on which no packet arrives before the end of the run.
    NothingArrives {
        /// Names of sender and receiver.
        links: Vec<(String, String)>,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::Robot { agents, notice } => write!(f, "{agents}: {notice}"),
            Notice::UnusedDwell { line } => write!(f, "`dwell_s` on line {line} is not used"),
            Notice::UnusedInLog { file, links } => {
                write!(f, "the packets of {} in `{file}` are not used: the network has no such edge", named(links))
            }
            Notice::NothingArrives { links } => {
                write!(
                    f,
                    "no packet of {} arrives before the end of the run: the initial message is heard",
                    named(links)
                )
            }
        }
    }
}

/// "a → b and c → d".
fn named(links: &[(String, String)]) -> String {
    enumerate(links.iter().map(|(from, to)| format!("{from} → {to}")))
}
