//! Vehicles with one thrust, (44)–(58), and rotorcraft: the identities of the proofs along real runs, agreement, formations.

use forwardstep_sim::reference::Tracking;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::vehicles::{
    ADAPTIVE, BY_ACCELERATION, DIFFERENTIABLE, G, by_acceleration, rotorcraft, three, vehicle,
};
use crate::common::{RTOL, assert_first_order, balance_residual, column, last, run, sampled, truth};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::plant::Rotors;
use forwardstep_core::robot::PlanarArm;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    BreakdownCause, Ending, Exchange, Known, Outcome, Robot, RotorcraftModel, Setup, SetupError, Signal, ThrustKind,
    ThrustLaw, simulate,
};

/// max over agents and axes of the spread of x − d, at the end.
fn spread(setup: &Setup, outcome: &Outcome) -> f64 {
    let centre = |agent: usize, axis: usize| {
        let away = setup.agents[agent].target.as_ref().map_or(0.0, |_| last(outcome, agent, Signal::Offset, axis));
        last(outcome, agent, Signal::Position, axis) - away
    };
    let axes = (0..3).map(|axis| {
        let all = (0..setup.agents.len()).map(|agent| centre(agent, axis));
        all.clone().fold(f64::MIN, f64::max) - all.fold(f64::MAX, f64::min)
    });
    axes.fold(0.0, f64::max)
}

#[test]
fn thm4_and_thm5_lyapunov_functions_lose_what_their_proofs_say_along_real_runs() {
    for kind in [vehicle(), rotorcraft()] {
        for design in [DIFFERENTIABLE, ADAPTIVE] {
            for in_formation in [false, true] {
                let setup = three(&kind, design, in_formation, 15.0);
                let outcome = run(&setup);
                for agent in 0..3 {
                    let error = balance_residual(&outcome, agent, 0.0);
                    assert!(error <= 10.0 * RTOL, "{kind:?} {design:?} {in_formation} {agent}: {error:e}");
                }
            }
        }
    }
}

/// By a measured acceleration, with the power of its bias.
#[test]
fn own_lyapunov_function_loses_what_its_proof_says_by_a_measured_acceleration() {
    for (bias, in_formation) in [([0.0; 3], false), ([0.0; 3], true), ([0.1, -0.2, 0.15], true)] {
        let setup = three(&vehicle(), by_acceleration(bias), in_formation, 15.0);
        let outcome = run(&setup);
        for agent in 0..3 {
            let error = balance_residual(&outcome, agent, 0.0);
            assert!(error <= 10.0 * RTOL, "{bias:?} {in_formation} {agent}: {error:e}");
            // What is recorded is the rate of the velocity, and what the sensor adds.
            let [dx, ddx] = [Signal::Velocity, Signal::Acceleration].map(|signal| column(&outcome, agent, signal, 2));
            let t = &outcome.recording.t_s;
            let mean: f64 = ddx
                .windows(2)
                .zip(t.windows(2))
                .map(|(a, t)| 0.5 * (a[0] + a[1] - 2.0 * bias[2]) * (t[1] - t[0]))
                .sum();
            assert!((mean - (dx[dx.len() - 1] - dx[0])).abs() < 0.02, "{mean}");
        }
    }
}

/// Vehicles whose accelerometers have the same bias agree on a fixed graph, and drift for ever as fast as the head of the law's file says.
#[test]
fn own_vehicles_with_a_bias_drift_together() {
    for bias in [0.05, -0.1] {
        let mut setup = three(&vehicle(), by_acceleration([0.0, 0.0, bias]), false, 90.0);
        let edge = |from, to| Edge { from, to, weight: Weight::Constant(1.0), delay: 0 };
        setup.network.schedule = Schedule::fixed(vec![edge(0, 1), edge(1, 2), edge(2, 0)]);
        setup.network.delays = vec![Delay::constant(0.0)];
        let outcome = run(&setup);
        assert!(spread(&setup, &outcome) < 1e-5, "{}", spread(&setup, &outcome));
        for agent in 0..3 {
            let (mass, found) = (setup.agents[agent].robot.theta[0], last(&outcome, agent, Signal::Estimate, 0));
            assert!((found - mass * G / (G - bias)).abs() < 1e-6, "{found} for {mass}");
            let speed = last(&outcome, agent, Signal::Velocity, 2);
            // Roots 1 and 1.5, d = 1; up is negative.
            assert!((speed + 3.5 / 4.0 * bias).abs() < 1e-6, "{speed} at {bias}");
        }
    }
}

