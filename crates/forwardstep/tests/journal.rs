//! Runs that are killed, or whose files may not grow, and what `forwardstep report` makes of what they left.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Child, Command as Process, Stdio};
use std::time::{Duration, Instant};

use crate::support::{folder, forwardstep, is_long, names, some, stderr};
use forwardstep::io::output::SavedRun;
use forwardstep::sim::Recording;
use tempfile::TempDir;

/// A run of some seconds, since its steps are short.
const LONG: &str = r#"
format = 2
title = "Two arms"
time = { end_s = 20, record_every_s = 0.01 }
solver.method.fixed.step_s = 2e-5
[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[network]
delay.constant_s = 0.1
edges.csv.file = "../links.csv"
"#;
const LINKS: &str = "from,to\narm-1,arm-2\narm-2,arm-1\n";

/// A folder with the scenario below it and a file that it names above that.
fn scenario() -> TempDir {
    let folder = folder();
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/long.toml"), LONG).unwrap();
    fs::write(folder.path().join("links.csv"), LINKS).unwrap();
    folder
}

fn start(folder: &TempDir, out: &str) -> Child {
    Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(folder)
        .args(["run", "mine/long.toml", "--out", out])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Waits until a run has a journal; whether it has, rather than that it has ended.
fn has_journal(run: &mut Child, out: &Path) -> bool {
    let started = Instant::now();
    loop {
        if out.join("rows.journal").exists() {
            return true;
        }
        if run.try_wait().unwrap().is_some() {
            return false;
        }
        assert!(started.elapsed() < Duration::from_secs(120), "a run of some seconds");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// What a folder recorded.
fn recording(out: &Path) -> Recording {
    let run = SavedRun::open(out).unwrap();
    let verdicts = forwardstep::check::check(run.setup());
    run.record(&verdicts, forwardstep_check::Practical::default(), None, &[]).outcome.recording.clone()
}

/// That the rows of `part` are the first of `whole`, bit for bit; how many they are.
fn first_rows(part: &Recording, whole: &Recording) -> usize {
    let rows = part.t_s.len();
    let bits = |values: &[f64]| values[..rows].iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&part.t_s), bits(&whole.t_s));
    assert_eq!(part.columns.len(), whole.columns.len());
    for (one, other) in part.columns.iter().zip(&whole.columns) {
        assert_eq!(bits(&one.values), bits(&other.values));
        assert_eq!(one.values.len(), rows);
    }
    rows
}

#[test]
fn a_run_that_was_killed_has_its_rows() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    forwardstep(&folder, &["run", "mine/long.toml", "--out", "whole"]).success();
    assert!(!names(&path("whole")).contains(&"rows.journal".to_owned()), "the tables are whole");
    let whole = recording(&path("whole"));
    let mut counts = Vec::new();
    let waits_ms = [0, 30, 400, 1100, 1900].into_iter().enumerate();
    for (k, wait_ms) in waits_ms.filter(|(k, _)| is_long() || ![2, 3].contains(k)) {
        let out = format!("killed-{k}");
        let mut run = start(&folder, &out);
        assert!(has_journal(&mut run, &path(&out)) || k > 1);
        std::thread::sleep(Duration::from_millis(wait_ms));
        run.kill().unwrap();
        run.wait().unwrap();
        let cut_off = path(&out).join("rows.journal").exists();
        if k == 1 {
            // Its files are not needed any more, and a run does not take the place of what was kept.
            let error = stderr(&forwardstep(&folder, &["run", "first-order", "--out", &out]).code(2));
            assert!(error.contains("is not empty"), "{error}");
            let kept = format!("`forwardstep report {out}` writes the files of what it computed");
            assert!(error.contains(&kept) && !error.contains("--force"), "{error}");
            fs::rename(path("links.csv"), path("moved.csv")).unwrap();
        }
        let note = stderr(&forwardstep(&folder, &["report", &out, "--out", &format!("{out}-elsewhere")]).success());
        let again = stderr(&forwardstep(&folder, &["report", &out]).success());
        // On a fast machine those that are killed late may have come to their end, and not to their tables.
        let ended = note.contains("the run ended before its tables were written");
        assert_eq!(note.contains("Was cut off at t = ") || ended, cut_off, "{note}");
        assert_eq!(note, again);
        let (here, elsewhere) = (recording(&path(&out)), recording(&path(&format!("{out}-elsewhere"))));
        assert_eq!(here, elsewhere);
        counts.push(first_rows(&here, &whole));
        assert!(!cut_off || ended || fs::read_to_string(path(&out).join("report.html")).unwrap().contains("Cut off"));
        assert!(!ended || k > 1, "{note}");
        assert!(!names(&path(&out)).contains(&"rows.journal".to_owned()));
        if k == 1 {
            fs::rename(path("moved.csv"), path("links.csv")).unwrap();
        }
    }
    assert!(counts[0] > 1, "{counts:?}");
    assert!(counts.last() > counts.first(), "a journal grows: {counts:?}");
}

#[test]
fn a_run_that_goes_on_is_looked_at_elsewhere_alone() {
    let folder = scenario();
    // Ten times as long as the others, so that it goes on while it is looked at.
    fs::write(folder.path().join("mine/long.toml"), LONG.replace("end_s = 20", "end_s = 200")).unwrap();
    let mut run = start(&folder, "live");
    assert!(has_journal(&mut run, &folder.path().join("live")));
    let error = stderr(&forwardstep(&folder, &["report", "live"]).code(2));
    assert!(error.contains("another run is writing to") && error.contains("--out"), "{error}");
    let note = stderr(&forwardstep(&folder, &["report", "live", "--out", "looked-at"]).success());
    assert!(note.contains("still going on"), "{note}");
    assert!(run.try_wait().unwrap().is_none(), "the run outlived both looks");
    run.kill().unwrap();
    run.wait().unwrap();
}

#[test]
fn a_run_whose_files_may_not_grow_keeps_what_it_could() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    fs::write(path("mine/longer.toml"), LONG.replace("end_s = 20", "end_s = 200")).unwrap();
    // A megabyte, in blocks of 512 bytes: some seconds of rows, and less than all of them.
    let limited = Process::new("sh")
        .current_dir(&folder)
        .args(["-c", "ulimit -f 2000; exec \"$0\" run mine/longer.toml --out limited"])
        .arg(assert_cmd::cargo::cargo_bin("forwardstep"))
        .output()
        .unwrap();
    let said = String::from_utf8(limited.stderr).unwrap();
    assert_eq!(limited.status.code(), Some(2), "{said}");
    assert!(said.contains("rows.journal") && said.contains("its rows could no longer be kept"), "{said}");
    assert!(said.contains("File too large"), "{said}");
    let written = path("limited").join("summary.json").exists();
    let note = stderr(&forwardstep(&folder, &["report", "limited", "--out", "elsewhere"]).success());
    assert_eq!(note.contains("Was cut off at t = "), !written, "{note}");
    forwardstep(&folder, &["run", "mine/long.toml", "--out", "whole"]).success();
    let (mut kept, whole) = (recording(&path("elsewhere")), recording(&path("whole")));
    let rows = kept.t_s.len();
    assert!(rows > 100, "{rows}");
    // The last row of the shorter run lies just before its end.
    let common = rows.min(whole.t_s.len() - 1);
    kept.t_s.truncate(common);
    kept.columns.iter_mut().for_each(|column| column.values.truncate(common));
    assert_eq!(first_rows(&kept, &whole), common);
}

