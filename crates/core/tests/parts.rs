//! Formulas, chains, what is measured, sent and held: what shares no robots with `all.rs`, compiled beside it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod assemble;
mod bits;
mod bounded_estimates;
mod chains;
mod composite;
mod expression;
mod expressions;
mod external;
mod gain;
mod lengths;
mod mailbox;
mod observer;
mod sampled;
mod vector_chains;
