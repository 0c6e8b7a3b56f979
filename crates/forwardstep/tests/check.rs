//! `forwardstep check`: exit statuses, waivers, and the document for programs.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use std::fs;

use forwardstep::check::Id;
use forwardstep::io::scenario::SHIPPED_SCENARIOS;
use serde_json::Value;
use support::{folder, forwardstep, stderr, stdout};
use tempfile::TempDir;

/// Two arms, of which nobody hears the second, with limits that are enforced.
const TWO: &str = r#"
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
damping.gain = [[4, 2], [2, 1.5]]
[control]
sample_hz = 500
torque_limit = [200, 100]
[network]
edges = [["arm-1", "arm-2"]]
"#;

fn with(text: &str) -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("two.toml"), text).unwrap();
    folder
}

fn json(folder: &TempDir, arguments: &[&str], status: i32) -> Value {
    let all = [&["check", "--json"], arguments].concat();
    serde_json::from_str(&stdout(&forwardstep(folder, &all).code(status))).unwrap()
}

#[test]
fn hypotheses_are_waived_by_name_and_the_waiver_is_printed() {
    let folder = with(TWO);
    let said = |accepted: &[&str], status| {
        let mut arguments = vec!["check", "two.toml"];
        arguments.extend(accepted.iter().flat_map(|name| ["--accept", name]));
        stdout(&forwardstep(&folder, &arguments).code(status))
    };
    let both = said(&[], 1);
    assert!(both.contains("all in all: not covered by the paper (applied-torque, continuous-time)"), "{both}");
    let one = said(&["continuous-time"], 1);
    assert!(one.contains("accepted: continuous-time, although not covered by the paper\n"), "{one}");
    assert!(one.contains("all in all: not covered by the paper (applied-torque)\n"), "{one}");
    let none = said(&["continuous-time", "applied-torque", "continuous-time"], 0);
    assert!(none.ends_with("all in all: holds\n") && none.matches("accepted:").count() == 2, "{none}");
    let idle = said(&["spanning-tree", "no-delay"], 1);
    assert!(idle.contains("accepted: spanning-tree, without need: holds\n"), "{idle}");
    assert!(idle.contains("accepted: no-delay, which nothing here asks for\n"), "{idle}");
    let slip = stderr(&forwardstep(&folder, &["check", "two.toml", "--accept", "spaning-tree"]).code(2));
    assert!(slip.contains("a similar value exists: 'spanning-tree'"), "{slip}");
}

/// Waiving one answer does not hide another that is as bad.
#[test]
fn a_waiver_is_for_one_hypothesis_only() {
    let folder = with(&TWO.replace("[[\"arm-1\", \"arm-2\"]]", "[]"));
    let found = json(&folder, &["two.toml", "--accept", "applied-torque", "--accept", "continuous-time"], 1);
    assert_eq!((&found["outcome"], &found["fine"]), (&"violated".into(), &false.into()));
    let found = json(&folder, &["two.toml", "--accept", "spanning-tree"], 1);
    assert_eq!(found["outcome"], "not covered by the paper");
    assert_eq!(found["verdicts"]["worst"], "violated", "what was found does not change by being accepted");
}

#[test]
fn the_document_says_what_the_words_say_and_keeps_to_its_schema() {
    let here = folder();
    let schema: Value = serde_json::from_str(&stdout(&forwardstep(&here, &["schema", "check"]).success())).unwrap();
    assert_eq!(schema["title"], "forwardstep check");
    for scenario in SHIPPED_SCENARIOS {
        let run = forwardstep(&here, &["check", scenario.name]);
        let status = run.get_output().status.code().unwrap();
        let (text, found) = (stdout(&run), json(&here, &[scenario.name], status));
        assert_eq!(found["fine"], status == 0);
        assert_eq!(found["format"], 1);
        assert!(text.contains(found["verdicts"]["theorem"].as_str().unwrap()), "{text}");
        for hypothesis in found["verdicts"]["hypotheses"].as_array().unwrap() {
            let word = |key: &str| hypothesis[key].as_str().unwrap();
            assert!(Id::ALL.iter().any(|id| id.name() == word("id") && id.place() == word("place")));
            let lines =
                format!("  {}: {} [{}]\n    {}\n", word("answer"), word("requires"), word("id"), word("because"));
            assert!(text.contains(&lines), "{lines}\n{text}");
        }
        follows(&found, &schema, &schema);
        assert_eq!(found.get("prediction"), None, "it was not asked for");
        let predicted = json(&here, &[scenario.name, "--predict"], status);
        follows(&predicted, &schema, &schema);
        let leads = ["theorem-8", "theorem-9", "remark-12"].contains(&scenario.name);
        assert!(!(leads && predicted.get("prediction").is_some()), "{}: nothing is agreed upon", scenario.name);
    }
}

