//! `forwardstep report`: the report of a run, built anew from its folder.

mod refusals;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::{folder, forwardstep, stderr};
use tempfile::TempDir;

/// Two arms that estimate; a `[goal]` or `[solver]` may follow.
const ARMS: &str = r#"
format = 2
title = "Two arms"
time = { end_s = 3, record_every_s = 0.1 }
[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[network]
delay.saw_tooth = { min_s = 0.1, max_s = 0.2, period_s = 0.7 }
edges = [["arm-1", "arm-2"], ["arm-2", "arm-1"]]
"#;

/// Three pendulums from files beside the scenario, below it, and elsewhere.
const FILES: &str = r#"
format = 2
title = "Three pendulums"
time = { end_s = 2, record_every_s = 0.1 }
[[agents]]
name = "here"
count = 2
robot.urdf.file = "pendulum.urdf"
start.position_rad = [[0.1], [0.5]]
[[agents]]
name = "there"
robot.urdf.file = "../elsewhere.urdf"
start.position_rad = [0.9]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[law.known]
[network]
delay.constant_s = 0.1
edges.csv.file = "./tables/edges.csv"
"#;

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.01"/>
    </inertial>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="5"/>
  </joint>
</robot>
"#;

/// Every file below a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn collect(folder: &Path, prefix: &str, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
            if path.is_dir() {
                collect(&path, &format!("{name}/"), found);
            } else {
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(folder, "", &mut found);
    found
}

/// The names of files that differ, or that only one of two folders has.
fn differences(one: &BTreeMap<String, Vec<u8>>, other: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let names = one.keys().chain(other.keys().filter(|name| !one.contains_key(*name)));
    names.filter(|name| one.get(*name) != other.get(*name)).cloned().collect()
}

fn remove_pictures(run: &Path) {
    fs::remove_file(run.join("report.html")).unwrap();
    fs::remove_dir_all(run.join("plots")).unwrap();
}

/// Takes the pictures out of a folder and has them built again: the folder must be what it was, byte for byte.
fn is_rebuilt(folder: &TempDir, run: &str) {
    let path = folder.path().join(run);
    let before = contents(&path);
    assert!(before.contains_key("report.html") && before.contains_key("plots/torques.svg"));
    remove_pictures(&path);
    let again = forwardstep(folder, &["report", run]).success();
    assert_eq!(stderr(&again), "", "nothing changed, so nothing is remarked");
    let files = String::from_utf8(again.get_output().stdout.clone()).unwrap();
    assert_eq!(files.lines().count(), 5, "{files}");
    assert!(files.contains("report.html"), "{files}");
    assert_eq!(differences(&before, &contents(&path)), [""; 0]);
}

#[test]
fn shipped_scenarios_are_rebuilt_byte_for_byte() {
    let folder = folder();
    for scenario in ["six-arms", "first-order", "theorem-2", "ten-different-robots", "backstepping"] {
        forwardstep(&folder, &["run", scenario]).success();
        is_rebuilt(&folder, &format!("forwardstep-runs/{scenario}"));
    }
}

/// The page had a leader and thrusts, and the files for print had neither.
#[test]
fn regress_figures_for_print_have_the_leader_and_the_thrust() {
    let folder = folder();
    let figure = |scenario: &str, name: &str| {
        forwardstep(&folder, &["run", scenario, "--out", scenario, "--force"]);
        fs::read_to_string(folder.path().join(scenario).join("plots").join(name)).unwrap()
    };
    let led = figure("theorem-8", "positions.svg");
    assert!(led.contains("leader, dashed") && led.matches("polyline").count() > 40, "dashes are lines of their own");
    let flown = figure("theorem-4", "torques.svg");
    assert!(flown.contains("thrust") && flown.contains("in N") && !flown.contains("Nothing was recorded"));
    assert!(!figure("theorem-1", "torques.svg").contains("thrust"));
}

#[test]
fn what_was_predicted_stands_beside_what_was_observed() {
    let folder = folder();
    let run = |scenario: &str| {
        let text = String::from_utf8(forwardstep(&folder, &["run", scenario]).success().get_output().stdout.clone());
        let path = folder.path().join("forwardstep-runs").join(scenario);
        let summary: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(path.join("summary.json")).unwrap()).unwrap();
        (text.unwrap(), summary, fs::read_to_string(path.join("report.html")).unwrap())
    };
    // ϑ is known, and z(0) = q̇(0).
    let (text, summary, page) = run("first-order");
    let (course, metrics) = (&summary["prediction"]["course"]["found"], &summary["metrics"]);
    let settled = [&course["settled_s"], &metrics["settled_to_1_percent_s"]].map(|t_s| t_s.as_f64().unwrap());
    assert!((settled[0] / settled[1] - 1.0).abs() < 0.01, "{settled:?}");
    assert!(text.contains(&format!("{:.2} s, predicted {:.2} s", settled[1], settled[0])), "{text}");
    for peak in course["peak_torques"].as_array().unwrap() {
        let same = |other: &&serde_json::Value| (&other["agent"], &other["axis"]) == (&peak["agent"], &peak["axis"]);
        let observed = metrics["peak_torques"].as_array().unwrap().iter().find(same).unwrap();
        let ratio = peak["value"].as_f64().unwrap() / observed["value"].as_f64().unwrap();
        assert!((ratio - 1.0).abs() < 1e-4, "{peak} {observed}");
    }
    assert!(metrics["final_tracking_error"].as_f64().unwrap() < 1e-6);
    assert!(page.contains("<section id=\"predicted\">") && page.contains("\"predicted\":"), "a section and a series");
    assert!(page.contains("rightmost characteristic root") && page.contains("Value, shoulder"));
    let within = &course["within"][0];
    let mean = metrics["final_means"][0].as_f64().unwrap();
    // Both are computed to a tolerance.
    let [low, high] = [0, 1].map(|end| within[end].as_f64().unwrap());
    assert!(low - 1e-8 < mean && mean < high + 1e-8, "{within} {mean}");
    // Estimates start far away, and the graph switches.
    let (_, summary, page) = run("six-arms");
    assert!(summary["metrics"]["final_tracking_error"].as_f64().unwrap() > 1e-3);
    assert!(page.contains("At the end s is still ") && page.contains("it also moved the value agreed upon"));
    assert!(page.contains("estimates have not settled. The theorem gives s → 0 without a rate"));
    let rate = &summary["prediction"]["rate"]["period"];
    assert!(rate["factor"].as_f64().unwrap() < 1.0 && page.contains(" s the disagreement shrinks to "), "{rate}");
    // Nothing is agreed upon.
    let (text, summary, page) = run("theorem-8");
    assert_eq!(summary["prediction"], serde_json::Value::Null);
    assert!(!page.contains("<section id=\"predicted\">") && !text.contains("Predicted"));
}

