//! What changed V along sampled runs: all of it adds up, and every cause is there when it acts and not otherwise.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::{Injection, InjectionBalance, InjectionWatch};
use forwardstep_core::Gain;
use forwardstep_core::robot::PointMass;
use forwardstep_sim::push::{Effect, Push};
use forwardstep_sim::recording::SampleTaken;
use forwardstep_sim::{
    Adaptive, Control, Exchange, Inside, Known, Observers, Outcome, Place, Sensors, Setup, Signal, VelocitySensor,
    Watch, recorded_columns, simulate_with,
};

use super::{agent, arm, constant, pulse, ring, rough_handling, run};
use crate::common::column;

/// Two planar arms that adapt, one of which moves faster, under exact samples.
fn arms(sample_hz: f64) -> Setup {
    let law = |gamma: f64| {
        let (damping, adaptation) = (Gain::Number(8.0), Gain::Number(gamma));
        Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.2; 5], bounds: None })
    };
    let mut setup = ring(vec![arm(0, &[1.5], law(10.0)), arm(1, &[1.2, 2.0], law(3.0))], Exchange::Position, 4.0);
    setup.agents.iter_mut().for_each(|agent| agent.start.reference = vec![vec![0.4, -0.3]]);
    setup.time.record_every_s = 0.5;
    setup.sampled(sample_hz)
}

/// Two point masses with this many axes, whose masses are known.
fn masses(axes: usize, sample_hz: f64) -> Setup {
    let mass = |index: usize| {
        let known = Arc::new(Known { damping: Gain::Number(5.0) });
        let kind = Arc::new(PointMass { dimension: axes });
        let mut agent = agent(index, &[1.0, 1.7], kind, vec![1.0 + index as f64], known);
        agent.robot.axes = (0..axes).map(|k| crate::common::axis(["x", "y", "z"][k])).collect();
        agent.start.q = vec![0.5 - index as f64; axes];
        agent.start.dq = vec![0.2; axes];
        agent.start.reference = vec![vec![-0.1; axes]];
        agent
    };
    let mut setup = ring(vec![mass(0), mass(1)], Exchange::PositionVelocity, 4.0);
    setup.time.record_every_s = 0.5;
    setup.sampled(sample_hz)
}

fn with(mut setup: Setup, change: impl FnOnce(&mut Control)) -> Setup {
    if let Some(control) = &mut setup.control {
        change(control);
    }
    setup
}

fn watched(setup: &Setup) -> (Outcome, Vec<InjectionBalance>) {
    let mut watch = InjectionWatch::of(setup).unwrap();
    let outcome = simulate_with(
        setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { inside: Some(&mut watch), ..Observers::default() },
    )
    .unwrap();
    course_adds_up(&watch);
    (outcome, watch.balances())
}

/// At every time what was put in until then is the change of V, and the end is that of the balances.
pub(super) fn course_adds_up(watch: &InjectionWatch<'_>) {
    let (course, balances) = (watch.course(), watch.balances());
    let largest: f64 = balances.iter().map(|balance| balance.largest_j).sum::<f64>().max(1e-4);
    assert!(course.t_s.len() > 5 && course.t_s.len() < 130, "{}", course.t_s.len());
    assert!(course.t_s[0] == 0.0 && course.t_s.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", course.t_s);
    for (k, v) in course.v_j.iter().enumerate() {
        let put_in: f64 = course.terms_j.iter().map(|term| term[k]).sum();
        assert!((v - course.v_j[0] - put_in).abs() < 1e-9 * largest, "{}: {v} {put_in}", course.t_s[k]);
    }
    let all = |part: fn(&InjectionBalance) -> f64| balances.iter().map(part).sum::<f64>();
    assert_eq!([course.v_j.first(), course.v_j.last()], [Some(&all(|own| own.start_j)), Some(&all(|own| own.end_j))]);
    for (k, term) in course.terms_j.iter().enumerate() {
        let sum: f64 = balances.iter().map(|own| own.terms_j[k]).sum();
        assert_eq!((term.len(), term.first(), term.last()), (course.t_s.len(), Some(&0.0), Some(&sum)));
    }
}

/// Runs a setup and requires that for every agent the terms add up and that just these causes, besides damping and holding, act.
fn only(setup: &Setup, causes: &[Injection]) -> Vec<InjectionBalance> {
    let (outcome, balances) = watched(setup);
    assert_eq!(balances.len(), setup.agents.len());
    for balance in &balances {
        let v = column(&outcome, balance.agent, Signal::Lyapunov, 0);
        let ends = [v[0], *v.last().unwrap()];
        assert_eq!([balance.start_j, balance.end_j], ends);
        assert!(balance.residual_j().abs() < 1e-9 * balance.largest_j, "{balance:?}, {}", balance.residual_j());
        assert!(balance.term_j(Injection::Dissipated) < 0.0);
        for injection in Injection::ALL {
            let acts = matches!(injection, Injection::Dissipated | Injection::Held) || causes.contains(&injection);
            let size = balance.term_j(injection).abs() / balance.largest_j;
            assert!(if acts { size > 1e-6 } else { size == 0.0 }, "{} {size}: {balance:?}", injection.name());
        }
    }
    balances
}

/// V of every agent at the end of every step, beside the watch that is looked at.
struct Ends<'a> {
    watch: InjectionWatch<'a>,
    lyapunov: usize,
    steps: Vec<(f64, f64)>,
}

