//! Desired dynamics that a user writes down (Section IV-B): their instances are the designs of the paper, bit for bit, and the
//! variables they are written in make no difference where s ≡ 0.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::reference::{RootPair, RootSet, WrittenIn};
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::reference::{Desired, DesiredPolynomial, PureIntegral, Tracking};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{ChainStep, Exchange, Known, Network, Outcome, Setup, SetupError, Signal, simulate};

use crate::common::chains::{estimate, of_all_orders, tracking};
use crate::common::{assert_first_order, balance_residual, column, columns, consensus_of_masses, run, switching};

pub(super) fn by_roots(integrators: usize, roots: impl Into<RootSet>) -> DesiredPolynomial {
    DesiredPolynomial::Roots { integrators, roots: roots.into() }
}

/// p A(p) x = −Σ_j w_ij [A(p) x − what is heard] for the roots of A.
pub(super) fn agreeing(roots: &[f64], heard: &[f64], written: WrittenIn) -> Desired {
    Desired {
        polynomial: by_roots(1, roots),
        coupling: Some(by_roots(0, roots)),
        heard: heard.to_vec(),
        follows_target: false,
        written,
        protocol: None,
    }
}

pub(super) fn following(polynomial: DesiredPolynomial, written: WrittenIn) -> Desired {
    Desired { polynomial, coupling: None, heard: Vec::new(), follows_target: true, written, protocol: None }
}

/// `setup` under these desired dynamics.
pub(super) fn under(mut setup: Setup, desired: Desired) -> Setup {
    setup.exchange = desired.exchange();
    setup.reference = Arc::new(desired);
    for agent in &mut setup.agents {
        agent.roots_per_s.clear();
    }
    setup
}

fn assert_same_bits(one: &Outcome, other: &Outcome) {
    assert_eq!(one.recording.columns.len(), other.recording.columns.len());
    for (a, b) in one.recording.columns.iter().zip(&other.recording.columns) {
        assert_eq!((a.signal, &a.values), (b.signal, &b.values), "agent {}", a.agent);
    }
}

/// The largest distance of positions at any time.
pub(super) fn apart(one: &Outcome, other: &Outcome) -> f64 {
    let (one, other) = (columns(one, Signal::Position), columns(other, Signal::Position));
    let each = |(a, b): (&&[f64], &&[f64])| a.iter().zip(*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    one.iter().zip(&other).map(each).fold(0.0, f64::max)
}

pub(super) fn steps() -> [ChainStep; 2] {
    let adaptive = ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]) };
    [ChainStep::Linearising { gain_per_s: 2.0 }, adaptive]
}

pub(super) const ROOTS: [f64; 4] = [1.0, 2.0, 1.5, 1.2];

/// The chains have orders 2, 3 and 4, so N = 4 and 5 are order invariance and increment.
#[test]
fn eq_43_consensus_of_chains_is_an_instance_of_desired_dynamics() {
    for (step, order) in steps().iter().zip([3, 4]) {
        let mut setup = of_all_orders(step, [order; 3]);
        setup.time.end_s = 10.0;
        let desired = agreeing(&ROOTS[..order], &[], WrittenIn::Measured);
        assert_same_bits(&run(&setup), &run(&under(setup.clone(), desired)));
    }
}

/// (a9) for plants of orders 3, 2 and, under backstepping, 1, with complex roots; by roots and by the coefficients that they have.
#[test]
fn eq_43_tracking_is_an_instance_of_desired_dynamics() {
    let roots = RootSet { real: vec![1.5, 2.0], pairs: vec![RootPair { real: 0.5, imaginary: 1.0 }] };
    let mut setup = tracking();
    setup.time.end_s = 10.0;
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = roots.clone());
    let truth = run(&setup);
    let coefficients = forwardstep_core::reference::polynomial(&roots).unwrap()[..4].to_vec();
    for polynomial in [by_roots(0, roots), DesiredPolynomial::Coefficients(coefficients)] {
        assert_same_bits(&truth, &run(&under(setup.clone(), following(polynomial, WrittenIn::Measured))));
    }
}

/// Point masses under (6) with known masses, which follow targets.
fn masses_with_targets(roots: &[f64]) -> Setup {
    let mut setup = crate::common::masses::tracking();
    setup.time.end_s = 10.0;
    for agent in &mut setup.agents {
        agent.law = Arc::new(Known { damping: Gain::Number(6.0) });
        agent.roots_per_s = roots.into();
    }
    setup.reference = Arc::new(Tracking);
    setup
}

