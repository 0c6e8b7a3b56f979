//! What a run says at its end, and what it advises.

use std::fs;

use super::QUICK;
use crate::support::{folder, forwardstep, stderr, stdout};

/// Twelve carts, every other at the other end.
const RING: &str = r#"format = 2
title = "A ring"
time = { end_s = 1, record_every_s = 0.1 }
[[agents]]
name = "cart"
count = 12
robot.point_mass = { dimension = 1, mass_kg = 1 }
start.position_m = [[1], [-1], [1], [-1], [1], [-1], [1], [-1], [1], [-1], [1], [-0.8]]
[reference.consensus]
roots_per_s = [3, 4]
exchange = "position_velocity"
[law.known]
[network]
edges.ring = { direction = "both" }
[goal]
disagreement_below = 1e-3
"#;

#[test]
fn a_run_that_ends_too_early_says_so_and_how_long_would_be_enough() {
    let folder = folder();
    let run = |end_s: &str| {
        let text =
            format!("{QUICK}[goal]\ndisagreement_below = 1e-3\n").replace("end_s = 30", &format!("end_s = {end_s}"));
        fs::write(folder.path().join("two.toml"), text).unwrap();
        forwardstep(&folder, &["run", "two.toml", "--out", "two", "--force"])
    };
    let short = run("3").code(1);
    let text = stdout(&short);
    let words = text.lines().find(|line| line.trim_start().starts_with("in words")).unwrap();
    assert!(words.contains("not agreed: ") && words.contains(" rad apart (arm-1, arm-2), still moving at "), "{words}");
    assert!(words.ends_with(" rad/s, and coming closer"), "{words}");
    let page = fs::read_to_string(folder.path().join("two/report.html")).unwrap();
    assert!(page.contains("not agreed: ") && page.contains("run longer"));
    let advised = text.split("`time.end_s = ").nth(1).and_then(|rest| rest.split('`').next()).unwrap();
    assert!(advised.parse::<f64>().unwrap() < 30.0, "{advised}");
    let long = stdout(&run(advised).success());
    assert!(long.contains("in words") && long.contains(" agreed: ") && !long.contains("to change"), "{long}");
}

/// The quarters of a run that falls from row to row tell little apart at its beginning.
#[test]
fn regress_what_falls_from_row_to_row_comes_closer() {
    let folder = folder();
    let text = format!("{QUICK}[goal]\ndisagreement_below = 1e-3\n").replace("end_s = 30", "end_s = 0.4");
    fs::write(folder.path().join("two.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "two.toml"]).code(1));
    assert!(said.contains(", and coming closer") && said.contains("would be about enough"), "{said}");
}

/// What disturbs neighbours fades in a moment; what has to go all around takes long, and is most of what is left.
#[test]
fn a_run_that_looks_quick_at_first_is_told_how_long_its_design_takes() {
    let folder = folder();
    let run = |end_s: &str| {
        fs::write(folder.path().join("ring.toml"), RING.replace("end_s = 1", &format!("end_s = {end_s}"))).unwrap();
        forwardstep(&folder, &["run", "ring.toml", "--out", "ring", "--force"])
    };
    for short in ["1", "2"] {
        let text = stdout(&run(short).code(1));
        let advised = text.split("`time.end_s = ").nth(1).and_then(|rest| rest.split('`').next()).unwrap();
        assert!(advised.len() <= 3, "{advised}");
        let long = stdout(&run(advised).success());
        assert!(long.contains(" agreed: "), "{long}");
    }
}

/// What delays leave is not put down to the robots; what robots leave is.
#[test]
fn what_late_links_leave_behind_a_leader_is_said_to_be_theirs() {
    let folder = folder();
    let shipped = forwardstep::io::scenario::shipped_scenario("leader-over-late-links").unwrap().text;
    let goal = shipped.replace("error_below = 0.14", "error_below = 0.014");
    let prompt = goal.lines().filter(|line| !line.starts_with("delay.")).collect::<Vec<_>>().join("\n");
    let loose = prompt.replace("damping.gain = 100", "damping.gain = 0.3").replace("end_s = 40", "end_s = 10");
    for (name, text, late) in [("late", &goal, true), ("loose", &loose, false)] {
        fs::write(folder.path().join(format!("{name}.toml")), text).unwrap();
        let said = stdout(&forwardstep(&folder, &["run", &format!("{name}.toml")]).code(1));
        assert_eq!(said.contains("messages are late"), late, "{name}: {said}");
        assert_eq!(said.contains("robots do not follow"), !late, "{name}: {said}");
    }
}

#[test]
fn regress_what_the_comparison_with_continuous_time_takes_is_told_too() {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), format!("{QUICK}[control]\nsample_hz = 50\n")).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "two.toml"]).success());
    let wall = said.lines().find(|line| line.trim_start().starts_with("wall time")).unwrap();
    assert!(wall.contains(" × real time, and ") && wall.ends_with(" s for the same in continuous time"), "{wall}");
    fs::write(folder.path().join("two.toml"), QUICK).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "two.toml", "--force"]).success());
    assert!(!said.contains("for the same in continuous time"), "{said}");
}

