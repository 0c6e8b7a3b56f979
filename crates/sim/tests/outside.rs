//! Delays and switching signals of one's own: the same bits as ours where they compute the same, and no lie goes unseen.

use std::ops::ControlFlow;

use crate::common::{consensus_of_masses, sampled, switching};
use forwardstep_core::Scalar;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{
    Arrivals, Basis, Delay, DelayFault, DelayFunction, DelayPiece, Known, Loss, PacketLink, SawTooth, Sinusoid,
};
use forwardstep_sim::network::NetworkError;
use forwardstep_sim::quantity::{QuantityError, positive};
use forwardstep_sim::recording::BreakdownCause;
use forwardstep_sim::schedule::{
    Dwell, Extent, KnownSwitching, Schedule, ScheduleFault, Segment, Segments, SwitchingSignal, Window,
};
use forwardstep_sim::{Ending, Outcome, Setup, SetupError, simulate};

/// Three masses that agree over two graphs in turn.
fn three() -> Setup {
    let mut setup = consensus_of_masses(4.0);
    setup.network.schedule = switching().schedule;
    setup
}

fn run(setup: &Setup) -> Result<Outcome, SetupError> {
    simulate(setup, &mut |_| ControlFlow::Continue(()))
}

/// A saw-tooth written by somebody else.
#[derive(Debug, PartialEq)]
struct Teeth(SawTooth);

impl DelayFunction for Teeth {
    fn words(&self) -> &'static str {
        "teeth"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        positive("", "period_s", self.0.period_s)
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let SawTooth { period_s, offset_s, .. } = self.0;
        let start_s = |index: u64| index as f64 * period_s - offset_s.rem_euclid(period_s);
        DelayPiece::new(index, start_s(index), start_s(index + 1))
    }

    fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
        let SawTooth { min_s, max_s, period_s, .. } = self.0;
        Scalar::mul_add((max_s - min_s) / period_s, t_s - piece.start_s, min_s).min(max_s)
    }

    fn known(&self) -> Known {
        Known::declared([self.0.min_s, self.0.max_s])
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.monotone();
    }
}

/// A delay that is what these functions say, whatever its author declares.
#[derive(Debug)]
struct Says {
    piece: fn(u64) -> DelayPiece,
    value: fn(f64) -> f64,
    within_s: [f64; 2],
}

impl PartialEq for Says {
    fn eq(&self, _: &Self) -> bool {
        false
    }
}

impl DelayFunction for Says {
    fn words(&self) -> &'static str {
        "a liar"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, index: u64) -> DelayPiece {
        (self.piece)(index)
    }

    fn value(&self, _: &DelayPiece, t_s: f64) -> f64 {
        (self.value)(t_s)
    }

    fn known(&self) -> Known {
        // What it says of its basis is not believed.
        Known { basis: Basis::Rule, ..Known::declared(self.within_s) }
    }

    fn arrivals(&self, search: &mut Arrivals<'_>) {
        search.within_slope(2.0);
    }
}

fn whole(_: u64) -> DelayPiece {
    DelayPiece::WHOLE
}

fn honest() -> Says {
    Says { piece: whole, value: |t| 0.2 + 0.1 * t.sin(), within_s: [0.1, 0.3] }
}

fn with(delay: Delay) -> Setup {
    let mut setup = three();
    setup.network.delays = vec![delay];
    setup
}