impl Watch for Ends<'_> {
    fn sampled(&mut self, taken: SampleTaken<'_>) {
        self.watch.sampled(taken);
    }

    fn inside(&mut self, at: Inside<'_>) {
        let ends = (at.place == Place::End).then(|| (at.agent, at.t_s, at.values[self.lyapunov]));
        self.watch.inside(at);
        match ends {
            Some((0, t_s, v)) => self.steps.push((t_s, v)),
            Some((_, _, v)) => self.steps.last_mut().unwrap().1 += v,
            None => {}
        }
    }
}

/// A point of a course has V of all agents at the end of one step.
#[test]
fn the_course_of_what_is_put_in_has_all_agents_at_one_time() {
    let setup = arms(100.0);
    let columns = recorded_columns(&setup).unwrap();
    let mut own = columns.iter().filter(|column| column.agent == 0);
    let lyapunov = own.position(|column| column.signal == Signal::Lyapunov).unwrap();
    let mut ends = Ends { watch: InjectionWatch::of(&setup).unwrap(), lyapunov, steps: Vec::new() };
    simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { inside: Some(&mut ends), ..Observers::default() },
    )
    .unwrap();
    let course = ends.watch.course();
    assert!(course.t_s.len() > 100 && ends.steps.len() > 2 * course.t_s.len());
    for (t_s, v) in course.t_s.iter().zip(&course.v_j).skip(1) {
        assert!(ends.steps.contains(&(*t_s, *v)), "{t_s}: {v}");
    }
}

const ADAPTS: &[Injection] = &[Injection::Adaptation];

#[test]
fn prop_what_is_put_into_v_adds_up_and_every_cause_counts_where_it_acts() {
    use Injection::{Adaptation, Limited, Measured, Pushed, Reconstructed};
    for sample_hz in [100.0, 500.0] {
        let arms = || arms(sample_hz);
        only(&arms(), ADAPTS);
        only(&with(arms(), |control| control.computation_delay_s = 0.3 / sample_hz), ADAPTS);
        only(&with(arms(), |control| control.computation_delay_s = 1.0 / sample_hz), ADAPTS);
        let noisy = |control: &mut Control| {
            control.sensors = Sensors { position_noise: 1e-3, velocity_noise: 1e-2, seed: 4, ..control.sensors };
        };
        only(&with(arms(), noisy), &[Adaptation, Measured]);
        only(&with(arms(), |control| control.sensors.velocity_quantum = 0.01), &[Adaptation, Measured]);
        let filtered = |control: &mut Control| control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 30.0 };
        only(&with(arms(), filtered), &[Adaptation, Reconstructed]);
        let both = |control: &mut Control| {
            filtered(control);
            control.sensors.position_quantum = 1e-3;
        };
        only(&with(arms(), both), &[Adaptation, Reconstructed, Measured]);
        only(&with(arms(), |control| control.actuators.torque_limit = Some(vec![10.0, 2.0])), &[Adaptation, Limited]);
        only(&with(arms(), |control| control.actuators.torque_quantum = 0.5), &[Adaptation, Limited]);
        let mut pushed = arms();
        pushed.time.end_s = 8.0;
        pushed.agents.iter_mut().for_each(|agent| agent.pushes = rough_handling());
        only(&pushed, &[Adaptation, Pushed]);
        for axes in 1..=3 {
            only(&masses(axes, sample_hz), &[]);
            only(&with(masses(axes, sample_hz), noisy), &[Measured]);
            let limited = |control: &mut Control| control.actuators.torque_limit = Some(vec![0.5; axes]);
            only(&with(masses(axes, sample_hz), limited), &[Limited]);
        }
        let late_and_worse = |control: &mut Control| {
            both(control);
            control.sensors.position_noise = 1e-3;
            control.computation_delay_s = 0.5 / sample_hz;
            control.actuators.torque_limit = Some(vec![10.0, 2.0]);
        };
        only(&with(pushed, late_and_worse), &[Adaptation, Reconstructed, Measured, Limited, Pushed]);
    }
}

