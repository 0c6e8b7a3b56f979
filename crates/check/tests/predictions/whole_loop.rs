//! The sampled loop with its reference and its network, against recursions written down here and against runs.

use std::sync::Arc;

use forwardstep_check::{Finding, PracticalAnswer, WholeLoop, practical};
use forwardstep_core::Gain;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{Adaptive, Exchange, Known, Setup, VelocitySensor, simulate};
use nalgebra::SMatrix;
use std::ops::ControlFlow;

use crate::common::kinds::{formula, tracking};
use crate::common::{arm, edge, masses};
use forwardstep_core::expression::Expression;

/// Two masses of 2 kg that hear each other, with these roots, K/m = `rate`.
fn two(roots: [f64; 2], rate: f64, hz: f64) -> Setup {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)];
    let mut setup = masses(
        Exchange::PositionVelocity,
        2,
        Schedule::fixed(edges),
        vec![forwardstep_sim::delay::Delay::constant(0.0)],
    );
    setup.agents.truncate(2);
    setup.network.agents = 2;
    for (k, agent) in setup.agents.iter_mut().enumerate() {
        agent.roots_per_s = roots.to_vec().into();
        agent.robot.theta = vec![2.0];
        agent.law = Arc::new(Known { damping: Gain::Number(2.0 * rate) });
        agent.start.q = vec![k as f64, -(k as f64)];
        agent.start.dq = vec![0.0; 2];
    }
    setup.time.end_s = 40.0;
    setup.sampled(hz)
}

fn found(setup: &Setup) -> WholeLoop {
    let whole = |finding| if let Finding::WholeLoop(found) = finding { Some(found) } else { None };
    practical(setup).findings.into_iter().find_map(whole).expect("agents under (6)–(7) that sample")
}

/// The largest difference of both at the end of a run, as a part of that at its start; infinite where it breaks down.
fn left(setup: &Setup) -> f64 {
    let Ok(outcome) = simulate(setup, &mut |_| ControlFlow::Continue(())) else { return f64::INFINITY };
    let last = |agent: usize| {
        let column =
            outcome.recording.columns.iter().find(|c| (c.agent, c.signal, c.axis) == (agent, Signal::Position, 0));
        *column.expect("positions are recorded").values.last().expect("rows")
    };
    let difference = (last(0) - last(1)).abs();
    if difference.is_finite() { difference } else { f64::INFINITY }
}

/// The largest multiplier of the difference of both over one period: z goes exactly with what was measured at its beginning.
fn multiplier([a, b]: [f64; 2], rate: f64, h: f64) -> f64 {
    let (sum, product, both) = (a + b, a * b, a + b + 1.0);
    let step = |x: [f64; 4]| {
        let [q, v, z, d] = x;
        // With w = 1 and what the other tells, of the opposite sign.
        let input = -product * v - (sum * v + product * q + b * v + product * q);
        let held = d - rate * (v - z);
        let e = (-both * h).exp();
        let next = e * d + (1.0 - e) / both * input;
        let moved = z + (1.0 - e) / both * d + (h - (1.0 - e) / both) / both * input;
        [q + h * v + 0.5 * h * h * held, v + h * held, moved, next]
    };
    let columns = [0, 1, 2, 3].map(|k| step(core::array::from_fn(|i| f64::from(u8::from(i == k)))));
    let matrix = SMatrix::<f64, 4, 4>::from_fn(|i, j| columns[j][i]);
    matrix.complex_eigenvalues().iter().map(|root| root.norm()).fold(0.0, f64::max)
}

#[test]
fn eq_the_rate_of_two_masses_is_that_of_their_recursion() {
    for (roots, rate, hz) in
        [([5.0, 10.0], 1.0, 5.0), ([5.0, 10.0], 1.0, 7.0), ([1.0, 2.0], 0.5, 1.2), ([3.0, 4.0], 6.0, 9.0)]
    {
        let [network, _] = found(&two(roots, rate, hz)).network_rate_per_s.expect("a fixed graph of equal masses");
        // Both agree for ever: the sum of their positions has the multiplier one.
        let expected = multiplier(roots, rate, 1.0 / hz).max(1.0).ln() * hz;
        assert!((network - expected).abs() < 1e-4, "{roots:?} at {hz} Hz: {network} for {expected}");
    }
}

