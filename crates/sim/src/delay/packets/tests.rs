use proptest::prelude::*;

use super::super::{Delay, RandomHold, SawTooth};
use super::*;

fn link() -> PacketLink {
    PacketLink {
        every_s: 0.01,
        first_s: 0.0,
        latency_s: 0.02,
        jitter_s: 0.05,
        loss: Loss::Random { probability: 0.3 },
        most_in_a_row: None,
        seed: 11,
    }
}

/// Lengths of the runs of lost packets.
fn bursts(trace: &Trace) -> Vec<usize> {
    let mut bursts = vec![0];
    for packet in trace.packets() {
        match packet.delay_s {
            None => *bursts.last_mut().unwrap() += 1,
            Some(_) if *bursts.last().unwrap() > 0 => bursts.push(0),
            Some(_) => {}
        }
    }
    bursts.into_iter().filter(|length| *length > 0).collect()
}

/// What is heard at `t`, packet by packet.
fn oracle(packets: &[Packet], t: f64) -> f64 {
    let arrived = packets.iter().filter(|p| p.delay_s.is_some_and(|delay| p.send_s + delay <= t));
    arrived.map(|packet| packet.send_s).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn losses_have_their_rates_and_lengths() {
    let n = 200_000.0;
    let trace = |loss| PacketLink { loss, ..link() }.trace((3, 4), (n - 1.0) * 0.01).unwrap();
    let share = |trace: &Trace| trace.statistics().lost as f64 / trace.packets().len() as f64;

    // A share p of n independent losses is off by more than five deviations once in two million seeds.
    let random = trace(Loss::Random { probability: 0.3 });
    assert!((share(&random) - 0.3).abs() < 5.0 * (0.3 * 0.7 / n).sqrt(), "{}", share(&random));
    let mean = |lengths: &[usize]| lengths.iter().sum::<usize>() as f64 / lengths.len() as f64;
    // Runs of independent losses have the length 1/(1 − p) on average.
    assert!((mean(&bursts(&random)) - 1.0 / 0.7).abs() < 0.02, "{}", mean(&bursts(&random)));

    let chain = trace(Loss::Bursts { enter: 0.01, leave: 0.2 });
    // Losses in a row are alike: their effective number is smaller by (2 − enter − leave)/(enter + leave).
    let wanted = 0.01 / 0.21;
    let deviation = (wanted * (1.0 - wanted) / n * (2.0 - 0.21) / 0.21).sqrt();
    assert!((share(&chain) - wanted).abs() < 5.0 * deviation, "{} {wanted} {deviation}", share(&chain));
    let lengths = bursts(&chain);
    let deviation = (0.8_f64.sqrt() / 0.2) / (lengths.len() as f64).sqrt();
    assert!((mean(&lengths) - 5.0).abs() < 5.0 * deviation, "{} {deviation}", mean(&lengths));
    assert_eq!(trace(Loss::Never).statistics().lost, 0);
}

#[test]
fn latencies_are_uniform() {
    let trace = link().trace((0, 1), 2000.0).unwrap();
    let delays: Vec<f64> = trace.packets().iter().filter_map(|packet| packet.delay_s).collect();
    assert!(delays.iter().all(|delay| (0.02..=0.07).contains(delay)));
    let below = delays.iter().filter(|delay| **delay < 0.03).count() as f64 / delays.len() as f64;
    assert!((below - 0.2).abs() < 5.0 * (0.2 * 0.8 / delays.len() as f64).sqrt(), "{below}");
}

#[test]
fn a_link_has_its_own_stream() {
    let [one, same, other, back] =
        [(0, 1), (0, 1), (0, 2), (1, 0)].map(|pair| link().trace(pair, 5.0).unwrap().packets().to_vec());
    assert_eq!(one, same);
    assert!(one != other && one != back && other != back);
    // A longer run begins in the same way, and jitter has no say in what is lost.
    assert_eq!(link().trace((0, 1), 50.0).unwrap().packets()[..one.len()], one);
    let steady = PacketLink { jitter_s: 0.0, ..link() }.trace((0, 1), 5.0).unwrap();
    let lost = |packets: &[Packet]| packets.iter().map(|packet| packet.delay_s.is_none()).collect::<Vec<_>>();
    assert_eq!(lost(steady.packets()), lost(&one));
}

#[test]
fn packets_without_jitter_are_a_saw_tooth() {
    let steady = PacketLink { loss: Loss::Never, jitter_s: 0.0, latency_s: 0.25, every_s: 0.5, ..link() };
    let delay = Delay::new(steady.trace((0, 1), 4.0).unwrap());
    let tooth = Delay::new(SawTooth { min_s: 0.25, max_s: 0.75, period_s: 0.5, offset_s: 0.25 });
    assert_eq!(delay.value(0.125), 0.125);
    for k in 2..32 {
        let t = 0.125 * f64::from(k);
        assert_eq!(delay.value(t), tooth.value(t), "{t}");
        let (piece, other) = (delay.piece_at(t), tooth.piece_at(t));
        assert_eq!(piece.start_s, other.start_s);
        assert_eq!(delay.sent_on(piece, t), piece.start_s - 0.25);
    }
    assert_eq!(steady.bound_s(), 0.75);
}

#[test]
fn the_last_message_of_one_instant_counts() {
    let packet = |send_s, delay_s| Packet { send_s, delay_s: Some(delay_s) };
    let trace = Trace::new(vec![packet(0.0, 0.0), packet(1.0, 1.0), packet(1.5, 0.5), packet(1.75, 3.0)], 4.0).unwrap();
    let delay = Delay::new(trace);
    let sent = |t: f64| delay.sent_on(delay.piece_at(t), t);
    assert_eq!([0.0, 1.9, 2.0, 4.0].map(sent), [0.0, 0.0, 1.5, 1.5]);
    assert_eq!((delay.min_s(), delay.first_piece().end_s), (0.0, 2.0));
    let trace = delay.packets().unwrap();
    let LinkStatistics { sent, lost, late, largest_age_s } = trace.statistics();
    assert_eq!((sent, lost, late), (4, 0, 1));
    assert!((largest_age_s - 2.5).abs() < 1e-12);
    // Of a run that was stopped: what was sent at the start is as old as the run.
    let LinkStatistics { sent, lost, late, largest_age_s } = trace.statistics_until(1.6);
    assert_eq!((sent, lost, late, largest_age_s), (3, 0, 0, 1.6));
    assert_eq!(trace.statistics_until(2.0).late, 1);
}

#[test]
fn what_makes_no_link_is_refused() {
    let wrong = |change: &dyn Fn(&mut PacketLink)| {
        let mut link = link();
        change(&mut link);
        link.trace((0, 1), 1.0).unwrap_err().to_string()
    };
    assert_eq!(wrong(&|l| l.every_s = 0.0), "`period_s` is 0, but must be positive");
    assert_eq!(wrong(&|l| l.first_s = 0.2), "`first_s` is 0.2, but must be from 0 to 0.01");
    assert_eq!(wrong(&|l| l.latency_s = f64::NAN), "`latency_s` is NaN, but must not be negative");
    assert_eq!(wrong(&|l| l.jitter_s = -1.0), "`jitter_s` is -1, but must not be negative");
    let random = Loss::Random { probability: 1.5 };
    assert_eq!(wrong(&|l| l.loss = random), "`probability` is 1.5, but must be from 0 to 1");
    let bursts = [(1.5, 0.5), (0.5, 0.0), (0.5, 1.5)].map(|(enter, leave)| Loss::Bursts { enter, leave });
    let said = [
        "`enter` is 1.5, but must be from 0 to 1",
        "`leave` is 0, but must be positive",
        "`leave` is 1.5, but must be from 0 to 1",
    ];
    for (loss, said) in bursts.into_iter().zip(said) {
        assert_eq!(wrong(&|l| l.loss = loss), said);
    }
    assert_eq!(
        wrong(&|l| l.every_s = 1.0 / f64::from(1_u32 << 30)),
        "about 1.1e9 packets until the end of the run, but at most 5000000 are accepted"
    );
    let packet = |send_s, delay_s| Packet { send_s, delay_s: Some(delay_s) };
    assert!(matches!(Trace::new(vec![packet(-1.0, 0.0)], 1.0), Err(PacketError::Times { packet: 0, .. })));
    assert!(matches!(
        Trace::new(vec![packet(1.0, 0.0), packet(1.0, 1.0)], 1.0),
        Err(PacketError::Order { packet: 1, .. })
    ));
    assert!(RandomHold::draw(1, (0, 1), [0.2, 0.1], [1.0, 2.0], 5.0).is_err());
    assert!(RandomHold::draw(1, (0, 1), [0.1, 0.2], [0.0, 2.0], 5.0).is_err());
    assert_eq!(
        RandomHold::draw(1, (0, 1), [0.1, 0.2], [1e-9, 1e-8], 5.0).unwrap_err().to_string(),
        "about 9.1e8 jumps of the delay until the end of the run, but at most 5000000 are accepted"
    );
}

#[test]
fn a_short_least_hold_is_not_taken_for_every_hold() {
    for shortest in [1e-8, 1e-30] {
        let hold = RandomHold::draw(1, (0, 1), [0.1, 0.2], [shortest, 2.0], 10.0).unwrap();
        assert!((5..30).contains(&hold.times_s().len()), "{}", hold.times_s().len());
    }
}

#[test]
fn packets_holds_and_noise_share_no_random_numbers() {
    use rand::Rng;
    use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
    // Agent 1's noise and the link from 0 to 1 have the same stream of the same seed.
    let mut noise = ChaCha8Rng::seed_from_u64(11);
    noise.set_stream(1);
    let mut packets = stream(Kind::Packets, 11, 0, 1);
    let mut holds = stream(Kind::Holds, 11, 0, 1);
    let mut numbers: Vec<u64> =
        (0..100).flat_map(|_| [noise.random::<u64>(), packets.random(), holds.random()]).collect();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), 300);
}

