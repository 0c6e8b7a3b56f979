//! Which desired dynamics are a design of the paper, and that each part of what is written counts.

use std::sync::Arc;

use forwardstep_check::{Id, check};
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::WrittenIn;
use forwardstep_sim::Setup;
use forwardstep_sim::reference::{Desired, DesiredPolynomial, Protocol};

use super::{constant, pair};
use crate::common::kinds::{chain, rest_at};
use forwardstep_sim::trajectory::Trajectory;

fn by_roots(integrators: usize, roots: &[f64]) -> DesiredPolynomial {
    DesiredPolynomial::Roots { integrators, roots: roots.to_vec().into() }
}

/// p K(p) with K = (p + 1)(p + 2), beside K(p) and K(0) x_j.
fn agreeing() -> Desired {
    Desired {
        polynomial: by_roots(1, &[1.0, 2.0]),
        coupling: Some(by_roots(0, &[1.0, 2.0])),
        heard: Vec::new(),
        follows_target: false,
        written: WrittenIn::Measured,
        protocol: None,
    }
}

/// Whether two agents under these dynamics are told that they are under a design of the paper.
fn is_design(mut setup: Setup, desired: Desired) -> bool {
    setup.exchange = desired.exchange();
    if desired.follows_target {
        let axes = setup.agents[0].robot.axes.len();
        let target = Trajectory::new((0..axes).map(|_| rest_at(0.1)).collect()).unwrap();
        setup.agents.iter_mut().for_each(|agent| agent.target = Some(target.clone()));
    }
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s.clear());
    setup.reference = Arc::new(desired);
    check(&setup).hypotheses.iter().any(|hypothesis| hypothesis.id == Id::DesiredDesign)
}

fn masses() -> Setup {
    pair([constant(0.1), constant(0.1)])
}

#[test]
fn eq_43_what_agrees_is_a_design_by_all_that_is_written_of_it() {
    let is = |change: fn(&mut Desired)| {
        let mut desired = agreeing();
        change(&mut desired);
        is_design(masses(), desired)
    };
    assert!(is(|_| {}));
    assert!(is(|desired| desired.heard = vec![2.0]) && is(|desired| desired.heard = vec![2.0, 2.0]));
    for heard in [vec![3.0], vec![3.0, 2.0], vec![2.0, 1.5], vec![3.0, 3.0]] {
        assert!(!is_design(masses(), Desired { heard: heard.clone(), ..agreeing() }), "{heard:?}");
    }
    assert!(!is(|desired| desired.polynomial = by_roots(0, &[1.0, 2.0])));
    assert!(!is(|desired| desired.polynomial = by_roots(2, &[1.0, 2.0])));
    assert!(!is(|desired| desired.coupling = None));
    assert!(!is(|desired| desired.coupling = Some(by_roots(0, &[1.0, 3.0]))));
    let protocol =
        || Protocol { term: Expression::variable(0) * -0.1, stable_because: None, input_to_state_stable_because: None };
    assert!(!is_design(masses(), Desired { protocol: Some(protocol()), ..agreeing() }));
    // In x it is (23), of order three and of robots alone; in z it is none.
    assert!(is(|desired| desired.written = WrittenIn::X) && !is(|desired| desired.written = WrittenIn::Z));
    let longer = |written| Desired {
        polynomial: by_roots(1, &[1.0, 2.0, 3.0]),
        coupling: Some(by_roots(0, &[1.0, 2.0, 3.0])),
        written,
        ..agreeing()
    };
    assert!(is_design(masses(), longer(WrittenIn::Measured)) && !is_design(masses(), longer(WrittenIn::X)));
    let mut chains = masses();
    let plant = chain(&Expression::number(1.0), 0, false);
    chains.agents = vec![plant.clone(), plant];
    assert!(is_design(chains.clone(), agreeing()));
    assert!(!is_design(chains, Desired { written: WrittenIn::X, ..agreeing() }));
}

#[test]
fn eq_43_what_follows_a_target_is_a_design_where_nothing_else_enters() {
    let following =
        || Desired { polynomial: by_roots(0, &[1.0, 2.0]), coupling: None, follows_target: true, ..agreeing() };
    assert!(is_design(masses(), following()));
    assert!(!is_design(masses(), Desired { polynomial: by_roots(1, &[1.0, 2.0]), ..following() }));
    assert!(!is_design(masses(), Desired { coupling: Some(by_roots(0, &[1.0, 2.0])), ..following() }));
    assert!(!is_design(masses(), Desired { heard: vec![2.0], ..following() }));
}
