//! (110) over graphs that take turns and over links that delay, which is not in the paper.

use forwardstep_check::{Answer, Id, Report, Source, Theorem, check};
use forwardstep_core::expression::Expression;
use forwardstep_sim::Setup;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::schedule::{Phase, Schedule};

use super::common::edge;
use super::{answer, led_by_agent, setup, wave};

/// The report on (110) over two edges with these delays.
fn late(delays: [Delay; 2], weight: f64) -> Report {
    let mut setup = setup(FollowingDesign::Continuous, wave(), 3.0);
    setup.network.delays = delays.to_vec();
    setup.network.schedule = Schedule::fixed(vec![edge(2, 0, weight, 0), edge(0, 1, 1.0, 1)]);
    check(&setup)
}

#[test]
fn prop_with_delays_on_a_fixed_graph_what_may_be_left_is_said() {
    // D = √5 and α = 1: along the row the delays add up, whatever the weights are.
    let near = |report: &Report| {
        assert_eq!((&report.theorem, report.worst()), (&Theorem::LateLeader, Answer::Holds));
        assert!(report.hypotheses.iter().all(|one| ![Id::NoDelay, Id::LeaderInEveryGraph].contains(&one.id)));
        let number = report.promises.split("exceeds ").nth(1).unwrap().split(';').next().unwrap();
        number.parse::<f64>().unwrap()
    };
    let drive = 5.0_f64.sqrt();
    for (delays, weight) in [([0.1, 0.0], 1.0), ([0.1, 0.05], 7.0), ([0.0, 1e-9], 1.0), ([3.0, 2.0], 0.1)] {
        let (found, exact) = (near(&late(delays.map(Delay::constant), weight)), drive * (delays[0] + delays[1]));
        assert!(found >= exact && found <= 1.001 * exact, "{delays:?}: {found} {exact}");
    }
    // A cycle: c₁ = (c₂ + D (T₁ + T₂))/2 and c₂ = c₁ + D T₂.
    let mut ring = setup(FollowingDesign::Continuous, wave(), 3.0);
    ring.network.delays = [0.1, 0.2].map(Delay::constant).to_vec();
    ring.network.schedule = Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 2.0, 1), edge(1, 0, 1.0, 1)]);
    let (found, exact) = (near(&check(&ring)), drive * (0.1 + 0.2 + 0.2 + 0.2));
    assert!(found >= exact && found <= 1.001 * exact, "{found} {exact}");
    // Controllers that sample hear a period later: two more periods along the row.
    let sampled = check(&ring.clone().sampled(100.0));
    assert!(sampled.promises.contains("exceeds 1.655"), "{}", sampled.promises);
}

#[test]
fn prop_what_is_left_for_delays_has_no_number_where_none_is_known() {
    let said = |setup: &Setup| {
        let report = check(setup);
        assert_eq!(report.theorem, Theorem::LateLeader);
        assert!(report.promises.contains("in proportion to them"), "{}", report.promises);
        report
    };
    let mut varies = setup(FollowingDesign::Continuous, wave(), 3.0);
    varies.network.delays[0] = Delay::constant(0.1);
    varies.network.weights = vec![BoundedFormula::new(Expression::variable(0).sin_of() * 0.1 + 1.0, 20.0)];
    varies.network.schedule.graphs[0][0].weight = Weight::Formula(0);
    assert_eq!(answer(&said(&varies), "weights are constant").0, Answer::NotCovered);
    // A leader that is an agent, and one that is never heard.
    let mut led = led_by_agent(FollowingDesign::Continuous, wave());
    led.network.delays[0] = Delay::constant(0.1);
    said(&led);
    let mut cut = setup(FollowingDesign::Continuous, wave(), 3.0);
    cut.network.delays[0] = Delay::constant(0.1);
    cut.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)]);
    assert_eq!(answer(&said(&cut), "reaches everybody").0, Answer::Violated);
}

