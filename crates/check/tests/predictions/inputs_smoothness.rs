//! Jumps of derivatives of inputs by the first variation, of every kind of plant: against differences of runs, and against series.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::smoothness::{Covered, NoSmoothness, NotCovered, Smoothness, smoothness};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_sim::{
    AgentSetup, ChainLaw, ChainModel, ChainStep, Estimate, Exchange, NetworkJump, Observers, RotorcraftModel, Setup,
    Signal, Start, ThrustKind, input_orders, simulate_with,
};

use super::smoothness::{arms, compare, refused, roots};
use crate::common::kinds::{blind_mass, cascade, chain, rest_at, spacecraft, tracking, vehicle};
use crate::common::{arm, noise};

/// The network of [`arms`] with three of these in it, each elsewhere.
fn three(order: usize, agent: &dyn Fn() -> AgentSetup) -> Setup {
    let mut setup = arms(Exchange::Position, order);
    for (i, own) in setup.agents.iter_mut().enumerate() {
        *own = AgentSetup { name: format!("agent-{}", i + 1), ..agent() };
        own.start.q.iter_mut().enumerate().for_each(|(k, q)| *q += 0.4 * noise(3 * i + k));
    }
    setup
}

fn x(k: usize) -> Expression {
    Expression::variable(k)
}

fn number(value: f64) -> Expression {
    Expression::number(value)
}

/// d³x/dt³ = θ x² + (2 + sin x) u by immersion and invariance or with known terms.
fn third_order(order: usize, adaptive: bool) -> AgentSetup {
    let psi = x(0).sin_of() + 2.0;
    let phi = if adaptive { vec![x(0) * x(0)] } else { Vec::new() };
    let estimate = Estimate { adaptation: vec![1.0; phi.len()], start: vec![0.2; phi.len()], bounds: None };
    let theta = vec![0.5; phi.len()];
    let model = ChainModel::Derivatives(Arc::new(Formulas::new(3, &number(0.0), phi, &psi).unwrap()));
    let step = if adaptive {
        ChainStep::Immersion { gain_per_s: 2.0, estimate, antiderivatives: vec![x(0) * x(0) * x(2)] }
    } else {
        ChainStep::Linearising { gain_per_s: 2.0 }
    };
    let mut agent = chain(&psi, theta.len(), adaptive);
    agent.robot.kind = Arc::new(model);
    agent.law = Arc::new(ChainLaw { step, floor: 1e-3 });
    agent.start = Start { q: vec![0.3], dq: vec![0.1], rest: vec![-0.2], reference: Vec::new() };
    agent.roots_per_s = roots(order).into();
    agent
}

/// One input of an agent, so many derivatives of which must not jump.
fn input(signal: Signal, continuous: usize) -> Covered {
    Covered { signal, derivatives: continuous + 1, continuous: Some(continuous) }
}

/// Nothing below the last derivative jumps, and the last does.
fn keeps(smoothness: &Smoothness, kinds: &[Covered]) {
    assert_eq!(smoothness.kinds(), kinds);
    assert!(smoothness.kept() && !smoothness.jumps.is_empty());
    for jump in &smoothness.jumps {
        let kind = kinds.iter().find(|kind| kind.signal == jump.signal).unwrap();
        assert_eq!(jump.derivatives.len(), kind.derivatives);
        let (last, below) = jump.derivatives.split_last().unwrap();
        assert!(below.iter().flatten().all(|change| change.jump == 0.0), "{jump:?}");
        assert!(last.iter().any(|change| change.jump != 0.0), "{jump:?}");
    }
}

#[test]
fn val_one_sided_differences_of_runs_are_the_jumps_of_chains_and_masses_of_every_order() {
    for order in 1..=3 {
        let with = |agent: AgentSetup| AgentSetup { roots_per_s: roots(order).into(), ..agent };
        let torque = [input(Signal::Torque, order - 1)];
        let psi = x(0).sin_of() + 2.0;
        for adaptive in [false, true] {
            let parameters = usize::from(adaptive);
            keeps(&compare(&three(order, &|| with(chain(&psi, parameters, adaptive))), 2, false), &torque);
            if order > 1 {
                let torque = [input(Signal::Torque, order - 2)];
                keeps(&compare(&three(order, &|| third_order(order, adaptive)), 2, false), &torque);
            }
        }
        let strict = || with(cascade(x(1) + x(0) * x(0), number(1.5), 1));
        keeps(&compare(&three(order, &strict), 2, false), &torque);
        if order > 1 {
            keeps(&compare(&three(order, &|| with(blind_mass(1.0, 1.0))), 2, false), &torque);
        }
    }
}

#[test]
fn thm3_orders_four_and_five_of_chains_and_masses_keep_what_43_promises() {
    for order in 4..=5 {
        let with = |agent: AgentSetup| AgentSetup { roots_per_s: roots(order).into(), ..agent };
        let agents: [&dyn Fn() -> AgentSetup; 4] = [
            &|| with(chain(&number(2.0), 1, true)),
            &|| third_order(order, true),
            &|| with(blind_mass(1.0, 1.0)),
            &|| with(cascade(x(1), number(1.5), 1)),
        ];
        for (agent, less) in agents.into_iter().zip([1, 2, 1, 1]) {
            let mut setup = three(order, agent);
            setup.solver.max_step_s = None;
            let found = smoothness(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
            keeps(&found, &[input(Signal::Torque, order - less)]);
        }
    }
}

fn designs() -> [(ThrustKind, usize); 3] {
    [
        (ThrustKind::Continuous, 0),
        (ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 }, 1),
        (ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 1.6, bounds: None }, 1),
    ]
}