#[test]
fn prop_with_the_period_holding_and_stepping_vanish_and_the_dissipation_becomes_that_of_the_proof() {
    let mut continuous = arms(1000.0);
    continuous.control = None;
    assert!(InjectionWatch::of(&continuous).is_none());
    let continuous = run(&continuous);
    let [coarse, fine] = [500.0, 1000.0].map(|sample_hz| watched(&arms(sample_hz)).1);
    for (coarse, fine) in coarse.iter().zip(&fine) {
        let dissipated = *column(&continuous, fine.agent, Signal::Dissipation, 0).last().unwrap();
        for injection in [Injection::Held, Injection::Adaptation] {
            let ratio = coarse.term_j(injection) / fine.term_j(injection);
            assert!((1.9..2.1).contains(&ratio), "{}: {ratio}", injection.name());
        }
        let gaps = [coarse, fine].map(|balance| (balance.term_j(Injection::Dissipated) + dissipated).abs());
        assert!(gaps[1] < gaps[0] && gaps[1] < 5e-4 * dissipated, "{gaps:?} of {dissipated}");
    }
}

#[test]
fn the_first_that_the_proof_does_not_allow_is_named_with_its_time() {
    let first = |setup: &Setup| watched(setup).1[0].first;
    // Well sampled, and pushed for a while: all of it is allowed.
    let mut setup = masses(2, 1000.0);
    assert_eq!(first(&setup), None);
    setup.agents[0].pushes = vec![pulse(Effect::Torque(constant(&[6.0, 3.0])))];
    assert_eq!(first(&setup), None);
    // For ever: not.
    let for_ever = Push { effect: Effect::Torque(constant(&[6.0, 3.0])), from_s: 2.0, until_s: f64::INFINITY };
    setup.agents[0].pushes = vec![for_ever];
    let (injection, t_s) = first(&setup).unwrap();
    assert_eq!(injection, Injection::Pushed);
    assert!((2.0..2.1).contains(&t_s), "{t_s}");
    // A cause that acts from the start comes before.
    let noisy = with(setup.clone(), |control| control.sensors.velocity_quantum = 0.5);
    let (injection, t_s) = first(&noisy).unwrap();
    assert_eq!(injection, Injection::Measured);
    assert!(t_s < 1.0, "{t_s}");
    let limited = with(masses(2, 1000.0), |control| control.actuators.torque_limit = Some(vec![0.05; 2]));
    assert_eq!(first(&limited).unwrap().0, Injection::Limited);
    // Too slow for its damping, so that holding itself feeds V.
    let (injection, t_s) = first(&with(masses(2, 1000.0), |control| control.sample_hz = 2.2)).unwrap();
    assert_eq!(injection, Injection::Held);
    assert!(t_s < 4.0, "{t_s}");
}

#[test]
fn regress_a_run_that_is_watched_has_the_same_bits() {
    let setup = with(arms(200.0), |control| control.computation_delay_s = 0.002);
    let (outcome, alone) = (watched(&setup).0, run(&setup));
    assert_eq!(outcome.recording, alone.recording);
    assert_eq!(outcome.statistics, alone.statistics);
}
