//! Networks, delays and sampled control at their edges: what is just allowed, just refused, just in time.

use forwardstep_sim::reference::PureIntegral;
use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::single::{craft, half_a_turn, planar, targets};
use crate::common::{column, columns, masses, run, sampled, silent};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, PiecewiseConstant, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::network::NetworkError;
use forwardstep_sim::quantity::Requirement;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    ClippedSamples, Control, Exchange, Known, Network, Observers, Outcome, Sensors, Setup, SetupError, Signal,
    VelocitySensor, simulate, simulate_with,
};

fn edge(from: usize, to: usize) -> Edge {
    Edge { from, to, weight: Weight::Constant(1.0), delay: 0 }
}

/// Two agents that hear each other over one delay.
fn pair() -> Network {
    Network { schedule: Schedule::fixed(vec![edge(0, 1), edge(1, 0)]), delays: vec![Delay::constant(0.1)], ..silent(2) }
}

#[test]
fn indices_end_where_lists_do() {
    let said = |change: &dyn Fn(&mut Network)| {
        let mut network = pair();
        change(&mut network);
        network.validate(20.0)
    };
    let replaced = |edge: Edge| move |network: &mut Network| network.schedule = Schedule::fixed(vec![edge]);
    assert_eq!(said(&|_| {}), Ok(()));
    for (from, to) in [(0, 2), (2, 0)] {
        let error = NetworkError::NoSuchAgent { graph: 0, from, to, agents: 2 };
        assert_eq!(said(&replaced(edge(from, to))), Err(error));
    }
    let error = NetworkError::NoSuchDelay { graph: 0, delay: 1, delays: 1 };
    assert_eq!(said(&replaced(Edge { delay: 1, ..edge(0, 1) })), Err(error));
    let error = NetworkError::NoSuchWeight { graph: 0, weight: 0, weights: 0 };
    assert_eq!(said(&replaced(Edge { weight: Weight::Formula(0), ..edge(0, 1) })), Err(error));
    for weight in [0.0, -1.0, f64::INFINITY] {
        let result = said(&replaced(Edge { weight: Weight::Constant(weight), ..edge(0, 1) }));
        let Err(NetworkError::Quantity(error)) = result else { panic!("{result:?}") };
        assert_eq!((error.path.to_string(), error.value), ("network.graphs[0][0].weight".into(), weight));
    }
    assert!(matches!(said(&|network| network.agents = 0), Err(NetworkError::NoAgents)));
}

#[test]
fn a_weight_that_touches_zero_is_refused_and_one_above_is_not() {
    let said = |mean: f64| {
        let swing = Expression::variable(0).sin_of() * 0.5 + mean;
        let weights = vec![BoundedFormula::new(swing, 20.0)];
        let varying = Edge { weight: Weight::Formula(0), ..edge(0, 1) };
        Network { schedule: Schedule::fixed(vec![varying]), weights, ..pair() }.validate(20.0)
    };
    let Err(NetworkError::Quantity(error)) = said(0.5) else { panic!("{:?}", said(0.5)) };
    assert_eq!(error.path.to_string(), "network.graphs[0][0].weight");
    assert!(matches!(error.requirement, Requirement::Throughout { within: [low, _], seen_s: None, .. } if low <= 0.0));
    assert_eq!(said(0.51), Ok(()));
}

#[test]
fn only_the_last_phase_of_a_schedule_that_ends_may_last_any_time() {
    let phases = |dwells: [f64; 2]| dwells.map(|dwell_s| Phase { edges: vec![edge(0, 1)], dwell_s }).to_vec();
    let said = |schedule| Network { schedule, ..pair() }.validate(20.0).is_ok();
    assert!(said(Schedule::once(phases([1.0, 0.0]))) && said(Schedule::once(phases([1.0, f64::NAN]))));
    assert!(!said(Schedule::once(phases([0.0, 1.0]))));
    assert!(!said(Schedule::periodic(phases([1.0, 0.0]))) && !said(Schedule::periodic(phases([0.0, 1.0]))));
    let random = |dwell_s| said(Schedule::random(vec![vec![edge(0, 1)]], dwell_s, 1));
    assert!(random([1.0, 1.0]) && !random([1.0, 0.9]) && !random([0.0, 1.0]));
}

