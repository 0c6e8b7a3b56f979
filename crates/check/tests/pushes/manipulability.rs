//! Remark 4 as a transfer: from a torque on one agent to the value agreed upon, by theory and by pushing.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::manipulability::{LowFrequency, Manipulability, Measured, NoManipulability, Trial, measure};
use forwardstep_check::prediction::NoRate;
use forwardstep_check::{ideal, predict};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::reference::{RootPair, RootSet};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::reference::{Consensus, PureIntegral, ReferenceDynamics};
use forwardstep_sim::{Adaptive, Control, Exchange, Known, Sensors, Setup, Signal, Start};

use super::{DAMPING, arm, mass, ring};
use crate::common::{column, edge, run};

/// Roots that differ but for the first, as order and agent say.
fn roots(order: usize, agent: usize) -> Vec<f64> {
    (0..order).map(|r| 1.1 + r as f64 * (0.6 + 0.15 * agent as f64)).collect()
}

fn masses(order: usize, exchange: Exchange, lambda: f64) -> Setup {
    let mut setup = ring((0..3).map(|i| mass(i, &roots(order, i))).collect(), exchange, 120.0);
    setup.agents.iter_mut().for_each(|agent| agent.manipulability = lambda);
    setup
}

fn both(setup: &Setup, agent: usize, torque: f64) -> (LowFrequency, Measured) {
    let trial = Trial { agent, axis: 1, torque, for_s: 1.5 };
    let theory = Manipulability::of(setup, agent, 1).unwrap().low_frequency();
    (theory, measure(setup, trial, &mut |_| ControlFlow::Continue(())).unwrap())
}

/// To 1e-3 of the gain; what should be nothing, of `unit`.
fn agrees((theory, measured): (LowFrequency, Measured), degree: i32, unit: f64) {
    assert_eq!(theory.degree, degree, "{theory:?}");
    let close = |measured: f64, theory: f64| {
        let error = (measured - theory).abs();
        assert!(error < 1e-3 * if theory == 0.0 { unit } else { theory.abs() }, "{measured} is not {theory}");
    };
    close(measured.by_impulse, theory.by_impulse());
    close(measured.drift, theory.by_impulse());
    if degree < 1 {
        close(measured.by_constant, theory.by_constant());
    }
}

#[test]
fn eq_31_degree_and_gain_are_those_that_pushes_show() {
    for order in 1..=4 {
        for (exchange, lambda) in [
            (Exchange::Position, 0.0),
            (Exchange::PositionVelocity, 0.0),
            (Exchange::Position, 0.4),
            (Exchange::PositionVelocity, 1.7),
        ] {
            let found = both(&masses(order, exchange, lambda), order % 3, 2.0);
            agrees(found, i32::from(lambda > 0.0), 0.05);
        }
    }
    for (exchange, lambda) in [(Exchange::Position, 0.9), (Exchange::PositionVelocity, 2.5), (Exchange::Position, 0.0)]
    {
        let mut setup = masses(2, exchange, lambda);
        setup.reference = Arc::new(PureIntegral);
        agrees(both(&setup, 0, 2.0), if lambda > 0.0 { 1 } else { -1 }, 0.05);
    }
}

#[test]
fn eq_31_arms_that_know_gravity_have_degree_one_and_arms_that_adapt_to_it_have_none() {
    let known: Arc<dyn forwardstep_sim::Law> = Arc::new(Known { damping: Gain::Matrix(vec![8.0, 1.5, 1.5, 6.0]) });
    let adaptive = |gamma: f64| {
        let adaptation = Gain::Diagonal(vec![gamma; 5]);
        Arc::new(Adaptive { damping: Gain::Number(8.0), adaptation, estimate_start: vec![0.0; 5], bounds: None })
    };
    for (law, lambda, degree) in [
        (known.clone(), 1.5, 1),
        (known, 0.0, 0),
        (adaptive(10.0) as Arc<dyn forwardstep_sim::Law>, 1.5, 0),
        (adaptive(10.0), 0.0, -1),
    ] {
        let agents = (0..3).map(|i| arm(i, &roots(2, i), law.clone())).collect();
        let mut setup = ring(agents, Exchange::PositionVelocity, 120.0);
        setup.agents.iter_mut().for_each(|agent| agent.manipulability = lambda);
        agrees(both(&setup, 1, 0.002), degree, 0.05);
    }
}

