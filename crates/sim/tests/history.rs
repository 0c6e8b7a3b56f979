//! What is forgotten is never asked for again: every recorded number is that of the same run with all of its history kept.

use crate::cases::{cases, setup};
use crate::common::{every_kind, following, run, sampled};
use forwardstep_core::reference::Choice;
use forwardstep_sim::delay::{Delay, Loss, PacketLink, RandomHold, SawTooth};
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Network, Setup, SetupError, Signal, validate};

/// The same setup with a graph more, which comes into force after the end of the run only. One of its links is late by
/// `delay_s`, so that everything sent in that time is kept. `None` when nobody hears anybody, or nothing late.
fn with_a_late_link(setup: &Setup, delay_s: f64) -> Option<Setup> {
    let mut setup = setup.clone();
    let after_s = 2.0 * setup.time.end_s;
    let segments = setup.network.schedule.segments().take_while(|segment| segment.start_s < setup.time.end_s);
    let phase = |segment: forwardstep_sim::schedule::Segment| Phase {
        edges: setup.network.schedule.graph(segment.graph).to_vec(),
        dwell_s: segment.end_s.min(segment.start_s + after_s) - segment.start_s,
    };
    let mut phases: Vec<Phase> = segments.map(phase).collect();
    let mut edges = phases.iter().find(|phase| !phase.edges.is_empty())?.edges.clone();
    edges[0].delay = setup.network.delays.len();
    setup.network.delays.push(Delay::constant(delay_s));
    phases.push(Phase { edges, dwell_s: 1.0 });
    setup.network.schedule = Schedule::once(phases);
    (!matches!(validate(&setup), Err(SetupError::DelayedDerived { .. }))).then_some(setup)
}

/// Every column that differs from that of a run that forgets nothing: agent, signal and number of rows. `None` when nothing
/// can be forgotten.
fn forgotten(setup: &Setup) -> Option<Vec<(usize, Signal, usize)>> {
    let all_kept = run(&with_a_late_link(setup, 100.0 * setup.time.end_s)?);
    let forgetful = run(&with_a_late_link(setup, 0.0)?);
    assert_eq!(forgetful.recording.t_s, all_kept.recording.t_s);
    let columns = forgetful.recording.columns.iter().zip(&all_kept.recording.columns);
    let differ = columns.map(|(a, b)| {
        let rows = a.values.iter().zip(&b.values).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        (a.agent, a.signal, rows)
    });
    Some(differ.filter(|(_, _, rows)| *rows > 0).collect())
}

#[test]
fn regress_rows_within_a_step_hear_the_longest_delay() {
    for case in cases() {
        let mut setup = setup(&case);
        setup.time.record_every_s = 0.003;
        assert_eq!(forgotten(&setup), Some(vec![]), "{}", case.name);
    }
    let mut nothing_late = Vec::new();
    for (name, setup) in every_kind() {
        match forgotten(&setup) {
            Some(differ) => assert_eq!(differ, [], "{name}"),
            None => nothing_late.push(name),
        }
        assert_eq!(forgotten(&sampled(setup, 500.0)).unwrap_or_default(), [], "{name}, sampled");
    }
    // Nobody hears anybody, or accelerations are heard at once.
    let silent = [
        "chains-tracking",
        "masses-tracking",
        "masses-by-a-model",
        "tip-of-a-planar-arm",
        "tip-of-a-tree",
        "spacecraft",
        "passivity-filter",
    ];
    let at_once = ["following-119", "following-122", "following-as-a-swarm", "following-in-a-layer"];
    assert_eq!(nothing_late, [&silent[..], &at_once].concat());
    let mut followers = following::arms(FollowingDesign::Continuous, Choice::Implicit, 0.8, 4.0);
    followers.network.delays = vec![Delay::constant(0.3)];
    assert_eq!(forgotten(&followers), Some(vec![]));
}

#[test]
fn regress_rows_within_a_step_hear_the_longest_delay_of_every_kind() {
    let link = PacketLink {
        every_s: 0.05,
        first_s: 0.0,
        latency_s: 0.1,
        jitter_s: 0.1,
        loss: Loss::Random { probability: 0.3 },
        most_in_a_row: None,
        seed: 5,
    };
    let delays = [
        Delay::constant(0.4),
        Delay::new(SawTooth { min_s: 0.1, max_s: 0.5, period_s: 0.7, offset_s: 0.2 }),
        Delay::new(link.trace((0, 1), 12.0).unwrap()),
        Delay::new(RandomHold::draw(3, (0, 1), [0.1, 0.5], [0.2, 0.4], 12.0).unwrap()),
    ];
    // Order one with both exchanges, then the baseline that differentiates: what they record hears the network at every row.
    for name in ["01-order1-both-constant", "02-order1-position-sinusoid", "36-backstepping-varying"] {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        for delay in &delays {
            let mut setup = setup(&case);
            (setup.time.record_every_s, setup.time.end_s) = (0.003, 10.0);
            setup.network = Network { delays: vec![delay.clone(); setup.network.delays.len()], ..setup.network };
            assert_eq!(forgotten(&setup), Some(vec![]), "{name}, {delay:?}");
        }
    }
}
