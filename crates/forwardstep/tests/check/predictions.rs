//! What is predicted of a run before it, and what it is said to be of.

use std::fs;

use super::{TWO, json, with};
use crate::support::{folder, forwardstep, stdout};

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
    assert!(text.contains("rate: rightmost characteristic root −1 1/s"), "{text}");
}

#[test]
fn a_run_predicts_unless_that_takes_longer_than_the_run() {
    let folder = with(TWO);
    let said = |arguments: &[&str]| {
        stdout(&forwardstep(&folder, &[&["run", "two.toml", "--force"], arguments].concat()).success())
    };
    let (predicted, left_out) = ("Predicted for robots that follow", "No prediction: ");
    let text = said(&[]);
    assert!(text.contains(predicted) && !text.contains(left_out), "{text}");
    // 2 agents of 2 axes, and 10 horizons of one for the rate: 24 axes.
    let of_length = |end_s: &str| {
        fs::write(folder.path().join("two.toml"), TWO.replacen("end_s = 30", end_s, 1)).unwrap();
    };
    of_length("end_s = 834");
    let text = said(&[]);
    assert!(!text.contains(predicted) && text.contains(left_out), "{text}");
    let text = said(&["--predict"]);
    assert!(text.contains(predicted) && !text.contains(left_out), "{text}");
    of_length("end_s = 833");
    assert!(said(&[]).contains(predicted));
}

/// Estimates that start close to the truth delay a run as well, where K and Γ are small: nothing was said of that.
#[test]
fn regress_estimates_that_start_near_the_truth_are_named_beside_a_settling_time() {
    let folder = folder();
    let text = "format = 2\ntime.end_s = 60\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 2 }\n\
                start.position_m = [[0.0], [1.0]]\n[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\n\
                [law.adaptive]\ndamping.gain = 2\nadaptation_gain = 1\nestimate_start.scaled = SCALED\n[network]\nedges.ring = {}\n";
    for (scaled, part) in [
        ("0.95", "(but estimates start within 5 % of the truth"),
        ("0.5", "(but estimates start far from the truth"),
        ("1.0", "settled to 1 % after"),
    ] {
        fs::write(folder.path().join("own.toml"), text.replace("SCALED", scaled)).unwrap();
        let said = stdout(&forwardstep(&folder, &["check", "own.toml", "--predict"]).code(0));
        assert!(said.contains(part) && said.contains("(but") == (scaled != "1.0"), "{scaled}: {said}");
    }
}

/// Two masses in a ring, with `more` in their file.
fn masses(roots: [&str; 2], more: &str) -> String {
    let mass = |name: &str, at: f64, roots: &str| {
        format!(
            "[[agents]]\nname = \"{name}\"\nrobot.point_mass = {{ dimension = 1, mass_kg = 1 }}\nstart.position_m = [{at}]\n\
             reference.consensus.roots_per_s = {roots}\n"
        )
    };
    format!(
        "format = 2\ntime.end_s = 40\n{}{}[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position_velocity\"\nPUSHED\n\
         [law.known]\ndamping.gain = 8\n[network]\nedges.ring = {{}}\n{more}",
        mass("a", 1.0, roots[0]),
        mass("b", -1.0, roots[1])
    )
}

/// What lasts for a while acts as if it had never been, once it is over.
#[test]
fn regress_delays_that_stay_and_pushes_that_come_to_zero_are_over() {
    let folder = folder();
    let check = |text: &str, status: i32| {
        fs::write(folder.path().join("own.toml"), text.replace("PUSHED", "")).unwrap();
        stdout(&forwardstep(&folder, &["check", "own.toml"]).code(status))
    };
    // Without κ₀ in common nothing is shown over delays that never stop changing.
    let late = |period: &str| {
        let delay = format!("delay.piecewise_constant = {{ times_s = [0, 10], values_s = [0.1, 0.5]{period} }}\n");
        masses(["[4, 1]", "[0.2, 1]"], &delay)
    };
    let (stays, repeats) = (check(&late(""), 0), check(&late(", period_s = 20"), 1));
    assert!(stays.contains("holds: κ₀ is common") && stays.contains("all in all: holds"), "{stays}");
    assert!(!repeats.contains("holds: κ₀ is common"), "{repeats}");
    let pushed = |force: &str| {
        let push = format!("[[external_wrenches]]\non = [\"a\"]\nby.force_n = [\"{force}\"]\n");
        masses(["[1, 2]", "[1, 2]"], &push)
    };
    let (over, lasts) = (check(&pushed("max(0, 1 - t/100)"), 0), check(&pushed("2 + sin(t)"), 1));
    assert!(over.contains("predicted agreement: (") && !over.contains("pushed for ever"), "{over}");
    assert!(lasts.contains("is pushed for ever"), "{lasts}");
}

