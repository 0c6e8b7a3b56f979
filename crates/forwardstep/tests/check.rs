//! `forwardstep check`: exit statuses, waivers, and the document for programs.

mod derivation;
mod many;
mod narrow;
mod predictions;
mod protocols;
mod sampling;
mod smoothness;
mod whose;

use std::fs;

use crate::support::{folder, forwardstep, some, stderr, stdout};
use forwardstep::check::Id;
use forwardstep::io::scenario::SHIPPED_SCENARIOS;
use serde_json::Value;
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
    assert!(
        one.contains(
            "all in all: not covered by the paper (applied-torque), but for what was accepted: continuous-time\n"
        ),
        "{one}"
    );
    let none = said(&["continuous-time", "applied-torque", "continuous-time"], 0);
    assert!(
        none.ends_with("all in all: holds, but for what was accepted: applied-torque, continuous-time\n")
            && none.matches("\naccepted: ").count() == 2,
        "{none}"
    );
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
fn practical_verdicts_stand_beside_the_hypotheses_and_count_where_they_are_asked_for() {
    let all = ["--accept", "continuous-time", "--accept", "applied-torque", "--accept", "spanning-tree"];
    let found = |hz: u32, more: &[&str], status| {
        let folder = with(&TWO.replace("sample_hz = 500", &format!("sample_hz = {hz}")));
        let arguments = [&["two.toml"], &all[..], more].concat();
        json(&folder, &arguments, status)
    };
    // λ is about 8.4/s: σ is 1 near 240 ms.
    for (hz, answer) in [(500, "adequate"), (6, "marginal"), (3, "inadequate")] {
        let document = found(hz, &[], 0);
        let verdicts = document["practical"]["verdicts"].as_array().unwrap();
        let with_id = |id: &str| verdicts.iter().find(|verdict| verdict["id"] == id);
        let [sampling, load] = ["sampling-margin", "static-load"].map(|id| with_id(id).unwrap());
        assert_eq!((&sampling["id"], &sampling["answer"]), (&"sampling-margin".into(), &answer.into()), "{sampling}");
        assert_eq!((&load["id"], &load["answer"]), (&"static-load".into(), &"adequate".into()), "{load}");
        // What grows has no bound.
        let grows = with_id("whole-loop").unwrap()["answer"] == "inadequate";
        assert!(!grows || hz == 3, "{verdicts:?}");
        assert_eq!(with_id("tracking-disagreement").is_none(), grows, "{verdicts:?}");
        if let Some(agreement) = with_id("tracking-disagreement") {
            let gain = agreement["numbers"]["rms_gain_s"].as_f64().unwrap();
            assert_eq!(agreement["answer"], "bound", "{agreement}");
            assert!(
                gain > 0.0 && agreement["because"].as_str().unwrap().contains("RMS disagreement ≤ "),
                "{agreement}"
            );
        }
        assert_eq!(document["practical"]["worst"], answer);
        let sigma = sampling["numbers"]["sigma"].as_f64().unwrap();
        let longest_s = sampling["numbers"]["longest_period_s"].as_f64().unwrap();
        assert!((sigma * longest_s * f64::from(hz) - 1.0).abs() < 1e-9);
        assert_eq!(found(hz, &["--practical"], i32::from(answer == "inadequate"))["fine"], true);
    }
    let said = stdout(&forwardstep(&with(TWO), &["check", "two.toml"]).code(1));
    assert!(said.contains("\nPractical: derived for this software, not in the paper\n  adequate: "), "{said}");
}

#[test]
fn the_document_says_what_the_words_say_and_keeps_to_its_schema() {
    let here = folder();
    let schema: Value = serde_json::from_str(&stdout(&forwardstep(&here, &["schema", "check"]).success())).unwrap();
    assert_eq!(schema["title"], "forwardstep check");
    for scenario in some(SHIPPED_SCENARIOS, 8) {
        let run = forwardstep(&here, &["check", scenario.name]);
        let status = run.get_output().status.code().unwrap();
        let (text, found) = (stdout(&run), json(&here, &[scenario.name], status));
        assert_eq!(found["fine"], status == 0);
        assert_eq!(found["format"], 1);
        assert!(text.contains(found["verdicts"]["theorem"].as_str().unwrap()), "{text}");
        for hypothesis in found["verdicts"]["hypotheses"].as_array().unwrap() {
            let word = |key: &str| hypothesis[key].as_str().unwrap();
            // What the paper has not is marked, also where it asks the same of something else.
            let ours = word("source").ends_with("not in the paper");
            let is_it = |id: &&Id| id.name() == word("id");
            let id = Id::ALL.iter().find(is_it).unwrap();
            assert!(id.place() == word("place") || ours && word("place") == "own derivation", "{hypothesis}");
            let mark = if ours { ", not in the paper" } else { "" };
            let name = format!("{}{mark}", word("id"));
            let lines = format!("  {}: {} [{name}]\n    {}\n", word("answer"), word("requires"), word("because"));
            assert!(text.contains(&lines), "{lines}\n{text}");
            assert_eq!(hypothesis["change"].is_null(), word("answer") == "holds", "{hypothesis}");
            let change = hypothesis["change"].as_str().map(|change| format!("    to make it hold: {change}\n"));
            assert!(text.contains(&change.unwrap_or_default()), "{text}");
        }
        follows(&found, &schema, &schema);
        assert_eq!(found.get("prediction"), None, "it was not asked for");
        let predicted = json(&here, &[scenario.name, "--predict"], status);
        follows(&predicted, &schema, &schema);
        let leads = ["theorem-8", "leader-over-turns", "leader-over-late-links", "theorem-9", "remark-12"]
            .contains(&scenario.name);
        assert!(!(leads && predicted.get("prediction").is_some()), "{}: nothing is agreed upon", scenario.name);
    }
}