/// (110) over two graphs that take turns.
fn turns(first: Vec<Edge>, second: Vec<Edge>) -> Setup {
    let mut setup = setup(FollowingDesign::Continuous, wave(), 3.0);
    let phase = |edges| Phase { dwell_s: 1.0, edges };
    setup.network.schedule = Schedule::periodic(vec![phase(first), phase(second)]);
    setup
}

#[test]
fn prop_over_graphs_that_take_turns_the_leader_has_to_reach_everybody_in_each() {
    let (down, up) = (vec![edge(2, 0, 1.0, 0), edge(0, 1, 0.3, 0)], vec![edge(2, 1, 5.0, 0), edge(1, 0, 1.0, 0)]);
    let report = check(&turns(down.clone(), up.clone()));
    assert_eq!((&report.theorem, report.worst()), (&Theorem::SwitchingLeader, Answer::Holds));
    assert_eq!((report.theorem.source(), report.theorem.name()), (Source::Derived, "theorem-8-switching"));
    assert!(report.hypotheses.iter().all(|one| ![Id::FixedGraph, Id::LeaderReachesAll].contains(&one.id)));
    for (first, second, phase, group) in [
        (down.clone(), up[1..].to_vec(), 2, "mass-2"),
        (down[..1].to_vec(), up.clone(), 1, "mass-2"),
        (Vec::new(), up.clone(), 1, "mass-1"),
    ] {
        let (said, because) = answer(&check(&turns(first, second)), "in each of the graphs");
        assert_eq!(said, Answer::Violated);
        assert!(
            because.starts_with(&format!("in phase {phase} ")) && because.contains(&format!("[{group}]")),
            "{because}"
        );
    }
    // What stays is what counts where a schedule ends.
    let phase = |edges| Phase { dwell_s: 1.0, edges };
    let mut ends = turns(down.clone(), up.clone());
    for (first, second, expected) in
        [(Vec::new(), up.clone(), Answer::Holds), (up.clone(), down[..1].to_vec(), Answer::Violated)]
    {
        ends.network.schedule = Schedule::once(vec![phase(first), phase(second)]);
        assert_eq!(answer(&check(&ends), "in each of the graphs").0, expected);
    }
    // With weights that fade it does not hold.
    let mut fades = turns(down, up);
    fades.network.weights = vec![BoundedFormula::new((-Expression::variable(0)).exp_of(), 20.0)];
    fades.network.schedule.graphs[0][0].weight = Weight::Formula(0);
    assert_eq!(check(&fades).worst(), Answer::Violated);
}

#[test]
fn prop_graphs_that_take_turns_are_not_covered_with_delays_or_with_other_designs() {
    let (down, up) = (vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)], vec![edge(2, 1, 1.0, 0), edge(1, 0, 1.0, 0)]);
    let mut late = turns(down.clone(), up.clone());
    late.network.delays[0] = Delay::constant(0.1);
    let report = check(&late);
    assert_eq!(report.theorem, Theorem::Theorem8);
    let found = report.hypotheses.iter().find(|one| one.id == Id::FixedGraph).unwrap();
    assert_eq!(found.answer(), Answer::NotCovered);
    assert!(found.because().contains("late") && found.change().unwrap().contains("without delay"), "{found:?}");
    for design in [
        FollowingDesign::Differentiable,
        FollowingDesign::WithoutAcceleration,
        FollowingDesign::Swarm { coupling: 50.0 },
    ] {
        let mut other = turns(down.clone(), up.clone());
        assert!(other.change_reference(|following: &mut Following| (following.design, following.gain) = (design, 9.0)));
        let report = check(&other);
        let found = report.hypotheses.iter().find(|one| one.id == Id::FixedGraph).unwrap();
        assert_eq!(
            (report.theorem.source() == Source::Paper, found.answer()),
            (!matches!(design, FollowingDesign::Swarm { .. }), Answer::NotCovered)
        );
        assert!(found.because().contains("former neighbours"), "{}", found.because());
    }
}
