//! Pairs of complex roots: what they are enough for, and where nothing holds with them.

use forwardstep_check::derivation::case::cases;
use forwardstep_check::hypothesis::{Evidence, FollowingEvidence, ReferenceEvidence};
use forwardstep_check::prediction::{NoCascade, NoRate, guaranteed_rate, rate};
use forwardstep_check::{Answer, Id, NoPrediction, Theorem, check, predict};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{RootPair, RootSet};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{Exchange, Setup, ThrustKind};

use super::led;
use crate::common::kinds::{alone, blind_mass, chain, rest_at, tracking, vehicle};
use crate::common::{arm, edge, masses};

fn with(real: &[f64], pairs: &[[f64; 2]]) -> RootSet {
    let pairs = pairs.iter().map(|[real, imaginary]| RootPair { real: *real, imaginary: *imaginary });
    RootSet { real: real.to_vec(), pairs: pairs.collect() }
}

/// What `check` answers about a hypothesis, with its evidence.
fn about(setup: &Setup, id: Id) -> Option<(Answer, Evidence)> {
    let found = check(setup).hypotheses.into_iter().find(|hypothesis| hypothesis.id == id)?;
    Some((found.answer(), found.evidence))
}

/// (119), (122) with α and β: whether they are Hurwitz, and the rate against which the period of the sign is held.
fn held(design: FollowingDesign, coefficients: [f64; 2]) -> (Answer, f64) {
    let graph = Schedule::fixed(vec![edge(2, 0, 1.0, 0), edge(0, 1, 1.0, 0)]);
    let setup = led(graph, design, coefficients);
    let Some((_, Evidence::Following(FollowingEvidence::Sign { rate_per_s, .. }))) = about(&setup, Id::SetValuedSign)
    else {
        panic!()
    };
    (about(&setup, Id::Hurwitz).unwrap().0, rate_per_s)
}

#[test]
fn thm9_a_pair_of_complex_roots_is_hurwitz_and_its_response_to_a_held_sign_swings() {
    for design in [FollowingDesign::Differentiable, FollowingDesign::WithoutAcceleration] {
        assert_eq!(held(design, [2.0, 3.0]), (Answer::Holds, 2.0_f64.sqrt()));
        // −0.3 ± 1.2 i: 1 + b/a is 5, more than the absolute integral of α times the impulse response, coth(π a/(2 b)).
        let alpha = 0.3 * 0.3 + 1.2 * 1.2;
        let (stable, by_pair) = held(design, [alpha, 0.6]);
        assert_eq!(stable, Answer::Holds);
        assert!((by_pair - (5.0 * alpha).sqrt()).abs() < 1e-12, "{by_pair}");
        let response = |t: f64| alpha * (-0.3 * t).exp() * (1.2 * t).sin().abs() / 1.2;
        let integral: f64 = (0..400_000).map(|k| response((f64::from(k) + 0.5) * 1e-4) * 1e-4).sum();
        let exact = 1.0 / (std::f64::consts::PI * 0.3 / 2.4).tanh();
        assert!((integral - exact).abs() < 1e-3 && exact < 5.0, "{integral} {exact}");
    }
}

#[test]
fn prop_complex_roots_are_not_shown_to_lead_to_agreement() {
    let ring = || Schedule::fixed((0..5).map(|k| edge(k, (k + 1) % 5, 1.0, 0)).collect());
    let flying = vehicle(ThrustKind::Continuous, Floor::Stops(0.1));
    let of_roots = [
        masses(Exchange::Position, 3, ring(), vec![Delay::constant(0.1)]),
        masses(Exchange::PositionVelocity, 3, ring(), vec![Delay::constant(0.1)]),
        alone(chain(&Expression::number(1.0), 0, false)),
        alone(blind_mass(1.0, 1.0)),
        alone(flying),
    ];
    for mut setup in of_roots {
        assert_eq!(about(&setup, Id::RealRoots).unwrap().0, Answer::Holds, "{}", check(&setup).theorem);
        setup.agents[0].roots_per_s = with(&[1.0], &[[0.1, 2.0]]);
        let (answer, evidence) = about(&setup, Id::RealRoots).unwrap();
        assert_eq!(answer, Answer::NotShown);
        let Evidence::Reference(ReferenceEvidence::ComplexRoots { pair, .. }) = evidence else {
            panic!("{evidence:?}")
        };
        assert_eq!(pair, RootPair { real: 0.1, imaginary: 2.0 });
        assert_eq!(about(&setup, Id::Hurwitz), None);
        let said = check(&setup).hypotheses.into_iter().find(|found| found.id == Id::RealRoots).unwrap();
        assert!(said.because().contains("−0.1 ± 2i") && said.change().unwrap().contains("real roots"));
    }
}

