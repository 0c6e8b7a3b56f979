//! What stands where a file is expected and is none, or is clearly another.

use std::fs;
use std::path::Path;

use forwardstep_io::robot::open_robot;
use forwardstep_io::scenario::open_scenario;
use forwardstep_io::urdf::UrdfOptions;
use miette::Report;

const KEY: &str =
    "-----BEGIN OPENSSH PRIVATE KEY-----\nb3BlbnNzaC1rZXktdjEAAAAABG5vbmU\n-----END OPENSSH PRIVATE KEY-----\n";
const ACCOUNTS: &str = "root:x:0:0:root:/root:/bin/bash\ndaemon:x:1:1:daemon:/usr/sbin:/usr/sbin/nologin\n";
const SETTINGS: &str = "HOST=example.org\nDB_PASSWORD=hunter2\n";
const WITH_EDGES: &str = r#"format = 2
title = "Two carts"
time = { end_s = 1 }
[[agents]]
name = "cart"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position_velocity"
[network]
edges.csv.file = "edges.csv"
"#;

/// All that is said about a file at this path, given as a scenario, as a robot, and as a table that a scenario names.
fn said(path: &Path) -> [String; 3] {
    let name = path.to_str().unwrap();
    let scenario = Report::new(open_scenario(name).unwrap_err());
    let robot = open_robot(name, &UrdfOptions::default()).err().map(Report::new);
    let naming = path.with_extension("naming.toml");
    fs::write(&naming, WITH_EDGES.replace("\"edges.csv\"", &format!("\"{name}\""))).unwrap();
    let table = Report::new(open_scenario(naming.to_str().unwrap()).unwrap_err());
    // Nothing is said of what is a robot.
    [Some(scenario), robot, Some(table)].map(|report| report.map_or_else(String::new, |report| format!("{report:?}")))
}

#[test]
fn what_is_clearly_something_else_is_named_and_never_quoted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("arm");
    for (bytes, what, hidden) in [
        (KEY.as_bytes(), "it holds a key or a certificate", "b3Blbn"),
        (ACCOUNTS.as_bytes(), "it holds a list of accounts", "/bin/bash"),
        (b"machine example.org login me password hunter2\n", "it holds passwords or tokens", "hunter2"),
        (b"example.org:5432:orders:me:hunter2\n", "it holds passwords or tokens", "hunter2"),
        (b"me:$apr1$hunter2$x\n", "it holds a list of accounts", "hunter2"),
        (SETTINGS.as_bytes(), "it holds passwords or tokens", "example.org"),
        (b"\x7fELF\x02\x01\x01 secrets", "it holds a program, an archive", "secrets"),
    ] {
        fs::write(&path, bytes).unwrap();
        for said in said(&path) {
            assert!(said.contains(what) && !said.contains(hidden), "{said}");
        }
    }
}

#[test]
fn of_a_text_that_may_be_anything_only_the_place_of_the_mistake_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("letter.toml");
    fs::write(&path, "first = 1\nDear Ms Lovelace,\nplease keep this between us\n").unwrap();
    let [scenario, robot, _] = said(&path);
    for said in [&scenario, &robot] {
        assert!(!said.contains("between us"), "{said}");
    }
    assert!(scenario.contains("letter.toml:2:6") && !scenario.contains("Lovelace"), "{scenario}");
    assert!(!scenario.contains("first = 1"), "{scenario}");
    for (text, hidden) in [
        ("user = me, my secret is hunter2\n", "hunter2"),
        ("token hunter2", "hunter2"),
        ("a = 'b'\nsomething_long_that_nobody_should_see = 1\n", "nobody"),
        ("a = [1, 2", "1, 2"),
    ] {
        fs::write(&path, text).unwrap();
        let [scenario, ..] = said(&path);
        assert!(scenario.contains("letter.toml") && !scenario.contains(hidden), "{scenario}");
    }
    // Around a mistake in a scenario there are lines to find it by.
    fs::write(&path, WITH_EDGES.replace("count = 2", "count = two")).unwrap();
    assert!(said(&path)[0].contains("robot.point_mass"));
}

