//! `forwardstep falsify`, a minute of it, and `forwardstep attack`.

use std::fs;

use tempfile::TempDir;

use crate::support::{folder, forwardstep, is_long, some, stderr, stdout};

/// A number of the summary.
fn count(said: &str, words: &str) -> u64 {
    let line = said.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{words}\n{said}"));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn nothing_is_refuted_in_a_minute() {
    let folder = folder();
    // A few cases, which are the same on every machine, unless there is time.
    let (arguments, least): (&[&str], u64) = match is_long() {
        true => (&["falsify", "--seconds", "60", "--cases", "2000", "--seed", "7"], 10),
        false => (&["falsify", "--cases", "50", "--seed", "1"], 2),
    };
    let said = stdout(&forwardstep(&folder, arguments).code(0));
    assert_eq!(count(&said, "refuted"), 0, "{said}");
    // Some of each kind were judged.
    assert!(count(&said, "whose spread never grew") > least, "{said}");
    assert!(count(&said, "whose spread shrank at least by what is guaranteed") > least / 2, "{said}");
    assert!(count(&said, "whose error falls") > least, "{said}");
    assert!(count(&said, "that came to the value that is predicted") > 0, "{said}");
    assert!(!folder.path().join("forwardstep-refuted").exists());
}

#[test]
fn the_same_seed_draws_the_same_cases() {
    let folder = folder();
    let said = |seed: &str| stdout(&forwardstep(&folder, &["falsify", "--cases", "10", "--seed", seed]).code(0));
    assert_eq!(said("3"), said("3"));
    assert_ne!(said("3"), said("4"));
    assert!(said("3").starts_with("10 cases of seed 3\n"));
}

