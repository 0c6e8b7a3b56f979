//! The same setup gives the same bits: again, beside other runs in other threads, and as on the machine that wrote the
//! digests.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use crate::cases::{cases, setup};
use forwardstep_sim::{
    Actuators, Control, NetworkJump, Observers, Sensors, Setup, Signal, VelocitySensor, simulate, simulate_with,
};

/// All Lagrangian cases, then a run of every other kind of system, continuous and sampled.
fn setups() -> Vec<(String, Setup)> {
    let mut all: Vec<_> = cases().iter().map(|case| (case.name.clone(), setup(case))).collect();
    for (name, setup) in crate::common::every_kind() {
        all.push((format!("{name}-sampled"), crate::common::sampled(setup.clone(), 500.0)));
        all.push((name.into(), setup));
    }
    all
}

/// FNV-1a over the bits of `numbers`, continuing from `hash`.
fn fnv(hash: u64, numbers: &[f64]) -> u64 {
    let bytes = numbers.iter().flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// A line per signal, with a digest per entry over the times of the rows and the values of all agents that have it. A digest
/// hangs on nothing else: columns may move and others may join them.
fn digests_of(setup: &Setup) -> String {
    let recording = simulate(setup, &mut |_| ControlFlow::Continue(())).unwrap().recording;
    let times = fnv(0xcbf2_9ce4_8422_2325, &recording.t_s);
    let mut entries: BTreeMap<String, BTreeMap<usize, BTreeMap<usize, &[f64]>>> = BTreeMap::new();
    for column in &recording.columns {
        let agents = entries.entry(column.signal.name()).or_default().entry(column.axis).or_default();
        assert_eq!(agents.insert(column.agent, &column.values), None, "one column per agent, signal and entry");
    }
    let mut text = String::new();
    for (name, entries) in entries {
        text += &format!("  {name}");
        for agents in entries.values() {
            let digest = agents.iter().fold(times, |hash, (agent, values)| fnv(fnv(hash, &[*agent as f64]), values));
            text += &format!(" {digest:016x}");
        }
        text.push('\n');
    }
    text
}

/// When the numbers change on purpose, the end of the message is the new content of the file.
fn same(committed: &str, now: &str) {
    let changed = committed.lines().zip(now.lines()).position(|(was, is)| was != is);
    let line = changed.unwrap_or(committed.lines().count()) + 1;
    assert!(committed == now, "the digests differ from line {line} on; they are now\n{now}");
}

#[test]
fn digest_same_bits_on_repeat_and_beside_other_threads() {
    let setups = setups();
    let digest = |(_, setup): &(String, Setup)| digests_of(setup);
    let alone: Vec<String> = setups.iter().map(digest).collect();
    for threads in [2, 7] {
        let together: Vec<String> = std::thread::scope(|scope| {
            let chunks = setups.chunks(setups.len().div_ceil(threads));
            let running: Vec<_> =
                chunks.map(|chunk| scope.spawn(|| chunk.iter().map(digest).collect::<Vec<_>>())).collect();
            running.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
        });
        assert_eq!(alone, together, "{threads} threads");
    }
}

#[test]
fn digest_a_run_whose_jumps_are_looked_at_has_the_same_bits() {
    let (mut shown, mut apart) = (0, 0);
    for (name, setup) in setups().into_iter().step_by(3) {
        let mut state = None;
        let mut look = |jump: NetworkJump<'_>| {
            assert!(setup.control.is_none() && jump.agent < setup.agents.len(), "{name}");
            assert!(jump.signals.len() == jump.state.len() && jump.before.sums.len() == jump.after.sums.len());
            // Positions first, and no state jumps between two agents' turns.
            assert_eq!(jump.signals[0], (Signal::Position, 0), "{name}");
            assert!(jump.signals.iter().all(|(signal, _)| *signal != Signal::Dissipation));
            shown += 1;
            apart += usize::from(jump.before != jump.after);
            let at = (jump.t_s, jump.agent);
            assert!(state.is_none_or(|last| last < at), "{name}: {last:?} {at:?}", last = state);
            state = Some(at);
        };
        let looked_at = simulate_with(
            &setup,
            &mut |_| ControlFlow::Continue(()),
            Observers { jumps: Some(&mut look), ..Observers::default() },
        )
        .unwrap();
        let plain = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
        for (one, other) in looked_at.recording.columns.iter().zip(&plain.recording.columns) {
            assert!(one.values.iter().map(|v| v.to_bits()).eq(other.values.iter().map(|v| v.to_bits())), "{name}");
        }
        assert_eq!(looked_at.statistics, plain.statistics, "{name}");
    }
    assert!(shown > 100 && apart > 50 && apart < shown, "{shown} {apart}");
}

#[test]
fn digest_sampled_runs_have_the_same_bits_as_on_the_machine_that_wrote_them() {
    let mut setup = crate::cases::setup(&cases()[14]);
    setup.control = Some(Control {
        failures: Default::default(),
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
    same(include_str!("digests/sampled.txt"), &digests_of(&setup));
}

#[test]
fn digest_same_bits_as_on_the_machine_that_wrote_them() {
    let digests: String = setups().iter().map(|(name, setup)| format!("{name}\n{}", digests_of(setup))).collect();
    same(include_str!("digests/all.txt"), &digests);
}