#[test]
fn prop_complex_roots_are_enough_to_follow_a_target() {
    let swing = || rest_at(0.3);
    let trackers = [
        tracking(arm(0, &[1.0]), vec![swing(), swing()]),
        tracking(blind_mass(1.0, 1.0), vec![swing()]),
        tracking(chain(&Expression::number(1.0), 0, false), vec![swing()]),
    ];
    for mut setup in trackers {
        setup.agents[0].roots_per_s = with(&[1.0], &[[0.1, 2.0]]);
        let evidence: Evidence = ReferenceEvidence::Hurwitz { slowest_per_s: 0.1 }.into();
        assert_eq!(about(&setup, Id::Hurwitz), Some((Answer::Holds, evidence)), "{}", check(&setup).theorem);
        assert_eq!(about(&setup, Id::RealRoots), None);
        setup.agents[0].roots_per_s.pairs[0].real = -0.1;
        assert_eq!(about(&setup, Id::Hurwitz).unwrap().0, Answer::Violated);
    }
}

/// Two masses that hear each other, both with a pair of complex roots.
fn two(pair: [f64; 2], weight: f64, delay_s: f64) -> Setup {
    let graph = Schedule::fixed(vec![edge(0, 1, weight, 0), edge(1, 0, weight, 0)]);
    let mut setup = masses(Exchange::Position, 2, graph, vec![Delay::constant(delay_s)]);
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = with(&[], &[pair]));
    setup
}

/// The difference of two agents under (24) of order two goes by (p + w)(p² + 2 a p + c²) + w c², which by Routh is stable exactly if
/// (w + 2 a)(c² + 2 a w) > 2 w c².
#[test]
fn the_rate_of_complex_roots_is_that_of_their_characteristic_polynomial_or_says_that_it_grows() {
    for (a, b, w) in
        [(0.1, 2.0, 1.0), (0.5, 2.0, 1.0), (1.5, 2.0, 1.0), (0.1, 2.0, 0.1), (0.1, 2.0, 30.0), (1.0, 0.5, 3.0)]
    {
        let square = a * a + b * b;
        let polynomial = [2.0 * w * square, square + 2.0 * a * w, w + 2.0 * a, 1.0];
        let stable = (w + 2.0 * a) * (square + 2.0 * a * w) > 2.0 * w * square;
        let value = |polynomial: &[f64], [x, y]: [f64; 2]| {
            let next = |[u, v]: [f64; 2], c: &f64| [u * x - v * y + c, u * y + v * x];
            let [u, v] = polynomial.iter().rev().fold([0.0; 2], next);
            u.hypot(v)
        };
        match rate(&two([a, b], w, 0.0)) {
            Ok(found) => {
                assert!(stable && found.root_per_s[0] < 0.0, "{a} {b} {w}: {found:?}");
                // A root of the sum of the agents, which goes by p (p² + (w + 2 a) p + c² + 2 a w), may be slower.
                let of_sum = value(&[square + 2.0 * a * w, w + 2.0 * a, 1.0], found.root_per_s);
                assert!(of_sum.min(value(&polynomial, found.root_per_s)) < 1e-6, "{a} {b} {w}: {found:?}");
            }
            Err(NoRate::Grows { per_s }) => assert!(!stable && per_s > 0.0, "{a} {b} {w}: {per_s}"),
            Err(error) => panic!("{a} {b} {w}: {error}"),
        }
    }
    assert!(matches!(rate(&two([0.3, 2.0], 1.0, 0.7)), Ok(_) | Err(NoRate::Grows { .. })));
}

#[test]
fn what_needs_the_chain_of_averages_refuses_complex_roots() {
    let setup = two([1.5, 2.0], 1.0, 0.0);
    assert_eq!(predict(&setup), Err(NoPrediction::ComplexRoots { agent: 0 }));
    let refused = guaranteed_rate(&setup, 1e6).unwrap_err();
    assert_eq!(refused, NoCascade::ComplexRoots { agent: 0 }.into());
    assert_eq!(check(&setup).theorem, Theorem::Theorem3Positions { order: 2 });
    let case = &cases(&setup)[0];
    assert_eq!((case.roots.order(), case.roots.all_real()), (2, None));
}
