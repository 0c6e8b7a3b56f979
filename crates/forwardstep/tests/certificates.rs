//! Certificates of the shipped scenarios, checked by the program in `checker/`, which shares no code with forwardstep.

mod cases;
mod checker;
mod formulas;
mod robots;
mod witnesses;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{folder, is_long, some};
use forwardstep::check::{certify, check};
use forwardstep::io::output::certificate_document;
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario};
use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn python(arguments: &[&str], certificates: &Path) -> Output {
    let mut command = Command::new("python3");
    command.args(arguments).env("FORWARDSTEP_CERTIFICATES", certificates).env("PYTHONDONTWRITEBYTECODE", "1");
    command.current_dir(root().join("checker")).output().expect("the checker needs python3")
}

/// Writes the certificate of a scenario into `to`, under its name.
fn certified(scenario: &str, to: &Path) -> PathBuf {
    let scenario = open_scenario(scenario).unwrap_or_else(|error| panic!("{error}"));
    let certificate = certify(&scenario.setup, &check(&scenario.setup));
    let path = to.join(format!("{}.json", scenario.name));
    fs::write(&path, certificate_document(&scenario, "0.0.0", &certificate).to_string()).unwrap();
    path
}

/// What the checker says of a certificate, as JSON.
fn checked(certificate: &Path, scenario: &Path) -> Value {
    let arguments = ["forwardstep_checker.py", "--json", certificate.to_str().unwrap(), scenario.to_str().unwrap()];
    let output = python(&arguments, Path::new(""));
    let printed = String::from_utf8(output.stdout).unwrap();
    serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{printed}{}", String::from_utf8_lossy(&output.stderr)))
}

fn file_of(scenario: &str) -> PathBuf {
    root().join(format!("crates/io/scenarios/{scenario}.toml"))
}

#[test]
fn every_claim_of_every_shipped_scenario_and_of_every_case_is_accepted() {
    let folder = folder();
    let (mut unchecked, mut accepted) = (BTreeSet::new(), 0);
    let cases = fs::read_dir(root().join("checker/cases")).unwrap().map(|entry| entry.unwrap().path());
    let cases: Vec<PathBuf> = cases.filter(|path| path.extension().is_some_and(|kind| kind == "toml")).collect();
    assert!(cases.len() > 10, "{cases:?}");
    for file in some(SHIPPED_SCENARIOS.iter().map(|scenario| file_of(scenario.name)).chain(cases), 5) {
        let scenario = file.file_stem().unwrap().to_str().unwrap();
        let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
        for entry in found["entries"].as_array().unwrap() {
            let text = |key: &str| entry[key].as_str().unwrap().to_owned();
            let claims = text("words").starts_with("nothing is claimed");
            match text("outcome").as_str() {
                "accepted" => accepted += 1,
                "could not check" if claims => {}
                "could not check" => {
                    unchecked.insert((scenario.to_owned(), text("id")));
                }
                outcome => panic!("{scenario}: {outcome}: {entry}"),
            }
        }
    }
    assert_eq!(unchecked, BTreeSet::<(String, String)>::new());
    assert!(accepted > if is_long() { 250 } else { 50 }, "{accepted}");
}

/// Three masses that agree; `network` is its table.
fn masses(network: &str) -> String {
    format!(
        "format = 2\ntitle = \"masses\"\n[time]\nend_s = 20\n[[agents]]\nname = \"m\"\ncount = 3\n\
         robot.point_mass = {{ mass_kg = 2, dimension = 1 }}\nstart.position_m = [[0.0], [1.0], [2.0]]\n\
         [reference.consensus]\nroots_per_s = [1.0, 2.0]\nexchange = \"position\"\n[network]\n{network}"
    )
}

const RING: &str = "edges = [[\"m-1\", \"m-2\"], [\"m-2\", \"m-3\"], [\"m-3\", \"m-1\"]]";

