//! What runs do, as one program: each file is a module of it, so that what they share is compiled once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod cases;
mod chains;
mod common;
mod determinism;
mod edges;
mod failures;
mod following;
mod forcing;
mod formulas;
mod friction;
mod history;
mod joint_tracking;
mod kinks;
mod lanes;
mod law_quantities;
mod leading;
mod limits;
mod links;
mod model_reference;
mod outside;
mod own_reference;
mod position_only;
mod probe;
mod pushed_kinds;
mod pushes;
mod quantities;
mod recipes;
mod sampled;
mod schedules;
mod ship;
mod single;
mod trajectories;
mod unused;
mod vehicles;
