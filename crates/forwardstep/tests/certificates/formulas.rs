//! Formulas as weights, delays, leaders and pushes: what is claimed of them is shown, and no claim is rejected.

use std::fs;

use serde_json::Value;

use super::{RING, entries_if_read, found_of, judged, masses, outcome_of_pair};
use crate::support::{folder, forwardstep, is_long, some, stdout};

fn accepted(scenario: &str, id: &str, answer: &str) {
    assert_eq!(judged(scenario, id), (answer.to_owned(), "accepted".to_owned()), "{id}: {scenario}");
}

/// The same of several hypotheses that hold.
fn all_hold(scenario: &str, ids: &[&str]) {
    let entries = entries_if_read(scenario).unwrap();
    for id in ids {
        let expected = Some(("holds".to_owned(), "accepted".to_owned()));
        assert_eq!(found_of(&entries, id), expected, "{id}: {scenario}");
    }
}

fn weighed(weight: &str) -> String {
    masses(&format!("weight = \"{weight}\"\ndelay.constant_s = 0.1\n{RING}"))
}

fn delayed(delay: &str) -> String {
    masses(&format!("delay.formula_s = \"{delay}\"\n{RING}"))
}

/// The torque on the first of three masses.
fn pushed(force: &str) -> String {
    let push = format!("[[external_wrenches]]\non = [\"m-1\"]\nby.force_n = [\"{force}\"]\n[network]");
    delayed("0.1").replace("[network]", &push)
}

/// Two masses that follow a leader under (108); `motion` is what stands under its key.
fn led(motion: &str, gain: &str) -> String {
    let text = masses("edges = [[\"leader\", \"m-1\"], [\"m-1\", \"m-2\"], [\"m-2\", \"m-3\"]]");
    let (from, to) = (text.find("[reference").unwrap(), text.find("[network]").unwrap());
    let design = format!("[reference.leader]\ndesign = \"continuous\"\nroots_per_s = [1.0]\ngain = {gain}\n");
    format!("{}[leader]\nmotion.{motion}\n{design}{}", &text[..from], &text[to..])
}

/// What has a limit, or is made of parts that are uniformly continuous, is so itself.
#[test]
fn what_settles_or_is_made_of_steady_parts_is_certified_for_ever() {
    for delay in some(
        [
            "min(sqrt(t), 1)",
            "min(sqrt(t), abs(sin(t)))",
            "0.3*exp(-t^2)",
            "0.3 + 0.1*sin(t)/(1 + t)",
            "t/(1 + abs(t))",
            "abs(1 - t)/(1 + t)",
            "t*exp(-t)",
            "0.2 + 0.1*sin(sqrt(1 + t^2))",
            "0.2 + 0.1*sin(sqrt((sin(t) + t)^2 + 2))",
        ],
        3,
    ) {
        accepted(&delayed(delay), "bounded-delays", "holds");
    }
    let folder = folder();
    let file = folder.path().join("own.toml");
    fs::write(&file, delayed("0.2 + 0.1*sin(sqrt(1 + t^2))")).unwrap();
    for other in ["0.2 + 0.1*sin(sqrt(1 + (t^2)^2))", "0.2 + 0.1*sin(sqrt(1 + t^3))", "0.2 + 0.1*sin(1 + t^2)"] {
        assert_ne!(outcome_of_pair(&file, &delayed(other), "bounded-delays").0, "accepted", "{other}");
    }
    for weight in ["1 + 0.9*tanh(t^2)", "1 + t*exp(-t)", "1 + abs(1 - t)/(1 + t)"] {
        accepted(&weighed(weight), "bounded-weights", "holds");
    }
}

/// One pass of intervals does not know the sign of what begins at zero; the slope does.
#[test]
fn delays_that_begin_at_zero_are_read_and_certified() {
    for delay in [
        "atan(t) + sin(t)",
        "(t + sin(t))/(1 + t)",
        "0.1*t*(1 + 0.5*sin(t))/(1 + t)",
        "0.2 + (2 + cos(t))*(t + 0.5*sin(3*t))/(5 + t)",
    ] {
        accepted(&delayed(delay), "bounded-delays", "holds");
    }
    // Below zero at its end, at once, and between two times at which it is zero.
    for delay in ["sin(t) - t/9", "sin(t) - 2*atan(t)", "sin(3*t)*t/(1 + t)"] {
        assert!(super::judged_if_read(&delayed(delay), "bounded-delays").is_none(), "{delay}");
    }
}

