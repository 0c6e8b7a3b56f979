//! Digital control: the continuous loop in the limit, and the very controller that runs on a robot.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::cases::{cases, setup};
use crate::common::{every_kind, masses, some};
use forwardstep_core::Gain;
use forwardstep_core::agent::{Agent, Inbox, Limiter};
use forwardstep_core::law::SlotineLi;
use forwardstep_core::reference::{Consensus, Measured, PositionVelocity};
use forwardstep_core::robot::PlanarArm;
use forwardstep_sim::delay::{Delay, Loss, PacketLink};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Actuators, Adaptive, AgentSetup, Breakdown, BreakdownCause, Control, Ending, Exchange, Known, Method, Outcome,
    Sensors, Setup, SetupError, Signal, VelocitySensor, simulate,
};

fn run(setup: &Setup) -> Outcome {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    outcome
}

fn control(sample_hz: f64) -> Control {
    Control {
        sample_hz,
        computation_delay_s: 0.0,
        sensors: Sensors::default(),
        actuators: Actuators::default(),
        failures: Default::default(),
    }
}

/// A case by its name, over a short horizon, at tight tolerance.
fn case(name: &str, end_s: f64) -> Setup {
    let case = cases().into_iter().find(|case| case.name == name).unwrap();
    let mut setup = setup(&case);
    setup.time.end_s = end_s;
    setup.time.record_every_s = 0.25;
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-10 };
    setup
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> &[f64] {
    let wanted = |c: &&forwardstep_sim::Column| (c.agent, c.signal, c.axis) == (agent, signal, axis);
    &outcome.recording.columns.iter().find(wanted).unwrap().values
}

