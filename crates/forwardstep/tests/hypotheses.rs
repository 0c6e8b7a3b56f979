//! Every hypothesis and every theorem that `check` knows is shown by a shipped scenario, or by one with a change.

use forwardstep::core::Gain;
use forwardstep::core::reference::WrittenIn;
use forwardstep::sim::reference::{Desired, DesiredPolynomial, Tracking};
use std::collections::BTreeSet;
use std::sync::Arc;

use forwardstep::check::hypothesis::{Evidence, Hypothesis, KindEvidence, Subject};
use forwardstep::check::{Answer, Footing, Id, Report, Rigour, Source, Theorem, check};
use forwardstep::core::law::ParameterBounds;
use forwardstep::io::SourceText;
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario, read_scenario};
use forwardstep::sim::delay::Delay;
use forwardstep::sim::leader::{Following, FollowingDesign};
use forwardstep::sim::push::{Course, Effect, Function, Push};
use forwardstep::sim::schedule::Schedule;
use forwardstep::sim::{
    Adaptive, Exchange, ModelReferenceLaw, PassivityFilterLaw, Setup, TaskSpaceLaw, ThrustKind, ThrustLaw,
};

fn shipped(name: &str) -> Setup {
    open_scenario(name).unwrap_or_else(|error| panic!("{error}")).setup
}

/// An arm whose lengths have bounds.
fn bounded_lengths(upper: f64) -> Setup {
    let mut setup = shipped("theorem-6");
    let bounds = ParameterBounds::new(vec![0.5; 2], vec![upper; 2], 0.01);
    assert!(setup.agents[0].change_law(|law: &mut TaskSpaceLaw| law.bounds = Some(bounds)));
    setup
}

/// An arm the velocity of whose tip is measured.
fn by_velocity() -> Setup {
    let mut setup = shipped("theorem-6");
    assert!(setup.agents[0].change_law(|law: &mut TaskSpaceLaw| law.by_velocity = true));
    setup
}

/// Its verdict is that of Theorem 6 but for whose it is: the proof asks for the same.
#[test]
fn own_a_tip_by_its_velocity_asks_for_what_theorem_6_does_and_is_not_of_the_paper() {
    let (measured, integrated) = (check(&by_velocity()), check(&shipped("theorem-6")));
    let asked = |report: &Report| -> Vec<(Id, Answer)> {
        report.hypotheses.iter().map(|hypothesis| (hypothesis.id, hypothesis.answer())).collect()
    };
    assert_eq!(asked(&measured), asked(&integrated));
    assert_eq!(measured.theorem.source(), Source::Derived);
    assert!(measured.theorem.to_string().starts_with("no theorem of the paper"), "{}", measured.theorem);
    assert!(measured.promises.contains("by a measured ẋ"), "{}", measured.promises);
    // Beside an arm under Theorem 6 the promise names both.
    let mut both = by_velocity();
    both.agents.extend(shipped("theorem-6").agents);
    both.network.agents = both.agents.len();
    let both = check(&both);
    assert_eq!(both.theorem, measured.theorem);
    assert!(both.promises.ends_with("as of Theorem 6"), "{}", both.promises);
}

/// Chains that would follow targets of their own.
fn tracking_chains() -> Setup {
    let mut setup = shipped("framework");
    setup.reference = Arc::new(Tracking);
    setup
}

/// A chain in feedback form that is disturbed where its input enters.
fn disturbed_chain() -> Setup {
    let mut setup = shipped("strict-feedback");
    let last = [0.0, 0.5].map(Function::Constant).to_vec();
    setup.agents[0].pushes = vec![Push { effect: Effect::Torque(Course::Each(last)), from_s: 1.0, until_s: 2.0 }];
    setup
}

/// Sampled controllers that drop messages which are too old.
fn timed_out() -> Setup {
    let mut setup = shipped("six-arms-over-radio");
    setup.control.as_mut().unwrap().failures.message_timeout_s = Some(0.1);
    setup
}

