//! (110) over graphs that take turns and over links that delay, which is not in the paper.

use std::ops::ControlFlow;

use forwardstep_check::{Answer, Id, Report, Source, Theorem, check};
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::Path;
use forwardstep_sim::{Method, Setup, Signal, TimeSpan, simulate};

use super::{answer, led_by_agent, mass, setup, wave};
use crate::common::{column, edge};

/// That of the setups here, s.
const SIGN_PERIOD_S: f64 = 1e-3;

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
        // Of each of both links a period and a half of the sign besides.
        let whole_s = delays[0] + delays[1] + 2.0 * 1.5 * SIGN_PERIOD_S;
        let (found, exact) = (near(&late(delays.map(Delay::constant), weight)), drive * whole_s);
        assert!(found >= exact && found <= 1.001 * exact, "{delays:?}: {found} {exact}");
    }
    // A cycle: c₁ = (c₂ + D (T₁ + T₂))/2 and c₂ = c₁ + D T₂.
    let mut ring = setup(FollowingDesign::Continuous, wave(), 3.0);
    ring.network.delays = [0.1, 0.2].map(Delay::constant).to_vec();
    ring.network.schedule = Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 2.0, 1), edge(1, 0, 1.0, 1)]);
    let (found, exact) = (near(&check(&ring)), drive * (0.1 + 0.2 + 0.2 + 0.2 + 6.0 * SIGN_PERIOD_S));
    assert!(found >= exact && found <= 1.001 * exact, "{found} {exact}");
    // Controllers that sample hear a period later, and hold their signs for a period: two and a half of them for each link.
    let sampled = check(&ring.clone().sampled(100.0));
    assert!(sampled.promises.contains("exceeds 1.789"), "{}", sampled.promises);
    // With a γ that is too small nobody comes so near, and nothing is known of signs that see too late what they did.
    let mut weak = ring.clone();
    assert!(weak.change_reference(|following: &mut Following| following.gain = 2.0));
    let mut lagging = ring.sampled(100.0);
    lagging.control.as_mut().unwrap().computation_delay_s = 0.01;
    for report in [check(&weak), check(&lagging)] {
        assert!(report.promises.contains("within a bound in proportion"), "{}", report.promises);
    }
}

/// A path of masses behind a leader that moves steadily, from rest at its place, and how far the last one is from it in the end.
fn path(agents: usize, delay_s: f64, sample_hz: Option<f64>) -> (Setup, f64) {
    let steady = Path::Formula(Expression::variable(0) * 0.7);
    let mut setup = setup(FollowingDesign::Continuous, steady, 3.0);
    setup.agents = (0..agents).map(|_| setup.agents[0].clone()).collect();
    for (index, agent) in setup.agents.iter_mut().enumerate() {
        agent.name = format!("mass-{}", index + 1);
    }
    setup.network.agents = agents + 1;
    setup.network.delays = vec![Delay::constant(delay_s)];
    let links = (1..agents).flat_map(|i| [edge(i - 1, i, 1.0, 0), edge(i, i - 1, 1.0, 0)]);
    setup.network.schedule = Schedule::fixed(links.chain([edge(agents, 0, 1.0, 0)]).collect());
    let setup = match sample_hz {
        Some(hz) => setup.sampled(hz),
        None => setup,
    };
    let end_s = 60.0;
    let setup = Setup { time: TimeSpan { end_s, record_every_s: 0.05, ..setup.time.clone() }, ..setup };
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let last = *column(&outcome, agents - 1, Signal::Position, 0).last().unwrap();
    (setup, (0.7 * end_s - last).abs())
}

/// What follows a word in a sentence, as a number.
fn after(sentence: &str, word: &str) -> f64 {
    let number = sentence.split(word).nth(1).unwrap_or_else(|| panic!("{word}: {sentence}"));
    number.split([';', ',', ' ']).next().unwrap().parse().unwrap()
}