fn refuted(says: Says) -> DelayFault {
    let setup = with(Delay::new(says));
    match run(&setup) {
        Err(SetupError::Network(NetworkError::RefutedDelay { delay: 0, words: "a liar", fault })) => {
            let asked = setup.network.delays[0].probe(setup.time.end_s);
            assert_eq!(format!("{asked:?}"), format!("Err({fault:?})"), "whoever asks");
            fault
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_own_saw_tooth_has_the_bits_of_the_shipped_one() {
    let tooth = SawTooth { min_s: 0.05, max_s: 0.4, period_s: 0.6, offset_s: 0.2 };
    for sample_hz in [None, Some(100.0)] {
        let both = [with(Delay::new(tooth)), with(Delay::new(Teeth(tooth)))];
        let [shipped, own] = both.map(|setup| run(&sample_hz.map_or(setup.clone(), |hz| sampled(setup, hz))).unwrap());
        assert!(shipped.recording.t_s.len() > 50 && shipped.recording.columns.len() > 4);
        assert_eq!(shipped.recording.t_s, own.recording.t_s);
        assert_eq!(shipped.statistics, own.statistics, "the same steps");
        for (shipped, own) in shipped.recording.columns.iter().zip(&own.recording.columns) {
            let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&shipped.values), bits(&own.values), "{:?} of agent {}", shipped.signal, shipped.agent);
        }
    }
}

/// Packets that somebody else holds: when each is heard from, and when it was sent.
#[derive(Debug, PartialEq)]
struct Newest {
    held: Vec<(f64, f64)>,
    max_s: f64,
}

impl DelayFunction for Newest {
    fn words(&self) -> &'static str {
        "the newest"
    }

    fn validate(&self, _: f64) -> Result<(), QuantityError> {
        Ok(())
    }

    fn piece(&self, index: u64) -> DelayPiece {
        let k = (index as usize).min(self.held.len() - 1);
        let end_s = self.held.get(k + 1).map_or(f64::INFINITY, |next| next.0);
        DelayPiece { held_s: Some(self.held[k].1), ..DelayPiece::new(index, self.held[k].0, end_s) }
    }

    fn value(&self, _: &DelayPiece, _: f64) -> f64 {
        f64::NAN
    }

    fn known(&self) -> Known {
        Known { until_s: Some(4.0), holds_packets: true, ..Known::declared([0.0, self.max_s]) }
    }

    fn arrivals(&self, _: &mut Arrivals<'_>) {}
}

#[test]
fn packets_that_somebody_else_holds_have_the_bits_of_the_shipped_ones() {
    let radio = PacketLink {
        every_s: 0.1,
        first_s: 0.05,
        latency_s: 0.02,
        jitter_s: 0.2,
        loss: Loss::Random { probability: 0.2 },
        most_in_a_row: None,
        seed: 5,
    };
    let shipped = Delay::new(radio.trace((0, 1), 4.0).unwrap());
    let mut held = Vec::new();
    let mut piece = shipped.first_piece();
    loop {
        held.push((piece.start_s, piece.held_s.unwrap()));
        if piece.end_s.is_infinite() {
            break;
        }
        piece = shipped.next_piece(piece);
    }
    assert!(held.len() > 15 && held[0].1 == f64::NEG_INFINITY);
    let own = Delay::new(Newest { held, max_s: shipped.max_s() });
    for sample_hz in [None, Some(100.0)] {
        let both = [with(shipped.clone()), with(own.clone())];
        let [shipped, own] = both.map(|setup| run(&sample_hz.map_or(setup.clone(), |hz| sampled(setup, hz))).unwrap());
        assert_eq!(shipped.statistics, own.statistics, "the same steps");
        for (shipped, own) in shipped.recording.columns.iter().zip(&own.recording.columns) {
            assert_eq!(shipped.values, own.values, "{:?} of agent {}", shipped.signal, shipped.agent);
        }
    }
    let mut longer = with(own);
    longer.time.end_s = 4.5;
    assert!(matches!(run(&longer), Err(SetupError::Network(NetworkError::EndsEarly { index: 0, until_s: 4.0, .. }))));
}

#[test]
fn arrivals_within_a_slope_are_those_between_turning_points() {
    #[derive(Debug, PartialEq)]
    struct Swing(Sinusoid);

    impl DelayFunction for Swing {
        fn words(&self) -> &'static str {
            "a swing"
        }

        fn validate(&self, end_s: f64) -> Result<(), QuantityError> {
            self.0.validate(end_s)
        }

        fn piece(&self, index: u64) -> DelayPiece {
            self.0.piece(index)
        }

        fn value(&self, piece: &DelayPiece, t_s: f64) -> f64 {
            self.0.value(piece, t_s)
        }

        fn known(&self) -> Known {
            self.0.known()
        }

        fn arrivals(&self, search: &mut Arrivals<'_>) {
            search.within_slope(self.0.amplitude_s * std::f64::consts::TAU / self.0.period_s);
        }
    }

    let sinusoid = Sinusoid { mean_s: 0.6, amplitude_s: 0.5, period_s: 1.0, phase_rad: 0.3 };
    let [shipped, own] = [Delay::new(sinusoid), Delay::new(Swing(sinusoid))];
    assert_eq!(own.known().basis, Basis::Declared, "what it hands on is not its own");
    let mut several = 0;
    for k in 0..200 {
        let found = |delay: &Delay| {
            let mut found = Vec::new();
            delay.arrivals(0.037 * f64::from(k), 100.0, &mut found);
            found
        };
        let [shipped, own] = [found(&shipped), found(&own)];
        assert_eq!(shipped.len(), own.len(), "{k}");
        several += usize::from(own.len() > 1);
        assert!(shipped.iter().zip(&own).all(|(a, b)| (a - b).abs() < 1e-12), "{shipped:?} {own:?}");
    }
    assert!(several > 20, "{several}");
}