/// What `min`, `max` and `abs` choose for ever has no kink, and what is made of a wave repeats as it does.
#[test]
fn kinks_that_are_none_and_waves_of_waves_are_certified() {
    for motion in ["min(2, 1/(1 + t))", "max(sin(t), 2 + cos(t))", "abs(2 + sin(t))", "sin(sin(t))^2"] {
        let text = led(&format!("formulas = [\"{motion}\"]"), "9");
        all_hold(&text, &["bounded-leader", "sign-gain"]);
    }
    for delay in
        ["0.2 + 0.1*sin(log(2 + abs(t^2)))", "0.2 + 0.1*sin(min(sqrt(1 + t^2), 1.2))", "0.2 + 0.1*abs(sin(sin(t)))"]
    {
        accepted(&delayed(delay), "bounded-delays", "holds");
    }
    // What is chosen in the end swings ever faster, as does the root of a fourth power; a kink that is one leaves no jerk.
    for delay in ["0.2 + 0.1*sin(max(t^2, 1))", "0.2 + 0.1*sin(sqrt(1 + (t^2)^2))"] {
        let (answer, _) = super::judged_if_read(&delayed(delay), "bounded-delays").unwrap();
        assert_ne!(answer, "holds", "{delay}");
    }
    let kink = led("formulas = [\"min(sin(t), 0.5)\"]", "9");
    assert!(super::judged_if_read(&kink, "bounded-leader").is_none_or(|(_, outcome)| outcome != "accepted"), "{kink}");
}

/// Bounds until the last switch are enough for an edge that is there no longer, and what is constant in pieces alone has an enclosure.
#[test]
fn formulas_of_edges_that_are_gone_for_good_are_certified_until_then() {
    let once = |first: &str| {
        let edge = format!("[{{ from = \"m-1\", to = \"m-2\", {first} }}]");
        let phases = format!("[[network.phases]]\ndwell_s = 1\nedges = {edge}\n[[network.phases]]\n{RING}");
        masses(&format!("switching = \"once\"\n{phases}"))
    };
    for weight in ["1 + t", "exp(-t)"] {
        accepted(&once(&format!("weight = \"{weight}\"")), "bounded-weights", "holds");
    }
    for delay in ["t", "t*abs(sin(t))"] {
        accepted(&once(&format!("delay.formula_s = \"{delay}\"")), "bounded-delays", "holds");
    }
    accepted(&weighed("max(0.5, t/(1 + t)^2)"), "bounded-weights", "holds");
    accepted(&delayed("max(0.5, t/(1 + t)^2)"), "bounded-delays", "holds");
}

#[test]
fn delays_that_swing_ever_wider_are_refuted() {
    for delay in ["abs(t*sin(t))", "abs(t*cos(t))", "t*abs(sin(t))"] {
        accepted(&delayed(delay), "bounded-delays", "violated");
    }
}

/// What happens late, and is over soon after.
#[test]
fn a_leader_that_moves_at_another_time_than_the_first_is_certified() {
    for when in ["20", "60", "200"] {
        accepted(&led(&format!("formulas = [\"atan(t - {when})\"]"), "3"), "sign-gain", "holds");
    }
}

/// α and β are products and sums that are rounded; a checker has the roots.
#[test]
fn swarms_are_certified_whatever_their_roots_are() {
    let text = fs::read_to_string(super::file_of("swarm-tracking")).unwrap();
    let with = |coefficients: &str| text.replace("roots_per_s = [1.0, 1.0]", coefficients);
    for roots in ["[1.3, 0.7]", "[1.17, 0.36]", "[1.1, 1.1]", "[0.9, 1.1]"] {
        accepted(&with(&format!("roots_per_s = {roots}")), "swarm-coupling", "holds");
    }
    // κ₀ is irrational, and the limit of two that are equal.
    for coefficients in ["alpha = 1.3\nbeta = 2.4", "alpha = 1.21\nbeta = 2.2"] {
        accepted(&with(coefficients), "swarm-coupling", "holds");
    }
    assert_ne!(judged(&with("alpha = 1.5\nbeta = 2.4"), "swarm-coupling").0, "holds");
}

/// A constant may be irrational: what runs is the double next to it.
#[test]
fn constants_that_are_not_rational_are_certified() {
    for weight in some(["sqrt(2)", "pi", "0.5*pi", "2^0.5", "exp(1)"], 3) {
        accepted(&weighed(weight), "spanning-tree", "holds");
        accepted(&weighed(weight), "agreement", "holds");
    }
    for delay in some(["cos(0.3)", "sqrt(2)/10", "exp(-1)", "0.1 + 0.1*sin((sqrt(2)*sqrt(2))^2)"], 2) {
        accepted(&delayed(delay), "bounded-delays", "holds");
    }
}