/// What a law that measures accelerations cannot do is refused with a reason.
#[test]
fn own_accelerations_are_measured_of_vehicles_that_nothing_pushes() {
    let refused = |setup: &Setup| simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
    let craft = three(&rotorcraft(), BY_ACCELERATION, false, 1.0);
    assert_eq!(
        refused(&craft),
        "agent `craft-0`: the thrust law by a measured acceleration is made for vehicles, not for rotorcraft"
    );
    let mut wrong = three(&vehicle(), BY_ACCELERATION, false, 1.0);
    wrong.agents[0].roots_per_s = vec![1.0; 3].into();
    assert!(refused(&wrong).contains("the list of roots"), "{}", refused(&wrong));
    let mut started = three(&vehicle(), BY_ACCELERATION, false, 1.0);
    assert!(started.agents[0].change_law(|law: &mut ThrustLaw| law.thrust_start = Some(13.0)));
    let outcome = run(&started);
    assert_eq!(column(&outcome, 0, Signal::Thrust, 0)[0], 13.0);
    assert_eq!(column(&outcome, 1, Signal::Thrust, 0)[0], 0.8 * G);
}

#[test]
fn thm4_and_thm5_vehicles_agree_over_switching_delayed_links() {
    for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE, BY_ACCELERATION] {
        let setup = three(&vehicle(), design, false, 60.0);
        let outcome = run(&setup);
        assert!(spread(&setup, &outcome) < 2e-3, "{design:?}: {}", spread(&setup, &outcome));
        for agent in 0..3 {
            let speed = (0..3).map(|axis| last(&outcome, agent, Signal::Velocity, axis).abs()).fold(0.0, f64::max);
            assert!(speed < 2e-3, "{design:?}: {speed}");
            let norm: f64 = (0..4).map(|k| last(&outcome, agent, Signal::Attitude, k).powi(2)).sum();
            assert!((norm - 1.0).abs() < 1e-14, "{norm}");
            if let ThrustKind::Adaptive { .. } | ThrustKind::ByAcceleration { .. } = design {
                // Gravity excites the estimate for ever: the mass is found, and s tends to a constant.
                let (mass, found) = (setup.agents[agent].robot.theta[0], last(&outcome, agent, Signal::Estimate, 0));
                assert!((mass - found).abs() < 1e-3, "{found} for {mass}");
            }
        }
    }
}

#[test]
fn formations_turn_about_a_point_that_is_agreed_upon() {
    for kind in [vehicle(), rotorcraft()] {
        for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE, BY_ACCELERATION] {
            if kind.is::<RotorcraftModel>() && [ThrustKind::Continuous, BY_ACCELERATION].contains(&design) {
                // Its ω jumps and its rate cannot be foreseen: the rate loop lags behind for ever.
                continue;
            }
            let setup = three(&kind, design, true, 60.0);
            let outcome = run(&setup);
            assert!(spread(&setup, &outcome) < 3e-3, "{kind:?} {design:?}: {}", spread(&setup, &outcome));
        }
    }
}

#[test]
fn prop_sampled_vehicles_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    for (kind, design) in [
        (vehicle(), ThrustKind::Continuous),
        (vehicle(), DIFFERENTIABLE),
        (vehicle(), ADAPTIVE),
        (vehicle(), BY_ACCELERATION),
        (rotorcraft(), DIFFERENTIABLE),
        (rotorcraft(), ADAPTIVE),
    ] {
        assert_first_order(&three(&kind, design, true, 2.0), 500.0);
    }
}

/// Against `validation/vehicles`, with rotation matrices and accelerations.
#[test]
fn val_vehicles_agree_with_an_independent_solver() {
    let mut truths = truth::read(include_str!("../../../validation/vehicles/vehicles.json")).into_iter();
    for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE, by_acceleration([0.1, -0.2, 0.15])] {
        for in_formation in [false, true] {
            let mut setup = three(&vehicle(), design, in_formation, 6.0);
            setup.network.delays = vec![Delay::constant(0.0)];
            for agent in &mut setup.agents {
                // z starts at zero in both programs; (46) has none.
                agent.start.reference =
                    vec![vec![0.0; 3]; if design == ThrustKind::Continuous { 0 } else { design.order() }];
            }
            let truth = truths.next().unwrap();
            let worst = truth.largest_difference(setup);
            assert!(worst < 1e-6, "{}: {worst:e}", truth.name);
        }
    }
}