#[test]
fn eq_a9_of_robots_is_an_instance_of_desired_dynamics() {
    for order in 2..5 {
        let setup = masses_with_targets(&ROOTS[..order]);
        let desired = following(by_roots(0, &ROOTS[..order]), WrittenIn::Measured);
        assert_same_bits(&run(&setup), &run(&under(setup.clone(), desired)));
    }
}

/// (aa10), (a1), (a5) and (24) of orders one to three.
#[test]
fn eq_24_and_eq_a5_of_robots_are_instances_of_desired_dynamics() {
    for order in 1..4 {
        let roots = &ROOTS[..order];
        let alpha_0: f64 = roots.iter().rev().product();
        for heard in [vec![], vec![alpha_0], vec![alpha_0, alpha_0 / roots[0]]] {
            let mut setup = consensus_of_masses(8.0);
            setup.exchange = if heard.len() > 1 { Exchange::PositionVelocity } else { Exchange::Position };
            setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = roots.into());
            let desired = agreeing(roots, &heard, WrittenIn::Measured);
            assert_same_bits(&run(&setup), &run(&under(setup.clone(), desired)));
        }
    }
}

/// One graph whose links are late, by a delay that jumps.
fn fixed_graph() -> Network {
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(0.8), delay: 0 };
    let edges = vec![edge(0, 1), edge(1, 2), edge(2, 0), edge(0, 2)];
    Network { schedule: Schedule::fixed(edges), ..switching() }
}

/// Remark 6: s(0) = 0 and a known plant leave s ≡ 0, and then the variables that 𝒵 is written in make no difference; with z(0)
/// elsewhere they do.
#[test]
fn remark_6_desired_dynamics_in_x_and_in_z_are_one_motion_without_s() {
    let mut setup = of_all_orders(&steps()[0], [4; 3]);
    (setup.network, setup.time.end_s) = (fixed_graph(), 12.0);
    // ż(0), which is integrated in another place where 𝒵 is written in x.
    for (agent, dz) in setup.agents.iter_mut().zip([0.7, -0.4]) {
        let top = [&agent.start.q[..], &agent.start.dq, &agent.start.rest].concat().last().copied().unwrap();
        agent.start.reference = vec![vec![top], vec![dz]];
    }
    let mut disturbed = setup.clone();
    disturbed.agents[0].start.reference[0][0] += 0.5;
    let with = |setup: &Setup, written| run(&under(setup.clone(), agreeing(&ROOTS, &[], written)));
    let (truth, moved) = (with(&setup, WrittenIn::Measured), with(&disturbed, WrittenIn::Measured));
    for written in [WrittenIn::Z, WrittenIn::X] {
        let (same, other) = (apart(&truth, &with(&setup, written)), apart(&moved, &with(&disturbed, written)));
        assert!(same < 1e-6 && other > 1e-3, "{written:?}: {same:e} {other:e}");
    }
}

#[test]
fn remark_6_tracking_in_x_and_in_z_is_one_motion_without_s() {
    let mut setup = of_all_orders(&steps()[0], [3; 3]);
    setup.agents.truncate(2);
    setup.network = Network::silent(2);
    setup.time.end_s = 10.0;
    for agent in &mut setup.agents {
        agent.target = tracking().agents[0].target.clone();
    }
    let with = |written| run(&under(setup.clone(), following(by_roots(0, ROOTS), written)));
    let truth = with(WrittenIn::Measured);
    let error = column(&truth, 0, Signal::Error, 0);
    assert!(error.last().unwrap().abs() < 1e-2 && error[0].abs() > 0.3);
    for written in [WrittenIn::Z, WrittenIn::X] {
        let same = apart(&truth, &with(written));
        assert!(same < 1e-6, "{written:?}: {same:e}");
    }
}

/// (3) and (23) are desired dynamics of order three in x, on robots, whatever s does.
#[test]
fn eq_3_and_eq_23_are_desired_dynamics_written_in_x() {
    for heard in [vec![], vec![2.0, 2.0]] {
        let mut setup = consensus_of_masses(10.0);
        setup.network = fixed_graph();
        setup.reference = Arc::new(PureIntegral);
        setup.exchange = if heard.len() > 1 { Exchange::PositionVelocity } else { Exchange::Position };
        for agent in &mut setup.agents {
            agent.roots_per_s = [1.0, 2.0].into();
            agent.start.reference = vec![vec![0.3, -0.5]];
        }
        let desired = run(&under(setup.clone(), agreeing(&[1.0, 2.0], &heard, WrittenIn::X)));
        let gap = apart(&run(&setup), &desired);
        assert!(gap < 1e-6, "{gap:e}");
    }
}