/// Roots of quotients of polynomials are bounded by their squares, however they are written and whatever they are divided by.
#[test]
fn leaders_delays_and_weights_with_roots_are_certified_and_refuted() {
    for (motion, gain) in some(
        [
            ("sqrt(1 + t + t^2)", "1.3"),
            ("sqrt(t^2 - 6*t + 11)", "3"),
            ("sqrt(2 + (t - 3)^2)/(1 + t)", "9"),
            ("sqrt(1 + t)*cos(sqrt(1 + t))", "3"),
            ("t/(1 + t + t^2)^0.5", "3"),
            ("sqrt(2 + t)*exp(-t)", "9"),
            ("sqrt((1 + t)/(2 + t))", "2"),
        ],
        3,
    ) {
        let text = led(&format!("formulas = [\"{motion}\"]"), gain);
        all_hold(&text, &["bounded-leader", "sign-gain"]);
    }
    for weight in ["sqrt(2 + (t - 3)^2)/(1 + t)", "1 + t/sqrt(1 + t^2)", "1 + sqrt(1 + t)/(2 + t)"] {
        accepted(&weighed(weight), "bounded-weights", "holds");
    }
    for weight in ["sqrt(1 + t)/(1 + t)", "t/sqrt(1 + t) + 1"] {
        accepted(&weighed(weight), "bounded-weights", "violated");
    }
    for (delay, answer) in some(
        [
            ("sqrt(2 + (t - 3)^2)/(1 + t)", "holds"),
            ("0.2 + 0.1*sin(sqrt(1 + t + t^2))", "holds"),
            ("0.1 + sqrt(1 + t)/(2 + t)*sin(t)^2", "holds"),
            ("2 - t/sqrt(1 + t^2)", "holds"),
            ("t/sqrt(1 + t)", "violated"),
        ],
        2,
    ) {
        accepted(&delayed(delay), "bounded-delays", answer);
    }
}

/// Beyond its last kink it has derivatives, of which one grows.
#[test]
fn leaders_that_grow_beyond_a_kink_are_refuted() {
    for motion in ["abs(t^2 - 3)", "abs(t - 3)*sin(t)", "abs(t - 3)^2", "exp(abs(t/9 - 3))", "max(t^2, 3)"] {
        accepted(&led(&format!("formulas = [\"{motion}\"]"), "9"), "bounded-leader", "violated");
    }
}

#[test]
fn leaders_are_certified_up_to_the_gain_that_they_need() {
    let motions = [
        ("atan(t)", "2"),
        ("atan(2*t)", "5"),
        ("1/(1 + t^2)", "5"),
        ("sin(t)", "1.415"),
        ("t*exp(-t)", "4"),
        ("atan(sin(1.3*t) - t)", "9"),
        // What swings and settles needs no more than what it settles at: √2 of what is multiplied with the sine.
        ("tanh(t/5)*sin(t)", "1.43"),
        ("sin(t)/(1 + 1/(1 + t))", "1.43"),
    ];
    for (motion, gain) in some(motions, 4) {
        let text = led(&format!("formulas = [\"{motion}\"]"), gain);
        all_hold(&text, &["bounded-leader", "sign-gain"]);
    }
    // What has no weight does not count, and factors that belong together stay so.
    for (motion, gain, less) in
        some([("atan(2 + t/20)", "10", "0.005"), ("0.5*tanh(1 - exp(-t)) + cos(t)", "3", "1.2")], 2)
    {
        let scenario = |gain: &str| led(&format!("formulas = [\"{motion}\"]"), gain);
        accepted(&scenario(gain), "sign-gain", "holds");
        let folder = folder();
        let file = folder.path().join("own.toml");
        fs::write(&file, scenario(gain)).unwrap();
        assert_eq!(outcome_of_pair(&file, &scenario(less), "sign-gain").0, "rejected", "{motion}");
    }
    // Of a drive that comes to what it was at the start again, but for rounding, the start is the witness.
    for slope in some(["1", "3", "5", "0.75"], 2) {
        accepted(&led(&format!("formulas = [\"exp(-t) + {slope}*t\"]"), slope), "sign-gain", "violated");
    }
    let waves =
        "sinusoids = [{ waves = [{ amplitude = 1, rad_per_s = 1 }, { amplitude = 1, rad_per_s = 1.41421356 }] }]";
    accepted(&led(waves, "4"), "sign-gain", "holds");
    // It passes long after the run.
    accepted(&led("formulas = [\"tanh(t - 50)\"]", "1.3"), "sign-gain", "violated");
}

#[test]
fn pushes_that_come_to_zero_have_ended() {
    for effort in ["\"max(0, 1 - t)\"", "0"] {
        let text = format!("{}\n[[external_wrenches]]\non = [\"m\"]\nby.effort = [{effort}]\n", masses(RING));
        accepted(&text, "pushes-end", "holds");
    }
}

