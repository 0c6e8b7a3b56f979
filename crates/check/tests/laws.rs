//! Verdicts about laws of Sections IV and V: what they need to know, and what has to be bounded.

use crate::common::kinds::{
    alone, blind_mass, cascade, chain, change_tip, fading_power_of_time, filtered_spacecraft, formula, modelled_mass,
    planar_tip, power_of_time, rest_at, spacecraft, tracking, tree_tip, vehicle,
};
use crate::common::{About, answer, answers, arm};
use forwardstep_check::hypothesis::Subject;
use forwardstep_check::{Answer, Id, Source, Theorem, check};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::{Expression, Number, Unary};
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::CascadeTerms;
use forwardstep_core::robot::tree::JointKind::{Prismatic, Revolute};
use forwardstep_core::robot::tree::{JointKind, Uncertain};
use forwardstep_sim::reference::Consensus;
use forwardstep_sim::trajectory::{Path, Trajectory};
use forwardstep_sim::{AgentSetup, ChainModel, Setup, SpacecraftModel, ThrustKind};
use std::sync::Arc;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// What is said about the regressor of an arm, and which lengths are named.
fn regressor(kinds: [JointKind; 3], axes: [[f64; 3]; 3], uncertain: Uncertain) -> (Answer, Vec<usize>) {
    let setup = tracking(tree_tip(kinds, axes, uncertain), vec![rest_at(0.1), rest_at(0.2), rest_at(0.3)]);
    let report = check(&setup);
    let named = |k: &usize| report.hypotheses.iter().any(|h| h.because().contains(&format!("length-{k}")));
    (answer(&setup, About::Regressor), (0..9).filter(named).collect())
}

#[test]
fn thm6_lengths_that_the_regressor_holds_are_not_covered_and_no_others() {
    let turning = [Revolute; 3];
    // A tool is in no dynamics.
    assert_eq!(regressor(turning, [Z, Y, Y], Uncertain::Tool), (Answer::Holds, vec![]));
    // Along the one axis that has turned so far nothing enters; behind two that differ, all does.
    let all_of_the_second = vec![0, 1, 3, 4, 5];
    assert_eq!(regressor(turning, [Z, Y, Y], Uncertain::Chain), (Answer::NotCovered, all_of_the_second));
    // With parallel axes the part along them never does.
    assert_eq!(regressor(turning, [Y, Y, Y], Uncertain::Chain), (Answer::NotCovered, vec![0, 2, 3, 5]));
    assert_eq!(regressor(turning, [Y, Y, X], Uncertain::Chain), (Answer::NotCovered, vec![0, 2, 3, 5]));
    // What only slides turns nothing.
    assert_eq!(regressor([Prismatic; 3], [X, Y, Z], Uncertain::Chain), (Answer::Holds, vec![]));
    assert_eq!(regressor([Prismatic, Prismatic, Revolute], [X, Y, Z], Uncertain::Chain), (Answer::Holds, vec![]));
    assert_eq!(
        regressor([Prismatic, Revolute, Revolute], [X, Z, Z], Uncertain::Chain),
        (Answer::NotCovered, vec![3, 4])
    );
    assert_eq!(
        regressor([Revolute, Prismatic, Revolute], [Z, X, Z], Uncertain::Chain),
        (Answer::NotCovered, vec![0, 1, 3, 4])
    );
}

#[test]
fn thm6_lengths_that_are_known_may_be_in_the_regressor_and_wrong_ones_have_to_be_adapted() {
    let said = |adapted: bool, known: bool| {
        let mut agent = tree_tip([Revolute; 3], [Z, Y, Y], Uncertain::Chain);
        let kind = agent.robot.kind.clone();
        change_tip(&mut agent, |law| {
            if known {
                law.kinematic_start = law.tip.parameters(&*kind).unwrap();
            }
            if !adapted {
                law.kinematic_adaptation = None;
            }
        });
        let setup = tracking(agent, vec![rest_at(0.1), rest_at(0.2), rest_at(0.3)]);
        [answer(&setup, About::Regressor), answer(&setup, About::TaskSpaceGains)]
    };
    assert_eq!(said(true, false), [Answer::NotCovered, Answer::Holds]);
    assert_eq!(said(true, true), [Answer::NotCovered, Answer::Holds]);
    assert_eq!(said(false, true), [Answer::Holds; 2]);
    assert_eq!(said(false, false), [Answer::NotCovered; 2]);
}