/// An arm and a spacecraft, each with its target.
fn arm_and_spacecraft() -> Setup {
    let mut setup = shipped("theorem-6");
    setup.agents.extend(shipped("theorem-7").agents);
    setup.network.agents = setup.agents.len();
    setup
}

/// A spacecraft by a filter of its attitude error.
fn filtered_spacecraft() -> Setup {
    let mut setup = shipped("tumbling-target");
    let [filter, damping] = [1.0, 3.0].map(Gain::Number);
    setup.agents[0].law = Arc::new(PassivityFilterLaw { error_gain_n_m: 4.0, filter, damping });
    setup
}

/// A mass without velocity, by a model.
fn by_model() -> Setup {
    let mut setup = shipped("without-velocity");
    setup.agents[0].law = Arc::new(ModelReferenceLaw { filter_per_s: 20.0, adaptation: 8.0, estimate_start: 0.0 });
    setup.agents[0].roots_per_s.real.pop();
    setup
}

/// Vehicles whose accelerometers have this bias.
fn by_acceleration(bias: [f64; 3]) -> Setup {
    let mut setup = shipped("theorem-5");
    for agent in &mut setup.agents {
        agent.roots_per_s.real.pop();
        assert!(agent.change_law(|law: &mut ThrustLaw| {
            let (alpha_star, gamma_star, estimate_start) = (3.0, 0.2, 1.2);
            law.design = ThrustKind::ByAcceleration { alpha_star, gamma_star, estimate_start, bounds: None, bias };
        }));
    }
    setup
}

/// Its verdict is that of Theorem 5 but for whose it is and what a bias does: the proof asks for the same.
#[test]
fn own_vehicles_by_acceleration_ask_for_what_theorem_5_does_and_for_no_bias() {
    let (measured, by_parts) = (check(&by_acceleration([0.0; 3])), check(&shipped("theorem-5")));
    let asked = |report: &Report| -> Vec<(Id, Answer)> {
        let others = report.hypotheses.iter().filter(|hypothesis| hypothesis.id != Id::UnbiasedAcceleration);
        others.map(|hypothesis| (hypothesis.id, hypothesis.answer())).collect()
    };
    assert_eq!(asked(&measured), asked(&by_parts));
    assert_eq!(measured.theorem.source(), Source::Derived);
    assert!(measured.theorem.to_string().starts_with("no theorem of the paper"), "{}", measured.theorem);
    let bias = |setup: &Setup| {
        let report = check(setup);
        let found = report.hypotheses.iter().filter(|hypothesis| hypothesis.id == Id::UnbiasedAcceleration);
        let found: Vec<_> = found.map(|hypothesis| (hypothesis.answer(), hypothesis.because())).collect();
        assert_eq!(found.len(), 1);
        found[0].clone()
    };
    assert_eq!(bias(&by_acceleration([0.0; 3])).0, Answer::Holds);
    // Roots 1 and 1.5: between e/2.5 and 2.5 e/1.5.
    for (e, words) in
        [(0.3, "rise together for ever, at 0.12 to 0.5 m/s"), (-0.3, "sink together for ever, at 0.12 to 0.5 m/s")]
    {
        let (answer, reason) = bias(&by_acceleration([0.0, 0.0, e]));
        assert!(answer == Answer::NotCovered && reason.contains(words), "{reason}");
    }
    let mut one = by_acceleration([0.0; 3]);
    one.agents[2] = by_acceleration([0.1, 0.0, 0.0]).agents[2].clone();
    let (answer, reason) = bias(&one);
    assert!(answer == Answer::NotCovered && reason.contains("vehicle-3") && !reason.contains("together"), "{reason}");
}

/// Robots with reference dynamics of different orders.
fn own_orders() -> Setup {
    let mut setup = shipped("theorem-3-24-order-4");
    setup.agents[0].roots_per_s.real.pop();
    setup
}

/// Theorem 8 with an observer in the place of (110).
fn observed() -> Setup {
    let mut setup = shipped("theorem-8");
    setup.exchange = Exchange::Estimates;
    assert!(setup.change_reference(|following: &mut Following| {
        following.design = FollowingDesign::Observer { kappa: 2.0 };
    }));
    setup
}

