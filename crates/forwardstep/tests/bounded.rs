//! Estimates that are kept within bounds, by every adaptive law: identities hold along runs, estimates keep to the bounds whatever pushes,
//! and bounds that leave the truth out are found.

use std::ops::ControlFlow;

use forwardstep::check::derivation::residual::{Missing, Residual, Residuals};
use forwardstep::check::{Answer, Id, check};
use forwardstep::io::SourceText;
use forwardstep::io::output::Metrics;
use forwardstep::io::scenario::{Scenario, read_scenario, shipped_scenario};
use forwardstep::sim::{Ending, Moment, Observers, Signal, simulate, simulate_with};

/// Shipped scenarios with an adaptive law, what to replace in them, and whether a mass is what bounds keep.
const LAWS: [(&str, &str, &str); 6] = [
    ("theorem-1", "[law.adaptive]", "[law.adaptive]\nbounds.BOUNDS"),
    ("without-velocity", "estimate_start_kg = 0 ", "bounds.BOUNDS "),
    ("theorem-5", "estimate_start_kg = 1.2 }", "estimate_start_kg = 1.2, bounds.BOUNDS }"),
    ("theorem-6", "[law.task_space]", "[law.task_space]\nestimate_bounds.BOUNDS"),
    ("immersion-and-invariance", "gain_per_s = 3", "gain_per_s = 3\nbounds.BOUNDS"),
    ("strict-feedback", "gains_per_s = 1", "gains_per_s = 1\nbounds.BOUNDS"),
];