#[test]
fn thm6_lengths_outside_their_bounds_violate_them() {
    // The true lengths are 1 m and 0.8 m.
    let said = |lower: [f64; 2], upper: [f64; 2]| {
        let mut agent = planar_tip();
        let bounds = ParameterBounds::new(lower.to_vec(), upper.to_vec(), 0.1);
        change_tip(&mut agent, |law| law.bounds = Some(bounds));
        answer(&tracking(agent, vec![rest_at(0.8), rest_at(0.6)]), About::Lengths)
    };
    assert_eq!(said([0.9, 0.7], [1.1, 0.9]), Answer::Holds);
    assert_eq!(said([1.0, 0.8], [1.0, 0.8]), Answer::Holds, "a bound belongs to what it bounds");
    assert_eq!(said([1.05, 0.7], [1.1, 0.9]), Answer::Violated);
    assert_eq!(said([0.9, 0.7], [0.95, 0.9]), Answer::Violated);
    assert_eq!(said([0.9, 0.85], [1.1, 0.9]), Answer::Violated);
    assert_eq!(said([0.9, 0.7], [1.1, 0.75]), Answer::Violated);
    let unbounded = tracking(planar_tip(), vec![rest_at(0.8), rest_at(0.6)]);
    assert!(answers(&check(&unbounded), About::Lengths).is_empty());
}

#[test]
fn thm6_a_jacobian_that_is_singular_at_the_start_is_violated() {
    let said = |elbow: f64| {
        let mut agent = planar_tip();
        agent.start.q[1] = elbow;
        answer(&tracking(agent, vec![rest_at(0.8), rest_at(0.6)]), About::Determinant)
    };
    assert_eq!([1.4, 0.0].map(said), [Answer::Watched, Answer::Violated]);
    // One part in a million of the largest singular value, or less, is zero for the law.
    assert_eq!([1e-3, 1e-7].map(said), [Answer::Watched, Answer::Violated]);
}

#[test]
fn eq_a8_and_57_and_by_a_model_an_estimate_that_is_not_adapted_has_to_be_the_mass() {
    let blind = |adaptation, start| {
        let mut agent = blind_mass(adaptation, start);
        agent.roots_per_s.real.truncate(2);
        answer(&alone(agent), About::PositionOnlyGains)
    };
    assert_eq!([blind(5.0, 0.3), blind(0.0, 2.0), blind(0.0, 0.3)], [Answer::Holds, Answer::Holds, Answer::NotCovered]);
    let modelled = |adaptation, start| {
        answer(&tracking(modelled_mass(adaptation, start), vec![rest_at(0.5)]), About::ModelReferenceGains)
    };
    let said = [modelled(5.0, 0.3), modelled(0.0, 2.0), modelled(0.0, 0.3)];
    assert_eq!(said, [Answer::Holds, Answer::Holds, Answer::NotCovered]);
    let flown = |gamma_star, estimate_start| {
        let design = ThrustKind::Adaptive { alpha_star: 3.0, gamma_star, estimate_start, bounds: None };
        answer(&alone(vehicle(design, Floor::Stops(1.0))), About::ThrustGains)
    };
    assert_eq!([flown(0.2, 0.3), flown(0.0, 2.0), flown(0.0, 0.3)], [Answer::Holds, Answer::Holds, Answer::NotCovered]);
}

#[test]
fn thm4_a_thrust_that_is_kept_above_a_floor_is_not_covered() {
    let design = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
    let kept = Floor::Kept { floor: 1.0, approach_s: 0.1 };
    let said = |floors: &[Floor]| {
        let mut setup = alone(vehicle(design, floors[0]));
        setup.agents = floors.iter().map(|floor| vehicle(design, *floor)).collect();
        setup.network.agents = floors.len();
        answer(&setup, About::Thrust)
    };
    assert_eq!(said(&[Floor::Stops(1.0)]), Answer::Watched);
    assert_eq!(said(&[kept]), Answer::NotCovered);
    assert_eq!(said(&[Floor::Stops(1.0), kept]), Answer::NotCovered, "one is enough");
}

