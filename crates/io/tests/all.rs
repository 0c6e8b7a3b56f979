//! What is read and written, as one program: each file is a module of it, so that what they share is compiled once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod folders;
mod forged_tables;
mod formulas;
mod journal;
mod metrics;
mod names;
mod output;
mod restore;
mod run_folders;
mod sampled;
mod scenario;
mod seeds;
mod shapes;
mod state;
mod strange_files;
mod support;
mod urdf;
mod vector_chains;