#[test]
fn random_holds_keep_within_their_bounds() {
    let hold = RandomHold::draw(3, (0, 1), [0.05, 0.4], [0.1, 0.8], 500.0).unwrap();
    let delay = Delay::new(hold);
    let (mut piece, mut values) = (delay.first_piece(), Vec::new());
    while piece.end_s < 500.0 {
        assert!((0.1 - 1e-9..=0.8 + 1e-9).contains(&(piece.end_s - piece.start_s)));
        values.push(delay.value_on(piece, piece.start_s));
        assert_eq!(delay.piece_at(piece.start_s), piece);
        piece = delay.next_piece(piece);
    }
    assert!(values.iter().all(|value| (0.05..=0.4).contains(value)));
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    assert!((mean - 0.225).abs() < 5.0 * (0.35 / 12.0_f64.sqrt()) / (values.len() as f64).sqrt(), "{mean}");
}

fn any_packets() -> impl Strategy<Value = Vec<Packet>> {
    prop::collection::vec((0.0..0.3_f64, prop::option::weighted(0.7, 0.0..1.5_f64), any::<bool>()), 0..60).prop_map(
        |drawn| {
            let mut send_s = -1e-9;
            let packet = |(gap, delay_s, round): (f64, Option<f64>, bool)| {
                // Some on a grid, so that arrivals coincide.
                send_s += if round { 0.25 } else { gap + 1e-9 };
                Packet {
                    send_s: send_s.max(0.0),
                    delay_s: delay_s.map(|d: f64| if round { (4.0 * d).floor() / 4.0 } else { d }),
                }
            };
            drawn.into_iter().map(packet).collect()
        },
    )
}