#[test]
fn eq_43_a_factor_of_the_input_holds_where_it_keeps_away_from_zero_in_every_state_and_else_is_watched() {
    let x = || Expression::variable(0);
    let constant = chain(&Expression::number(2.0), 0, false);
    assert_eq!(answer(&alone(constant), About::Divisor), Answer::Holds);
    let of = |psi: Expression| {
        let report = check(&alone(chain(&psi, 0, false)));
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::InputFactor).unwrap();
        (found.answer(), found.because())
    };
    assert_eq!(of(x().cos_of() + 2.0), (Answer::Holds, "in every state it is 1 at least in magnitude".into()));
    assert_eq!(of(-x().power(2.0) - 0.25).0, Answer::Holds);
    // Positive, but as small as one likes; of both signs; below the floor of 1e-3.
    let (answered, because) = of((-x().power(2.0)).exp_of());
    assert!(
        answered == Answer::Watched && because.ends_with("that it keeps away from zero far away was not shown"),
        "{because}"
    );
    let (answered, because) = of(x() - 0.7);
    assert!(answered == Answer::Watched && because.ends_with("comes to zero in the state (0.7)"), "{because}");
    assert_eq!(of(x().power(2.0) + 1e-4).0, Answer::Watched);
    // Exactly zero, though f64 has 5.6e-17.
    let tenth = |text: &str| Expression::number(Number::decimal(text).unwrap());
    let (answered, because) = of(tenth("0.1") + tenth("0.2") - tenth("0.3"));
    assert!(answered == Answer::Violated && because.contains(" is 0 for ever"), "{because}");
    // A constant may be too small from the start: the floor is 1e-3.
    for (psi, answered) in [
        (0.0, Answer::Violated),
        (9e-4, Answer::Violated),
        (-9e-4, Answer::Violated),
        (1e-3, Answer::Holds),
        (-2.0, Answer::Holds),
    ] {
        assert_eq!(answer(&alone(chain(&Expression::number(psi), 0, false)), About::Divisor), answered, "{psi}");
    }
    let cancelled = Expression::number(0.5) - 0.5;
    assert_eq!(answer(&alone(chain(&cancelled, 0, false)), About::Divisor), Answer::Violated);
    // Strict feedback with a constant input, with one that varies, and pure feedback, which divides by ∂f/∂x_2.
    let strict = || Expression::variable(1);
    let bent = || Expression::variable(1) + Expression::variable(1).power(3.0);
    let one = || Expression::number(1.0);
    assert_eq!(answer(&alone(cascade(strict(), one(), 1)), About::Divisor), Answer::Holds);
    assert_eq!(answer(&alone(cascade(strict(), x().cos_of() + 2.0, 1)), About::Divisor), Answer::Holds);
    assert_eq!(answer(&alone(cascade(bent(), one(), 1)), About::Divisor), Answer::Watched);
    // Between two and four where it has a value, which is not everywhere.
    let partly = x().log_of().under(Unary::Tanh) + 3.0;
    assert_eq!(answer(&alone(chain(&partly, 0, false)), About::Divisor), Answer::Watched);
    // Nothing moves the first equation where its slope along x_2 is zero, whatever it is written with.
    let level = || strict() * 0.0 + x().sin_of();
    for known in [x(), level(), strict() - strict(), (strict() * 0.0).cos_of()] {
        let report = check(&alone(cascade(known, one(), 1)));
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::InputFactor).unwrap();
        assert_eq!(
            (found.answer(), &*found.because()),
            (Answer::Violated, "x2 does not move equation 1 of agent: its slope is 0 for ever")
        );
        assert_eq!(found.change().unwrap(), "a term of x2 in equation 1 of agent, such as x2 itself");
    }
}

#[test]
fn eq_33_terms_have_a_value_in_every_state() {
    let x = || Expression::variable(0);
    let one = || Expression::number(1.0);
    let said = |psi: Expression| {
        let report = check(&alone(chain(&psi, 1, true)));
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::DefinedTerms).unwrap();
        (found.answer(), found.because())
    };
    assert_eq!(said(x().cos_of() + 2.0).0, Answer::Holds);
    let (answered, because) = said(one() / (x() - 0.7));
    assert_eq!(
        (answered, &*because),
        (Answer::Violated, "ψ of agent has a pole, in the state (0.7); a run may step over it")
    );
    let (answered, because) = said((x() - 0.6).sqrt_of() + 1.0);
    assert!(answered == Answer::Violated && because.contains("of what is negative"), "{because}");
    // 0/0 may have a limit.
    assert_eq!(said(x().sin_of() / x() + 2.0).0, Answer::NotShown);
    // Terms of cascades as well.
    let cascaded = |known| {
        let report = check(&alone(cascade(known, Expression::number(1.0), 1)));
        report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::DefinedTerms).unwrap().answer()
    };
    let next = || Expression::variable(1);
    assert_eq!([cascaded(next()), cascaded(next() + one() / x())], [Answer::Holds, Answer::Violated]);
}

