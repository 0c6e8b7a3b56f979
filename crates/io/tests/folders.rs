//! Folders that runs are written to: what is replaced, what is kept, and what is in the way.

use std::fs;

use crate::output::write;
use crate::support::{record, two_arms, verdicts};
use forwardstep_io::output::{Action, Options, OutputError, RunFolder, write_run};

#[test]
fn a_folder_that_is_not_empty_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("thesis.tex"), "years of work").unwrap();
    let refused = RunFolder::create(folder.path(), false).unwrap_err();
    // `--force` is not advised where it is refused.
    assert!(matches!(refused, OutputError::FolderNotEmpty { replaceable: false, .. }));
    assert!(!refused.help().unwrap().contains("--force"));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn force_replaces_what_a_run_writes_and_nothing_else() {
    let (setup, outcome) = two_arms();
    let (folder, report) = (tempfile::tempdir().unwrap(), verdicts());
    let path = folder.path();
    write(path, &setup, &outcome);
    fs::write(path.join("notes.md"), "mine").unwrap();
    fs::write(path.join("plots/mine.svg"), "mine").unwrap();
    fs::write(path.join("report.html"), "old").unwrap();
    let run = RunFolder::create(path, true).unwrap();
    write_run(&run, &record(&setup, &outcome, &report), Options { csv: false }).unwrap();
    assert_eq!(fs::read_to_string(path.join("notes.md")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(path.join("plots/mine.svg")).unwrap(), "mine");
    assert!(fs::read_to_string(path.join("report.html")).unwrap().len() > 10_000);
    assert!(!path.join("trajectory.csv").exists(), "the earlier run's table would pass for this run's");
}

#[test]
fn force_spares_a_folder_that_no_run_wrote_and_what_was_changed_in_one() {
    let (setup, outcome) = two_arms();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (file, text) in
        [("thesis.tex", "years of work"), ("scenario.toml", "mine"), ("summary.json", "{\"format\": 2}")]
    {
        fs::write(path.join(file), text).unwrap();
        let refused = RunFolder::create(path, true).unwrap_err();
        assert!(matches!(refused, OutputError::NotOfARun { .. }), "{file}: {refused}");
        fs::remove_file(path.join(file)).unwrap();
    }
    write(path, &setup, &outcome);
    assert!(RunFolder::create(path, true).is_ok());
    for file in ["scenario.toml", "trajectory.parquet", "trajectory.csv", "phases.csv"] {
        let before = fs::read(path.join(file)).ok();
        fs::write(path.join(file), "mine").unwrap();
        match RunFolder::create(path, true) {
            Err(OutputError::Changed { path: changed }) => assert_eq!(changed, path.join(file)),
            other => panic!("{file}: {other:?}"),
        }
        match before {
            Some(bytes) => fs::write(path.join(file), bytes).unwrap(),
            None => fs::remove_file(path.join(file)).unwrap(),
        }
    }
    assert!(RunFolder::create(path, true).is_ok());
    // A run that ended while it gave its files their names.
    fs::rename(path.join("summary.json"), path.join(".summary.json.partial")).unwrap();
    assert!(RunFolder::create(path, true).is_ok());
}

#[test]
fn what_no_file_can_replace_is_found_before_the_run() {
    let (setup, outcome) = two_arms();
    for (name, found) in [
        ("report.html", "a folder"),
        ("shapes.json", "a folder"),
        ("plots/torques.svg", "a folder"),
        (".summary.json.partial", "a folder"),
        ("rows.journal", "a folder"),
        ("plots", "no folder"),
        ("inputs", "no folder"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        write(path, &setup, &outcome);
        let way = path.join(name);
        if way.is_dir() {
            fs::remove_dir_all(&way).unwrap()
        } else {
            drop(fs::remove_file(&way))
        }
        if found == "a folder" {
            fs::create_dir_all(way.join("mine")).unwrap()
        } else {
            fs::write(&way, "mine").unwrap()
        }
        let error = RunFolder::create(path, true).unwrap_err();
        assert!(matches!(&error, OutputError::InTheWay { path, .. } if *path == way), "{name}: {error}");
        assert!(error.to_string().contains(found) && error.help().is_some_and(|help| help.contains("move it")));
        // The report alone is written anew by `report`.
        let drawn = ["report.html", "plots/torques.svg", "plots"].contains(&name);
        assert_eq!(RunFolder::open(path).is_err(), drawn, "{name}");
    }
}

/// What a link leads to is not the run's, whoever writes: a run, a report, or who copies inputs.
#[cfg(unix)]
#[test]
fn regress_nothing_is_written_or_removed_through_a_folder_that_is_a_link() {
    let (setup, outcome) = two_arms();
    for (name, file) in [("plots", "positions.svg"), ("inputs", "manifest.json")] {
        let folder = tempfile::tempdir().unwrap();
        let [path, outside] = ["run", "outside"].map(|name| folder.path().join(name));
        fs::create_dir(&outside).unwrap();
        fs::write(outside.join(file), "mine").unwrap();
        write(&path, &setup, &outcome);
        drop(fs::remove_dir_all(path.join(name)));
        std::os::unix::fs::symlink(&outside, path.join(name)).unwrap();
        let error = RunFolder::create(&path, true).unwrap_err();
        assert!(matches!(&error, OutputError::InTheWay { path: at, .. } if *at == path.join(name)), "{name}: {error}");
        assert!(error.to_string().contains("a link to another folder"), "{error}");
        assert_eq!(RunFolder::open(&path).is_err(), name == "plots");
        assert_eq!(fs::read_to_string(outside.join(file)).unwrap(), "mine");
    }
}

#[cfg(unix)]
#[test]
fn a_table_of_another_length_is_not_read() {
    let (setup, outcome) = two_arms();
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &setup, &outcome);
    let table = folder.path().join("trajectory.parquet");
    let summary = fs::read_to_string(folder.path().join("summary.json")).unwrap();
    assert!(summary.contains(&format!("\"bytes\": {}", fs::metadata(&table).unwrap().len())), "{summary}");
    // Of holes, which take no room, but would take hours to read.
    fs::File::options().write(true).open(&table).unwrap().set_len(1 << 43).unwrap();
    let began = std::time::Instant::now();
    assert!(matches!(RunFolder::create(folder.path(), true), Err(OutputError::Changed { path }) if path == table));
    assert!(began.elapsed().as_secs() < 10);
    // Where its length is right, what it holds decides.
    fs::write(&table, vec![0; 8]).unwrap();
    assert!(matches!(RunFolder::create(folder.path(), true), Err(OutputError::Changed { .. })));
}

#[test]
fn leftovers_of_a_killed_writer_do_not_count() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("plots")).unwrap();
    fs::write(folder.path().join(".summary.json.partial"), "{").unwrap();
    fs::write(folder.path().join("plots/.torques.svg.partial"), "<svg").unwrap();
    let (setup, outcome) = two_arms();
    write(folder.path(), &setup, &outcome);
    assert!(!folder.path().join(".summary.json.partial").exists());
}

