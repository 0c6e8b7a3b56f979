//! Names of hypotheses are stable, and answers follow from evidence.

use forwardstep_sim::reference::PureIntegral;
use std::collections::BTreeSet;
use std::sync::Arc;

use crate::common::kinds::{rest_at, vehicle};
use crate::common::{arm, edge, masses, setup};
use forwardstep_check::hypothesis::{FollowingEvidence, LinkEvidence, ReferenceEvidence, Subject};
use forwardstep_check::{Answer, Evidence, Id, Rigour, Source, Theorem, check};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, Loss, PacketLink};
use forwardstep_sim::formula::{BoundedFormula, Witness};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{Exchange, ThrustKind};

/// Names may join this list. None may leave it or change: certificates, waivers and summaries of earlier versions refer to them.
const NAMES: [&str; 64] = [
    "spanning-tree",
    "leader-reaches-all",
    "leader-in-every-graph",
    "dwell-time",
    "fixed-graph",
    "mutual-weights",
    "bounded-delays",
    "no-delay",
    "messages-in-time",
    "bounded-weights",
    "constant-weights",
    "coupling-sector",
    "real-roots",
    "hurwitz",
    "common-order",
    "own-orders",
    "common-first-root",
    "measured-derivative",
    "desired-design",
    "desired-dynamics",
    "manipulability",
    "uniform-inertia",
    "bounded-dynamics",
    "positive-gains",
    "pushes-end",
    "applied-torque",
    "continuous-time",
    "exact-measurements",
    "one-kind",
    "bounded-target",
    "bounded-leader",
    "sign-gain",
    "set-valued-sign",
    "shared-design",
    "printed-design",
    "swarm-coupling",
    "defined-terms",
    "input-factor",
    "chain-gains",
    "chain-adaptation",
    "bounded-regressors",
    "matched-disturbance",
    "position-only-gains",
    "model-reference-gains",
    "known-masses",
    "thrust-gains",
    "nonzero-thrust",
    "unbiased-acceleration",
    "angular-velocity",
    "every-wrench",
    "declared",
    "task-space-gains",
    "regular-jacobian",
    "target-within-reach",
    "certain-regressor",
    "parameters-within-bounds",
    "smooth-friction",
    "lengths-within-bounds",
    "attitude-gains",
    "known-momentum",
    "passivity-filter-gains",
    "target-at-rest",
    "start-attitude",
    "nonzero-quaternion",
];

#[test]
fn names_of_hypotheses_are_stable_and_unique() {
    let names: Vec<&str> = Id::ALL.iter().map(|id| id.name()).collect();
    assert_eq!(names, NAMES);
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), NAMES.len(), "a name is given twice");
    for id in Id::ALL {
        let kebab = |c: char| c.is_ascii_lowercase() || c == '-';
        assert!(id.name().chars().all(kebab), "{}", id.name());
        assert!(!id.place().is_empty(), "{}", id.name());
        // What is ours has no place in the paper, unless the paper names it without stating it.
        assert!(id.place() != "own derivation" || id.source() == Source::Derived, "{}", id.name());
    }
}

/// Two agents that hear each other over a delay; their verdict on delays.
fn delays(used: Vec<Delay>) -> (Answer, Rigour, Evidence) {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, used.len() - 1)];
    let mut setup = masses(Exchange::Position, 2, Schedule::fixed(edges), used);
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.time.end_s = 20.0;
    let mut hypotheses = check(&setup).hypotheses;
    hypotheses.retain(|hypothesis| hypothesis.id == Id::BoundedDelays);
    assert_eq!(hypotheses.len(), 1);
    let found = hypotheses.pop().unwrap();
    (found.answer(), found.rigour(), found.evidence)
}

