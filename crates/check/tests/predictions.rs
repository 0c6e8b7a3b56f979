//! When the value agreed upon is known before the run, and every reason why it is not.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

mod common;
#[path = "predictions/course.rs"]
mod course;
#[path = "predictions/rate.rs"]
mod rate;

use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral, Tracking};
use std::sync::Arc;

use common::kinds::{alone, blind_mass};
use common::{column, edge, masses, run, setup};
use forwardstep_check::{NoPrediction, predict};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Adaptive, Control, Exchange, Known, Setup, Signal};

/// Two masses that hear each other, and a third that only listens.
fn three(exchange: Exchange) -> Setup {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 2.0, 1), edge(1, 2, 1.5, 0)];
    let delays = vec![Delay::constant(0.2), Delay::constant(0.0)];
    let mut setup = masses(exchange, 2, Schedule::fixed(edges), delays);
    setup.agents.truncate(3);
    setup.network.agents = 3;
    setup.time.end_s = 60.0;
    setup.time.record_every_s = 1.0;
    setup
}

fn pushed_for_ever(value: f64) -> Push {
    let course = Course::Each(vec![Function::Constant(value), Function::Constant(0.0)]);
    Push { effect: Effect::Torque(course), from_s: 1.0, until_s: f64::INFINITY }
}

fn ends(setup: &Setup, agent: usize, axis: usize) -> f64 {
    *column(&run(setup), agent, Signal::Position, axis).last().unwrap()
}

#[test]
fn eq_3_and_23_keep_their_value_whoever_pushes_for_ever() {
    // No z is in what they conserve, so a tracking error that stays does not count.
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        let mut setup = three(exchange);
        setup.reference = Arc::new(PureIntegral);
        let untouched = predict(&setup).unwrap();
        setup.agents[0].pushes = vec![pushed_for_ever(2.0)];
        assert_eq!(predict(&setup).unwrap(), untouched);
        for axis in 0..2 {
            assert!((ends(&setup, 1, axis) - untouched.value[axis]).abs() < 1e-6, "{exchange:?}");
        }
        // With λ the integral of s counts, which has no end.
        setup.agents[0].manipulability = 0.5;
        assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 0 }));
        setup.agents[0].manipulability = 0.0;
        setup.reference = Arc::new(Consensus);
        assert_eq!(predict(&setup), Err(NoPrediction::PushedForEver { agent: 0 }));
    }
}

#[test]
fn who_is_heard_by_nobody_counts_for_nothing() {
    let mut setup = three(Exchange::Position);
    let untouched = predict(&setup).unwrap();
    assert_eq!(untouched.influence[2], 0.0);
    setup.agents[2].pushes = vec![pushed_for_ever(3.0)];
    setup.agents[2].manipulability = 1.0;
    setup.agents[2].law =
        Arc::new(Adaptive { damping: Gain::Number(5.0), adaptation: Gain::Number(1.0), estimate_start: vec![0.0] });
    assert_eq!(predict(&setup).unwrap(), untouched);
    assert!((ends(&setup, 0, 0) - untouched.value[0]).abs() < 1e-6);
    // Who is heard counts.
    setup.agents.swap(1, 2);
    assert!(matches!(predict(&setup), Err(NoPrediction::PushedForEver { agent: 1 })));
    setup.agents[1].pushes.clear();
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
}