#[test]
fn what_is_from_outside_is_declared_whatever_it_says() {
    let known = Delay::new(honest()).known();
    assert_eq!((known.basis, known.within_s, known.unknown), (Basis::Declared, [0.1, 0.3], None));
    assert_eq!(run(&with(Delay::new(honest()))).unwrap().ending, Ending::Completed);
    assert!(!Delay::new(Says { value: |_| 0.2, within_s: [0.2, 0.2], ..honest() }).is_constant());
}

#[test]
fn pieces_that_leave_gaps_or_have_no_length_or_never_end_are_refused() {
    let refused = |piece| refuted(Says { piece, ..honest() });
    let gap = refused(|k| DelayPiece::new(k, k as f64 * 0.5, k as f64 * 0.5 + if k == 3 { 0.4 } else { 0.5 }));
    assert_eq!(gap, DelayFault::Gap { index: 4, start_s: 2.0, before_s: 1.9 });
    let late = refused(|k| DelayPiece::new(k, k as f64 + 0.1, k as f64 + 1.1));
    assert_eq!(late, DelayFault::Gap { index: 0, start_s: 0.1, before_s: 0.0 });
    let empty = refused(|k| DelayPiece::new(k, k.min(2) as f64, k.min(1) as f64 + 1.0));
    assert_eq!(empty, DelayFault::Empty { index: 2, start_s: 2.0, end_s: 2.0 });
    let no_number = refused(|k| DelayPiece::new(k, 0.0, f64::NAN));
    assert!(matches!(no_number, DelayFault::Empty { index: 0, .. }));
    // Pieces whose lengths halve come to no end before 1 s, those like 1/k to one after more than any run has.
    let halves = refused(|k| DelayPiece::new(k, 1.0 - 0.5_f64.powi(k as i32), 1.0 - 0.5_f64.powi(k as i32 + 1)));
    assert!(matches!(halves, DelayFault::Empty { start_s: 1.0, .. }), "{halves:?}");
    let many = refused(|k| DelayPiece::new(k, 1e-9 * k as f64, 1e-9 * (k + 1) as f64));
    assert!(matches!(many, DelayFault::TooMany { most: 1_000_000, t_s } if (t_s - 1e-3).abs() < 1e-9), "{many:?}");
}