#[test]
fn a_run_has_so_many_switches_and_no_more() {
    let said = |schedule| Network { schedule, ..pair() }.validate(20.0).is_ok();
    let graphs = || vec![vec![edge(0, 1)], vec![edge(1, 0)]];
    for (dwell_s, is_said) in [(2.1e-6, true), (1.9e-6, false)] {
        let phases = graphs().into_iter().map(|edges| Phase { edges, dwell_s }).collect();
        assert_eq!(said(Schedule::periodic(phases)), is_said);
        assert_eq!(said(Schedule::random(graphs(), [0.5 * dwell_s, 1.5 * dwell_s], 1)), is_said);
    }
}

#[test]
fn a_formula_has_to_be_known_to_the_end_of_the_run_and_no_further() {
    let slow = Expression::variable(0).sin_of() * 0.1 + 0.2;
    let delays = vec![Delay::new(BoundedFormula::new(slow, 20.0))];
    let network = Network { delays, ..pair() };
    assert_eq!([19.0, 20.0].map(|end_s| network.lasts_until(end_s)), [Ok(()), Ok(())]);
    let error = NetworkError::EndsEarly { index: 0, until_s: 20.0, end_s: 20.1 };
    assert_eq!(network.lasts_until(20.1), Err(error));
    // What no edge refers to may end before.
    let short = || BoundedFormula::new(Expression::variable(0).sin_of() * 0.1 + 0.2, 5.0);
    let (mut delays, weights) = (network.delays.clone(), vec![short()]);
    delays.push(Delay::new(short()));
    let mut unused = Network { delays, weights, ..network };
    assert_eq!(unused.lasts_until(20.0), Ok(()));
    unused.schedule.graphs[0][0].weight = Weight::Formula(0);
    assert_eq!(unused.lasts_until(20.0), Err(NetworkError::EndsEarly { index: 0, until_s: 5.0, end_s: 20.0 }));
}

fn arrivals(delay: &Delay, sent_s: f64) -> Vec<f64> {
    let mut arrivals = Vec::new();
    delay.arrivals(sent_s, 100.0, &mut arrivals);
    arrivals
}

#[test]
fn what_is_sent_arrives_later_or_not_at_all() {
    assert!(arrivals(&Delay::constant(0.0), 1.0).is_empty());
    assert_eq!(arrivals(&Delay::constant(0.5), 1.0), [1.5]);
    // Three arrivals while the delay grows faster than time: t − T(t) = 1 is solved by each, and by no other time.
    let swing = Delay::new(Sinusoid { mean_s: 2.0, amplitude_s: 2.0, period_s: 1.5, phase_rad: 0.3 });
    let found = arrivals(&swing, 1.0);
    let early = |t: f64| t - swing.value(t) - 1.0;
    assert!(found.iter().all(|t| early(*t).abs() < 1e-9), "{found:?}");
    let crossings = (0..100_000).filter(|k| {
        let t = 1.0 + 1e-4 * f64::from(*k);
        early(t) * early(t + 1e-4) < 0.0
    });
    assert_eq!(found.len(), crossings.count(), "{found:?}");
    assert!(found.len() >= 3 && found.is_sorted());
}

#[test]
fn a_sinusoid_may_touch_zero_and_its_amplitude_is_not_negative() {
    let swing = |mean_s, amplitude_s| Delay::new(Sinusoid { mean_s, amplitude_s, period_s: 1.0, phase_rad: 0.2 });
    assert_eq!([swing(0.3, 0.3).min_s(), swing(0.3, 0.3).max_s()], [0.0, 0.6]);
    let said = |delay| Network { delays: vec![delay], ..pair() }.validate(20.0).is_ok();
    assert!(said(swing(0.3, 0.3)) && !said(swing(0.29, 0.3)) && !said(swing(0.3, -0.3)));
}

#[test]
fn pieces_of_a_periodic_delay_follow_one_another_for_ever() {
    let steps = Delay::new(PiecewiseConstant {
        times_s: vec![0.0, 0.4, 0.9],
        values_s: vec![0.6, 0.0, 0.2],
        period_s: Some(1.3),
    });
    let mut piece = steps.first_piece();
    for k in 0..30_u32 {
        let (round, entry) = (f64::from(k / 3), (k % 3) as usize);
        let [from, to] = [[0.0, 0.4], [0.4, 0.9], [0.9, 1.3]][entry].map(|t| round * 1.3 + t);
        assert!((piece.start_s - from).abs() < 1e-12 && (piece.end_s - to).abs() < 1e-12, "{piece:?}");
        let middle = 0.5 * (from + to);
        assert_eq!(steps.value(middle), [0.6, 0.0, 0.2][entry]);
        assert_eq!(steps.piece_at(middle), piece);
        assert_eq!(steps.piece_at(piece.start_s), piece, "from the right");
        piece = steps.next_piece(piece);
    }
}

