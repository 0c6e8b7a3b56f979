//! Certificates about robots, what acts at their joints, and where they are to go.

use std::fs;
use std::path::Path;

use super::{certified, changed, file_of, judged, outcome_beside, python, root};
use crate::support::folder;

#[test]
fn only_an_uncertain_tool_is_certified_to_stay_out_of_the_regressor() {
    let tool = (
        "end_effector = { link = \"tool0\", at_m = [0, 0, 0.15] }",
        "end_effector = { link = \"tool0\", at_m = [0, 0, 0.15], uncertain = \"chain\" }",
    );
    let text = changed("task-space-ur5e", tool.0, tool.1);
    assert_eq!(outcome_beside("task-space-ur5e", &text, "certain-regressor").0, "rejected");
    let same = changed("task-space-ur5e", "at_m = [0, 0, 0.15]", "at_m = [0, 0, 0.25]");
    assert_eq!(outcome_beside("task-space-ur5e", &same, "certain-regressor").0, "accepted");
}

#[test]
fn friction_and_bounds_are_certified_by_the_text() {
    let case = |name: &str| fs::read_to_string(root().join(format!("checker/cases/{name}.toml"))).unwrap();
    let is = |text: &str, id: &str, answer: &str, outcome: &str| {
        assert_eq!(judged(text, id), (answer.to_owned(), outcome.to_owned()), "{id}: {text}");
    };
    let rubbing = case("friction");
    is(&rubbing, "smooth-friction", "holds", "accepted");
    is(&rubbing, "parameters-within-bounds", "holds", "accepted");
    // Of dry friction nothing is claimed, and of what does not rub nothing is asked for: else something would be left out.
    is(
        &rubbing.replace("friction.smooth", "friction.dry"),
        "smooth-friction",
        "not covered by the paper",
        "could not check",
    );
    is(
        &rubbing.replace("coulomb = [2, 2, 2, 0.5, 0.5, 0.5]", "coulomb = 0"),
        "parameters-within-bounds",
        "holds",
        "accepted",
    );
    let given = case("bounds");
    is(&given, "parameters-within-bounds", "holds", "accepted");
    let outside = given.replace("lower = [2]", "lower = [2.25]");
    is(&outside, "parameters-within-bounds", "violated", "accepted");
}

#[test]
fn robots_in_closed_form_with_drives_are_certified_by_the_text() {
    let is = |robot: &str, id: &str, answer: &str, outcome: &str| {
        let text = fs::read_to_string(root().join("checker/cases/friction.toml")).unwrap();
        let (head, rest) = text.split_once("robot.urdf").unwrap();
        let rest = rest.split_once("\n\n").unwrap().1;
        let text = format!("{head}robot.{robot}\nstart.position = [[0, 0], [0.2, 0.1]]\n\n{rest}");
        assert_eq!(judged(&text, id), (answer.to_owned(), outcome.to_owned()), "{id}: {text}");
    };
    let arm = "planar_arm = { mass_kg = [2, 1], length_m = [1, 0.8], damping = 0.1, armature = [0.2, 0], friction.smooth = { coulomb = [0.5, 0] } }";
    let mass = "point_mass = { dimension = 2, mass_kg = 2, damping = [0, 1], friction.smooth = { coulomb = 0.5 } }";
    for robot in [arm, mass] {
        for id in
            ["uniform-inertia", "bounded-dynamics", "smooth-friction", "parameters-within-bounds", "positive-gains"]
        {
            is(robot, id, "holds", "accepted");
        }
        is(&robot.replace("smooth", "dry"), "smooth-friction", "not covered by the paper", "could not check");
        is(&robot.replace("smooth", "dry"), "uniform-inertia", "holds", "accepted");
    }
}

/// Targets, leaders and attitudes along curves through points, and tips of trees.
#[test]
fn curves_through_points_and_tips_of_trees_are_enclosed() {
    let is = |(name, old, new): (&str, &str, &str), id: &str, answer: &str| {
        assert_eq!(judged(&changed(name, old, new), id), (answer.to_owned(), "accepted".to_owned()), "{name}: {new}");
    };
    // What drives the followers reaches 0.403.
    is(("remark-12", "gain = 2 ", "gain = 0.41 "), "sign-gain", "holds");
    is(("remark-12", "gain = 2 ", "gain = 0.4 "), "sign-gain", "violated");
    is(("rest-to-rest", "[0, 0, 0, 1]", "[0, 0, 0, 0.5]"), "nonzero-quaternion", "holds");
    is(("task-space-ur5e", "-0.60 + 0.08", "-1.60 + 0.08"), "target-within-reach", "violated");
    is(("task-space-ur5e", "\"tool0\",", "\"wrist_1_link\","), "target-within-reach", "holds");
    let arm = fs::read_to_string(file_of("theorem-6")).unwrap();
    let from = arm.find("target.formulas").unwrap();
    let to = from + arm[from..].find('\n').unwrap();
    let moved = format!(
        "{}target.points = {{ times_s = [1.5, 3, 7], positions = [[0.8, 0.2], [0.5, 0.4], [0.9, -0.3]] }}\n{}",
        &arm[..from],
        &arm[to..]
    );
    assert_eq!(judged(&moved, "target-within-reach"), ("holds".to_owned(), "accepted".to_owned()), "{moved}");
}

/// Beside the certificate of the shipped scenario: without one or two entries the norm is another, and without three it vanishes at t = 0.
#[test]
fn a_norm_that_is_no_longer_what_was_shown_is_rejected() {
    let folder = folder();
    let certificate = certified(file_of("tumbling-target").to_str().unwrap(), folder.path());
    let file = folder.path().join("tumbling-target.toml");
    let entries = ["\"sin(0.125*t)\"", "\"cos(0.125*t)\"", "\"0.2553419*cos(0.075*t)\""];
    let mut text = fs::read_to_string(file_of("tumbling-target")).unwrap();
    for entry in entries {
        assert!(text.contains(entry));
        text = text.replace(entry, "\"0\"");
        fs::write(&file, &text).unwrap();
        let files = [certificate.to_str().unwrap(), file.to_str().unwrap()];
        let output = python(&[&["forwardstep_checker.py", "--ignore-digests"], &files[..]].concat(), Path::new(""));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.code() == Some(1) && said.contains("rejected: nonzero-quaternion"), "{entry}: {said}");
    }
}
