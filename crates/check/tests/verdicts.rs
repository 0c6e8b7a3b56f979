//! Verdicts at their edges: what holds for ever, what on the run, and what is said only where it applies.

mod asked;
mod complex_roots;
mod designs;
mod failures;
mod free_fall;
mod sampling;

use forwardstep_sim::reference::Backstepping;
use std::sync::Arc;

use crate::common::kinds::{alone, blind_mass, filtered_spacecraft, rest_at, spacecraft, tracking, vehicle};
use crate::common::{About, answer, answers, edge, masses};
use forwardstep_check::hypothesis::{GraphEvidence, KindEvidence};
use forwardstep_check::{Answer, Evidence, Id, NoPrediction, Theorem, check, predict};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::{Rotors, Wheels};
use forwardstep_core::reference::Choice;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::leader::{Following, FollowingDesign, Leader, Leading};
use forwardstep_sim::schedule::{Logged, Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Spline, Trajectory};
use forwardstep_sim::{
    Adaptive, Control, Exchange, Known, RotorcraftModel, Setup, SpacecraftModel, ThrustKind, ThrustLaw,
};

/// Two masses that hear each other through delays of their own.
fn pair(delays: [Delay; 2]) -> Setup {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 1)];
    let mut setup = masses(Exchange::Position, 2, Schedule::fixed(edges), delays.to_vec());
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.time.end_s = 20.0;
    setup
}

fn constant(s: f64) -> Delay {
    Delay::constant(s)
}

fn with_weights(weights: [Expression; 2]) -> Setup {
    let mut setup = pair([constant(0.1), constant(0.1)]);
    let edges = &mut setup.network.schedule.graphs[0];
    for (k, edge) in edges.iter_mut().enumerate() {
        edge.weight = Weight::Formula(k);
    }
    let bounded = |formula: Expression| BoundedFormula::new(formula, 20.0);
    setup.network.weights = weights.map(bounded).to_vec();
    setup
}

/// c + sin(rate t).
fn swing(c: f64, rate: f64) -> Expression {
    (Expression::variable(0) * rate).sin_of() + c
}

/// 2 + sin(t²), which swings faster and faster.
fn faster() -> Expression {
    (Expression::variable(0) * Expression::variable(0)).sin_of() + 2.0
}

#[test]
fn a_delay_or_a_weight_that_turns_negative_after_the_run_is_refuted() {
    // On [0, 20] it is at least 0.5, and at t = 150 π it is −0.5.
    let later = swing(0.5, 0.01);
    let delay = Delay::new(BoundedFormula::new(later.clone(), 20.0));
    assert_eq!(answer(&pair([constant(0.1), delay]), About::Delays), Answer::Violated);
    assert_eq!(answer(&with_weights([swing(2.0, 1.0), later]), About::Weights), Answer::Violated);
    assert_eq!(answer(&with_weights([swing(2.0, 1.0), swing(1.5, 0.3)]), About::Weights), Answer::Holds);
}

#[test]
fn every_weight_has_to_be_uniformly_continuous() {
    let (slow, fast) = (swing(2.0, 1.0), faster());
    assert_eq!(answer(&with_weights([slow.clone(), slow.clone()]), About::Weights), Answer::Holds);
    assert_eq!(answer(&with_weights([slow.clone(), fast.clone()]), About::Weights), Answer::NotShown);
    assert_eq!(answer(&with_weights([fast, slow]), About::Weights), Answer::NotShown);
}

#[test]
fn the_bound_of_delays_is_that_of_the_longest() {
    for delays in [[constant(0.3), constant(0.1)], [constant(0.1), constant(0.3)]] {
        let report = check(&pair(delays));
        assert!(report.hypotheses.iter().any(|h| h.answer() == Answer::Holds && h.because().contains("exceeds 0.3 s")));
    }
}

#[test]
fn remark_4_is_spoken_of_where_there_is_a_gain() {
    let said = |lambda: f64| {
        let mut setup = pair([constant(0.1), constant(0.1)]);
        setup.agents[1].manipulability = lambda;
        answers(&check(&setup), About::Manipulability)
    };
    assert_eq!(said(0.0), []);
    assert_eq!(said(0.7), [Answer::Holds]);
}

#[test]
fn eq_aa6_a_derivative_that_a_filter_estimates_is_not_covered() {
    let mut setup = pair([constant(0.1), constant(0.1)]);
    assert_eq!(answers(&check(&setup), About::Derivative), []);
    setup.reference = Arc::new(Backstepping { filter_s: 0.01, acceleration_limit: None });
    assert_eq!(answer(&setup, About::Derivative), Answer::NotCovered);
}

