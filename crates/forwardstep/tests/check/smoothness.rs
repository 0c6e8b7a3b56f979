//! `smoothness`: the tables and figures of SMOOTHNESS.md, and what is said in words.

use std::fs;
use std::path::Path;

use forwardstep::io::output::{SMOOTHNESS_FORMAT, SmoothnessDocument, SmoothnessFound};

use crate::support::{folder, forwardstep, stderr, stdout};

fn page() -> String {
    fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../SMOOTHNESS.md")).unwrap()
}

/// Rows of tables, cell by cell.
fn rows(text: &str) -> Vec<Vec<String>> {
    let rows = text.lines().filter(|line| line.starts_with("| "));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

#[test]
fn val_the_tables_and_figures_of_smoothness_are_what_runs_say() {
    let (page, here) = (page(), folder());
    let mut printed = String::new();
    let commands = page.lines().filter_map(|line| line.strip_prefix("    forwardstep "));
    for command in commands {
        let mut arguments: Vec<&str> = command.split(' ').collect();
        let drawn = arguments.iter().position(|argument| *argument == "--plot").map(|at| arguments[at + 1]);
        arguments.iter_mut().filter(|argument| Some(**argument) == drawn).for_each(|argument| *argument = "new.svg");
        printed += &stdout(&forwardstep(&here, &arguments).success());
        if let Some(drawn) = drawn {
            let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(drawn);
            let [committed, new] =
                [committed, here.path().join("new.svg")].map(|path| fs::read_to_string(path).unwrap());
            assert!(committed == new, "{drawn} is another now");
        }
    }
    assert_eq!(rows(&page), rows(&printed), "the tables are now\n{printed}");
}

#[test]
fn thm3_the_table_of_smoothness_keeps_what_is_promised() {
    let rows = rows(&page());
    let of = |columns: usize| rows.iter().filter(move |row| row.len() == columns && row[0] != "Scenario");
    let number = |cell: &str| cell.replace('−', "-").split(' ').next().unwrap().parse::<f64>().unwrap();
    let derivatives = ["τ", "dτ/dt", "d²τ/dt²", "d³τ/dt³"];
    let below = of(8).filter(|row| row[7] == "no jump").count();
    assert!(below >= 10 && of(8).filter(|row| row[7] == "no jump").all(|row| row[3] == "0"), "{rows:?}");
    for row in of(8).filter(|row| row[7] == "bounded") {
        // A chain of order k has k − 2 less, and they differ in strict-feedback; the angular velocity of a vehicle has one less.
        let order: Option<usize> = row[1].parse().ok();
        let torque = order.is_none_or(|order| row[2] == derivatives[order - 1]);
        let turns = order
            .filter(|order| *order > 1)
            .is_some_and(|order| ["ω", "dω/dt"].get(order - 2) == Some(&row[2].as_str()));
        let thrust = order
            .filter(|order| *order > 1)
            .is_some_and(|order| ["dσ/dt", "d²σ/dt²"].get(order - 2) == Some(&row[2].as_str()));
        assert!((torque || turns || thrust) && number(&row[3]) > 0.0, "{row:?}");
    }
    // Smoother and slower.
    let orders: Vec<&Vec<String>> = of(7).collect();
    assert_eq!(orders.len(), 4);
    assert!(orders.windows(2).all(|pair| number(&pair[1][2]) > 1.2 * number(&pair[0][2])), "{orders:?}");
    assert!(orders.iter().zip(derivatives).all(|(row, derivative)| row[3] == derivative), "{orders:?}");
    // The baseline: slope −1.
    let filters: Vec<&Vec<String>> = of(6).collect();
    let slope = number(&filters.last().unwrap()[5]);
    assert!(filters.len() == 6 && (slope + 1.0).abs() < 0.04, "{filters:?}");
    let products = filters.iter().rev().take(3).map(|row| number(&row[1]) * number(&row[2]));
    assert!(products.clone().fold(0.0, f64::max) < 1.05 * products.fold(f64::MAX, f64::min), "{filters:?}");
}

#[test]
fn smoothness_says_in_words_what_jumps_and_why_it_cannot_say() {
    let here = folder();
    let said = |arguments: &[&str]| stdout(&forwardstep(&here, &[&["smoothness"], arguments].concat()).success());
    let of_three = said(&["theorem-3-a5-order-3"]);
    assert!(of_three.contains("\n  dτ/dt    does not jump; promised: no jump\n  d²τ/dt²  jumps by "), "{of_three}");
    assert!(of_three.contains("79 switches, and 80 other instants at which a delay may jump"), "{of_three}");
    let mixed = said(&["mixed-network"]);
    let vehicles = "\n  ω of vehicle-1, vehicle-2, loaded-vehicle:\n  ω        does not jump; promised: no jump\n  dω/dt    jumps by ";
    assert!(mixed.contains(vehicles) && mixed.contains(" rad/s² at most: "), "{mixed}");
    let fixed = said(&["first-order"]);
    assert!(fixed.contains("\n  τ        nothing that enters it jumps; promised: bounded\n"), "{fixed}");
    let ordered = said(&["first-order", "--orders", "1,8"]);
    assert!(ordered.contains("order 8: not settled; nothing that is heard jumps"), "{ordered}");
    let filtered = said(&["backstepping", "--filters", "0.01,0.003"]);
    assert!(filtered.contains("  ε = 0.01 s: τ jumps by 505 N m at most (arm-1, shoulder, 1.00 s)\n"), "{filtered}");
    assert!(filtered.contains("slope of the jump over ε in a log-log plot: −0.9"), "{filtered}");
    for (arguments, why) in [
        (&["theorem-8"][..], "has a set-valued sign"),
        (&["six-arms-over-radio"], "the controllers sample"),
        (&["without-velocity"], "it follows a target of its own, and no switch and no delay reaches its input"),
        (&["immersion-and-invariance", "--orders", "2"], "but not pendulum-1: its law is immersion and invariance"),
        (&["theorem-2", "--json", "--table"], "cannot be used with"),
        (&["first-order", "--filters", "0.1,0.2"], "nothing that is heard jumps"),
        (&["theorem-2", "--filters", "0.1"], "at least two different filters"),
        (&["theorem-2", "--filters", "0"], "must be a number above 0"),
        (&["theorem-2", "--orders", "9"], "must be a whole number from 1 to 8"),
        (&["theorem-2", "--orders", "1", "--filters", "1"], "cannot be used with"),
        (&["theorem-2", "--plot", "x.svg"], "required arguments were not provided"),
        (&["backstepping", "--orders", "1"], "has no order to change"),
        (&["theorem-2", "--orders", "1", "--plot", "no/such/folder.svg"], "there is no folder `no/such`"),
    ] {
        let complaint = stderr(&forwardstep(&here, &[&["smoothness"], arguments].concat()).code(2));
        assert!(complaint.split_whitespace().collect::<Vec<_>>().join(" ").contains(why), "{complaint}");
    }
}

#[test]
fn smoothness_as_json_is_what_its_schema_describes() {
    let here = folder();
    let said =
        |arguments: &[&str]| stdout(&forwardstep(&here, &[&["smoothness", "--json"], arguments].concat()).success());
    for arguments in [&["theorem-2", "thrust-continuous", "first-order"][..], &["theorem-2", "--orders", "1,2"]] {
        let document: SmoothnessDocument = serde_json::from_str(&said(arguments)).unwrap();
        assert_eq!(document.format, SMOOTHNESS_FORMAT);
        for scenario in &document.scenarios {
            let (inputs, orders) = match &scenario.found {
                SmoothnessFound::AsItIs { inputs, .. } => (inputs.len(), 0),
                SmoothnessFound::Orders(orders) => (0, orders.len()),
                SmoothnessFound::Filters { .. } => (0, 0),
            };
            let expected = match (scenario.name.as_str(), arguments.contains(&"--orders")) {
                ("thrust-continuous", false) => (2, 0),
                (_, false) => (1, 0),
                (_, true) => (0, 2),
            };
            assert_eq!((inputs, orders), expected, "{}", scenario.name);
        }
        let SmoothnessFound::AsItIs { kept, inputs, .. } = &document.scenarios[0].found else { continue };
        let last = inputs[0].derivatives[1].as_ref().unwrap();
        assert!(*kept && inputs[0].continuous == Some(1) && inputs[0].derivatives[0].as_ref().unwrap().jump == 0.0);
        assert_eq!((last.unit.as_str(), last.agent.as_str(), last.switched), ("N m", "arm-2", true));
    }
    let schema: serde_json::Value =
        serde_json::from_str(&stdout(&forwardstep(&here, &["schema", "smoothness"]).success())).unwrap();
    assert_eq!(schema["title"], "forwardstep smoothness");
    let described: Vec<&String> = schema["properties"].as_object().unwrap().keys().collect();
    let document: serde_json::Value = serde_json::from_str(&said(&["first-order"])).unwrap();
    assert!(document.as_object().unwrap().keys().all(|key| described.contains(&key)), "{described:?}");
}
