//! Controllers that are stepped by hand have the bits of the simulator, and their carts go the same ways.

#[path = "../examples/stepped.rs"]
#[allow(dead_code, unreachable_pub, missing_docs, reason = "an example that is a program of its own")]
mod example;

use std::ops::ControlFlow;

use example::{MASS_KG, PERIOD_S, Pair, START_M, latency_s, moved};
use forwardstep::sim::delay::{Delay, Packet, Trace};
use forwardstep::sim::{AgentSetup, Ending, Known, Network, Observers, RobotSetup, Setup, Signal, simulate_with};

const END_S: f64 = 20.0;

/// The same two carts, controllers and packets in the simulator.
fn setup() -> Setup {
    let cart = |name: &str, x: f64| {
        AgentSetup::new(name, RobotSetup::point_mass(1, MASS_KG), Known::gain(8.0)).roots([1.0, 2.0]).at(&[x])
    };
    let packet = |tick| Packet { send_s: f64::from(tick) * PERIOD_S, delay_s: latency_s(tick) };
    let trace = Trace::new((0..(END_S / PERIOD_S) as u32).map(packet).collect(), END_S).unwrap();
    let network = Network::fixed(2, [(0, 1), (1, 0)], Delay::new(trace));
    let mut setup = Setup::consensus([cart("left", START_M[0]), cart("right", START_M[1])], network, END_S);
    setup.time.record_every_s = PERIOD_S;
    setup.sampled(1.0 / PERIOD_S)
}

#[test]
fn digest_controllers_stepped_by_hand_have_the_bits_of_the_simulator() {
    let mut log = [Vec::new(), Vec::new()];
    let outcome = simulate_with(
        &setup(),
        &mut |_| ControlFlow::Continue(()),
        Observers {
            samples: Some(&mut |taken| {
                log[taken.agent].push(([taken.measured[0], taken.measured[1]], taken.command[0]));
            }),
            ..Observers::default()
        },
    )
    .unwrap();
    assert_eq!(outcome.ending, Ending::Completed);
    let mut pair = Pair::new().unwrap();
    for (tick, (left, right)) in log[0].iter().zip(&log[1]).enumerate() {
        let forces = pair.tick([left.0, right.0]).unwrap();
        assert_eq!(forces.map(f64::to_bits), [left.1, right.1].map(f64::to_bits), "sample {tick}");
    }
    let (heard, late) = pair.arrivals();
    assert!(log[0].len() > 2000 && heard > 1000 && late > 100, "{heard} heard, {late} late");
}

#[test]
fn carts_moved_by_hand_go_where_the_simulator_integrates_them_to() {
    let recording = forwardstep::sim::run(&setup()).unwrap().recording;
    let positions = [0, 1].map(|agent| recording.values(agent, Signal::Position, 0).unwrap());
    let (mut pair, mut carts) = (Pair::new().unwrap(), START_M.map(|x| [x, 0.0]));
    for row in 0..recording.t_s.len() {
        for k in 0..2 {
            assert!((carts[k][0] - positions[k][row]).abs() < 1e-7, "row {row}: {carts:?}");
        }
        let forces = pair.tick(carts).unwrap();
        carts = [0, 1].map(|k| moved(carts[k], forces[k]));
    }
    assert!((carts[0][0] - carts[1][0]).abs() < 1e-3);
}
