//! A tip with uncertain lengths (76)–(82), and an attitude without angular velocity (97)–(105): the identities of the proofs
//! along real runs, sampled runs, and what ends a run.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::single::{anthropomorphic, craft, filtered_craft, half_a_turn, planar, targets};
use crate::common::{RTOL, assert_first_order, balance_residual, column, last, run, sampled, truth};
use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::tree::Uncertain;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::recording::{Breakdown, BreakdownCause};
use forwardstep_sim::{AttitudeLaw, Ending, Outcome, PassivityFilterLaw, Setup, Signal, TaskSpaceLaw, simulate};

/// The residual of the balance, and how much of V(0) was lost.
fn balance(outcome: &Outcome) -> (f64, f64) {
    let start = column(outcome, 0, Signal::Lyapunov, 0)[0];
    (balance_residual(outcome, 0, 0.0), last(outcome, 0, Signal::Dissipation, 0) / start)
}

#[test]
fn thm6_identity_holds_along_real_runs() {
    let bounds = ParameterBounds::new(vec![0.9, 0.7], vec![1.1, 0.9], 0.2);
    let runs = [
        planar(None, 0.3),
        planar(Some(bounds), 0.3),
        anthropomorphic(Uncertain::Tool),
        anthropomorphic(Uncertain::Chain),
    ];
    for (index, setup) in runs.iter().enumerate() {
        let (error, lost) = balance(&run(setup));
        assert!(error <= 10.0 * RTOL, "run {index}: {error}");
        assert!(lost > 0.01, "run {index} lost {lost}");
    }
}

/// By a measured velocity of the tip, which no theorem of the paper does; z is a function, and V has no |z − z_r|².
#[test]
fn own_identity_holds_along_real_runs_by_a_measured_velocity_of_the_tip() {
    let bounds = ParameterBounds::new(vec![0.9, 0.7], vec![1.1, 0.9], 0.2);
    let runs = [
        planar(None, 0.3),
        planar(Some(bounds), 0.3),
        anthropomorphic(Uncertain::Tool),
        anthropomorphic(Uncertain::Chain),
    ];
    for (index, setup) in runs.into_iter().enumerate() {
        let mut setup = by_velocity(setup);
        let outcome = run(&setup);
        let (error, lost) = balance(&outcome);
        assert!(error <= 10.0 * RTOL, "run {index}: {error}");
        assert!(lost > 0.01, "run {index} lost {lost}");
        // What is measured is the rate of x, and z is shown though it is no state.
        (setup.time.record_every_s, setup.time.end_s) = (1e-3, 1.0);
        let outcome = run(&setup);
        let [x, dx] = [Signal::TaskPosition, Signal::TaskVelocity].map(|signal| column(&outcome, 0, signal, 0));
        for k in (1..x.len() - 1).step_by(50) {
            let slope = (x[k + 1] - x[k - 1]) / 2e-3;
            assert!((slope - dx[k]).abs() < 5e-3, "run {index}: {slope} against {}", dx[k]);
        }
        assert!(outcome.recording.columns.iter().any(|column| column.signal == Signal::Reference(0)));
    }
}

fn by_velocity(mut setup: Setup) -> Setup {
    assert!(setup.agents[0].change_law(|law: &mut TaskSpaceLaw| law.by_velocity = true));
    setup
}

/// Noise of ẋ is a torque at once; of Theorem 6, which reads no ẋ, such noise is refused.
#[test]
fn own_noise_of_the_velocity_of_a_tip_reaches_the_torque() {
    let noisy = |noise: f64| {
        let mut setup = sampled(by_velocity(planar(None, 0.3)), 500.0);
        setup.time.end_s = 4.0;
        setup.control.as_mut().unwrap().sensors.tip_velocity_noise = noise;
        let outcome = run(&setup);
        // Behind the transient of the start.
        let torque = column(&outcome, 0, Signal::Torque, 0);
        torque[3 * torque.len() / 4..].windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0])).sum::<f64>()
    };
    let (exact, little, much) = (noisy(0.0), noisy(0.01), noisy(0.1));
    assert!(little > 1.5 * exact && much > 20.0 * little, "{exact} {little} {much}");
    let mut setup = sampled(planar(None, 0.3), 500.0);
    setup.control.as_mut().unwrap().sensors.tip_velocity_noise = 0.01;
    let refused = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the noise of the velocities of end-effectors is 0.01, but no law measures the velocity of an end-effector"
    );
}

#[test]
fn thm7_identity_holds_along_real_runs() {
    for (index, target) in targets().into_iter().enumerate() {
        let outcome = run(&craft(half_a_turn([0.1, -0.05, 0.08]), target, 5.0));
        let (error, lost) = balance(&outcome);
        assert!(error <= 10.0 * RTOL, "target {index}: {error}");
        assert!(lost > 0.9, "target {index} lost {lost}");
        let angle = column(&outcome, 0, Signal::Angle, 0);
        let (first, last) = (angle[0], *angle.last().unwrap());
        assert!(last < 1e-3 * first, "target {index}: {first} rad to {last} rad");
    }
}