#[test]
fn attack_finds_a_network_over_which_a_broken_hypothesis_matters() {
    let folder = folder();
    // With these seeds soon.
    let targets = [
        ("a1-first-roots", "8", "common-first-root"),
        ("24-complex-roots", "1", "real-roots"),
        ("119-weights", "1", "constant-weights"),
        ("110-windows", "3", "leader-in-every-graph"),
        ("110-late-turns", "6", "fixed-graph, no-delay"),
        ("122-turns", "1", "fixed-graph"),
        ("swarm-turns", "28", "fixed-graph, printed-design, swarm-coupling"),
    ];
    for (target, seed, id) in some(targets, 4) {
        // It ends as soon as it has found one: mostly within a minute, on a machine that is busy later.
        let arguments = ["attack", target, "--seed", seed, "--seconds", "300", "--out", "found.toml"];
        let said = stdout(&forwardstep(&folder, &arguments).code(0));
        assert!(said.contains("fails: ") && said.contains(&format!("do not hold for it: {id}\n")), "{target}: {said}");
        // What is saved is a scenario that says the same of itself.
        let accepted = id.split(", ").flat_map(|id| ["--accept", id]);
        let arguments: Vec<&str> = ["check", "found.toml"].into_iter().chain(accepted).collect();
        let check = stdout(&forwardstep(&folder, &arguments).code(0));
        assert!(
            id.split(", ").all(|id| check.contains(&format!("[{id}]")) || check.contains(&format!("[{id}, "))),
            "{check}"
        );
        forwardstep(&folder, &["run", "found.toml", "--out", "run", "--force"]);
        let summary = fs::read_to_string(folder.path().join("run/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let gap = &summary["metrics"]["disagreement"]["measured"];
        let [initial, last] = ["initial", "last"].map(|when| gap[when].as_f64().unwrap());
        assert!(last > 0.05 * initial, "{target}: {last} from {initial}");
        if target == "swarm-turns" {
            each_graph_is_enough(&folder);
        }
    }
}

/// What was found fails since its graphs come in turns: each of them alone holds.
fn each_graph_is_enough(folder: &TempDir) {
    let found: toml::Table = toml::from_str(&fs::read_to_string(folder.path().join("found.toml")).unwrap()).unwrap();
    let phases = found["network"]["phases"].as_array().unwrap();
    assert!(phases.len() > 1, "{found}");
    for phase in phases {
        let mut alone = found.clone();
        let network = alone["network"].as_table_mut().unwrap();
        network.remove("phases");
        network.insert("edges".into(), phase["edges"].clone());
        fs::write(folder.path().join("alone.toml"), alone.to_string()).unwrap();
        // Nothing is against it but that no paper prints it.
        forwardstep(folder, &["check", "alone.toml", "--accept", "printed-design"]).code(0);
    }
}

/// Two masses that hear each other in turns, with these roots.
fn turns(roots: &str, delay: &str) -> String {
    format!(
        "format = 2\n[time]\nend_s = 60\n[[agents]]\nname = \"m\"\ncount = 2\nrobot.point_mass = {{ mass_kg = 2, dimension = 1 }}\n\
         start.position_m = [[0.0], [1.0]]\n[reference.consensus]\nroots_per_s = {roots}\nexchange = \"position\"\n\
         [network]\nweight = 4\ndelay.constant_s = {delay}\n[[network.phases]]\ndwell_s = 0.5\nedges = [[\"m-1\", \"m-2\"]]\n\
         [[network.phases]]\ndwell_s = 2.5\nedges = [[\"m-2\", \"m-1\"]]\n"
    )
}

/// How much is left, of the worst and as stated, in percent.
fn percents(said: &str) -> [f64; 2] {
    let number = |after: &str| {
        let number = said.split(after).nth(1).unwrap().split(" %").next().unwrap().replace('−', "-");
        // `2.038 × 10⁻⁶` as a program reads it.
        let power = |superscript: &str| -> String {
            let plain = |letter| {
                "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|known| known == letter).and_then(|at| "-0123456789".chars().nth(at))
            };
            superscript.chars().filter_map(plain).collect()
        };
        match number.split_once(" × 10") {
            Some((digits, exponent)) => format!("{digits}e{}", power(exponent)).parse().unwrap(),
            None => number.parse().unwrap(),
        }
    };
    [number(if said.contains("grows: ") { "grows: " } else { "worst: " }), number("as stated it is ")]
}

#[test]
fn attack_varies_a_scenario_within_the_delays_and_dwell_times_that_it_states() {
    let folder = folder();
    fs::write(folder.path().join("own.toml"), turns("[1.0, 2.0]", "0.4")).unwrap();
    let arguments = ["attack", "own.toml", "--seconds", "3", "--pieces", "4", "--out", "found.toml"];
    let said = stdout(&forwardstep(&folder, &arguments).code(0));
    assert!(
        said.contains("of the interval of all cascaded variables") && said.contains("do not hold for it: none\n"),
        "{said}"
    );
    let [worst, stated] = percents(&said);
    assert!(worst > 1.5 * stated && worst < 100.0, "{said}");
    // What is saved is the same scenario with a network inside the stated bounds, and is as bad.
    let text = fs::read_to_string(folder.path().join("found.toml")).unwrap();
    let found: toml::Table = toml::from_str(&text).unwrap();
    let numbers =
        |list: &toml::Value| -> Vec<f64> { list.as_array().unwrap().iter().map(|x| x.as_float().unwrap()).collect() };
    let network = &found["network"];
    let delays = network["delay"].get("piecewise_constant").map_or_else(
        || vec![network["delay"]["constant_s"].as_float().unwrap()],
        |pieces| numbers(&pieces["values_s"]),
    );
    assert!(delays.iter().all(|delay_s| (0.0..=0.4).contains(delay_s)), "{text}");
    let phases = network["phases"].as_array().unwrap();
    assert!((2..=4).contains(&phases.len()), "{text}");
    for phase in phases {
        assert!((0.5..=2.5).contains(&phase["dwell_s"].as_float().unwrap()), "{text}");
    }
    let again = ["attack", "found.toml", "--seconds", "0.2", "--out", "again.toml"];
    let [_, as_saved] = percents(&stdout(&forwardstep(&folder, &again).code(0)));
    assert!((as_saved / worst - 1.0).abs() < 1e-2, "{as_saved} {worst}");
}

#[test]
fn attack_finds_where_a_scenario_outside_of_its_theorem_grows() {
    let folder = folder();
    let text = turns("[{ real = 0.5, imaginary = 4.0 }]", "0");
    fs::write(folder.path().join("own.toml"), &text).unwrap();
    let arguments = ["attack", "own.toml", "--seconds", "60", "--out", "found.toml"];
    let said = stdout(&forwardstep(&folder, &arguments).code(0));
    assert!(said.contains("grows: ") && said.contains("do not hold for it: real-roots\n"), "{said}");
    assert!(percents(&said)[0] > 1000.0, "{said}");
    forwardstep(&folder, &["check", "found.toml", "--accept", "real-roots"]).code(0);
}

#[test]
fn attack_says_why_a_scenario_cannot_be_attacked() {
    let folder = folder();
    let fixed = turns("[1.0, 2.0]", "0").split("[[network.phases]]").next().unwrap().to_owned();
    fs::write(folder.path().join("fixed.toml"), format!("{fixed}edges = [[\"m-1\", \"m-2\"]]\n")).unwrap();
    let same = turns("[1.0, 2.0]", "0.4").replace("[[0.0], [1.0]]", "[[1.0], [1.0]]");
    fs::write(folder.path().join("same.toml"), same).unwrap();
    for (scenario, reason) in [
        ("theorem-8", "everybody follows a leader"),
        ("through-waypoints", "agents follow targets"),
        ("fixed.toml", "it leaves nothing open"),
        // A table says when its graphs change.
        ("replayed-draws", "it leaves nothing open"),
        ("same.toml", "agents start together"),
        ("nowhere.toml", "cannot read"),
        ("a2", "there is no scenario `a2`"),
        ("a1-first-root", "designs that come with `attack`: a1, 24, a1-first-roots, "),
    ] {
        let failed = forwardstep(&folder, &["attack", scenario, "--seconds", "1"]).code(2);
        let said = String::from_utf8(failed.get_output().stderr.clone()).unwrap();
        assert!(said.contains(reason), "{scenario}: {said}");
    }
}

#[test]
fn attack_inside_a_theorem_finds_nothing_that_grows() {
    let folder = folder();
    let seconds = if is_long() { "10" } else { "1.5" };
    for target in ["a1", "24"] {
        let said =
            stdout(&forwardstep(&folder, &["attack", target, "--seconds", seconds, "--out", "found.toml"]).code(0));
        let percent = said.split("worst: ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
        let percent: f64 = percent.parse().unwrap_or_else(|_| panic!("{said}"));
        assert!(percent > 0.0 && percent < 100.0 && said.contains("do not hold for it: none\n"), "{said}");
    }
    forwardstep(&folder, &["attack", "a1", "--seconds", "1", "--out", "no/such/folder.toml"]).code(2);
}

#[test]
fn regress_a_place_that_takes_no_file_is_refused_before_the_search() {
    let folder = folder();
    fs::write(folder.path().join("file"), "mine").unwrap();
    for out in ["file", "file/below"] {
        let said = stderr(&forwardstep(&folder, &["falsify", "--cases", "1", "--out", out]).code(2));
        assert!(said.contains("`file` is no folder"), "{said}");
    }
    // Nobody writes there, whoever runs this.
    #[cfg(target_os = "linux")]
    for out in ["/proc/self/fdinfo", "/proc/self/fdinfo/below"] {
        let said = stderr(&forwardstep(&folder, &["falsify", "--cases", "1", "--out", out]).code(2));
        assert!(said.contains("cannot be written to: ") && said.contains("name another folder"), "{said}");
    }
    // What is not needed is not made.
    forwardstep(&folder, &["falsify", "--cases", "1", "--out", "made/too"]).code(0);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