#[test]
fn rigour_of_a_bound_is_that_of_its_weakest_part() {
    let constant = || Delay::constant(0.1);
    let formula = Expression::number(0.3);
    let enclosed = || Delay::new(BoundedFormula::new(formula.clone(), 20.0));
    let packets = |most_in_a_row| {
        let loss = Loss::Random { probability: 0.1 };
        let link =
            PacketLink { every_s: 0.02, first_s: 0.0, latency_s: 0.03, jitter_s: 0.02, loss, most_in_a_row, seed: 1 };
        Delay::new(link.trace((0, 1), 20.0).unwrap())
    };
    let found = |used| {
        let (answer, rigour, _) = delays(used);
        (answer, rigour)
    };
    assert_eq!(found(vec![constant()]), (Answer::Holds, Rigour::Exact));
    assert_eq!(found(vec![enclosed(), constant()]), (Answer::Holds, Rigour::Enclosed));
    assert_eq!(found(vec![constant(), packets(Some(2))]), (Answer::Holds, Rigour::Exact));
    assert_eq!(found(vec![packets(None), enclosed()]), (Answer::HoldsOnHorizon, Rigour::Given));
    assert_eq!(found(vec![enclosed(), packets(None)]), (Answer::HoldsOnHorizon, Rigour::Given));
    let (_, _, evidence) = delays(vec![constant(), enclosed()]);
    let Evidence::Links(LinkEvidence::Delays { bound_s, unknown, .. }) = evidence else { panic!("{evidence:?}") };
    assert!((bound_s, unknown.len()) == (0.3, 0));
}

#[test]
fn evidence_names_the_two_agents_and_their_first_roots() {
    let phase = |from, to| Phase { edges: vec![edge(from, to, 1.0, 0)], dwell_s: 1.0 };
    let schedule = Schedule::periodic(vec![phase(0, 1), phase(1, 0)]);
    let agents = vec![arm(0, &[1.0, 2.0]), arm(1, &[3.0, 2.0])];
    let report = check(&setup(agents, Exchange::PositionVelocity, schedule, vec![Delay::constant(0.1)], 9.0));
    let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::CommonFirstRoot).unwrap();
    let Evidence::Reference(ReferenceEvidence::FirstRoots([(a, kappa_a), (b, kappa_b)])) = &found.evidence else {
        panic!("{found:?}")
    };
    assert_eq!([(a.index, &*a.name, *kappa_a), (b.index, &*b.name, *kappa_b)], [(0, "arm-1", 1.0), (1, "arm-2", 3.0)]);
    assert_eq!((found.id.source(), found.id.place()), (Source::Corrected("E1"), "Theorem 3"));
    assert_eq!(report.theorem, Theorem::Theorem3Velocities { order: 2 });
    assert_eq!(report.theorem.source().words(), "the paper as corrected (E1, E2)");
}

#[test]
fn thm8_the_answer_about_the_gain_follows_from_its_bounds() {
    let gain = |reached: Option<f64>, unbounded, for_ever| {
        let reached = reached.map(|value| Witness { t_s: 1.0, value });
        let (gamma, seen, on_run, end_s) = (2.0, 1.0, 1.5, 9.0);
        let evidence = FollowingEvidence::Gain { gamma, seen, on_run, for_ever, reached, unbounded, end_s };
        let evidence = Evidence::from(evidence);
        (evidence.answer(), evidence.rigour())
    };
    assert_eq!(gain(None, false, 1.9), (Answer::Holds, Rigour::Enclosed));
    // That it is enough on the run says nothing of later.
    assert_eq!(gain(None, false, 2.0), (Answer::NotShown, Rigour::Sampled));
    assert_eq!(gain(None, false, f64::INFINITY), (Answer::NotShown, Rigour::Sampled));
    assert_eq!(gain(None, true, f64::INFINITY), (Answer::Violated, Rigour::Enclosed));
    assert_eq!(gain(Some(2.0), false, 2.5), (Answer::Violated, Rigour::Enclosed));
}

