//! What the fuzzers have in common: how the program meets a file, and what must hold whatever the file says.
//!
//! Everything here fails by panicking, which is how a fuzzer reports.

mod complaint;
#[path = "../../crates/forwardstep/src/commands/dynamics.rs"]
#[allow(dead_code, reason = "the program prints the help")]
mod dynamics;
mod robots;
mod runs;
mod scratch;
mod stopwatch;

pub use complaint::{complaint, one_line};
pub use robots::{described, moved};
pub use runs::{open, tried};
pub use scratch::Scratch;
pub use stopwatch::{prompt, within};
