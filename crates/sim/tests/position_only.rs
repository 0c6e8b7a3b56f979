//! A point mass without velocity, (a7)–(a9), and many of them: the identity of the proof along real runs.

use crate::common::masses::{by_model, consensus, is_reached, tracking};
use crate::common::{assert_first_order, balance_residual, last, run, truth};
use forwardstep_sim::Signal;

#[test]
fn eq_a8_loses_exactly_k_y_squared_along_real_runs() {
    for setup in [tracking(), consensus(2), consensus(3)] {
        let outcome = run(&setup);
        for agent in 0..setup.agents.len() {
            let error = balance_residual(&outcome, agent, 0.0);
            assert!(error <= 10.0 * 1e-8, "agent {agent}: {error}");
        }
    }
}

#[test]
fn eq_a9_a_mass_of_unknown_weight_reaches_its_target() {
    is_reached(&tracking());
}

#[test]
fn remark_7_masses_agree_over_switching_delayed_links_without_velocities() {
    for order in [2, 3] {
        let outcome = run(&consensus(order));
        for axis in 0..2 {
            let ends = [0, 1, 2].map(|agent| last(&outcome, agent, Signal::Position, axis));
            let speed = (0..3).map(|agent| last(&outcome, agent, Signal::Velocity, axis).abs());
            let spread = ends.iter().fold(f64::MIN, |a, b| a.max(*b)) - ends.iter().fold(f64::MAX, |a, b| a.min(*b));
            assert!(spread < 2e-3, "order {order}, axis {axis}: {ends:?}");
            assert!(speed.fold(0.0, f64::max) < 2e-3);
        }
    }
}

#[test]
fn prop_sampled_masses_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for mut setup in [tracking(), consensus(2)] {
        setup.time.end_s = 4.0;
        assert_first_order(&setup, 500.0);
    }
}

/// Against `validation/masses`, where the velocity is measured and nothing is integrated by parts, or the law by a model has the form of the books.
#[test]
fn val_masses_without_velocity_agree_with_an_independent_solver() {
    let setups = [tracking(), consensus(2), consensus(3), by_model()];
    let truths = truth::read(include_str!("../../../validation/masses/masses.json"));
    assert_eq!(truths.len(), setups.len());
    for (truth, setup) in truths.iter().zip(setups) {
        let worst = truth.largest_difference(setup);
        assert!(worst < 1e-6, "{}: {worst:e}", truth.name);
    }
}
