//! The sampled loop with its reference and its network, against recursions written down here and against runs.

use std::sync::Arc;

use forwardstep_check::{Finding, PracticalAnswer, WholeLoop, practical};
use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::PlanarLinks;
use forwardstep_sim::drives::{JointDrives, JointFriction};
use forwardstep_sim::recording::{Ending, Signal};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{Adaptive, Exchange, Known, Setup, TimeSpan, VelocitySensor, simulate};
use nalgebra::SMatrix;
use std::ops::ControlFlow;

use crate::common::kinds::{chain, formula, rest_at, tracking};
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

/// The difference of both at the end of a run, infinite where it breaks down.
fn left(setup: &Setup) -> f64 {
    largest(setup, |[a, b]| (a - b).abs())
}

/// The largest of this over the last two seconds.
fn largest(setup: &Setup, of: impl Fn([f64; 2]) -> f64) -> f64 {
    let Ok(outcome) = simulate(setup, &mut |_| ControlFlow::Continue(())) else { return f64::INFINITY };
    if outcome.ending != Ending::Completed {
        return f64::INFINITY;
    }
    let column = |agent: usize| {
        let is_it = |c: &&forwardstep_sim::Column| (c.agent, c.signal, c.axis) == (agent, Signal::Position, 0);
        &outcome.recording.columns.iter().find(is_it).expect("positions are recorded").values
    };
    let rows = outcome.recording.t_s.iter().zip(column(0).iter().zip(column(1).iter()));
    let late = rows.filter(|(t_s, _)| **t_s >= setup.time.end_s - 2.0);
    let largest = late.map(|(_, (a, b))| of([*a, *b])).fold(0.0, f64::max);
    if largest.is_finite() { largest } else { f64::INFINITY }
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
        let network = found(&two(roots, rate, hz)).start.network.expect("a fixed graph of equal masses");
        // Both agree for ever: the sum of their positions has the multiplier one.
        let expected = multiplier(roots, rate, 1.0 / hz).max(1.0).ln() * hz;
        assert!((network.per_s - expected).abs() < 1e-4, "{roots:?} at {hz} Hz: {network:?} for {expected}");
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
                answer => assert!(answer == PracticalAnswer::Adequate && left < 0.1, "{roots:?} at {hz} Hz: {left}"),
            }
            *(if left > 1.0 { &mut grew } else { &mut fell }) += 1;
        }
    }
    assert!(grew > 5 && fell > 5, "{grew} {fell}");
}