#[test]
fn thrust_that_vanishes_stops_the_run_before_it_is_zero_or_is_kept_away() {
    let mut setup = three(&vehicle(), DIFFERENTIABLE, false, 6.0);
    // One far above the others: it wants to fall faster than it can.
    setup.agents[0].start.q[2] = -150.0;
    let mut measured = three(&vehicle(), BY_ACCELERATION, false, 6.0);
    measured.agents[0].start.q[2] = -150.0;
    for setup in [setup.clone(), sampled(setup.clone(), 500.0), measured.clone(), sampled(measured.clone(), 500.0)] {
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        let Ending::BrokeDown(breakdown) = outcome.ending else { panic!("{:?}", outcome.ending) };
        assert_eq!((breakdown.agent, breakdown.signal), (0, Signal::Thrust));
        let BreakdownCause::Vanished { value, floor } = breakdown.cause else { panic!("{:?}", breakdown.cause) };
        assert!(floor == 1.0 && value > 0.0 && value <= floor, "{value}");
        let mut recorded = outcome.recording.columns.iter().flat_map(|column| &column.values);
        assert!(recorded.all(|value| value.is_finite()));
    }
    // The rival turns sooner, and comes less close to its floor.
    for (setup, close) in [(&mut setup, 2.0), (&mut measured, 5.0)] {
        for agent in &mut setup.agents {
            assert!(agent.change_law(|law: &mut ThrustLaw| law.floor = Floor::Kept { floor: 1.0, approach_s: 0.1 }));
        }
        setup.time.record_every_s = 1e-3;
        let kept = run(setup);
        let least = column(&kept, 0, Signal::Thrust, 0).iter().copied().fold(f64::MAX, f64::min);
        assert!(least > 1.0 && least < close, "the floor is approached, never crossed: {least}");
    }
}

#[test]
fn prop_rotors_stay_within_their_limits_and_slow_the_formation_down() {
    let rotors = Rotors { offset: 0.15, drag: 0.02, thrust: [0.3, 4.5] };
    let unlimited = rotorcraft().downcast::<RotorcraftModel>().unwrap().clone();
    let kind: Arc<dyn Robot> = Arc::new(RotorcraftModel { rotors: Some(rotors), ..unlimited });
    let setup = three(&kind, DIFFERENTIABLE, false, 60.0);
    let outcome = run(&setup);
    let rows = outcome.recording.t_s.len();
    let mut reached = false;
    for agent in 0..3 {
        for row in 0..rows {
            let tau = [0, 1, 2].map(|axis| column(&outcome, agent, Signal::Torque, axis)[row]);
            let thrusts = rotors.thrusts(column(&outcome, agent, Signal::Thrust, 0)[row], tau);
            assert!(thrusts.iter().all(|t| (0.3 - 1e-9..=4.5 + 1e-9).contains(t)), "{thrusts:?}");
            reached |= thrusts.iter().any(|t| !(0.3 + 1e-9..=4.5 - 1e-9).contains(t));
        }
    }
    assert!(reached, "limits that bite");
    assert!(spread(&setup, &outcome) < 5e-3, "{}", spread(&setup, &outcome));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let good = three(&vehicle(), DIFFERENTIABLE, false, 1.0);
    let refused = |change: &dyn Fn(&mut Setup)| {
        let mut setup = good.clone();
        change(&mut setup);
        simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap_err()
    };
    let law = |setup: &mut Setup, change: &dyn Fn(&mut ThrustLaw)| {
        assert!(setup.agents[1].change_law(change));
    };
    assert!(matches!(refused(&|s| s.exchange = Exchange::PositionVelocity), SetupError::SendsPositionOnly { .. }));
    assert!(matches!(refused(&|s| s.agents[1].roots_per_s.real.truncate(2)), SetupError::RootCount { .. }));
    let arm = |s: &mut Setup| {
        s.agents[1].robot.kind = Arc::new(PlanarArm);
        s.agents[1].start.rest.clear();
    };
    assert!(matches!(refused(&arm), SetupError::LawOfAnother { .. }));
    assert!(matches!(refused(&|s| s.agents[1].manipulability = 0.5), SetupError::NoManipulability { .. }));
    assert!(matches!(refused(&|s| s.agents[1].start.rest = vec![0.0; 3]), SetupError::Entries { got: 9, .. }));
    assert!(matches!(refused(&|s| s.agents[1].robot.theta[0] = -1.0), SetupError::Quantity(_)));
    assert!(matches!(refused(&|s| law(s, &|law| law.floor = Floor::Stops(0.0))), SetupError::Quantity(_)));
    assert!(matches!(refused(&|s| s.reference = Arc::new(Tracking)), SetupError::NotTracking { .. }));
    let known = Arc::new(Known { damping: Gain::Number(1.0) });
    assert!(matches!(refused(&|s| s.agents[1].law = known.clone()), SetupError::LawOfAnother { .. }));
    let flat = Arc::new(RotorcraftModel { gravity: G, inertia: Gain::Diagonal(vec![1.0, 1.0, 0.0]), rotors: None });
    let refused_flat = refused(&|s| {
        s.agents[1].robot.kind = flat.clone();
        s.agents[1].start.rest = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    });
    let SetupError::Quantity(error) = refused_flat else { panic!("{refused_flat:?}") };
    assert_eq!(error.path.to_string(), "agents[1].robot.inertia_kg_m2[2]");
}
