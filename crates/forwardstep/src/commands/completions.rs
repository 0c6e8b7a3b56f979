//! `forwardstep completions`, and what the shell then asks for.

use std::ffi::OsString;

use clap::CommandFactory;
use clap_complete::env::Shells;
use clap_complete::{CompleteEnv, Shell};

use crate::arguments::Arguments;
use crate::console::{Console, Plain, complain};
use crate::status::Status;

/// Under this variable the script of a shell asks what could be typed next.
const ASKED: &str = "FORWARDSTEP_COMPLETE";
const PROGRAM: &str = env!("CARGO_PKG_NAME");

/// Prints the script that completes commands, options, scenarios and robots in `shell`. It asks the program on PATH each time, so that it
/// knows the files that are there.
pub(crate) fn completions(shell: Shell, console: &mut Console) -> Status {
    // Into memory first: the generator knows no closed pipe.
    let mut script = Vec::new();
    let shells = Shells::builtins();
    let written = shells
        .completer(&shell.to_string())
        .map(|shell| shell.write_registration(ASKED, PROGRAM, PROGRAM, PROGRAM, &mut script));
    match written {
        Some(Err(error)) => complain(&Plain::new(error)),
        Some(Ok(())) => {
            console.verbatim(String::from_utf8_lossy(&script));
            Status::Fine
        }
        // Both lists have the same shells.
        None => Status::Fine,
    }
}

/// Answers a shell that asks; whether one did.
pub(crate) fn asked(arguments: &[OsString]) -> Option<Status> {
    if arguments.is_empty() || std::env::var_os(ASKED).is_none() {
        return None;
    }
    let here = std::env::current_dir().ok();
    let answer = CompleteEnv::with_factory(Arguments::command).var(ASKED).bin(PROGRAM).completer(PROGRAM);
    match answer.try_complete(arguments, here.as_deref()) {
        Ok(true) => Some(Status::Fine),
        Ok(false) => None,
        Err(error) => Some(complain(&Plain::new(error))),
    }
}