#[test]
fn prop_what_grows_by_the_verdict_grows_in_a_run_and_nothing_else() {
    let (mut grew, mut fell) = (0, 0);
    for roots in [[5.0, 10.0], [8.0, 12.0], [2.0, 3.0]] {
        for hz in [2.0, 4.0, 5.0, 6.0, 8.0, 11.0, 15.0, 30.0] {
            let setup = two(roots, 1.5, hz);
            let verdict = found(&setup);
            let left = left(&setup);
            match verdict.answer() {
                PracticalAnswer::Inadequate => assert!(left > 1.0, "{roots:?} at {hz} Hz: {left}"),
                answer => assert!(answer == PracticalAnswer::Adequate && left < 0.05, "{roots:?} at {hz} Hz: {left}"),
            }
            *(if left > 1.0 { &mut grew } else { &mut fell }) += 1;
        }
    }
    assert!(grew > 5 && fell > 5, "{grew} {fell}");
}

#[test]
fn a_filter_is_too_slow_where_the_run_says_so() {
    for (cut_off_hz, slow) in [(0.2, true), (0.4, false), (3.0, false)] {
        let mut setup = two([1.0, 2.0], 8.0, 100.0);
        setup.control.as_mut().unwrap().sensors.velocity = VelocitySensor::Filtered { cut_off_hz };
        let left = left(&setup);
        assert_eq!(left > 1.0, slow, "{cut_off_hz} Hz: {left}");
        assert_eq!(found(&setup).answer() == PracticalAnswer::Inadequate, slow, "{cut_off_hz} Hz: {:?}", found(&setup));
    }
}

#[test]
fn what_is_late_counts_and_bounds_on_what_grows_are_not_given() {
    let mut setup = two([1.0, 2.0], 0.5, 10.0 / 3.0);
    let names = |setup: &Setup| practical(setup).findings.iter().map(Finding::name).collect::<Vec<_>>();
    assert!(found(&setup).answer() < PracticalAnswer::Inadequate && names(&setup).contains(&"tracking-disagreement"));
    setup.control.as_mut().unwrap().computation_delay_s = 0.28;
    assert_eq!(found(&setup).answer(), PracticalAnswer::Inadequate);
    assert!(left(&setup) > 1.0);
    assert!(!names(&setup).iter().any(|name| name.starts_with("tracking-")), "{:?}", names(&setup));
}

#[test]
fn the_adaptation_of_who_follows_a_target_is_in_it() {
    let follower = |adaptation: f64| {
        let mut agent = arm(0, &[2.0, 3.0]);
        agent.robot.kind = Arc::new(forwardstep_core::robot::PointMass { dimension: 1 });
        agent.robot.axes.truncate(1);
        (agent.robot.theta, agent.robot.theta_names) = (vec![2.0], vec!["mass".into()]);
        agent.law = Arc::new(Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(adaptation),
            estimate_start: vec![0.0],
            bounds: None,
        });
        (agent.start.q, agent.start.dq) = (vec![0.0], vec![0.0]);
        let swings = formula((Expression::variable(0) * 3.0).sin_of());
        let mut setup = tracking(agent, vec![swings]);
        setup.time.end_s = 20.0;
        setup.sampled(20.0)
    };
    assert_eq!(found(&follower(10.0)).answer(), PracticalAnswer::Inadequate);
    assert_eq!(found(&follower(0.2)).answer(), PracticalAnswer::Adequate);
}

/// A motion that is held, and velocities that lag, cost no more than is said.
#[test]
fn the_mean_power_of_robots_that_move_between_samples_is_not_above_its_bound() {
    for (hz, cut_off_hz) in [(5.0, None), (20.0, None), (100.0, Some(1.0)), (100.0, Some(4.0)), (10.0, Some(3.0))] {
        let mut setup = two([1.0, 2.0], 2.5, hz);
        if let Some(cut_off_hz) = cut_off_hz {
            setup.control.as_mut().unwrap().sensors.velocity = VelocitySensor::Filtered { cut_off_hz };
        }
        setup.time.record_every_s = 0.005;
        let bound = practical(&setup).findings.into_iter().find_map(|finding| match finding {
            Finding::TrackingPower(bound) => Some(bound),
            _ => None,
        });
        let bound = bound.expect("a motion feeds it");
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).expect("it runs");
        let errors = outcome.recording.columns.iter().filter(|column| column.signal == Signal::TrackingError);
        let rows = outcome.recording.t_s.len() as f64;
        // K = 5.
        let mean: f64 = errors.map(|column| column.values.iter().map(|s| 5.0 * s * s / rows).sum::<f64>()).sum();
        assert!(mean < bound.mean_w && mean > 0.02 * bound.mean_w, "{hz} Hz, {cut_off_hz:?}: {mean} of {bound:?}");
    }
}