/// Two that pass each other have not agreed, however near they are at the end.
#[test]
fn regress_nothing_is_said_to_be_reached_in_passing() {
    let folder = folder();
    let push = "[[external_wrenches]]\non = [\"a\"]\nfrom_s = 25\nfor_s = 10\nby.force_n = [8]\n";
    let (mut passed, mut reached) = (false, false);
    for end_s in ["24", "31", "31.5", "32", "38", "38.5", "39", "39.5", "40", "40.5", "41", "41.5", "42", "60"] {
        let text = masses(["[1, 2]", "[1, 2]"], push)
            .replace("PUSHED", "manipulability_gain = 1")
            .replace("end_s = 40", &format!("end_s = {end_s}"));
        fs::write(folder.path().join("own.toml"), text).unwrap();
        let said = stdout(&forwardstep(&folder, &["run", "own.toml", "--force"]));
        let passes = said.contains("only in passing");
        assert!(!(passes && said.contains("at this rate")), "{said}");
        assert!(!(passes && said.contains("reached agreement")), "{said}");
        assert!(
            !(said.contains(" agreed: ") && !said.contains("not agreed") && !said.contains("reached agreement")),
            "{said}"
        );
        (passed, reached) = (passed || passes, reached || said.contains("reached agreement"));
    }
    assert!(passed && reached);
}

/// Who leads is named once, with how far it is off.
#[test]
fn regress_a_leader_is_not_named_again_after_its_distance() {
    let folder = folder();
    let text = stdout(&forwardstep(&folder, &["scenarios", "pilot-ship"]).success());
    fs::write(folder.path().join("own.toml"), text.replace("end_s = 100", "end_s = 3")).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "own.toml"]));
    assert!(said.contains("not following: ") && said.contains("from its target, and"), "{said}");
    assert!(!said.contains(", ("), "{said}");
}

/// Its loop comes back hardly faster than it would go, and what s does to the references is not in the bound: the run has 1.7 times as much.
#[test]
fn regress_the_mean_power_has_no_bound_where_samples_slow_the_loop() {
    let folder = folder();
    let check = |deployed: &str| {
        let agent = |name: &str, mass: &str, at: &str, gain: &str| {
            format!(
                "[[agents]]\nname = \"{name}\"\nrobot.point_mass = {{ dimension = 1, mass_kg = {mass} }}\nstart.position_m = [{at}]\n\
                 law.known.damping.gain = {gain}\n"
            )
        };
        let text = format!(
            "format = 2\ntime.end_s = 101.2\n{}{}[reference.consensus]\nroots_per_s = [0.62, 1.18, 1.17]\nexchange = \"position_velocity\"\n\
             [network]\nedges = [{{ from = \"a\", to = \"b\", weight = 0.35, delay.constant_s = 0.5 }}, \
             {{ from = \"b\", to = \"a\", weight = 1.02, delay.constant_s = 0.1 }}]\n[control]\n{deployed}\n\
             velocity.filtered_difference.cut_off_hz = 1.477\n",
            agent("a", "0.63", "1.43", "1.31"),
            agent("b", "0.62", "1.9", "0.72")
        );
        fs::write(folder.path().join("own.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["check", "own.toml"]))
    };
    let (slow, fast) = (check("sample_hz = 1.9767\ncomputation_delay_s = 0.1952"), check("sample_hz = 100"));
    assert!(slow.contains("marginal: the loop as a whole decays") && !slow.contains("[tracking-power"), "{slow}");
    assert!(fast.contains("[tracking-power"), "{fast}");
}
