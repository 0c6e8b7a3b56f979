//! The guaranteed rate of agreement, against closed forms and runs.

use forwardstep_check::ideal;
use forwardstep_check::prediction::guaranteed::WORK;
use forwardstep_check::prediction::{CascadeSpread, Fall, GuaranteedRate, guaranteed_rate};
use forwardstep_sim::delay::{Delay, Loss, PacketLink, RandomHold, SawTooth, Sinusoid};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Exchange, Setup};

use crate::common::{edge, masses, noise, run};

/// Two agents of order 1 that hear each other at once with the weight `w` and send velocities too.
fn pair(w: f64, kappa: f64) -> Setup {
    let schedule = Schedule::fixed(vec![edge(0, 1, w, 0), edge(1, 0, w, 0)]);
    let mut setup = masses(Exchange::PositionVelocity, 1, schedule, vec![Delay::constant(0.0)]);
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.time.end_s = 6.0;
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = vec![kappa]);
    setup
}

/// What the operator of that pair leaves, exactly: ψ₁ᵢ has (1 ± e^(−2wt))/2 of both, and ψ₀ᵢ follows it.
fn left_of_pair(w: f64, kappa: f64, t: f64) -> f64 {
    let (own, lag, two) = ((-2.0 * w * t).exp(), (-kappa * t).exp(), 2.0 * w);
    let part = 0.5 * kappa / (kappa - two) * (own - lag);
    let below = |i: usize| {
        let mean = 0.5 * (1.0 - lag);
        let signs = [[part, -part], [-part, part]][i];
        let mut row = [0.0, mean + signs[0], 0.0, mean + signs[1]];
        row[2 * i] = lag;
        row
    };
    let above = |i: usize| {
        let mut row = [0.0, 0.5 * (1.0 - own), 0.0, 0.5 * (1.0 - own)];
        row[2 * i + 1] = 0.5 * (1.0 + own);
        row
    };
    let rows = [below(0), above(0), below(1), above(1)];
    let common = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a.min(*b)).sum::<f64>();
    1.0 - rows.iter().flat_map(|a| rows.iter().map(move |b| common(a, b))).fold(1.0, f64::min)
}

#[test]
fn a_pair_without_delay_is_left_what_its_exponentials_leave() {
    for (w, kappa) in [(0.5, 3.0), (1.0, 40.0)] {
        let found = guaranteed_rate(&pair(w, kappa), WORK).unwrap();
        assert!(found.falls.len() > 5 && !found.drawn);
        for Fall { t_s, left } in &found.falls {
            let exact = left_of_pair(w, kappa, *t_s);
            assert!(*left >= exact && *left < exact + 0.01, "{t_s} s: {left}, exactly {exact}");
        }
        eprintln!("{w} {kappa}: {:?} {:?} {:?}", found.falls.len(), found.settled_s, found.repeat);
    }
}

fn five(exchange: Exchange, order: usize, seed: usize) -> Setup {
    let end_s = 40.0;
    let weight = |k: usize| 1.0 + 0.6 * noise(seed + k);
    let ring: Vec<_> = (0..5).map(|i| edge(i, (i + 1) % 5, weight(i), i % 3)).collect();
    let chords = vec![edge(0, 2, weight(7), 1), edge(3, 1, weight(8), 2)];
    let link = PacketLink {
        every_s: 0.1,
        first_s: 0.05,
        latency_s: 0.03,
        jitter_s: 0.2,
        loss: Loss::Random { probability: 0.3 },
        most_in_a_row: Some(4),
        seed: 3,
    };
    let delays = match seed % 4 {
        0 => vec![Delay::constant(0.0), Delay::constant(0.35), Delay::constant(0.6)],
        1 => vec![
            Delay::new(SawTooth { min_s: 0.0, max_s: 0.3, period_s: 0.7, offset_s: 0.1 }),
            Delay::new(Sinusoid { mean_s: 0.3, amplitude_s: 0.3, period_s: 1.4, phase_rad: 0.4 }),
            Delay::constant(0.2),
        ],
        2 => vec![Delay::new(link.trace((0, 1), end_s).unwrap()); 3],
        _ => vec![Delay::new(RandomHold::draw(5, (0, 1), [0.0, 0.4], [0.1, 0.3], end_s).unwrap()); 3],
    };
    let schedule = match seed % 3 {
        0 => Schedule::fixed(ring),
        1 => Schedule::periodic(vec![
            Phase { edges: ring[..2].to_vec(), dwell_s: 0.4 },
            Phase { edges: ring[2..].to_vec(), dwell_s: 0.7 },
            Phase { edges: chords, dwell_s: 0.3 },
        ]),
        _ => Schedule::random(vec![ring[..2].to_vec(), ring[2..].to_vec(), chords], [0.2, 0.5], seed as u64),
    };
    let mut setup = masses(exchange, order, schedule, delays);
    setup.time.end_s = end_s;
    setup.time.record_every_s = 0.02;
    setup
}

/// The spread of a run of the reference dynamics never exceeds what is guaranteed; the largest part of it that it comes to, and when it
/// settles.
fn held_against_a_run(setup: &Setup, found: &GuaranteedRate) -> Option<f64> {
    let ideal = ideal(setup).unwrap();
    let outcome = run(&ideal);
    let spread = CascadeSpread::of(&ideal, &outcome.recording).unwrap();
    for (low, high) in spread.low.iter().zip(&spread.high) {
        let start = high[0] - low[0];
        for Fall { t_s, left } in &found.falls {
            let rows = outcome.recording.t_s.iter().zip(low.iter().zip(high));
            for (at_s, (low, high)) in rows.filter(|(at_s, _)| **at_s >= *t_s) {
                assert!(high - low <= left * start * (1.0 + 1e-6), "{at_s} s: {}, not {left} of {start}", high - low);
            }
        }
    }
    let widths = spread.widths();
    let last = widths.iter().rposition(|width| *width > 0.01 * widths[0])?;
    outcome.recording.t_s.get(last + 1).copied()
}

#[test]
fn prop_no_run_shrinks_less_than_is_guaranteed() {
    for seed in 0..12 {
        for (exchange, order) in [(Exchange::Position, 1), (Exchange::PositionVelocity, 2), (Exchange::Position, 3)] {
            let setup = five(exchange, order, seed);
            let started = std::time::Instant::now();
            let found = guaranteed_rate(&setup, WORK);
            let quick = started.elapsed();
            let Ok(found) = found else {
                eprintln!("{seed} {exchange:?} {order}: {found:?}");
                continue;
            };
            let started = std::time::Instant::now();
            let more = guaranteed_rate(&setup, WORK).unwrap();
            let thorough = started.elapsed();
            let settled = held_against_a_run(&setup, &found);
            let settled2 = held_against_a_run(&setup, &more);
            eprintln!(
                "{seed} {exchange:?} {order}: quick {:?} {:?} last {:?} rep {:?}; thorough {:?} {:?} last {:?} rep {:?}; run {settled:?} {settled2:?}",
                quick,
                found.settled_s,
                found.falls.last(),
                found.repeat,
                thorough,
                more.settled_s,
                more.falls.last(),
                more.repeat
            );
        }
    }
}