#[test]
fn broken_runs_are_rebuilt_byte_for_byte() {
    let folder = folder();
    let step = "[solver]\nmin_step_s = 5e-3\nmethod.adaptive = { rtol = 1e-13, atol = 1e-13 }";
    fs::write(folder.path().join("step.toml"), format!("{ARMS}{step}")).unwrap();
    forwardstep(&folder, &["run", "step.toml"]).code(3);
    is_rebuilt(&folder, "forwardstep-runs/step");

    let limit = FILES.replace("\"there\"\n", "\"there\"\nenforce_limits = true\nstart.velocity_rad_s = [30]\n");
    fs::create_dir_all(folder.path().join("a/tables")).unwrap();
    fs::write(folder.path().join("a/limit.toml"), limit).unwrap();
    fs::write(folder.path().join("a/pendulum.urdf"), PENDULUM).unwrap();
    fs::write(folder.path().join("elsewhere.urdf"), PENDULUM).unwrap();
    fs::write(folder.path().join("a/tables/edges.csv"), "from,to\nhere-1,there\nthere,here-2\nhere-2,here-1\n")
        .unwrap();
    let broken = stderr(&forwardstep(&folder, &["run", "a/limit.toml"]).code(3));
    assert!(broken.contains("there.q.hinge left its limits"), "{broken}");
    is_rebuilt(&folder, "forwardstep-runs/limit");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_is_rebuilt_byte_for_byte_when_it_has_ended() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command as Process, Stdio};

    let folder = folder();
    // Years of simulated time, so that it cannot end by itself.
    let long = ARMS
        .replace("end_s = 3, record_every_s = 0.1", "end_s = 1e8, record_every_s = 100")
        .replace("saw_tooth = { min_s = 0.1, max_s = 0.2, period_s = 0.7 }", "constant_s = 0.1");
    fs::write(folder.path().join("long.toml"), long).unwrap();
    let mut run = Process::new(assert_cmd::cargo::cargo_bin("forwardstep"))
        .current_dir(&folder)
        .args(["run", "long.toml", "--out", "long"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(run.stdout.take().unwrap()).lines();
    // The verdicts are printed when the folder is taken and the handler is in place.
    assert_eq!(lines.next().unwrap().unwrap(), "Two arms");
    let error = stderr(&forwardstep(&folder, &["report", "long"]).code(2));
    let nothing = error.contains("there is no summary.json in it") && error.contains("has no rows yet");
    assert!(nothing || error.contains("another run is writing to long"), "{error}");
    std::thread::sleep(std::time::Duration::from_millis(300));
    Process::new("kill").args(["-INT", &run.id().to_string()]).status().unwrap();
    lines.for_each(drop);
    assert_eq!(run.wait().unwrap().code(), Some(130));
    is_rebuilt(&folder, "long");
}

/// With `--follow` it offered an option that it has not.
#[test]
fn regress_who_follows_a_run_into_a_folder_that_is_taken_is_told_the_same_as_without() {
    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    for out in ["run", "taken"] {
        forwardstep(&folder, &["run", "arms.toml", "--out", out]).success();
    }
    let told =
        |more: &[&str]| stderr(&forwardstep(&folder, &[&["report", "run", "--out", "taken"], more].concat()).code(2));
    let plain = told(&[]);
    assert!(plain.contains("is not empty") && !plain.contains("--force"), "{plain}");
    assert_eq!(told(&["--follow"]), plain);
}

#[test]
fn csv_serves_where_there_is_no_parquet() {
    let folder = folder();
    fs::write(folder.path().join("arms.toml"), ARMS).unwrap();
    forwardstep(&folder, &["run", "arms.toml", "--csv", "--out", "run"]).success();
    let run = folder.path().join("run");
    fs::remove_file(run.join("trajectory.parquet")).unwrap();
    is_rebuilt(&folder, "run");
    // One that was saved by another program may differ in its text.
    let table = fs::read_to_string(run.join("trajectory.csv")).unwrap();
    fs::write(run.join("trajectory.csv"), table.replace('\n', "\r\n")).unwrap();
    let report = fs::read_to_string(run.join("report.html")).unwrap();
    let note = stderr(&forwardstep(&folder, &["report", "run"]).success());
    assert!(note.starts_with("note: trajectory.csv is not as the run wrote it"), "{note}");
    let data = |page: &str| page.split_once("<script id=\"block\"").unwrap().1.to_owned();
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    assert!(page.contains("trajectory.csv is not as the run wrote it"));
    assert!(data(&page) == data(&report), "the same numbers are drawn");
}

#[test]
fn a_folder_holds_all_that_went_into_its_run() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir_all(path.join("mine/tables")).unwrap();
    fs::write(path.join("mine/network.toml"), FILES).unwrap();
    fs::write(path.join("mine/pendulum.urdf"), PENDULUM).unwrap();
    fs::write(path.join("elsewhere.urdf"), PENDULUM.replace("value=\"2\"", "value=\"3\"")).unwrap();
    fs::write(path.join("mine/tables/edges.csv"), "from,to\nhere-1,there\nthere,here-2\nhere-2,here-1\n").unwrap();
    forwardstep(&folder, &["run", "mine/network.toml", "--out", "run"]).success();
    let files = contents(&path.join("run"));
    assert_eq!(files["scenario.toml"], FILES.as_bytes());
    assert_eq!(files["inputs/pendulum.urdf"], PENDULUM.as_bytes());
    for name in ["inputs/tables/edges.csv", "inputs/outside/elsewhere.urdf"] {
        assert!(files.contains_key(name), "{:?}", files.keys());
    }

    // The report needs nothing but the folder, wherever it is.
    fs::remove_dir_all(path.join("mine")).unwrap();
    fs::remove_file(path.join("elsewhere.urdf")).unwrap();
    fs::create_dir(path.join("archive")).unwrap();
    fs::rename(path.join("run"), path.join("archive/run")).unwrap();
    is_rebuilt(&folder, "archive/run");

    // Nor does a run of its scenario, when all names lead downwards.
    let error = stderr(&forwardstep(&folder, &["run", "archive/run/scenario.toml", "--out", "again"]).code(2));
    assert!(error.contains("`../elsewhere.urdf`: there is no such file"), "{error}");
    fs::write(path.join("archive/elsewhere.urdf"), &files["inputs/outside/elsewhere.urdf"]).unwrap();
    forwardstep(&folder, &["run", "archive/run/scenario.toml", "--out", "again"]).success();
    let again = contents(&path.join("again"));
    for name in ["inputs/pendulum.urdf", "inputs/tables/edges.csv", "plots/positions.svg", "plots/torques.svg"] {
        assert!(again[name] == files[name], "{name} differs");
    }

    // What an earlier run left goes, unless somebody changed it.
    let edges = path.join("again/inputs/tables/edges.csv");
    fs::write(&edges, "mine now").unwrap();
    let refused = stderr(&forwardstep(&folder, &["run", "first-order", "--out", "again", "--force"]).code(2));
    assert!(refused.contains("inputs/tables/edges.csv is not as the run in that folder wrote it"), "{refused}");
    fs::rename(&edges, path.join("again/inputs/mine.csv")).unwrap();
    forwardstep(&folder, &["run", "first-order", "--out", "again", "--force"]).success();
    let names: Vec<_> = contents(&path.join("again")).into_keys().filter(|name| name.contains("inputs")).collect();
    assert_eq!(names, ["inputs/mine.csv"]);
}