/// A delay of a microsecond lets every agent of a path lag by a held sign more than the one before.
#[test]
fn regress_held_signs_add_up_along_a_path_of_late_links() {
    for (delay_s, sample_hz) in [(1e-6, None), (0.05, None), (1e-6, Some(200.0)), (0.05, Some(200.0))] {
        let (setup, left) = path(6, delay_s, sample_hz);
        let report = check(&setup);
        let bound = after(&report.promises, "exceeds ");
        assert!(left <= bound && bound <= 2.6 * left, "{delay_s} {sample_hz:?}: {left} of {bound}");
        let about = after(&answer(&report, "set-valued").1, "of up to about ");
        assert!(about <= bound && about > 0.3 * left - 0.7 * 36.0 * delay_s, "{delay_s} {sample_hz:?}: {about} {left}");
    }
    // Each link adds the period of its own end: 1, 3, 5 … 11 of them up to the last. Without a delay signs are set together, but not by controllers that sample.
    for (sample_hz, times) in [(None, 1.0), (Some(200.0), 36.0)] {
        let (setup, left) = path(6, 0.0, sample_hz);
        let about = after(&answer(&check(&setup), "set-valued").1, "of up to about ");
        let one = 0.7 * sample_hz.map_or(SIGN_PERIOD_S, |hz: f64| 1.0 / hz);
        assert!((about / (times * one) - 1.0).abs() < 1e-3, "{about} {times} {one}");
        assert!(left <= 1.2 * about && left > 0.5 * about, "{sample_hz:?}: {left} {about}");
    }
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
    // A delay of which more is not known than what it is on the run.
    let mut swings = setup(FollowingDesign::Continuous, wave(), 3.0);
    let faster = Expression::variable(0).power(2.0).sin_of() * 0.05 + 0.1;
    swings.network.delays[0] = Delay::new(BoundedFormula::new(faster, 20.0));
    assert_ne!(said(&swings).worst(), Answer::Holds);
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

/// Followers 1 to 4 are vertices 0 to 3, the leader at rest is vertex 4. All weights are one, κ₀ = κ₁ = 1, k = 12, and the sign is too
/// weak to be seen. The numbers are those of SciPy, products of exponentials of the matrices of [q, z, p].
#[test]
fn own_a_swarm_over_graphs_that_take_turns_grows_though_each_is_enough() {
    let graph = |both: &[(usize, usize)], led: &[usize]| -> Vec<Edge> {
        let links = both.iter().flat_map(|&(one, other)| [edge(one, other, 1.0, 0), edge(other, one, 1.0, 0)]);
        links.chain(led.iter().map(|to| edge(4, *to, 1.0, 0))).collect()
    };
    let graphs = [graph(&[(0, 1), (0, 2)], &[1, 3]), graph(&[(0, 2), (0, 3), (1, 2), (2, 3)], &[0, 2])];
    let rest = Path::Sinusoids { offset: 0.0, waves: Vec::new() };
    let mut swarm = setup(FollowingDesign::Swarm { coupling: 12.0 }, rest, 1e-12);
    swarm.agents = (0..4).map(mass).collect();
    for (agent, q) in swarm.agents.iter_mut().zip([1.0, -1.0, -1.0, 1.0]) {
        agent.start.q = vec![q];
    }
    swarm.network.agents = 5;
    swarm.time.end_s = 30.0;
    swarm.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-12 };
    let last = |setup: &Setup| {
        let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
        [0, 1, 2, 3].map(|agent| *column(&outcome, agent, Signal::Position, 0).last().unwrap())
    };
    for edges in &graphs {
        swarm.network.schedule = Schedule::fixed(edges.clone());
        let report = check(&swarm);
        let fails: Vec<Id> =
            report.hypotheses.iter().filter(|one| one.answer() != Answer::Holds).map(|one| one.id).collect();
        assert_eq!(fails, [Id::PrintedDesign], "{report:?}");
        assert!(last(&swarm).iter().all(|q| q.abs() < 1e-7), "{:?}", last(&swarm));
    }
    swarm.network.schedule = Schedule::periodic(graphs.map(|edges| Phase { dwell_s: 1.25, edges }).to_vec());
    let report = check(&swarm);
    let found = report.hypotheses.iter().find(|one| one.id == Id::FixedGraph).unwrap();
    assert_eq!(found.answer(), Answer::NotCovered);
    assert!(found.because().ends_with("the error can grow"), "{}", found.because());
    let foretold = [16.243_780_961_171_25, 6.416_258_402_109_31, 21.918_416_767_477_96, -4.540_569_335_121_10];
    for (q, foretold) in last(&swarm).into_iter().zip(foretold) {
        assert!((q - foretold).abs() < 1e-6, "{q} {foretold}");
    }
}