/// Two masses behind a leader, vertex 2, under this schedule.
fn led(schedule: Schedule, design: FollowingDesign, [alpha, beta]: [f64; 2]) -> Setup {
    let mut setup = pair([constant(0.0), constant(0.0)]);
    let trajectory = Trajectory::new(vec![rest_at(0.0), rest_at(0.0)]).unwrap();
    let leader = Leading::Motion(Leader { name: "leader".into(), trajectory });
    let following = Following { leader, design, alpha, beta, gain: 1.0, choice: Choice::Implicit, period_s: 1e-3 };
    setup.reference = Arc::new(following);
    setup.exchange = Exchange::PositionVelocity;
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
    setup.network.agents = 3;
    setup.network.schedule = schedule;
    setup
}

fn chain_of_three() -> Schedule {
    Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)])
}

#[test]
fn thm9_a_leader_that_is_heard_at_random_reaches_everybody_on_the_run_only() {
    let graphs = vec![vec![edge(2, 0, 1.0, 0)], vec![edge(0, 1, 1.0, 0)]];
    let random = Schedule::random(graphs.clone(), [0.1, 0.2], 1);
    let said = |schedule: Schedule| {
        let setup = led(schedule, FollowingDesign::Differentiable, [1.0, 2.5]);
        [answer(&setup, About::LeaderReaches), answer(&setup, About::LeaderFixed)]
    };
    assert_eq!(said(random), [Answer::HoldsOnHorizon, Answer::NotCovered]);
    let phases: Vec<Phase> = graphs.into_iter().map(|edges| Phase { edges, dwell_s: 1.0 }).collect();
    assert_eq!(said(Schedule::periodic(phases)), [Answer::Holds, Answer::NotCovered]);
    assert_eq!(said(chain_of_three()), [Answer::Holds, Answer::Holds]);
    assert_eq!(said(Schedule::fixed(vec![edge(2, 0, 1.0, 0)]))[0], Answer::Violated);
    let setup = led(chain_of_three(), FollowingDesign::Continuous, [1.0, 1.0]);
    assert_eq!(predict(&setup), Err(NoPrediction::Leader));
}

#[test]
fn prop_a_swarm_needs_the_coupling_that_its_derivation_asks_for() {
    // With weights of one λ is (3 − √5)/2; at roots κ₀ = 0.5 and κ₁ = 2, β = 2.5, α = 1.
    let lambda = 0.5 * (3.0 - 5.0_f64.sqrt());
    let least = |low: f64, high: f64| {
        let (alpha, beta) = (low * high, low + high);
        (beta + low.powi(4) / (2.0 * (beta * beta - alpha) * high)) / lambda
    };
    let both = Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)]);
    for (low, high) in [(0.5, 2.0), (1.0, 1.0), (3.0, 40.0)] {
        let said = |part: f64| {
            let design = FollowingDesign::Swarm { coupling: part * least(low, high) };
            answer(&led(both.clone(), design, [low * high, low + high]), About::Coupling)
        };
        assert_eq!([said(1.0 + 1e-6), said(1.0 - 1e-6)], [Answer::Holds, Answer::NotShown], "{low} {high}");
    }
    // p² + p + ½ has no real roots.
    let complex = led(both, FollowingDesign::Swarm { coupling: 1e3 }, [0.5, 1.0]);
    assert_eq!(answer(&complex, About::Coupling), Answer::NotShown);
}

pub(crate) fn control(computation_delay_s: f64) -> Option<Control> {
    Some(Control {
        sample_hz: 10.0,
        computation_delay_s,
        sensors: Default::default(),
        actuators: Default::default(),
        failures: Default::default(),
    })
}

#[test]
fn thm8_the_phase_in_which_nobody_hears_a_leader_is_counted_from_the_first_of_all() {
    let phase = |edges, dwell_s| Phase { edges, dwell_s };
    let whole = vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)];
    let phases = vec![phase(whole.clone(), 1.0), phase(whole, 1.0), phase(vec![edge(2, 0, 1.0, 0)], 1.0)];
    let report = check(&led(Schedule::once(phases), FollowingDesign::Continuous, [1.0, 1.0]));
    let found = report.hypotheses.iter().find(|found| found.id == Id::LeaderInEveryGraph).unwrap();
    let unheard = matches!(&found.evidence, Evidence::Graph(GraphEvidence::Unheard { phase: 3, .. }));
    assert!(unheard && found.answer() == Answer::Violated, "{:?}", found.evidence);
}

