//! What is said of sampling before a run, beside the table of SAMPLING.md and beside runs.

use std::fs;

use crate::support::{folder, forwardstep, some, stdout};
use forwardstep::check::{SamplingMargin, WholeLoop};
use forwardstep::io::output::Deployment;
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario, shipped_scenario};

/// The table of SAMPLING.md, row by row.
fn rows() -> Vec<Vec<String>> {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../SAMPLING.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| Scenario"));
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

#[test]
fn val_the_rules_of_the_sampling_table_are_those_of_the_scenarios() {
    let rows = rows();
    assert_eq!(rows.len(), 23);
    for row in some(&rows, 4) {
        let [name, late, velocity, rule, measured, ratio] = &row[..] else { panic!("{row:?}") };
        let deployment = Deployment {
            late: late.strip_suffix(" h").map(|late| late.parse().unwrap()),
            filter_hz: velocity.strip_prefix("filtered at ").map(|hz| hz.trim_end_matches(" Hz").parse().unwrap()),
        };
        let setup = open_scenario(name).unwrap().setup;
        let found = deployment.rule(&setup).unwrap();
        let [rule, measured, ratio] = [rule, measured, ratio].map(|cell| cell.parse::<f64>().unwrap());
        assert!((1e3 * found.period_s / rule - 1.0).abs() < 0.005, "{row:?}: {found:?}");
        // What is learnt under way, of friction above all, is far on the safe side.
        let least = match &name[..] {
            "six-arms-with-friction" => 0.39,
            "five-ships" => 0.74,
            _ => 0.8,
        };
        assert!((rule / measured - ratio).abs() < 0.01 && ratio > least && ratio < 1.07, "{row:?}");
        // What is said of that very deployment there.
        let at = |share: f64| deployment.apply(&setup, share * found.period_s);
        if found.linearised {
            let grows = |share: f64| WholeLoop::of(&at(share)).unwrap().lasting_per_s().is_some();
            assert!(!grows(0.99) && grows(1.01), "{row:?}");
        } else {
            let sigma = |share: f64| SamplingMargin::of(&at(share)).unwrap().worst.sigma;
            assert!((sigma(1.0) - 1.0).abs() < 1e-6 && sigma(0.8) < 1.0 && sigma(1.1) > 1.0, "{row:?}");
        }
    }
    let samples = |name: &str| open_scenario(name).unwrap().setup.control.is_some();
    for scenario in SHIPPED_SCENARIOS.iter().filter(|scenario| samples(scenario.name)) {
        assert!(rows.iter().any(|row| row[0] == scenario.name), "{} samples and has no row", scenario.name);
    }
}

/// At rest they learn nothing, and what is learnt under way is what sampling bears least: these break down after four seconds.
#[test]
fn regress_ships_that_sample_too_slowly_for_their_way_are_not_called_adequate() {
    let text = shipped_scenario("five-ships").unwrap().text;
    let folder = folder();
    fs::write(
        folder.path().join("ships.toml"),
        format!("{text}\n[control]\nsample_hz = 3\ncomputation_delay_s = 0.08\n"),
    )
    .unwrap();
    let said = stdout(&forwardstep(&folder, &["check", "ships.toml"]).code(1));
    assert!(said.contains("not shown: they sample fast enough for K and Γ"), "{said}");
    assert!(said.contains(" on the way that its reference leads (ship-"), "{said}");
    forwardstep(&folder, &["run", "ships.toml", "--out", "run"]).code(3);
}

/// All multipliers of a short period are close to one, on which the search of eigenvalues may stall.
#[test]
fn regress_short_periods_have_their_multipliers() {
    for hz in some((600..680).chain([800, 1024, 5000, 20_000]), 9) {
        let setup = open_scenario("theorem-7").unwrap().setup.sampled(f64::from(hz));
        let found = WholeLoop::of(&setup).unwrap_or_else(|| panic!("{hz} Hz"));
        assert!(found.start.leftmost.unwrap()[0] > 0.99 && found.lasting_per_s().is_none(), "{hz} Hz: {found:?}");
    }
}

#[test]
fn val_a_row_of_the_sampling_table_is_what_runs_say() {
    let here = folder();
    let said = |arguments: &[&str]| stdout(&forwardstep(&here, &[&["sampling-limit"], arguments].concat()).success());
    let printed = said(&["theorem-2", "--late", "0.9", "--table"]);
    let cells: Vec<String> = rows().into_iter().nth(3).unwrap();
    assert_eq!(printed.lines().last().unwrap(), format!("| {} |", cells.join(" | ")));
    let in_words = said(&["theorem-2", "--late", "0.9", "--peak-error", "2.5", "--disagreement", "0.2"]);
    assert!(
        in_words.contains("\n  rule       11.7 ms: ") && in_words.contains("|s| ≤ 2.500, and at most 0.200 "),
        "{in_words}"
    );
    // What no period can do.
    let never = ["sampling-limit", "theorem-2", "--disagreement", "1e-300"];
    let never = stdout(&forwardstep(&here, &never).code(1));
    assert!(
        never.contains("\n  measured   – ms: no period that was tried gave this: accepted is that |s| ≤ "),
        "{never}"
    );
    forwardstep(&here, &["sampling-limit", "theorem-2", "--late", "1.5"]).code(2);
}