/// `shipped` with another of what its desired dynamics are made of.
fn desired(shipped_name: &str, change: impl FnOnce(&mut Desired)) -> Setup {
    let mut setup = shipped(shipped_name);
    assert!(setup.change_reference(change));
    setup
}

/// Desired dynamics by coefficients, the first of which stand for x.
fn coefficients(list: &[f64]) -> DesiredPolynomial {
    DesiredPolynomial::Coefficients(list.to_vec())
}

fn reports() -> Vec<Report> {
    let changed = [
        bounded_lengths(1.5),
        tracking_chains(),
        disturbed_chain(),
        timed_out(),
        arm_and_spacecraft(),
        filtered_spacecraft(),
        by_model(),
        own_orders(),
        by_velocity(),
        by_acceleration([0.0; 3]),
        observed(),
        desired("desired-dynamics", |desired| desired.heard = vec![1.0]),
    ];
    let shipped = SHIPPED_SCENARIOS.iter().map(|scenario| shipped(scenario.name));
    shipped.chain(changed).map(|setup| check(&setup)).collect()
}

#[test]
fn every_hypothesis_and_every_theorem_is_shown_by_some_setup() {
    let reports = reports();
    let hypotheses = || reports.iter().flat_map(|report| &report.hypotheses);
    let shown: BTreeSet<Id> = hypotheses().map(|hypothesis| hypothesis.id).collect();
    // What a law from outside declares is shown by `own_kind`.
    let missing = Id::ALL.iter().filter(|id| !shown.contains(id) && **id != Id::Declared).map(|id| id.name());
    let missing: Vec<&str> = missing.collect();
    assert!(missing.is_empty(), "nothing shows {missing:?}");

    let theorems: BTreeSet<&str> = reports.iter().map(|report| report.theorem.name()).collect();
    let names = [
        "backstepping",
        "chains-agree",
        "chains-track",
        "composite",
        "continuous-thrust",
        "desired-dynamics",
        "leader-observer",
        "mixture",
        "model-reference",
        "passivity-filter",
        "position-only-tracks",
        "remark-12",
        "remark-3",
        "remark-7",
        "robots-track",
        "swarm",
        "targets",
        "theorem-1",
        "theorem-2",
        "theorem-3-first-order",
        "theorem-3-own-orders",
        "theorem-3-positions",
        "theorem-3-velocities",
        "theorem-4",
        "theorem-5",
        "theorem-6",
        "theorem-6-pose",
        "theorem-6-redundant",
        "theorem-7",
        "theorem-8",
        "theorem-8-late",
        "theorem-8-switching",
        "theorem-9",
        "thrust-by-acceleration",
        "tip-velocity",
    ];
    assert_eq!(theorems, names.into());
    for hypothesis in hypotheses() {
        let (requires, because) = (hypothesis.requires(), hypothesis.because());
        assert!(!requires.contains('…') && !requires.is_empty() && !because.is_empty(), "{hypothesis:?}");
        assert_eq!(hypothesis.answer() == Answer::Watched, hypothesis.rigour() == Rigour::Watched, "{hypothesis:?}");
    }
}

/// Of dynamics of one's own it was said that no bounded delay breaks them, and that only graphs that switch leave open where they lead.
#[test]
fn regress_what_averages_bear_is_not_said_of_dynamics_of_ones_own() {
    let breaks = |setup: &Setup, id: Id| {
        let breaks = Footing::of(setup, &check(setup)).breaks;
        breaks.into_iter().find(|ground| ground.id == id).map(|ground| ground.words).unwrap()
    };
    let mut own = shipped("desired-nonlinear");
    own.network.delays = vec![Delay::constant(0.5)];
    for (id, averages) in [(Id::BoundedDelays, "however long or abrupt"), (Id::DwellTime, "does not matter")] {
        for setup in [shipped("theorem-2"), shipped("desired-dynamics")] {
            assert!(breaks(&setup, id).contains(averages), "{:?}", breaks(&setup, id));
        }
        let said = breaks(&own, id);
        assert!(!said.contains(averages) && said.contains("can break agreement too"), "{said}");
    }

    let mut other = desired("desired-dynamics", |desired| desired.heard = vec![1.0]);
    let because = |setup: &Setup| check(setup).hypotheses[0].because();
    assert!(because(&other).contains("over graphs that switch and links that are late"), "{}", because(&other));
    let first = other.network.schedule.graphs[0].clone();
    other.network.schedule = Schedule::fixed(first);
    other.network.delays.iter_mut().for_each(|delay| *delay = Delay::constant(0.1));
    let said = because(&other);
    assert!(said.contains("graph, weights and delays are constant") && !said.contains("switch"), "{said}");
}