/// Of a log nothing is known beyond its end: neither that everybody hears a leader for ever, nor that somebody does not.
#[test]
fn own_what_a_log_of_graphs_shows_of_a_leader_is_shown_up_to_its_end() {
    let (whole, cut) = (vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)], vec![edge(2, 0, 1.0, 0)]);
    let other = vec![edge(2, 1, 1.0, 0), edge(1, 0, 1.0, 0)];
    let said = |schedule: Schedule| {
        let report = check(&led(schedule, FollowingDesign::Continuous, [1.0, 1.0]));
        report.hypotheses.iter().find(|found| found.id == Id::LeaderInEveryGraph).unwrap().answer()
    };
    for (second, known, logged) in
        [(other, Answer::Holds, Answer::HoldsOnHorizon), (cut, Answer::Violated, Answer::NotShown)]
    {
        let graphs = vec![whole.clone(), second];
        let phases = graphs.iter().map(|edges| Phase { edges: edges.clone(), dwell_s: 1.0 }).collect();
        assert_eq!(said(Schedule::periodic(phases)), known);
        let starts_s = (0..20).map(f64::from).collect();
        let log = Logged { starts_s, graphs: (0..20).map(|k| k % 2).collect(), until_s: 20.0 };
        assert_eq!(said(Schedule::logged(graphs, log)), logged);
    }
}

#[test]
fn parameters_at_a_bound_are_within_it() {
    let said = |lower: f64, upper: f64| {
        let mut setup = pair([constant(0.1), constant(0.1)]);
        let law = Adaptive {
            damping: Gain::Number(5.0),
            adaptation: Gain::Number(1.0),
            estimate_start: vec![lower],
            bounds: Some(ParameterBounds::new(vec![lower], vec![upper], 0.01)),
        };
        (setup.agents[0].law, setup.agents[0].robot.theta) = (Arc::new(law), vec![2.0]);
        let report = check(&setup);
        report.hypotheses.iter().find(|found| found.id == Id::ParametersWithinBounds).map(|found| found.answer())
    };
    let answers =
        [(2.0, 3.0), (1.0, 2.0), (2.001, 3.0), (1.0, 1.999)].map(|(lower, upper)| said(lower, upper).unwrap());
    assert_eq!(answers, [Answer::Holds, Answer::Holds, Answer::Violated, Answer::Violated]);
}

#[test]
fn every_measurement_that_is_not_exact_is_said() {
    let said = |change: fn(&mut Control)| {
        let mut setup = pair([constant(0.1), constant(0.1)]);
        setup.control = control(0.0);
        change(setup.control.as_mut().unwrap());
        check(&setup).hypotheses.iter().any(|hypothesis| hypothesis.id == Id::ExactMeasurements)
    };
    assert!(!said(|_| {}));
    assert!(
        said(|control| control.sensors.position_noise = 1e-4) && said(|control| control.sensors.velocity_noise = 1e-4)
    );
    assert!(said(|control| control.sensors.tip_velocity_noise = 1e-4));
    assert!(
        said(|control| control.sensors.position_quantum = 1e-3)
            && said(|control| control.sensors.velocity_quantum = 1e-3)
    );
}