/// Of a strict-feedback chain of n equations n − 1 derivatives are taken, of a pure-feedback chain n.
#[test]
fn regress_terms_of_chains_bear_the_derivatives_that_backstepping_takes() {
    let x = Expression::variable;
    let number = Expression::number;
    let said = |order: usize, term: Expression, pure: bool| {
        let mut agent = cascade(x(1), number(1.0), 1);
        let mut known: Vec<Expression> = (1..order).map(x).collect();
        known.push(number(0.0));
        if pure {
            known[0] = x(1) + x(1).power(3.0) + term.clone();
        }
        let first = if pure { number(0.0) } else { term };
        let regressors = (0..order).map(|i| vec![if i == 0 { first.clone() } else { number(0.0) }]).collect();
        agent.robot.kind =
            Arc::new(ChainModel::Cascade(Arc::new(CascadeTerms::new(known, regressors, number(1.0)).unwrap())));
        let report = check(&alone(agent));
        let found = report.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::DefinedTerms).unwrap();
        (found.answer(), found.because(), found.change())
    };
    let power = |exponent: f64| x(0).power(2.0).power(exponent);
    let answers = |order: usize, pure: bool, exponents: &[f64]| -> Vec<Answer> {
        exponents.iter().map(|exponent| said(order, power(*exponent), pure).0).collect()
    };
    use Answer::{Holds, NotShown};
    assert_eq!(answers(2, false, &[1.25, 2.5]), [Holds, Holds]);
    assert_eq!(answers(3, false, &[1.5, 2.5]), [NotShown, Holds]);
    assert_eq!(answers(4, false, &[1.25, 2.5, 3.5]), [NotShown, NotShown, Holds]);
    assert_eq!(answers(2, true, &[1.25, 2.5]), [NotShown, Holds]);
    // Of what is positive everywhere any power will do.
    assert_eq!(said(4, (x(0).power(2.0) + 1.0).power(0.25), false).0, Holds);
    assert_eq!(said(4, (x(0).power(2.0) + 1.0).sqrt_of(), false).0, Holds);
    let (_, because, change) = said(4, power(1.25), false);
    assert!(because.contains("is not shown to have 3 derivatives there"), "{because}");
    assert!(change.unwrap().contains("exponents of 3 or more"));
}

#[test]
fn eq_43_regressors_have_to_be_bounded_where_they_are_adapted_by_the_gradient() {
    let one = Expression::number(1.0);
    let said = |agent: AgentSetup| answers(&check(&alone(agent)), About::Regressors);
    assert_eq!(said(chain(&one, 1, true)), [Answer::Watched]);
    assert_eq!(said(chain(&one, 0, true)), []);
    assert_eq!(said(chain(&one, 1, false)), []);
    let strict = |parameters| cascade(Expression::variable(1), Expression::number(1.0), parameters);
    assert_eq!(said(strict(1)), [Answer::Watched]);
    assert_eq!(said(strict(0)), []);
}

/// A path with `bounded` derivatives that are bounded for ever, beginning with the zeroth, and no more.
fn smooth(bounded: i32) -> Path {
    // t^(k − ½) has k − 1 derivatives that are finite at t = 0.
    fading_power_of_time(0.01, f64::from(bounded) - 0.5)
}

/// How many derivatives of its target an agent needs, beside the target itself.
fn needed(agent: &AgentSetup, about: About) -> usize {
    let axes = if agent.robot.kind.is::<SpacecraftModel>() { 4 } else { agent.robot.axes.len() };
    let said = |bounded: i32| {
        let mut paths: Vec<Path> = (0..axes).map(|_| rest_at(0.1)).collect();
        *paths.last_mut().unwrap() = smooth(bounded);
        let mut setup = tracking(agent.clone(), paths);
        if about == About::Offset {
            setup.reference = Arc::new(Consensus);
        }
        answer(&setup, about)
    };
    let answers: Vec<Answer> = (1..=5).map(said).collect();
    let first = answers.iter().position(|answer| *answer != Answer::NotShown).unwrap_or(5);
    assert!(answers[first..].iter().all(|answer| *answer == Answer::Holds), "{answers:?}");
    first
}

