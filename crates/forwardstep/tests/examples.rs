//! The examples run and say what is true.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// An example as `cargo test` has built it.
fn example(name: &str) -> Command {
    let this = std::env::current_exe().unwrap();
    let built = this.parent().unwrap().parent().unwrap().join("examples").join(name);
    let built = built.with_extension(std::env::consts::EXE_EXTENSION);
    let changed = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    let source = changed(&folder().join(name).with_extension("rs"));
    let hint = "`cargo build --examples` builds it, and so does `cargo test` without `--test`";
    assert!(source.is_some() && changed(&built) >= source, "{name} is not built, or is older than its source: {hint}");
    Command::new(built)
}

/// What it prints, line by line, when all goes well.
fn printed(name: &str, arguments: &[&str]) -> Vec<String> {
    let Output { status, stdout, stderr } = example(name).args(arguments).output().unwrap();
    let (stdout, stderr) = (String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap());
    assert!(status.success() && stderr.is_empty(), "{name}: {status}\n{stdout}{stderr}");
    stdout.lines().map(str::to_owned).collect()
}

/// The numbers of a line.
fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

#[test]
fn two_masses_agree_in_a_program_of_at_most_25_lines() {
    let lines = printed("first", &[]);
    assert_eq!(lines.len(), 11);
    assert_eq!(numbers(&lines[0]), [0.0, 0.0, 1.0]);
    let last = numbers(&lines[10]);
    assert!((last[1] - last[2]).abs() < 1e-3 && last[1] > 0.1 && last[1] < 0.9, "{last:?}");
    assert!(fs::read_to_string(folder().join("first.rs")).unwrap().lines().count() <= 25);
}

#[test]
fn a_law_of_ones_own_follows_with_a_balance_that_closes() {
    let lines = printed("own_law", &[]);
    let [continuous, balance, sampled] = &lines[..] else { panic!("{lines:?}") };
    let [continuous, balance, sampled] = [continuous, balance, sampled].map(|line| *numbers(line).last().unwrap());
    assert!(continuous < 1e-3 && balance < 1e-5 && sampled < 1e-2, "{lines:?}");
    assert!(balance > 0.0 && sampled != continuous, "{lines:?}");
}

#[test]
fn controllers_stepped_by_hand_agree_over_a_radio_that_loses_packets() {
    let lines = printed("stepped", &[]);
    assert_eq!(lines.len(), 7, "{lines:?}");
    assert_eq!(numbers(&lines[0]), [0.0, 0.0, 1.0]);
    let last = numbers(&lines[5]);
    assert!((last[1] - last[2]).abs() < 1e-3, "{last:?}");
    assert_eq!(numbers(&lines[6]).len(), 2);
}

#[test]
fn robots_from_a_urdf_have_dynamics_and_agree() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../io/robots/gantry.urdf");
    for (arguments, axes) in [(&[][..], 6), (&[file.to_str().unwrap()][..], 3)] {
        let lines = printed("urdf", arguments);
        assert_eq!(lines.len(), 2 * axes, "{lines:?}");
        for line in &lines[axes..] {
            let [left, right] = numbers(line)[..] else { panic!("{line}") };
            assert!((left - right).abs() < 1e-2, "{line}");
        }
    }
    let missing = example("urdf").arg("nowhere.urdf").output().unwrap();
    assert!(!missing.status.success());
}

#[test]
fn a_program_of_ones_own_knows_its_kinds() {
    let lines = printed("tank", &["schema"]);
    assert!(lines.iter().any(|line| line.contains("inflow_limit_m3_s")));
}

#[test]
fn every_example_is_run_by_a_test() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let texts: Vec<String> =
        fs::read_dir(tests).unwrap().filter_map(|entry| fs::read_to_string(entry.unwrap().path()).ok()).collect();
    for entry in fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned();
        let runs = [format!("printed(\"{name}\""), format!("../examples/{name}.rs\"]")];
        assert!(texts.iter().any(|text| runs.iter().any(|run| text.contains(run))), "no test runs {name}.rs");
    }
}