#[test]
fn matrices_are_judged_by_dominance_by_their_determinant_and_by_null_vectors() {
    let is = |psi: &str, answer: &str| {
        let scenario = format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"two\"\ncount = 2\nstart.position_m = [[0.1, 0.2], [0.3, 0.4]]\n\
             robot.vector_chain = {{ order = 1, chi = [\"0\", \"0\"], psi = {psi} }}\n[law.linearising]\nfloor = 1e-3\n\
             [reference.consensus]\nroots_per_s = [1]\nexchange = \"position\"\n[network]\nedges.ring = {{}}\n"
        );
        assert_eq!(judged(&scenario, "input-factor"), (answer.to_owned(), "accepted".to_owned()), "{psi}");
    };
    is(r#"[["3", "sin(x1)"], ["0.5", "2"]]"#, "holds");
    // No row outweighs the rest.
    is(r#"[["1 + 0.1*sin(x1)", "2"], ["-2", "1"]]"#, "holds");
    // 0.1 · 0.9 = 0.3 · 0.3, but not in binary numbers.
    is(r#"[["0.1", "0.3"], ["0.3", "0.9"]]"#, "violated");
}

/// The proof of a hypothesis.
fn proof(scenario: &str, id: &str) -> Value {
    let folder = folder();
    let file = folder.path().join("own.toml");
    fs::write(&file, scenario).unwrap();
    let certificate = fs::read_to_string(certified(file.to_str().unwrap(), folder.path())).unwrap();
    let certificate: Value = serde_json::from_str(&certificate).unwrap();
    let entries = certificate["hypotheses"].as_array().unwrap();
    entries.iter().find(|entry| entry["id"] == id).unwrap()["proof"].clone()
}

/// What `check` answers about a hypothesis, and what the checker makes of its proof. No claim is rejected.
fn judged(scenario: &str, id: &str) -> (String, String) {
    judged_if_read(scenario, id).unwrap_or_else(|| panic!("{id}: {scenario}"))
}

/// The same, of what can be read, and asks for the hypothesis.
fn judged_if_read(scenario: &str, id: &str) -> Option<(String, String)> {
    found_of(&entries_if_read(scenario)?, id)
}

/// What the checker makes of each proof, of what can be read. No claim is rejected.
fn entries_if_read(scenario: &str) -> Option<Vec<Value>> {
    let folder = folder();
    let file = folder.path().join("own.toml");
    fs::write(&file, scenario).unwrap();
    open_scenario(file.to_str().unwrap()).ok()?;
    let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
    let entries = found["entries"].as_array().unwrap();
    let rejected = entries.iter().find(|entry| entry["outcome"] == "rejected");
    assert!(rejected.is_none(), "{scenario}: {rejected:?}");
    Some(entries.clone())
}

/// The answer about a hypothesis, and what the checker makes of its proof.
fn found_of(entries: &[Value], id: &str) -> Option<(String, String)> {
    let entry = entries.iter().find(|entry| entry["id"] == id)?;
    let text = |key: &str| entry[key].as_str().unwrap().to_owned();
    Some((text("answer"), text("outcome")))
}

#[test]
fn what_formulas_do_for_ever_is_shown_or_refuted_by_a_witness() {
    let shown = |(answer, outcome): (String, String), expected: &str, case: &str| {
        assert_eq!((answer.as_str(), outcome.as_str()), (expected, "accepted"), "{case}");
    };
    let weights = [
        ("1 + t/(1+t)", "holds"),
        ("(1+t)/(2+t)", "holds"),
        ("2 - exp(-t)", "holds"),
        ("1 + exp(-t)*sin(5*t)", "holds"),
        ("1 + 1/(1+t^2)", "holds"),
        ("2 + 0.5*sin(t)*cos(3*t)", "holds"),
        ("exp(-t)", "violated"),
        ("1/(1+t)", "violated"),
        ("1/log(t+3)", "violated"),
        ("1 - 0.01*t", "violated"),
        ("1 + t", "violated"),
        // Functions of what decays, and of what stays.
        ("2 + log(2 + exp(-t))", "holds"),
        ("2 - sqrt(1 + exp(-t))", "holds"),
        ("2 - atan(1 + exp(-t))", "holds"),
        ("min(2, 1 + exp(-t))", "holds"),
        ("max(0.5, exp(-t))", "holds"),
        ("min(2 + exp(-t), 1 + exp(-2*t))", "holds"),
        // After the run they come to a limit that is no weight, by way of every rule of limits.
        ("1 - 0.7*atan(t/40)", "violated"),
        ("0.9 - tanh(t/60)", "violated"),
        ("1/(2 + exp(-t/40)) + 0.2 - 0.5*atan(t/40)", "violated"),
        ("min(exp(-t), 1/(1 + t))", "violated"),
        ("1 - min(2, 1.5 - exp(-t/40))", "violated"),
        ("(1 + t)^0.5", "violated"),
        ("(1 + t)^(-0.5)", "violated"),
        // No limit: a time after the run at which it is no weight.
        ("0.5 + sin(t/10)", "violated"),
        ("1 + sin(t/20)^3 + 0.1*cos(3*t)", "violated"),
    ];
    for (weight, answer) in some(weights, 3) {
        let scenario = masses(&format!("weight = \"{weight}\"\ndelay.constant_s = 0.1\n{RING}"));
        shown(judged(&scenario, "bounded-weights"), answer, weight);
    }
    let delays = [
        ("t/(1+t)", "holds"),
        ("0.2 + 0.2*sin(3*t)", "holds"),
        ("1/(1+t^2)", "holds"),
        ("0.5*exp(-t)", "holds"),
        ("tanh(t)", "holds"),
        ("0.3 + 0*t", "holds"),
        ("t", "violated"),
        ("sqrt(t)", "violated"),
        ("0.5 - 0.01*t", "violated"),
        ("atan(1 + t)", "holds"),
        ("sqrt(1 + exp(-t)) - 1", "holds"),
        ("log(1 + exp(-t))", "holds"),
        ("1 - 0.7*atan(t/40)", "violated"),
        ("0.1 + 0.2*sin(t/10)", "violated"),
        ("0.5*abs(cos(t/40)) - 0.1", "violated"),
    ];
    for (delay, answer) in some(delays, 4) {
        let scenario = masses(&format!("delay.formula_s = \"{delay}\"\n{RING}"));
        shown(judged(&scenario, "bounded-delays"), answer, delay);
    }
}

#[test]
fn proofs_reach_networks_that_are_not_shipped() {
    let accepted = |network: &str, id: &str, expected: &str| {
        let (answer, outcome) = judged(&masses(network), id);
        assert_eq!((answer.as_str(), outcome.as_str()), (expected, "accepted"), "{network}");
    };
    let random = "switching.random = { seed = 5, dwell_s = [0.5, 2] }";
    // One graph that is drawn again and again, with a tree and without.
    accepted(&format!("{random}\n[[network.phases]]\n{RING}"), "spanning-tree", "holds");
    accepted(&format!("{random}\n[[network.phases]]\nedges = [[\"m-1\", \"m-2\"]]"), "spanning-tree", "violated");
    // The same graph twice, once with its weights in other words.
    let phase = |weight: &str| {
        format!(
            "\n[[network.phases]]\ndwell_s = 1\nedges = [{{ from = \"m-1\", to = \"m-2\", weight = {weight} }}, [\"m-2\", \"m-3\"]]"
        )
    };
    accepted(&format!("{}{}", phase("2"), phase("2.0")), "agreement", "holds");
    accepted(&format!("{}{}", phase("2"), phase("\"2 + 0*t\"")), "agreement", "holds");
    let lost = "delay.packets = { seed = 1, period_s = 0.1, latency_s = 0.02, loss.random.probability = 1 }";
    accepted(&format!("{lost}\n{RING}"), "bounded-delays", "violated");
    // Three lost in a row at most: four periods, the latency and the jitter, exactly.
    let ruled = "delay.packets = { seed = 1, period_s = 0.1, latency_s = 0.02, jitter_s = 0.05, \
        loss.random = { probability = 0.5, most_consecutive = 3 } }";
    accepted(&format!("{ruled}\n{RING}"), "bounded-delays", "holds");
    let bound = proof(&masses(&format!("{ruled}\n{RING}")), "bounded-delays");
    assert_eq!(bound["bound_s"], "0.47", "{bound}");
    // The delay of one link, stated beside the graph, is the longest of all.
    let link = format!("{RING}\n[[network.link_delays]]\nfrom = \"m-2\"\nto = \"m-3\"\n{ruled}");
    accepted(&link, "bounded-delays", "holds");
    assert_eq!(proof(&masses(&link), "bounded-delays")["bound_s"], "0.47");
}

#[test]
fn phases_that_differ_in_delays_alone_are_certified_as_one_graph() {
    let phase = |delay: &str, weight: &str| {
        format!(
            "[[network.phases]]\ndwell_s = 1\nedges = [{{ from = \"m-1\", to = \"m-2\", weight = {weight}, delay.{delay} }}, \
             [\"m-2\", \"m-1\"], [\"m-2\", \"m-3\"]]\n"
        )
    };
    let integral = |second: &str| {
        masses(&format!("{}{second}", phase("constant_s = 0.2", "2")))
            .replace("[reference.consensus]\nroots_per_s", "[reference.pure_integral]\nroots_per_s")
    };
    let late = integral(&phase("sinusoid = { mean_s = 0.3, amplitude_s = 0.2, period_s = 0.7 }", "2"));
    assert_eq!(judged(&late, "fixed-graph"), ("holds".to_owned(), "accepted".to_owned()));
    // The same certificate beside another weight, or an edge less.
    let folder = folder();
    let file = folder.path().join("late.toml");
    fs::write(&file, &late).unwrap();
    let phases = [phase("constant_s = 0.2", "3"), phase("constant_s = 0.2", "2").replace(", [\"m-2\", \"m-3\"]", "")];
    for second in phases {
        let (outcome, words) = outcome_of_pair(&file, &integral(&second), "fixed-graph");
        assert!(outcome == "rejected" && words.contains("by the text"), "{outcome}: {words}");
    }
}

#[test]
fn swarms_with_roots_that_differ_are_certified_too() {
    let text = SHIPPED_SCENARIOS.iter().find(|shipped| shipped.name == "swarm-tracking").unwrap().text;
    for roots in ["[0.5, 3.0]", "[3.0, 0.5]", "[2.0, 0.1]"] {
        let own = text.replace("roots_per_s = [1.0, 1.0]", &format!("roots_per_s = {roots}"));
        assert_ne!(own, text);
        let own = own.replace("coupling = 12 ", "coupling = 40 ");
        assert_eq!(judged(&own, "swarm-coupling"), ("holds".to_owned(), "accepted".to_owned()), "{roots}");
    }
}

/// A shipped scenario with something else in it.
fn changed(name: &str, old: &str, new: &str) -> String {
    let text = fs::read_to_string(file_of(name)).unwrap();
    assert!(text.contains(old), "{name}");
    text.replace(old, new)
}

/// Each a shipped scenario, its roots, and a pair in their place.
const PAIRS: [(&str, &str, &str); 4] = [
    ("theorem-9", "[1.0, 1.0]", "[{ real = 0.5, imaginary = 0.5 }]"),
    ("remark-12", "[1.0, 1.0]", "[{ real = 0.5, imaginary = 0.25 }]"),
    ("without-velocity", "[1.0, 1.5, 2.0]", "[1.5, { real = 0.7, imaginary = 2.0 }]"),
    ("through-waypoints", "[3, 4]", "[{ real = 2, imaginary = 0.5 }]"),
];

#[test]
fn complex_roots_are_certified_where_a_hurwitz_polynomial_is_enough() {
    for (name, old, new) in PAIRS {
        let text = changed(name, old, new);
        assert_eq!(judged(&text, "hurwitz"), ("holds".to_owned(), "accepted".to_owned()), "{name}");
    }
    // Elsewhere nothing is claimed.
    let three = ("[1.0, 1.5, 2.0]", "[1.5, { real = 0.7, imaginary = 2.0 }]");
    let two = ("[1.0, 1.0]", "[{ real = 0.5, imaginary = 0.5 }]");
    for (name, id, (old, new)) in [("theorem-4", "real-roots", three), ("swarm-tracking", "swarm-coupling", two)] {
        let text = changed(name, old, new);
        assert_eq!(judged(&text, id), ("not shown".to_owned(), "could not check".to_owned()), "{name}");
    }
}

/// What the checker says of a hypothesis by the certificate of a shipped scenario beside another text.
fn outcome_beside(name: &str, text: &str, id: &str) -> (String, String) {
    outcome_of_pair(&file_of(name), text, id)
}

/// The same by the certificate of a file.
fn outcome_of_pair(scenario: &Path, text: &str, id: &str) -> (String, String) {
    let folder = folder();
    let certificate = certified(scenario.to_str().unwrap(), folder.path());
    let file = folder.path().join("beside.toml");
    fs::write(&file, text).unwrap();
    let arguments = ["forwardstep_checker.py", "--json", "--ignore-digests"];
    let files = [certificate.to_str().unwrap(), file.to_str().unwrap()];
    let printed = String::from_utf8(python(&[&arguments[..], &files[..]].concat(), Path::new("")).stdout).unwrap();
    let found: Value = serde_json::from_str(&printed).unwrap();
    let entry = found["entries"].as_array().unwrap().iter().find(|entry| entry["id"] == id).unwrap();
    (entry["outcome"].as_str().unwrap().to_owned(), entry["words"].as_str().unwrap().to_owned())
}

/// The certificate stands; the scenario beside it is another.
#[test]
fn a_certificate_is_rejected_beside_roots_that_have_lost_the_property() {
    let outcome = |name: &str, (old, new): (&str, &str), id: &str| outcome_beside(name, &changed(name, old, new), id);
    let is = |found: (String, String), outcome: &str, words: &str| {
        assert!(found.0 == outcome && found.1.contains(words), "{found:?}");
    };
    let (three, pair) = ("[1.0, 1.5, 2.0]", "[1.0, { real = 1.5, imaginary = 2.0 }]");
    // As far to the left as before, but complex.
    is(outcome("theorem-4", (three, pair), "real-roots"), "rejected", "a root is complex");
    is(outcome("without-velocity", (three, pair), "hurwitz"), "accepted", "1");
    let slower = "[1.0, { real = 0.9, imaginary = 2.0 }]";
    is(outcome("without-velocity", (three, slower), "hurwitz"), "rejected", "below all roots");
    let wrong = "[1.0, { real = -1.5, imaginary = 2.0 }]";
    is(outcome("without-velocity", (three, wrong), "hurwitz"), "rejected", "below all roots");
    let (two, swinging) = ("[1.0, 1.0]", "[{ real = 1.0, imaginary = 0.1 }]");
    is(outcome("swarm-tracking", (two, swinging), "swarm-coupling"), "rejected", "real roots");
    // The period of 1 ms is short enough for 100 swings per unit of decay, not for more.
    let fast = "[{ real = 0.02, imaginary = 5.0 }]";
    is(outcome("theorem-9", (two, fast), "set-valued-sign"), "rejected", "is not so by the text");
}

#[test]
fn an_equation_that_its_next_state_does_not_move_is_a_witness() {
    let folder = folder();
    let file = folder.path().join("unmoved.toml");
    let shipped = fs::read_to_string(file_of("pure-feedback")).unwrap();
    let with = |first: &str, regressor: &str| {
        let text = shipped.replace("x2 + 0.2*x2^3", first).replace("x1^2 + 0.3*tanh(x2)", regressor);
        assert_ne!(text, shipped);
        text
    };
    for (first, regressor) in [("x1^2", "sin(x1)"), ("x1^2 + 0*x2", "x1^2"), ("x2 - x2", "tanh(0*x2)")] {
        let text = with(first, regressor);
        fs::write(&file, &text).unwrap();
        assert_eq!(judged(&text, "input-factor"), ("violated".to_owned(), "accepted".to_owned()), "{first}");
        // Beside a chain that is moved it shows nothing.
        for moved in [&shipped, &with("x1^2 + x2", "x1^2"), &with("x1^2", "x1^2 + 0.01*x2")] {
            let (outcome, words) = outcome_of_pair(&file, moved, "input-factor");
            assert!(outcome == "rejected" && words.contains("is moved by x2"), "{outcome}: {words}");
        }
    }
    // What moves weakly, or through a parameter, is left to the run, unless it begins below the floor: estimates start at zero.
    for (first, regressor, answer) in [
        ("0.01*x2", "x1^2", "watched during the run"),
        ("0.01*x2", "x2", "watched during the run"),
        ("x1^2", "x2", "violated"),
        ("1e-9*x2", "x1^2", "violated"),
    ] {
        assert_eq!(judged(&with(first, regressor), "input-factor").0, answer, "{first}, {regressor}");
    }
}

#[test]
fn witnesses_of_other_kinds_are_replayed() {
    let accepted = |scenario: &str, id: &str, expected: &str| {
        let (answer, outcome) = judged(scenario, id);
        assert_eq!((answer.as_str(), outcome.as_str()), (expected, "accepted"), "{scenario}");
    };
    let own_first_roots = |text: String| {
        let agents = (1..=3).map(|k| {
            format!("[[agents]]\nname = \"m-{k}\"\nrobot.point_mass = {{ mass_kg = 2, dimension = 1 }}\nstart.position_m = [{k}.0]\nreference.consensus = {{ roots_per_s = [{k}.0, 2.0] }}\n")
        });
        let from = text.find("[[agents]]").unwrap();
        let to = text.find("[reference").unwrap();
        let text = format!("{}{}{}", &text[..from], agents.collect::<String>(), &text[to..]);
        text.replace("roots_per_s = [1.0, 2.0]\nexchange = \"position\"", "exchange = \"position_velocity\"")
    };
    // Unequal first roots over a graph that stays, after one that does not.
    let once = format!(
        "switching = \"once\"\n[[network.phases]]\ndwell_s = 1\nedges = [[\"m-1\", \"m-2\"]]\n[[network.phases]]\n{RING}"
    );
    accepted(&own_first_roots(masses(&once)), "common-first-root", "holds");
    let shipped = |name: &str| fs::read_to_string(file_of(name)).unwrap();
    let replaced = |name: &str, from: &str, to: &str| {
        let text = shipped(name);
        assert!(text.contains(from), "{name}");
        text.replace(from, to)
    };
    let far = replaced("theorem-6", "\"0.8 + 0.3*cos(t)\"", "\"1.9 + 0.3*cos(t)\"");
    accepted(&far, "target-within-reach", "violated");
    let chain = |chi: &str| {
        masses(RING)
            .replace(
                "robot.point_mass = { mass_kg = 2, dimension = 1 }",
                &format!("robot.chain = {{ order = 1, chi = \"{chi}\", psi = \"1\" }}"),
            )
            .replace("roots_per_s = [1.0, 2.0]", "roots_per_s = [1.0]")
            .replace("[network]", "[law.linearising]\ngain_per_s = 2\n[network]")
    };
    accepted(&chain("1/(x-0.7)"), "defined-terms", "violated");
    accepted(&chain("sqrt(x-0.6)"), "defined-terms", "violated");
    accepted(&chain("1/(1+x^2)"), "defined-terms", "holds");
    let leader = |motion: &str| {
        let text = masses("edges = [[\"leader\", \"m-1\"], [\"m-1\", \"m-2\"], [\"m-2\", \"m-3\"]]");
        let from = text.find("[reference").unwrap();
        let to = text.find("[network]").unwrap();
        let design = "[reference.leader]\ndesign = \"continuous\"\nroots_per_s = [1.0]\ngain = 2\n";
        format!("{}[leader]\nmotion.formulas = [\"{motion}\"]\n{design}{}", &text[..from], &text[to..])
    };
    accepted(&leader("0.01*t^2"), "bounded-leader", "violated");
    accepted(&leader("0.01*t^2"), "sign-gain", "violated");
    accepted(&leader("tanh(t) + exp(-t)"), "sign-gain", "holds");
}
