//! Nonlinear protocols that a user writes down (Section IV-B): for chains and robots, in continuous time and sampled.

use std::sync::Arc;

use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_core::reference::WrittenIn;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::reference::{Desired, DesiredPolynomial, Protocol};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    AgentSetup, ChainModel, Known, Network, Outcome, RobotSetup, Setup, SetupError, Signal, simulate,
};

use super::desired::{ROOTS, agreeing, apart, by_roots, following, steps, under};
use crate::common::chains::{agent, of_all_orders, tracking, x};
use crate::common::following::arm;
use crate::common::truth;
use crate::common::{
    assert_first_order, balance_residual, column, columns, consensus_of_masses, run, sampled, setup as common_setup,
    switching,
};

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
    let beside = Desired { follows_target: true, heard: vec![0.0, 1.0], ..nonlinear(3, -x(0)) };
    let said = refused(consensus_of_masses(1.0), beside.clone());
    assert!(matches!(said, SetupError::ProtocolHearsVelocities { .. }), "{said:?}");
    // One that follows a target in what is measured has to have one, and in z does not exist.
    let said = refused(consensus_of_masses(1.0), Desired { heard: Vec::new(), ..beside.clone() });
    assert!(matches!(said, SetupError::NoTarget { .. }), "{said:?}");
    let said = refused(followers(3), Desired { heard: Vec::new(), written: WrittenIn::Z, ..beside });
    assert!(matches!(said, SetupError::DesiredVariables { .. }), "{said:?}");
}

/// Masses of one kilogramme with a target each, over links that switch and are late.
fn followers(agents: usize) -> Setup {
    let mass = |k: usize| {
        let mass = AgentSetup::new(format!("mass-{k}"), RobotSetup::point_mass(1, 1.0), Known::gain(2.0));
        let mut mass = mass.at(&[1.0 - 0.8 * k as f64]).following(swing(k));
        (mass.start.dq, mass.start.reference) = (vec![0.3], vec![vec![0.5 - 0.2 * k as f64], vec![-0.1]]);
        mass
    };
    let any = Desired { follows_target: true, ..nonlinear(3, -x(0)) };
    common_setup((0..agents).map(mass).collect(), Arc::new(any), switching(), 10.0)
}

fn swing(k: usize) -> Trajectory {
    let wave = Sinusoid { amplitude: 0.6, rad_per_s: 0.8 + 0.1 * k as f64, phase_rad: 0.3 };
    Trajectory::new(vec![Path::Sinusoids { offset: 0.2 * k as f64, waves: vec![wave] }]).unwrap()
}

/// What stands beside q⃛_d, which is there without f, in q⃛ = q⃛_d − 3 ë − ë³ − 4 ė − 2 e + tanh Σ_j w_ij (q_j − q_i), of order N = 3, whose variables are q, q̇, q̈, what is heard, Σ_j w_ij, q_d and
/// its derivatives, t.
fn drawn_to_targets_and_neighbours() -> Expression {
    let e = |r: usize| x(r) - x(r + 5);
    let alone = -e(2) * 3.0 - e(2).power(3.0) - e(1) * 4.0 - e(0) * 2.0;
    alone + ((x(3) - x(4) * x(0)) * (Expression::number(2.0) + (x(9) * 0.7).sin_of())).tanh_of()
}

