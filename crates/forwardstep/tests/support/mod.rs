//! The program in a folder of its own, and what it said and wrote there.
#![allow(clippy::unwrap_used, dead_code, unreachable_pub, reason = "each test uses its own part")]

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use tempfile::TempDir;

/// Every so many of these, and all of them where `.ci/long` asks for that.
pub fn some<T>(all: impl IntoIterator<Item = T>, every: usize) -> impl Iterator<Item = T> {
    all.into_iter().step_by(if is_long() { 1 } else { every })
}

/// Whether tests may take as long as before a release.
pub fn is_long() -> bool {
    std::env::var_os("FORWARDSTEP_LONG").is_some()
}

pub fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn forwardstep(folder: &TempDir, arguments: &[&str]) -> Assert {
    Command::cargo_bin("forwardstep").unwrap().current_dir(folder).args(arguments).assert()
}

pub fn stdout(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

pub fn stderr(assert: &Assert) -> String {
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

/// The names of what is in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Every file of a folder that a report is made of, by name.
fn pictures(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = vec![folder.join("report.html")];
    files.extend(fs::read_dir(folder.join("plots")).unwrap().map(|entry| entry.unwrap().path()));
    files.sort();
    files.into_iter().map(|file| (file.display().to_string(), fs::read(&file).unwrap())).collect()
}

/// The report and the plots of a run are the same when `program` draws them again from its tables.
pub fn assert_report_is_rebuilt(program: fn(&[&str]) -> ExitCode, run: &Path) {
    let drawn = pictures(run);
    assert!(drawn.len() > 2);
    fs::remove_file(run.join("report.html")).unwrap();
    fs::remove_dir_all(run.join("plots")).unwrap();
    assert_eq!(program(&["report", run.to_str().unwrap()]), ExitCode::SUCCESS);
    assert_eq!(pictures(run), drawn, "the same from the tables");
}