/// V of a passivity filter, with the term without a sign where the target turns, and with that of a torque from outside.
#[test]
fn prop_what_v_of_a_passivity_filter_loses_is_known_along_real_runs() {
    for (index, target) in targets().into_iter().enumerate() {
        for pushed in [false, true] {
            let mut setup = filtered_craft(half_a_turn([0.1, -0.05, 0.08]), target.clone());
            if pushed {
                let torque = [0.2, -0.1, 0.3].map(Function::Constant).to_vec();
                setup.agents[0].pushes =
                    vec![Push { effect: Effect::Torque(Course::Each(torque)), from_s: 2.0, until_s: 5.0 }];
            }
            let outcome = run(&setup);
            let (error, lost) = balance(&outcome);
            assert!(error <= 10.0 * RTOL, "target {index}, pushed {pushed}: {error}");
            assert!(pushed || lost > 0.9, "target {index} lost {lost}");
            let dissipation = column(&outcome, 0, Signal::Dissipation, 0);
            let falls = dissipation.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9);
            // Where the target keeps still nothing is ever gained.
            assert!(falls || index > 0 || pushed, "target {index}");
        }
    }
}

/// From rest z and ω stay together, so that ẏ has nothing to do and V stays zero.
#[test]
fn thm7_from_rest_the_reference_is_followed_exactly() {
    let outcome = run(&craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0));
    let v = column(&outcome, 0, Signal::Lyapunov, 0).iter().fold(0.0_f64, |most, v| most.max(*v));
    assert!(v < 1e-12, "{v}");
    assert!(column(&outcome, 0, Signal::Angle, 0).last().unwrap() < &3e-3);
}

#[test]
fn prop_sampled_systems_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let mut craft = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(1), 5.0);
    let mut arm = planar(None, 0.3);
    let mut watched = by_velocity(arm.clone());
    for setup in [&mut craft, &mut arm, &mut watched] {
        setup.time.end_s = 3.0;
        assert_first_order(setup, 200.0);
    }
}

#[test]
fn prop_wheels_keep_to_their_limits_when_asked() {
    for enforced in [false, true] {
        let mut setup = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(0), 0.5);
        setup.agents[0].enforce_limits = enforced;
        setup.time.end_s = 20.0;
        let outcome = run(&sampled(setup, 50.0));
        let largest = (0..4)
            .flat_map(|wheel| column(&outcome, 0, Signal::WheelTorque, wheel))
            .fold(0.0_f64, |most, u| most.max(u.abs()));
        assert_eq!(largest <= 0.5, enforced, "{largest} N m");
    }
}

#[test]
fn thm6_a_run_ends_when_an_aggressive_gain_drives_the_jacobian_to_singularity() {
    let outcome = simulate(&planar(None, 300.0), &mut |_| ControlFlow::Continue(())).unwrap();
    let Ending::BrokeDown(Breakdown { signal, cause, .. }) = outcome.ending else { panic!("{:?}", outcome.ending) };
    assert_eq!(signal, Signal::Determinant);
    assert!(matches!(cause, BreakdownCause::Vanished { .. }), "{cause:?}");
}

/// Against `validation/single`, which shares no form of the equations: the momentum comes from the wheels, and the quaternion
/// between R and R_z, or R and R_d, is integrated.
#[test]
fn val_tips_and_spacecraft_agree_with_an_independent_solver() {
    let mut arm = planar(None, 0.3);
    arm.agents[0].law = Arc::new(TaskSpaceLaw {
        task_gain: Gain::Matrix(vec![20.0, 2.0, 2.0, 25.0]),
        kinematic_adaptation: Some(Gain::Diagonal(vec![0.3, 0.4])),
        ..arm.agents[0].law.downcast::<TaskSpaceLaw>().unwrap().clone()
    });
    let watched = by_velocity(arm.clone());
    let mut setups = vec![arm];
    // The fourth target goes through points of a table, whose curve is no formula.
    for target in targets().into_iter().take(3) {
        let mut craft = craft(half_a_turn([0.1, -0.05, 0.08]), target, 5.0);
        craft.agents[0].law = Arc::new(AttitudeLaw {
            damping: Gain::Diagonal(vec![3.0, 2.5, 2.0, 3.5]),
            filter: Gain::Diagonal(vec![1.0, 1.2, 0.8, 1.1]),
            ..craft.agents[0].law.downcast::<AttitudeLaw>().unwrap().clone()
        });
        setups.push(craft);
    }
    for target in targets().into_iter().take(3) {
        let mut craft = filtered_craft(half_a_turn([0.1, -0.05, 0.08]), target);
        assert!(craft.agents[0].change_law(|law: &mut PassivityFilterLaw| {
            law.damping = Gain::Diagonal(vec![3.0, 2.5, 2.0, 3.5]);
            law.filter = Gain::Diagonal(vec![1.0, 1.2, 0.8, 1.1]);
        }));
        setups.push(craft);
    }
    setups.push(watched);
    let truths = truth::read(include_str!("../../../validation/single/single.json"));
    assert_eq!(truths.len(), setups.len());
    for (truth, setup) in truths.iter().zip(setups) {
        let worst = truth.largest_difference(setup);
        assert!(worst < 1e-6, "{}: {worst:e}", truth.name);
    }
}