/// The same with targets: masses of one kilogramme behind (6) follow as chains of two integrators do.
#[test]
fn eq_43_robots_follow_targets_by_a_nonlinear_protocol_as_chains_do() {
    let desired = Desired { follows_target: true, ..nonlinear(3, drawn_to_targets_and_neighbours()) };
    let integrators = Formulas::new(2, &Expression::number(0.0), Vec::new(), &Expression::number(1.0)).unwrap();
    let integrators = ChainModel::Derivatives(Arc::new(integrators));
    let masses = under(followers(3), desired.clone());
    let mut chains = masses.clone();
    for (k, own) in chains.agents.iter_mut().enumerate() {
        let start = [own.start.q[0], own.start.dq[0]];
        let mut chain = agent(k, integrators.clone(), &[], steps()[0].clone(), &[], &start);
        (chain.start.reference, chain.target) = (own.start.reference.clone(), own.target.clone());
        *own = chain;
    }
    let (masses, chains) = (run(&masses), run(&chains));
    for signal in [Signal::Position, Signal::Reference(1), Signal::Error] {
        let (of_masses, of_chains) = (columns(&masses, signal), columns(&chains, signal));
        assert!(of_masses.len() == 3 && of_chains.len() == 3, "{signal:?}");
        let apart = |(a, b): (&&[f64], &&[f64])| a.iter().zip(*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let gap = of_masses.iter().zip(&of_chains).map(apart).fold(0.0, f64::max);
        assert!(gap < 1e-8, "{signal:?}: {gap:e}");
    }
    // Neighbours are heard: without them each comes nearer to its own target.
    let far =
        |outcome: &Outcome| columns(outcome, Signal::Error).iter().map(|e| e[e.len() - 1].abs()).fold(0.0, f64::max);
    let alone = Desired { follows_target: true, ..nonlinear(3, drawn_to_targets_and_neighbours()) };
    let mut silent = under(followers(3), alone);
    silent.network = Network::silent(3);
    assert!(far(&masses) > 0.05 && far(&run(&silent)) < 0.5 * far(&masses), "{} {}", far(&masses), far(&run(&silent)));
}

/// Arms that estimate: V falls as (6) and (7) have it whatever the protocol does, and sampled runs come to continuous ones.
#[test]
fn thm_lyapunov_of_arms_behind_targets_and_a_nonlinear_protocol_balances() {
    let desired = Desired { follows_target: true, ..nonlinear(3, drawn_to_targets_and_neighbours()) };
    let agents = (0..3)
        .map(|k| {
            let paths = [swing(k).paths()[0].clone(), swing(k + 1).paths()[0].clone()];
            arm(k, [0.4 * k as f64, 0.3 - 0.2 * k as f64], 0.7).following(Trajectory::new(paths.to_vec()).unwrap())
        })
        .collect();
    let setup = under(common_setup(agents, Arc::new(desired.clone()), switching(), 4.0), desired);
    let outcome = run(&setup);
    for agent in 0..3 {
        assert!(balance_residual(&outcome, agent, 0.0) < 1e-7, "{}", balance_residual(&outcome, agent, 0.0));
        assert!(column(&outcome, agent, Signal::Lyapunov, 0)[0] > 0.1);
    }
    assert_first_order(&setup, 250.0);
}

/// With m = 1 a robot has ṡ = −K s, as a chain of integrators has under feedback linearisation: both take the same protocol the same way,
/// with time in it, over links that switch and are late, in what is measured and in z.
#[test]
fn eq_43_robots_take_a_nonlinear_protocol_as_chains_do() {
    let pull = (x(3) - x(4) * x(0)) * (Expression::number(2.0) + (x(5) * 0.7).sin_of());
    let term = -x(1) * 3.0 - x(2) * 2.5 - x(2).power(3.0) + pull.tanh_of();
    let starts = [[1.0, 0.3], [-0.8, 0.0], [0.2, -0.5]];
    let integrators = Formulas::new(2, &Expression::number(0.0), Vec::new(), &Expression::number(1.0)).unwrap();
    let integrators = ChainModel::Derivatives(Arc::new(integrators));
    let reference = |k: usize| vec![vec![starts[k][1] + 0.2], vec![-0.1]];
    let of_chains = |k: usize| {
        let mut chain = agent(k, integrators.clone(), &[], steps()[0].clone(), &[], &starts[k]);
        chain.start.reference = reference(k);
        chain
    };
    let of_masses = |k: usize| {
        let mass = AgentSetup::new(format!("mass-{k}"), RobotSetup::point_mass(1, 1.0), Known::gain(2.0));
        let mut mass = mass.at(&starts[k][..1]);
        (mass.start.dq, mass.start.reference) = (starts[k][1..].to_vec(), reference(k));
        mass
    };
    for written in [WrittenIn::Measured, WrittenIn::Z] {
        let desired = Desired { written, ..nonlinear(3, term.clone()) };
        let whole = |agents: Vec<AgentSetup>| {
            let setup = common_setup(agents, Arc::new(desired.clone()), switching(), 10.0);
            run(&under(setup, desired.clone()))
        };
        let (chains, masses) = (whole((0..3).map(of_chains).collect()), whole((0..3).map(of_masses).collect()));
        let moved = column(&masses, 0, Signal::Position, 0);
        assert!((moved[0] - moved[moved.len() - 1]).abs() > 0.1);
        let gap = apart(&chains, &masses);
        assert!(gap < 1e-8, "{written:?}: {gap:e}");
    }
}

/// (a1) as one formula on arms that estimate, in continuous time and sampled: what is affine is stepped exactly, a formula by stages.
#[test]
fn eq_43_a_linear_protocol_of_arms_is_the_linear_one_sampled_too() {
    // c₁ is heard beside f, which holds the rest of it.
    let term = -x(1) * 2.0 - x(2) * 3.0 - x(4) * (x(0) * 2.0 + x(1) * 3.0 + x(2)) + x(3) * 2.0;
    let arms = |sample_hz: Option<f64>, desired: Desired| {
        let mut agents: Vec<_> = (0..3).map(|k| arm(k, [0.4 * k as f64, 0.3 - 0.2 * k as f64], 0.7)).collect();
        agents[1].start.dq = vec![0.2, -0.1];
        let setup = common_setup(agents, Arc::new(desired.clone()), switching(), 3.0);
        let setup = under(setup, desired);
        run(&sample_hz.map_or(setup.clone(), |hz| sampled(setup, hz)))
    };
    for (heard, most) in [(vec![], [1e-8, 1e-9]), (vec![0.0, 2.0], [1e-8, 1e-9])] {
        let linear = agreeing(&ROOTS[..2], if heard.is_empty() { &[] } else { &[2.0, 2.0] }, WrittenIn::Measured);
        let formula = Desired { heard, ..nonlinear(3, term.clone()) };
        for (sample_hz, most) in [None, Some(250.0)].into_iter().zip(most) {
            let gap = apart(&arms(sample_hz, linear.clone()), &arms(sample_hz, formula.clone()));
            assert!(gap < most, "{sample_hz:?}: {gap:e}");
        }
    }
    let swell = Expression::number(2.0) + (x(5) * 3.0).sin_of();
    let mut saturated = nonlinear(3, term.tanh_of() * swell);
    saturated.written = WrittenIn::Z;
    let agents = (0..3).map(|k| arm(k, [0.4 * k as f64, 0.3 - 0.2 * k as f64], 0.7)).collect();
    let setup = common_setup(agents, Arc::new(saturated.clone()), switching(), 2.0);
    assert_first_order(&under(setup, saturated), 250.0);
}

/// Against `validation/protocols`: arms that estimate, with time in the protocol, in what is measured and in z.
#[test]
fn val_arms_under_a_nonlinear_protocol_agree_with_an_independent_solver() {
    let swell = Expression::number(2.0) + (x(5) * 3.0).sin_of();
    let term = -x(2) * 3.0 - x(1) * 2.0 + swell * (x(3) - x(4) * x(0)).tanh_of() - x(2).power(3.0) * 0.3;
    let truths = truth::read(include_str!("../../../../validation/protocols/protocols.json"));
    assert_eq!(truths.len(), 2);
    for (truth, written) in truths.iter().zip([WrittenIn::Measured, WrittenIn::Z]) {
        let mut agents: Vec<_> = (0..3).map(|k| arm(k, [0.4 * k as f64, 0.3 - 0.2 * k as f64], 0.7)).collect();
        agents[1].start.dq = vec![0.2, -0.1];
        let desired = Desired { written, ..nonlinear(3, term.clone()) };
        let setup = common_setup(agents, Arc::new(desired.clone()), switching(), 1.0);
        let worst = truth.largest_difference(under(setup, desired));
        assert!(worst < 1e-7, "{}: {worst:e}", truth.name);
    }
}