#[test]
fn eq_a9_and_others_need_as_many_derivatives_of_a_target_as_they_take() {
    assert_eq!(needed(&blind_mass(5.0, 0.3), About::Target), 3, "(a9) takes the jerk of its target");
    assert_eq!(needed(&modelled_mass(5.0, 0.3), About::Target), 2, "a model takes the acceleration of its target");
    assert_eq!(needed(&planar_tip(), About::Target), 2);
    assert_eq!(needed(&spacecraft(), About::Target), 2);
    assert_eq!(needed(&filtered_spacecraft(), About::Target), 2);
    for roots in 1..=4 {
        let mut plant = chain(&Expression::number(1.0), 0, false);
        plant.roots_per_s = vec![1.0; roots].into();
        assert_eq!(needed(&plant, About::Target), roots, "as many as there are roots");
    }
    let floor = Floor::Stops(1.0);
    let differentiable = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
    assert_eq!(needed(&vehicle(ThrustKind::Continuous, floor), About::Offset), 3);
    assert_eq!(needed(&vehicle(differentiable, floor), About::Offset), 4);
}

#[test]
fn targets_are_bounded_for_ever_refuted_or_not_shown_to_be() {
    let said = |path: Path| answer(&tracking(blind_mass(5.0, 0.3), vec![path]), About::Target);
    assert_eq!(said(formula(Expression::variable(0).sin_of() * 0.3)), Answer::Holds);
    assert_eq!(said(power_of_time(0.1, 2.0)), Answer::Violated);
    // A target has to stay where it is, an offset may travel.
    assert_eq!(said(formula(Expression::variable(0) * 0.3)), Answer::Violated);
    let mut travelling: Setup = alone(vehicle(ThrustKind::Continuous, Floor::Stops(1.0)));
    let drift = vec![formula(Expression::variable(0) * 0.3), rest_at(0.0), rest_at(0.0)];
    travelling.agents[0].target = Some(Trajectory::new(drift).unwrap());
    assert_eq!(answer(&travelling, About::Offset), Answer::Holds);
    // Any axis may be the one that is not bounded.
    let late = vec![rest_at(0.0), rest_at(0.0), power_of_time(0.1, 0.5)];
    travelling.agents[0].target = Some(Trajectory::new(late).unwrap());
    assert_eq!(answer(&travelling, About::Offset), Answer::NotShown);
}

#[test]
fn thm7_a_quaternion_that_comes_to_zero_is_violated_and_one_that_does_not_holds() {
    let said =
        |last: Path| answer(&tracking(spacecraft(), vec![rest_at(0.0), rest_at(0.0), rest_at(0.0), last]), About::Path);
    assert_eq!(said(rest_at(1.0)), Answer::Holds);
    assert_eq!(said(rest_at(-1.0)), Answer::Holds);
    // It passes zero at π.
    assert_eq!(said(formula(Expression::variable(0).sin_of())), Answer::Violated);
    let shrinking = formula(Expression::variable(0) * -0.04 + 1.0);
    assert_eq!(said(shrinking), Answer::Violated, "at 20 s it is 0.2, and at 25 s it is zero");
    assert_eq!(said(formula((-Expression::variable(0)).exp_of())), Answer::Violated, "it fades");
    assert_eq!(said(formula((-Expression::variable(0)).exp_of() + 0.1)), Answer::Holds);
}

/// (6)–(7) behind reference dynamics for tracking: no theorem of the paper, and that is said.
#[test]
fn robots_that_track_fall_under_no_theorem_of_the_paper_and_all_that_their_argument_asks_for_is_shown() {
    for (roots, derivatives) in [(1, 2), (2, 2), (3, 3), (4, 4)] {
        let agent = arm(0, &vec![2.0; roots]);
        let swing = || formula((Expression::variable(0) * 0.7).sin_of());
        let setup = tracking(agent, vec![swing(), swing()]);
        let report = check(&setup);
        assert_eq!((&report.theorem, report.worst()), (&Theorem::RobotsTrack, Answer::Holds));
        assert_eq!(report.theorem.source(), Source::Derived);
        assert!(report.theorem.to_string().starts_with("no theorem of the paper"));
        let has = |id: Id| report.hypotheses.iter().any(|hypothesis| hypothesis.id == id);
        assert!([Id::BoundedTarget, Id::PositiveGains, Id::Hurwitz, Id::AppliedTorque].into_iter().all(has));
        let asked = report.hypotheses.iter().find_map(|hypothesis| match &hypothesis.subject {
            Subject::Targets { derivatives, .. } => Some(*derivatives),
            _ => None,
        });
        assert_eq!(asked, Some(derivatives));
    }
    // Of a parabola not even the velocity is bounded for ever.
    let setup = tracking(arm(0, &[2.0]), vec![power_of_time(0.01, 2.0), rest_at(0.0)]);
    assert_eq!(check(&setup).worst(), Answer::Violated);
}