/// Masses under the law with known parameters, sampled at 10 Hz.
fn slow_masses(delay_s: f64) -> Setup {
    let mut setup = masses::consensus(2);
    for agent in &mut setup.agents {
        agent.law = Arc::new(Known { damping: Gain::Number(3.0) });
    }
    setup.network = Network {
        schedule: Schedule::fixed(vec![edge(0, 1), edge(1, 2), edge(2, 0)]),
        delays: vec![Delay::constant(delay_s)],
        ..silent(3)
    };
    setup.time.end_s = 6.0;
    sampled(setup, 10.0)
}

fn positions(outcome: &Outcome) -> Vec<Vec<f64>> {
    columns(outcome, Signal::Position).into_iter().map(<[f64]>::to_vec).collect()
}

#[test]
fn what_arrives_a_rounding_late_is_heard_at_the_sample_at_which_it_arrives() {
    // 0.3 s are three periods, give or take the last bit of k/10 − 0.3.
    let exact = positions(&run(&slow_masses(0.3)));
    assert_eq!(exact, positions(&run(&slow_masses(0.3 - 1e-10))));
    assert_eq!(positions(&run(&slow_masses(0.31))), positions(&run(&slow_masses(0.39))), "one sample later");
    assert_ne!(exact, positions(&run(&slow_masses(0.31))));
}

#[test]
fn messages_are_kept_as_long_as_the_longest_delay() {
    // Delays of 1, 2, 3, … periods each shift what is heard by one sample: none may be overwritten.
    let mut before = positions(&run(&slow_masses(0.0)));
    for periods in 1..20 {
        let now = positions(&run(&slow_masses(0.1 * f64::from(periods))));
        assert_ne!(now, before, "{periods}");
        before = now;
    }
    // With everybody silent for so long, agents hear the start for the whole run, however long the delay.
    assert_eq!(positions(&run(&slow_masses(6.0))), positions(&run(&slow_masses(60.0))));
}

#[test]
fn a_nonlinear_coupling_is_sampled_like_a_linear_one() {
    let mut setup = slow_masses(0.2);
    setup.control = None;
    setup.network.coupling = Coupling::Tanh { scale: 0.3 };
    crate::common::assert_first_order(&setup, 200.0);
}

fn with_control(mut setup: Setup, change: impl Fn(&mut Control)) -> Setup {
    change(setup.control.as_mut().unwrap());
    setup
}

#[test]
fn torques_are_rounded_and_limited_for_every_kind_of_agent() {
    let mut arm = planar(None, 0.3);
    arm.time.end_s = 0.4;
    let mut blind = masses::tracking();
    blind.time.end_s = 1.0;
    for setup in [slow_masses(0.2), sampled(arm, 500.0), sampled(blind, 500.0)] {
        let m = setup.agents[0].robot.axes.len();
        let quantum = 0.3;
        let rounded = run(&with_control(setup.clone(), |control| {
            control.actuators.torque_quantum = quantum;
            control.actuators.torque_limit = Some(vec![1.1; m]);
        }));
        let all: Vec<f64> = columns(&rounded, Signal::Torque).concat();
        assert!(all.iter().all(|tau| (tau / quantum - (tau / quantum).round()).abs() < 1e-9), "multiples of a step");
        // Three steps of 0.3 fit below 1.1, four do not, though 1.1 is nearer to four.
        let most = all.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        assert!((most - 0.9).abs() < 1e-9, "{most}");
    }
}

#[test]
fn commands_that_limits_change_are_counted_for_every_kind_of_agent() {
    let mut arm = planar(None, 0.3);
    arm.time.end_s = 0.4;
    let mut blind = masses::tracking();
    blind.time.end_s = 1.0;
    assert_eq!(run(&arm).statistics.clipped, None, "control is continuous");
    for setup in [slow_masses(0.2), sampled(arm, 500.0), sampled(blind, 500.0)] {
        let m = setup.agents[0].robot.axes.len();
        let with = |torque: f64, rate: f64| {
            with_control(setup.clone(), |control| {
                control.actuators.torque_limit = Some(vec![torque; m]);
                control.actuators.torque_rate_limit = Some(vec![rate; m]);
            })
        };
        let free = run(&with(1e6, 1e9));
        let torques = columns(&free, Signal::Torque).concat();
        let limit = 0.5 * torques.iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
        let (mut samples, mut at_limit) = (0, 0);
        let limited = simulate_with(
            &with(limit, 1e9),
            &mut |_| ControlFlow::Continue(()),
            Observers {
                samples: Some(&mut |sample| {
                    samples += 1;
                    at_limit += u64::from(sample.command.iter().any(|tau| tau.abs() == limit));
                }),
                ..Observers::default()
            },
        );
        let clipped = limited.unwrap().statistics.clipped.unwrap();
        assert_eq!(clipped, ClippedSamples { samples, torque: at_limit, rate: 0 });
        assert!(at_limit > 0 && at_limit < samples, "{clipped:?}");
        assert_eq!(free.statistics.clipped, Some(ClippedSamples { samples, torque: 0, rate: 0 }));
        assert_eq!(free.recording, run(&setup).recording, "the run is that without limits");
        // Some fail that way; until then nearly every command is too fast.
        let slow = simulate(&with(1e15, 1e-3), &mut |_| ControlFlow::Continue(())).unwrap().statistics.clipped.unwrap();
        assert!(slow.torque == 0 && slow.rate + 5 > slow.samples && slow.rate < slow.samples, "{slow:?}");
    }
}

