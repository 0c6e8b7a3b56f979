//! Folders that are no whole run, that cannot be written, or in which something is not what a run wrote.

use std::fs;
use std::path::Path;

use super::{ARMS, contents, differences, is_rebuilt};
use crate::support::{folder, forwardstep, names, stderr};
use forwardstep::io::output::RunFolder;

#[test]
fn what_is_wrong_is_said_and_nothing_is_harmed() {
    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    forwardstep(&folder, &["run", "arms.toml", "--csv", "--out", "run"]).success();
    let run = folder.path().join("run");
    let sound = contents(&run);
    let text = |name: &str| String::from_utf8(sound[name].clone()).unwrap();
    let table = text("trajectory.csv");
    let cut = table.len() * 2 / 3;
    let whole_lines = table[..cut].rfind('\n').unwrap() + 1;
    let half_a_table = sound["trajectory.parquet"][..sound["trajectory.parquet"].len() / 2].to_vec();
    let mut one_bit = sound["trajectory.parquet"].clone();
    one_bit[1000] ^= 1;
    let replaced = |name: &str, from: &str, to: &str| {
        assert!(text(name).contains(from), "{from}");
        text(name).replacen(from, to, 1).into_bytes()
    };
    let without = "trajectory.parquet";
    // The file, what stands in it instead, whether Parquet is out of the way, and what is said about it.
    let cases: Vec<(&str, Option<Vec<u8>>, &str, &str)> = vec![
        ("summary.json", None, "", "holds no whole run: there is no summary.json in it"),
        ("summary.json", Some(b"{".to_vec()), "", "not a summary as runs write it: EOF while parsing"),
        ("summary.json", Some(b"[]".to_vec()), "", "not a summary as runs write it"),
        ("summary.json", Some(vec![0xff]), "", "it is no UTF-8 text"),
        (
            "summary.json",
            Some(b"{\"format\": 3}".to_vec()),
            "",
            "its format is 3, and this version of forwardstep reads",
        ),
        ("summary.json", Some(replaced("summary.json", "\"kind\"", "\"king\"")), "", "missing field `kind` at line"),
        (
            "summary.json",
            Some(replaced("summary.json", "\"kind\": \"completed\"", "\"kind\": \"broke_down\"")),
            "",
            "it says that nothing broke down, and the scenario has no such signal",
        ),
        (
            "summary.json",
            Some(replaced(
                "summary.json",
                "\"inputs\": []",
                "\"inputs\": [{\"name\": \"a\", \"file\": \"../a\", \"digest_blake3\": \"\"}]",
            )),
            "",
            "the copy of an input is `../a`, which is not in `inputs/`",
        ),
        ("scenario.toml", None, "", "there is no scenario.toml in it"),
        (
            "scenario.toml",
            Some(replaced("scenario.toml", "end_s", "ens_s")),
            "",
            "run/scenario.toml:4:10: unknown key `ens_s`",
        ),
        ("scenario.toml", Some(replaced("scenario.toml", "\"arm\"", "\"leg\"")), "", "there is no agent `arm-1`"),
        (
            "scenario.toml",
            Some(text("scenario.toml").replace("\"arm", "\"leg").into_bytes()),
            "",
            "there is no column `leg-1.q.shoulder`",
        ),
        (
            "scenario.toml",
            Some(replaced("scenario.toml", "[network]", "[law.known]\n[network]")),
            "",
            "records the column `arm-1.theta_hat.",
        ),
        ("trajectory.parquet", Some(half_a_table), "", "trajectory.parquet`: it was changed or damaged since the run"),
        ("trajectory.parquet", Some(one_bit), "", "trajectory.parquet`: it was changed or damaged since the run"),
        ("trajectory.parquet", Some(Vec::new()), "", "trajectory.parquet`: it was changed or damaged since the run"),
        ("trajectory.csv", None, without, "there is no trajectory.parquet or trajectory.csv in it"),
        ("trajectory.csv", Some(Vec::new()), without, "there is no column `t_s`"),
        ("trajectory.csv", Some(table.as_bytes()[..cut].to_vec()), without, "found record with"),
        ("trajectory.csv", Some(table.as_bytes()[..whole_lines].to_vec()), without, "rows, and the run wrote 31"),
        (
            "trajectory.csv",
            Some(replaced("trajectory.csv", "\n0.1,", "\nsoon,")),
            without,
            "line 3: `soon` in the column `t_s` is no number",
        ),
        ("trajectory.csv", Some(replaced("trajectory.csv", "\n0.1,", "\n7,")), without, "time does not rise at row 3"),
        (
            "trajectory.csv",
            Some(replaced("trajectory.csv", "\n3.0,", "\n1e9,")),
            without,
            "its last row is at t = 1000000000 s, and the scenario ends at 3 s",
        ),
        (
            "trajectory.csv",
            Some(replaced("trajectory.csv", "\n3.0,", "\ninf,")),
            without,
            "its last row is at t = inf s",
        ),
        (
            "trajectory.csv",
            Some(replaced("trajectory.csv", "arm-1.q.shoulder", "arm-1.p.shoulder")),
            without,
            "there is no column `arm-1.q.shoulder`",
        ),
        (
            "trajectory.csv",
            Some(replaced("trajectory.csv", "arm-1.q.shoulder", "arm-1.q.elbow")),
            without,
            "two columns `arm-1.q.elbow`",
        ),
    ];
    for (name, instead, out_of_the_way, expected) in cases {
        match instead {
            Some(bytes) => fs::write(run.join(name), bytes).unwrap(),
            None => fs::remove_file(run.join(name)).unwrap(),
        }
        if !out_of_the_way.is_empty() {
            fs::remove_file(run.join(out_of_the_way)).unwrap();
        }
        let before = contents(&run);
        let error = stderr(&forwardstep(&folder, &["report", "run"]).code(2));
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(error.contains("help: "), "what to do: {error}");
        assert_eq!(differences(&before, &contents(&run)), [""; 0], "{expected}");
        for (name, bytes) in &sound {
            fs::write(run.join(name), bytes).unwrap();
        }
    }
    is_rebuilt(&folder, "run");
}