#[test]
fn a_file_in_the_way_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    assert!(matches!(RunFolder::create(&file, true), Err(OutputError::NotAFolder { .. })));
    match RunFolder::create(file.join("run"), false) {
        Err(OutputError::Io { action: Action::CreateFolder, path, .. }) => assert_eq!(path, file.join("run")),
        other => panic!("{other:?}"),
    }
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_written_to_is_an_error_before_the_run() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
    let is_privileged = fs::write(folder.path().join("probe"), "").is_ok();
    let _ = fs::remove_file(folder.path().join("probe"));
    match RunFolder::create(folder.path(), false) {
        Ok(_) => assert!(is_privileged, "only the superuser may write here"),
        Err(OutputError::Io { action, source, .. }) => {
            assert_eq!(action, Action::WriteInto);
            assert_eq!(source.kind(), std::io::ErrorKind::PermissionDenied);
        }
        Err(other) => panic!("{other}"),
    }
}

#[cfg(target_os = "linux")]
#[test]
fn folders_made_for_a_run_that_left_nothing_vanish() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("mine")).unwrap();
    drop(RunFolder::create(folder.path().join("mine/made/too"), false).unwrap());
    drop(RunFolder::create(folder.path().join("mine"), false).unwrap());
    assert_eq!(fs::read_dir(folder.path().join("mine")).unwrap().count(), 0, "the folder that was there stays");
}

#[test]
fn a_file_system_without_files_is_an_error() {
    let error = RunFolder::create("/proc/forwardstep-run", false).unwrap_err();
    assert!(matches!(error, OutputError::Io { action: Action::CreateFolder, .. }), "{error}");
    assert!(error.to_string().contains("/proc/forwardstep-run"));
}

#[test]
fn a_failure_half_way_leaves_an_earlier_run_whole() {
    let (setup, outcome) = two_arms();
    let (folder, report) = (tempfile::tempdir().unwrap(), verdicts());
    write(folder.path(), &setup, &outcome);
    let before = fs::read(folder.path().join("summary.json")).unwrap();
    // A folder under a temporary name cannot be opened as a file.
    let run = RunFolder::create(folder.path(), true).unwrap();
    fs::create_dir(folder.path().join(".report.html.partial")).unwrap();
    let error = write_run(&run, &record(&setup, &outcome, &report), Options::default()).unwrap_err();
    assert!(matches!(error, OutputError::Io { action: Action::CreateFile, .. }), "{error}");
    assert_eq!(fs::read(folder.path().join("summary.json")).unwrap(), before);
    let partial =
        |e: fs::DirEntry| e.file_type().unwrap().is_file() && e.file_name().to_string_lossy().starts_with('.');
    assert!(!fs::read_dir(folder.path()).unwrap().any(|e| partial(e.unwrap())), "half a run was left");
}