#[test]
fn regress_the_transfer_is_that_of_the_place_where_all_agree() {
    let law = Arc::new(Adaptive {
        damping: Gain::Number(8.0),
        adaptation: Gain::Diagonal(vec![10.0; 5]),
        estimate_start: vec![0.0; 5],
        bounds: None,
    });
    let agents = (0..3).map(|i| arm(i, &roots(2, i), law.clone())).collect();
    let setup = ring(agents, Exchange::PositionVelocity, 1.0);
    let agreed = predict(&ideal(&setup).unwrap()).unwrap().value;
    for agent in 0..3 {
        assert!(agreed != setup.agents[agent].start.q);
        assert_eq!(Manipulability::of(&setup, agent, 1).unwrap().posture(), agreed);
    }
}

#[test]
fn eq_31_the_transfer_of_one_agent_is_its_closed_form() {
    let (alpha, beta, lambda, m) = (1.3, 2.1, 0.7, 1.0);
    let mut setup = ring(vec![mass(0, &[alpha, beta])], Exchange::Position, 1.0);
    setup.reference = Arc::new(PureIntegral);
    setup.agents[0].manipulability = lambda;
    let found = Manipulability::of(&setup, 0, 0).unwrap();
    let p = 0.37;
    let want = (p * p + lambda) / (p * (p + alpha) * (p + beta) * (m * p + DAMPING));
    let [re, im] = found.at([p, 0.0]).unwrap();
    assert!((re / want - 1.0).abs() < 1e-13 && im == 0.0);
    assert_eq!(found.at([0.0, 0.0]), None);
}

/// The amplitude of e^(jωt) in the second half of a run, over whole periods.
fn amplitude(values: &[f64], step_s: f64, omega: f64) -> [f64; 2] {
    let period = (2.0 * std::f64::consts::PI / (omega * step_s)).round() as usize;
    let last = values.len() - 1;
    let mut sum = [0.0; 2];
    for (row, value) in values.iter().enumerate().skip(last - 2 * period).take(2 * period) {
        let angle = omega * row as f64 * step_s;
        sum[0] += value * angle.cos();
        sum[1] -= value * angle.sin();
    }
    sum.map(|sum| sum / period as f64)
}

#[test]
fn eq_31_the_transfer_is_the_frequency_response_of_a_run_with_delays() {
    // Two periods end with the run; rows divide them evenly.
    let (omega, step_s) = (2.0 * std::f64::consts::PI / 8.0, 0.02);
    for (reference, exchange, order) in [
        (Arc::new(Consensus) as Arc<dyn ReferenceDynamics>, Exchange::PositionVelocity, 3),
        (Arc::new(Consensus), Exchange::Position, 1),
        (Arc::new(PureIntegral), Exchange::PositionVelocity, 2),
    ] {
        let mut setup = masses(order, exchange, 0.0);
        setup.reference = reference;
        // λ of the one that is pushed alone keeps the agreement.
        setup.agents[0].manipulability = 0.8;
        for agent in &mut setup.agents {
            agent.start = Start { q: vec![0.0; 2], dq: vec![0.0; 2], rest: Vec::new(), reference: Vec::new() };
        }
        let wave = Function::Formula((Expression::variable(0) * omega).cos_of() * 2.0);
        let effect = Effect::Torque(Course::Each(vec![wave, Function::Constant(0.0)]));
        setup.agents[0].pushes = vec![Push { effect, from_s: 0.0, until_s: f64::INFINITY }];
        setup.time.record_every_s = step_s;
        let transfer = Manipulability::of(&setup, 0, 0).unwrap();
        let outcome = run(&setup);
        let rows = outcome.recording.t_s.len();
        let mut agreed = vec![0.0; rows];
        for (agent, u) in transfer.influence().iter().enumerate() {
            let q = column(&outcome, agent, Signal::Position, 0);
            agreed.iter_mut().zip(q).for_each(|(sum, q)| *sum += u * q);
        }
        let [re, im] = transfer.at([0.0, omega]).unwrap();
        let found = amplitude(&agreed, step_s, omega);
        let error = (found[0] / 2.0 - re).hypot(found[1] / 2.0 - im);
        assert!(error < 1e-4 * re.hypot(im), "{found:?} is not twice {re} + {im} j");
    }
}