/// The edges are given in the certificate, and held against the rule.
#[test]
fn random_graphs_are_certified_by_the_edges_that_were_drawn() {
    let text = masses("edges.random = { in_degree = 1, seed = 3 }").replace("count = 3", "count = 5");
    let text = text.replace("[[0.0], [1.0], [2.0]]", "[[0.0], [1.0], [2.0], [3.0], [4.0]]");
    for degree in ["2", "3"] {
        let text = text.replace("in_degree = 1", &format!("in_degree = {degree}"));
        all_hold(&text, &["spanning-tree", "agreement"]);
    }
}

/// A generator of numbers that are the same everywhere.
struct Draws(u64);

impl Draws {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % end as u64) as usize
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }

    fn formula(&mut self, depth: usize) -> String {
        if depth == 0 {
            let leaf = self.of(&[
                "t",
                "0.5",
                "2",
                "1",
                "sin(t)",
                "exp(-t)",
                "t/20",
                "cos(3*t)",
                "0.1",
                "sqrt(2)",
                "sqrt(1 + t)",
                "(t^2 - t + 1)^0.5",
                "sqrt(2 + t)^-1",
            ]);
            return leaf.to_owned();
        }
        let a = self.formula(depth - 1);
        match self.below(9) {
            0 => format!("({a} + {})", self.formula(depth - 1)),
            1 => format!("({a} - {})", self.formula(depth - 1)),
            2 | 3 => format!("({a})*({})", self.formula(depth - 1)),
            4 => format!("({a})/(1 + abs({}))", self.formula(depth - 1)),
            5 => format!("{}({a}, {})", self.of(&["min", "max"]), self.formula(depth - 1)),
            6 => format!("({a})^2"),
            _ => format!("{}({a})", self.of(&["sin", "cos", "tanh", "atan", "abs"])),
        }
    }
}

#[test]
fn torques_that_fade_like_1_over_t_are_certified() {
    let holds = ("holds".to_owned(), "accepted".to_owned());
    for force in some(
        [
            "3*exp(-t)",
            "exp(-0.05*t)*sin(t) + 2/(1 + t)",
            "sin(t)*cos(3*t)/(1 + t^2)",
            "t*exp(-0.3*t)",
            "(1 + sin(t))*exp(-t/4) - cos(t)/(2 + t)",
            "1/(1 + t)*tanh(t)",
            "t/(1 + t^2)",
        ],
        3,
    ) {
        assert_eq!(judged(&pushed(force), "pushes-end"), holds, "{force}");
    }
    for force in ["sin(t)", "1/sqrt(1 + t)", "t/(1 + t)", "1/log(3 + t)", "exp(-t) + 0.001"] {
        assert_eq!(judged(&pushed(force), "pushes-end").0, "not covered by the paper", "{force}");
    }
}

#[test]
fn prop_no_claim_about_drawn_formulas_is_rejected() {
    let mut draws = Draws(1);
    let mut claims = 0;
    let cases = if is_long() { 60 } else { 8 };
    for case in 0..cases {
        let depth = 1 + case % 3;
        let formula = draws.formula(depth);
        let (text, id) = match case % 4 {
            0 => (weighed(&format!("0.6 + 0.5*tanh({formula})")), "bounded-weights"),
            1 => (delayed(&format!("abs({formula})")), "bounded-delays"),
            2 => (delayed(&format!("0.1 + 0.1*sin({formula})")), "bounded-delays"),
            _ => (led(&format!("formulas = [\"{formula}\"]"), "3"), "sign-gain"),
        };
        // What cannot be run is refused on reading.
        if let Some((answer, _)) = super::judged_if_read(&text, id) {
            claims += usize::from(answer == "holds" || answer == "violated");
        }
    }
    assert!(claims > cases / 4, "{claims}");
}

/// Whoever wants a certificate hears from the program itself what it could not prove.
#[test]
fn claims_without_a_proof_are_named() {
    let folder = folder();
    let said = |motion: &str| {
        fs::write(folder.path().join("own.toml"), led(&format!("formulas = [\"{motion}\"]"), "9")).unwrap();
        let printed = stdout(&forwardstep(&folder, &["check", "own.toml", "--certificate", "own.json"]));
        let document: Value = serde_json::from_slice(&fs::read(folder.path().join("own.json")).unwrap()).unwrap();
        let claims = document["hypotheses"].as_array().unwrap().iter().filter(|it| it["answer"] == "holds");
        let bare: Vec<_> = claims.filter(|it| it["proof"].is_null()).map(|it| it["id"].as_str().unwrap()).collect();
        let line = printed.lines().find_map(|line| line.strip_prefix("without a proof in the certificate: "));
        (bare.join(", "), line.map(|line| line.split(';').next().unwrap().to_owned()))
    };
    assert_eq!(said("sin(t)"), (String::new(), None));
    assert_eq!(said("sqrt(1 + t + t^2)"), (String::new(), None));
    let (bare, named) = said("log(2 + t)/(1 + t)");
    assert!(!bare.is_empty());
    assert_eq!(named, Some(bare));
}
