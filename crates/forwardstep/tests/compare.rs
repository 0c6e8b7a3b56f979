//! `forwardstep compare`: runs side by side.

use std::fs;
use std::path::Path;

use crate::support::{folder, forwardstep, names, stderr, stdout};
use serde_json::Value;
use tempfile::TempDir;

/// Two point masses that agree over a link that switches.
const POINTS: &str = r#"
format = 2
title = "Two points"
time = { end_s = 4, record_every_s = 0.05 }
[[agents]]
name = "point"
count = 2
robot.point_mass = { mass_kg = 1.0, dimension = 1 }
start.position_m = [[-1.0], [1.0]]
[reference.consensus]
roots_per_s = [2.0, 3.0]
exchange = "position_velocity"
[law.known]
[network]
delay.constant_s = 0.1
[[network.phases]]
dwell_s = 0.5
edges = [["point-1", "point-2"], ["point-2", "point-1"]]
[[network.phases]]
dwell_s = 0.25
edges = [["point-2", "point-1"]]
[goal]
disagreement_below = 0.1
"#;

/// A joint that starts near its limit, and runs into it.
const INTO_A_LIMIT: &str = r#"
format = 2
title = "An arm that leaves its limits"
time = { end_s = 3, record_every_s = 0.1 }
[[agents]]
name = "here"
robot.urdf.file = "pendulum.urdf"
enforce_limits = true
start.position_rad = [0.9]
[[agents]]
name = "there"
robot.urdf.file = "pendulum.urdf"
start.position_rad = [1.9]
[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"
[law.known]
[network]
edges = [["there", "here"]]
"#;

const PENDULUM: &str = r#"<robot name="pendulum">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.01"/>
    </inertial>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="50" velocity="5"/>
  </joint>
</robot>
"#;

fn write(here: &TempDir, name: &str, text: &str) {
    fs::write(here.path().join(name), text).unwrap();
}

/// What `compare --json` prints, which is what it writes.
fn document(here: &TempDir, arguments: &[&str], out: &str) -> Value {
    let arguments = [&["compare", "--json", "--out", out], arguments].concat();
    let printed: Value = serde_json::from_str(&stdout(&forwardstep(here, &arguments))).unwrap();
    let written = fs::read_to_string(here.path().join(out).join("compare.json")).unwrap();
    assert_eq!(printed, serde_json::from_str::<Value>(&written).unwrap());
    printed
}

fn row<'a>(document: &'a Value, key: &str) -> &'a Value {
    let rows = document["rows"].as_array().unwrap();
    rows.iter().find(|row| row["key"] == key).unwrap_or_else(|| panic!("no row {key}"))
}

fn words(document: &Value, key: &str) -> Vec<String> {
    let cells = row(document, key)["cells"].as_array().unwrap();
    cells.iter().map(|cell| cell["words"].as_str().unwrap().to_owned()).collect()
}

fn numbers(document: &Value, key: &str) -> Vec<f64> {
    let cells = row(document, key)["cells"].as_array().unwrap();
    cells.iter().map(|cell| cell["value"].as_f64().unwrap()).collect()
}

