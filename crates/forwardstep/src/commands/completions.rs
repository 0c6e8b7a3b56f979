//! `forwardstep completions`

use clap::CommandFactory;
use clap_complete::Shell;

use crate::arguments::Arguments;
use crate::console::Console;
use crate::status::Status;

/// Prints the script that completes commands and options in `shell`.
pub(crate) fn completions(shell: Shell, console: &mut Console) -> Status {
    // Into memory first: the generator knows no closed pipe.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), env!("CARGO_PKG_NAME"), &mut script);
    console.verbatim(String::from_utf8_lossy(&script));
    Status::Fine
}
