//! The same setup gives the same bits: again, beside other runs in other threads, and as on the machine that wrote the
//! digests.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod cases;
mod common;

use std::ops::ControlFlow;

use cases::{cases, setup};
use forwardstep_sim::{Actuators, Control, Sensors, Setup, VelocitySensor, simulate};

/// All Lagrangian cases, then a run of every other kind of system, continuous and sampled.
fn setups() -> Vec<(String, Setup)> {
    let mut all: Vec<_> = cases().iter().map(|case| (case.name.clone(), setup(case))).collect();
    for (name, setup) in common::every_kind() {
        all.push((format!("{name}-sampled"), common::sampled(setup.clone(), 500.0)));
        all.push((name.into(), setup));
    }
    all
}

/// FNV-1a over the bits of every number recorded.
fn digest_of(setup: &Setup) -> u64 {
    let outcome = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let numbers = outcome.recording.t_s.iter().chain(outcome.recording.columns.iter().flat_map(|c| &c.values));
    numbers
        .flat_map(|number| number.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[test]
fn digest_same_bits_on_repeat_and_beside_other_threads() {
    let setups = setups();
    let digest = |(_, setup): &(String, Setup)| digest_of(setup);
    let alone: Vec<u64> = setups.iter().map(digest).collect();
    for threads in [2, 7] {
        let together: Vec<u64> = std::thread::scope(|scope| {
            let chunks = setups.chunks(setups.len().div_ceil(threads));
            let running: Vec<_> =
                chunks.map(|chunk| scope.spawn(|| chunk.iter().map(digest).collect::<Vec<_>>())).collect();
            running.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
        });
        assert_eq!(alone, together, "{threads} threads");
    }
}

#[test]
fn digest_sampled_runs_have_the_same_bits_as_on_the_machine_that_wrote_them() {
    let mut setup = cases::setup(&cases()[14]);
    setup.control = Some(Control {
        sample_hz: 400.0,
        computation_delay_s: 0.001,
        sensors: Sensors {
            velocity: VelocitySensor::Filtered { cut_off_hz: 50.0 },
            position_noise: 1e-5,
            seed: 3,
            ..Sensors::default()
        },
        actuators: Actuators { torque_rate_limit: Some(vec![500.0; 2]), ..Actuators::default() },
    });
    assert_eq!(format!("{:016x}", digest_of(&setup)), "a7c54af484a3aa91");
}

#[test]
fn digest_same_bits_as_on_the_machine_that_wrote_them() {
    // When the numbers change on purpose, the message is the new content of digests.txt.
    let digests: String = setups().iter().map(|(name, setup)| format!("{:016x} {name}\n", digest_of(setup))).collect();
    assert_eq!(digests, include_str!("digests.txt"), "the bits are now\n{digests}");
}
