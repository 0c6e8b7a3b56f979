//! What is not the paper's is marked where people and programs read it.

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
