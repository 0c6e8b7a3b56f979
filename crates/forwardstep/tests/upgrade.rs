//! Scenario files and runs of format 1: converted by `forwardstep upgrade`, and still reported.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{folder, forwardstep, names, stderr, stdout};
use forwardstep::io::SourceText;
use forwardstep::io::output::SavedRun;
use forwardstep::io::scenario::{ScenarioError, Upgraded, read_scenario, shipped_scenario, upgrade};
use forwardstep::sim::Signal;

/// Files as they were written in format 1.
fn old(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/format_1").join(name)
}

const FILES: [&str; 7] =
    ["arms", "rotorcraft", "teleoperation", "task-space-ur5e", "swarm-tracking", "layer", "own-law"];

fn text_of(name: &str) -> String {
    fs::read_to_string(old(&format!("{name}.toml"))).unwrap()
}

fn upgraded(text: &str) -> Result<Upgraded, ScenarioError> {
    upgrade(&SourceText::new("old.toml", text))
}

fn setup_of(text: &str, folder: &Path) -> String {
    let read = read_scenario("new", &SourceText::new("new.toml", text), Some(folder));
    format!("{:?}", read.unwrap_or_else(|error| panic!("{error}\n{text}")).setup)
}

#[test]
fn every_old_key_is_renamed_and_nothing_else_changes() {
    let mut seen = String::new();
    for name in FILES {
        let text = text_of(name);
        let new = upgraded(&text).unwrap();
        setup_of(&new.text, &old(""));
        assert_eq!(text.lines().count(), new.text.lines().count(), "{name}");
        for (k, (from, to)) in text.lines().zip(new.text.lines()).enumerate() {
            let moved = new.moved.iter().find(|moved| moved.line == k + 1);
            let said = moved.map_or((from.trim(), from.trim()), |moved| (moved.from.as_str(), moved.to.as_str()));
            assert_eq!(said, (from.trim(), to.trim()), "{name}:{}", k + 1);
            let comment = |line: &str| line.split_once('#').map(|(_, comment)| comment.to_owned());
            assert_eq!(comment(from), comment(to), "{name}:{}", k + 1);
        }
        seen.extend(new.moved.iter().map(|moved| format!("{}\n", moved.from)));
        assert!(new.moved[0].to.contains("format = 2"), "{name}");
        // It is of the present format now.
        let again = upgraded(&new.text).unwrap();
        assert_eq!((again.text, again.moved), (new.text, Vec::new()), "{name}");
    }
    for key in [
        "ledger",
        "[[pushes]]",
        "hand_on_axes",
        "hand_on_point",
        "spread",
        "[agents.spread]",
        "tip = {",
        "tip.at_m",
        "sign_every_s",
        "sign.layer",
        "every_s = 0.05, ",
        "random = { probability = 0.3, most_in_a_row",
        "loss.bursts.most_in_a_row",
    ] {
        assert!(seen.contains(key), "{key} in no file of format 1");
    }
}

#[test]
fn upgraded_scenarios_are_the_shipped_ones() {
    for name in ["teleoperation", "task-space-ur5e", "swarm-tracking"] {
        let new = upgraded(&text_of(name)).unwrap();
        assert_eq!(setup_of(&new.text, &old("")), setup_of(shipped_scenario(name).unwrap().text, &old("")), "{name}");
    }
}

#[test]
fn an_upgraded_scenario_runs_to_the_same_bits() {
    let folder = folder();
    for name in ["arms.toml", "torques.csv", "rotorcraft.toml"] {
        fs::copy(old(name), folder.path().join(name)).unwrap();
    }
    let said = stdout(&forwardstep(&folder, &["upgrade", "arms.toml", "rotorcraft.toml"]).success());
    assert!(said.contains("arms.toml:4: format = 1 → format = 2\n"), "{said}");
    assert!(said.contains("arms.toml:48: ledger = true "), "{said}");
    assert!(said.contains(" → lyapunov_balance = true "), "{said}");
    assert_eq!(names(folder.path()), ["arms.toml", "rotorcraft.toml", "torques.csv"]);
    for name in ["arms", "rotorcraft"] {
        forwardstep(&folder, &["run", &format!("{name}.toml"), "--out", name]).success();
        let copy = folder.path().join(format!("old-{name}"));
        copy_folder(&old(&format!("runs/{name}")), &copy);
        let runs = [folder.path().join(name), copy].map(|path| SavedRun::open(&path).unwrap());
        let [new, then] = runs.each_ref().map(|run| {
            let report = forwardstep::check::check(run.setup());
            run.record(&report, forwardstep_check::Practical::default(), None, &[]).outcome.recording.clone()
        });
        if name == "rotorcraft" {
            assert!(format!("{new:?}") == format!("{then:?}"), "{name}");
        }
        // Signs were set by what was heard a step before when this was recorded, and they chatter.
        for (new, then) in new.columns.iter().zip(&then.columns).filter(|(new, _)| new.signal == Signal::Position) {
            let apart = new.values.iter().zip(&then.values).map(|(new, then)| (new - then).abs());
            assert!(apart.fold(0.0, f64::max) < 0.05, "{name}");
        }
        assert_eq!(format!("{:?}", runs[0].setup()), format!("{:?}", runs[1].setup()), "{name}");
    }
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &to);
        } else {
            fs::copy(entry.path(), to).unwrap();
        }
    }
}

