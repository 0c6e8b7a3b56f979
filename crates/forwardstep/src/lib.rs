//! Forwardstepping control of networked robots: design, check, simulate.
//!
//! This crate gathers the others under one name, and holds the program `forwardstep`: [`program`] is it, for programs that know
//! further kinds of robots and laws.
//!
//! | module | what is in it |
//! |---|---|
//! | [`core`] | robots, reference dynamics, tracking laws; no clocks, no files |
//! | [`sim`] | switching, delayed networks and their simulation |
//! | [`check`] | hypotheses of the theorems with witnesses, predictions |
//! | [`io`] | scenario and URDF files in; tables and reports out |
//!
//! ```
//! use std::ops::ControlFlow;
//!
//! use forwardstep::io::scenario::open_scenario;
//! use forwardstep::sim::{Signal, simulate};
//!
//! let mut scenario = open_scenario("first-order")?;
//! scenario.setup.time.end_s = 2.0;
//! let outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(()))?;
//! let positions = outcome.recording.columns.iter().filter(|column| column.signal == Signal::Position);
//! assert_eq!(positions.count(), 4 * 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// The commands speak of this crate as everybody else does.
extern crate self as forwardstep;

mod arguments;
mod commands;
mod console;
pub mod own;
mod program;
mod status;

pub use forwardstep_check as check;
pub use forwardstep_core as core;
pub use forwardstep_io as io;
pub use forwardstep_sim as sim;
pub use program::{program, program_with};
