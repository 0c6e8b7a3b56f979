//! The rules of ARCHITECTURE.md that can be read off manifests and sources.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

/// Crates from the ground up; each may depend on those before it.
const LAYERS: [&str; 5] = ["core", "sim", "check", "io", "forwardstep"];

fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn manifest(layer: &str) -> Table {
    fs::read_to_string(crates().join(layer).join("Cargo.toml")).unwrap().parse().unwrap()
}

/// What a crate needs when it is not being tested.
fn dependencies(layer: &str) -> BTreeSet<String> {
    let manifest = manifest(layer);
    let targets = manifest.get("target").and_then(Value::as_table).into_iter().flat_map(|targets| targets.values());
    let tables = [&manifest].into_iter().chain(targets.filter_map(Value::as_table)).flat_map(|part| {
        ["dependencies", "build-dependencies"].into_iter().filter_map(|key| part.get(key)?.as_table())
    });
    tables.flat_map(|table| table.keys().cloned()).collect()
}

/// A source file without comments and without its own tests.
struct Source {
    path: String,
    code: String,
}

fn sources(below: &str) -> Vec<Source> {
    let mut found = Vec::new();
    collect(&crates().join(below), &mut found);
    assert!(!found.is_empty(), "nothing in {below}");
    found
}

fn collect(path: &Path, found: &mut Vec<Source>) {
    if path.is_dir() {
        let mut entries: Vec<_> = fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        entries.iter().for_each(|entry| collect(entry, found));
    } else if path.ends_with("tests.rs") {
        // The tests of a module, which its own file includes for tests only.
    } else if path.extension().is_some_and(|extension| extension == "rs") {
        let text = fs::read_to_string(path).unwrap();
        found.push(Source { path: path.display().to_string(), code: without_tests(&text) });
    }
}

/// A source without comments, and without every item that is for tests only: from its attribute to the line that closes it.
fn without_tests(text: &str) -> String {
    let mut lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let mut kept = Vec::new();
    while let Some(line) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept.push(line);
            continue;
        }
        let indent = line.len() - line.trim_start().len();
        let ends = |line: &str| {
            let code = line.trim_end();
            code.len() - code.trim_start().len() == indent && (code.ends_with('}') || code.ends_with(';'))
        };
        lines.by_ref().find(|line| ends(line));
    }
    kept.join("\n")
}

#[test]
fn what_is_for_tests_alone_is_left_out_and_nothing_behind_it() {
    let text = "use a;\n#[cfg(test)]\nmod b;\nfn c() {\n    // d\n    #[cfg(test)]\n    e(\n        1,\n    );\n    f();\n}\n\
                #[cfg(test)]\n#[allow(g)]\nmod h {\n    fn i() {\n    }\n}\nfn j() {}\n";
    assert_eq!(without_tests(text), "use a;\nfn c() {\n    f();\n}\nfn j() {}");
    // Here much stands behind such items.
    let thrust =
        sources("core/src/controller/thrust").into_iter().find(|source| source.path.ends_with("thrust/mod.rs"));
    assert!(thrust.unwrap().code.lines().count() > 250);
}

/// Whether `code` has `word`, and not as a part of a longer one.
fn says(code: &str, word: &str) -> bool {
    let continues = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).any(|(at, _)| {
        let (before, after) = (&code[..at], &code[at + word.len()..]);
        !(word.starts_with(continues) && before.ends_with(continues)
            || word.ends_with(continues) && after.starts_with(continues))
    })
}

/// Fails when a file below `below` says one of `words`.
fn never_says(below: &str, words: &[&str]) {
    let mut said = Vec::new();
    for Source { path, code } in sources(below) {
        said.extend(words.iter().filter(|word| says(&code, word)).map(|word| format!("{path}: {word}")));
    }
    assert!(said.is_empty(), "\n{}", said.join("\n"));
}