#[test]
fn predictions_are_made_where_they_are_asked_for_and_are_said_to_be_for_no_tracking_error() {
    let folder = with(TWO);
    let said =
        |arguments: &[&str]| stdout(&forwardstep(&folder, &[&["check", "two.toml"], arguments].concat()).code(1));
    assert!(!said(&[]).contains("Predicted"));
    let text = said(&["--predict"]);
    assert!(text.contains("Predicted for robots that follow their references exactly, s ≡ 0:"), "{text}");
    let found = json(&folder, &["two.toml", "--predict"], 1);
    let (course, rate) = (&found["prediction"]["course"]["found"], &found["prediction"]["rate"]["roots"]);
    // The second arm hears the first with weight one: (p + 1)(p + 1)(p + 2)/2 beside p (p + 1)(p + 2)/2.
    assert!((rate["root_per_s"][0].as_f64().unwrap() + 1.0).abs() < 1e-6, "{rate}");
    assert_eq!((course["reached"].as_bool(), course["t_s"].as_array().map(Vec::len)), (Some(true), Some(301)));
    let settled = format!("settled to 1 % after {:.2} s", course["settled_s"].as_f64().unwrap());
    assert!(text.contains(&settled), "{settled}\n{text}");
    let by_roots = rate["settled_s"].as_f64().unwrap() / course["settled_s"].as_f64().unwrap();
    assert!((by_roots - 1.0).abs() < 0.02, "{by_roots}");
    let value = course["within"].as_array().unwrap();
    assert_eq!(value.len(), 2);
    assert!(text.contains("value agreed upon (") && text.contains("peak torque "), "{text}");
    assert!(rate["excited"].as_f64().unwrap() > 0.05, "of three roots in one place the largest is not at the start");
    assert!(text.contains("rate: rightmost root -1.0000 1/s"), "{text}");
}

/// Whether a document has what its schema requires, and nothing that it does not know.
fn follows(document: &Value, schema: &Value, root: &Value) {
    if let Some(name) = schema["$ref"].as_str() {
        return follows(document, root.pointer(name.trim_start_matches('#')).unwrap(), root);
    }
    if let Some(choices) = schema["oneOf"].as_array() {
        let known = |choice: &&Value| {
            let (properties, fields) = (choice["properties"].as_object(), document.as_object());
            fields.unwrap().keys().all(|key| properties.unwrap().contains_key(key))
        };
        return follows(document, choices.iter().find(known).expect("one of the choices"), root);
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        // A table, or nothing.
        let known = |choice: &&Value| document.is_null() == (choice["type"] == "null");
        return follows(document, choices.iter().find(known).expect("one of the choices"), root);
    }
    match document {
        Value::Object(fields) => {
            for name in schema["required"].as_array().into_iter().flatten() {
                assert!(fields.contains_key(name.as_str().unwrap()), "{name} is missing");
            }
            for (name, value) in fields {
                let field = &schema["properties"][name];
                assert!(!field.is_null(), "{name} is unknown");
                follows(value, field, root);
            }
        }
        Value::Array(items) => items.iter().for_each(|item| follows(item, &schema["items"], root)),
        Value::String(_) => assert!(schema["type"].to_string().contains("string"), "{schema}"),
        Value::Number(_) => {
            let types = schema["type"].to_string();
            assert!(types.contains("number") || types.contains("integer"), "{schema}");
        }
        Value::Bool(_) => assert_eq!(schema["type"], "boolean"),
        Value::Null => assert!(schema["type"].to_string().contains("null"), "{schema}"),
    }
}

/// Rounding finds a Cholesky factor of each of them.
#[test]
fn matrices_that_are_exactly_singular_are_refused_with_a_direction() {
    for (gain, because) in [
        ("[[1, 2], [2, 4]]", "vᵀ A v = 0 for v = (-2, 1)"),
        ("[[0.1, 0.3], [0.3, 0.9]]", "vᵀ A v = 0 for v = (-3, 1)"),
        ("[[0.01, 0.07], [0.07, 0.49]]", "vᵀ A v = 0 for v = (-7, 1)"),
    ] {
        let folder = with(&TWO.replace("[[4, 2], [2, 1.5]]", gain));
        for command in ["check", "run"] {
            let said = stderr(&forwardstep(&folder, &[command, "two.toml"]).code(2));
            assert!(said.contains(because) && said.contains("two.toml:14:"), "{said}");
        }
    }
}
