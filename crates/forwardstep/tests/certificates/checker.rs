//! The checker as a program: its own tests, its files, its length; and the program that writes what it reads.

use std::fs;
use std::path::Path;

use super::{certified, checked, file_of, python, root};
use crate::support::{folder, forwardstep, stderr, stdout};
use forwardstep::io::scenario::SHIPPED_SCENARIOS;

#[test]
fn pairs_that_were_tampered_with_are_judged_as_the_truth_says() {
    let folder = folder();
    for scenario in SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name) {
        certified(file_of(scenario).to_str().unwrap(), folder.path());
    }
    for case in [
        "formulas",
        "cut",
        "friction",
        "bounds",
        "desired-target",
        "logs",
        "slider",
        "drawn-graph",
        "model-reference",
        "tip-velocity",
    ] {
        certified(root().join(format!("checker/cases/{case}.toml")).to_str().unwrap(), folder.path());
    }
    let output = python(&["-m", "unittest", "test_checker"], folder.path());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_program_writes_a_certificate_whose_digests_count_until_they_are_ignored() {
    let folder = folder();
    let text = fs::read_to_string(file_of("theorem-2")).unwrap();
    fs::write(folder.path().join("own.toml"), &text).unwrap();
    forwardstep(&folder, &["check", "own.toml", "--certificate", "own.json"]).code(0);
    let [certificate, scenario] = ["own.json", "own.toml"].map(|name| folder.path().join(name));
    let status = |more: &[&str]| {
        let files = [certificate.to_str().unwrap(), scenario.to_str().unwrap()];
        let output = python(&[&["forwardstep_checker.py"], &files[..], more].concat(), Path::new(""));
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let (code, said) = status(&[]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("accepted: spanning-tree, holds") && said.ends_with("all in all: accepted\n"), "{said}");
    // A comment changes nothing but the digest.
    fs::write(&scenario, format!("# another\n{text}")).unwrap();
    let (code, said) = status(&[]);
    assert!(code == 1 && said.contains("(certificate.scenario.sha256)"), "{said}");
    assert_eq!(status(&["--ignore-digests"]).0, 0);
    // Without its second graph nothing of the first three arms reaches the others.
    let without = text.replace(r#"["arm-2", "arm-3"],"#, "").replace(r#"["arm-4", "arm-5"],"#, "");
    fs::write(&scenario, without).unwrap();
    let (code, said) = status(&["--ignore-digests"]);
    let place = "certificate.hypotheses[0].proof.windows[0].arborescence[1]";
    assert!(code == 1 && said.contains(&format!("is no edge of this phase ({place})")), "{said}");
}

/// Each a shipped scenario with a change that violates one hypothesis.
#[test]
fn every_answer_violated_comes_with_a_witness_that_is_replayed() {
    let folder = folder();
    let cases = [
        ("theorem-2", "spanning-tree", vec![(r#"["arm-2", "arm-3"],"#, ""), (r#"["arm-4", "arm-5"],"#, "")]),
        ("theorem-8", "leader-reaches-all", vec![(r#"["leader", "arm-1"], "#, "")]),
        ("leader-over-turns", "leader-in-every-graph", vec![(r#"["leader", "arm-4"], "#, "")]),
        ("theorem-8", "sign-gain", vec![("gain = 2 ", "gain = 0.5 ")]),
        (
            "saturated-coupling",
            "input-factor",
            vec![("parameters = [-0.5, 0.7] }", r#"parameters = [-0.5, 0.7], psi = "1e-4" }"#)],
        ),
    ];
    for (scenario, id, changes) in cases {
        let mut text = fs::read_to_string(file_of(scenario)).unwrap();
        for (old, new) in changes {
            assert!(text.contains(old), "{scenario}: {old}");
            text = text.replace(old, new);
        }
        let file = folder.path().join(format!("{scenario}.toml"));
        fs::write(&file, text).unwrap();
        let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
        assert_eq!(found["violated"], serde_json::json!([id]), "{found}");
        let rejected = found["entries"].as_array().unwrap().iter().any(|entry| entry["outcome"] == "rejected");
        assert!(!rejected, "{found}");
    }
}

#[test]
fn a_certificate_that_cannot_be_written_is_an_error() {
    let folder = folder();
    let failed = forwardstep(&folder, &["check", "theorem-2", "--certificate", "nowhere/own.json"]).code(2);
    assert!(stderr(&failed).contains("nowhere/own.json"), "{}", stderr(&failed));
    assert!(stdout(&failed).is_empty());
}

#[test]
fn the_checker_is_short_enough_to_be_read() {
    let text = fs::read_to_string(root().join("checker/forwardstep_checker.py")).unwrap();
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
    let lines = text.lines().filter(is_code).count();
    assert!(lines <= 1500, "{lines} lines that are neither blank nor a comment");
    assert!(text.lines().all(|line| line.chars().count() <= 140));
}