#[test]
fn regress_a_scenario_without_a_command_is_told_its_command() {
    let folder = folder();
    for (word, pasted) in [("two.toml", "two.toml"), ("six-arms", "six-arms"), ("my arms.toml", "'my arms.toml'")] {
        let said = stderr(&forwardstep(&folder, &[word]).code(2));
        assert!(said.contains(&format!("`forwardstep run {pasted}`")), "{said}");
    }
    let said = stderr(&forwardstep(&folder, &["nonsense"]).code(2));
    assert!(!said.contains("forwardstep run"), "{said}");
}

#[test]
fn regress_values_below_zero_are_refused_as_values() {
    let folder = folder();
    let cases: [(&[&str], &str); 5] = [
        (&["new", "--agents", "-3"], "must be a whole number from 1 to 100"),
        (&["new", "--order", "-1"], "must be a whole number from 1 to 8"),
        (&["manipulability", "--lambda", "-1,0"], "must be a number of at least 0"),
        (&["smoothness", "--filters", "-0.1"], "must be a number above 0"),
        (&["sampling-limit", "--late", "-1"], "invalid value '-1'"),
    ];
    for (arguments, words) in cases {
        let said = stderr(&forwardstep(&folder, arguments).code(2));
        assert!(said.contains(words) && !said.contains("'-- -"), "{arguments:?}: {said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn regress_help_that_cannot_be_written_is_an_error_and_a_name_that_is_no_text_has_a_next_step() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::{Command, Stdio};

    let binary = assert_cmd::cargo::cargo_bin("forwardstep");
    for arguments in [&["--help"][..], &["run", "--help"], &["-V"]] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = Command::new(&binary).args(arguments).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && said.contains("cannot write to the standard output"), "{said}");
    }
    let output = Command::new(&binary).arg("run").arg(OsStr::from_bytes(b"\xff.toml")).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && said.contains("rename the file"), "{said}");
}

/// What grows without end breaks down for want of memory, or of small enough steps; neither is what is to be mended.
#[test]
fn regress_a_run_that_broke_down_because_agents_drive_each_other_apart_says_that() {
    let folder = folder();
    let text = r#"format = 2
title = "Two agents that hear each other late and with large weights, and move by the cube of where they are"
time.end_s = 60
solver.memory_budget_bytes = 2000000
[[agents]]
name = "agent"
count = 2
robot.chain = { order = 2, chi = "x^3", psi = "2 + cos(x)" }
start.position = [[1.0], [-0.5]]
[reference.desired]
polynomial = { integrators = 1, roots_per_s = [1, 2] }
coupling_polynomial = [1]
[law.linearising]
gain_per_s = 2
[network]
weight = 60
delay.constant_s = 0.5
edges.ring = {}
"#;
    fs::write(folder.path().join("own.toml"), text).unwrap();
    let run = forwardstep(&folder, &["run", "own.toml", "--out", "own"]).code(3);
    let said = stdout(&run);
    assert!(stderr(&run).contains(" bytes, and more as steps become shorter, where"), "{}", stderr(&run));
    assert!(
        said.contains("driven apart: axis 1, ") && said.contains(" apart (agent-1, agent-2), 1.5 at the"),
        "{said}"
    );
    assert!(said.contains("to change             not shown [desired-dynamics]"), "{said}");
    let page = fs::read_to_string(folder.path().join("own/report.html")).unwrap();
    // What is of no unit has none, and a balance that is far off does not hold to anything.
    assert!(
        page.contains("driven apart: axis 1, ")
            && page.contains(" leaves V(0) by ")
            && page.contains(", where V(0) is ")
    );
    let figure = fs::read_to_string(folder.path().join("own/plots/positions.svg")).unwrap();
    assert!(figure.contains("Positions – Two agents that hear") && figure.contains('…'), "a long title is shortened");
}