#[test]
fn vehicles_are_told_apart_from_rotorcraft() {
    let design = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
    let plain = alone(vehicle(design, Floor::Stops(1.0)));
    assert_eq!(answers(&check(&plain), About::AngularVelocity), []);
    assert_eq!(answers(&check(&plain), About::Rotors), []);
    let craft = |rotors| {
        let mut setup = plain.clone();
        setup.agents[0].robot.kind = Arc::new(RotorcraftModel { gravity: 9.81, inertia: Gain::Number(0.02), rotors });
        setup.agents[0].start.rest = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        setup
    };
    assert_eq!(answer(&craft(None), About::AngularVelocity), Answer::NotCovered);
    assert_eq!(answers(&check(&craft(None)), About::Rotors), []);
    // The slowest body is named, whichever comes first.
    for order in [[30.0, 4.0], [4.0, 30.0]] {
        let mut two = craft(None);
        let flying = two.agents[0].clone();
        two.agents.push(flying);
        two.network.agents = 2;
        for (agent, bandwidth_per_s) in two.agents.iter_mut().zip(order) {
            agent.name = format!("craft-{bandwidth_per_s}");
            assert!(agent.change_law(|law: &mut ThrustLaw| law.bandwidth_per_s = bandwidth_per_s));
        }
        let found = check(&two).hypotheses.into_iter().find(|h| h.id == Id::AngularVelocity).unwrap();
        let Evidence::Kind(KindEvidence::AngularRate { agent, bandwidth_per_s, .. }) = found.evidence else { panic!() };
        assert_eq!((agent.name.as_str(), bandwidth_per_s), ("craft-4", 4.0));
    }
    // Of several floors the lowest is named.
    let mut two = plain.clone();
    two.agents.push(vehicle(design, Floor::Stops(0.5)));
    two.network.agents = 2;
    assert!(check(&two).hypotheses.iter().any(|h| h.answer() == Answer::Watched && h.because().contains("0.5 N")));
    // Where one of them adapts to its mass, or could, not all have that of the plant.
    let continuous = vehicle(ThrustKind::Continuous, Floor::Stops(1.0));
    let known = |setup: &Setup| check(setup).hypotheses.iter().any(|hypothesis| hypothesis.id == Id::KnownMasses);
    let mut designs = alone(continuous.clone());
    assert!(known(&designs));
    designs.agents.push(vehicle(design, Floor::Stops(1.0)));
    designs.network.agents = 2;
    assert!(!known(&designs));
    assert_eq!(answers(&check(&designs), About::ThrustGains), [Answer::Holds]);
    // What both say of their gains is said once.
    let mut both = craft(None);
    both.agents.push(vehicle(design, Floor::Stops(1.0)));
    both.network.agents = 2;
    assert_eq!(answers(&check(&both), About::ThrustGains), [Answer::Holds]);
    let rotors = Rotors { offset: 0.15, drag: 0.02, thrust: [0.2, 8.0] };
    assert_eq!(answer(&craft(Some(rotors)), About::Rotors), Answer::NotCovered);
    // Their limits cut off what is asked for, whether or not those of others are only reported.
    assert_eq!(answer(&craft(None), About::FullTorque), Answer::Holds);
    assert_eq!(answer(&craft(Some(rotors)), About::FullTorque), Answer::NotCovered);
    let mut enforced = craft(Some(rotors));
    let change =
        |setup: &Setup| check(setup).hypotheses.iter().find(|one| one.id == Id::AppliedTorque).unwrap().change();
    assert_eq!(change(&enforced).unwrap(), "thrusts without ends, as `every-wrench` says");
    enforced.agents[0].enforce_limits = true;
    let both = "limits that are reported, without `enforce_limits`; thrusts without ends, as `every-wrench` says";
    assert_eq!(change(&enforced).unwrap(), both);
}

#[test]
fn two_kinds_of_agents_are_not_of_one_theorem() {
    let mut mixed = alone(blind_mass(1.0, 1.0));
    mixed.agents[0].roots_per_s = vec![1.0, 2.0].into();
    assert_eq!(answers(&check(&mixed), About::OneKind), []);
    mixed.agents.push(mixed.agents[0].clone());
    mixed.agents[1].law = Arc::new(Known { damping: Gain::Number(5.0) });
    mixed.network.agents = 2;
    assert_eq!(answer(&mixed, About::OneKind), Answer::NotCovered);
    mixed.agents[0].law = Arc::new(Adaptive {
        damping: Gain::Number(5.0),
        adaptation: Gain::Number(1.0),
        estimate_start: vec![0.0],
        bounds: None,
    });
    assert_eq!(answers(&check(&mixed), About::OneKind), [], "known and unknown parameters are one kind");
    // Who follows a target of its own agrees with nobody.
    let mut apart = tracking(blind_mass(1.0, 1.0), vec![rest_at(0.1)]);
    apart.agents.push(apart.agents[0].clone());
    apart.agents[1].law = Arc::new(Known { damping: Gain::Number(5.0) });
    apart.network.agents = 2;
    assert_eq!(answers(&check(&apart), About::OneKind), []);
}

