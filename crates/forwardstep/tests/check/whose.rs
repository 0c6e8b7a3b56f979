//! What is not the paper's is marked where people and programs read it.

use std::fs;

use serde_json::Value;

use crate::support::{folder, forwardstep, stdout};

const OURS: &str = "derived for this software, not in the paper";

fn words(scenario: &str) -> String {
    stdout(&forwardstep(&folder(), &["check", scenario]))
}

fn verdicts(scenario: &str) -> Value {
    let document: Value =
        serde_json::from_str(&stdout(&forwardstep(&folder(), &["check", "--json", scenario]))).unwrap();
    document["verdicts"].clone()
}

#[test]
fn regress_offsets_and_nonlinear_couplings_are_not_the_papers() {
    for (scenario, name, extension) in [
        ("formation", "theorem-4", ", with offsets from where all agree as derived for this software: "),
        ("vehicles-behind-a-leader", "theorem-4", ", with offsets from where all agree as derived for this software: "),
        ("saturated-coupling", "chains-agree", ", with a nonlinear coupling as derived for this software: "),
    ] {
        let (text, document) = (words(scenario), verdicts(scenario));
        assert!(text.contains(extension), "{text}");
        assert_eq!((document["id"].as_str(), document["source"].as_str()), (Some(name), Some(OURS)));
        assert!(document["theorem"].as_str().unwrap().ends_with(extension.trim_end_matches(": ")), "{document}");
    }
    let plain = verdicts("theorem-4");
    assert_eq!(plain["source"].as_str(), Some("the paper"));
}

#[test]
fn hypotheses_that_the_paper_does_not_have_are_marked_and_no_others() {
    for scenario in ["formation", "saturated-coupling", "theorem-3-a5-order-3"] {
        let (text, document) = (words(scenario), verdicts(scenario));
        for hypothesis in document["hypotheses"].as_array().unwrap() {
            let of = |key: &str| hypothesis[key].as_str().unwrap();
            let mark = if of("source") == OURS { ", not in the paper" } else { "" };
            let line = format!("{}: {} [{}{mark}]", of("answer"), of("requires"), of("id"));
            assert!(text.contains(&line), "{line} is not in {text}");
        }
    }
}

/// Of agents with targets each law has its own statement, and all together are no more the paper's than the least of them.
#[test]
fn regress_laws_that_no_theorem_treats_are_not_given_one_beside_others_that_have_it() {
    let craft = |name: &str, law: &str| {
        format!(
            "[[agents]]\nname = \"{name}\"\nrobot.spacecraft.inertia_kg_m2 = [2, 1.5, 1]\ntarget.formulas = [0, 0, 0, 1]\nlaw.{law} = {{}}\n\
             start.attitude = {{ axis = [1, 1, 0], angle_rad = 1 }}\n"
        )
    };
    let folder = folder();
    let check = |second: &str| {
        let text = format!(
            "format = 2\ntime.end_s = 5\n{}{}[reference.tracking]\n",
            craft("a", "attitude"),
            craft("b", second)
        );
        fs::write(folder.path().join("own.toml"), text).unwrap();
        let words = stdout(&forwardstep(&folder, &["check", "own.toml"]).code(0));
        let document = stdout(&forwardstep(&folder, &["check", "--json", "own.toml"]).code(0));
        (words, serde_json::from_str::<Value>(&document).unwrap()["verdicts"].clone())
    };
    let (words, document) = check("passivity_filter");
    assert!(
        words.contains("each agent by what is said of its law: Theorem 7") && !words.contains("for every agent"),
        "{words}"
    );
    assert!(words.contains("; no theorem of the paper: a passivity filter"), "{words}");
    assert_eq!((document["id"].as_str(), document["source"].as_str()), (Some("targets"), Some(OURS)));
    let (words, document) = check("attitude");
    assert!(words.contains("Theorem 7, ") && !words.contains("each agent by"), "{words}");
    assert_ne!(document["source"].as_str(), Some(OURS));
}

/// With offsets it is not x that all agree on, be their laws alike or not.
#[test]
fn regress_unlike_vehicles_in_formation_are_not_promised_to_meet() {
    let text = "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"v\"\nrobot.vehicle.mass_kg = 1.5\nstart.position_m = [0, 0, -3]\n\
                law.thrust.design.adaptive = { damping_per_s = 3, adaptation_gain = 0.2, estimate_start_kg = 1.2 }\nTARGET\n\
                [[agents]]\nname = \"w\"\nrobot.vehicle.mass_kg = 1\nstart.position_m = [1, 0, -3]\n\
                law.thrust.design.differentiable = { damping_per_s = 3, stiffness = 4 }\n\
                [reference.consensus]\nroots_per_s = [1, 1.5, 2]\nexchange = \"position\"\n[network]\nedges.ring = {}\n";
    let folder = folder();
    let said = |target: &str| {
        fs::write(folder.path().join("own.toml"), text.replace("TARGET", target)).unwrap();
        stdout(&forwardstep(&folder, &["check", "own.toml"]))
    };
    let plain = said("");
    assert!(plain.contains("side by side") && plain.contains("xᵢ − xⱼ → 0"), "{plain}");
    let apart = said("target.formulas = [\"0.2*t\", 1, 0]");
    assert!(apart.contains("side by side") && apart.contains("yᵢ − yⱼ → 0") && !apart.contains("xᵢ − xⱼ"), "{apart}");
}