#[test]
fn what_is_no_folder_of_a_run_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    forwardstep(&folder, &["run", "arms.toml"]).success();
    let cases = [
        ("arms", "there is no folder `arms`", "did you mean `forwardstep-runs/arms`?"),
        ("forwardstep-runs/arms/report.html", "is not a folder", "did you mean `forwardstep-runs/arms`?"),
        ("elsewhere", "there is no folder `elsewhere`", "give the folder of a run"),
        (".", "`.` holds no whole run", "run the scenario again"),
    ];
    for (asked, error, help) in cases {
        let said = stderr(&forwardstep(&folder, &["report", asked]).code(2));
        assert!(said.contains(error) && said.contains(help), "{said}");
    }
    assert_eq!(contents(folder.path()).keys().filter(|name| !name.starts_with("forwardstep-runs")).count(), 1);
}

#[test]
fn a_failure_while_writing_leaves_the_old_report_whole() {
    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    forwardstep(&folder, &["run", "arms.toml", "--out", "run"]).success();
    let run = folder.path().join("run");
    fs::write(run.join("report.html"), "old").unwrap();
    // A folder under a temporary name cannot be opened as a file.
    fs::create_dir(run.join("plots/.estimates.svg.partial")).unwrap();
    let before = contents(&run);
    let error = stderr(&forwardstep(&folder, &["report", "run"]).code(2));
    assert!(error.contains("run/plots/.estimates.svg.partial is a folder, where a run has to write"), "{error}");
    assert_eq!(differences(&before, &contents(&run)), [""; 0]);
}

#[cfg(unix)]
#[test]
fn a_folder_that_is_closed_to_us_is_an_error() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    forwardstep(&folder, &["run", "arms.toml", "--out", "run"]).success();
    let run = folder.path().join("run");
    let mode = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    mode(&run, 0o555);
    let is_privileged = fs::write(run.join("probe"), "").is_ok();
    if !is_privileged {
        let error = stderr(&forwardstep(&folder, &["report", "run"]).code(2));
        assert!(
            error.contains("could not write into the folder run") && error.contains("make the folder writable"),
            "{error}"
        );
    }
    mode(&run, 0o755);
    mode(&run.join("trajectory.parquet"), 0o000);
    if !is_privileged {
        let error = stderr(&forwardstep(&folder, &["report", "run"]).code(2));
        assert!(error.contains("trajectory.parquet`: permission denied") && error.contains("readable"), "{error}");
    }
}

/// The advice was to run it again.
#[test]
fn regress_a_run_without_rows_yet_is_not_said_to_be_over() {
    let folder = folder();
    fs::create_dir(folder.path().join("begun")).unwrap();
    let claimed = RunFolder::create(folder.path().join("begun"), false).unwrap();
    let error = stderr(&forwardstep(&folder, &["report", "begun"]).code(2));
    assert!(error.contains("a run is writing to it and has no rows yet"), "{error}");
    // A copy is nobody's. (The claim itself may outlive this by the moment in which another test forks.)
    fs::create_dir(folder.path().join("left")).unwrap();
    for name in names(&folder.path().join("begun")) {
        fs::copy(folder.path().join("begun").join(&name), folder.path().join("left").join(&name)).unwrap();
    }
    drop(claimed);
    let error = stderr(&forwardstep(&folder, &["report", "left"]).code(2));
    assert!(error.contains("run the scenario again"), "{error}");
}
