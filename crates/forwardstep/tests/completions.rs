//! Scripts for shells.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used)]

use assert_cmd::Command;
use assert_cmd::assert::Assert;

fn forwardstep(arguments: &[&str]) -> Assert {
    Command::cargo_bin("forwardstep").unwrap().args(arguments).assert()
}

#[test]
fn shells_complete_commands() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = forwardstep(&["completions", shell]).success();
        let script = String::from_utf8(script.get_output().stdout.clone()).unwrap();
        for word in ["forwardstep", "scenarios", "robot", "completions", "ignore-friction"] {
            assert!(script.contains(word), "{shell}: no {word}");
        }
    }
    forwardstep(&["completions", "basic"]).code(2);
}
