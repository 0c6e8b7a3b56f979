//! Certificates of the cases beside the checker: desired dynamics by coefficients, and networks that were logged.

use std::fs;

use super::support::folder;
use super::{certified, changed, checked, judged, root};

fn case(name: &str) -> String {
    fs::read_to_string(root().join(format!("checker/cases/{name}"))).unwrap()
}

#[test]
fn polynomials_of_targets_are_certified_by_the_array_of_routh() {
    let text = case("desired-target.toml");
    let is = |polynomial: &str, answer: &str| {
        let own = text.replace("polynomial = [6, 11, 6]", &format!("polynomial = {polynomial}"));
        assert_eq!(judged(&own, "desired-dynamics"), (answer.to_owned(), "accepted".to_owned()), "{polynomial}");
        // What is asked of the target has the order of the polynomial.
        assert_eq!(judged(&own, "bounded-target"), ("holds".to_owned(), "accepted".to_owned()), "{polynomial}");
    };
    is("[6, 11, 6]", "holds");
    is("[0.1, 0.3, 0.7, 0.2]", "violated");
    is("[0.1, 0.7, 1.3, 0.9]", "holds");
    is("[66, 11, 6]", "violated");
    is("{ integrators = 1, roots_per_s = [1, { real = 0.3, imaginary = 0.7 }] }", "violated");
}

#[test]
fn logs_are_certified_up_to_the_end_of_the_run() {
    let folder = folder();
    let holds = case("logs-holds.csv");
    let accepted = |phases: &str, first_edges: &str| {
        fs::write(folder.path().join("logs-phases.csv"), phases).unwrap();
        fs::write(folder.path().join("logs-holds.csv"), &holds).unwrap();
        let file = folder.path().join("own.toml");
        let text = case("logs.toml").replace("edges = [[\"mass-1\", \"mass-2\"]]", first_edges);
        fs::write(&file, text).unwrap();
        let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
        for id in ["spanning-tree", "dwell-time", "bounded-delays"] {
            let entries = found["entries"].as_array().unwrap();
            let entry = entries.iter().find(|entry| entry["id"] == id).unwrap();
            assert_eq!([&entry["answer"], &entry["outcome"]], ["holds on [0, end]", "accepted"], "{phases}: {entry}");
        }
    };
    let one = "edges = [[\"mass-1\", \"mass-2\"]]";
    accepted(&case("logs-phases.csv"), one);
    // 1.8 − 1.1 is more than 0.7 in floating point.
    accepted("t_s,phase\n0,2\n1.1,1\n1.8,2\n2.6,1\n5,\n", one);
    // One phase, for as long as the table tells.
    accepted("t_s,phase\n0,1\n6,\n", "edges = [[\"mass-1\", \"mass-2\"], [\"mass-2\", \"mass-3\"]]");
}

#[test]
fn lengths_of_planar_arms_are_held_against_the_bounds_of_their_estimates() {
    let bounds = "bounds = { lower_m = [0.5, 0.8], upper_m = [1.3, 1] }\nkinematic_gain = 1 ";
    let text = changed("theorem-6", "kinematic_gain = 1 ", bounds);
    assert_eq!(judged(&text, "lengths-within-bounds"), ("holds".to_owned(), "accepted".to_owned()));
}