#[test]
fn reference_dynamics_with_accelerations_want_a_graph_that_stays() {
    let one = || vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0)];
    let delay = || vec![Delay::constant(0.1)];
    let answer = |schedule| {
        let mut setup = masses(Exchange::Position, 2, schedule, delay());
        setup.reference = Arc::new(PureIntegral);
        let report = check(&setup);
        assert_eq!((report.theorem.name(), report.theorem.source()), ("remark-3", Source::Paper));
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::FixedGraph).unwrap();
        assert_eq!(found.subject, Subject::Setup);
        found.answer()
    };
    assert_eq!(answer(Schedule::fixed(one())), Answer::Holds);
    let phase = || Phase { edges: one(), dwell_s: 1.0 };
    // The same twice stays, another does not.
    assert_eq!(answer(Schedule::periodic(vec![phase(), phase()])), Answer::Holds);
    let other = Phase { edges: vec![edge(2, 1, 1.0, 0), edge(1, 0, 1.0, 0)], dwell_s: 1.0 };
    assert_eq!(answer(Schedule::periodic(vec![phase(), other])), Answer::NotCovered);
}

#[test]
fn what_was_drawn_is_given_and_what_repeats_is_exact() {
    let tree = |schedule| {
        let report = check(&masses(Exchange::Position, 2, schedule, vec![Delay::constant(0.1)]));
        let found = report.hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::SpanningTree).unwrap();
        (found.answer(), found.rigour(), found.because().contains("up to the end of the run"))
    };
    let (first, second) =
        (|| vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0)], || vec![edge(2, 3, 1.0, 0), edge(3, 4, 1.0, 0)]);
    let random = |graphs| Schedule::random(graphs, [0.1, 0.2], 1);
    let periodic =
        |graphs: Vec<_>| Schedule::periodic(graphs.into_iter().map(|edges| Phase { edges, dwell_s: 0.2 }).collect());
    assert_eq!(tree(random(vec![first(), second()])), (Answer::HoldsOnHorizon, Rigour::Given, true));
    // What no draw can bring is missing for ever.
    assert_eq!(tree(random(vec![first(), first()])), (Answer::Violated, Rigour::Exact, false));
    assert_eq!(tree(periodic(vec![first(), second()])), (Answer::Holds, Rigour::Exact, false));
    assert_eq!(tree(periodic(vec![first(), first()])), (Answer::Violated, Rigour::Exact, false));
}

/// The paper has linear couplings, and nobody in it keeps an offset: it names formations as a reason for consensus.
#[test]
fn regress_what_a_theorem_is_extended_to_is_not_the_papers() {
    let fixed = || Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0)]);
    let mut coupled = masses(Exchange::Position, 2, fixed(), vec![Delay::constant(0.1)]);
    let plain = check(&coupled).theorem;
    assert_eq!((plain.name(), plain.source()), ("theorem-3-positions", Source::Corrected("E2")));
    for coupling in [Coupling::Saturated { limit: 0.1 }, Coupling::Tanh { scale: 1.0 }] {
        coupled.network.coupling = coupling;
        let theorem = check(&coupled).theorem;
        assert_eq!((theorem.name(), theorem.source()), (plain.name(), Source::Derived));
        assert_eq!(theorem.to_string(), format!("{plain}, with a nonlinear coupling as derived for this software"));
    }
    let floor = Floor::Stops(0.5);
    for (design, name) in [
        (ThrustKind::Continuous, "continuous-thrust"),
        (ThrustKind::Differentiable { alpha_star: 4.0, stiffness: 20.0 }, "theorem-4"),
    ] {
        let two = vec![vehicle(design, floor), vehicle(design, floor)];
        let mut flying =
            setup(two, Exchange::Position, Schedule::fixed(vec![edge(0, 1, 1.0, 0)]), vec![Delay::constant(0.0)], 10.0);
        let plain = check(&flying).theorem;
        assert_eq!((plain.name(), plain.source()), (name, Source::Paper));
        // Offsets at rest are none of the paper's either.
        flying.agents[0].target = Trajectory::new(vec![rest_at(1.0), rest_at(0.0), rest_at(0.0)]).ok();
        let report = check(&flying);
        assert_eq!((report.theorem.name(), report.theorem.source()), (name, Source::Derived));
        assert!(report.theorem.to_string().ends_with("with offsets from where all agree as derived for this software"));
        let bounded = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::BoundedTarget).unwrap();
        assert_eq!((bounded.place(), bounded.source()), ("own derivation", Source::Derived));
    }
}