#[test]
fn values_that_are_no_delays_or_not_as_declared_are_refused_with_time_and_value() {
    let refused = |value| refuted(Says { value, ..honest() });
    let DelayFault::Value { t_s, value_s, low_s: 0.1, high_s: 0.3 } = refused(|t| 0.2 + 0.05 * t) else { panic!() };
    assert!(t_s > 2.0 && value_s == 0.2 + 0.05 * t_s, "{value_s} at {t_s}");
    assert!(matches!(refused(|t| 0.3 - 0.1 * t), DelayFault::Value { t_s, .. } if t_s > 2.0));
    assert!(
        matches!(refused(|t| if t > 1.0 { f64::NAN } else { 0.2 }), DelayFault::Value { value_s, .. } if value_s.is_nan())
    );
    assert!(matches!(refused(|_| -0.1), DelayFault::Value { t_s: 0.0, value_s: -0.1, .. }));
    let jump = refused(|t| if t < 1.234 { 0.15 } else { 0.25 });
    let DelayFault::Jump { index: 0, t_s, by_s } = jump else { panic!("{jump:?}") };
    assert!((t_s - 1.234).abs() < 1e-12 && (by_s - 0.1).abs() < 1e-12);
    let early = refuted(Says { piece: |k| DelayPiece { held_s: Some(0.5), ..whole(k) }, ..honest() });
    assert_eq!(early, DelayFault::TooEarly { t_s: 0.0, sent_s: 0.5 });
    // Rounding is no lie.
    assert_eq!(run(&with(Delay::new(Says { value: |_| 0.3 + 1e-16, ..honest() }))).unwrap().ending, Ending::Completed);
}

#[test]
fn bounds_that_bound_nothing_are_refused() {
    for within_s in [[-0.1, 0.3], [0.3, 0.1], [f64::NAN, 0.3], [0.1, f64::NAN], [0.1, f64::INFINITY]] {
        let setup = with(Delay::new(Says { within_s, ..honest() }));
        let path = run(&setup).err().map(|error| error.path(&setup).to_string()).unwrap();
        assert!(path.starts_with("network.delays[0].the "), "{within_s:?}: {path}");
    }
}

#[test]
fn a_value_that_no_probe_meets_breaks_the_run_down() {
    // Too narrow for the raster, and where every step begins: t = 0 has been probed, what follows at once has not.
    let spike = |t: f64| if t > 1e-7 && t < 2e-3 { 5.0 } else { 0.2 };
    let setup = with(Delay::new(Says { value: spike, ..honest() }));
    for setup in [setup.clone(), sampled(setup, 1000.0)] {
        let outcome = run(&setup).unwrap();
        let Ending::BrokeDown(breakdown) = outcome.ending else { panic!("{:?}", outcome.ending) };
        let BreakdownCause::Delay { delay: 0, at_s } = breakdown.cause else { panic!("{breakdown:?}") };
        assert!(at_s < 2e-3, "{at_s}");
    }
}

#[test]
fn regress_no_coupling_hides_a_delay_that_is_no_number() {
    let spike = |t: f64| if t > 1e-7 && t < 2e-3 { f64::NAN } else { 0.2 };
    let couplings = [
        Coupling::Linear,
        Coupling::Saturated { limit: 0.5 },
        Coupling::Tanh { scale: 0.5 },
        Coupling::Rational { scale: 0.5 },
    ];
    for coupling in couplings {
        let mut setup = with(Delay::new(Says { value: spike, ..honest() }));
        setup.network.coupling = coupling;
        for setup in [setup.clone(), sampled(setup, 1000.0)] {
            let Ending::BrokeDown(breakdown) = run(&setup).unwrap().ending else { panic!("{coupling:?}") };
            assert!(matches!(breakdown.cause, BreakdownCause::Delay { delay: 0, .. }), "{coupling:?}: {breakdown:?}");
        }
    }
}

/// A switching signal that says this.
#[derive(Debug, PartialEq)]
struct Turns {
    segments: Vec<Segment>,
    least_s: f64,
}

