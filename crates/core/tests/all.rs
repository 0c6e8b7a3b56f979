//! What robots and their laws do, as one program: each file is a module of it, so that what they share is compiled once. What shares nothing with
//! them is `parts.rs`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod common;
mod controllers;
mod inertia;
mod model_reference;
mod passivity_filter;
mod prop_lagrangian;
mod prop_tree;
mod spacecraft;
mod task_space;
mod val_pinocchio;
