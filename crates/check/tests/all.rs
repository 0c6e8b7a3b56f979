//! What is said of setups, as one program: each file is a module of it, so that what they share is compiled once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod agreement;
mod common;
mod footing;
mod hypotheses;
mod identities;
mod laws;
mod leader;
mod links;
mod network;
mod null_vectors;
mod outside;
mod periods;
mod predictions;
mod pushes;
mod robots;
mod schedules;
mod verdicts;