#[test]
fn a_report_is_as_good_as_its_worst_answer() {
    let mut setup = pair([constant(0.1), constant(0.1)]);
    assert_eq!(check(&setup).worst(), Answer::Holds);
    setup.agents[0].enforce_limits = true;
    assert_eq!(check(&setup).worst(), Answer::NotCovered);
    setup.network.schedule = Schedule::fixed(Vec::new());
    assert_eq!(check(&setup).worst(), Answer::Violated);
    let order = [
        Answer::Holds,
        Answer::HoldsOnHorizon,
        Answer::Watched,
        Answer::NotShown,
        Answer::NotCovered,
        Answer::Violated,
    ];
    assert!(order.is_sorted());
    let words = order.map(Answer::words);
    let [first, last] = [
        ["holds", "holds on [0, end]", "watched during the run"],
        ["not shown", "not covered by the paper", "violated"],
    ];
    assert_eq!(words, [first, last].concat()[..]);
}

#[test]
fn thm7_what_is_known_of_a_spacecraft_holds_and_a_path_is_looked_at_between_the_looks() {
    let target = |o| vec![rest_at(0.0), rest_at(0.0), rest_at(0.0), o];
    let setup = tracking(spacecraft(), target(rest_at(1.0)));
    assert_eq!(answer(&setup, About::Momentum), Answer::Holds);
    // |cos(500 π t / 20)| is one at every look, 20 s / 2000 apart, if those are at its crests, and zero between them.
    use core::f64::consts::TAU;
    let rate = TAU / (2.0 * 20.0 / 2000.0);
    let crests = crate::common::kinds::formula((Expression::variable(0) * rate).cos_of());
    let said = answer(&tracking(spacecraft(), target(crests)), About::Path);
    assert_eq!(said, Answer::Violated, "no look sees it at zero, but between them it is");
}

#[test]
fn a_passivity_filter_is_shown_for_what_keeps_still_and_for_equal_moments_of_inertia() {
    let still = || [0.3, -0.2, 0.1, 1.0].map(rest_at).to_vec();
    let turning = || {
        vec![rest_at(0.0), crate::common::kinds::formula(Expression::variable(0).sin_of()), rest_at(0.0), rest_at(2.0)]
    };
    let said = |target, moments: [f64; 3]| {
        let mut setup = tracking(filtered_spacecraft(), target);
        let inertia_kg_m2 = std::array::from_fn(|row| std::array::from_fn(|k| if row == k { moments[k] } else { 0.0 }));
        setup.agents[0].robot.kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels: Wheels::orthogonal() });
        let report = check(&setup);
        assert_eq!(report.theorem, Theorem::PassivityFilter);
        let of = |id| report.hypotheses.iter().find(|hypothesis| hypothesis.id == id).map(|one| one.answer());
        (of(Id::TargetAtRest), of(Id::KnownMomentum))
    };
    // Beside a target that keeps still neither M nor h_I is read.
    assert_eq!(said(still(), [10.0, 8.0, 6.0]), (Some(Answer::Holds), None));
    assert_eq!(said(turning(), [10.0, 8.0, 6.0]), (Some(Answer::NotShown), Some(Answer::Holds)));
    assert_eq!(said(turning(), [8.0; 3]), (Some(Answer::Holds), Some(Answer::Holds)));
    assert_eq!(said(turning(), [8.0, 8.0, 8.001]).0, Some(Answer::NotShown));
    // Products of inertia couple what the moments do not.
    let mut tilted = tracking(filtered_spacecraft(), turning());
    let inertia_kg_m2 = [[8.0, 0.5, 0.0], [0.5, 8.0, 0.0], [0.0, 0.0, 8.0]];
    tilted.agents[0].robot.kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels: Wheels::orthogonal() });
    let at_rest = check(&tilted).hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::TargetAtRest).unwrap();
    assert_eq!(at_rest.answer(), Answer::NotShown);
}

/// One entry goes to zero and stays there, and another passes zero long after the run, where nobody looks.
#[test]
fn regress_an_attitude_of_which_a_part_goes_on_after_the_run_is_not_shown_by_it() {
    let goes = Path::Spline(Spline::new(vec![0.0, 5.0], vec![1.0, 0.0]).unwrap());
    let swings = Path::Formula((Expression::variable(0) * 0.01 + 0.1).cos_of());
    let passes = tracking(spacecraft(), vec![goes.clone(), swings, rest_at(0.0), rest_at(0.0)]);
    assert_eq!(answer(&passes, About::Path), Answer::NotShown);
    // Where nothing moves any more, the run says it.
    let back = Path::Spline(Spline::new(vec![0.0, 5.0], vec![-0.5, 1.0]).unwrap());
    let rests = tracking(spacecraft(), vec![goes, back, rest_at(0.0), rest_at(0.0)]);
    assert_eq!(answer(&rests, About::Path), Answer::Holds);
}