/// V̇ does not ask where z, R_z and y start, nor which of q and −q: a sign, a z, an attitude of the reference, and a filter that has
/// not settled.
#[test]
fn thm7_identity_holds_from_every_start_of_its_states() {
    let z = || vec![0.2, -0.1, 0.05];
    let starts = [
        vec![z()],
        vec![vec![0.0; 3], vec![0.0, 0.6, 0.0, -1.6]],
        vec![vec![0.0; 3], Vec::new(), vec![0.4, -0.3, 0.2, 2.5]],
        vec![z(), vec![0.5, 0.1, -0.2, 1.0], vec![-1.0, 0.5, 0.0, 1.0]],
    ];
    for (index, reference) in starts.into_iter().enumerate() {
        for sign in [1.0, -1.0] {
            let mut setup = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(index), 5.0);
            let start = &mut setup.agents[0].start;
            start.q.iter_mut().for_each(|x| *x *= sign);
            start.reference = reference.clone();
            let outcome = run(&setup);
            let (error, lost) = balance(&outcome);
            assert!(error <= 10.0 * RTOL, "start {index}: {error}");
            assert!(lost > 0.9, "start {index} lost {lost}");
            let angle = column(&outcome, 0, Signal::Angle, 0);
            assert!(angle.last().unwrap() < &5e-3, "start {index}: {angle:?}");
            for (axis, z) in reference[0].iter().enumerate() {
                assert_eq!(column(&outcome, 0, Signal::Reference(0), axis)[0], *z);
            }
            // (100) with K = 3 and Λ_f = 1.
            let rate: Vec<f64> = (0..4).map(|k| column(&outcome, 0, Signal::FilterRate, k)[0]).collect();
            let settled = rate.iter().all(|rate| rate.abs() < 1e-12);
            assert_eq!(settled, reference.get(2).is_none(), "{rate:?}");
        }
    }
    let filtered = |y: &[f64]| {
        let mut setup = craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0);
        setup.agents[0].start.reference = vec![vec![0.0; 3], Vec::new(), y.to_vec()];
        setup.time.end_s = 0.1;
        column(&run(&setup), 0, Signal::FilterRate, 1)[0]
    };
    assert!((filtered(&[0.0, 0.7, 0.0, 3.0]) + 0.7).abs() < 1e-15);
}

#[test]
fn the_sign_of_the_quaternion_chooses_the_way_round() {
    for control in [false, true] {
        let furthest = |sign: f64| {
            let half = 0.5_f64;
            let q = [0.0, 0.0, libm::sin(half), libm::cos(half)].map(|x| sign * x);
            let mut setup = craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0);
            setup.agents[0].start.q = q.to_vec();
            let setup = if control { sampled(setup, 50.0) } else { setup };
            let outcome = run(&setup);
            let angle = column(&outcome, 0, Signal::Angle, 0);
            assert!((angle[0] - 1.0).abs() < 1e-12 && angle.last().unwrap() < &5e-3, "{angle:?}");
            angle.iter().fold(0.0_f64, |most, angle| most.max(*angle))
        };
        assert!(furthest(1.0) < 1.0 + 1e-9);
        assert!(furthest(-1.0) > 3.1);
    }
}

#[test]
fn starts_of_further_states_have_their_lengths() {
    let refused = |reference: Vec<Vec<f64>>| {
        let mut setup = craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0);
        setup.agents[0].start.reference = reference;
        simulate(&setup, &mut |_| ControlFlow::Break(())).err().map(|error| error.to_string())
    };
    let z = || vec![0.0; 3];
    assert_eq!(refused(vec![z(), vec![], vec![]]), None);
    for wrong in [vec![vec![]], vec![z(), vec![0.0; 3]], vec![z(), vec![], vec![1.0; 5]], vec![z(), vec![f64::NAN; 4]]]
    {
        assert!(refused(wrong.clone()).is_some(), "{wrong:?}");
    }
    assert!(refused(vec![z(), vec![], vec![], vec![]]).unwrap().contains("has 4 entries where 3 are needed"));
}
