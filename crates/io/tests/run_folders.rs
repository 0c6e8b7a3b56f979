//! The folder of a run is a scenario that runs again, wherever it is.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use forwardstep_io::output::{Options, OutputError, RunFolder, write_run};
use forwardstep_io::scenario::{OpenError, open_scenario};
use forwardstep_sim::simulate;

use crate::support::plain_record;

const CARTS: &str = r#"format = 2
title = "Two carts"
time = { end_s = 0.5, record_every_s = 0.1 }
[[agents]]
name = "cart"
count = 2
robot.urdf.file = "../robots/cart.urdf"
start.position_m = [[0], [1]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges.csv.file = "edges.csv"
"#;
const CART: &str = r#"<robot name="cart"><link name="rail"/>
<link name="cart"><inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-3" upper="3" velocity="2" effort="50"/></joint></robot>"#;

/// Runs a scenario and writes its folder.
fn run(scenario: &Path, out: &Path) {
    run_into(&RunFolder::create(out, false).unwrap(), scenario).unwrap();
}

/// Runs a scenario and writes it into a folder that is there.
fn run_into(folder: &RunFolder, scenario: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let scenario = open_scenario(scenario.to_str().unwrap()).unwrap();
    let outcome = simulate(&scenario.setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let verdicts = forwardstep_check::check(&scenario.setup);
    let record = plain_record(&scenario, &outcome, &verdicts);
    write_run(folder, &record, Options::default())
}

#[test]
fn a_folder_runs_again_where_none_of_its_files_are() {
    let here = tempfile::tempdir().unwrap();
    for (file, text) in [
        ("robots/cart.urdf", CART),
        ("mine/carts.toml", CARTS),
        ("mine/edges.csv", "from,to\ncart-1,cart-2\ncart-2,cart-1\n"),
    ] {
        let path = here.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let there = tempfile::tempdir().unwrap();
    let folders = ["first", "second", "third"].map(|name| there.path().join(name).join("carts"));
    run(&here.path().join("mine/carts.toml"), &folders[0]);
    drop(here);
    run(&folders[0], &folders[1]);
    run(&folders[1], &folders[2]);
    for file in ["trajectory.parquet", "scenario.toml", "inputs/manifest.json", "inputs/edges.csv"] {
        let bytes = |k: usize| fs::read(folders[k].join(file)).unwrap();
        assert!(bytes(0) == bytes(1) && bytes(1) == bytes(2), "{file}");
    }
    assert_eq!(fs::read_to_string(folders[2].join("inputs/outside/cart.urdf")).unwrap(), CART);
}

#[test]
fn a_list_of_copies_cannot_lead_out_of_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("inputs")).unwrap();
    fs::write(folder.path().join("scenario.toml"), CARTS).unwrap();
    for list in [
        "",
        "{}",
        r#"{"format": 2, "files": []}"#,
        r#"{"format": 1, "files": [{"name": "edges.csv", "file": "/etc/hostname"}]}"#,
        r#"{"format": 1, "files": [{"name": "edges.csv", "file": "inputs/../../edges.csv"}]}"#,
    ] {
        fs::write(folder.path().join("inputs/manifest.json"), list).unwrap();
        let opened = open_scenario(folder.path().to_str().unwrap());
        assert!(matches!(opened, Err(OpenError::Manifest { .. })), "{list}");
    }
}

#[test]
fn a_folder_that_is_held_for_a_moment_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let held = fs::File::open(folder.path()).unwrap();
    held.lock().unwrap();
    assert_eq!(RunFolder::is_in_use(folder.path()), Some(true));
    assert!(RunFolder::create(folder.path(), false).is_err(), "it is held for long");
    let later = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_millis(20));
        drop(held);
    });
    RunFolder::create(folder.path(), false).unwrap();
    later.join().unwrap();
    assert_eq!(RunFolder::is_in_use(folder.path()), Some(false));
}

/// The names in a folder and what the files hold.
#[cfg(unix)]
fn content(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { folders.push(path) } else { files.push((path.clone(), fs::read(path).unwrap())) }
        }
    }
    files.sort();
    files
}

