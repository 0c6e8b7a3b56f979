//! `forwardstep falsify`, a minute of it, and `forwardstep attack`.
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
    assert!(count(&said, "whose spread shrank at least by what is guaranteed") > 5, "{said}");
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

#[test]
fn attack_finds_a_network_over_which_a_broken_hypothesis_matters() {
    let folder = folder();
    for (target, id) in [("a1-first-roots", "common-first-root"), ("119-weights", "constant-weights")] {
        let said = stdout(&forwardstep(&folder, &["attack", target, "--seconds", "60", "--out", "found.toml"]).code(0));
        assert!(said.contains("fails: ") && said.contains(&format!("do not hold for it: {id}\n")), "{target}: {said}");
        // What is saved is a scenario that says the same of itself.
        let check = stdout(&forwardstep(&folder, &["check", "found.toml", "--accept", id]).code(0));
        assert!(check.contains(&format!("[{id}]")), "{check}");
        forwardstep(&folder, &["run", "found.toml", "--out", "run", "--force"]);
        let summary = fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let gap = &summary["metrics"]["disagreement"]["measured"];
        let [initial, last] = ["initial", "last"].map(|when| gap[when].as_f64().unwrap());
        assert!(last > 0.05 * initial, "{target}: {last} from {initial}");
    }
}

#[test]
fn attack_inside_a_theorem_finds_nothing_that_grows() {
    let folder = folder();
    for target in ["a1", "24"] {
        let said = stdout(&forwardstep(&folder, &["attack", target, "--seconds", "3", "--out", "found.toml"]).code(0));
        let percent = said.split("worst: ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        let percent: f64 = percent.parse().unwrap_or_else(|_| panic!("{said}"));
        assert!(percent > 0.0 && percent < 100.0 && said.contains("do not hold for it: none\n"), "{said}");
    }
    forwardstep(&folder, &["attack", "a1", "--seconds", "1", "--out", "no/such/folder.toml"]).code(2);
}
