//! What the laws, the robots and the formulas do, as one program: each file is a module of it, so that what they share is compiled once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod assemble;
mod bits;
mod bounded_estimates;
mod chains;
mod common;
mod composite;
mod controllers;
mod expression;
mod expressions;
mod external;
mod gain;
mod inertia;
mod lengths;
mod mailbox;
mod model_reference;
mod observer;
mod passivity_filter;
mod prop_lagrangian;
mod prop_tree;
mod sampled;
mod spacecraft;
mod task_space;
mod val_pinocchio;
mod vector_chains;