/// The proofs of the second steps do not ask what leads.
#[test]
fn eq_lyapunov_identities_hold_whatever_desired_dynamics_lead() {
    // x⁽⁵⁾ with a resonance, on neighbours that are heard with other coefficients than consensus has.
    let polynomial = DesiredPolynomial::Coefficients(vec![0.0, 2.0, 6.0, 7.0, 4.0]);
    let coupling = Some(DesiredPolynomial::Coefficients(vec![1.5, 2.0]));
    for written in [WrittenIn::Measured, WrittenIn::Z, WrittenIn::X] {
        let desired = Desired {
            polynomial: polynomial.clone(),
            coupling: coupling.clone(),
            heard: Vec::new(),
            follows_target: false,
            written,
            protocol: None,
        };
        for step in steps() {
            let mut setup = of_all_orders(&step, [3; 3]);
            setup.time.end_s = 20.0;
            let outcome = run(&under(setup, desired.clone()));
            for agent in 0..3 {
                let error = balance_residual(&outcome, agent, 1.0);
                assert!(error <= 10.0 * 1e-8, "{written:?} {agent}: {error}");
            }
        }
    }
}

#[test]
fn prop_sampled_desired_dynamics_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for written in [WrittenIn::Measured, WrittenIn::Z, WrittenIn::X] {
        let mut chains = of_all_orders(&steps()[0], [3; 3]);
        let mut masses = consensus_of_masses(3.0);
        (chains.network, masses.network, chains.time.end_s) = (fixed_graph(), fixed_graph(), 3.0);
        assert_first_order(&under(chains, agreeing(&ROOTS[..3], &[], written)), 250.0);
        assert_first_order(&under(masses, agreeing(&ROOTS[..3], &[], written)), 250.0);
    }
}

#[test]
fn desired_dynamics_without_meaning_are_refused() {
    let refused = |setup: Setup, desired: Desired| {
        simulate(&under(setup, desired), &mut |_| std::ops::ControlFlow::Continue(())).unwrap_err()
    };
    let chains = || of_all_orders(&steps()[0], [3; 3]);
    let measured = WrittenIn::Measured;
    // Of order three on a plant of order four.
    assert!(matches!(
        refused(chains(), agreeing(&ROOTS[..2], &[], measured)),
        SetupError::DesiredOrder { order: 3, least: 4, .. }
    ));
    let both = Desired { follows_target: true, ..agreeing(&ROOTS[..3], &[], measured) };
    assert!(matches!(refused(chains(), both), SetupError::Desired { .. }));
    let long = Desired { coupling: Some(by_roots(0, ROOTS)), ..agreeing(&ROOTS[..2], &[], measured) };
    assert!(matches!(refused(chains(), long), SetupError::Desired { .. }));
    let nothing =
        Desired { polynomial: DesiredPolynomial::Coefficients(Vec::new()), ..agreeing(&ROOTS, &[], measured) };
    assert!(matches!(refused(chains(), nothing), SetupError::Desired { .. }));
    let huge = DesiredPolynomial::Coefficients(vec![f64::INFINITY; 4]);
    let infinite = Desired { polynomial: huge, ..agreeing(&ROOTS[..3], &[], measured) };
    assert!(matches!(refused(chains(), infinite), SetupError::Desired { .. }));
    let bad = agreeing(&[1.0, -2.0, 1.0], &[], measured);
    assert!(matches!(refused(chains(), bad), SetupError::Roots { .. }));
    let mut start = chains();
    start.agents[2].start.reference = vec![vec![0.0]; 2];
    assert!(matches!(refused(start, agreeing(&ROOTS[..3], &[], measured)), SetupError::StartOfReference { .. }));
    // A law that follows a target by other variables.
    let targets = masses_with_targets(&ROOTS[..3]);
    let in_x = following(by_roots(0, &ROOTS[..3]), WrittenIn::X);
    assert!(matches!(refused(targets, in_x), SetupError::DesiredVariables { .. }));
    // Backstepping needs derivatives of z.
    let cascades = crate::common::chains::cascades();
    let in_x = agreeing(&ROOTS, &[], WrittenIn::X);
    assert!(matches!(refused(cascades, in_x), SetupError::Chain { .. }));
    // Thrust and velocity-free masses have reference dynamics of their own.
    let masses = crate::common::masses::consensus(3);
    assert!(matches!(refused(masses, agreeing(&ROOTS[..3], &[], measured)), SetupError::ReferenceOfLaw { .. }));
}
