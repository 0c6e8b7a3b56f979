//! The program `forwardstep`.

use std::process::ExitCode;

use forwardstep::io::scenario::kinds::Kinds;

fn main() -> ExitCode {
    forwardstep::program(&Kinds::shipped())
}
