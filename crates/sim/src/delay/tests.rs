use forwardstep_core::expression::Expression;

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

#[test]
fn what_a_delay_does_on_a_part_of_a_piece_holds_all_of_its_values() {
    /// A delay from outside, of which only the declared bounds are known.
    #[derive(Debug, PartialEq)]
    struct Own;
    impl DelayFunction for Own {
        fn words(&self) -> &'static str {
            "a delay of one's own"
        }
        fn validate(&self, _: f64) -> Result<(), QuantityError> {
            Ok(())
        }
        fn piece(&self, _: u64) -> DelayPiece {
            DelayPiece::WHOLE
        }
        fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
            0.2 + 0.1 * libm::sin(t_s * t_s)
        }
        fn known(&self) -> Known {
            Known::declared([0.1, 0.3])
        }
        fn arrivals(&self, search: &mut Arrivals<'_>) {
            search.monotone();
        }
    }
    let t = Expression::variable(0);
    let waves = BoundedFormula::new((t * 3.0).sin_of() * 0.2 + 0.2, 9.0);
    let straight = [
        Delay::constant(0.25),
        Delay::new(SawTooth { min_s: 0.1, max_s: 0.4, period_s: 0.7, offset_s: 0.2 }),
        Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.3], values_s: vec![0.1, 0.2], period_s: Some(0.5) }),
        Delay::new(RandomHold::draw(1, (0, 1), [0.05, 0.4], [0.1, 0.8], 9.0).unwrap()),
    ];
    let wave = Sinusoid { mean_s: 0.3, amplitude_s: 0.3, period_s: 1.4, phase_rad: 0.4 };
    let curved = [Delay::new(wave), Delay::new(waves), Delay::new(Own)];
    let is_straight = (0..straight.len()).map(|_| true).chain((0..curved.len()).map(|_| false));
    for (delay, is_straight) in straight.iter().chain(&curved).zip(is_straight) {
        let mut piece = delay.first_piece();
        for k in 0..400 {
            let (from_s, to_s) = (0.02 * f64::from(k), 0.02 * f64::from(k + 1));
            while piece.end_s <= from_s {
                piece = delay.next_piece(piece);
            }
            let to_s = to_s.min(piece.end_s);
            let sent = delay.sent_over(piece, [from_s, to_s]);
            assert_eq!(matches!(sent, SentOver::Line(_)), is_straight, "{delay:?}");
            for part in [0.0, 0.3, 0.5, 0.9, 1.0] {
                let value_s = delay.value_on(piece, from_s + part * (to_s - from_s));
                let [low, high] = match sent {
                    SentOver::Line([first, last]) => [first + part * (last - first); 2],
                    SentOver::Within(within) => within,
                    SentOver::Held(_) => panic!("{delay:?} holds no packets"),
                };
                assert!(low <= value_s + 1e-12 && value_s <= high + 1e-12, "{delay:?}: {value_s} s, not {sent:?}");
                // As narrow as it can be, but for what only its author knows.
                let known = delay.known();
                assert!(known.basis == Basis::Declared || high - low < 0.03, "{delay:?}: {sent:?}");
            }
        }
    }
    let log = Trace::new(vec![Packet { send_s: 0.5, delay_s: Some(0.5) }], 9.0).unwrap();
    let log = Delay::new(log);
    assert_eq!(log.sent_over(log.first_piece(), [0.2, 0.3]), SentOver::Held(f64::NEG_INFINITY));
    assert_eq!(log.sent_over(log.piece_at(2.0), [2.0, 3.0]), SentOver::Held(0.5));
}
