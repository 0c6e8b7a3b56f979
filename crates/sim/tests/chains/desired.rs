//! Desired dynamics that a user writes down (Section IV-B): their instances are the designs of the paper, bit for bit, and the
//! variables they are written in make no difference where s ≡ 0.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{RootPair, RootSet, WrittenIn};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::reference::{Desired, DesiredPolynomial, Protocol, PureIntegral, Tracking};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{ChainStep, Exchange, Known, Network, Outcome, Setup, SetupError, Signal, simulate};

use crate::common::chains::{estimate, of_all_orders, tracking, x};
use crate::common::{assert_first_order, balance_residual, column, columns, consensus_of_masses, run, switching};

fn by_roots(integrators: usize, roots: impl Into<RootSet>) -> DesiredPolynomial {
    DesiredPolynomial::Roots { integrators, roots: roots.into() }
}

/// p A(p) x = −Σ_j w_ij [A(p) x − what is heard] for the roots of A.
fn agreeing(roots: &[f64], heard: &[f64], written: WrittenIn) -> Desired {
    Desired {
        polynomial: by_roots(1, roots),
        coupling: Some(by_roots(0, roots)),
        heard: heard.to_vec(),
        follows_target: false,
        written,
        protocol: None,
    }
}

fn following(polynomial: DesiredPolynomial, written: WrittenIn) -> Desired {
    Desired { polynomial, coupling: None, heard: Vec::new(), follows_target: true, written, protocol: None }
}