#[test]
fn imports_run_downwards_only() {
    for (height, layer) in LAYERS.iter().enumerate() {
        let below: BTreeSet<String> = LAYERS[..height].iter().map(|layer| format!("forwardstep-{layer}")).collect();
        let own = dependencies(layer).into_iter().filter(|name| name.starts_with("forwardstep"));
        let upwards: Vec<_> = own.filter(|name| !below.contains(name)).collect();
        assert!(upwards.is_empty(), "{layer} must not depend on {upwards:?}");
    }
    let on_disk: BTreeSet<_> =
        fs::read_dir(crates()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert_eq!(on_disk, LAYERS.map(String::from).into(), "every crate has its layer");
}

#[test]
fn the_core_needs_next_to_nothing() {
    let allowed: BTreeSet<String> =
        ["libm", "num-rational", "num-traits", "pulp", "thiserror"].map(String::from).into();
    assert_eq!(dependencies("core"), allowed);
    let pulp = &manifest("core")["dependencies"]["pulp"];
    assert_eq!(pulp.get("optional"), Some(&Value::Boolean(true)), "without `std` there is no dispatch");
    let root = fs::read_to_string(crates().join("core/src/lib.rs")).unwrap();
    assert!(root.contains("#![cfg_attr(not(feature = \"std\"), no_std)]"));
}

#[test]
fn serialisation_lives_in_io_only() {
    let formats = ["serde", "serde_json", "toml", "schemars", "csv", "parquet", "roxmltree"].map(String::from).into();
    for layer in LAYERS {
        let own = dependencies(layer);
        let found: Vec<_> = own.intersection(&formats).collect();
        assert!(layer == "io" || found.is_empty(), "{layer} must not depend on {found:?}");
    }
}

#[test]
fn laws_know_no_clock_no_file_and_keep_no_secret() {
    let outside = ["std::", "Instant", "SystemTime", "t_s"];
    let hidden_state = [
        "pub static",
        "\nstatic",
        "    static",
        "Cell",
        "RefCell",
        "UnsafeCell",
        "OnceCell",
        "OnceLock",
        "LazyLock",
        "Mutex",
        "RwLock",
        "sync::atomic",
        "thread_local!",
    ];
    never_says("core/src", &outside);
    never_says("core/src", &hidden_state);
}

#[test]
fn simulation_and_verdicts_touch_no_files() {
    let world =
        ["std::fs", "std::io", "std::env", "std::net", "std::process", "print!", "println!", "eprintln!", "dbg!"];
    never_says("sim/src", &world);
    never_says("check/src", &world);
}

/// What the page has in common with pictures for print and with words stands beside it.
#[test]
fn pictures_and_words_take_nothing_from_the_page() {
    for below in ["plots", "comparison", "formula", "guarantee.rs", "prediction", "residuals.rs", "explanation.rs"] {
        for Source { path, code } in sources(&format!("io/src/output/{below}")) {
            // A comparison has a page of its own.
            let code = code.replace("report::side_by_side", "");
            assert!(!code.contains("report::"), "{path} imports from the page");
        }
    }
}

#[test]
fn no_library_reads_the_clock_on_the_wall() {
    for below in ["core/src", "sim/src", "check/src", "io/src"] {
        never_says(below, &["Instant", "SystemTime"]);
    }
    // What other programs call, and what their commands are made of.
    for file in ["lib", "program", "arguments", "console", "status"] {
        never_says(&format!("forwardstep/src/{file}.rs"), &["Instant", "SystemTime"]);
    }
}

/// Dependencies that every user of a crate builds, whatever the features.
fn always_built(layer: &str) -> BTreeSet<String> {
    let is_optional = |value: &Value| value.get("optional") == Some(&Value::Boolean(true));
    let manifest = manifest(layer);
    let table = manifest["dependencies"].as_table().unwrap();
    table.iter().filter(|(_, value)| !is_optional(value)).map(|(name, _)| name.clone()).collect()
}

#[test]
fn a_library_needs_nothing_of_the_program() {
    let library = ["forwardstep-check", "forwardstep-core", "forwardstep-sim"].map(String::from);
    assert_eq!(always_built("forwardstep"), library.into());
    let report = ["base64", "blake3", "csv", "maud", "parquet", "plotters", "sha2", "snap"].map(String::from).into();
    let readers = always_built("io");
    assert!(readers.is_disjoint(&report) && readers.contains("toml"), "{readers:?}");
    // A workspace member turns features on by itself only where it says so.
    let workspace: Table = fs::read_to_string(crates().join("../Cargo.toml")).unwrap().parse().unwrap();
    let shared = &workspace["workspace"]["dependencies"];
    for name in ["forwardstep-io", "miette"] {
        assert_eq!(shared[name]["default-features"], Value::Boolean(false), "{name}");
    }
    let default: Vec<_> = manifest("forwardstep")["features"]["default"].as_array().unwrap().clone();
    assert_eq!(default, [Value::from("program")]);
}

#[test]
fn the_engine_knows_no_robots() {
    never_says(
        "sim/src/engine",
        &["crate::closed_loop", "forwardstep_core::robot", "forwardstep_core::law", "forwardstep_core::reference"],
    );
    for file in ["graph.rs", "schedule", "delay", "network.rs"] {
        let above = ["engine", "closed_loop", "setup", "recording", "simulate"];
        never_says(&format!("sim/src/{file}"), &above.map(|room| format!("crate::{room}")).each_ref().map(|s| &s[..]));
    }
}

/// Functions of the platform's library differ in their last bits from one machine to another.
#[test]
fn no_number_depends_on_the_platform() {
    let functions = [
        ".sin()",
        ".cos()",
        ".tan()",
        ".asin()",
        ".acos()",
        ".atan()",
        ".atan2(",
        ".exp()",
        ".exp2()",
        ".ln()",
        ".log(",
        ".log2()",
        ".log10()",
        ".powf(",
        ".powi(",
        ".cbrt()",
        ".hypot(",
        ".sinh()",
        ".cosh()",
        ".tanh()",
        "f64::sin",
        "f64::cos",
        "f64::sin_cos",
        "f64::exp",
        "f64::ln",
        "f64::powf",
        "f64::powi",
    ];
    for below in ["core/src", "sim/src", "check/src"] {
        never_says(below, &functions);
    }
}

#[test]
fn the_lints_of_the_workspace_hold_everywhere() {
    for layer in LAYERS {
        assert_eq!(manifest(layer)["lints"]["workspace"], Value::Boolean(true), "{layer}");
        never_says(&format!("{layer}/src"), &["unsafe {", "unsafe fn", "unsafe impl", "allow(unsafe_code"]);
    }
}