/// The text of a page before its numbers.
fn words(run: &Path) -> String {
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    page.split_once("<script id=\"index\"").unwrap().0.to_owned()
}

#[test]
fn what_changed_since_the_run_is_said() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("pendulum.urdf"), PENDULUM).unwrap();
    fs::write(
        path.join("network.toml"),
        FILES.replace("../elsewhere", "pendulum").replace(".csv.file = \"./tables/edges.csv\"", ".ring = {}"),
    )
    .unwrap();
    forwardstep(&folder, &["run", "network.toml", "--out", "run"]).success();
    let run = path.join("run");
    let sound = contents(&run);
    let text = |name: &str| String::from_utf8(sound[name].clone()).unwrap();
    let changed = |name: &str, from: &str, to: &str| {
        let old = text(name);
        assert!(old.contains(from), "{from}");
        fs::write(run.join(name), old.replace(from, to)).unwrap();
        let note = stderr(&forwardstep(&folder, &["report", "run"]).success());
        fs::write(run.join(name), old).unwrap();
        assert_eq!(contents(&run)["summary.json"], sound["summary.json"], "the record of the run stays");
        note
    };
    // A title may change, and so may comments.
    assert_eq!(changed("scenario.toml", "title = \"Three pendulums\"", "# Mine\ntitle = \"A better title\""), "");
    assert!(words(&run).contains(">A better title</h1>"));
    let note = changed("scenario.toml", "delay.constant_s = 0.1", "delay.constant_s = 0.2");
    assert!(note.starts_with("note: scenario.toml was changed after the run"), "{note}");
    assert!(note.contains("note: the verdicts were worked out anew"), "no delay exceeds another number: {note}");
    assert!(words(&run).contains("scenario.toml was changed after the run"));
    let note = changed("inputs/pendulum.urdf", "effort=\"50\"", "effort=\"1\"");
    assert!(note.starts_with("note: `pendulum.urdf`, which the scenario names, is not what it was"), "{note}");
    let note = changed("summary.json", "\"version\": \"", "\"version\": \"0.0.");
    assert!(note.starts_with("note: simulated by forwardstep 0.0."), "{note}");
    assert!(words(&run).contains("this page was made by forwardstep"));
    // With everything as it was, so is the report.
    forwardstep(&folder, &["report", "run"]).success();
    assert_eq!(differences(&sound, &contents(&run)), [""; 0]);
}