#[test]
fn every_reason_for_which_there_is_none_is_the_one_that_is_said() {
    let said = |change: &dyn Fn(&mut Setup)| {
        let mut setup = three(Exchange::Position);
        change(&mut setup);
        predict(&setup).err()
    };
    assert_eq!(said(&|_| {}), None);
    let backstepping = Arc::new(Backstepping { filter_s: 0.1, acceleration_limit: None });
    assert_eq!(said(&|setup| setup.reference = backstepping.clone()), Some(NoPrediction::Backstepping));
    assert_eq!(said(&|setup| setup.reference = Arc::new(Tracking)), Some(NoPrediction::Law));
    let blind = || {
        let mut agent = blind_mass(1.0, 1.0);
        agent.roots_per_s = vec![1.0, 2.0];
        agent
    };
    assert_eq!(said(&|setup| setup.agents[2].law = blind().law), Some(NoPrediction::Law), "one is enough");
    assert_eq!(predict(&alone(blind())).err(), Some(NoPrediction::Law));
    let tanh = Coupling::Tanh { scale: 1.0 };
    assert_eq!(said(&|setup| setup.network.coupling = tanh), Some(NoPrediction::Coupling));
    let control = Control {
        failures: Default::default(),
        sample_hz: 100.0,
        computation_delay_s: 0.0,
        sensors: Default::default(),
        actuators: Default::default(),
    };
    assert_eq!(said(&|setup| setup.control = Some(control.clone())), Some(NoPrediction::Sampled));
    let saw = Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 1.0, offset_s: 0.0 });
    for delay in [0, 1] {
        assert_eq!(said(&|setup| setup.network.delays[delay] = saw.clone()), Some(NoPrediction::VaryingDelay));
    }
    // A delay that no edge has changes nothing.
    assert_eq!(said(&|setup| setup.network.delays.push(saw.clone())), None);
    let swing = Expression::variable(0).sin_of() * 0.5 + 1.0;
    let varying = |setup: &mut Setup| {
        setup.network.weights = vec![BoundedFormula::new(swing.clone(), 60.0)];
        let edges = &mut setup.network.schedule.graphs[0];
        edges[1].weight = Weight::Formula(0);
    };
    assert_eq!(said(&varying), Some(NoPrediction::VaryingWeight));
    let one_way = Schedule::fixed(vec![edge(0, 1, 1.0, 0)]);
    assert_eq!(
        said(&|setup| setup.network.schedule = one_way.clone()),
        Some(NoPrediction::NoSpanningTree { closed_groups: 2 })
    );
    assert_eq!(said(&|setup| setup.agents[1].roots_per_s = vec![1.0, 0.0]), Some(NoPrediction::Roots { agent: 1 }));
}

#[test]
fn a_schedule_of_one_phase_is_one_graph() {
    let base = three(Exchange::PositionVelocity);
    let edges = &base.network.schedule.graphs[0];
    let phase = Phase { edges: edges.clone(), dwell_s: 1.0 };
    let value = |schedule| {
        predict(&Setup { network: forwardstep_sim::Network { schedule, ..base.network.clone() }, ..base.clone() })
    };
    let fixed = predict(&base).unwrap();
    assert_eq!(value(Schedule::periodic(vec![phase.clone()])).unwrap(), fixed);
    assert_eq!(value(Schedule::once(vec![phase.clone()])).unwrap(), fixed);
    // The same twice is one graph as well, in whatever order its edges stand.
    let mut turned = phase.clone();
    turned.edges.reverse();
    for two in [Schedule::periodic(vec![phase.clone(); 2]), Schedule::once(vec![phase.clone(), turned])] {
        assert_eq!(value(two).unwrap(), fixed);
    }
    let mut heavier = phase.clone();
    heavier.edges[0].weight = 3.0.into();
    assert_eq!(value(Schedule::periodic(vec![phase, heavier])).err(), Some(NoPrediction::Switching));
}

/// K of every kind, for masses that start with a tracking error.
#[test]
fn eq_31_the_agreement_moves_by_the_gain_of_each_axis() {
    for damping in [Gain::Number(3.0), Gain::Diagonal(vec![2.0, 5.0]), Gain::Bandwidth(1.5)] {
        let mut setup = three(Exchange::Position);
        setup.agents[1].law = Arc::new(Known { damping: damping.clone() });
        setup.agents[1].manipulability = 0.8;
        setup.agents[1].start.reference = vec![vec![-0.4, 0.9]];
        let after = predict(&setup).unwrap();
        let outcome = run(&setup);
        for axis in 0..2 {
            for agent in 0..3 {
                let q = *column(&outcome, agent, Signal::Position, axis).last().unwrap();
                assert!((q - after.value[axis]).abs() < 1e-6, "{damping:?}: {q} and {}", after.value[axis]);
            }
        }
    }
    // What a full matrix does to the other axis is not worked out, nor what a limit takes away.
    let mut setup = three(Exchange::Position);
    setup.agents[1].manipulability = 0.8;
    setup.agents[1].start.reference = vec![vec![-0.4, 0.9]];
    setup.agents[1].law = Arc::new(Known { damping: Gain::Matrix(vec![3.0, 0.5, 0.5, 4.0]) });
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
    setup.agents[1].law = Arc::new(Known { damping: Gain::Number(3.0) });
    assert!(predict(&setup).is_ok());
    setup.agents[1].enforce_limits = true;
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
}

#[test]
fn a_single_agent_stays_where_its_own_dynamics_lead() {
    let mut one = three(Exchange::Position);
    one.agents.truncate(1);
    let mut one = setup(one.agents, Exchange::Position, Schedule::fixed(Vec::new()), Vec::new(), 40.0);
    one.time.record_every_s = 1.0;
    let value = predict(&one).unwrap();
    assert_eq!(value.influence, [1.0]);
    assert!((ends(&one, 0, 0) - value.value[0]).abs() < 1e-6);
}
