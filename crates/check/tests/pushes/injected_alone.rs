//! What changed V of sampled agents that are by themselves: targets of their own, chains, masses without velocity, vehicles, spacecraft, end-effectors.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::{Injection, InjectionBalance, InjectionWatch};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_sim::push::{Effect, Push};
use forwardstep_sim::{
    AgentSetup, ChainModel, Control, Ending, Exchange, Observers, Outcome, Sensors, Setup, Start, ThrustKind,
    VelocitySensor, simulate, simulate_with,
};

use super::{constant, ring};
use crate::common::arm;
use crate::common::kinds::{blind_mass, cascade, chain, planar_tip, rest_at, spacecraft, tracking, vehicle};

fn watched(setup: &Setup) -> (Outcome, Vec<InjectionBalance>) {
    forwardstep_sim::validate(setup).unwrap();
    let mut watch = InjectionWatch::of(setup).unwrap();
    let outcome = simulate_with(
        setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { inside: Some(&mut watch), ..Observers::default() },
    )
    .unwrap();
    super::injected::course_adds_up(&watch);
    (outcome, watch.balances())
}

fn sampled(mut setup: Setup, end_s: f64) -> Setup {
    setup.time.end_s = end_s;
    setup.time.record_every_s = 0.5;
    setup.sampled(250.0)
}

fn two(agent: &dyn Fn() -> AgentSetup) -> Setup {
    let mut setup = ring(vec![agent(), agent()], Exchange::Position, 2.0);
    setup.agents[1].name = "other".into();
    setup.agents[1].start.q.iter_mut().for_each(|q| *q += 0.4);
    sampled(setup, 2.0)
}

/// One design of every kind, by name.
fn designs() -> Vec<(&'static str, Setup)> {
    let x = Expression::variable;
    let psi = x(0).sin_of() + 2.0;
    let own = |mut agent: AgentSetup, target: &[f64]| {
        agent.start.dq.iter_mut().for_each(|dq| *dq += 0.1);
        sampled(tracking(agent, target.iter().map(|value| rest_at(*value)).collect()), 2.0)
    };
    let slow = |mut agent: AgentSetup| {
        agent.roots_per_s = [1.0, 2.0].into();
        agent
    };
    vec![
        ("robot with a target", own(arm(0, &[1.0, 1.5]), &[0.4, -0.2])),
        ("mass without velocity and a target", own(blind_mass(1.0, 1.0), &[0.9])),
        ("end-effector", own(planar_tip(), &[1.0, 0.9])),
        ("spacecraft", own(spacecraft(), &[0.0, 0.0, 0.6, 0.8])),
        ("masses without velocity", two(&|| blind_mass(1.0, 1.0))),
        ("chains", two(&|| slow(chain(&psi, 0, false)))),
        ("chains that adapt", two(&|| slow(chain(&psi, 1, true)))),
        ("strict feedback", two(&|| slow(cascade(x(1) + x(0) * x(0), Expression::number(1.5), 1)))),
        (
            "vehicles",
            two(&|| vehicle(ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 }, Floor::Stops(0.1))),
        ),
        (
            "vehicles that adapt",
            two(&|| {
                let design =
                    ThrustKind::Adaptive { alpha_star: 3.0, gamma_star: 0.2, estimate_start: 1.6, bounds: None };
                vehicle(design, Floor::Stops(0.1))
            }),
        ),
    ]
}

fn with(setup: &Setup, change: impl FnOnce(&mut Control)) -> Setup {
    let mut setup = setup.clone();
    change(setup.control.as_mut().unwrap());
    setup
}

/// Runs a setup and requires that for every agent the terms add up and that just these causes, besides damping and holding, act.
fn only(name: &str, setup: &Setup, causes: &[Injection]) -> Vec<InjectionBalance> {
    let (outcome, balances) = watched(setup);
    assert_eq!((&outcome.ending, balances.len()), (&Ending::Completed, setup.agents.len()), "{name}");
    for balance in &balances {
        assert!(
            balance.residual_j().abs() < 1e-10 * balance.largest_j.max(1e-4),
            "{name}: {balance:?}, {}",
            balance.residual_j()
        );
        assert!(balance.term_j(Injection::Dissipated) < 0.0 && balance.start_j != balance.end_j, "{name}: {balance:?}");
        for injection in Injection::ALL {
            let acts = matches!(injection, Injection::Dissipated | Injection::Held) || causes.contains(&injection);
            assert_eq!(balance.term_j(injection) != 0.0, acts, "{name}, {}: {balance:?}", injection.name());
        }
    }
    balances
}