/// `setup` under these desired dynamics.
fn under(mut setup: Setup, desired: Desired) -> Setup {
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
fn apart(one: &Outcome, other: &Outcome) -> f64 {
    let (one, other) = (columns(one, Signal::Position), columns(other, Signal::Position));
    let each = |(a, b): (&&[f64], &&[f64])| a.iter().zip(*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    one.iter().zip(&other).map(each).fold(0.0, f64::max)
}

fn steps() -> [ChainStep; 2] {
    let adaptive = ChainStep::Adaptive { gain_per_s: 2.0, estimate: estimate(&[2.0, 2.0]) };
    [ChainStep::Linearising { gain_per_s: 2.0 }, adaptive]
}

const ROOTS: [f64; 4] = [1.0, 2.0, 1.5, 1.2];

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

/// f alone, without any linear part.
fn nonlinear(order: usize, term: Expression) -> Desired {
    let said = || Some("a test".to_owned());
    Desired {
        polynomial: DesiredPolynomial::Coefficients(vec![0.0; order]),
        coupling: None,
        heard: Vec::new(),
        follows_target: false,
        written: WrittenIn::Measured,
        protocol: Some(Protocol { term, stable_because: said(), input_to_state_stable_because: said() }),
    }
}

/// (24) with roots 1, 2 and 1.5 as one formula: f has x, …, x^(3), what is heard and the weights where they belong.
#[test]
fn eq_43_a_linear_protocol_as_a_formula_is_the_linear_one() {
    let [a0, a1, a2] = [3.0, 6.5, 4.5];
    let own = x(1) * a0 + x(2) * a1 + x(3) * a2;
    let all = x(0) * a0 + x(1) * a1 + x(2) * a2 + x(3);
    let term = -own - x(5) * all + x(4) * a0;
    for written in [WrittenIn::Measured, WrittenIn::Z] {
        let mut setup = of_all_orders(&steps()[1], [3; 3]);
        setup.time.end_s = 10.0;
        let linear = run(&under(setup.clone(), agreeing(&ROOTS[..3], &[], written)));
        let formula = run(&under(setup, Desired { written, ..nonlinear(4, term.clone()) }));
        let gap = apart(&linear, &formula);
        assert!(gap < 1e-9, "{written:?}: {gap:e}");
    }
}

/// (a9) in the same way: x_d and its derivatives stand behind the weights. Its highest one is there without f.
#[test]
fn eq_43_tracking_as_a_formula_is_tracking() {
    let alpha = forwardstep_core::reference::polynomial([1.0, 2.0, 1.5]).unwrap();
    let error = |r: usize| x(r) - x(5 + r);
    let term = -(error(0) * alpha[0]) - error(1) * alpha[1] - error(2) * alpha[2];
    let mut setup = tracking();
    setup.time.end_s = 10.0;
    let linear = following(by_roots(0, [1.0, 2.0, 1.5]), WrittenIn::Measured);
    let formula = Desired { follows_target: true, ..nonlinear(3, term) };
    let gap = apart(&run(&under(setup.clone(), linear)), &run(&under(setup, formula)));
    assert!(gap < 1e-9, "{gap:e}");
}

/// ẍ_i = −ẋ_i − ẋ_i³ + tanh(2 Σ_j w_ij (x_j − x_i)): agents that start ten metres apart agree, in continuous time and sampled, and the
/// balance of the second step holds.
#[test]
fn eq_43_a_nonlinear_protocol_leads_plants_of_orders_one_and_two() {
    let term = -x(1) - x(1).power(3.0) + ((x(2) - x(3) * x(0)) * 2.0).tanh_of();
    let mut setup = of_all_orders(&steps()[0], [3; 3]);
    let (mut slow, second) = (setup.agents[0].clone(), setup.agents[0].clone());
    slow.name = "second".into();
    slow.start.q = vec![-9.0];
    setup.agents = vec![second, slow];
    setup.network = Network { schedule: Schedule::fixed(two_way()), ..Network { agents: 2, ..switching() } };
    setup.time.end_s = 40.0;
    let setup = under(setup, nonlinear(2, term));
    let outcome = run(&setup);
    let positions = columns(&outcome, Signal::Position);
    let gap = |row: usize| (positions[0][row] - positions[1][row]).abs();
    let last = positions[0].len() - 1;
    assert!(gap(0) > 9.0 && gap(last) < 1e-3, "{} {}", gap(0), gap(last));
    for agent in 0..2 {
        assert!(balance_residual(&outcome, agent, 1.0) < 1e-7);
    }
    let mut short = setup;
    short.time.end_s = 3.0;
    assert_first_order(&short, 250.0);
}

/// ẍ_i = ẍ_d − a₁ė_i − a₀e_i − (1 + 4 exp(−t/10)) Σ_j w_ij (x_i − x_j), with e_i = x_i − x_d and one target: differences of e obey what
/// stands there, and their mean the rest, whatever the coupling. In x alone as in z, in continuous time and sampled.
#[test]
fn eq_43_time_a_target_and_neighbours_stand_in_one_protocol() {
    let share = Expression::number(1.0) + (x(7) * -0.1).exp_of() * 4.0;
    let term = share * (x(2) - x(3) * x(0));
    let polynomial = DesiredPolynomial::Coefficients(vec![0.3, 1.1]);
    let mut setup = tracking();
    let agent = setup.agents[2].clone();
    let mut other = agent.clone();
    (other.name, other.start.q) = ("other".into(), vec![agent.start.q[0] - 2.0]);
    setup.agents = vec![agent, other];
    setup.network =
        Network { schedule: Schedule::fixed(two_way()), delays: vec![Delay::constant(0.0)], ..Network::silent(2) };
    setup.time.end_s = 6.0;
    let with = |term| Desired { polynomial: polynomial.clone(), follows_target: true, ..nonlinear(2, term) };
    let (coupled, alone) = (under(setup.clone(), with(term)), under(setup, with(x(0) * 0.0)));
    let (near, far) = (run(&coupled), run(&alone));
    let last = |outcome: &Outcome, agent| *column(outcome, agent, Signal::Error, 0).last().unwrap();
    let gap = |outcome: &Outcome| (last(outcome, 0) - last(outcome, 1)).abs();
    assert!(gap(&near) < 0.2 * gap(&far), "{} {}", gap(&near), gap(&far));
    let mean = |outcome: &Outcome| last(outcome, 0) + last(outcome, 1);
    assert!((mean(&near) - mean(&far)).abs() < 1e-5, "{} {}", mean(&near), mean(&far));
    let mut short = coupled;
    short.time.end_s = 3.0;
    assert_first_order(&short, 250.0);
}

fn two_way() -> Vec<Edge> {
    let edge = |from, to| Edge { from, to, weight: Weight::Constant(0.8), delay: 0 };
    vec![edge(0, 1), edge(1, 0)]
}

#[test]
fn nonlinear_protocols_without_meaning_are_refused() {
    let refused = |setup: Setup, desired: Desired| {
        simulate(&under(setup, desired), &mut |_| std::ops::ControlFlow::Continue(())).unwrap_err()
    };
    let chains = || of_all_orders(&steps()[0], [3; 3]);
    let in_x = Desired { written: WrittenIn::X, ..nonlinear(4, -x(0)) };
    assert!(matches!(refused(chains(), in_x), SetupError::Desired { .. }));
    // Without a target there is no variable beyond the weights but t.
    assert!(matches!(refused(chains(), nonlinear(4, x(7))), SetupError::Desired { .. }));
    assert!(matches!(refused(consensus_of_masses(1.0), nonlinear(3, -x(0))), SetupError::ProtocolOfChains { .. }));
}
