//! A table, read by every scenario in `tables/` that names it.

#![no_main]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use forwardstep_fuzz::{Scratch, open, tried};
use libfuzzer_sys::fuzz_target;

/// The folder, and the scenarios in it, which name `fuzzed.csv`.
static SCENARIOS: LazyLock<(Scratch, Vec<PathBuf>)> = LazyLock::new(|| {
    let scratch = Scratch::new();
    let tables = Path::new(env!("CARGO_MANIFEST_DIR")).join("tables");
    let mut paths: Vec<PathBuf> = fs::read_dir(tables)
        .expect("the folder of scenarios")
        .map(|entry| entry.expect("a scenario").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| {
            let text = fs::read_to_string(&path).expect("a scenario");
            assert!(text.contains("\"fuzzed.csv\""), "{} names another table", path.display());
            scratch.write(path.file_name().and_then(|name| name.to_str()).expect("a name"), text.as_bytes())
        })
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    (scratch, paths)
});

fuzz_target!(|bytes: &[u8]| {
    let (scratch, scenarios) = &*SCENARIOS;
    scratch.write("fuzzed.csv", bytes);
    for path in scenarios {
        if let Some(scenario) = open(path) {
            tried(scratch, scenario);
        }
    }
});