// A folder that is held open cannot be renamed elsewhere.
#[cfg(unix)]
#[test]
fn regress_a_run_whose_folder_was_renamed_leaves_the_next_of_that_name_alone() {
    let here = tempfile::tempdir().unwrap();
    let scenario = here.path().join("carts.toml");
    fs::write(
        &scenario,
        CARTS.replace("urdf.file = \"../robots/cart.urdf\"", "point_mass = { dimension = 1, mass_kg = 2 }"),
    )
    .unwrap();
    fs::write(here.path().join("edges.csv"), "from,to\ncart-1,cart-2\ncart-2,cart-1\n").unwrap();
    let (name, away) = (here.path().join("runs/carts"), here.path().join("runs/away"));
    let refused = |folder: &RunFolder, content_before: &[(PathBuf, Vec<u8>)]| {
        assert!(folder.is_elsewhere());
        let error = run_into(folder, &scenario).unwrap_err();
        let OutputError::Elsewhere { path, now } = &error else { panic!("{error}") };
        assert_eq!(path, &name);
        if cfg!(target_os = "linux") {
            assert_eq!(now.as_deref(), Some(fs::canonicalize(&away).unwrap().as_path()));
        }
        assert!(error.help().is_some_and(|help| help.contains("forwardstep report")), "{error}");
        assert_eq!(content(&name), content_before);
    };
    // The next run has just begun, and its folder is empty.
    let first = RunFolder::create(&name, false).unwrap();
    fs::rename(&name, &away).unwrap();
    let next = RunFolder::create(&name, false).unwrap();
    refused(&first, &[]);
    drop(first);
    assert!(name.is_dir());
    // It is over; and it has its journal, and files that are not finished.
    run_into(&next, &scenario).unwrap();
    drop(next);
    fs::remove_dir_all(&away).unwrap();
    let first = RunFolder::create(&name, true).unwrap();
    fs::rename(&name, &away).unwrap();
    run(&scenario, &name);
    fs::write(name.join("rows.journal"), "of the next").unwrap();
    fs::write(name.join(".scenario.toml.partial"), "of the next").unwrap();
    refused(&first, &content(&name));
    let before = content(&name);
    drop(first);
    assert_eq!(content(&name), before);
    // Where nothing has the name, the folder is made anew, and kept from others.
    fs::remove_dir_all(&name).unwrap();
    let first = RunFolder::create(&name, false).unwrap();
    fs::remove_dir_all(&name).unwrap();
    assert!(!first.is_elsewhere());
    run_into(&first, &scenario).unwrap();
    assert_eq!(RunFolder::is_in_use(&name), Some(true));
    assert!(name.join("summary.json").is_file());
}

#[test]
fn regress_copies_of_inputs_that_were_edited_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (scenario, out) = (folder.path().join("mine/carts.toml"), folder.path().join("out"));
    for (file, text) in [
        ("robots/cart.urdf", CART),
        ("mine/carts.toml", CARTS),
        ("mine/edges.csv", "from,to\ncart-1,cart-2\ncart-2,cart-1\n"),
    ] {
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    run(&scenario, &out);
    assert!(RunFolder::create(&out, true).is_ok());
    let other_copy = r#"{"format": 1, "files": [{"name": "edges.csv", "file": "inputs/other.csv"}]}"#;
    for (file, text) in
        [("inputs/edges.csv", "mine"), ("inputs/outside/cart.urdf", "mine"), ("inputs/manifest.json", other_copy)]
    {
        let path = out.join(file);
        let before = fs::read(&path).unwrap();
        fs::write(&path, text).unwrap();
        match RunFolder::create(&out, true) {
            Err(OutputError::Changed { path: changed }) => assert_eq!(changed, path),
            other => panic!("{file}: {other:?}"),
        }
        fs::write(&path, before).unwrap();
    }
    assert!(RunFolder::create(&out, true).is_ok());
    // Nor is one replaced that stands where a copy of this run comes to stand for the first time.
    let run = RunFolder::create(&out, true).unwrap();
    fs::write(&scenario, CARTS.replace("edges.csv\"", "more.csv\"")).unwrap();
    fs::copy(folder.path().join("mine/edges.csv"), folder.path().join("mine/more.csv")).unwrap();
    let mine = out.join("inputs/more.csv");
    fs::write(&mine, "mine").unwrap();
    match run_into(&run, &scenario) {
        Err(OutputError::Changed { path: changed }) => assert_eq!(changed, mine),
        other => panic!("{other:?}"),
    }
    assert!(out.join("summary.json").exists() && out.join("inputs/edges.csv").exists(), "nothing was changed");
    fs::remove_file(&mine).unwrap();
    run_into(&run, &scenario).unwrap();
    assert!(!out.join("inputs/edges.csv").exists() && !out.join(".summary.json.replaced").exists());
}