#[test]
fn the_summary_of_a_run_keeps_to_its_schema() {
    let here = folder();
    let schema: Value = serde_json::from_str(&stdout(&forwardstep(&here, &["schema", "summary"]).success())).unwrap();
    assert_eq!(schema["title"], "forwardstep summary.json");
    assert!(schema["properties"]["agents"]["description"].is_string());
    let radio = SHIPPED_SCENARIOS.iter().find(|scenario| scenario.name == "six-arms-over-radio").unwrap().text;
    assert!(radio.contains("end_s = 60"));
    fs::write(here.path().join("radio.toml"), radio.replace("end_s = 60", "end_s = 2")).unwrap();
    for name in ["first-order", "radio.toml", "theorem-5", "theorem-6", "theorem-8", "rest-to-rest"] {
        let out = name.trim_end_matches(".toml");
        forwardstep(&here, &["run", name, "--out", out]);
        let text = fs::read_to_string(here.path().join(out).join("summary.json")).unwrap();
        let document: Value = serde_json::from_str(&text).unwrap();
        follows(&document, &schema, &schema);
        assert!(
            document["agents"].as_array().is_some_and(|agents| agents.iter().all(|agent| agent["name"].is_string()))
        );
        let mut wrong = document.clone();
        wrong["unheard_of"] = Value::Bool(true);
        assert!(std::panic::catch_unwind(|| follows(&wrong, &schema, &schema)).is_err());
    }
}