#[test]
fn prop_what_is_put_into_v_of_every_kind_adds_up_and_every_cause_counts_where_it_acts() {
    for (name, setup) in &designs() {
        only(name, setup, &[]);
        only(name, &with(setup, |control| control.computation_delay_s = 1e-3), &[]);
        // Without measured velocities there is nothing to reconstruct.
        let blind = name.contains("without velocity") || ["spacecraft", "strict feedback"].contains(name);
        let noisy = |control: &mut Control| {
            let velocity_noise = if blind { 0.0 } else { 1e-5 };
            control.sensors = Sensors { position_noise: 1e-5, velocity_noise, seed: 4, ..control.sensors };
        };
        only(name, &with(setup, noisy), &[Injection::Measured]);
        if !blind {
            let filtered = VelocitySensor::Filtered { cut_off_hz: 30.0 };
            let filter = |control: &mut Control| control.sensors.velocity = filtered;
            only(name, &with(setup, filter), &[Injection::Reconstructed]);
        }
        // What is rounded is a torque; those of wheels and thrusts have other limits.
        if !name.contains("vehicles") && *name != "spacecraft" {
            only(name, &with(setup, |control| control.actuators.torque_quantum = 1e-3), &[Injection::Limited]);
        }
    }
}

/// A chain of order one has no velocity that a filter could make.
#[test]
fn regress_chains_of_order_one_beside_others_are_traced_under_a_filter() {
    let mut setup = two(&|| chain(&(Expression::variable(0).sin_of() + 2.0), 0, false));
    let own = |order: usize| {
        let model = Formulas::new(order, &Expression::number(0.0), Vec::new(), &Expression::number(1.0)).unwrap();
        Arc::new(ChainModel::Derivatives(Arc::new(model)))
    };
    setup.agents[0].robot.kind = own(1);
    setup.agents[0].start = Start { q: vec![0.3], dq: Vec::new(), rest: Vec::new(), reference: Vec::new() };
    setup.agents[1].robot.kind = own(2);
    for agent in &mut setup.agents {
        agent.roots_per_s = [1.0, 2.0].into();
    }
    setup.control.as_mut().unwrap().sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 30.0 };
    let (outcome, balances) = watched(&setup);
    assert_eq!((&outcome.ending, balances.len()), (&Ending::Completed, 2));
    let reconstructed: Vec<bool> =
        balances.iter().map(|balance| balance.term_j(Injection::Reconstructed) != 0.0).collect();
    assert_eq!(reconstructed, [false, true]);
}

#[test]
fn prop_a_push_on_an_agent_by_itself_is_counted_and_only_then() {
    for (name, setup) in designs() {
        let effect = match name {
            "chains" | "chains that adapt" => Effect::Torque(constant(&[0.02])),
            "strict feedback" => Effect::Torque(constant(&[0.0, 0.02])),
            "mass without velocity and a target" | "masses without velocity" => Effect::Torque(constant(&[0.2])),
            "robot with a target" | "end-effector" => Effect::Torque(constant(&[0.5, -0.2])),
            _ => continue,
        };
        let mut pushed = setup.clone();
        let push = Push { effect, from_s: 0.3, until_s: 0.9 };
        pushed.agents.iter_mut().for_each(|agent| agent.pushes = vec![push.clone()]);
        only(name, &pushed, &[Injection::Pushed]);
    }
}

#[test]
fn prop_with_the_period_what_holding_puts_into_v_vanishes() {
    for (name, mut setup) in designs() {
        let share = |setup: &Setup| {
            let balances = only(name, setup, &[]);
            let held = |balance: &InjectionBalance| balance.term_j(Injection::Held).abs() / balance.largest_j;
            balances.iter().map(held).fold(0.0, f64::max)
        };
        let coarse = share(&setup);
        setup.control.as_mut().unwrap().sample_hz *= 16.0;
        let fine = share(&setup);
        assert!(fine < 0.25 * coarse, "{name}: {coarse} {fine}");
    }
}

#[test]
fn regress_a_run_whose_energies_are_looked_at_has_the_same_bits() {
    for (name, setup) in designs() {
        let plain = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        let (watched, _) = watched(&setup);
        assert!(plain.recording == watched.recording, "{name}");
    }
}

#[test]
fn the_first_cause_of_an_agent_by_itself_is_named_with_its_time() {
    let (name, mut setup) = designs().remove(0);
    setup.control.as_mut().unwrap().sample_hz = 2000.0;
    assert_eq!(only(name, &setup, &[])[0].first, None);
    let limited = with(&setup, |control| control.actuators.torque_limit = Some(vec![2.0, 0.5]));
    let first = only(name, &limited, &[Injection::Limited])[0].first;
    assert!(first.is_some_and(|(cause, t_s)| cause == Injection::Limited && t_s > 0.0 && t_s < 1.0), "{first:?}");
}