#[test]
fn degree_and_gain_are_the_limit_of_the_transfer() {
    let adaptive = |gamma: Vec<f64>| Adaptive {
        damping: Gain::Matrix(vec![8.0, 1.5, 1.5, 6.0]),
        adaptation: Gain::Diagonal(gamma),
        estimate_start: vec![0.0; 5],
        bounds: None,
    };
    let mut seen = Vec::new();
    for (lambda, integral) in [(0.0, false), (0.6, false), (0.0, true), (0.6, true)] {
        for knows in [false, true] {
            // The first may be a point mass that knows its parameter.
            let law = Arc::new(adaptive(vec![0.5; 5]));
            let mut setup = ring((0..3).map(|i| arm(i, &roots(2, i), law.clone())).collect(), Exchange::Position, 1.0);
            if integral {
                setup.reference = Arc::new(PureIntegral);
            }
            if knows {
                setup.agents[0] = mass(0, &roots(2, 0));
            }
            setup.agents[0].manipulability = lambda;
            let transfer = Manipulability::of(&setup, 0, 1).unwrap();
            let LowFrequency { degree, gain } = transfer.low_frequency();
            let p = 1e-6_f64;
            let [re, _] = transfer.at([p, 0.0]).unwrap();
            assert!((re * p.powi(degree) / gain - 1.0).abs() < 1e-4, "{degree}: {gain}, {}", re * p.powi(degree));
            seen.push(degree);
        }
    }
    assert_eq!(seen, [-1, 0, 0, 1, -2, -1, 0, 1]);
}

#[test]
fn networks_without_such_a_transfer_say_why() {
    let fine = masses(2, Exchange::Position, 1.0);
    let why = |change: &dyn Fn(&mut Setup)| {
        let mut setup = fine.clone();
        change(&mut setup);
        Manipulability::of(&setup, 0, 0).unwrap_err()
    };
    assert_eq!(Manipulability::of(&fine, 3, 0).unwrap_err(), NoManipulability::NoSuchAxis { agent: 3, axis: 0 });
    assert_eq!(Manipulability::of(&fine, 0, 2).unwrap_err(), NoManipulability::NoSuchAxis { agent: 0, axis: 2 });
    let listens = why(&|setup| {
        setup.network.schedule = forwardstep_sim::schedule::Schedule::fixed(vec![
            edge(1, 2, 1.0, 0),
            edge(2, 1, 1.0, 0),
            edge(1, 0, 1.0, 0),
        ]);
    });
    assert_eq!(listens, NoManipulability::NoInfluence { agent: 0 });
    let apart =
        why(&|setup| setup.network.schedule = forwardstep_sim::schedule::Schedule::fixed(vec![edge(0, 1, 1.0, 0)]));
    assert_eq!(apart, NoManipulability::Network(NoRate::NoSpanningTree));
    let sampled = why(&|setup| {
        setup.control = Some(Control {
            sample_hz: 100.0,
            computation_delay_s: 0.0,
            sensors: Sensors::default(),
            actuators: Default::default(),
            failures: Default::default(),
        });
    });
    assert_eq!(sampled, NoManipulability::Sampled);
    // Roots −0.1 ± 2 i let the disagreement of these agents grow, and no push then leaves what it displaced; −1 ± 0.2 i do not.
    let pair = |real: f64, imaginary: f64| {
        let mut setup = fine.clone();
        let roots = RootSet { real: Vec::new(), pairs: vec![RootPair { real, imaginary }] };
        setup.agents.iter_mut().for_each(|agent| (agent.roots_per_s, agent.manipulability) = (roots.clone(), 0.0));
        Manipulability::of(&setup, 0, 0)
    };
    let grows = pair(0.1, 2.0);
    assert!(matches!(grows, Err(NoManipulability::Network(NoRate::Grows { .. }))), "{grows:?}");
    assert!(pair(1.0, 0.2).is_ok());
}

#[test]
fn eq_31_what_damps_a_ship_itself_counts_beside_k() {
    let ship = |index: usize| {
        let mut agent = mass(index, &roots(2, index));
        agent.robot.kind = Arc::new(forwardstep_core::robot::Ship);
        agent.robot.theta = vec![25.8, 33.8, 1.0, 2.8, 9.0, 7.0, 0.3, 0.2, 5.0];
        agent.robot.theta_names = vec![String::new(); 9];
        agent.robot.axes.push(agent.robot.axes[0].clone());
        agent.robot.axes[2].name = "heading".into();
        agent.start.q.push(0.4);
        agent.start.dq.push(0.0);
        agent.manipulability = 1.2;
        agent
    };
    let setup = ring((0..3).map(ship).collect(), Exchange::PositionVelocity, 150.0);
    agrees(both(&setup, 0, 0.002), 1, 0.05);
}