impl SwitchingSignal for Turns {
    fn words(&self) -> &'static str {
        "turns"
    }

    fn validate(&self, _: usize, _: f64) -> Result<(), QuantityError> {
        positive("", "least_s", self.least_s)
    }

    fn segments(&self, _: usize) -> Segments<'_> {
        Segments::new(self.segments.iter().copied())
    }

    fn known(&self) -> KnownSwitching {
        // Nor is this believed.
        KnownSwitching { extent: Extent::Whole, dwell: Dwell::Shortest(self.least_s) }
    }
}

fn segment(start_s: f64, end_s: f64, graph: usize) -> Segment {
    Segment { start_s, end_s, graph }
}

#[test]
fn an_own_switching_signal_has_the_bits_of_the_shipped_one_and_is_judged_on_the_horizon() {
    let shipped = three();
    let end_s = shipped.time.end_s;
    let segments: Vec<Segment> = shipped.network.schedule.segments().take_while(|s| s.start_s <= end_s).collect();
    let mut own = shipped.clone();
    own.network.schedule = Schedule::new(shipped.network.schedule.graphs.clone(), Turns { segments, least_s: 0.1 });
    let window = |setup: &Setup| match setup.network.schedule.window(setup.network.agents, end_s) {
        Window::Uniform { length_s, for_all_time, .. } => (length_s, for_all_time),
        missing => panic!("{missing:?}"),
    };
    assert_eq!((window(&shipped).0, window(&shipped).1), (window(&own).0, true));
    assert!(!window(&own).1, "not for all time");
    assert_eq!(own.network.schedule.known(), KnownSwitching::declared(0.1));
    let [shipped, own] = [shipped, own].map(|setup| run(&setup).unwrap());
    assert!(shipped.recording.t_s.len() > 50);
    for (shipped, own) in shipped.recording.columns.iter().zip(&own.recording.columns) {
        assert_eq!(shipped.values, own.values);
    }
}

#[test]
fn a_switching_signal_that_is_not_what_it_says_is_refused() {
    let refused = |segments: Vec<Segment>| {
        let mut setup = three();
        let (graphs, end_s) = (setup.network.schedule.graphs.clone(), setup.time.end_s);
        setup.network.schedule = Schedule::new(graphs, Turns { segments, least_s: 0.5 });
        match run(&setup) {
            Err(SetupError::Network(NetworkError::RefutedSwitching { words: "turns", fault })) => {
                let asked = setup.network.schedule.probe(end_s);
                assert_eq!(format!("{asked:?}"), format!("Err({fault:?})"));
                // Nor does whoever looks at it all the same come to harm.
                setup.network.schedule.window(setup.network.agents, end_s);
                fault
            }
            other => panic!("{other:?}"),
        }
    };
    let ever = f64::INFINITY;
    assert_eq!(refused(vec![]), ScheduleFault::Ends { t_s: 0.0 });
    assert_eq!(refused(vec![segment(0.0, 1.0, 0)]), ScheduleFault::Ends { t_s: 1.0 });
    let gap = refused(vec![segment(0.0, 1.0, 0), segment(1.1, ever, 1)]);
    assert_eq!(gap, ScheduleFault::Gap { start_s: 1.1, before_s: 1.0 });
    let short = refused(vec![segment(0.0, 0.4, 0), segment(0.4, ever, 1)]);
    assert_eq!(short, ScheduleFault::Short { start_s: 0.0, end_s: 0.4, least_s: 0.5 });
    assert!(matches!(refused(vec![segment(0.0, f64::NAN, 0)]), ScheduleFault::Short { start_s: 0.0, .. }));
    for graph in [2, 7] {
        let nobody = refused(vec![segment(0.0, 1.0, 0), segment(1.0, ever, graph)]);
        assert_eq!(nobody, ScheduleFault::NoSuchGraph { t_s: 1.0, graph, graphs: 2 });
    }
}