/// Links that are late by whole periods, agents that differ, and a mode that needs the whole run to be seen.
#[test]
fn prop_late_links_and_slow_modes_of_unequal_agents_are_told_as_runs_tell_them() {
    let mut answers = Vec::new();
    for (roots, hz, delay_s) in [
        ([5.0, 10.0], 8.0, 0.0),
        ([5.0, 10.0], 8.0, 0.11),
        ([5.0, 10.0], 8.0, 0.4),
        ([2.0, 3.0], 3.0, 0.0),
        ([2.0, 3.0], 3.0, 0.5),
        ([2.0, 3.0], 4.0, 0.5),
        ([1.0, 2.0], 1.75, 0.0),
        ([1.0, 2.0], 2.0, 0.6),
    ] {
        let mut setup = two(roots, 1.5, hz);
        // The other one is slower to follow.
        setup.agents[1].law = Arc::new(Known { damping: Gain::Number(2.0) });
        setup.network.delays = vec![forwardstep_sim::delay::Delay::constant(delay_s)];
        // What all agree on may grow too.
        setup.agents[1].start.q = vec![0.3, 0.2];
        let verdict = found(&setup);
        let network = verdict.last().network.expect("fixed").per_s;
        let both = |setup: &Setup| largest(setup, |q| q[0].abs().max(q[1].abs()));
        let (short, long) =
            (both(&setup), both(&Setup { time: TimeSpan { end_s: 80.0, ..setup.time.clone() }, ..setup.clone() }));
        // Another forty seconds say how fast it is.
        let seen = (long / short).ln() / 40.0;
        let grows = verdict.answer() == PracticalAnswer::Inadequate;
        assert_eq!(grows, seen > 0.025, "{roots:?} at {hz} Hz, {delay_s} s late: {network}, seen {seen}");
        if grows {
            assert!(
                (network - seen).abs() < 0.03 * seen + 0.01,
                "{roots:?} at {hz} Hz, {delay_s} s: {network}, seen {seen}"
            );
        }
        answers.push(grows);
    }
    assert!(answers.iter().filter(|grows| **grows).count() >= 2 && answers.contains(&false), "{answers:?}");
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
    // Who moves from the start does so before a filter knows of it.
    for (hz, cut_off_hz, dq) in [
        (5.0, None, 0.0),
        (20.0, None, 0.0),
        (100.0, Some(1.0), 0.0),
        (100.0, Some(4.0), 0.0),
        (10.0, Some(3.0), 0.0),
        (10.0, Some(3.0), 1.0),
        (100.0, Some(3.0), 1.0),
        (100.0, Some(3.0), -4.0),
    ] {
        let mut setup = two([1.0, 2.0], 2.5, hz);
        setup.agents.iter_mut().for_each(|agent| agent.start.dq.fill(dq));
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

/// Two planar arms whose loop is bad where they start, or where they meet, or with estimates that are wrong.
#[test]
fn what_lasts_is_where_references_lead_and_estimates_may_be_wrong() {
    let arms = |start: [f64; 2], adapts: bool| {
        let mut setup = two([2.0, 2.6], 1.0, 5.0);
        for (k, agent) in setup.agents.iter_mut().enumerate() {
            *agent = arm(k, &[2.0, 2.6]);
            agent.start.q = vec![0.2 * k as f64, start[k]];
            agent.start.dq = vec![0.0; 2];
            let estimate_start = agent.robot.theta.clone();
            let upper = estimate_start.iter().map(|theta| 1.6 * theta).collect();
            let bounds = adapts.then(|| ParameterBounds::new(estimate_start.clone(), upper, 1e-3));
            let damping = Gain::Bandwidth(1.0);
            agent.law = if adapts {
                Arc::new(Adaptive { damping, adaptation: Gain::Bandwidth(0.1), estimate_start, bounds })
            } else {
                Arc::new(Known { damping })
            };
        }
        found(&setup)
    };
    let right = arms([0.5, 0.4], false);
    let astray = arms([0.5, 0.4], true);
    assert_eq!((right.answer(), &right.astray), (PracticalAnswer::Adequate, &None));
    assert_eq!(astray.lasting_per_s(), None);
    assert!(astray.astray_per_s() > Some(0.05) && astray.answer() == PracticalAnswer::Marginal, "{astray:?}");
}

/// Two double integrators that hear each other at weight 5: each is stable by itself, and both are not.
#[test]
fn regress_agents_under_other_laws_have_their_network() {
    let psi = Expression::number(1.0);
    let looped = |weight: f64, hz: f64| {
        let mut setup = tracking(chain(&psi, 0, false), vec![rest_at(0.0)]);
        let edges = vec![edge(0, 1, weight, 0), edge(1, 0, weight, 0)];
        let delays = vec![forwardstep_sim::delay::Delay::constant(0.0)];
        let consensus = masses(Exchange::Position, 2, Schedule::fixed(edges), delays);
        setup.reference = consensus.reference;
        setup.network = forwardstep_sim::Network { agents: 2, ..consensus.network };
        setup.agents[0].target = None;
        let mut other = setup.agents[0].clone();
        (other.name, other.start.q) = ("other".into(), vec![1.0]);
        setup.agents.push(other);
        setup.time.end_s = 60.0;
        setup.sampled(hz)
    };
    let mut seen = [0, 0];
    for (weight, hz) in [(5.0, 2.0), (1.0, 2.0), (5.0, 20.0), (8.0, 4.0), (30.0, 6.0)] {
        let setup = looped(weight, hz);
        let grows = WholeLoop::of(&setup).unwrap().answer() == PracticalAnswer::Inadequate;
        let left = left(&setup);
        assert_eq!(grows, left > 1.0, "{weight}, {hz} Hz: {left}");
        seen[usize::from(grows)] += 1;
    }
    assert!(seen[0] >= 1 && seen[1] >= 1, "{seen:?}");
}

/// Joints that are damped so much that a sample holds many of their time constants.
#[test]
fn regress_plants_that_are_fast_by_themselves_are_linearised_too() {
    for damping in [0.0, 30.0, 300.0] {
        let mut setup = two([1.0, 2.0], 1.0, 10.0);
        for (k, agent) in setup.agents.iter_mut().enumerate() {
            *agent = arm(k, &[1.0, 2.0]);
            let drives = JointDrives { damping: (damping > 0.0).then(|| vec![damping; 2]), ..JointDrives::default() };
            agent.robot = agent.robot.clone().with_drives(&drives).expect("an arm has joints");
            agent.start.q = vec![0.3 * k as f64, 0.2];
            agent.start.dq = vec![0.0; 2];
            agent.law = Arc::new(Known { damping: Gain::Number(0.3) });
        }
        let verdict = WholeLoop::of(&setup).expect("it has numbers");
        assert!(verdict.answer() < PracticalAnswer::Inadequate && left(&setup) < 0.1, "{damping}: {verdict:?}");
    }
}

/// By itself it has no numbers any more after some periods: what is left to look at is not all that there is.
#[test]
fn regress_an_agent_that_runs_away_by_itself_is_not_left_out() {
    let at = |hz: f64| {
        let psi = Expression::number(1.5);
        let mut setup = tracking(chain(&psi, 1, true), vec![rest_at(0.2)]);
        setup.time.end_s = 2000.0;
        setup.sampled(hz)
    };
    let [fast, slow] = [at(20.0), at(0.3)].map(|setup| WholeLoop::of(&setup).expect("it has numbers at its start"));
    assert_eq!((fast.trial.lost_s, fast.answer()), (None, PracticalAnswer::Adequate), "{fast:?}");
    assert!(slow.trial.lost_s.is_some() && slow.answer() == PracticalAnswer::Inadequate, "{slow:?}");
}

/// A target that comes to swing: the start says nothing of it, whatever the order of the reference is.
#[test]
fn regress_targets_are_looked_at_along_their_way_whatever_the_number_of_roots_is() {
    let t = || Expression::variable(0);
    let swings = || formula((Expression::number(1.0) - (t() * -0.05).exp_of()) * (t() * 3.0).sin_of());
    for roots in [vec![1.0], vec![1.0, 2.0], vec![1.0, 2.0, 3.0]] {
        let mut agent = arm(0, &roots);
        agent.robot.kind = Arc::new(forwardstep_core::robot::PointMass { dimension: 1 });
        agent.robot.axes.truncate(1);
        (agent.robot.theta, agent.robot.theta_names) = (vec![1.5], vec!["mass".into()]);
        let (damping, adaptation) = (Gain::Number(10.0), Gain::Number(20.0));
        agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.0], bounds: None });
        (agent.start.q, agent.start.dq) = (vec![0.0], vec![0.0]);
        let mut setup = tracking(agent, vec![swings()]);
        setup.time.end_s = 100.0;
        // Linear maps alone, without a trial.
        let [slow, fast] = [20.0, 2000.0].map(|hz| WholeLoop::of(&setup.clone().sampled(hz)).expect("it has numbers"));
        assert_eq!((&slow.last, slow.start_per_s()), (&None, None), "{roots:?}: {slow:?}");
        // There is too much of it at 2 kHz to be followed from end to end.
        let is_gapless = fast.along.as_ref().map(|along| along.is_gapless);
        assert!(slow.along.is_some() && is_gapless == Some(false), "{roots:?}: {slow:?} {fast:?}");
        assert_eq!(slow.answer(), PracticalAnswer::Inadequate, "{roots:?}: {slow:?}");
        assert!(fast.answer() < PracticalAnswer::Inadequate, "{roots:?}: {fast:?}");
    }
}