/// (24), (a5) and tracking are recognised by exact numbers; what is another design is not shown, and what cannot work is violated.
#[test]
fn eq_43_desired_dynamics_are_judged_by_the_design_that_they_are() {
    let of = |setup: &Setup| {
        let report = check(setup);
        (report.theorem.name(), report.hypotheses[0].id, report.hypotheses[0].answer())
    };
    let agreed = |change: fn(&mut Desired)| of(&desired("desired-dynamics", change));
    let (design, open) = (Id::DesiredDesign, Id::DesiredDynamics);
    assert_eq!(agreed(|_| {}), ("chains-agree", design, Answer::Holds));
    assert_eq!(agreed(|desired| desired.heard = vec![2.0]), ("chains-agree", design, Answer::Holds));
    let other = ("desired-dynamics", open, Answer::NotShown);
    assert_eq!(agreed(|desired| desired.heard = vec![2.0_f64.next_up()]), other);
    assert_eq!(agreed(|desired| desired.written = WrittenIn::Z), other);
    assert_eq!(agreed(|desired| desired.written = WrittenIn::X), other);
    assert_eq!(agreed(|desired| desired.coupling = Some(coefficients(&[2.0]))), other);
    assert_eq!(agreed(|desired| desired.polynomial = coefficients(&[0.0, 2.0, 3.0])), other);
    let tracked = |change: fn(&mut Desired)| of(&desired("desired-in-z", change));
    assert_eq!(tracked(|_| {}), ("chains-track", design, Answer::Holds));
    // (p + 1)⁴, and with a pair of roots to the right of the axis.
    let stable = |desired: &mut Desired| desired.polynomial = coefficients(&[1.0, 4.0, 6.0, 4.0]);
    assert_eq!(tracked(stable), ("chains-track", open, Answer::Holds));
    let unstable = |desired: &mut Desired| desired.polynomial = coefficients(&[1.0, 4.0, 1.0, 4.0]);
    assert_eq!(tracked(unstable), ("chains-track", open, Answer::Violated));

    // On robots of order two the form in x is (23), or (3) where velocities are exchanged.
    let mut robots = shipped("theorem-1");
    let by_roots = |integrators| DesiredPolynomial::Roots { integrators, roots: [1.0, 2.0].into() };
    let mut with = |heard: &[f64], written| {
        let desired = Desired {
            polynomial: by_roots(1),
            coupling: Some(by_roots(0)),
            heard: heard.to_vec(),
            follows_target: false,
            written,
            protocol: None,
        };
        robots.exchange = desired.exchange();
        robots.reference = Arc::new(desired);
        robots.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
        of(&robots)
    };
    assert_eq!(with(&[2.0, 2.0], WrittenIn::X), ("theorem-1", design, Answer::Holds));
    assert_eq!(with(&[], WrittenIn::X), ("remark-3", design, Answer::Holds));
    assert_eq!(with(&[2.0, 2.0], WrittenIn::Measured), ("theorem-2", design, Answer::Holds));
    assert_eq!(with(&[2.0, 1.5], WrittenIn::Measured), other);
    assert_eq!(with(&[], WrittenIn::Measured), ("theorem-3-positions", design, Answer::Holds));
}

