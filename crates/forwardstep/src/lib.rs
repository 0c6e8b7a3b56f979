//! Forwardstepping control of networked robots: design, check, simulate.
//!
//! This crate gathers the others under one name. A first program:
//!
//! ```
#![doc = include_str!("../examples/first.rs")]
//! ```
//!
//! | module | what is in it |
//! |---|---|
//! | [`core`] | robots, reference dynamics, tracking laws; no clocks, no files |
//! | [`sim`] | switching, delayed networks and their simulation |
//! | [`check`] | hypotheses of the theorems with witnesses, predictions |
#![cfg_attr(feature = "files", doc = "| [`io`] | scenario and URDF files in; tables and reports out |")]
//!
//! | feature | what it adds |
//! |---|---|
//! | none | `core`, `sim` and `check` |
//! | `files` | `io`, which reads scenario and URDF files, from memory too |
//! | `report` | `io::output`: tables, plots and the page of a run |
//! | `program`, the default | the program `forwardstep`, and `program` for programs that know further kinds of robots and laws |

// The commands speak of this crate as everybody else does.
#[cfg(feature = "program")]
extern crate self as forwardstep;

#[cfg(feature = "program")]
mod arguments;
#[cfg(feature = "program")]
mod commands;
#[cfg(feature = "program")]
mod console;
#[cfg(feature = "program")]
mod falsify;
#[cfg(feature = "program")]
mod mistake;
#[cfg(feature = "program")]
mod number;
#[cfg(feature = "files")]
pub mod own;
#[cfg(feature = "program")]
mod program;
#[cfg(feature = "program")]
mod status;

pub use forwardstep_check as check;
pub use forwardstep_core as core;
#[cfg(feature = "files")]
pub use forwardstep_io as io;
pub use forwardstep_sim as sim;
#[cfg(feature = "program")]
pub use program::{program, program_with};