/// Without the line breaks of a page.
fn flat(said: &str) -> String {
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn a_robot_or_a_list_given_as_a_scenario_is_named_and_the_reverse() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine");
    let robot = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/gantry.urdf")).unwrap();
    for (text, what, scenario_help, robot_help) in [
        (&*robot, "a robot (URDF)", "new my-scenario.toml --robot ", None),
        ("{\"agents\": []}", "JSON", "scenarios are TOML", Some("a robot is a URDF")),
        ("agents:\n  - name: arm\n", "YAML", "scenarios are TOML", Some("a robot is a URDF")),
        ("from,to\na,b\n", "a table (CSV)", "edges.csv.file", Some("a robot is a URDF")),
        ("<sdf version='1.7'/>", "a model for another simulator", "robots are read from URDF", None),
    ] {
        fs::write(&path, text).unwrap();
        let [scenario, robot, _] = said(&path).map(|said| flat(&said));
        assert!(scenario.contains(&format!("this is {what}")) && scenario.contains(scenario_help), "{scenario}");
        assert!(
            robot_help.is_none_or(|help| robot.contains(&format!("this is {what}")) && robot.contains(help)),
            "{robot}"
        );
    }
    fs::write(&path, WITH_EDGES).unwrap();
    let [_, robot, _] = said(&path).map(|said| flat(&said));
    assert!(robot.contains("this is a scenario, and no robot") && robot.contains("forwardstep check "), "{robot}");
    // A scenario with a mistake is one all the same.
    fs::write(&path, WITH_EDGES.replace("count = 2", "count = ")).unwrap();
    let [scenario, ..] = said(&path);
    assert!(scenario.contains("not valid TOML"), "{scenario}");
}

#[cfg(unix)]
#[test]
fn pipes_devices_and_folders_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for said in said(&pipe) {
        assert!(said.contains("it is a pipe, and no file"), "{said}");
    }
    let room = folder.path().join("room");
    fs::create_dir(&room).unwrap();
    for said in said(&room) {
        assert!(said.contains("it is a folder"), "{said}");
    }
    assert!(flat(&said(&room)[0]).contains("give a scenario file, or the folder of a run"));
    fs::write(room.join("mine.toml"), "").unwrap();
    assert!(flat(&said(&room)[0]).contains("name a file in it: there are `mine.toml`"));
    // What stands in place of the scenario of a run is named.
    let scenario = room.join("scenario.toml");
    std::os::unix::fs::symlink("nowhere", &scenario).unwrap();
    let missing = flat(&said(&room)[0]);
    assert!(
        missing.contains("room/scenario.toml`: there is no such file") && missing.contains("a link to"),
        "{missing}"
    );
    fs::remove_file(&scenario).unwrap();
    fs::create_dir(&scenario).unwrap();
    assert!(flat(&said(&room)[0]).contains("room/scenario.toml`: it is a folder"));
    fs::remove_dir(&scenario).unwrap();
    fs::write(room.join("rows.journal"), "").unwrap();
    let journaled = flat(&said(&room)[0]);
    assert!(journaled.contains("a run that was cut off") && journaled.contains("forwardstep report "), "{journaled}");
    let (device, socket) = (folder.path().join("device"), folder.path().join("socket"));
    std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
    let _listening = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    assert!(said(&device).iter().all(|said| said.contains("it is a device, and no file")));
    assert!(said(&socket).iter().all(|said| said.contains("it is a socket, and no file")));
    // What says that it is a file, and gives nothing until there is more.
    let log = folder.path().join("log");
    std::os::unix::fs::symlink("/proc/kmsg", &log).unwrap();
    if log.exists() {
        let is_refused =
            |said: &String| said.contains("something that waits for more") || said.contains("permission denied");
        assert!(said(&log).iter().all(is_refused), "{:?}", said(&log));
    }
}

#[cfg(unix)]
#[test]
fn pipes_in_the_folder_of_a_run_are_refused_at_once() {
    use forwardstep_io::output::SavedRun;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["summary.json", "scenario.toml"] {
        assert!(std::process::Command::new("mkfifo").arg(path.join(name)).status().unwrap().success());
        let said = SavedRun::open(path).unwrap_err().to_string();
        assert!(said.contains("it is a pipe, and no file"), "{said}");
        fs::remove_file(path.join(name)).unwrap();
        fs::write(path.join(name), "{}").unwrap();
    }
}