#[test]
fn the_tighter_of_two_limits_counts() {
    let limited = |own: f64, common: f64| {
        let mut setup =
            with_control(slow_masses(0.2), |control| control.actuators.torque_limit = Some(vec![common; 2]));
        for agent in &mut setup.agents {
            agent.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(own));
            agent.enforce_limits = true;
        }
        let outcome = run(&setup);
        columns(&outcome, Signal::Torque).concat().iter().fold(0.0_f64, |most, tau| most.max(tau.abs()))
    };
    assert_eq!([limited(0.2, 0.5), limited(0.5, 0.2), limited(0.2, 0.2)], [0.2; 3]);
}

#[test]
fn what_limits_or_samples_take_away_from_a_proof_is_not_balanced() {
    let balanced = |setup: &Setup| {
        let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
        outcome.recording.columns.iter().any(|column| column.signal == Signal::Dissipation)
    };
    let mut setup = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(0), 0.5);
    setup.time.end_s = 1.0;
    assert!(balanced(&setup) && !balanced(&sampled(setup.clone(), 50.0)));
    setup.agents[0].enforce_limits = true;
    assert!(!balanced(&setup));
    setup.agents[0].enforce_limits = false;
    setup.solver.balance = false;
    assert!(!balanced(&setup));
}

/// A free mass in uniform motion: its filtered velocity rises like 1 − e^(−2π f t), and is what its reference starts from.
#[test]
fn the_cut_off_of_the_filter_is_in_hertz() {
    let cut_off_hz = 0.5;
    let mut setup = with_control(slow_masses(0.0), |control| {
        control.sample_hz = 100.0;
        control.sensors = Sensors { velocity: VelocitySensor::Filtered { cut_off_hz }, ..Sensors::default() };
    });
    setup.agents.truncate(1);
    setup.network = silent(1);
    // Nothing but damping acts, and z stays at zero: τ = −K q̇ as it is filtered.
    setup.agents[0].law = Arc::new(Known { damping: Gain::Number(1e-6) });
    setup.agents[0].start.reference = vec![vec![0.0; 2]; 2];
    setup.agents[0].roots_per_s = vec![1e-9, 1e-9].into();
    setup.time.end_s = 1.0;
    let outcome = run(&setup);
    let (tau, dq) = (column(&outcome, 0, Signal::Torque, 0), setup.agents[0].start.dq[0]);
    for (row, t) in outcome.recording.t_s.iter().enumerate().skip(1).filter(|(_, t)| **t < 0.99) {
        let want = -1e-6 * dq * (1.0 - (-core::f64::consts::TAU * cut_off_hz * t).exp());
        assert!((tau[row] - want).abs() < 0.02 * 1e-6 * dq.abs(), "{t}: {} is not {want}", tau[row]);
    }
}

#[test]
fn a_nonlinear_coupling_goes_with_consensus_by_positions_alone() {
    let base = || {
        let mut setup = slow_masses(0.2);
        setup.control = None;
        setup.network.coupling = Coupling::Tanh { scale: 0.3 };
        setup
    };
    let said = |change: &dyn Fn(&mut Setup)| {
        let mut setup = base();
        setup.time.end_s = 0.1;
        change(&mut setup);
        simulate(&setup, &mut |_| ControlFlow::Continue(())).err()
    };
    assert_eq!(said(&|_| {}), None);
    assert_eq!(said(&|setup| setup.exchange = Exchange::PositionVelocity), Some(SetupError::Coupling));
    let pure = Arc::new(PureIntegral);
    assert_eq!(said(&|setup| setup.reference = pure.clone()), Some(SetupError::Coupling));
}