/// Follows the run in `out`.
fn follow(folder: &TempDir, out: &str, more: &[&str]) -> Child {
    Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(folder)
        .args(["report", out, "--follow"])
        .args(more)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Until when a page says that it shows a run that goes on; nothing of another page.
fn shown_until(page: &Path) -> Option<f64> {
    let page = fs::read_to_string(page).ok()?;
    assert!(page.ends_with("</html>"), "a page is there whole or not at all");
    assert_eq!(page.contains("running: "), page.contains("location.reload"));
    let (_, rest) = page.split_once("running: ")?;
    rest.split_once(" s of ")?.0.parse().ok()
}

/// The different times that a page shows, one after the other, until they are `many`.
fn times_shown(page: &Path, many: usize) -> Vec<f64> {
    let (started, mut times) = (Instant::now(), Vec::new());
    while times.len() < many {
        times.extend(shown_until(page).filter(|t_s| times.last() != Some(t_s)));
        assert!(started.elapsed() < Duration::from_secs(120), "{times:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
    times
}

#[test]
fn the_page_of_a_run_grows_until_it_has_ended() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    fs::write(path("mine/long.toml"), LONG.replace("end_s = 20", "end_s = 2000")).unwrap();
    for (out, shown_in, more) in some([("there", "elsewhere", &["--out", "elsewhere"][..]), ("here", "here", &[])], 2) {
        let mut run = start(&folder, out);
        // Nothing is there to be shown yet, and whoever follows waits for it.
        while !path(out).exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        let follower = follow(&folder, out, more);
        let times = times_shown(&path(shown_in).join("report.html"), 3);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
        assert!(!path(out).join("summary.json").exists() && !path(shown_in).join("summary.json").exists());
        run.kill().unwrap();
        run.wait().unwrap();
        let ended = follower.wait_with_output().unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert!(ended.status.success() && said.contains("Was cut off at t = "), "{said}");
        let page = fs::read_to_string(path(shown_in).join("report.html")).unwrap();
        assert!(page.contains("Cut off") && !page.contains("running: "), "{shown_in}");
        assert!(!names(&path(shown_in)).iter().any(|name| name.contains("partial")), "{shown_in}");
        assert!(recording(&path(shown_in)).t_s.last() >= times.last());
        // What was followed from elsewhere stays as it was.
        assert_eq!(path(out).join("rows.journal").exists(), out != shown_in);
    }
}

/// A run makes its folder before it claims it: whoever follows it at that moment was told that there is no run.
#[test]
fn regress_who_follows_a_folder_that_was_just_made_waits_for_its_run() {
    let folder = scenario();
    let path = folder.path().join("soon");
    fs::write(folder.path().join("mine/long.toml"), LONG.replace("end_s = 20", "end_s = 2")).unwrap();
    fs::create_dir(&path).unwrap();
    let follower = follow(&folder, "soon", &[]);
    std::thread::sleep(Duration::from_millis(500));
    assert!(start(&folder, "soon").wait().unwrap().success());
    let ended = follower.wait_with_output().unwrap();
    assert!(ended.status.success(), "{ended:?}");
}

#[test]
fn who_follows_a_run_to_its_end_has_the_page_that_it_wrote() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    let mut run = start(&folder, "whole");
    assert!(has_journal(&mut run, &path("whole")));
    let ended = follow(&folder, "whole", &[]).wait_with_output().unwrap();
    assert!(run.wait().unwrap().success());
    assert!(ended.status.success(), "{ended:?}");
    let page = fs::read(path("whole/report.html")).unwrap();
    assert!(String::from_utf8_lossy(&page).contains("Reached the horizon of 20 s."));
    // So does who follows one that is over.
    fs::remove_file(path("whole/report.html")).unwrap();
    forwardstep(&folder, &["report", "whole", "--follow"]).success();
    assert_eq!(fs::read(path("whole/report.html")).unwrap(), page);
    let error = stderr(&forwardstep(&folder, &["report", "nowhere", "--follow"]).code(2));
    assert!(error.contains("nowhere"), "{error}");
}

/// A run that follows itself.
fn start_followed(folder: &TempDir, out: &str) -> Child {
    Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(folder)
        .args(["run", "mine/long.toml", "--csv", "--follow", "--out", out])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

#[test]
fn a_run_that_follows_itself_writes_the_same() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    fs::write(path("mine/long.toml"), LONG.replace("end_s = 20", "end_s = 2000")).unwrap();
    let mut run = start_followed(&folder, "killed");
    let page = path("killed/report.html");
    let times = times_shown(&page, 2);
    run.kill().unwrap();
    let said = String::from_utf8(run.wait_with_output().unwrap().stderr).unwrap();
    assert!(said.contains("grows while the run goes on") && said.contains("killed/report.html"), "{said}");
    // What it wrote last stays, and `report` finishes it, also where it was killed while it wrote another.
    assert!(shown_until(&page) >= times.last().copied());
    fs::write(path("killed/.report.html.partial"), "half of a page").unwrap();
    forwardstep(&folder, &["report", "killed"]).success();
    assert!(fs::read_to_string(&page).unwrap().contains("Cut off") && shown_until(&page).is_none());
    assert!(!names(&path("killed")).iter().any(|name| name.contains("partial")));

    fs::write(path("mine/long.toml"), LONG.replace("step_s = 2e-5", "step_s = 5e-6")).unwrap();
    let mut run = start_followed(&folder, "followed");
    assert!(has_journal(&mut run, &path("followed")));
    assert!(!times_shown(&path("followed/report.html"), 1).is_empty());
    assert!(run.wait().unwrap().success());
    forwardstep(&folder, &["run", "mine/long.toml", "--csv", "--out", "alone"]).success();
    assert_eq!(names(&path("followed")), names(&path("alone")));
    for file in ["trajectory.parquet", "trajectory.csv", "report.html", "plots/positions.svg"] {
        assert!(
            fs::read(path("followed").join(file)).unwrap() == fs::read(path("alone").join(file)).unwrap(),
            "{file}"
        );
    }
}

#[test]
fn who_follows_a_folder_that_vanishes_is_told_and_the_run_writes_it_again() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    fs::write(path("mine/long.toml"), LONG.replace("end_s = 20", "end_s = 2000")).unwrap();
    let mut run = start_followed(&folder, "gone");
    let _ = times_shown(&path("gone/report.html"), 1);
    let follower = follow(&folder, "gone", &[]);
    std::thread::sleep(Duration::from_millis(300));
    fs::remove_dir_all(path("gone")).unwrap();
    let ended = follower.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert!(ended.status.code() == Some(2) && said.contains("there is no folder `gone`"), "{said}");
    assert!(run.try_wait().unwrap().is_none(), "the run goes on");
    // The run still has its rows, and is asked to end.
    let interrupt = Process::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap();
    assert!(interrupt.success());
    assert_eq!(run.wait().unwrap().code(), Some(130));
    assert!(recording(&path("gone")).t_s.len() > 10);
    assert!(fs::read_to_string(path("gone/report.html")).unwrap().contains("Interrupted"));
}

