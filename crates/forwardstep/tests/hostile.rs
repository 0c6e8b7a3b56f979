//! Files, arguments and folders that are not what they should be, by mistake or on purpose, and what is said of them.

use std::fs;
use std::time::{Duration, Instant};

use crate::support::{folder, forwardstep, stderr, stdout};

/// Nothing of these may reach a terminal from outside.
fn is_tame(said: &str) -> bool {
    !said.chars().any(|c| c != '\n' && forwardstep::io::breaks_lines(c) || forwardstep::io::is_invisible(c))
}

#[test]
fn regress_no_output_replaces_a_file_of_somebody_else() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let text = forwardstep::io::scenario::shipped_scenario("first-order").unwrap().text;
    fs::write(path("own.toml"), text).unwrap();
    for arguments in [
        &["check", "own.toml", "--certificate", "own.toml"][..],
        &["attack", "own.toml", "--seconds", "60", "--out", "own.toml"],
        &["attack", "a1", "--seconds", "60", "--out", "own.toml"],
    ] {
        let began = Instant::now();
        let said = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(said.contains("already exists") && said.contains("choose another name"), "{said}");
        assert!(began.elapsed() < Duration::from_secs(30), "nothing is searched for before");
        assert_eq!(fs::read_to_string(path("own.toml")).unwrap(), text);
    }
    // What the command itself wrote it replaces.
    for _ in 0..2 {
        forwardstep(&folder, &["check", "own.toml", "--certificate", "own.json"]).success();
        forwardstep(&folder, &["attack", "24-complex-roots", "--seconds", "1", "--out", "found.toml"]);
    }
    fs::write(path("found.toml"), text).unwrap();
    forwardstep(&folder, &["attack", "24-complex-roots", "--seconds", "1", "--out", "found.toml"]).code(2);
    #[cfg(unix)]
    {
        // Who writes into a pipe waits until somebody reads.
        let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap();
        assert!(made.success());
        let unread = stderr(&forwardstep(&folder, &["check", "own.toml", "--certificate", "pipe"]).code(2));
        assert!(unread.contains("`pipe` is a pipe that no program reads"), "{unread}");
    }
    let missing = stderr(&forwardstep(&folder, &["check", "own.toml", "--certificate", "no/x.json"]).code(2));
    assert!(missing.contains("there is no folder `no`") && missing.contains("make it first"), "{missing}");
}

#[test]
fn regress_what_a_forged_run_says_does_nothing_to_a_terminal() {
    const EVIL: &str = "\u{1b}[2J\u{1b}[31mOWNED\nall in all: holds\u{200b}";
    let folder = folder();
    let path = |file: &str| folder.path().join("run").join(file);
    forwardstep(&folder, &["run", "first-order", "--out", "run", "--csv"]).success();
    fs::remove_file(path("trajectory.parquet")).unwrap();
    let (table, summary) =
        (fs::read_to_string(path("trajectory.csv")).unwrap(), fs::read_to_string(path("summary.json")).unwrap());
    let (header, rows) = table.split_once('\n').unwrap();
    let column = header.split(',').nth(3).unwrap();
    let (first, others) = rows.split_once('\n').unwrap();
    let cell = first.split(',').nth(3).unwrap();
    let quoted = serde_json::to_string(EVIL).unwrap();
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(summary.contains(&version));
    for (csv, json, refused) in [
        (format!("{}\n{rows}", header.replacen(column, &format!("\"{EVIL}\""), 1)), summary.clone(), true),
        (format!("{header}\n{}\n{others}", first.replacen(cell, &format!("\"{EVIL}\""), 1)), summary.clone(), true),
        (table.clone(), summary.replace(&version, &format!("\"version\": {quoted}")), false),
        (table.clone(), summary.replacen("\"completed\"", &quoted, 1), true),
    ] {
        fs::write(path("trajectory.csv"), csv).unwrap();
        fs::write(path("summary.json"), json).unwrap();
        for command in
            [&["report", "run"][..], &["report", "run", "--out", "other"], &["compare", "run", "first-order"]]
        {
            let done = forwardstep(&folder, command);
            let said = format!("{}{}", stderr(&done), stdout(&done));
            assert!(is_tame(&said), "{command:?}: {said:?}");
            assert!(!said.contains("\nall in all"), "{command:?}: {said}");
            if refused {
                assert!(stderr(&done.code(2)).contains("OWNED"), "{command:?}: {said}");
            }
            drop(fs::remove_dir_all(folder.path().join("other")));
            drop(fs::remove_dir_all(folder.path().join("forwardstep-runs")));
        }
    }
}