#[test]
fn runs_of_format_1_are_reported() {
    let folder = folder();
    for name in ["arms", "rotorcraft"] {
        let run = folder.path().join(name);
        copy_folder(&old(&format!("runs/{name}")), &run);
        let said = stderr(&forwardstep(&folder, &["report", name]).success());
        // What verdicts say may change from version to version, and then that is said as well.
        let notes = said.lines().filter(|line| line.starts_with("note: ") && !line.contains("worked out anew"));
        assert_eq!(notes.count(), 1, "{said}");
        assert!(said.contains("written in an earlier format"), "{said}");
        let page = fs::read_to_string(run.join("report.html")).unwrap();
        assert!(!page.contains("omega_wanted") && !page.contains("family-sign\""), "{name}");
        assert_eq!(page.contains("family-selection"), name == "arms");
        // The folder keeps its format: nothing but pictures was written.
        for file in ["scenario.toml", "summary.json", "trajectory.parquet"] {
            assert_eq!(fs::read(run.join(file)).unwrap(), fs::read(old(&format!("runs/{name}")).join(file)).unwrap());
        }
    }
}

#[test]
fn a_file_of_format_1_is_refused_with_the_command_that_converts_it() {
    let folder = folder();
    fs::copy(old("rotorcraft.toml"), folder.path().join("old.toml")).unwrap();
    let refused = stderr(&forwardstep(&folder, &["check", "old.toml"]).code(2));
    assert!(refused.contains("`format` is 1, but this version reads format 2"), "{refused}");
    assert!(refused.contains("`forwardstep upgrade old.toml`"), "{refused}");
    fs::write(folder.path().join("later.toml"), "format = 3").unwrap();
    for command in ["check", "upgrade"] {
        let refused = stderr(&forwardstep(&folder, &[command, "later.toml"]).code(2));
        assert!(refused.contains("`format` is 3") && refused.contains("a later version"), "{refused}");
    }
}

#[test]
fn files_are_converted_whole_or_not_at_all() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let text = text_of("own-law");
    fs::write(path("one.toml"), &text).unwrap();
    let new = stdout(&forwardstep(&folder, &["upgrade", "one.toml", "--stdout"]).success());
    assert_eq!(fs::read_to_string(path("one.toml")).unwrap(), text);
    assert!(new.contains("law.task_space.end_effector.at_m = [0, 0, 0.15]    # twice"), "{new}");
    forwardstep(&folder, &["upgrade", "one.toml", "--out", "two.toml"]).success();
    assert_eq!(fs::read_to_string(path("one.toml")).unwrap(), text);
    assert_eq!(fs::read_to_string(path("two.toml")).unwrap(), new);
    let same = stdout(&forwardstep(&folder, &["upgrade", "two.toml"]).success());
    assert_eq!(same, "two.toml is of the present format\n");
    // Of several files, those that cannot be converted stay, and the others are converted.
    fs::write(path("both.toml"), "format = 1\n[solver]\nledger = true\nlyapunov_balance = true\n").unwrap();
    fs::write(path("broken.toml"), "format = 1\n[solver\n").unwrap();
    let failed = forwardstep(&folder, &["upgrade", "both.toml", "broken.toml", "none.toml", "one.toml"]).code(2);
    let said = stderr(&failed);
    assert!(said.contains("both `ledger` and `lyapunov_balance` are given"), "{said}");
    assert!(said.contains("broken.toml:2:") && said.contains("cannot read `none.toml`"), "{said}");
    assert!(fs::read_to_string(path("both.toml")).unwrap().contains("ledger = true"));
    assert_eq!(fs::read_to_string(path("one.toml")).unwrap(), new);
    let several = stderr(&forwardstep(&folder, &["upgrade", "one.toml", "two.toml", "--out", "three.toml"]).code(2));
    assert!(several.contains("`--out` is for one file"), "{several}");
    let several = stderr(&forwardstep(&folder, &["upgrade", "one.toml", "two.toml", "--stdout"]).code(2));
    assert!(several.contains("`--stdout` is for one file"), "{several}");
    assert_eq!(names(folder.path()), ["both.toml", "broken.toml", "one.toml", "two.toml"]);
}

#[test]
fn names_that_look_like_keys_and_line_ends_stay() {
    let text = "format = 1 # one\r\n[[agents]]\r\nname = \"pushes\"\r\n\
                robot.urdf = { file = \"spread\", locked = { spread = 0, tip = 1, \"law.task_space.tip\" = 2 } }\r\n\
                spread.seed = 1\r\n[network.phases.x.packets]\r\nevery_s = 1 # s\r\n";
    let expected = text
        .replace("format = 1", "format = 2")
        .replace("spread.seed", "parameter_variation.seed")
        .replace("every_s", "period_s");
    assert_eq!(upgraded(text).unwrap().text, expected);
    assert!(upgraded("time.end_s = 1").is_err() && upgraded("format = \"one\"").is_err());
}