/// Two masses in a tenth of a second are as far apart without s: nothing is to be mended about the robots.
#[test]
fn regress_robots_are_not_blamed_for_what_the_design_leaves_as_well() {
    let folder = folder();
    let text = r#"format = 2
time.end_s = 0.1
[[agents]]
name = "mass"
count = 2
robot.point_mass = { dimension = 1, mass_kg = 2 }
start.position_m = [[0], [1]]
[reference.consensus]
roots_per_s = [1, 2]
exchange = "position"
[network]
delay.constant_s = 0.2
edges.ring = {}
[goal]
disagreement_below = 1e-3
"#;
    fs::write(folder.path().join("two.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "two.toml"]).code(1));
    assert!(
        said.contains("not agreed: axis 1, 1 m apart") && said.contains("it needs some 19 s more at least; larger"),
        "{said}"
    );
    assert!(!said.contains("do not follow their references"), "{said}");
}

#[test]
fn one_file_too_many_or_too_few_and_numbers_that_are_none_have_a_next_step() {
    let folder = folder();
    fs::write(folder.path().join("own.toml"), QUICK).unwrap();
    let said = |arguments: &[&str]| stderr(&forwardstep(&folder, arguments).code(2));
    assert!(
        said(&["run", "own.toml", "theorem-1"])
            .contains("tip: one scenario or run at a time; `forwardstep compare A B`")
    );
    assert!(said(&["compare", "own.toml"]).contains("tip: name two runs or scenarios at least"));
    for (found, help) in [("\"30\"", "write 30, without quotes"), ("\"soon\"", "where a number should stand")] {
        fs::write(folder.path().join("text.toml"), QUICK.replace("end_s = 30", &format!("end_s = {found}"))).unwrap();
        let said = said(&["check", "text.toml"]);
        assert!(said.contains(help) && said.contains("without quotes") == help.contains("without"), "{said}");
    }
    fs::write(folder.path().join("count.toml"), QUICK.replace("count = 2", "count = 2.0")).unwrap();
    assert!(said(&["check", "count.toml"]).contains("help: write 2\n"));
    forwardstep(&folder, &["compare", "own.toml", "theorem-1", "--out", "both"]);
    let both = said(&["report", "both"]);
    assert!(both.contains("it is a comparison: give one of the runs"), "{both}");
}

/// Links that take turns: a time "would be enough" after which nine times as much was left.
#[test]
fn regress_of_a_gap_that_falls_unevenly_no_time_is_said_to_be_enough() {
    let folder = folder();
    let text = r#"
format = 2
time = { end_s = 5, record_every_s = 0.02 }
[[agents]]
name = "m0"
robot.point_mass = { dimension = 1, mass_kg = 1.2 }
start = { position_m = [0], velocity_m_s = [0.5] }
[[agents]]
name = "m1"
robot.point_mass = { dimension = 1, mass_kg = 0.7 }
start = { position_m = [-0.9], velocity_m_s = [-0.4] }
[reference.consensus]
roots_per_s = [3.3, 1.5, 1.9]
exchange = "position"
[law.adaptive]
damping.gain = 9.5
[[network.phases]]
dwell_s = 2.03
edges = [{ from = "m0", to = "m1", weight = 0.92 }]
[[network.phases]]
dwell_s = 0.32
edges = []
[[network.phases]]
dwell_s = 1.71
edges = [{ from = "m1", to = "m0", weight = 0.94, delay.constant_s = 0.1 }]
[goal]
disagreement_below = 1e-4
"#;
    fs::write(folder.path().join("turns.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "turns.toml"]).code(1));
    assert!(said.contains("comes closer unevenly; try `time.end_s = "), "{said}");
}

/// What ten samples a second leave of a target that tumbles swings with it, and a time was advised as if that fell.
#[test]
fn regress_what_samples_leave_of_a_motion_is_not_waited_for_alone() {
    let folder = folder();
    let text = stdout(&forwardstep(&folder, &["scenarios", "tumbling-target"]).success());
    fs::write(folder.path().join("t.toml"), text.replacen("[time]", "[control]\nsample_hz = 10\n\n[time]", 1)).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "t.toml", "--out", "out"]).code(1));
    assert!(said.contains("run longer, or sample faster: it comes closer unevenly"), "{said}");
}
