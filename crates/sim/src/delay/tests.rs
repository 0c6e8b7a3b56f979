use super::*;

fn arrivals(delay: &Delay, sent_s: f64) -> Vec<f64> {
    let mut out = Vec::new();
    delay.arrivals(sent_s, f64::INFINITY, &mut out);
    for t in &out {
        assert!((t - delay.value(*t) - sent_s).abs() < 1e-12, "{t} is no arrival of {sent_s}");
    }
    out
}

#[test]
fn constant_arrives_once() {
    assert_eq!(arrivals(&Delay::constant(0.25), 1.5), vec![1.75]);
    assert_eq!(arrivals(&Delay::constant(0.0), 1.5), Vec::<f64>::new());
}

#[test]
fn steep_sinusoid_arrives_several_times() {
    // |dT/dt| up to 3: t − T(t) turns back, so one message is heard three times.
    let delay = Delay::new(Sinusoid { mean_s: 0.6, amplitude_s: 0.5, period_s: 1.0, phase_rad: 0.0 });
    let counts: Vec<usize> = (0..20).map(|k| arrivals(&delay, 5.0 + 0.05 * k as f64).len()).collect();
    assert!(counts.iter().all(|c| c % 2 == 1), "{counts:?}");
    assert!(counts.contains(&3), "{counts:?}");
}

#[test]
fn a_delay_beyond_the_horizon_is_not_searched_to_its_end() {
    let until = |delay: Delay| {
        let mut out = Vec::new();
        delay.arrivals(0.5, 10.0, &mut out);
        out
    };
    let far = Delay::new(SawTooth { min_s: 0.0, max_s: 1e30, period_s: 0.6, offset_s: 0.0 });
    // From every tooth's start the delay rises past all that was sent since, but for the first instant.
    assert!(until(far).iter().all(|t| *t <= 10.0));
    let wide = Delay::new(Sinusoid { mean_s: 1e12, amplitude_s: 1e12, period_s: 0.1, phase_rad: 0.0 });
    assert!(until(wide).iter().all(|t| *t <= 10.0));
}

#[test]
fn saw_tooth_and_piecewise_jump_where_they_say() {
    let saw = Delay::new(SawTooth { min_s: 0.05, max_s: 0.4, period_s: 0.6, offset_s: 0.2 });
    let piece = saw.piece_at(0.5);
    assert!((piece.start_s - 0.4).abs() < 1e-15 && (piece.end_s - 1.0).abs() < 1e-15);
    assert_eq!(saw.value_on(piece, piece.start_s), 0.05);
    assert!((saw.value_on(piece, piece.end_s) - 0.4).abs() < 1e-15);
    assert!((saw.value(0.0) - (0.05 + 0.35 / 3.0)).abs() < 1e-15);

    let steps =
        Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: Some(1.0) });
    assert_eq!([0.0, 0.29, 0.3, 0.99, 1.0, 7.31].map(|t| steps.value(t)), [0.1, 0.1, 0.2, 0.2, 0.1, 0.2]);
    // Sent at 0.15: heard at 0.25 with the first value and at 0.35 with the second.
    let heard = arrivals(&steps, 0.15);
    assert_eq!(heard.len(), 2);
    let once = Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: None });
    assert_eq!(once.value(50.0), 0.2);
    assert_eq!(once.piece_at(0.2).end_s, 0.3);
}

#[test]
fn pieces_follow_one_another_without_gaps() {
    let delays = [
        Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 0.1, offset_s: 0.03 }),
        Delay::new(PiecewiseConstant {
            times_s: vec![0.0, 0.1, 0.7],
            values_s: vec![0.3, 0.0, 0.2],
            period_s: Some(0.9),
        }),
    ];
    for delay in delays {
        let mut piece = delay.first_piece();
        for _ in 0..10_000 {
            let next = delay.next_piece(piece);
            assert_eq!(piece.end_s, next.start_s);
            assert!(next.end_s > next.start_s);
            let middle = 0.5 * (next.start_s + next.end_s);
            assert_eq!(delay.piece_at(middle), next);
            assert_eq!(delay.piece_at(next.start_s), next);
            piece = next;
        }
    }
}

#[test]
fn what_is_known_beyond_the_run_says_what_it_rests_on() {
    let known = |delay: Delay| {
        let known = delay.known();
        (known.bound_s, known.unknown, known.basis, known.holds_packets)
    };
    let rule = |bound_s| (bound_s, None, Basis::Rule, false);
    assert_eq!(known(Delay::constant(0.25)), rule(0.25));
    assert_eq!(
        known(Delay::new(Sinusoid { mean_s: 0.5, amplitude_s: 0.25, period_s: 1.0, phase_rad: 0.0 })),
        rule(0.75)
    );
    assert_eq!(known(Delay::new(SawTooth { min_s: 0.1, max_s: 0.4, period_s: 1.0, offset_s: 0.0 })), rule(0.4));
    let steps = Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: None });
    assert_eq!(known(steps), rule(0.2));
    // By what may be drawn, not by what was drawn.
    let hold = RandomHold::draw(1, (0, 1), [0.05, 0.4], [0.1, 0.8], 1.0).unwrap();
    assert_eq!(known(Delay::new(hold)), rule(0.4));
    let link = |most_in_a_row| PacketLink {
        every_s: 0.25,
        first_s: 0.0,
        latency_s: 0.5,
        jitter_s: 0.0,
        loss: Loss::Random { probability: 0.5 },
        most_in_a_row,
        seed: 1,
    };
    let held = |most_in_a_row| Delay::new(link(most_in_a_row).trace((0, 1), 9.0).unwrap());
    assert_eq!(known(held(Some(2))), (1.25, None, Basis::Rule, true));
    let (bound_s, unknown, basis, packets) = known(held(None));
    assert_eq!((unknown, basis, packets), (Some(Unknown::PacketsInARow), Basis::Numbers, true));
    assert_eq!(bound_s, held(None).max_s());
    let log = Trace::new(vec![Packet { send_s: 0.0, delay_s: Some(0.5) }], 9.0).unwrap();
    assert_eq!(known(Delay::new(log)).1, Some(Unknown::LaterPackets));
}