#[test]
fn a_page_that_cannot_be_written_ends_no_run() {
    let folder = scenario();
    fs::write(folder.path().join("mine/long.toml"), LONG.replace("step_s = 2e-5", "step_s = 5e-6")).unwrap();
    // Half a megabyte, less than a page: the rows of some seconds fit.
    let limited = Process::new("sh")
        .current_dir(&folder)
        .args(["-c", "ulimit -f 1000; exec \"$0\" run mine/long.toml --follow --out limited"])
        .arg(assert_cmd::cargo::cargo_bin("forwardstep"))
        .output()
        .unwrap();
    let said = String::from_utf8(limited.stderr).unwrap();
    assert!(said.contains("The page did not grow any more") && said.contains("limited/report.html"), "{said}");
    assert!(!folder.path().join("limited/.report.html.partial").exists());
    forwardstep(&folder, &["report", "limited", "--out", "elsewhere"]).success();
    assert!(recording(&folder.path().join("elsewhere")).t_s.len() > 100);
}

#[test]
fn regress_a_run_whose_folder_was_renamed_says_where_its_rows_are() {
    let folder = scenario();
    let path = |out: &str| folder.path().join(out);
    let mut run = Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(&folder)
        .args(["run", "mine/long.toml", "--out", "runs"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    assert!(has_journal(&mut run, &path("runs")));
    fs::rename(path("runs"), path("away")).unwrap();
    let mut next = start(&folder, "runs");
    assert!(has_journal(&mut next, &path("runs")));
    next.kill().unwrap();
    next.wait().unwrap();
    let journal = fs::read(path("runs/rows.journal")).unwrap();
    let ended = run.wait_with_output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{said}");
    assert!(said.contains("another folder by now") && !said.contains("runs/rows.journal"), "{said}");
    assert!(fs::read(path("runs/rows.journal")).unwrap() == journal && names(&path("runs")) == ["rows.journal"]);
    forwardstep(&folder, &["report", "away"]).success();
    assert!(recording(&path("away")).t_s.len() == 2001, "all rows are there");
}
