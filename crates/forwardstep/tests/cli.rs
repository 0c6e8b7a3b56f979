//! The program as a user meets it: what it prints, what it writes, and how it exits.

mod advice;
mod beside;
mod told;

use std::fs;
use std::path::Path;
use std::process::{Command as Process, Stdio};

use crate::support::{folder, forwardstep, names, stderr, stdout};
use forwardstep::io::scenario::SHIPPED_SCENARIOS;
use tempfile::TempDir;

/// Two arms that agree within a few seconds; a `[goal]` or `[solver]` may follow.
const QUICK: &str = r#"
format = 2
title = "Two arms"
time = { end_s = 30, record_every_s = 0.1 }
[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[law.known]
[network]
delay.constant_s = 0.1
edges = [["arm-1", "arm-2"], ["arm-2", "arm-1"]]
"#;

fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn scenarios_are_listed_and_printed() {
    let folder = folder();
    let list = stdout(&forwardstep(&folder, &["scenarios"]).success());
    for scenario in SHIPPED_SCENARIOS {
        assert!(list.lines().any(|line| line.starts_with(scenario.name)), "{list}");
        assert_eq!(stdout(&forwardstep(&folder, &["scenarios", scenario.name]).success()), scenario.text);
    }
    let error = stderr(&forwardstep(&folder, &["scenarios", "six-amrs"]).code(2));
    assert!(error.contains("did you mean `six-arms`?"), "{error}");
}

#[test]
fn the_schema_is_json() {
    let text = stdout(&forwardstep(&folder(), &["schema"]).success());
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(schema["title"], "forwardstep scenario");
}

#[test]
fn a_shipped_scenario_runs_by_name_in_any_folder() {
    let folder = folder();
    let run = forwardstep(&folder, &["run", "first-order"]).success();
    let text = stdout(&run);
    assert!(text.starts_with("First order (aa10)"), "{text}");
    for row in ["verdict", "goal", "final disagreement", "peak torque", "steps", "wall time", "files"] {
        assert!(text.lines().any(|line| line.trim_start().starts_with(row)), "no {row} in {text}");
    }
    assert_eq!(stderr(&run), "", "no progress unless a person looks at it");
    assert!(!text.contains('\u{1b}'), "no colours unless a person looks at them");
    let files = names(&folder.path().join("forwardstep-runs/first-order"));
    for file in ["report.html", "scenario.toml", "summary.json", "trajectory.parquet"] {
        assert!(files.iter().any(|name| name == file), "no {file} in {files:?}");
    }
}

#[test]
fn without_a_command_the_six_arms_run() {
    let folder = folder();
    let text = stdout(&forwardstep(&folder, &[]).success());
    assert!(text.starts_with("Six UR5e arms agree"), "{text}");
    assert!(folder.path().join("forwardstep-runs/six-arms/report.html").is_file());
}

#[test]
fn a_file_runs_with_csv_into_a_folder_of_choice() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), QUICK).unwrap();
    forwardstep(&folder, &["run", "two.toml", "--out", "a/b", "--csv"]).success();
    let table = fs::read_to_string(folder.path().join("a/b/trajectory.csv")).unwrap();
    assert!(table.starts_with("t_s,arm-1.q.shoulder,"), "{}", &table[..40]);
    assert_eq!(table.lines().count(), 1 + 301);
    assert_eq!(names(folder.path()), ["a", "two.toml"]);
}

#[test]
fn the_same_scenario_gives_the_same_bits() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), QUICK).unwrap();
    for out in ["a", "b"] {
        forwardstep(&folder, &["run", "two.toml", "--out", out]).success();
    }
    for file in ["trajectory.parquet", "report.html"] {
        let bytes = |out: &str| fs::read(folder.path().join(out).join(file)).unwrap();
        assert!(bytes("a") == bytes("b"), "{file} differs");
    }
}

