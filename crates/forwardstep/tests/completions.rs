//! Scripts for shells.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used)]

use assert_cmd::Command;
use assert_cmd::assert::Assert;

fn forwardstep(arguments: &[&str]) -> Assert {
    Command::cargo_bin("forwardstep").unwrap().args(arguments).assert()
}

#[test]
fn every_command_has_a_manual_page() {
    let page = forwardstep(&["man"]).success();
    let page = String::from_utf8(page.get_output().stdout.clone()).unwrap();
    assert!(page.contains(".TH forwardstep 1") && page.contains("sampling\\-limit"), "{page}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    forwardstep(&["man", path]).success();
    for name in ["forwardstep", "forwardstep-run", "forwardstep-new", "forwardstep-man"] {
        let page = std::fs::read_to_string(folder.path().join(format!("{name}.1"))).unwrap();
        assert!(page.contains(&format!(".TH {name} 1")), "{page}");
    }
    forwardstep(&["man", &format!("{path}/none")]).code(2);
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