/// Whether a document has what its schema requires, and nothing that it does not know.
fn follows(document: &Value, schema: &Value, root: &Value) {
    if let Some(name) = schema["$ref"].as_str() {
        return follows(document, root.pointer(name.trim_start_matches('#')).unwrap(), root);
    }
    if let (Some(choices), Some(text)) = (schema["oneOf"].as_array(), document.as_str()) {
        // One of some words.
        let has = |choice: &Value| {
            choice["const"] == text || choice["enum"].as_array().is_some_and(|all| all.contains(document))
        };
        assert!(choices.iter().any(has), "{text}: {schema}");
        return;
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
                let own = &schema["properties"][name];
                let field = if own.is_null() { &schema["additionalProperties"] } else { own };
                assert!(field.is_object(), "{name} is unknown");
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
/// What `check` answers about a hypothesis, and the change that it names.
fn answered(folder: &TempDir, text: &str, id: &str) -> (String, String) {
    fs::write(folder.path().join("own.toml"), text).unwrap();
    let output = forwardstep(folder, &["check", "--json", "own.toml"]).get_output().clone();
    let document: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{text}\n{output:?}"));
    let all = document["verdicts"]["hypotheses"].as_array().unwrap();
    let found = all.iter().find(|one| one["id"] == id).unwrap_or_else(|| panic!("{id}: {document}"));
    let text = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
    assert_eq!(text("change").is_empty(), text("answer") == "holds", "{found}");
    (text("answer"), text("change"))
}

#[test]
fn a_change_that_is_named_makes_the_hypothesis_hold() {
    let folder = folder();
    let shipped =
        |name: &str| fs::read_to_string(format!("{}/../io/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let three = TWO.replace("count = 2", "count = 3").replace("[0.3, 0.4]]", "[0.3, 0.4], [0.5, 0.6]]");
    let weight = |text: &str| TWO.replace("[network]", &format!("[network]\nweight = \"{text}\""));
    let delay = |text: &str| TWO.replace("[network]", &format!("[network]\ndelay.{text}"));
    let roots = |first: &str| {
        let own = format!(
            "[[agents]]\nname = \"b\"\nreference.consensus = {{ roots_per_s = [{first}, 2.0] }}\nrobot.planar_arm = {{ mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }}\nstart.position_rad = [0.1, 0.2]\n[reference.consensus]"
        );
        TWO.replace("[reference.consensus]", &own)
            .replace("edges = [[\"arm-1\", \"arm-2\"]]", "switching = \"repeat\"\n[[network.phases]]\ndwell_s = 1\nedges = [[\"arm-1\", \"arm-2\"], [\"arm-2\", \"b\"], [\"b\", \"arm-1\"]]\n[[network.phases]]\ndwell_s = 1\nedges = [[\"arm-1\", \"arm-2\"]]")
    };
    let (theorem_8, turns) = (shipped("theorem-8"), shipped("leader-over-turns"));
    let sign = |period_s: &str| {
        theorem_8.replace("[reference.leader]", &format!("[reference.leader]\nsign_period_s = {period_s}"))
    };
    let radio = |timeout_s: &str| {
        let text = delay("constant_s = 0.3");
        text.replace(
            "sample_hz = 500",
            &format!("sample_hz = 500\nmessage_timeout_s = {timeout_s}\nsafe_command = \"zero\""),
        )
    };
    // The hypothesis, the scenario, what the change says, and the scenario with the change.
    let cases: [(&str, String, &str, String); 12] = [
        (
            "spanning-tree",
            three.clone(),
            "an edge from arm-1 to arm-3",
            three.replace("\"arm-2\"]]", "\"arm-2\"], [\"arm-1\", \"arm-3\"]]"),
        ),
        ("bounded-weights", weight("exp(-t)"), "max(w, c)", weight("max(exp(-t), 0.1)")),
        ("bounded-weights", weight("1 + t"), "min(w, c)", weight("min(1 + t, 3)")),
        ("bounded-delays", delay("formula_s = \"t\""), "min(T, 1)", delay("formula_s = \"min(t, 1)\"")),
        (
            "bounded-delays",
            delay("packets = { seed = 1, period_s = 0.1, latency_s = 0.01, loss.random = { probability = 0.3 } }"),
            "`most_consecutive`",
            delay(
                "packets = { seed = 1, period_s = 0.1, latency_s = 0.01, loss.random = { probability = 0.3, most_consecutive = 4 } }",
            ),
        ),
        ("common-first-root", roots("1.5"), "κ₀ = 1 per second, the first of its roots, for b too", roots("1.0")),
        ("applied-torque", TWO.to_owned(), "no limits", TWO.replace("torque_limit = [200, 100]\n", "")),
        ("messages-in-time", radio("0.1"), "`message_timeout_s` of at least 0.302", radio("0.302")),
        ("sign-gain", theorem_8.replace("gain = 2 ", "gain = 0.5 "), "γ above ", theorem_8.clone()),
        ("set-valued-sign", sign("0.5"), "`sign_period_s` of at most 0.01", sign("0.01")),
        (
            "no-delay",
            turns.replacen("[[network.phases]]", "[network]\ndelay.constant_s = 0.1\n[[network.phases]]", 1),
            "no delays",
            turns.clone(),
        ),
        (
            "leader-in-every-graph",
            turns.replace("[\"leader\", \"arm-4\"], ", ""),
            "in phase 2 an edge to arm-4 from the leader",
            turns.clone(),
        ),
    ];
    for (id, before, change, after) in cases {
        let (answer, named) = answered(&folder, &before, id);
        assert!(answer != "holds" && named.contains(change), "{id}: {answer}: {named}");
        let (answer, _) = answered(&folder, &after, id);
        assert_eq!(answer, "holds", "{id} with {named}\n{after}");
    }
}

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

#[test]
fn what_changed_v_is_said_when_asked_and_adds_up() {
    // Masses are not known, so that V(0) is not zero.
    let adapted = TWO.replace("[law.known]", "[law.adaptive]\nadaptation_gain = 5").replace("end_s = 30", "end_s = 1");
    let folder = with(&adapted);
    let run = |more: &[&str]| {
        let arguments = [&["run", "two.toml", "--force", "--out", "run"], more].concat();
        let said = stdout(&forwardstep(&folder, &arguments));
        let summary = fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
        (said, serde_json::from_str::<Value>(&summary).unwrap())
    };
    let (said, summary) = run(&[]);
    assert!(!said.contains("V of all agents") && summary["injected"].as_array().is_none_or(Vec::is_empty), "{said}");
    let (said, summary) = run(&["--balance"]);
    assert!(said.contains("V of all agents") && said.contains("beyond the proof"), "{said}");
    for own in summary["injected"].as_array().unwrap() {
        let joule = |key: &str| own[key].as_f64().unwrap();
        let terms =
            ["dissipated_j", "held_j", "reconstructed_j", "measured_j", "limited_j", "pushed_j", "adaptation_j"];
        let sum: f64 = terms.map(joule).iter().sum();
        assert!((joule("start_j") + sum - joule("end_j")).abs() < 1e-7 * joule("start_j"), "{own}");
    }
    // Where nothing samples there is nothing to tell apart, which is said.
    let continuous = adapted.replace("[control]\nsample_hz = 500\ntorque_limit = [200, 100]\n", "");
    let told = stderr(&forwardstep(&with(&continuous), &["run", "two.toml", "--balance", "--out", "run"]));
    assert!(told.contains("--balance says nothing here"), "{told}");
}