proptest! {
    #[test]
    fn prop_the_newest_that_has_arrived_is_heard(packets in any_packets(), times in prop::collection::vec(0.0..12.0_f64, 20)) {
        let until_s = 10.0;
        let trace = Trace::new(packets.clone(), until_s).unwrap();
        let delay = Delay::new(trace);
        let arrivals = packets.iter().filter_map(|p| Some(p.send_s + p.delay_s?));
        for t in times.into_iter().chain(arrivals).filter(|t| *t <= until_s) {
            let piece = delay.piece_at(t);
            prop_assert!(piece.start_s <= t && t < piece.end_s);
            prop_assert_eq!(delay.sent_on(piece, t), oracle(&packets, t));
            prop_assert!((delay.min_s()..=delay.max_s()).contains(&delay.value_on(piece, t)));
        }
        let mut piece = delay.first_piece();
        while piece.end_s.is_finite() {
            let next = delay.next_piece(piece);
            prop_assert!(next.start_s == piece.end_s && next.end_s > next.start_s);
            prop_assert!(delay.sent_on(next, 0.0) > delay.sent_on(piece, 0.0));
            piece = next;
        }
    }

    #[test]
    fn prop_a_bounded_loss_bounds_the_age(
        (seed, most) in (any::<u64>(), 0..6_u32),
        (every_s, latency_s, jitter_s) in (0.01..0.3_f64, 0.0..0.4_f64, 0.0..0.6_f64),
        first in 0.0..=1.0_f64,
        bursts in any::<bool>(),
    ) {
        let loss = if bursts { Loss::Bursts { enter: 0.3, leave: 0.2 } } else { Loss::Random { probability: 0.8 } };
        let link = PacketLink { every_s, first_s: first * every_s, latency_s, jitter_s, loss, most_in_a_row: Some(most), seed };
        let trace = link.trace((0, 1), 60.0).unwrap();
        prop_assert!(trace.statistics().largest_age_s <= link.bound_s() * (1.0 + 1e-12));
        prop_assert!(super::tests::bursts(&trace).into_iter().all(|length| length <= most as usize));
    }
}