#[test]
fn an_existing_folder_is_kept_unless_forced() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), QUICK).unwrap();
    let out = folder.path().join("forwardstep-runs/two");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("summary.json"), "mine").unwrap();
    fs::write(out.join("notes.txt"), "mine too").unwrap();
    let error = stderr(&forwardstep(&folder, &["run", "two.toml"]).code(2));
    assert!(error.contains("already exists") && !error.contains("--force"), "{error}");
    assert_eq!(names(&out), ["notes.txt", "summary.json"]);
    assert_eq!(fs::read_to_string(out.join("summary.json")).unwrap(), "mine");
    // What no run wrote stays, whatever is asked for.
    let error = stderr(&forwardstep(&folder, &["run", "two.toml", "--force"]).code(2));
    assert!(error.contains("was not written by a run"), "{error}");
    assert_eq!(fs::read_to_string(out.join("summary.json")).unwrap(), "mine");
    fs::remove_dir_all(&out).unwrap();
    forwardstep(&folder, &["run", "two.toml"]).success();
    fs::write(out.join("notes.txt"), "mine too").unwrap();
    forwardstep(&folder, &["run", "two.toml", "--force"]).success();
    assert_eq!(summary(&out)["title"], "Two arms");
    assert_eq!(fs::read_to_string(out.join("notes.txt")).unwrap(), "mine too");
}

#[cfg(unix)]
#[test]
fn two_runs_never_share_a_folder() {
    let folder = folder();
    // Years of simulated time, so that it cannot end by itself.
    let long = QUICK.replace("end_s = 30, record_every_s = 0.1", "end_s = 1e8, record_every_s = 100");
    fs::write(folder.path().join("long.toml"), long).unwrap();
    let mut first = Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(&folder)
        .args(["run", "long.toml", "--out", "shared"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut line = String::new();
    // The verdicts are printed once the folder is taken.
    std::io::BufRead::read_line(&mut std::io::BufReader::new(first.stdout.as_mut().unwrap()), &mut line).unwrap();
    for arguments in
        [&["run", "first-order", "--out", "shared"][..], &["run", "first-order", "--out", "shared", "--force"]]
    {
        let error = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(error.contains("another run is writing to shared"), "{error}");
    }
    first.kill().unwrap();
    first.wait().unwrap();
    // What was left behind by a run that was killed is in nobody's way, but for rows that it has kept since a second was over.
    let _ = fs::remove_file(folder.path().join("shared/rows.journal"));
    forwardstep(&folder, &["run", "first-order", "--out", "shared"]).success();
}

#[cfg(unix)]
#[test]
fn a_link_to_nowhere_is_no_folder() {
    let folder = folder();
    std::os::unix::fs::symlink("nowhere", folder.path().join("link")).unwrap();
    let error = stderr(&forwardstep(&folder, &["run", "first-order", "--out", "link"]).code(2));
    assert!(error.contains("link exists and is not a folder"), "{error}");
    assert_eq!(names(folder.path()), ["link"]);
}

#[test]
fn bad_input_writes_nothing() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), QUICK.replace("\"arm-2\"]", "\"arm-3\"]")).unwrap();
    for command in ["run", "check"] {
        let error = stderr(&forwardstep(&folder, &[command, "two.toml"]).code(2));
        assert!(error.contains("two.toml:16:20: there is no agent `arm-3`"), "{error}");
        assert!(error.contains("did you mean"), "{error}");
    }
    let error = stderr(&forwardstep(&folder, &["run", "tow.toml"]).code(2));
    assert!(error.contains("cannot read `tow.toml`") && error.contains("did you mean `two.toml`?"), "{error}");
    let error = stderr(&forwardstep(&folder, &["run", "theorm-2"]).code(2));
    assert!(
        error.contains("there is no scenario `theorm-2`") && error.contains("did you mean `theorem-2`?"),
        "{error}"
    );
    forwardstep(&folder, &["run", "six-arms", "--fast"]).code(2);
    assert_eq!(names(folder.path()), ["two.toml"]);
}

