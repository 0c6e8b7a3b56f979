//! `robot` as a user meets it.

use std::fs;

use crate::support::{forwardstep, names, stderr, stdout};
use serde_json::{Map, Value, json};
use tempfile::TempDir;

const TREE: &str = include_str!("../../../validation/urdf/tree.urdf");
/// What Pinocchio makes of the shipped robots and of the tree: `validation/urdf/generate.py`.
const TRUTH: &str = include_str!("../../../validation/urdf/pinocchio.json");

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tree.urdf"), TREE).unwrap();
    folder
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// Within 1e-11 of the largest entry.
fn assert_close(what: &str, ours: &[f64], theirs: &[f64]) {
    let size = theirs.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (k, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!((a - b).abs() <= 1e-11 * size, "{what}, entry {k}: {a} against {b}");
    }
}

#[test]
fn val_pinocchio_robot_at_a_state() {
    let folder = folder();
    let truth: Value = serde_json::from_str(TRUTH).unwrap();
    for case in truth["cases"].as_array().unwrap() {
        let name = case["robot"].as_str().unwrap();
        let joints: Vec<&str> =
            case["joints"].as_array().unwrap().iter().map(|joint| joint.as_str().unwrap()).collect();
        let damping = numbers(&case["damping"]);
        let locks = case["locked"].as_object().unwrap().iter();
        let locks: Vec<String> = locks.map(|(joint, value)| format!("--lock={joint}={value}")).collect();
        let file = if name == "tree" { "tree.urdf" } else { name };
        for state in case["states"].as_array().unwrap() {
            let entry = |k: usize| {
                let quantities = ["q", "dq", "z", "dz"];
                Value::Object(quantities.iter().map(|key| ((*key).to_owned(), state[key][k].clone())).collect())
            };
            let map: Map<String, Value> =
                joints.iter().enumerate().map(|(k, joint)| ((*joint).to_owned(), entry(k))).collect();
            fs::write(folder.path().join("state.json"), serde_json::to_string_pretty(&map).unwrap()).unwrap();
            let mut arguments = vec!["robot", file, "--at", "state.json", "--json"];
            arguments.extend(locks.iter().map(String::as_str));
            let ours: Value = serde_json::from_str(&stdout(&forwardstep(&folder, &arguments).success())).unwrap();

            let keys: Vec<_> = ours.as_object().unwrap().keys().map(String::as_str).collect();
            assert_eq!(keys.len(), 5, "{keys:?}");
            assert_eq!(ours["joints"], json!(joints));
            let mass: Vec<f64> = ours["M"].as_array().unwrap().iter().flat_map(numbers).collect();
            assert_close(name, &mass, &numbers(&state["mass"]));
            assert_close(name, &numbers(&ours["g"]), &numbers(&state["gravity"]));
            // Pinocchio's torque has the damping in it.
            let [dq, z, torque] = ["dq", "z", "torque"].map(|key| numbers(&state[key]));
            let tau: Vec<f64> = (0..joints.len()).map(|k| torque[k] - damping[k] * z[k]).collect();
            assert_close(name, &numbers(&ours["tau"]), &tau);
            // Its acceleration is that under another torque: M (ours − its) = τ − its τ + D q̇.
            let (ddq, its_ddq, its_tau) = (numbers(&ours["ddq"]), numbers(&state["ddq"]), numbers(&state["tau"]));
            let m = numbers(&state["mass"]);
            let n = joints.len();
            let row = |i: usize, x: &[f64]| (0..n).map(|j| m[i * n + j] * x[j]).sum::<f64>();
            let ours: Vec<f64> = (0..n).map(|i| row(i, &ddq)).collect();
            let its: Vec<f64> = (0..n).map(|i| row(i, &its_ddq) + tau[i] - its_tau[i] + damping[i] * dq[i]).collect();
            assert_close(name, &ours, &its);
        }
    }
}

#[test]
fn a_robot_that_is_led_as_it_moves_follows_its_reference() {
    let folder = folder();
    let entry = |q: f64, v: f64| json!({ "q": q, "dq": v, "z": v, "dz": 0.5 });
    let state = json!({ "turn": entry(1.0, 0.2), "a_left": entry(-0.5, 1.0), "z_slide": entry(0.1, -1.0), "a_wheel": entry(9.0, 2.0) });
    fs::write(folder.path().join("state.json"), state.to_string()).unwrap();
    let text = stdout(&forwardstep(&folder, &["robot", "tree.urdf", "--at", "state.json", "--json"]).success());
    let ours: Value = serde_json::from_str(&text).unwrap();
    assert_close("ddq = dz where dq = z", &numbers(&ours["ddq"]), &[0.5; 4]);
    let text = stdout(&forwardstep(&folder, &["robot", "tree.urdf", "--at", "state.json"]).success());
    for word in ["joints", "M", "g", "tau", "ddq", "a_wheel"] {
        assert!(text.split_whitespace().any(|found| found == word), "no {word} in {text}");
    }
    let tau = ours["tau"][0].as_f64().unwrap().to_string();
    assert!(text.contains(&tau), "{tau} is not in {text}");
}