/// The largest difference of positions.
fn gap(a: &Outcome, b: &Outcome) -> f64 {
    let positions = |o: &Outcome| -> Vec<f64> {
        let columns = o.recording.columns.iter().filter(|c| c.signal == Signal::Position);
        columns.flat_map(|c| c.values.clone()).collect()
    };
    let (a, b) = (positions(a), positions(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn prop_sampled_runs_converge_to_the_continuous_one_with_the_period() {
    for case_name in some(cases().iter().map(|case| case.name.clone()), 4) {
        let mut setup = case(&case_name, 4.0);
        let continuous = run(&setup);
        // From rates that resolve the roots, the damping and the shortest delays of the cases.
        let gaps = [1000.0, 2000.0, 4000.0].map(|sample_hz| {
            setup.control = Some(control(sample_hz));
            gap(&run(&setup), &continuous)
        });
        let orders = [(gaps[0] / gaps[1]).log2(), (gaps[1] / gaps[2]).log2()];
        assert!(orders.iter().all(|order| (0.9..1.15).contains(order)), "{case_name}: {gaps:?}, of orders {orders:?}");
    }
}

/// Between two samples the plant moves on, and with it all that is made of its state, whatever kind it is.
#[test]
fn regress_rows_between_two_samples_show_what_is_so_then() {
    const ROWS: usize = 5;
    for (name, setup) in every_kind() {
        let mut setup = crate::common::sampled(setup, 100.0);
        (setup.time.end_s, setup.time.record_every_s) = (0.5, 0.002);
        let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!(outcome.recording.t_s.len() > 50, "{name}: {:?}", outcome.ending);
        for column in &outcome.recording.columns {
            let made = matches!(column.signal, Signal::TrackingError | Signal::Error | Signal::Lyapunov);
            let moves = |values: &[f64]| values.iter().any(|value| *value != values[0]);
            if made && moves(&column.values) {
                let periods = column.values.chunks(ROWS).filter(|period| moves(period)).count();
                assert!(2 * ROWS * periods > column.values.len(), "{name}: {:?} {}", column.signal, column.axis);
            }
        }
    }
    let mut carts = masses::tracking();
    (carts.time.end_s, carts.time.record_every_s) = (2.0, 0.003);
    let outcome = run(&crate::common::sampled(carts.clone(), 100.0));
    let mut jets = [[0.0; 5]; 2];
    for (row, t_s) in outcome.recording.t_s.iter().enumerate() {
        carts.agents[0].target.as_ref().unwrap().jets(*t_s, &mut jets);
        for (axis, jet) in jets.iter().enumerate() {
            let at = |signal| column(&outcome, 0, signal, axis)[row];
            assert!((at(Signal::Error) - (at(Signal::Position) - jet[0])).abs() < 1e-14, "{t_s}");
        }
    }
}

/// What is within a limit is so by a whole number of steps, and 0.6/0.2 is three of them.
#[test]
fn regress_a_torque_that_is_rounded_reaches_its_limit() {
    for (quantum, limit, largest) in [
        (0.2, 0.6, 0.6),
        (0.1, 0.3, 0.3),
        (0.1, 0.7, 0.7),
        (0.4, 1.2, 1.2),
        (0.5, 1.3, 1.0),
        (1.0, 0.9, 0.0),
        (0.0, 1.3, 1.3),
    ] {
        let actuators = Actuators { torque_quantum: quantum, ..Actuators::default() };
        assert!((actuators.largest_within(limit) - largest).abs() < 1e-15, "{quantum} {limit}");
    }
    assert_eq!(Actuators { torque_quantum: 0.5, ..Actuators::default() }.largest_within(f64::INFINITY), f64::INFINITY);
    let mut setup = masses::tracking();
    let mut digital = control(50.0);
    digital.actuators = Actuators { torque_limit: Some(vec![0.6; 2]), torque_quantum: 0.2, ..Actuators::default() };
    setup.agents[0].start.q = vec![3.0, -3.0];
    setup.control = Some(digital);
    let outcome = run(&setup);
    let most = column(&outcome, 0, Signal::Torque, 0).iter().fold(0.0_f64, |most, torque| most.max(torque.abs()));
    assert!((most - 0.6).abs() < 1e-15, "{most}");
}

#[test]
fn regress_the_simulator_steps_the_agent_that_runs_on_a_robot() {
    let mut setup = case("03-order2-both-zero-delay", 2.0);
    setup.control = Some(control(256.0));
    // Exact in binary, so that rows and samples are the same instants.
    setup.time.record_every_s = 1.0 / 256.0;
    setup.network.schedule = Schedule::fixed(Vec::new());
    let outcome = run(&setup);

    let agent = &setup.agents[0];
    let Some(Adaptive { damping, adaptation, estimate_start, .. }) = agent.law.downcast() else { unreachable!() };
    let law = SlotineLi {
        damping: damping.resolve(2, &[]).unwrap(),
        adaptation: Some(adaptation.resolve(5, &[]).unwrap()),
        bounds: None,
    };
    assert_eq!(setup.exchange, Exchange::PositionVelocity);
    let reference = Consensus::<PositionVelocity>::new([(&agent.roots_per_s, 0.0)]).unwrap();
    let mut twin = Agent::new(PlanarArm, reference, law, estimate_start.clone(), Limiter::none(2)).unwrap();
    let read = |signal, row: usize| [0, 1].map(|axis| column(&outcome, 0, signal, axis)[row]);
    let start: Vec<f64> = (0..2).flat_map(|r| read(Signal::Reference(r), 0)).collect();
    twin.set_reference(&start).unwrap();
    let inbox = Inbox { degree: 0.0, sums: &[0.0; 4] };
    for row in 0..400 {
        let (q, dq) = (read(Signal::Position, row), read(Signal::Velocity, row));
        let command = twin.step(row as f64 / 256.0, Measured { q: &q, dq: &dq }, inbox).unwrap();
        assert_eq!(command.tau, read(Signal::Torque, row), "sample {row}");
        assert_eq!(command.z, read(Signal::Reference(0), row), "sample {row}");
    }
}

#[test]
fn commands_wait_for_the_computation_and_stay_within_the_limits() {
    let mut setup = case("03-order2-both-zero-delay", 0.5);
    let mut digital = control(250.0);
    digital.computation_delay_s = 0.003;
    setup.control = Some(digital.clone());
    setup.time.record_every_s = 0.001;
    let late = run(&setup);
    let torque = column(&late, 0, Signal::Torque, 0);
    // Nothing is applied before the first command is there, and that one asks for nothing. Then torques change 3 ms after every sample and only there.
    assert_eq!(torque[..3], [0.0; 3]);
    for (row, pair) in torque.windows(2).enumerate().skip(4) {
        assert_eq!(pair[0] != pair[1], (row + 1) % 4 == 3, "row {row}");
    }

    let limits = [0.2 * peak(torque), 0.2 * peak(column(&late, 0, Signal::Torque, 1))];
    digital.actuators = Actuators {
        torque_limit: Some(limits.to_vec()),
        torque_rate_limit: Some(vec![500.0, 200.0]),
        torque_quantum: 0.125,
    };
    setup.control = Some(digital);
    let limited = run(&setup);
    for (axis, rate) in [500.0, 200.0].into_iter().enumerate() {
        let torque = column(&limited, 0, Signal::Torque, axis);
        assert!(torque.iter().all(|tau| (tau / 0.125).fract() == 0.0));
        assert!(torque.iter().all(|tau| tau.abs() <= limits[axis]));
        assert!(torque[4..].windows(2).all(|pair| (pair[1] - pair[0]).abs() <= rate * 0.004 + 0.125));
    }
    assert!(peak(column(&limited, 0, Signal::Torque, 0)) > limits[0] - 0.125, "the limit is reached");
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |peak, value| peak.max(value.abs()))
}

#[test]
fn sampling_that_is_too_slow_ends_a_run_and_says_who_ran_away() {
    let mut setup = case("03-order2-both-zero-delay", 10.0);
    let mut slow = control(40.0);
    slow.computation_delay_s = 0.025;
    setup.control = Some(slow);
    let outcome = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let Ending::BrokeDown(Breakdown { t_s, signal: Signal::Velocity, cause, .. }) = outcome.ending else {
        unreachable!("{:?}", outcome.ending)
    };
    assert!(matches!(cause, BreakdownCause::RanAway { value, steps: 2500 } if value.abs() > 100.0), "{cause:?}");
    assert!(t_s < 10.0 && outcome.recording.t_s.last().is_some_and(|last| *last <= t_s));
}

#[test]
fn noise_is_the_same_for_the_same_seed_and_its_own_for_every_agent() {
    let mut setup = case("03-order2-both-zero-delay", 1.0);
    let with = |seed| {
        let mut control = control(100.0);
        control.sensors = Sensors { position_noise: 1e-3, velocity_noise: 1e-2, seed, ..Sensors::default() };
        Some(control)
    };
    setup.network.schedule = Schedule::fixed(Vec::new());
    setup.agents[1] = AgentSetup { name: setup.agents[1].name.clone(), ..setup.agents[0].clone() };
    let mut torques = |seed| {
        setup.control = with(seed);
        let outcome = run(&setup);
        [0, 1].map(|agent| column(&outcome, agent, Signal::Torque, 0).to_vec())
    };
    let first = torques(1);
    assert_eq!(first, torques(1));
    assert_ne!(first, torques(2));
    // Two agents that are the same but for their noise.
    assert_ne!(first[0], first[1]);
}

#[test]
fn encoders_alone_are_enough_for_agreement() {
    let mut setup = case("03-order2-both-zero-delay", 60.0);
    let mut digital = control(500.0);
    digital.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 40.0 };
    digital.sensors.position_quantum = 1e-5;
    setup.control = Some(digital);
    setup.solver.method = Method::Adaptive { rtol: 1e-6, atol: 1e-8 };
    let outcome = run(&setup);
    let ends = |axis| (0..setup.agents.len()).map(move |agent| (agent, axis));
    for axis in 0..2 {
        let last: Vec<f64> =
            ends(axis).map(|(agent, axis)| *column(&outcome, agent, Signal::Position, axis).last().unwrap()).collect();
        let spread = last.iter().fold(f64::MIN, |a, b| a.max(*b)) - last.iter().fold(f64::MAX, |a, b| a.min(*b));
        // A quantum of position, differenced, is 5e-3 rad/s of velocity noise; damped, it leaves this much.
        assert!(spread < 2e-2, "{last:?}");
    }
}

#[test]
fn regress_packets_that_arrive_at_a_sample_are_heard_at_it() {
    // Packets at every sample that take two periods are a delay of two periods, however 0.1 + 0.2 is rounded.
    let mut setup = case("03-order2-both-zero-delay", 2.0);
    for sample_hz in [8.0, 10.0, 50.0, 500.0] {
        let mut digital = control(sample_hz);
        digital.actuators.torque_limit = Some(vec![20.0, 20.0]);
        setup.control = Some(digital);
        for agent in &mut setup.agents {
            agent.law = Arc::new(Known { damping: Gain::Number(0.4) });
        }
        let latency_s = 2.0 / sample_hz;
        let link = PacketLink {
            first_s: 0.0,
            every_s: 1.0 / sample_hz,
            latency_s,
            jitter_s: 0.0,
            loss: Loss::Never,
            most_in_a_row: None,
            seed: 1,
        };
        setup.network.delays = vec![Delay::constant(latency_s)];
        let constant = run(&setup);
        setup.network.delays = vec![Delay::new(link.trace((0, 1), 2.0).unwrap())];
        assert_eq!(constant.recording, run(&setup).recording, "{sample_hz} Hz");
    }
}

#[test]
fn a_run_that_no_memory_holds_is_refused_before_it_begins() {
    let mut setup = case("03-order2-both-zero-delay", 2.0);
    for (sample_hz, end_s, delay_s) in [(1e300, 2.0, 0.0), (f64::NAN, 2.0, 0.0), (1e7, 2.0, 0.0), (9e3, 1e3, 1e9)] {
        setup.control = Some(control(sample_hz));
        setup.time.end_s = end_s;
        setup.network.delays = vec![Delay::constant(delay_s)];
        // Many agents make messages large, and rows are few.
        let agents = if delay_s > 0.0 { 12 } else { 3 };
        setup.agents =
            (0..agents).map(|k| AgentSetup { name: format!("agent-{k}"), ..setup.agents[0].clone() }).collect();
        setup.network.agents = agents;
        let refused = simulate(&setup, &mut |_| ControlFlow::Break(()));
        let expected = match refused {
            Err(SetupError::Memory { need_bytes, budget_bytes }) => delay_s > 0.0 && need_bytes > budget_bytes,
            Err(SetupError::Quantity(error)) => delay_s == 0.0 && error.path.to_string() == "control.sample_hz",
            _ => false,
        };
        assert!(expected, "{sample_hz} Hz, {end_s} s, {delay_s} s");
    }
}