#[test]
fn a_missed_goal_is_status_one() {
    let folder = folder();
    let cases = [
        ("disagreement_below = 1e-3", 0, "met"),
        ("disagreement_below = 1e-30", 1, "missed"),
        ("expect = \"diverges\"", 1, "missed"),
    ];
    for (goal, status, word) in cases {
        fs::write(folder.path().join("two.toml"), format!("{QUICK}[goal]\n{goal}")).unwrap();
        let text = stdout(&forwardstep(&folder, &["run", "two.toml", "--force"]).code(status));
        let line = text.lines().find(|line| line.trim_start().starts_with("goal")).unwrap();
        assert!(line.contains(word), "{line}");
    }
}

#[test]
fn check_says_for_which_time_a_tree_is_missing() {
    let folder = folder();
    let phases = "[[network.phases]]\ndwell_s = 1\nedges = [[\"arm-1\", \"arm-2\"]]\n[[network.phases]]\ndwell_s = 1\nedges = []\n";
    let (agents, _) = QUICK.split_once("edges").unwrap();
    let once = "switching = \"once\"\n";
    let random = "switching.random = { seed = 1, dwell_s = [40, 50] }\n";
    for (switching, status, words) in [
        ("", 0, "the smallest uniform window lasts 2 s"),
        (
            once,
            1,
            "from t = 1 s on, whatever the window, no agent reaches all others: [arm-1] and [arm-2] hear no agent",
        ),
        // One graph is drawn within the run; what a longer run would show is not claimed.
        (random, 1, "from t = 0 s to the end of the run at 30 s, no agent reaches all others"),
    ] {
        fs::write(folder.path().join("two.toml"), format!("{agents}{switching}{phases}")).unwrap();
        let text = stdout(&forwardstep(&folder, &["check", "two.toml"]).code(status));
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn a_breakdown_is_status_three_and_keeps_what_was_computed() {
    let folder = folder();
    let solver = "[solver]\nmin_step_s = 5e-3\nmethod.adaptive = { rtol = 1e-13, atol = 1e-13 }";
    fs::write(folder.path().join("two.toml"), format!("{QUICK}{solver}")).unwrap();
    let run = forwardstep(&folder, &["run", "two.toml"]).code(3);
    let error = stderr(&run);
    assert!(error.contains("t = ") && error.contains("arm-") && error.contains("step"), "when, who and what: {error}");
    assert_eq!(summary(&folder.path().join("forwardstep-runs/two"))["ending"]["kind"], "broke_down");
}

#[test]
fn a_gain_that_makes_a_run_hopeless_ends_it_within_its_memory() {
    let folder = folder();
    for (gain, memory) in [("1e29", false), ("1e15", true)] {
        let solver = "[solver]\nmemory_budget_bytes = 1_000_000";
        let adaptive = format!("[law.adaptive]\ndamping.gain = 20\nadaptation_gain = {gain}");
        fs::write(folder.path().join("two.toml"), format!("{}{solver}", QUICK.replace("[law.known]", &adaptive)))
            .unwrap();
        let error = stderr(&forwardstep(&folder, &["run", "two.toml", "--force"]).code(3));
        for words in ["the closed loop is stiff", "at arm-", "K/λ_min(M)", "lower `law.adaptive.adaptation_gain`"] {
            assert!(error.contains(words), "no {words} in {error}");
        }
        assert_eq!(error.contains("`memory_budget_bytes` is 1000000"), memory, "{error}");
        let summary = summary(&folder.path().join("forwardstep-runs/two"));
        let cause = &summary["ending"]["breakdown"]["cause"];
        let stiffness = &cause[if memory { "memory_full" } else { "step_under_floor" }]["stiffness"];
        let [fastest, adaptation] =
            ["fastest_per_s", "adaptation_per_s"].map(|rate| stiffness[rate].as_f64().unwrap_or(f64::NAN));
        assert!((0.5..2.0).contains(&(fastest / adaptation)), "{stiffness}");
    }
}

#[test]
fn a_reader_who_leaves_early_is_no_error() {
    for arguments in [&["schema"][..], &["scenarios", "six-arms"], &["scenarios"]] {
        let binary = assert_cmd::cargo::cargo_bin("forwardstep");
        let mut process =
            Process::new(binary).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(process.stdout.take());
        let output = process.wait_with_output().unwrap();
        assert_eq!((output.status.code(), String::from_utf8(output.stderr).unwrap().as_str()), (Some(0), ""));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn text_that_cannot_be_written_is_an_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let binary = assert_cmd::cargo::cargo_bin("forwardstep");
    let output = Process::new(binary).arg("schema").stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(!output.stderr.is_empty());
}

/// A run of years of simulated time, so that it cannot end by itself, told to stop by `signals`, one after the other:
/// what it exits with and what it says.
#[cfg(unix)]
fn stopped(folder: &TempDir, mut command: Process, signals: &[&str]) -> (Option<i32>, String) {
    use std::io::{BufRead, BufReader};

    let long = QUICK.replace("end_s = 30, record_every_s = 0.1", "end_s = 1e8, record_every_s = 100");
    fs::write(folder.path().join("two.toml"), long).unwrap();
    let mut process = command
        .arg(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(folder)
        .args(["run", "two.toml"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
    // The verdicts are printed before the run, when the handler is in place.
    assert_eq!(lines.next().unwrap().unwrap(), "Two arms");
    for signal in signals {
        std::thread::sleep(std::time::Duration::from_millis(500));
        assert!(process.try_wait().unwrap().is_none(), "ended before {signal}");
        Process::new("kill").args([signal, process.id().to_string().as_str()]).status().unwrap();
    }
    let text: Vec<_> = lines.map(Result::unwrap).collect();
    let output = process.wait_with_output().unwrap();
    assert!(text.iter().any(|line| line.contains("final disagreement")), "{text:?}");
    let summary = summary(&folder.path().join("forwardstep-runs/two"));
    assert_eq!(summary["ending"]["kind"], "interrupted");
    assert!(summary["ending"]["t_s"].as_f64().unwrap() > 0.0);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_was_computed() {
    let (status, error) = stopped(&folder(), Process::new("env"), &["-INT"]);
    assert_eq!(status, Some(130));
    assert!(error.starts_with("Interrupted at t = "), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn regress_other_signals_keep_what_was_computed() {
    for (signal, status) in [("-TERM", 143), ("-HUP", 129)] {
        // Whoever runs the tests may do so under `nohup`.
        let mut command = Process::new("env");
        command.arg("--default-signal=HUP");
        let (found, error) = stopped(&folder(), command, &[signal]);
        assert_eq!(found, Some(status), "{signal}");
        assert!(error.starts_with("Interrupted at t = "), "{error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_under_nohup_outlives_its_terminal() {
    let mut command = Process::new("env");
    command.arg("--ignore-signal=HUP");
    let (status, _) = stopped(&folder(), command, &["-HUP", "-TERM"]);
    assert_eq!(status, Some(143));
}

/// Names that would colour, clear, turn round or forge what a terminal shows.
#[cfg(unix)]
#[test]
fn no_name_from_outside_reaches_the_terminal_raw() {
    const EVIL: &str = "a\u{1b}[31m\u{1b}[2J\u{202e}\u{9b}\r\nerror: forged\u{2028}";
    let folder = folder();
    let named = |end: &str| format!("{EVIL}{end}");
    fs::write(folder.path().join(named(".toml")), QUICK).unwrap();
    fs::write(folder.path().join(named("2.toml")), QUICK.replace("title", "titel")).unwrap();
    fs::write(folder.path().join(named(".urdf")), "<robot").unwrap();
    fs::create_dir(folder.path().join(named(".d"))).unwrap();
    let urdf = QUICK
        .replace("robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }", "robot.urdf.file = \"x.urdf\"");
    fs::write(folder.path().join("urdf.toml"), urdf).unwrap();
    let (fine, wrong, robot, run) = (named(".toml"), named("2.toml"), named(".urdf"), named(".d"));
    let option = format!("--{EVIL}");
    for arguments in [
        &["check", &fine][..],
        &["check", &fine, "--json"],
        &["explain", &fine, "--latex"],
        &["run", &fine, "--out", &run],
        &["run", &fine, "--out", &run],
        &["report", &run],
        &["report", EVIL],
        &["check", &wrong],
        &["check", "missing.toml"],
        &["check", "urdf.toml"],
        &["check", EVIL],
        &["robot", &robot],
        &["robot", EVIL],
        &["upgrade", &wrong],
        &["upgrade", EVIL],
        &["new", "--robot", &robot],
        &["new", &fine],
        &["run", "six-arms", &option],
        &["run", "six-arms", "--set", EVIL],
        &["check", "six-arms", "--accept", EVIL],
        &["check", "six-arms", "--certificate", &run],
        &["scenarios", EVIL],
        &[EVIL],
    ] {
        let done = forwardstep(&folder, arguments);
        for said in [stdout(&done), stderr(&done)] {
            let raw = |c: char| c.is_control() && c != '\n' && c != '\t' || matches!(c, '\u{202e}' | '\u{2028}');
            assert!(!said.contains(raw), "{arguments:?}: {said:?}");
            assert!(!said.lines().any(|line| line.trim_start().starts_with("error: forged")), "{arguments:?}: {said}");
        }
    }
}

#[test]
fn a_goal_about_one_agent_alone_is_refused() {
    let folder = folder();
    let text = QUICK.replace("count = 2\n", "").replace("[[0.1, 0.2], [0.3, 0.4]]", "[0.1, 0.2]");
    let (text, _) = text.split_once("edges").unwrap();
    fs::write(folder.path().join("one.toml"), format!("{text}edges = []\n[goal]\ndisagreement_below = 1e-3\n"))
        .unwrap();
    let refused = stderr(&forwardstep(&folder, &["check", "one.toml"]).code(2));
    assert!(refused.contains("compares agents, but there is one only") && refused.contains("one.toml:"), "{refused}");
}

#[test]
fn thm6_a_start_without_an_inverse_ends_the_run_with_the_value_that_vanishes() {
    let folder = folder();
    for (name, start, signal) in [
        ("theorem-6", "[0.3, 0]", "arm.det_jacobian is 0 where"),
        ("pose-ur5e", "[0, 0, 0, 0, 0, 0]", "arm.sigma_min_jacobian is 0 where"),
    ] {
        let shipped = stdout(&forwardstep(&folder, &["scenarios", name]).success());
        let lines = shipped.lines().map(|line| match line.starts_with("start.position_rad") {
            true => format!("start.position_rad = {start}\n"),
            false => format!("{line}\n"),
        });
        fs::write(folder.path().join("arm.toml"), lines.collect::<String>()).unwrap();
        let ended = stderr(&forwardstep(&folder, &["run", "arm.toml", "--force"]).code(3));
        assert!(ended.contains("Broke down at t = 0 s") && ended.contains(signal), "{name}: {ended}");
    }
}

#[cfg(unix)]
#[test]
fn a_terminal_gets_lines_of_its_width_and_a_pipe_whole_ones() {
    let folder = folder();
    let program = assert_cmd::cargo::cargo_bin("forwardstep");
    let widest = |text: &[u8]| {
        let text = String::from_utf8_lossy(text).replace('\r', "");
        text.lines().map(textwrap::core::display_width).max().unwrap_or(0)
    };
    let piped = Process::new(&program).current_dir(&folder).args(["check", "first-order"]).output().unwrap();
    assert!(widest(&piped.stdout) > 150);
    let command = format!("stty cols 60; '{}' check first-order", program.display());
    // A system without `script` has no terminal for tests.
    let shown = Process::new("script").current_dir(&folder).args(["-qec", &command, "/dev/null"]).output();
    let Ok(shown) = shown else { return };
    assert!(shown.status.success() && (40..=60).contains(&widest(&shown.stdout)), "{shown:?}");
}
