//! The program `forwardstep`.

use std::process::ExitCode;

use forwardstep::io::scenario::kinds::Kinds;

/// The allocator of musl asks the system for memory thousands of times in a run, where others do so a few times.
#[cfg(target_env = "musl")]
#[global_allocator]
static ALLOCATOR: dlmalloc::GlobalDlmalloc = dlmalloc::GlobalDlmalloc;

fn main() -> ExitCode {
    forwardstep::program(&Kinds::shipped())
}
