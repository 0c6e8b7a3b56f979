//! What is said of runs and designs is so: of those that pass, that are cut off from each other, that nothing moves.

use std::fs;

use crate::support::{folder, forwardstep, stderr, stdout};
use forwardstep::io::scenario::SHIPPED_SCENARIOS;
use serde_json::Value;

/// Point masses on a line, from these places, under a known law.
fn masses(places: &str, count: usize, end_s: &str, reference: &str, network: &str) -> String {
    format!(
        "format = 2\ntitle = \"masses\"\ntime = {{ end_s = {end_s}, record_every_s = 0.01 }}\n[[agents]]\nname = \"m\"\ncount = {count}\n\
         robot.point_mass = {{ dimension = 1, mass_kg = 2 }}\nstart.position_m = {places}\n{reference}\n[law.known]\n[network]\n{network}\n\
         [goal]\ndisagreement_below = 1e-2\n"
    )
}

const SEVEN: &str = "[reference.consensus]\nroots_per_s = [1, 2, 1.5, 3, 2.5, 1.2, 2.2]\nexchange = \"position\"";

/// Two masses that swing through each other were said to have agreed 10.39 s after the start, where they meet, at 0.2 m/s.
#[test]
fn regress_masses_that_pass_each_other_have_not_agreed() {
    let folder = folder();
    let said = |end_s: &str| {
        let text = masses("[[0], [1]]", 2, end_s, SEVEN, "delay.constant_s = 0.2\nedges.ring = {}");
        fs::write(folder.path().join("m.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["run", "m.toml", "--force"]).success())
    };
    let passing = said("10.445");
    assert!(passing.contains("agreement is not reached by 10.445 s; "), "{passing}");
    assert!(passing.contains("not agreed: ") && passing.contains("and so near only in passing"), "{passing}");
    assert!(!passing.contains("settled after") && passing.contains("not yet, predicted not yet"), "{passing}");
    let rested = said("80");
    assert!(rested.contains("agreed: ") && rested.contains("settled to 1 % after 36.6"), "{rested}");
}

/// The last graph has no edge: what has not come together by then never does.
#[test]
fn regress_no_longer_run_is_advised_where_messages_reach_nobody() {
    let folder = folder();
    let network =
        "switching = \"once\"\n[[network.phases]]\ndwell_s = 20\nedges.ring = {}\n[[network.phases]]\nedges = []";
    let reference = "[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"";
    let text = masses("[[0], [1], [3]]", 3, "30", reference, network).replace("1e-2", "1e-3");
    fs::write(folder.path().join("m.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "m.toml"]).code(1));
    assert!(said.contains("violated [spanning-tree]"), "{said}");
    assert!(!said.contains("time.end_s") && !said.contains("s more"), "{said}");
}

/// s is a thousandth of what is left, and γ too small.
#[test]
fn regress_robots_that_follow_their_references_are_not_blamed() {
    let folder = folder();
    let reference = "[leader]\nmotion.sinusoids = [{ offset = 0.3, waves = [{ amplitude = 0.6, rad_per_s = 0.8 }] }]\n[reference.leader]\n\
                     design = \"swarm\"\nroots_per_s = [1, 1]\ncoupling = 2\ngain = 0.1";
    let text = masses("[[0], [1]]", 2, "40", reference, "edges = [[\"leader\", \"m-1\"], [\"m-1\", \"m-2\"]]");
    let text = text.replace("[law.known]", "[law.adaptive]").replace("disagreement_below", "error_below");
    fs::write(folder.path().join("m.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "m.toml"]).code(1));
    assert!(said.contains("violated") && !said.contains("robots do not follow their references"), "{said}");
}

/// A run of one sample, and one in which nothing moves, work with any period.
#[test]
fn regress_no_limit_of_sampling_is_measured_where_nothing_can_be() {
    let folder = folder();
    let reference = "[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"";
    let limit = |places: &str, end_s: &str| {
        let text = masses(places, 2, end_s, reference, "edges.ring = {}") + "[control]\nsample_hz = 100\n";
        fs::write(folder.path().join("m.toml"), text).unwrap();
        let assert = forwardstep(&folder, &["sampling-limit", "m.toml"]);
        (assert.get_output().status.code(), stdout(&assert))
    };
    let (status, short) = limit("[[0], [1]]", "0.01");
    assert!(status == Some(0) && short.contains("measured   at least 1.000 ms; accepted is that |s|"), "{short}");
    assert!(
        short.contains("; 1 run; longer ones were not tried: they would leave a run fewer than ten samples"),
        "{short}"
    );
    let (status, still) = limit("[[1], [1]]", "10");
    assert!(status == Some(1) && still.contains("measured   – ms: nothing has to move"), "{still}");
}

/// A mass that adapts along its target runs away at periods far below those at which the damping alone does.
#[test]
fn regress_the_rule_for_periods_knows_of_adaptation_along_targets() {
    let folder = folder();
    let text = "format = 2\ntitle = \"m\"\ntime.end_s = 40\n[[agents]]\nname = \"m\"\nrobot.point_mass = { dimension = 2, mass_kg = 3 }\n\
                start.position_m = [1, -1]\ntarget.formulas = [\"sin(t)\", \"0.5*cos(0.7*t)\"]\n[reference.tracking]\nroots_per_s = [1, 2]\n\
                [law.adaptive]\n[control]\nsample_hz = 100\n[goal]\nerror_below = 1e-2\n";
    fs::write(folder.path().join("m.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["sampling-limit", "m.toml"]).success());
    let of = |what: &str| -> f64 {
        let line = said.lines().find(|line| line.trim_start().starts_with(what)).unwrap_or_else(|| panic!("{said}"));
        line.split_whitespace().nth(1).and_then(|number| number.parse().ok()).unwrap_or_else(|| panic!("{line}"))
    };
    let (rule, measured) = (of("rule"), of("measured"));
    assert!((0.9..1.1).contains(&(rule / measured)), "{said}");
}

/// What a desired design is, is found whatever root stands first; and it is promised what its name is.
#[test]
fn regress_a_desired_design_is_recognised_whatever_root_is_first() {
    let folder = folder();
    let check = |own: &str, coupling: &str, heard: &str, command: &str| {
        let reference =
            format!("[reference.desired]\npolynomial = {own}\ncoupling_polynomial = {coupling}\nheard = {heard}");
        let network =
            "delay.piecewise_constant = { times_s = [0, 1], values_s = [0.1, 0.4], period_s = 2 }\nedges.ring = {}";
        fs::write(folder.path().join("m.toml"), masses("[[0], [1], [3]]", 3, "20", &reference, network)).unwrap();
        let assert = forwardstep(&folder, &[command, "m.toml"]);
        format!("{}{}", stdout(&assert), stderr(&assert))
    };
    let roots = |roots: &str| format!("{{ integrators = 1, roots_per_s = {roots} }}");
    for first in ["[1, 2]", "[2, 1]"] {
        let said = check(&roots(first), "{ roots_per_s = [1, 2] }", "[2, 1]", "check");
        assert!(said.contains("(a5)") && said.contains("all in all: holds"), "{said}");
        let said = check(&roots(first), "{ roots_per_s = [1, 2] }", "[2, 2]", "check");
        assert!(said.contains("(a5)") && said.contains("all in all: holds"), "{said}");
    }
    let said = check(&roots("[1, 2]"), "{ roots_per_s = [1, 2] }", "[2, 3]", "check");
    assert!(said.contains("by comparison of polynomials") && said.contains("not shown"), "{said}");
    let said = check("[0, 2, 3]", "[2, 3, 1]", "[2]", "check");
    assert!(said.contains("given by coefficients, of which no roots are computed"), "{said}");
    let said = check(&roots("[1, 2]"), "{ roots_per_s = [1, 2] }", "[2]", "smoothness");
    assert!(said.contains("promised: no jump") && !said.contains("promised: nothing"), "{said}");
    // κ₀ is the root that is heard with velocities, wherever it stands.
    let course = |reference: &str| {
        fs::write(folder.path().join("m.toml"), masses("[[0], [1], [3]]", 3, "20", reference, "edges.ring = {}"))
            .unwrap();
        stdout(&forwardstep(&folder, &["run", "m.toml", "--force"]).success());
        let summary = fs::read_to_string(folder.path().join("forwardstep-runs/m/summary.json")).unwrap();
        let summary: Value = serde_json::from_str(&summary).unwrap();
        summary["prediction"]["course"]["found"]["settled_s"].as_f64().unwrap()
    };
    let designed = |roots: &str| {
        course(&format!("[reference.consensus]\nroots_per_s = {roots}\nexchange = \"position_velocity\""))
    };
    let desired = course(
        "[reference.desired]\npolynomial = { integrators = 1, roots_per_s = [1, 3] }\n\
         coupling_polynomial = { roots_per_s = [1, 3] }\nheard = [3, 1]",
    );
    let (first, second) = (designed("[3, 1]"), designed("[1, 3]"));
    assert!((desired - first).abs() < 1e-9 && (first - second).abs() > 0.1, "{desired}, {first}, {second}");
}

/// The factor of a chain in pure feedback is no ψ alone, and no other ψ makes more known of it.
#[test]
fn regress_no_other_psi_is_advised_for_slopes() {
    let folder = folder();
    let text = "format = 2\ntitle = \"p\"\ntime.end_s = 10\n[[agents]]\nname = \"p\"\ncount = 2\nrobot.pure_feedback = { known = [\"x2 + 0.2*x2^3\", \"0\"], \
                regressors = [[\"x1\"], [\"0\"]], parameters = [0.4], psi = \"2 + cos(x1)\" }\nstart.position = [[1], [0]]\n[reference.consensus]\n\
                roots_per_s = [1, 2]\nexchange = \"position\"\n[law.adaptive_backstepping]\n[network]\nedges.ring = {}\n";
    fs::write(folder.path().join("p.toml"), text).unwrap();
    let said = stdout(&forwardstep(&folder, &["check", "p.toml"]));
    assert!(said.contains("it is ψ times the slopes") && said.contains("`robot.strict_feedback` for p-1"), "{said}");
    assert!(!said.contains("cosine"), "{said}");
}

/// Where a curve through points joins rest its third derivative jumps; that its fourth is bounded was said to hold.
#[test]
fn regress_the_fourth_derivative_of_a_curve_through_points_is_not_said_to_be_bounded() {
    let folder = folder();
    fs::write(folder.path().join("points.csv"), "t_s,x\n0,0\n4,1\n8,3\n").unwrap();
    let check = |order: usize, roots: &str| {
        let text = format!(
            "format = 2\ntitle = \"c\"\ntime.end_s = 10\n[[agents]]\nname = \"c\"\nrobot.chain = {{ order = {order}, chi = \"0\", psi = \"1\" }}\n\
             start.position = [0]\ntarget.csv.file = \"points.csv\"\n[reference.tracking]\nroots_per_s = {roots}\n[law.linearising]\n"
        );
        fs::write(folder.path().join("c.toml"), text).unwrap();
        stdout(&forwardstep(&folder, &["check", "c.toml"]))
    };
    let said = check(3, "[1, 2, 3]");
    assert!(said.contains("all in all: holds"), "{said}");
    let said = check(4, "[1, 2, 3, 4]");
    assert!(said.contains("its third derivative jumps, so that the fourth has no bound"), "{said}");
    assert!(said.contains("all in all: not shown (bounded-target)"), "{said}");
}

/// An end-effector that turns about an axis from an attitude of its own has a quaternion of norm 1, which was not shown to stay away from zero.
#[test]
fn regress_the_quaternion_of_a_pose_that_turns_is_known_to_keep_its_norm() {
    let folder = folder();
    let text = SHIPPED_SCENARIOS.iter().find(|scenario| scenario.name == "pose-ur5e").unwrap().text;
    let (before, rest) = text.split_once("target.formulas").unwrap();
    let (_, after) = rest.split_once("[agents.robot.urdf]").unwrap();
    let target = "target.pose = { position = [\"-0.60 + 0.06*cos(0.8*t)\", -0.3, 0.3], attitude = { axis = [1, 0.2, 0], angle_rad = 3 }, \
                  turning = { axis = [0.1, 0, 1], rad_per_s = 0.05 } }\n";
    fs::write(folder.path().join("p.toml"), format!("{before}{target}[agents.robot.urdf]{after}")).unwrap();
    let said = stdout(&forwardstep(&folder, &["check", "p.toml"]));
    assert!(said.contains("all in all: watched during the run"), "{said}");
    assert!(said.contains("holds: the quaternion that arm is to follow is never zero"), "{said}");
}

/// Values that are small, and times, have digits.
#[test]
fn regress_what_is_small_has_digits() {
    let folder = folder();
    let reference = "[reference.consensus]\nroots_per_s = [1000, 2000]\nexchange = \"position\"";
    let text =
        masses("[[0], [1e-6]]", 2, "0.05", reference, "edges.ring = {}").replace("every_s = 0.01", "every_s = 1e-5");
    fs::write(folder.path().join("m.toml"), text.replace("below = 1e-2", "below = 1e-9")).unwrap();
    let said = stdout(&forwardstep(&folder, &["run", "m.toml"]));
    assert!(said.contains("0.000000500"), "{said}");
    let settled = said.lines().find(|line| line.contains("settled to 1 % ")).unwrap();
    assert!(!settled.contains(" 0.00 s"), "{settled}");
    // Rows that are far apart beside steps hide peaks.
    let text = masses("[[0], [1]]", 2, "60", &reference.replace("[1000, 2000]", "[1, 2]"), "edges.ring = {}");
    for (every, coarse) in [("5", true), ("0.01", false)] {
        fs::write(folder.path().join("m.toml"), text.replace("every_s = 0.01", &format!("every_s = {every}"))).unwrap();
        let said = stdout(&forwardstep(&folder, &["run", "m.toml", "--force"]));
        assert_eq!(said.contains("peaks and limits between rows are not seen"), coarse, "{said}");
    }
}

/// What was watched and failed is said to have failed, and who leads is not among those that follow.
#[test]
fn regress_what_failed_in_a_run_is_said_beside_its_hypothesis() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["run", "pilot-ship", "--out", "ship"]).success());
    let words = said.lines().find(|line| line.trim_start().starts_with("in words")).unwrap();
    assert!(
        words.contains("following: ")
            && words.contains(" from pilot (ship-")
            && words.contains("), and pilot 0.0017 m from its target, at most"),
        "{words}"
    );
    let page = fs::read_to_string(folder.path().join("ship/report.html")).unwrap();
    assert!(page.contains("in this run γ was too small until t = 44.36 s"));
    // Of a chain s is another difference than of a robot, and an attitude has no speed.
    forwardstep(&folder, &["run", "strict-feedback", "--out", "chain"]);
    assert!(fs::read_to_string(folder.path().join("chain/report.html")).unwrap().contains("s_i = x_i − z_i</span>"));
    forwardstep(&folder, &["run", "theorem-7", "--out", "craft"]);
    let page = fs::read_to_string(folder.path().join("craft/report.html")).unwrap();
    assert!(
        page.contains("unit quaternions")
            && page.contains("Angular velocity and reference")
            && page.contains("nothing: no agent hears another")
    );
    // What ends a run is named in the table at its end, at the top of the page, and beside its hypothesis.
    let text = "format = 2\ntitle = \"v\"\ntime = { end_s = 10, record_every_s = 0.02 }\n[[agents]]\nname = \"p\"\n\
                robot.chain = { order = 2, chi = \"0\", psi = \"1 - 0.5*x\" }\nstart.position = [0]\n\
                target.formulas = [\"3*(1-cos(0.5*t))\"]\n[reference.tracking]\nroots_per_s = [1, 2]\n[law.linearising]\n";
    fs::write(folder.path().join("v.toml"), text).unwrap();
    let run = forwardstep(&folder, &["run", "v.toml", "--out", "v"]).code(3);
    let said = stdout(&run);
    let verdict = said.lines().find(|line| line.trim_start().starts_with("verdict")).unwrap();
    assert!(verdict.ends_with("watched during the run; [input-factor]: it failed, at t = 2.551 s"), "{verdict}");
    assert!(stderr(&run).contains("choose a target that stays away from there, start elsewhere, or"), "{run}");
    let page = fs::read_to_string(folder.path().join("v/report.html")).unwrap();
    assert!(page.contains("<span class=\"bad\">[input-factor]: it failed, at t = 2.551 s</span>"));
    assert!(page.contains("the smallest in this run was ") && !page.contains(", of p, at t"));
    assert!(page.contains("in this run it failed, at t = 2.551 s") && !page.contains("this run reached its horizon"));
    let compared = stdout(&forwardstep(&folder, &["compare", "v", "craft", "--json"]));
    assert!(compared.contains("watched during the run: input-factor; [input-factor]: it failed, at"), "{compared}");
}

/// The filter of backstepping adds to V what its output is off by, so that nothing balances; of others it does.
#[test]
fn regress_no_balance_is_drawn_of_backstepping() {
    let folder = folder();
    for (scenario, balances) in [("backstepping", false), ("theorem-1", true)] {
        forwardstep(&folder, &["run", scenario, "--out", scenario]).success();
        let file = |name: &str| fs::read_to_string(folder.path().join(scenario).join(name)).unwrap();
        let summary: Value = serde_json::from_str(&file("summary.json")).unwrap();
        assert_eq!(summary["metrics"]["balance_residual"].is_object(), balances, "{scenario}");
        assert_eq!(file("report.html").contains("Lyapunov balance"), balances, "{scenario}");
    }
}

/// Thrusts, rotors and wheels had no peaks, and a run without torques was said to have recorded nothing.
#[test]
fn regress_thrusts_rotors_and_wheels_have_peaks() {
    let folder = folder();
    for (scenario, words, cell) in [
        ("thrust-continuous", "thrust: 17.9 N, vehicle-2 at 3.30 s", "thrust"),
        ("formation", "rotor 1: 6.95 N, right at 0.00 s", "rotor 4"),
        ("theorem-7", "momentum of wheel 2: 2.10 N m s, craft at 3.00 s", "torque of wheel 1"),
    ] {
        let said = stdout(&forwardstep(&folder, &["run", scenario, "--out", scenario]));
        assert!(said.contains(words), "{said}");
        let page = fs::read_to_string(folder.path().join(scenario).join("report.html")).unwrap();
        let (_, loads) = page.split_once("Peaks of thrusts and wheels").unwrap();
        assert!(
            loads.contains(&format!("<th scope=\"col\">{cell}</th>")) && !page.contains("No torques or forces were"),
            "{scenario}"
        );
        // Of rotors and wheels limits are known, so that their share is said.
        let (loads, _) = loads.split_once("</table>").unwrap();
        assert_eq!(loads.contains(" %</span>"), scenario != "thrust-continuous", "{loads}");
        // How near a thrust came to its floor.
        assert_eq!(page.contains("; the smallest in this run was "), scenario != "theorem-7", "{scenario}");
        if scenario == "formation" {
            assert!(page.contains("; the smallest in this run was 8.791 N, of left, at t = "), "{page}");
            // Four, and the largest of a rotor beside the 8 N that it has.
            assert_eq!(loads.matches("<th scope=\"row\"><span class=\"dot").count(), 4, "{loads}");
            assert!(loads.contains(">6.951</span>") && loads.contains(">87 %</span>"), "{loads}");
        }
    }
}

/// Of many predicted torques the largest are in the table, not the first.
#[test]
fn regress_the_largest_predicted_torques_are_on_the_page() {
    let folder = folder();
    let places: Vec<String> = (0..30).map(|k| format!("[{}]", k * k)).collect();
    let reference = "[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"";
    let text = masses(&format!("[{}]", places.join(", ")), 30, "5", reference, "edges.complete = {}");
    fs::write(folder.path().join("m.toml"), text).unwrap();
    forwardstep(&folder, &["run", "m.toml", "--predict"]);
    let page = fs::read_to_string(folder.path().join("forwardstep-runs/m/report.html")).unwrap();
    let (_, table) = page.split_once("predicted with the true parameters along the reference").unwrap();
    let (table, _) = table.split_once("The largest 24 of 30; summary.json has all.").unwrap();
    assert!(table.contains("m-30 ·") && table.contains("m-1 ·") && !table.contains("m-15 ·"), "{table}");
    assert!(table.find("m-1 ·") < table.find("m-30 ·"), "{table}");
}

/// Chains of order ten were called plants of order one, of which references of order ten are an increment.
#[test]
fn regress_the_order_of_a_chain_is_told_and_not_that_of_what_z_leads() {
    let folder = folder();
    let said = stdout(&forwardstep(&folder, &["explain", "strict-feedback-order-10"]).success());
    assert!(
        said.contains(
            "The plant is of order 10 with respect to x, and the reference dynamics are of order 10: the same"
        ),
        "{said}"
    );
}

/// A leader is driven by 4.46 at most, and the first time beyond γ = 4.42 was one at 4.4204: "γ is 4.42, but at t = 52.4 s it is 4.42".
#[test]
fn regress_a_witness_is_clear_where_there_is_one() {
    let folder = folder();
    let text = SHIPPED_SCENARIOS.iter().find(|scenario| scenario.name == "theorem-8").unwrap().text;
    let (before, after) = text.split_once("motion.sinusoids").unwrap();
    let (_, after) = after.split_once("\n]\n").unwrap();
    let swings = format!("{before}motion.formulas = [\"1.46*sin(1.07*t) + 0.4*cos(1.51*t)\", 0]\n{after}")
        .replace("end_s = 40", "end_s = 80")
        .replace("design = \"continuous\"", "design = \"observer\"")
        .replace("roots_per_s = [1.0]", "roots_per_s = [1.68, 2.1]")
        .replace("gain = 2 ", "gain = 4.42 ");
    fs::write(folder.path().join("swings.toml"), swings).unwrap();
    let said = stdout(&forwardstep(&folder, &["check", "swings.toml"]).code(1));
    let (gamma, reached) = said.split_once("γ is ").and_then(|(_, rest)| rest.split_once(", but at")).unwrap();
    assert!(!reached.contains(&format!("it is {gamma}\n")), "{said}");
}

/// Arms that adapt slowly agree long before they rest: 0.006 rad apart and 1.3 rad from where they will be, without a word.
#[test]
fn regress_agreement_that_is_still_on_its_way_is_told_from_the_predicted_one() {
    let folder = folder();
    let arms = |adapts: &str| {
        format!(
            "format = 2\ntime.end_s = 30\n[[agents]]\nname = \"a\"\ncount = 2\nrobot.planar_arm = {{ mass_kg = [1, 0.8], length_m = [1, 0.8] }}\n\
             start.position_rad = [[0.5, 0.2], [-0.4, 0.1]]\n{adapts}[reference.consensus]\nroots_per_s = [1, 2]\nexchange = \"position\"\n\
             [network]\nedges.ring = {{}}\n"
        )
    };
    for (adapts, is_on_its_way) in [
        ("[law.adaptive]\ndamping.gain = 2\nadaptation_gain = 0.2\n", true),
        ("[law.known]\ndamping.gain = 2\n", false),
    ] {
        fs::write(folder.path().join("arms.toml"), arms(adapts)).unwrap();
        let said = stdout(&forwardstep(&folder, &["run", "arms.toml", "--out", "arms", "--force"]));
        let reached = said.lines().find(|line| line.trim_start().starts_with("reached agreement")).unwrap();
        let way = ", on the way to the predicted one while s, still 1.67 rad/s, vanishes";
        assert_eq!(reached.ends_with(way), is_on_its_way, "{reached}");
    }
}

/// Where V(0) is next to nothing, a part of it says nothing: what the balance misses is told in joules.
#[test]
fn regress_a_balance_of_next_to_nothing_is_told_as_it_is() {
    let folder = folder();
    let text = "format = 2\ntime.end_s = 5\n[[agents]]\nname = \"mass\"\ncount = 2\nrobot.point_mass = { dimension = 1, mass_kg = 2 }\n\
                start.position_m = [[0.0], [1.0]]\nstart.reference.z = [[1e-5], [0.0]]\n[reference.consensus]\nroots_per_s = [1, 2]\n\
                exchange = \"position_velocity\"\n[law.known]\ndamping.gain = 5\n[network]\nedges.ring = {}\n";
    fs::write(folder.path().join("own.toml"), text).unwrap();
    forwardstep(&folder, &["run", "own.toml", "--out", "own"]);
    let summary = fs::read_to_string(folder.path().join("own/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let part = summary["metrics"]["balance_residual"]["relative"].as_f64().unwrap();
    let power = (part * 1e-6).log10().floor().to_string();
    let power =
        power.chars().map(|digit| "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit.to_digit(10).map_or(0, |n| n as usize + 1)).unwrap());
    let page = fs::read_to_string(folder.path().join("own/report.html")).unwrap();
    let said = page.split("(0) holds to ").nth(1).unwrap().split(" (worst").next().unwrap();
    let missed = format!(" × 10{} J, where V(0) is 1 × 10⁻¹⁰ J", power.collect::<String>());
    assert!(said.ends_with(&missed), "{said}, and not {missed}");
}