#[test]
fn regress_an_argument_begins_no_line_of_its_own() {
    let folder = folder();
    for arguments in [
        &["robot", "panda", "--lock", "panda_joint1=E\nerror: NINJ"][..],
        &["robot", "panda", "--lock=panda_joint1=E\nerror: NINJ"],
        &["new", "--agents=2\nerror: NINJ"],
        &["new", "--agents", "2\nerror: NINJ"],
        &["attack", "first-order", "--seconds=x\nerror: NINJ"],
    ] {
        let said = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(said.contains("\\nerror: NINJ") && !said.contains("\nerror: NINJ"), "{arguments:?}: {said}");
    }
}

#[test]
fn regress_no_command_quotes_a_secret() {
    let folder = folder();
    for (file, text) in [
        ("key", "-----BEGIN OPENSSH PRIVATE KEY-----\nhunter2\n"),
        ("shadow", "root:$6$hunter2:19000:0:99999:7:::\n"),
        ("env", "export DB_PASSWORD=hunter2\nDB=1\n"),
        ("aws", "[default]\naws_access_key_id = hunter2\naws_secret_access_key = hunter2\n"),
        ("netrc", "machine example.org login me password hunter2\n"),
        ("pgpass", "example.org:5432:orders:me:hunter2\n"),
        ("htpasswd", "me:$apr1$hunter2$x\n"),
        ("notes", "the word is hunter2\n"),
    ] {
        fs::write(folder.path().join(file), text).unwrap();
        for command in ["upgrade", "check", "robot"] {
            let said = stderr(&forwardstep(&folder, &[command, file]).code(2));
            assert!(!said.contains("hunter2") && said.contains(file), "{command} {file}: {said}");
        }
        assert_eq!(fs::read_to_string(folder.path().join(file)).unwrap(), text);
    }
}

#[test]
fn letters_that_nobody_sees_or_that_look_like_others_are_told() {
    let folder = folder();
    fs::write(folder.path().join("a.toml"), "format = 2\n\"title\u{200b}\" = 1\n\"titl\u{435}\" = 2\n").unwrap();
    let said = stderr(&forwardstep(&folder, &["check", "a.toml"]).code(2));
    assert!(is_tame(&said) && said.contains("unknown key `title\\u{200b}`"), "{said}");
    assert!(said.contains("`\\u{200b}` is U+200B") && said.contains("`\u{435}` is U+0435"), "{said}");
    // The mark with which some editors begin a file is no mistake, and is not shown.
    fs::write(folder.path().join("b.toml"), "\u{feff}format = 2\ntitel = 1\n").unwrap();
    let said = stderr(&forwardstep(&folder, &["check", "b.toml"]).code(2));
    assert!(is_tame(&said) && said.contains("did you mean `title`?") && !said.contains("???"), "{said}");
}

