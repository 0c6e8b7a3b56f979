//! Chains of Section IV: the identities of the proofs along real runs, agreement, and sampled control.

mod desired;
mod protocols;

use std::ops::ControlFlow;

use std::sync::Arc;

use crate::common::chains::{
    adaptive, agent, cascades, derivatives, estimate, linearising, number, pure_feedback, tracking, x,
};
use crate::common::{assert_first_order, balance_residual, column, last, run, setup, silent, switching, truth};
use forwardstep_core::plant::{CascadeTerms, Formulas};
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::reference::Consensus;
use forwardstep_sim::{ChainModel, ChainStep, Outcome, Setup, Signal, simulate};

fn spread(outcome: &Outcome, row: usize) -> f64 {
    let x: Vec<f64> = (0..3).map(|agent| column(outcome, agent, Signal::Position, 0)[row]).collect();
    x.iter().fold(f64::MIN, |a, b| a.max(*b)) - x.iter().fold(f64::MAX, |a, b| a.min(*b))
}

#[test]
fn eq_lyapunov_identities_of_chains_hold_along_real_runs() {
    for setup in [derivatives(), cascades(), pure_feedback(), tracking()] {
        let outcome = run(&setup);
        for agent in 0..setup.agents.len() {
            let error = balance_residual(&outcome, agent, 1.0);
            assert!(error <= 10.0 * 1e-8, "{}: {error}", setup.agents[agent].name);
        }
    }
}

#[test]
fn thm3_chains_of_different_orders_agree_over_switching_delayed_links() {
    for setup in [derivatives(), cascades(), pure_feedback()] {
        let outcome = run(&setup);
        let last = outcome.recording.columns[0].values.len() - 1;
        let (first, end) = (spread(&outcome, 0), spread(&outcome, last));
        assert!(end < 1e-3 * first, "{}: {first} to {end}", setup.agents[0].law.words().name);
    }
}

#[test]
fn eq_43_chains_reach_their_targets() {
    let outcome = run(&tracking());
    for agent in 0..3 {
        let error = column(&outcome, agent, Signal::Error, 0);
        assert!(error.last().unwrap().abs() < 1e-3 * error[0].abs(), "{agent}: {} {}", error[0], error.last().unwrap());
    }
}

#[test]
fn prop_sampled_chains_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let mut coupled = derivatives();
    coupled.network.coupling = Coupling::Tanh { scale: 0.3 };
    for mut setup in [derivatives(), coupled, cascades(), pure_feedback(), tracking()] {
        setup.time.end_s = 3.0;
        assert_first_order(&setup, 250.0);
    }
}

#[test]
fn prop_a_coupling_that_never_saturates_is_the_linear_one() {
    let linear = run(&derivatives());
    let mut setup = derivatives();
    setup.network.coupling = Coupling::Saturated { limit: 100.0 };
    let wide = run(&setup);
    setup.network.coupling = Coupling::Saturated { limit: 0.1 };
    let narrow = run(&setup);
    let end = |outcome: &Outcome, agent: usize| last(outcome, agent, Signal::Position, 0);
    for agent in 0..3 {
        assert!((end(&linear, agent) - end(&wide, agent)).abs() < 1e-6);
    }
    // A narrow one brings them together too, but elsewhere and later.
    let last = narrow.recording.columns[0].values.len() - 1;
    assert!((end(&linear, 0) - end(&narrow, 0)).abs() > 1e-3);
    assert!(spread(&narrow, last) < 0.1 * spread(&narrow, 0));
    assert!(spread(&narrow, last / 4) > 3.0 * spread(&linear, last / 4));
}

/// Against `validation/chains`, written from the paper and the literature.
#[test]
fn val_chains_agree_with_an_independent_solver() {
    let setups = [derivatives(), linearising(), adaptive(), cascades(), pure_feedback(), tracking()];
    let truths = truth::read(include_str!("../../../validation/chains/chains.json"));
    assert_eq!(truths.len(), setups.len());
    for (truth, setup) in truths.iter().zip(setups) {
        let worst = truth.largest_difference(setup);
        assert!(worst < 1e-6, "{}: {worst:e}", truth.name);
    }
}