/// What is said of a nonlinear protocol is declared and tried: nothing holds by it, and what diverges is violated with a run.
#[test]
fn eq_43_a_nonlinear_protocol_is_declared_and_runs_speak_against_it() {
    // The name of the theorem, and of three hypotheses the answer, the rigour and whether a run speaks against it.
    let of = |text: &str| {
        let scenario = read_scenario("own", &SourceText::new("own.toml", text), None).unwrap();
        let report = check(&scenario.setup);
        let against = |found: &Hypothesis| found.because().contains("they do not converge from there");
        let hypotheses = report.hypotheses.iter().take(3);
        let found = hypotheses.map(|found| (found.answer(), found.rigour(), against(found)));
        (report.theorem.name(), found.collect::<Vec<_>>())
    };
    let text = r#"format = 2
title = "a nonlinear protocol"
time.end_s = 40
[[agents]]
name = "cart"
count = 2
robot.chain = { order = 2, chi = "-x", psi = "2 + cos(x)" }
start.position_m = [[0.5], [-0.5]]
[reference.desired]
polynomial = [0, 1]
nonlinear = "tanh(2*(heard - weights*x))"
stable_because = "its potential and kinetic energy fall"
input_to_state_stable_because = "a test"
[law.linearising]
[network]
edges = [["cart-1", "cart-2"], ["cart-2", "cart-1"]]
"#;
    let declared = (Answer::NotShown, Rigour::Declared, false);
    let closer = vec![declared, declared, (Answer::NotShown, Rigour::Sampled, false)];
    assert_eq!(of(text), ("desired-dynamics", closer.clone()));
    // Not *violated*: nobody can replay a run in floating point exactly.
    let diverges = vec![declared, declared, (Answer::NotShown, Rigour::Sampled, true)];
    // They drive each other apart; and a cubic drives them to infinity in finite time.
    for wrong in ["-tanh(2*(heard - weights*x))", "x^3"] {
        assert_eq!(of(&text.replace("tanh(2*(heard - weights*x))", wrong)), ("desired-dynamics", diverges.clone()));
    }
    let target = text.replace(
        "nonlinear = \"tanh(2*(heard - weights*x))\"",
        "follows_target = true\nnonlinear = \"-(x - xd)^3 - x\"",
    );
    let target = target.replace("[[0.5], [-0.5]]", "[[0.5], [-0.5]]\ntarget.formulas = [\"0.1*sin(t)\"]");
    let (theorem, found) = of(target.split("[network]").next().unwrap());
    assert_eq!((theorem, found[2]), ("chains-track", closer[2]));
    // A target, neighbours and time in one: what is asked of links is asked all the same. Carts that flee each other are found out.
    let both = target.replace("-(x - xd)^3 - x", "-(x - xd) + (1 + exp(-t))*(heard - weights*x)");
    assert_eq!(of(&both), ("desired-dynamics", closer.clone()));
    let flee = both.replace("(1 + exp(-t))", "-(2 + exp(-t))");
    assert_eq!(of(&flee), ("desired-dynamics", diverges.clone()));
    // A run that is too short to come closer shows nothing, and one that flees is found out however short it is.
    let short = |text: &str| of(&text.replace("end_s = 40", "end_s = 0.01"));
    assert_eq!(short(text), ("desired-dynamics", closer.clone()));
    assert_eq!(short(&text.replace("tanh(2*(heard - weights*x))", "x^3")), ("desired-dynamics", diverges));
    // They swing for ever about 0, and do not agree: nothing grows.
    let swing = text.replace("tanh(2*(heard - weights*x))", "-x + dx*(1 - x^2)").replace("[0, 1]", "[0, 0]");
    assert_eq!(of(&swing).1[2], closer[2]);
}

#[test]
fn thm6_lengths_outside_their_bounds_are_named_with_the_agent() {
    let found = |upper| {
        let report = check(&bounded_lengths(upper));
        report.hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::LengthsWithinBounds).unwrap()
    };
    let inside = found(1.5);
    assert_eq!(inside.evidence, Evidence::Kind(KindEvidence::ParametersInside));
    assert!(matches!(&inside.subject, Subject::Agent(agent) if (agent.index, &*agent.name) == (0, "arm")));
    let outside = found(0.9);
    assert_eq!(outside.answer(), Answer::Violated);
    let Evidence::Kind(KindEvidence::ParameterOutside { agent, name: Some(name), value, .. }) = &outside.evidence
    else {
        panic!("{outside:?}")
    };
    assert_eq!(*value, 1.0);
    assert_eq!((agent.index, &*agent.name), (0, "arm"));
    assert_eq!(outside.because(), format!("{name} of arm is 1, which is outside 0.5 to 0.9"));
}

