//! A point mass by a model and a high gain, beside (a8): the identity of its proof along real runs, also pushed.

use crate::common::masses::{by_model, is_reached};
use crate::common::{assert_first_order, balance_residual, column, run};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::{ModelReferenceLaw, Setup, SetupError, Signal, simulate};
use std::ops::ControlFlow;

fn pushed() -> Setup {
    let mut setup = by_model();
    let force = [3.0, -2.0].map(Function::Constant).to_vec();
    setup.agents[0].pushes = vec![Push { effect: Effect::Torque(Course::Each(force)), from_s: 2.0, until_s: 5.0 }];
    setup
}

#[test]
fn own_v_of_model_reference_control_loses_what_is_derived_along_real_runs() {
    for setup in [by_model(), pushed()] {
        let outcome = run(&setup);
        let error = balance_residual(&outcome, 0, 0.0);
        assert!(error <= 10.0 * 1e-8, "{error}");
        let dissipation = column(&outcome, 0, Signal::Dissipation, 0);
        let falls = dissipation.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9);
        assert!(falls || !setup.agents[0].pushes.is_empty(), "nothing is ever gained");
    }
}

/// As (a8) does, from the same start and behind the same target.
#[test]
fn own_model_reference_control_brings_a_mass_of_unknown_weight_to_its_target() {
    is_reached(&by_model());
}

#[test]
fn prop_sampled_masses_by_a_model_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let mut setup = by_model();
    setup.time.end_s = 4.0;
    assert_first_order(&setup, 500.0);
}

#[test]
fn numbers_and_roots_that_no_model_has_are_refused() {
    let refused = |change: &dyn Fn(&mut Setup)| {
        let mut setup = by_model();
        change(&mut setup);
        simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    let law = |change: fn(&mut ModelReferenceLaw)| {
        refused(&|setup: &mut Setup| {
            assert!(setup.agents[0].change_law(change));
        })
    };
    assert!(matches!(law(|law| law.filter_per_s = 0.0), SetupError::Quantity { .. }));
    assert!(matches!(law(|law| law.adaptation = -1.0), SetupError::Quantity { .. }));
    assert!(matches!(law(|law| law.estimate_start = f64::NAN), SetupError::Quantity { .. }));
    for roots in [vec![1.0], vec![1.0, 2.0, 3.0]] {
        let error = refused(&|setup| setup.agents[0].roots_per_s = roots.clone().into());
        assert!(matches!(error, SetupError::RootCount { .. }), "{error:?}");
    }
}