#[test]
fn a_robot_is_described() {
    let folder = folder();
    let text = stdout(&forwardstep(&folder, &["robot", "tree.urdf"]).success());
    for part in [
        "tree on its base world",
        "-0.5 to 0.5 m",
        "200 N",
        "3.5 N s/m",
        "20 rad/s",
        "continuous",
        "7.3 kg",
        "moving mass 11.05 kg",
        "note: tree.urdf:78:16: the axis of joint `a_left`",
    ] {
        assert!(text.contains(part), "no {part} in {text}");
    }
    let places = ["turn ", "a_left ", "z_slide ", "a_wheel "].map(|joint| text.find(joint).unwrap());
    assert!(places.is_sorted(), "{text}");

    let text = stdout(&forwardstep(&folder, &["robot", "tree.urdf", "--json", "--lock", "turn=0.5"]).success());
    let value: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["joints"].as_array().unwrap().len(), 3);
    assert_eq!(value["joints"][1]["type"], "prismatic");
    assert_eq!(value["joints"][1]["position_limits"], json!([-0.5, 0.5]));
    assert_eq!(value["joints"][2]["position_limits"], Value::Null);
    assert_eq!(value["joints"][1]["damping"], 3.5);
    assert_eq!(value["bodies"][1]["centre_of_mass_m"], json!([0.1, 0.0, 0.0]));
    let [moving, held] = ["moving_mass_kg", "held_mass_kg"].map(|key| value[key].as_f64().unwrap());
    assert!((moving - 3.75).abs() < 1e-12 && (held - 7.3).abs() < 1e-12, "{moving} {held}");
    assert!(value["notices"][0].as_str().unwrap().contains("does not enter"), "{value}");
}

#[test]
fn friction_is_shown_unless_it_is_left_out() {
    let folder = folder();
    let rough = TREE.replace("damping=\"0.7\"", "damping=\"0.7\" friction=\"0.1\"");
    fs::write(folder.path().join("rough.urdf"), rough).unwrap();
    let text = stdout(&forwardstep(&folder, &["robot", "rough.urdf"]).success());
    let [turn, slide] =
        ["turn ", "z_slide "].map(|joint| text.lines().find(|line| line.trim_start().starts_with(joint)).unwrap());
    assert!(turn.contains("0.7 N m s/rad ") && turn.ends_with(" 0.1 N m") && slide.ends_with("none"), "{text}");
    let json: Value =
        serde_json::from_str(&stdout(&forwardstep(&folder, &["robot", "rough.urdf", "--json"]).success())).unwrap();
    assert_eq!((&json["joints"][0]["friction"], &json["joints"][1]["friction"]), (&json!(0.1), &json!(0.0)));
    let text = stdout(&forwardstep(&folder, &["robot", "rough.urdf", "--ignore-friction"]).success());
    assert!(text.contains("Coulomb friction is left out, as asked: 0.1 of `turn`"), "{text}");

    let state = json!({ "turn": { "q": 0 }, "a_left": { "q": 1 }, "z_slide": { "q": 0 }, "a_wheel": { "q": 0 } });
    fs::write(folder.path().join("state.json"), state.to_string()).unwrap();
    let at = |file| stdout(&forwardstep(&folder, &["robot", file, "--at", "state.json", "--json"]).success());
    assert_eq!(at("rough.urdf"), at("tree.urdf"));
}

#[test]
fn mistakes_about_a_robot_are_status_two_and_write_nothing() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("slip.json", "{ \"turn\": { \"q\": 0 },\n  \"a_lef\": { \"q\": 0 } }");
    write("huge.json", r#"{"turn":{"q":1,"dq":1e200},"a_left":{"q":1},"z_slide":{"q":0},"a_wheel":{"q":0}}"#);
    write("broken.json", "{ \"turn\": { \"q\": 0 }\n");
    write("nan.json", "{ \"turn\": { \"q\": NaN } }");
    write("broken.urdf", "<robot name=\"r\">\n  <link>\n</robot>");
    let before = names(folder.path());
    let cases: [(&[&str], &str); 14] = [
        (&["robot", "ur5"], "did you mean `ur5e`?"),
        (&["robot", "tre.urdf"], "did you mean `tree.urdf`?"),
        (&["robot", "broken.urdf"], "broken.urdf:"),
        (&["robot", "ur5e", "--lock", "elbow_joint"], "JOINT=VALUE"),
        (&["robot", "ur5e", "--lock", "elbow_joint=up"], "`up` is not a number"),
        (&["robot", "ur5e", "--lock", "elbow_jont=1"], "did you mean `elbow_joint`?"),
        (&["robot", "ur5e", "--lock", "elbow_joint=inf"], "must be finite"),
        (&["robot", "tree.urdf", "--at", "none.json"], "cannot read `none.json`"),
        (&["robot", "tree.urdf", "--at", "slop.json"], "did you mean `slip.json`?"),
        (&["robot", "tree.urdf", "--at", "."], "name a JSON file with the state"),
        (&["robot", "tree.urdf", "--at", "slip.json"], "slip.json:2:3: the robot has no moving joint `a_lef`"),
        (&["robot", "tree.urdf", "--at", "huge.json"], "which is not finite"),
        (&["robot", "tree.urdf", "--at", "broken.json"], "broken.json:1:21: not well-formed JSON"),
        (&["robot", "tree.urdf", "--at", "nan.json"], "nan.json:1:18: `NaN` is not a finite number"),
    ];
    for (arguments, message) in cases {
        let assert = forwardstep(&folder, arguments).code(2);
        assert!(stderr(&assert).contains(message), "{arguments:?}: {}", stderr(&assert));
        assert_eq!(stdout(&assert), "", "{arguments:?}");
    }
    assert_eq!(names(folder.path()), before);
}