/// The second state of a strict-feedback chain is no velocity, yet its reference has a start, and a state has all its entries.
#[test]
fn regress_chains_start_with_a_reference_and_with_the_state_that_the_model_has() {
    let mut setup = cascades();
    setup.time.end_s = 0.1;
    for agent in &mut setup.agents {
        agent.start.reference = vec![vec![0.25]];
    }
    let outcome = run(&setup);
    for agent in 0..3 {
        assert_eq!(column(&outcome, agent, Signal::Reference(0), 0)[0], 0.25);
    }
    for mut setup in [derivatives(), cascades()] {
        // What the leniency of old let through: the whole state beside the position.
        let start = &mut setup.agents[0].start;
        start.rest = [&start.dq[..], &start.rest].concat();
        start.dq.clear();
        start.rest.push(0.0);
        assert!(simulate(&setup, &mut |_| ControlFlow::Continue(())).is_err());
    }
}

/// 1, 1.1, 1.2, ….
fn roots(count: usize) -> Vec<f64> {
    (0..count).map(|r| 1.0 + 0.1 * r as f64).collect()
}

/// Three chains in strict-feedback form of an order, with so many parameters.
fn backstepping(order: usize, parameters: usize) -> Setup {
    let size = if order > 4 { 0.01 } else { 0.5 };
    let phi = |i: usize, j: usize| if (i + j).is_multiple_of(2) { x(i).sin_of() * size } else { x(0) * x(i) * size };
    let rows = (0..order).map(|i| (0..parameters).map(|j| phi(i, j)).collect());
    let model = ChainModel::Cascade(Arc::new(CascadeTerms::strict(rows.collect()).unwrap()));
    let of = |index: usize| {
        let estimate = estimate(&vec![1.0; parameters]);
        let step = ChainStep::Backstepping { gains_per_s: vec![1.0; order], estimate };
        let mut state = vec![0.0; order];
        state[0] = 0.5 - 0.4 * index as f64;
        let theta = &[0.3, -0.2, 0.4][..parameters];
        agent(index, model.clone(), theta, step, &roots(order.max(2) - 1), &state)
    };
    setup((1..=3).map(of).collect(), Arc::new(Consensus), switching(), 1.2)
}

#[test]
fn eq_lyapunov_identities_hold_for_chains_of_any_order() {
    for order in [1, 2, 7, 10] {
        for parameters in [0, 1, 3] {
            let outcome = run(&backstepping(order, parameters));
            for agent in 0..3 {
                let error = balance_residual(&outcome, agent, 1e-3);
                assert!(error <= 1e-7, "order {order}, {parameters} parameters: {error:e}");
            }
        }
    }
}

/// ẋ of a chain that hears nothing is a sum of the modes e^(−κt) of its roots, whatever its order.
#[test]
fn val_chains_of_any_order_move_as_the_modes_of_their_roots() {
    for order in [2, 9, 20] {
        let roots = roots(order - 1);
        let modes = [(0.4, roots[0]), (-0.3, roots[roots.len() - 1])];
        let exact = |r: i32, t: f64| {
            let mode = |(size, kappa): &(f64, f64)| match r {
                0 => size * (1.0 - (-kappa * t).exp()) / kappa,
                r => size * (-kappa).powi(r - 1) * (-kappa * t).exp(),
            };
            modes.iter().map(mode).sum::<f64>()
        };
        let state: Vec<f64> = (0..order as i32).map(|r| exact(r, 0.0)).collect();
        let model = ChainModel::Derivatives(Arc::new(
            Formulas::new(order, &number(0.0), vec![x(0).sin_of()], &number(2.0)).unwrap(),
        ));
        let step = ChainStep::Linearising { gain_per_s: 2.0 };
        let mut one = agent(1, model, &[0.7], step, &roots, &state);
        // One differentiator: z alone.
        one.start.reference = vec![vec![exact(order as i32 - 1, 0.0)]];
        let outcome = run(&setup(vec![one], Arc::new(Consensus), silent(1), 3.0));
        let position = column(&outcome, 0, Signal::Position, 0);
        for (row, t) in outcome.recording.t_s.iter().enumerate() {
            let error = (position[row] - exact(0, *t)).abs();
            assert!(error < 1e-6, "order {order} at {t}: {error:e}");
        }
    }
}