fn read(name: &str, text: String) -> Scenario {
    read_scenario(name, &SourceText::new("bounded.toml", text), None).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A shipped scenario with bounds.
fn bounded(name: &str, from: &str, to: &str, bounds: &str) -> Scenario {
    let text = shipped_scenario(name).unwrap().text;
    assert_eq!(text.matches(from).count(), 1, "{name}: {from}");
    read(name, text.replace(from, &to.replace("BOUNDS", bounds)))
}

#[test]
fn every_adaptive_law_keeps_its_identities_and_its_goal_with_bounds() {
    for (name, from, to) in LAWS {
        let scenario = bounded(name, from, to, "within = 0.4");
        let mut setup = scenario.setup.clone();
        let report = check(&setup);
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::ParametersWithinBounds);
        assert_eq!(found.map(|hypothesis| hypothesis.answer()), Some(Answer::Holds), "{name}");
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(outcome.ending, Ending::Completed, "{name}");
        let metrics = Metrics::of(&setup, &outcome.recording, None, scenario.goal);
        assert!(scenario.goal.unwrap().is_met(&setup, &outcome, &metrics), "{name}");
        let mut kept = 0;
        for column in outcome.recording.columns.iter().filter(|column| column.signal == Signal::Estimate) {
            let agent = &setup.agents[column.agent];
            let bounds = agent.law.kept_within().unwrap();
            let (range, margin) = (bounds.range(column.axis), bounds.margin[column.axis]);
            // The margin is where the rate of the estimate vanishes; the integrator keeps to that within its tolerance.
            let beyond =
                column.values.iter().map(|estimate| range.beyond(*estimate).abs() / margin).fold(0.0, f64::max);
            assert!(beyond <= 1.0 + 1e-3, "{name}: {} {beyond}", column.axis);
            kept += 1;
        }
        assert!(kept > 0, "{name}");

        setup.time.record_every_s = 0.05;
        setup.time.end_s = setup.time.end_s.min(3.0);
        let mut residuals = Residuals::of(&setup).unwrap();
        simulate_with(
            &setup,
            &mut |_| ControlFlow::Continue(()),
            Observers { moments: Some(&mut |moment: Moment<'_>| residuals.look(moment)), ..Observers::default() },
        )
        .unwrap();
        let found: Vec<Residual> = residuals.found().into_iter().flat_map(|(_, found)| found).collect();
        let broken: Vec<_> = found.iter().filter(|one| one.holds() == Some(false)).collect();
        assert!(broken.is_empty(), "{name}: {broken:?}");
        let left =
            found.iter().filter(|one| one.largest.as_ref().is_err_and(|missing| *missing != Missing::Definition));
        assert_eq!(left.clone().count(), 0, "{name}: {:?}", left.collect::<Vec<_>>());
    }
}

#[test]
fn bounds_without_the_truth_are_found() {
    for (name, from, to) in LAWS {
        let p = bounded(name, from, to, "within = 0.4").setup.agents[0].robot.theta.len();
        let list = |entry: &str| vec![entry; p].join(", ");
        // Nothing that these scenarios estimate is between 50 and 60.
        let given = format!("given = {{ lower = [{}], upper = [{}] }}", list("50"), list("60"));
        let text = shipped_scenario(name).unwrap().text.replace(from, &to.replace("BOUNDS", &given));
        let Ok(scenario) = read_scenario(name, &SourceText::new("bounded.toml", text), None) else {
            // Agents with parameters of different numbers take no list.
            assert_eq!(name, "strict-feedback");
            continue;
        };
        let report = check(&scenario.setup);
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::ParametersWithinBounds);
        assert_eq!(found.map(|hypothesis| hypothesis.answer()), Some(Answer::Violated), "{name}");
    }
}

/// A square wave for long: the estimates of `estimates-within-bounds` stay where they may be, and drift far beyond without bounds.
#[test]
fn a_disturbance_for_long_carries_no_estimate_out_of_its_bounds() {
    let text = shipped_scenario("estimates-within-bounds").unwrap().text;
    let pushed = text.replace("from_s = 5\nfor_s = 15\n", "").replace("0.8*sin(0.4*t)", "3*tanh(20*sin(0.4*t))");
    let free = pushed.replace(", bounds.within = 0.4", "");
    let farthest = |text: String| {
        let setup = read("estimates-within-bounds", text).setup;
        let bounds = read("estimates-within-bounds", pushed.clone()).setup;
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        let estimates = outcome.recording.columns.iter().filter(|column| column.signal == Signal::Estimate);
        let beyond = estimates.flat_map(|column| {
            let own = bounds.agents[column.agent].law.kept_within().unwrap();
            let (range, margin) = (own.range(column.axis), own.margin[column.axis]);
            column.values.iter().map(move |estimate| range.beyond(*estimate).abs() / margin)
        });
        beyond.fold(0.0, f64::max)
    };
    let (kept, drifted) = (farthest(pushed.clone()), farthest(free));
    assert!(kept <= 1.0 + 1e-3, "{kept}");
    assert!(drifted > 5.0, "{drifted}");
}

#[test]
fn mistakes_in_bounds_are_told_at_their_place() {
    let start =
        ("strict-feedback", "gains_per_s = 1", "gains_per_s = 1\nestimate_start.scaled = 2\nbounds.within = 0.4");
    let list = "bounds.given = { lower = [1, 1], upper = [2, 2] } ";
    let known = ("without-velocity", "adaptation_gain = 8", "adaptation_gain = 0\nbounds.within = 0.4");
    for ((name, from, to), message) in [
        (
            start,
            "the estimate of parameter 1 starts at 1, and this law keeps it strictly between its bounds, 0.3 and 0.7",
        ),
        (("without-velocity", "estimate_start_kg = 0 ", list), "`lower` has 2 entries, but `mass` needs 1"),
        (known, "bounds of estimates have no effect where these are not adapted"),
        (
            ("without-velocity", "estimate_start_kg = 0 ", "bounds.within = -1 "),
            "`bounds.within` is -1, but must be positive",
        ),
    ] {
        let text = shipped_scenario(name).unwrap().text.replace(from, to);
        let error = read_scenario(name, &SourceText::new("bounded.toml", text), None).unwrap_err().to_string();
        assert!(error.starts_with("bounded.toml:") && error.contains(message), "{error}");
    }
}
