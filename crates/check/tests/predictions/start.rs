//! Runs that do not begin on the course that s ≡ 0 takes, and predictions that are more work than they are worth.

use forwardstep_check::prediction::{COURSE_WORK, NoPeriodRate, Unfinished, course_within, period_rate_within};
use forwardstep_check::{NoCourse, predict};
use forwardstep_core::Gain;
use forwardstep_sim::delay::Delay;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Adaptive, AgentSetup, Exchange, Known, Setup, Signal};
use std::ops::ControlFlow;
use std::sync::Arc;

use super::course::predicted;
use super::{ends, three};
use crate::common::kinds::blind_mass;
use crate::common::{column, edge, run, setup};

/// Masses that hear velocities late, of which one has a z(0) beside its velocity.
fn beside(exchange: Exchange, order: usize) -> Setup {
    let mut setup = three(exchange);
    for agent in &mut setup.agents {
        agent.roots_per_s = [1.0, 1.7].as_slice()[..order].to_vec().into();
    }
    setup.agents[0].start.reference = vec![vec![3.0, -1.0]];
    setup
}

#[test]
fn regress_the_course_ends_at_the_value_that_is_predicted_where_velocities_were_sent_before_the_start() {
    for (exchange, order) in [(Exchange::PositionVelocity, 2), (Exchange::PositionVelocity, 1), (Exchange::Position, 2)]
    {
        let setup = beside(exchange, order);
        let (value, course) = (predict(&setup).unwrap().value, predicted(&setup));
        let within = course.within.clone().unwrap();
        for axis in 0..2 {
            let reached = ends(&setup, 0, axis);
            assert!((value[axis] - reached).abs() < 1e-5, "{exchange:?} {order}: {value:?}, not {reached}");
            let [low, high] = within[axis];
            assert!(
                low <= value[axis] + 1e-6 && high >= value[axis] - 1e-6 && high - low < 1e-3,
                "{value:?} {within:?}"
            );
        }
        assert!((course.start.s - 3.0).abs() < 0.4 && course.start.energy_j.unwrap() > 0.0, "{:?}", course.start);
    }
}

#[test]
fn regress_a_run_that_begins_beside_its_reference_begins_with_its_own_torque() {
    for (exchange, order) in [(Exchange::PositionVelocity, 1), (Exchange::Position, 1), (Exchange::Position, 2)] {
        let setup = beside(exchange, order);
        let outcome = run(&setup);
        for peak in predicted(&setup).peak_torques {
            let torque = column(&outcome, peak.agent, Signal::Torque, peak.axis);
            assert!(peak.value.abs() >= torque[0].abs() - 1e-6, "{peak:?}, not {}", torque[0]);
            assert!(peak.t_s > 0.0 || (peak.value - torque[0]).abs() < 1e-9, "{peak:?}, not {}", torque[0]);
            assert_eq!(peak.at_most, None, "nothing keeps it near this course");
        }
    }
}

#[test]
fn a_prediction_ends_where_its_work_does_and_says_so() {
    let setup = three(Exchange::PositionVelocity);
    let mut go_on = |_| ControlFlow::Continue(());
    assert!(course_within(&setup, COURSE_WORK, &mut go_on).is_ok());
    let Err(NoCourse::Unfinished(reason @ Unfinished::TooMuchWork { t_s, end_s })) =
        course_within(&setup, 1e5, &mut go_on)
    else {
        panic!("it is too much")
    };
    assert!(t_s > 0.0 && t_s < end_s && end_s == 60.0, "{reason:?}");
    assert!(reason.to_string().contains("`check --predict --thorough`"), "{reason}");
    let mut turning = setup;
    let phase = |from, to| Phase { edges: vec![edge(from, to, 1.0, 0)], dwell_s: 0.5 };
    turning.network.schedule = Schedule::periodic(vec![phase(0, 1), phase(1, 2), phase(1, 0)]);
    turning.network.delays = vec![Delay::constant(0.1)];
    assert!(period_rate_within(&turning, COURSE_WORK, &mut go_on).is_ok());
    let reason = period_rate_within(&turning, 1e5, &mut go_on);
    assert!(matches!(reason, Err(NoPeriodRate::Unfinished(Unfinished::TooMuchWork { .. }))), "{reason:?}");
}

/// With one root ż has s in it at once.
#[test]
fn eq_what_v_can_add_to_a_torque_counts_what_s_adds_to_the_acceleration_that_is_asked_for() {
    let mut setup = three(Exchange::Position);
    setup.network.schedule = Schedule::fixed(Vec::new());
    for agent in &mut setup.agents {
        agent.robot.theta = vec![3.0];
        (agent.start.q, agent.start.dq) = (vec![0.0; 2], vec![0.0; 2]);
        agent.roots_per_s = [2.0].into();
    }
    let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(2.0));
    setup.agents[1].law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![2.0], bounds: None });
    // z falls from 0.2 by its root, and ż with it: the most is at the start.
    setup.agents[1].start.dq = vec![0.2, 0.0];
    let peaks = predicted(&setup).peak_torques;
    let found = peaks.iter().find(|peak| (peak.agent, peak.axis) == (1, 0)).unwrap();
    // √(2 V) = Δm/√γ, |s| ≤ √(2 V)/√m, and ż has −κ s in it.
    let size = 1.0 / 2.0_f64.sqrt();
    let through = 3.0 * 2.0 * size / 3.0_f64.sqrt();
    let expected = 3.0 * 0.4 + size * (25.0 / 3.0 + 2.0 * 0.4 * 0.4_f64).sqrt() + through;
    assert!((found.at_most.unwrap() - expected).abs() < 1e-6 * expected, "{found:?} {expected}");
}