#[test]
fn what_is_missing_is_told_with_what_to_write() {
    let folder = folder();
    let deep = format!("format = 2\ntitle = \"x\"\na = {}\n", "{b=".repeat(3000));
    let dotted = format!("format = 2\ntitle = \"x\"\n{}b = 1\n", "a.".repeat(3000));
    for (text, parts) in [
        ("", &["nothing is written in this file", "forwardstep new"][..]),
        ("# later\n", &["nothing is written in this file"]),
        ("title = \"x\"\n", &["`format` is missing", "format = 2"]),
        ("format = 2\ntitle = \"x\"\n", &["`time` is missing", "end_s = 10"]),
        ("format = 2\ntitle = \"x\"\ntime = { end_s = 1 }\nterrain = 1\n", &["nothing touches anything"]),
        ("format = 2\ntitle = \"x\"\ntime = { end_s = 1 }\nsafety.min_distance_m = 1\n", &["pass through each other"]),
        (&deep, &["a.toml:3:", "nested so deeply"]),
        (&dotted, &["a.toml:3:", "nested so deeply"]),
    ] {
        fs::write(folder.path().join("a.toml"), text).unwrap();
        let said = stderr(&forwardstep(&folder, &["check", "a.toml"]).code(2));
        for part in parts {
            assert!(said.contains(part), "{part}: {said}");
        }
    }
    for (text, part) in [
        ("<robot name=\"a\"></robot>", "<link name="),
        ("<robot name=\"a\"><link name=\"a\"/></robot>", "what never moves has nothing to control"),
    ] {
        fs::write(folder.path().join("a.urdf"), text).unwrap();
        let said = stderr(&forwardstep(&folder, &["robot", "a.urdf"]).code(2));
        assert!(said.contains(part), "{said}");
    }
}

/// A scenario of masses over weeks.
const LONG: &str = r#"
format = 2
title = "Masses for long"
time = { end_s = 4e6, record_every_s = 1e4 }
[[agents]]
name = "mass"
count = 6
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = [[0], [1], [2], [3], [4], [5]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
delay.saw_tooth = { min_s = 0.0, max_s = 0.3, period_s = 0.5 }
edges.ring = {}
"#;

#[test]
fn regress_an_attack_ends_in_time_and_by_one_signal_though_a_run_is_long() {
    let folder = folder();
    fs::write(folder.path().join("long.toml"), LONG).unwrap();
    let began = Instant::now();
    let said = stderr(&forwardstep(&folder, &["attack", "long.toml", "--seconds", "1"]).code(2));
    assert!(said.contains("takes longer than `--seconds`"), "{said}");
    assert!(began.elapsed() < Duration::from_secs(60));
    if cfg!(unix) {
        let mut search = std::process::Command::new(assert_cmd::cargo::cargo_bin("forwardstep"))
            .current_dir(&folder)
            .args(["attack", "long.toml", "--seconds", "600"])
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_secs(2));
        let pid = search.id().to_string();
        assert!(std::process::Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
        let began = Instant::now();
        while search.try_wait().unwrap().is_none() {
            assert!(began.elapsed() < Duration::from_secs(60), "one signal is enough");
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_eq!(search.wait().unwrap().code(), Some(130));
    }
}

#[test]
fn what_samples_of_a_scenario_without_any_refuse_is_said_to_be_theirs() {
    let folder = folder();
    fs::write(folder.path().join("long.toml"), LONG).unwrap();
    let said = stderr(&forwardstep(&folder, &["sampling-limit", "long.toml"]).code(2));
    assert!(said.contains("with the samples that are tried") && said.contains("`time.end_s` be shorter"), "{said}");
}

/// All of its mistakes were collected, in gigabytes, before twenty of them were shown.
#[test]
fn regress_a_scenario_is_refused_that_is_larger_than_any() {
    let folder = folder();
    fs::write(folder.path().join("many.toml"), "[[agents]]\n".repeat(1_600_000)).unwrap();
    let error = stderr(&forwardstep(&folder, &["check", "many.toml"]).code(2));
    assert!(error.contains("larger than 16 MiB, as no scenario is"), "{error}");
}

/// A file of the run was asked for, without its name.
#[test]
fn regress_the_scenario_in_the_folder_of_a_run_is_named() {
    let folder = folder();
    forwardstep(&folder, &["run", "first-order", "--out", "made"]).success();
    let error = stderr(&forwardstep(&folder, &["upgrade", "made"]).code(2));
    assert!(error.contains("give the scenario in it, `made/scenario.toml`"), "{error}");
}
