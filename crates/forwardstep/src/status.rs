//! Exit statuses.

use std::process::ExitCode;

/// How the program ended. The numbers are part of its interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Status {
    /// All went well.
    Fine = 0,
    /// `check`: a hypothesis does not hold. `run`: the scenario's own goal was missed.
    Missed = 1,
    /// Invalid input, or a place that cannot be written to.
    BadInput = 2,
    /// The run broke down numerically; what was computed is written.
    BrokeDown = 3,
    /// Ctrl-C; what was computed is written.
    Interrupted = 130,
    /// SIGTERM; what was computed is written.
    Terminated = 143,
    /// SIGHUP; what was computed is written.
    HungUp = 129,
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> ExitCode {
        ExitCode::from(status as u8)
    }
}
