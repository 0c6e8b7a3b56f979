//! `forwardstep falsify`: a minute of it, and what it does with what it finds.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;

use support::{folder, forwardstep, stdout};

/// A number of the summary.
fn count(said: &str, words: &str) -> u64 {
    let line = said.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{words}\n{said}"));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn nothing_is_refuted_in_a_minute() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["falsify", "--seconds", "60", "--cases", "2000", "--seed", "7"]).code(0));
    assert_eq!(count(&said, "refuted"), 0, "{said}");
    // However slow the machine, some of each kind were judged.
    assert!(count(&said, "whose spread never grew") > 10, "{said}");
    assert!(count(&said, "whose error falls") > 10, "{said}");
    assert!(!folder.path().join("forwardstep-refuted").exists());
}

#[test]
fn the_same_seed_draws_the_same_cases() {
    let folder = folder();
    let said = |seed: &str| stdout(&forwardstep(&folder, &["falsify", "--cases", "24", "--seed", seed]).code(0));
    assert_eq!(said("3"), said("3"));
    assert_ne!(said("3"), said("4"));
    assert!(said("3").starts_with("24 cases of seed 3\n"));
}

#[test]
fn a_folder_that_cannot_be_written_to_is_no_matter_while_nothing_is_refuted() {
    let folder = folder();
    fs::write(folder.path().join("taken"), "a file").unwrap();
    forwardstep(&folder, &["falsify", "--cases", "2", "--out", "taken"]).code(0);
}
