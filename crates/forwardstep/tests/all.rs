//! What the program does for people, as one program: each file is a module of it, so that what they share is compiled once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "tests")]

mod architecture;
mod book;
mod bounded;
mod certificates;
mod changes;
mod check;
mod cli;
mod compare;
mod completions;
mod deployed;
mod documents;
mod examples;
mod falsify;
mod hostile;
mod hypotheses;
mod journal;
mod meshes;
mod new;
mod own_delay;
mod own_kind;
mod own_reference;
mod pushes;
mod refused;
mod report;
mod robot;
mod rows;
mod safe;
mod shipped;
mod stepped;
mod support;
mod upgrade;