fn summary(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn scenarios_are_run_and_laid_side_by_side() {
    let here = folder();
    write(&here, "points.toml", POINTS);
    write(&here, "slow.toml", &POINTS.replace("[2.0, 3.0]", "[1.0]").replace("Two points", "Two slow points"));
    let found = document(&here, &["points.toml", "slow.toml"], "both");
    assert_eq!(names(&here.path().join("both")), ["compare.html", "compare.json", "points", "slow"]);
    assert_eq!(names(here.path()), ["both", "points.toml", "slow.toml"]);
    assert_eq!((&found["runs"][0]["name"], &found["runs"][1]["title"]), (&"points".into(), &"Two slow points".into()));
    // What is the same is marked, and what is not.
    for (key, same) in
        [("robots", true), ("law", true), ("network", true), ("start", true), ("order", false), ("final_gap", false)]
    {
        assert_eq!(row(&found, key)["same"], same, "{key}");
    }
    assert_eq!(words(&found, "robots")[0], "2 × point_mass");
    assert_eq!(numbers(&found, "order"), [2.0, 1.0]);
    // The numbers are those of the runs.
    for (k, name) in ["points", "slow"].into_iter().enumerate() {
        let run = summary(&here.path().join("both").join(name));
        assert_eq!(run["metrics"]["disagreement"]["measured"]["last"].as_f64(), Some(numbers(&found, "final_gap")[k]));
        let peak = |all: &Value| {
            all.as_array().unwrap().iter().map(|peak| peak["value"].as_f64().unwrap().abs()).fold(0.0, f64::max)
        };
        assert_eq!(peak(&run["metrics"]["peak_torques"]), numbers(&found, "peak_torque")[k]);
    }
    // The order is that of the first derivative that jumps, plus one.
    let jump = words(&found, "first_jump");
    assert!(jump[0].starts_with("dτ/dt, by ") && jump[1].starts_with("τ, by "), "{jump:?}");
    assert_eq!(numbers(&found, "input_jump")[0], 0.0);
    assert!(numbers(&found, "input_jump")[1] > 0.01);

    // In words, at 80 columns, with what is the same said once; the folder is refused a second time, and taken with --force.
    let again = forwardstep(&here, &["compare", "points.toml", "slow.toml", "--out", "both"]).failure().code(2);
    assert!(stderr(&again).contains("not empty") && stderr(&again).contains("--force"), "{}", stderr(&again));
    let said = stdout(
        &forwardstep(&here, &["compare", "points.toml", "slow.toml", "both/slow", "both/points", "--out", "four"])
            .success(),
    );
    assert!(said.lines().all(|line| line.chars().count() <= 80), "{said}");
    assert_eq!(said.matches("2 × point_mass").count(), 1, "{said}");
    forwardstep(&here, &["compare", "--force", "points.toml", "slow.toml", "--out", "both"]).success();
}

#[test]
fn a_folder_of_a_run_beside_a_scenario_is_read_and_left_as_it_is() {
    let here = folder();
    write(&here, "points.toml", POINTS);
    forwardstep(&here, &["run", "points.toml", "--out", "early"]).success();
    let page = fs::metadata(here.path().join("early/report.html")).unwrap().modified().unwrap();
    let found = document(&here, &["early", "points.toml", "early"], "both");
    assert_eq!(fs::metadata(here.path().join("early/report.html")).unwrap().modified().unwrap(), page);
    assert_eq!(names(&here.path().join("both")), ["compare.html", "compare.json", "points"]);
    let called: Vec<_> = found["runs"].as_array().unwrap().iter().map(|run| run["name"].as_str().unwrap()).collect();
    assert_eq!(called, ["early", "points", "early-2"]);
    assert!(found["rows"].as_array().unwrap().iter().all(|row| row["same"] == true), "{found}");
    let said = stdout(&forwardstep(&here, &["compare", "early", "early", "--out", "same"]).success());
    assert!(said.contains("The runs are the same in all that is compared") && !said.contains("Different"), "{said}");
    assert_eq!(names(&here.path().join("same")), ["compare.html", "compare.json"]);
}

#[test]
fn a_run_that_breaks_down_is_compared_and_told_by_the_status() {
    let here = folder();
    write(&here, "points.toml", POINTS);
    write(&here, "limit.toml", INTO_A_LIMIT);
    write(&here, "pendulum.urdf", PENDULUM);
    let assert = forwardstep(&here, &["compare", "points.toml", "limit.toml", "--out", "both"]).failure().code(3);
    let said = stdout(&assert);
    assert!(said.contains("completed") && said.contains("broke down at"), "{said}");
    // Other kinds, with other units, which are said.
    let found: Value =
        serde_json::from_str(&fs::read_to_string(here.path().join("both/compare.json")).unwrap()).unwrap();
    assert_eq!(row(&found, "peak_torque")["note"], "units differ: N, N m");
    assert_eq!(row(&found, "robots")["same"], false);
    // A reason stands where there is nothing to compare.
    assert_eq!(words(&found, "value")[1], "—");
    assert!(row(&found, "value")["cells"][1]["because"].is_string());
    assert!(row(&found, "input_jump")["cells"][1]["because"].is_string());
}

#[test]
fn mistakes_are_told_before_anything_is_run_and_nothing_is_left() {
    let here = folder();
    write(&here, "points.toml", POINTS);
    forwardstep(&here, &["run", "points.toml", "--out", "run"]).success();
    fs::create_dir(here.path().join("empty")).unwrap();
    fs::create_dir(here.path().join("forged")).unwrap();
    fs::copy(here.path().join("run/scenario.toml"), here.path().join("forged/scenario.toml")).unwrap();
    write(&here, "forged/summary.json", "{\"format\": 2, \"rows\": \"<script>\"}");
    write(&here, "wrong.toml", &POINTS.replace("2.0, 3.0", "2.0, -3.0"));
    // A run in a folder that is called like a shipped scenario.
    fs::create_dir(here.path().join("first-order")).unwrap();
    fs::copy(here.path().join("run/summary.json"), here.path().join("first-order/summary.json")).unwrap();
    let before = names(here.path());
    for (arguments, told) in [
        (&["points.toml", "nothing-like-it"][..], "nothing-like-it"),
        (&["points.toml", "no/such/file.toml"], "no/such/file.toml"),
        (&["first-order", "nothing-like-it"], "the run in the folder of that name is `./first-order`"),
        (&["points.toml", "empty"], "holds no whole run"),
        (&["points.toml", "forged"], "summary.json"),
        (&["points.toml", "wrong.toml"], "roots_per_s"),
        (&["points.toml"], "2 values"),
        (&[], "required"),
    ] {
        let assert = forwardstep(&here, &[&["compare"], arguments].concat()).failure().code(2);
        assert!(stderr(&assert).contains(told), "{arguments:?}: {}", stderr(&assert));
        assert_eq!(names(here.path()), before, "{arguments:?}");
    }
    // A folder that no comparison wrote is never replaced.
    let assert = forwardstep(&here, &["compare", "--force", "run", "run", "--out", "run"]).failure().code(2);
    assert!(stderr(&assert).contains("not written by `compare`"), "{}", stderr(&assert));
    assert!(!here.path().join("run/compare.json").exists());
    // One that was interrupted left its runs.
    for (kept, status) in [(false, 0), (true, 2)] {
        let cut = here.path().join("cut");
        fs::create_dir_all(cut.join("later")).unwrap();
        fs::rename(here.path().join("run"), cut.join("points")).unwrap();
        if kept {
            fs::write(cut.join("notes.txt"), "mine").unwrap();
        }
        let arguments = ["compare", "--force", "cut/points", "cut/points", "--out", "cut"];
        forwardstep(&here, &arguments).code(status);
        fs::rename(cut.join("points"), here.path().join("run")).unwrap();
        fs::remove_dir_all(cut).unwrap();
    }
}

#[test]
fn the_document_keeps_to_its_schema() {
    let here = folder();
    let schema: Value = serde_json::from_str(&stdout(&forwardstep(&here, &["schema", "compare"]).success())).unwrap();
    assert_eq!(schema["title"], "forwardstep compare");
    write(&here, "points.toml", POINTS);
    let found = document(&here, &["points.toml", "points.toml"], "both");
    for (value, own) in [
        (&found, &schema),
        (&found["rows"][0], &schema["$defs"]["ComparedRow"]),
        (&found["runs"][0], &schema["$defs"]["ComparedRun"]),
    ] {
        for key in value.as_object().unwrap().keys() {
            assert!(own["properties"][key]["description"].is_string(), "{key}");
        }
        for key in own["required"].as_array().unwrap() {
            assert!(value.get(key.as_str().unwrap()).is_some(), "{key}");
        }
    }
}

/// A design behind a leader has no roots of its own to count, and who is alone tells nobody anything.
#[test]
fn regress_what_a_row_says_nothing_of_has_its_own_reason() {
    let here = folder();
    let alone = "format = 2\ntitle = \"m\"\ntime.end_s = 2\n[[agents]]\nname = \"m\"\nrobot.point_mass = { dimension = 1, mass_kg = 3 }\n\
                 start.position_m = [1]\ntarget.formulas = [\"sin(t)\"]\n[reference.tracking]\nroots_per_s = [1, 2]\n[law.adaptive]\n";
    write(&here, "alone.toml", alone);
    let found = document(&here, &["alone.toml", "swarm-tracking", "leader-over-turns", "pilot-ship"], "beside");
    let because = |key: &str, run: usize| row(&found, key)["cells"][run]["because"].as_str().map(str::to_owned);
    assert_eq!(because("told", 0).as_deref(), Some("no agent hears another"));
    assert_eq!(because("told", 1), None);
    assert_eq!(because("order", 0), None);
    assert_eq!(because("order", 2).as_deref(), Some("it is that of the design behind a leader"), "{found}");
    // The pilot has two roots, and those that follow it none.
    assert_eq!(row(&found, "order")["cells"][3]["words"], "2");
}

#[test]
fn ships_under_every_order_are_the_same_but_for_what_leads_them() {
    let here = folder();
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src/ships");
    let all = ["backstepping", "order-1", "order-2", "order-3", "order-4"];
    let files: Vec<String> = all.iter().map(|name| book.join(format!("{name}.toml")).display().to_string()).collect();
    let found = document(&here, &files.iter().map(String::as_str).collect::<Vec<_>>(), "ships");
    for key in ["robots", "law", "network", "start", "control", "horizon_s", "ended", "goal"] {
        assert_eq!(row(&found, key)["same"], true, "{key}");
    }
    // And they are those of the shipped scenario.
    let beside = [files[2].as_str(), "five-ships"];
    let shipped = document(&here, &[&["--no-jumps"], &beside[..]].concat(), "beside");
    for key in ["robots", "law", "network", "start", "control", "horizon_s"] {
        assert_eq!(row(&shipped, key)["same"], true, "{key}");
    }
    assert!(row(&shipped, "input_jump")["cells"][0]["because"].as_str().unwrap().contains("--no-jumps"));
    // Backstepping jumps far, order 1 by what is heard, and from order 2 on the torque is continuous.
    let jumps = numbers(&found, "input_jump");
    assert!(jumps[0] > 100.0 * jumps[1] && jumps[1] > 1.0 && jumps[2..].iter().all(|jump| *jump == 0.0), "{jumps:?}");
    let first = words(&found, "first_jump");
    for (said, begins) in first.iter().zip(["τ, by", "τ, by", "dτ/dt, by", "d²τ/dt², by", "d³τ/dt³, by"]) {
        assert!(said.starts_with(begins), "{first:?}");
    }
    let peaks = numbers(&found, "peak_torque");
    assert!(peaks.windows(2).all(|pair| pair[0] > pair[1]), "{peaks:?}");
}

#[test]
fn networks_with_other_numbers_are_not_the_same() {
    let here = folder();
    write(&here, "points.toml", POINTS);
    write(
        &here,
        "other.toml",
        &POINTS.replace("dwell_s = 0.25", "dwell_s = 0.3").replace("[1.0]]", "[0.9]]").replace("-1.0]", "-1.1]"),
    );
    let found = document(&here, &["points.toml", "other.toml"], "both");
    for key in ["network", "start"] {
        assert_eq!(row(&found, key)["same"], false, "{key}");
        let said = words(&found, key);
        assert!(!said[0].contains("other") && said[1].ends_with(", with other numbers"), "{said:?}");
    }
    assert_eq!(row(&found, "robots")["same"], true);
}

#[test]
fn what_a_sweep_varies_is_in_the_table() {
    let here = folder();
    let masses = |weight: f64, more: &str| {
        format!(
            "format = 2\ntime.end_s = 1\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ dimension = 1, mass_kg = 2 }}\n\
             start.position_m = [[0], [1]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n[law.known]\ndamping.gain = 5\n\
             [network]\nweight = {weight}\nedges.ring = {{}}\n{more}"
        )
    };
    write(&here, "half.toml", &masses(0.5, ""));
    write(&here, "two.toml", &masses(2.0, "delay.constant_s = 0.1\n"));
    let found = document(&here, &["half.toml", "two.toml"], "both");
    assert_eq!(words(&found, "scenario.network.weight"), ["0.5", "2"]);
    assert_eq!(words(&found, "scenario.network.delay.constant_s"), ["—", "0.1"]);
    let keys = found["rows"].as_array().unwrap().iter().map(|row| row["key"].as_str().unwrap());
    assert_eq!(keys.filter(|key| key.starts_with("scenario.")).count(), 2);
    assert_eq!(row(&found, "scenario.network.weight")["same"], false);
    // What differs behind what is shown differs all the same; kinds without a value are told apart.
    let far = |last: &str| {
        masses(1.0, "")
            .replace("edges.ring", &format!("delay.formula_s = \"0.1 + 0*({}{last})\"\nedges.ring", "t + ".repeat(30)))
    };
    write(&here, "one.toml", &far("1"));
    write(&here, "other.toml", &far("2").replace("edges.ring", "edges.complete"));
    let long = document(&here, &["one.toml", "other.toml"], "long");
    let formulas = words(&long, "scenario.network.delay.formula_s");
    assert!(formulas[0].ends_with('…') && formulas[0] == formulas[1], "{formulas:?}");
    assert_eq!(row(&long, "scenario.network.delay.formula_s")["same"], false);
    assert_eq!(words(&long, "scenario.network.edges.ring"), ["{}", "—"]);
    // Scenarios that have little in common are no variants.
    let arms = document(&here, &["half.toml", "six-arms"], "other");
    assert!(arms["rows"].as_array().unwrap().iter().all(|row| !row["key"].as_str().unwrap().starts_with("scenario.")));
}

#[test]
fn a_hostile_title_is_text_on_the_page() {
    let here = folder();
    let title = "</script><img src=x onerror=alert(1)> & more";
    write(&here, "hostile.toml", &POINTS.replace("Two points", title));
    forwardstep(&here, &["compare", "hostile.toml", "hostile.toml", "--out", "both"]).success();
    let page = fs::read_to_string(here.path().join("both/compare.html")).unwrap();
    assert!(!page.contains("<img") && page.contains("&lt;img src=x"), "escaped");
    assert!(!page.contains("http://") || page.matches("http://").count() == page.matches("http://www.w3.org").count());
}

#[cfg(unix)]
#[test]
fn regress_names_of_files_stay_in_their_lines() {
    let here = folder();
    let name = "a\nb\u{1b}[31mc\u{202e}";
    write(&here, &format!("{name}.toml"), POINTS);
    write(&here, "points.toml", POINTS);
    let ran = forwardstep(&here, &["compare", &format!("{name}.toml"), "points.toml", "--no-jumps", "--out", "both"]);
    let said = stdout(&ran.success());
    assert!(said.contains("a\\nb\\u{1b}[31mc\\u{202e}:"), "{said}");
    let page = fs::read_to_string(here.path().join("both/compare.html")).unwrap();
    assert!(!page.contains(['\u{1b}', '\u{202e}']));
}

/// What Remark 5 goes beyond: relative positions behind filters, p (p + 1)(p + 2) x = −w (x − x_j). By Routh's array the difference of two decays for
/// w < 3 alone, and by (24) for every weight.
#[test]
fn own_positions_behind_a_filter_agree_up_to_the_weight_of_routh_and_by_eq_24_beyond_it() {
    let here = folder();
    let left = |coupling: &str, weight: f64| {
        let text = format!(
            "format = 2\ntime.end_s = 1000\n[[agents]]\nname = \"agent\"\ncount = 2\n\
             robot.chain = {{ order = 2, chi = \"-x^3\", psi = \"2 + cos(x)\" }}\nstart.position = [[1.0], [-0.5]]\n\
             [reference.desired]\npolynomial = {{ integrators = 1, roots_per_s = [1, 2] }}\ncoupling_polynomial = {coupling}\n\
             [law.linearising]\ngain_per_s = 2\n[network]\nweight = {weight}\nedges.ring = {{}}\n"
        );
        write(&here, "pair.toml", &text);
        forwardstep(&here, &["run", "pair.toml", "--out", "run", "--force"]).success();
        let gap = summary(&here.path().join("run"))["metrics"]["disagreement"]["measured"].clone();
        gap["last"].as_f64().unwrap() / gap["initial"].as_f64().unwrap()
    };
    // The roots nearest to the axis have the real parts −0.00918 and 0.00900 1/s.
    assert!(left("[1]", 2.9) < 1e-3 && left("[1]", 3.1) > 1e3);
    assert!(left("{ roots_per_s = [1, 2] }", 31.0) < 1e-9);
}

/// Desired dynamics have an order, be it that of a polynomial that no agent's roots make.
#[test]
fn regress_desired_dynamics_have_an_order() {
    let folder = folder();
    let said =
        stdout(&forwardstep(&folder, &["compare", "desired-together", "first-order", "--out", "both"]).success());
    let order = said.lines().find(|line| line.trim_start().starts_with("order ")).unwrap();
    assert_eq!(order.split_whitespace().collect::<Vec<_>>(), ["order", "2", "1"], "{said}");
}