/// Friction holds back what is small, and is no slope of what grows.
#[test]
fn regress_the_loop_of_joints_that_rub_is_that_without_friction() {
    let looped = |friction: Option<JointFriction>| {
        let mut setup = two([5.0, 10.0], 1.5, 4.0);
        for agent in &mut setup.agents {
            let drives = JointDrives { friction: friction.clone(), ..JointDrives::default() };
            agent.robot = agent.robot.clone().with_drives(&drives).expect("a mass has axes");
        }
        let found = WholeLoop::of(&setup).expect("it has numbers");
        (found.agents, found.lasting_per_s().expect("a mode grows"))
    };
    let smooth = looped(None);
    for (coulomb, dry_s) in [(0.01, None), (5.0, None), (5.0, Some(1e-3))] {
        let (agents, rate) = looped(Some(JointFriction { coulomb: vec![coulomb; 2], width: vec![0.01; 2], dry_s }));
        assert_eq!(agents, smooth.0);
        assert!((rate - smooth.1).abs() < 1e-3 * smooth.1, "{coulomb}: {rate} and {smooth:?}");
    }
}

/// At every instant the loop decays by itself; while the arm swings it does not.
#[test]
fn regress_a_loop_along_a_motion_grows_where_its_run_does() {
    let t = || Expression::variable(0);
    let arm = |hz: f64, end_s: f64| {
        let mut agent = arm(0, &[1.0, 2.0]);
        agent.robot.theta = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta().to_vec();
        agent.law = Arc::new(Known { damping: Gain::Number(8.0) });
        (agent.start.q, agent.start.dq) = (vec![0.0, 1.0], vec![0.0; 2]);
        let second = Expression::number(1.0) + (t() * 1.7).sin_of();
        let mut setup = tracking(agent, vec![formula(t().sin_of() * 1.5), formula(second)]);
        (setup.time.end_s, setup.time.record_every_s) = (end_s, 0.1);
        setup.sampled(hz)
    };
    // How large s is at most behind the beginning.
    let astray = |setup: &Setup| {
        let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).expect("it runs");
        let errors = outcome.recording.columns.iter().filter(|column| column.signal == Signal::TrackingError);
        errors.flat_map(|column| &column.values[column.values.len() / 2..]).fold(0.0_f64, |most, s| most.max(s.abs()))
    };
    for (hz, grows) in [(20.0, true), (23.0, true), (26.0, true), (30.0, true), (40.0, false), (50.0, false)] {
        let setup = arm(hz, 90.0);
        // A trial of it does not run away, as far as it bursts.
        let found = found(&setup);
        let along = found.along.as_ref().expect("it is led");
        assert!(along.is_gapless, "{along:?}");
        assert_eq!(found.answer() == PracticalAnswer::Inadequate, grows, "{hz} Hz: {found:?}");
        assert_eq!(astray(&setup) > 0.3, grows, "{hz} Hz: {}", astray(&setup));
    }
}