#[test]
fn a_page_speaks_of_a_reference_velocity_where_there_is_one() {
    let folder = folder();
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/../../checker/cases/model-reference.toml");
    for (scenario, has_one) in [("without-velocity", true), (case, false)] {
        forwardstep(&folder, &["run", scenario, "--out", "run", "--force"]).success();
        let page = fs::read_to_string(folder.path().join("run/report.html")).unwrap();
        assert_eq!(page.contains("q̇, and z dashed"), has_one, "{scenario}");
        assert!(page.contains("data-plot=\"velocity\""), "{scenario}");
    }
}

/// What a radio carries is what it sends, however often controllers sample.
#[test]
fn regress_traffic_is_that_of_the_packets() {
    let folder = folder();
    let sampled = ARMS.replace("[network]", "[control]\nsample_hz = 100\n[network]").replace("end_s = 3", "end_s = 1");
    let saw_tooth = "saw_tooth = { min_s = 0.1, max_s = 0.2, period_s = 0.7 }";
    let radio = "packets = { period_s = 0.05, latency_s = 0.01, seed = 1 }";
    let slower = radio.replace("0.05", "0.1");
    let of_link = format!("[{{ from = \"arm-1\", to = \"arm-2\", delay.{slower} }}, ");
    for (text, told) in [
        (ARMS.to_owned(), "32 bytes per message; in continuous time there is no rate"),
        (sampled.clone(), "3200 bytes/s: 32 bytes at every sample"),
        (sampled.replace(saw_tooth, radio), "640 bytes/s: 32 bytes every 0.05 s"),
        (ARMS.replace(saw_tooth, radio), "640 bytes/s: 32 bytes every 0.05 s"),
        (
            sampled.replace(saw_tooth, radio).replace("[[\"arm-1\", \"arm-2\"], ", &of_link),
            "32 bytes per message; how often one is sent differs from link to link",
        ),
    ] {
        fs::write(folder.path().join("two.toml"), &text).unwrap();
        forwardstep(&folder, &["run", "two.toml", "--out", "run", "--force"]).success();
        let page = fs::read_to_string(folder.path().join("run/report.html")).unwrap();
        assert!(page.contains(told), "{told}: {text}");
    }
}