#[test]
fn thm4_5_the_thrust_of_a_vehicle_is_one_derivative_smoother_than_its_angular_velocity() {
    for (design, continuous) in designs() {
        let setup = three(2, &|| vehicle(design, Floor::Stops(0.1)));
        let kinds = [input(Signal::AngularVelocity, continuous), input(Signal::Thrust, continuous + 1)];
        keeps(&compare(&setup, 2, false), &kinds);
    }
}

/// What (49), of order three, has before a measured acceleration with order two.
#[test]
fn own_by_a_measured_acceleration_the_rate_of_the_thrust_jumps_as_the_angular_velocity_does() {
    let design = ThrustKind::ByAcceleration {
        alpha_star: 3.0,
        gamma_star: 0.2,
        estimate_start: 1.6,
        bounds: None,
        bias: [0.0; 3],
    };
    let setup = three(2, &|| vehicle(design, Floor::Stops(0.1)));
    keeps(&compare(&setup, 2, false), &[input(Signal::AngularVelocity, 0), input(Signal::ThrustRate, 0)]);
}

#[test]
fn a_rotorcraft_is_promised_its_thrust_and_its_torque_is_reported() {
    for (design, continuous) in designs() {
        let craft = || {
            let mut craft = vehicle(design, Floor::Stops(0.1));
            craft.robot.kind = Arc::new(RotorcraftModel { gravity: 9.81, inertia: Gain::Number(0.02), rotors: None });
            craft.start.rest = [&craft.start.rest[..], &[0.0; 3]].concat();
            craft
        };
        let found = compare(&three(2, &craft), 2, false);
        // The inner loop asks for dω/dt of the outer one, where that has one.
        let torque = Covered { signal: Signal::Torque, derivatives: 1, continuous: None };
        assert_eq!(found.kinds(), [torque, input(Signal::Thrust, continuous + 1)]);
        assert!(found.kept() && found.largest(torque, 0).unwrap().size > 1e-6);
    }
}

/// Every jump of every input by the first variation, by agent and instant.
fn varied(setup: &Setup) -> Vec<(usize, f64, Vec<Vec<f64>>)> {
    let mut seen = Vec::new();
    let mut look = |jump: NetworkJump<'_>| {
        if jump.before != jump.after {
            assert_eq!(jump.inputs.len(), 1);
            seen.push((jump.agent, jump.t_s, jump.inputs[0].derivatives.clone()));
        }
    };
    simulate_with(
        setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { jumps: Some(&mut look), ..Observers::default() },
    )
    .unwrap();
    seen
}

#[test]
fn thm3_the_first_variation_gives_robots_the_jumps_of_their_series() {
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=5 {
            let mut setup = arms(exchange, order);
            setup.solver.max_step_s = None;
            let found = smoothness(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
            let varied = varied(&setup);
            assert_eq!(varied.len(), found.jumps.len());
            for ((agent, t_s, derivatives), jump) in varied.iter().zip(&found.jumps) {
                assert_eq!((*agent, *t_s, derivatives.len()), (jump.agent, jump.t_s, order));
                for (own, series) in derivatives.iter().flatten().zip(jump.derivatives.iter().flatten()) {
                    assert!((own - series.jump).abs() <= 1e-9 * series.jump.abs(), "{order}: {own} {series:?}");
                }
            }
        }
    }
}

#[test]
fn robots_beyond_the_length_of_a_series_are_reported_by_the_first_variation() {
    let mut setup = arms(Exchange::Position, 9);
    setup.solver.max_step_s = None;
    setup.agents[1].roots_per_s.real.pop();
    let found = smoothness(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(found.kinds(), [input(Signal::Torque, 7), input(Signal::Torque, 8)]);
    assert!(found.kept());
    let sides = |jump: usize| found.jumps[jump].derivatives[0][0].sides;
    for (k, jump) in found.jumps.iter().enumerate() {
        assert_eq!(sides(k).is_some(), jump.agent == 1);
        assert!(jump.derivatives.last().unwrap().iter().all(|change| change.jump != 0.0));
    }
}

#[test]
fn agents_that_nothing_in_the_network_reaches_are_told_so() {
    let own = |agent: AgentSetup, axes| refused(&tracking(agent, vec![rest_at(0.1); axes]));
    for refused in [own(blind_mass(1.0, 1.0), 1), own(arm(0, &roots(2)), 2)] {
        assert!(matches!(refused, NoSmoothness::NoAgent { reason: NotCovered::OwnTarget, .. }), "{refused}");
    }
    let target = [0.0, 0.0, 0.6, 0.8].map(rest_at).to_vec();
    let craft = refused(&tracking(spacecraft(), target));
    assert!(matches!(craft, NoSmoothness::NoAgent { reason: NotCovered::OwnTarget, .. }), "{craft}");
    let alone = tracking(blind_mass(1.0, 1.0), vec![rest_at(0.1)]);
    assert_eq!(input_orders(&alone).unwrap()[0][0].order, None);
}