#[test]
fn eq_what_v_can_add_to_a_torque_counts_those_alone_who_are_heard_in_the_graph_that_adds_most() {
    let mut setup = three(Exchange::PositionVelocity);
    let phase = |edges| Phase { edges, dwell_s: 0.5 };
    let [much, little] = [vec![edge(0, 1, 1.5, 0), edge(2, 1, 0.5, 0), edge(1, 0, 7.0, 0)], vec![edge(0, 1, 0.75, 0)]];
    setup.network.schedule = Schedule::periodic(vec![phase(much), phase(little)]);
    setup.network.delays = vec![Delay::constant(0.0)];
    for (agent, (theta, off)) in setup.agents.iter_mut().zip([(4.0, 1.0), (3.0, 1.5), (1.0, 0.5)]) {
        agent.robot.theta = vec![theta];
        (agent.start.q, agent.start.dq) = (vec![0.0; 2], vec![0.0; 2]);
        agent.roots_per_s = [2.0].into();
        let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(2.0));
        agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![theta + off], bounds: None });
    }
    // All rest, so that Y ϑ and Y are zero. |s| ≤ Δm/√γ/√m of everybody; ż has −(κ + d) s of its own in it and w s of whom it hears.
    let s = |theta: f64, off: f64| off / 2.0_f64.sqrt() / theta.sqrt();
    let expected = 5.0 * s(3.0, 1.5) + 3.0 * ((2.0 + 2.0) * s(3.0, 1.5) + 1.5 * s(4.0, 1.0) + 0.5 * s(1.0, 0.5));
    for peak in predicted(&setup).peak_torques.iter().filter(|peak| peak.agent == 1) {
        assert!((peak.at_most.unwrap() - expected).abs() < 1e-6 * expected, "{peak:?} {expected}");
    }
    let mut velocities_unheard = Setup { exchange: Exchange::Position, ..setup };
    // λ adds to what ż has of s, whatever its sign.
    for lambda in [0.0, 0.7] {
        velocities_unheard.agents[1].manipulability = lambda;
        let expected = 5.0 * s(3.0, 1.5) + 3.0 * (2.0 + 2.0 + lambda) * s(3.0, 1.5);
        let peaks = predicted(&velocities_unheard).peak_torques;
        let found = peaks.iter().find(|peak| peak.agent == 1).unwrap();
        assert!((found.at_most.unwrap() - expected).abs() < 1e-6 * expected, "{found:?} {expected}");
    }
}

/// Two over a graph that switches once, and comes to stay.
fn settling(agents: Vec<AgentSetup>, exchange: Exchange) -> Setup {
    let phase = |edges, dwell_s| Phase { edges, dwell_s };
    let first = phase(vec![edge(0, 1, 1.0, 0)], 1.7);
    let last = phase(vec![edge(0, 1, 3.0, 0), edge(1, 0, 3.0, 0)], 1.0);
    let mut setup = setup(agents, exchange, Schedule::once(vec![first, last]), vec![Delay::constant(0.0)], 60.0);
    setup.time.record_every_s = 0.1;
    setup
}

#[test]
fn regress_a_value_that_s_can_move_is_said_to_be_that_without_s() {
    // Masses without a velocity, and masses under (6): of both the estimate starts where it is told to.
    let blind = |estimate| {
        let mut agents = [blind_mass(3.0, estimate), blind_mass(3.0, estimate)];
        (agents[0].start.q, agents[1].start.q) = (vec![1.6], vec![-1.4]);
        settling(agents.to_vec(), Exchange::Position)
    };
    let adapted = |estimate| {
        let mut agents = three(Exchange::PositionVelocity).agents[..2].to_vec();
        for agent in &mut agents {
            let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(2.0));
            let estimate_start = vec![estimate * agent.robot.theta[0]];
            agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start, bounds: None });
        }
        settling(agents, Exchange::PositionVelocity)
    };
    for (setup, off, known) in
        [(blind(0.2), 0.9, false), (blind(2.0), 0.0, true), (adapted(0.0), 1.0, false), (adapted(1.0), 0.0, true)]
    {
        let course = predicted(&setup);
        let ([low, high], reached) = (course.within.clone().unwrap()[0], ends(&setup, 0, 0));
        assert_eq!((course.moved_by_s, course.start.estimate_off), (!known, off), "{low} {high} {reached}");
        assert_eq!(low - 1e-4 < reached && reached < high + 1e-4, known, "{reached} and {low} to {high}");
    }
}

#[test]
fn a_value_that_is_conserved_whatever_s_does_needs_no_mark() {
    let mut fixed = three(Exchange::PositionVelocity);
    for agent in &mut fixed.agents {
        let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(2.0));
        agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.0], bounds: None });
    }
    assert!(!predicted(&fixed).moved_by_s && predict(&fixed).is_ok());
    // Remark 4, which `predict` has nothing for either.
    fixed.agents[0].manipulability = 0.5;
    assert!(predicted(&fixed).moved_by_s && predict(&fixed).is_err());
    // With the true parameters s is zero, until somebody pushes.
    for agent in &mut fixed.agents {
        agent.law = Arc::new(Known { damping: Gain::Number(5.0) });
    }
    assert!(!predicted(&fixed).moved_by_s);
    fixed.agents[0].pushes.push(super::pushed_for_ever(1.0));
    assert!(predicted(&fixed).moved_by_s);
}