#[test]
fn targets_of_different_kinds_fall_under_no_single_theorem() {
    let report = check(&arm_and_spacecraft());
    assert_eq!(report.theorem, Theorem::Targets(vec![Theorem::Theorem6, Theorem::Theorem7]));
    assert_eq!(report.theorem.to_string(), "a theorem of Section V for every agent");
    assert_eq!(report.promises, "every agent reaches its own target");
    let has = |id| report.hypotheses.iter().any(|hypothesis| hypothesis.id == id);
    assert!(has(Id::TaskSpaceGains) && has(Id::AttitudeGains) && !has(Id::OneKind));
}

#[test]
fn every_law_wants_as_many_derivatives_of_a_target_as_it_uses() {
    let wanted = |setup: &Setup| -> Vec<usize> {
        let report = check(setup);
        let subjects = report.hypotheses.into_iter().filter(|hypothesis| hypothesis.id == Id::BoundedTarget);
        let derivatives = subjects.map(|hypothesis| match hypothesis.subject {
            Subject::Targets { derivatives, .. } | Subject::Offsets { derivatives, .. } => derivatives,
            other => panic!("{other:?}"),
        });
        derivatives.collect()
    };
    let of = |name| wanted(&shipped(name));
    assert_eq!(["without-velocity", "theorem-6", "theorem-7", "formation"].map(of), [[3], [2], [2], [4]]);
    assert_eq!(of("through-waypoints"), [2]);
    // Chains want as many as their reference dynamics have roots, as arms under (6)–(7) do; (46) one less than (50).
    let offset = shipped("formation").agents[0].target.clone();
    let moved = |mut setup: Setup| {
        setup.agents.iter_mut().for_each(|agent| agent.target.clone_from(&offset));
        let mut roots: Vec<usize> = setup.agents.iter().map(|agent| agent.roots_per_s.len()).collect();
        roots.sort_unstable();
        roots.dedup();
        (wanted(&setup), roots)
    };
    let (chains, roots) = moved(shipped("framework"));
    assert!(chains == roots && roots.len() > 1, "{chains:?} {roots:?}");
    assert_eq!(moved(shipped("thrust-continuous")).0, [3]);
    assert_eq!(moved(shipped("theorem-3-24-order-4")).0, [4]);
}

#[test]
fn vehicles_and_rotorcraft_say_the_same_of_their_gains_once() {
    let mut setup = shipped("theorem-4");
    let bodies = shipped("formation").agents;
    setup.agents[0] = bodies[0].clone();
    let report = check(&setup);
    let count = |id| report.hypotheses.iter().filter(|hypothesis| hypothesis.id == id).count();
    assert_eq!([Id::ThrustGains, Id::AngularVelocity, Id::OneKind].map(count), [1, 1, 0]);
    assert_eq!((report.theorem.name(), report.theorem.source()), ("theorem-4", Source::Derived), "one keeps an offset");
    // Chains of different orders are said to have orders of their own.
    let chains = check(&shipped("framework"));
    let has = |id| chains.hypotheses.iter().any(|hypothesis| hypothesis.id == id);
    assert!(has(Id::OwnOrders) && !has(Id::CommonOrder));
}

#[test]
fn thm9_from_an_estimate_of_zero_is_said_to_be_slow() {
    let mut setup = shipped("theorem-9");
    let mut slow = |start: f64| {
        for agent in &mut setup.agents {
            assert!(agent.change_law(|law: &mut Adaptive| law.estimate_start.fill(start)));
        }
        let report = check(&setup);
        let shared = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::SharedDesign).unwrap();
        shared.because().contains("converges very slowly")
    };
    assert_eq!([0.0, 1.0].map(&mut slow), [true, false]);
}
