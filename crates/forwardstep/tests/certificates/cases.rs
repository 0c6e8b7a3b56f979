//! Certificates of the cases beside the checker: desired dynamics by coefficients, and networks that were logged.

use std::fs;
use std::path::Path;

use super::{certified, changed, checked, judged, judged_if_read, python, root};
use crate::support::folder;

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

/// A bias is not a claim, and no certificate of a vehicle without one is one of a vehicle with it.
#[test]
fn accelerometers_without_a_bias_are_certified() {
    let text = case("by-acceleration.toml");
    for id in ["unbiased-acceleration", "thrust-gains", "parameters-within-bounds"] {
        assert_eq!(judged(&text, id), ("holds".to_owned(), "accepted".to_owned()), "{id}");
    }
    let biased = text.replace("[0, 0.0, 0]", "[0, 0.0, 0.01]");
    let (answer, verdict) = judged(&biased, "unbiased-acceleration");
    assert_eq!([answer.as_str(), verdict.as_str()], ["not covered by the paper", "could not check"]);
    let wrong = text.replace("adaptation_gain = 0.2", "adaptation_gain = 0").replace(", bounds.within = 0.4", "");
    assert_ne!(judged(&wrong, "thrust-gains").0, "holds");

    let folder = folder();
    let [own, other] = ["own.toml", "other.toml"].map(|name| folder.path().join(name));
    fs::write(&own, &text).unwrap();
    fs::write(&other, &biased).unwrap();
    let certificate = certified(own.to_str().unwrap(), folder.path());
    let files = [&certificate, &other].map(|file| file.to_str().unwrap());
    let output = python(&["forwardstep_checker.py", files[0], files[1], "--ignore-digests"], Path::new(""));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("rejected: unbiased-acceleration") && !output.status.success(), "{said}");
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

#[test]
fn regress_delays_that_never_change_are_constant_however_they_are_written() {
    let text = |values: &str| {
        format!(
            "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"m\"\nrobot.point_mass = {{ mass_kg = 2, dimension = 1 }}\n\
             reference.consensus.roots_per_s = [4.0, 5.0]\nstart.position_m = [0.0]\n[[agents]]\nname = \"n\"\n\
             robot.point_mass = {{ mass_kg = 2, dimension = 1 }}\nreference.consensus.roots_per_s = [0.2, 1.0]\n\
             start.position_m = [1.0]\n[reference.consensus]\nexchange = \"position_velocity\"\n[network]\n\
             delay.piecewise_constant = {{ times_s = [0, 1], values_s = {values}, period_s = 2 }}\n\
             edges = [[\"m\", \"n\"], [\"n\", \"m\"]]\n"
        )
    };
    let is = |values: &str| judged(&text(values), "common-first-root");
    assert_eq!(is("[0.2, 0.2]"), ("holds".to_owned(), "accepted".to_owned()));
    // Doubles that programs print with seventeen digits.
    assert_eq!(judged(&text("[0.30000000000000004, 0.29999999999999999]"), "bounded-delays").1, "accepted");
    assert_eq!(is("[0.2, 0.3]").0, "not covered by the paper");
    let piecewise = "delay.piecewise_constant = { times_s = [0, 1], values_s = [0.2, 0.2], period_s = 2 }";
    let formula = |formula: &str| {
        let text = text("[0.2, 0.2]").replace(piecewise, &format!("delay.formula_s = \"{formula}\""));
        judged(&text, "common-first-root")
    };
    for stays in ["0.3 + 0*t", "(3*t - t - 2*t)*0 + 0.1 + 0.1", "0.3"] {
        assert_eq!(formula(stays), ("holds".to_owned(), "accepted".to_owned()), "{stays}");
    }
    assert_eq!(formula("0.3 + 1e-9*sin(t)").0, "not covered by the paper");
}

#[test]
fn regress_a_polynomial_is_its_roots_in_whatever_order() {
    let beside = |roots: &str, id: &str| {
        let coupling = format!("coupling_polynomial = {{ roots_per_s = {roots} }}");
        judged_if_read(&changed("desired-dynamics", "coupling_polynomial = { roots_per_s = [1, 2] }", &coupling), id)
    };
    for same in ["[1, 2]", "[2, 1]"] {
        assert_eq!(beside(same, "real-roots"), Some(("holds".to_owned(), "accepted".to_owned())), "{same}");
    }
    let none = beside("[2, 1], integrators = 0", "real-roots");
    assert_eq!(none, Some(("holds".to_owned(), "accepted".to_owned())));
    for other in ["[2, 2]", "[1, 3]", "[2]"] {
        assert_eq!(beside(other, "real-roots"), None, "{other}");
        assert_eq!(beside(other, "desired-dynamics").unwrap().0, "not shown", "{other}");
    }
}

#[test]
fn regress_a_link_with_an_inertia_that_no_body_has_is_not_certified_by_the_text() {
    let folder = folder();
    let link = |name: &str, ixx: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"1\"/>\
             <inertia ixx=\"{ixx}\" iyy=\"0.1\" izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"1 0 0\"/>\
             <axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"5\"/></joint>"
        )
    };
    for (ixx, expected) in [("0.1", "accepted"), ("-0.05", "could not check")] {
        let urdf = format!(
            "<robot name=\"r\"><link name=\"base\"/>{}{}{}{}</robot>",
            link("one", "0.1"),
            link("two", ixx),
            joint("a", "base", "one"),
            joint("b", "one", "two")
        );
        fs::write(folder.path().join("arm.urdf"), urdf).unwrap();
        let file = folder.path().join("own.toml");
        let text = "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.urdf.file = \"arm.urdf\"\n\
                    start.position_rad = [[0.1, 0.2], [0.3, 0.4]]\n[reference.consensus]\nroots_per_s = [1.0, 2.0]\n\
                    exchange = \"position_velocity\"\n[network]\nedges = [[\"m-1\", \"m-2\"]]\n";
        fs::write(&file, text).unwrap();
        let found = checked(&certified(file.to_str().unwrap(), folder.path()), &file);
        let entries = found["entries"].as_array().unwrap();
        let entry = entries.iter().find(|entry| entry["id"] == "uniform-inertia").unwrap();
        // It turns about the second axis alone, so that M is positive definite all the same.
        assert_eq!([&entry["answer"], &entry["outcome"]], ["holds", expected], "{ixx}: {entry}");
    }
}

#[test]
fn regress_bounds_of_an_estimated_mass_are_asked_for_where_a_thrust_carries_it() {
    let bounded = |bounds: &str| {
        changed("theorem-5", "estimate_start_kg = 1.2", &format!("estimate_start_kg = 1.2, bounds.{bounds}"))
    };
    assert_eq!(
        judged(&bounded("within = 0.6"), "parameters-within-bounds"),
        ("holds".to_owned(), "accepted".to_owned())
    );
    // Masses that vary are drawn, and not computed by the checker.
    let outside = bounded("given = { lower = [0.1], upper = [1.0] }");
    assert_eq!(judged(&outside, "parameters-within-bounds").0, "violated");
    assert_eq!(judged(&outside, "thrust-gains").1, "accepted");
}
