//! The conserved quantity, the spread that never grows, and the case in which it does.

use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral, ReferenceDynamics};
use std::sync::Arc;

use crate::common::{arm, column, edge, masses, noise, run, setup};
use forwardstep_check::prediction::CascadeSpread;
use forwardstep_check::{Answer, Id, NoPrediction, NotFixed, check, predict};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_sim::delay::{Delay, Loss, PacketLink, PiecewiseConstant, RandomHold, SawTooth, Sinusoid};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::{Edge, Weight};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Exchange, Known, Outcome, Setup, Signal, TimeSpan};

/// A strongly connected triangle with different weights and delays, and a fourth that only listens.
fn uneven() -> (Vec<Edge>, Vec<Delay>) {
    let edges =
        vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 1.1, 2), edge(1, 0, 0.4, 0), edge(2, 3, 0.9, 1)];
    let delays = vec![Delay::constant(0.3), Delay::constant(0.0), Delay::constant(0.75)];
    (edges, delays)
}

#[test]
fn prop_agreed_value_is_known_before_the_run() {
    // For every member of the family, adaptation on, agents in motion, roots of their own: to 1e-6.
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=4 {
            let agents = (0..4)
                .map(|i| {
                    let roots: Vec<f64> = (0..order).map(|r| 1.2 + 0.8 * r as f64 + 0.15 * i as f64).collect();
                    let mut agent = arm(i, &roots);
                    let entry = |k: usize| vec![0.4 * noise(50 + i + k), 0.4 * noise(70 + i + k)];
                    agent.start.reference = (0..order).map(entry).collect();
                    agent
                })
                .collect();
            let (edges, delays) = uneven();
            let mut setup = setup(agents, exchange, Schedule::fixed(edges), delays, 160.0);
            setup.time.record_every_s = 10.0;
            let prediction = predict(&setup).unwrap();
            assert!((prediction.influence.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert_eq!(prediction.influence[3], 0.0, "who is heard by nobody has no influence");
            let outcome = run(&setup);
            for agent in 0..4 {
                for axis in 0..2 {
                    let q = *column(&outcome, agent, Signal::Position, axis).last().unwrap();
                    let c = prediction.value[axis];
                    assert!((q - c).abs() < 1e-6, "{exchange:?} order {order} agent {agent}: {q} is not {c}");
                }
            }
        }
    }
}

#[test]
fn thm1_agreed_value_is_known_for_the_pure_integrals_too() {
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        let agents = (0..4)
            .map(|i| {
                let mut agent = arm(i, &[1.2 + 0.15 * i as f64, 2.0]);
                agent.start.reference = vec![vec![0.4 * noise(50 + i); 2], vec![0.3 * noise(60 + i); 2]];
                agent
            })
            .collect();
        let (edges, delays) = uneven();
        let mut setup = setup(agents, exchange, Schedule::fixed(edges), delays, 160.0);
        setup.reference = Arc::new(PureIntegral);
        setup.time.record_every_s = 10.0;
        let report = check(&setup);
        assert_eq!(report.worst(), Answer::Holds);
        assert!(report.theorem.to_string().starts_with(if exchange == Exchange::Position {
            "Remark 3"
        } else {
            "Theorem 1"
        }));
        let prediction = predict(&setup).unwrap();
        let outcome = run(&setup);
        for agent in 0..4 {
            for axis in 0..2 {
                let q = *column(&outcome, agent, Signal::Position, axis).last().unwrap();
                let c = prediction.value[axis];
                assert!((q - c).abs() < 1e-6, "{exchange:?} agent {agent}: {q} is not {c}");
            }
        }
    }
}

/// Two arms that first hear nobody and then each other; the largest torque within 0.1 s of the switch.
fn torque_at_a_switch(reference: Arc<dyn ReferenceDynamics>, exchange: Exchange) -> f64 {
    let roots: &[f64] = if reference.is::<Consensus>() { &[1.0, 2.0] } else { &[] };
    let both = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 0)];
    let schedule = Schedule::once(vec![
        Phase { edges: vec![edge(0, 1, 1.0, 0)], dwell_s: 3.0 },
        Phase { edges: both, dwell_s: 1.0 },
    ]);
    let mut setup = setup((0..2).map(|i| arm(i, roots)).collect(), exchange, schedule, vec![Delay::constant(0.2)], 3.1);
    setup.reference = reference;
    for agent in &mut setup.agents {
        agent.law = Arc::new(Known { damping: Gain::Number(8.0) });
    }
    setup.agents[0].start.q = vec![1.0, 0.5];
    setup.agents[1].start.q = vec![-0.6, 0.2];
    setup.time.record_every_s = 1e-4;
    let outcome = run(&setup);
    let after = outcome.recording.t_s.iter().position(|t| *t >= 3.0).unwrap();
    let torques = outcome.recording.columns.iter().filter(|c| c.signal == Signal::Torque);
    torques.flat_map(|c| c.values[after..].iter().map(|tau| tau.abs())).fold(0.0, f64::max)
}

#[test]
fn eq_aa6_torque_at_a_switch_grows_as_the_filter_narrows_and_that_of_a1_does_not() {
    let filter = |filter_s| Arc::new(Backstepping { filter_s, acceleration_limit: None });
    let peaks = [1e-2, 1e-3, 1e-4].map(|filter_s| torque_at_a_switch(filter(filter_s), Exchange::Position));
    // The part that goes like 1/ε, without gravity and damping.
    let growth = (peaks[2] - peaks[1]) / (peaks[1] - peaks[0]);
    assert!((growth - 10.0).abs() < 0.5, "{peaks:?} grow by {growth}");
    assert!(peaks[2] > 20.0 * torque_at_a_switch(Arc::new(Consensus), Exchange::PositionVelocity));

    let limited = Arc::new(Backstepping { filter_s: 1e-4, acceleration_limit: Some(5.0) });
    assert!(torque_at_a_switch(limited, Exchange::Position) < 0.1 * peaks[2]);
}

#[test]
fn eq_3_over_a_switching_graph_is_not_covered() {
    let phase = |from, to| Phase { edges: vec![edge(from, to, 1.0, 0)], dwell_s: 1.0 };
    let schedule = Schedule::periodic(vec![phase(0, 1), phase(1, 0)]);
    let agents = (0..2).map(|i| arm(i, &[1.0, 2.0])).collect();
    let mut setup = setup(agents, Exchange::PositionVelocity, schedule, vec![Delay::constant(0.1)], 1.0);
    setup.reference = Arc::new(PureIntegral);
    let report = check(&setup);
    assert_eq!(report.worst(), Answer::NotCovered);
    assert!(report.hypotheses.iter().any(|h| h.answer() == Answer::NotCovered && h.because().contains("(a1)")));
}

#[test]
fn thm1_phases_that_differ_in_delays_alone_are_one_graph() {
    let of = |delays: [usize; 5], weight: f64, dwell_s: f64| Phase {
        edges: (0..5).map(|k| edge(k, (k + 1) % 5, if k == 2 { weight } else { 1.3 }, delays[k])).collect(),
        dwell_s,
    };
    let turned = |mut phase: Phase| {
        phase.edges.reverse();
        phase
    };
    let saw = Delay::new(SawTooth { min_s: 0.0, max_s: 0.5, period_s: 0.37, offset_s: 0.1 });
    let delays = || vec![Delay::constant(0.0), Delay::constant(0.4), saw.clone()];
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        let over = |phases: Vec<Phase>| {
            let mut setup = masses(exchange, 2, Schedule::periodic(phases), delays());
            setup.reference = Arc::new(PureIntegral);
            setup
        };
        let (first, second) = (of([0, 1, 2, 0, 1], 1.3, 0.6), turned(of([1, 1, 0, 2, 0], 1.3, 0.9)));
        let mut setup = over(vec![first.clone(), second]);
        assert_eq!(check(&setup).worst(), Answer::Holds, "{exchange:?}");
        let heavier = check(&over(vec![first, of([1, 1, 0, 2, 0], 1.4, 0.9)]));
        let fixed = heavier.hypotheses.iter().find(|hypothesis| hypothesis.id == Id::FixedGraph).unwrap();
        assert_eq!(fixed.answer(), Answer::NotCovered);
        // And they agree, within an interval that never grows.
        setup.time.end_s = 60.0;
        let outcome = run(&setup);
        let spread = spreads(&setup, &outcome, 0);
        assert!(spread.windows(2).all(|pair| pair[1] <= pair[0] + 2e-5 * spread[0]), "{exchange:?}");
        assert!(spread[spread.len() - 1] < 1e-2 * spread[0], "{exchange:?}: {}", spread[spread.len() - 1]);
    }
}

#[test]
fn prediction_says_why_there_is_none() {
    let agents = || (0..2).map(|i| arm(i, &[1.0, 2.0])).collect::<Vec<_>>();
    let constant = vec![Delay::constant(0.1)];
    let one_way = Schedule::fixed(vec![edge(0, 1, 1.0, 0)]);
    let saw = vec![Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 1.0, offset_s: 0.0 })];
    let case = |schedule, delays| predict(&setup(agents(), Exchange::Position, schedule, delays, 1.0));
    assert_eq!(case(one_way.clone(), saw), Err(NoPrediction::NotFixed(NotFixed::VaryingDelay)));
    assert_eq!(case(Schedule::fixed(vec![]), constant.clone()), Err(NoPrediction::NoSpanningTree { closed_groups: 2 }));
    let phase = |from, to| Phase { edges: vec![edge(from, to, 1.0, 0)], dwell_s: 1.0 };
    assert_eq!(
        case(Schedule::periodic(vec![phase(0, 1), phase(1, 0)]), constant.clone()),
        Err(NoPrediction::NotFixed(NotFixed::Switching))
    );
    assert_eq!(case(one_way, constant).unwrap().influence, vec![1.0, 0.0]);
}

/// The width at every row of the interval of all cascaded variables, on one axis.
fn spreads(setup: &Setup, outcome: &Outcome, axis: usize) -> Vec<f64> {
    let CascadeSpread { low, high } = CascadeSpread::of(setup, &outcome.recording).unwrap();
    low[axis].iter().zip(&high[axis]).map(|(low, high)| high - low).collect()
}

#[test]
fn prop_spread_never_grows_whatever_switches_or_jumps() {
    let phase = |edges: &[(usize, usize, usize)], dwell_s| Phase {
        edges: edges.iter().map(|&(from, to, delay)| edge(from, to, 1.3, delay)).collect(),
        dwell_s,
    };
    let delays = vec![
        Delay::new(SawTooth { min_s: 0.0, max_s: 0.5, period_s: 0.37, offset_s: 0.1 }),
        Delay::new(PiecewiseConstant {
            times_s: vec![0.0, 0.4, 0.9],
            values_s: vec![0.6, 0.0, 0.2],
            period_s: Some(1.3),
        }),
        Delay::new(Sinusoid { mean_s: 0.3, amplitude_s: 0.3, period_s: 0.8, phase_rad: 1.0 }),
    ];
    let schedule = Schedule::periodic(vec![
        phase(&[(0, 1, 0), (2, 3, 1)], 0.31),
        phase(&[(1, 2, 2), (3, 4, 0), (4, 0, 1)], 0.23),
        phase(&[], 0.1),
        phase(&[(4, 2, 2), (0, 3, 0)], 0.47),
    ]);
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=4 {
            let setup = masses(exchange, order, schedule.clone(), delays.clone());
            let outcome = run(&setup);
            for axis in 0..2 {
                let spread = spreads(&setup, &outcome, axis);
                for (row, pair) in spread.windows(2).enumerate() {
                    // What is left is the distance between two rows, over which a crest can hide.
                    assert!(
                        pair[1] <= pair[0] + 2e-5 * spread[0],
                        "{exchange:?} order {order}: {} → {} at row {row}",
                        pair[0],
                        pair[1]
                    );
                }
                assert!(spread[spread.len() - 1] < 0.9 * spread[0]);
            }
        }
    }
}

#[test]
fn prop_spread_never_grows_over_random_packets_and_weights() {
    // Lossy, jittering, overtaking packets of four kinds, weights that swing, and a switching graph.
    let end_s = 12.0;
    let link = |seed, loss, jitter_s| PacketLink {
        every_s: 0.11,
        first_s: 0.03,
        latency_s: 0.05,
        jitter_s,
        loss,
        most_in_a_row: None,
        seed,
    };
    let swing = (Expression::variable(0) * 2.0).sin_of() * 1.2 + 1.3;
    for seed in 0..4 {
        let links = [
            link(seed, Loss::Never, 0.0),
            link(seed, Loss::Random { probability: 0.4 }, 0.3),
            link(seed, Loss::Bursts { enter: 0.1, leave: 0.3 }, 0.5),
        ];
        let pairs = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 3)];
        let mut delays: Vec<Delay> =
            pairs.iter().enumerate().map(|(k, pair)| Delay::new(links[k % 3].trace(*pair, end_s).unwrap())).collect();
        delays.push(Delay::new(RandomHold::draw(seed, (4, 2), [0.0, 0.5], [0.05, 0.4], end_s).unwrap()));
        let mut edges: Vec<Edge> = pairs.iter().enumerate().map(|(k, pair)| edge(pair.0, pair.1, 1.3, k)).collect();
        edges.push(edge(4, 2, 0.7, 6));
        edges[1].weight = Weight::Formula(0);
        edges[4].weight = Weight::Formula(0);
        let some = |which: &[usize]| which.iter().map(|k| edges[*k]).collect::<Vec<_>>();
        let schedule = Schedule::periodic(vec![
            Phase { edges: some(&[0, 2, 4]), dwell_s: 0.7 },
            Phase { edges: some(&[1, 3, 5, 6]), dwell_s: 0.9 },
        ]);
        let exchange = if seed % 2 == 0 { Exchange::Position } else { Exchange::PositionVelocity };
        let mut setup = masses(exchange, 1 + seed as usize % 3, schedule, delays);
        setup.network.weights = vec![BoundedFormula::new(swing.clone(), end_s)];
        let outcome = run(&setup);
        for axis in 0..2 {
            let spread = spreads(&setup, &outcome, axis);
            for (row, pair) in spread.windows(2).enumerate() {
                assert!(pair[1] <= pair[0] + 2e-5 * spread[0], "seed {seed}: {} → {} at row {row}", pair[0], pair[1]);
            }
            assert!(spread[spread.len() - 1] < 0.9 * spread[0]);
        }
        assert_eq!(predict(&setup), Err(NoPrediction::NotFixed(NotFixed::Switching)));
    }
}

#[test]
fn thm3_a5_with_unequal_first_roots_diverges_and_24_does_not() {
    // Two agents without delay, κ₀ = 4 and 0.2; nothing for 4 s, then both hear each other strongly for 0.5 s, repeated.
    let diverging = |exchange| {
        let both = vec![edge(0, 1, 4.0, 0), edge(1, 0, 4.0, 0)];
        let schedule =
            Schedule::periodic(vec![Phase { edges: vec![], dwell_s: 4.0 }, Phase { edges: both, dwell_s: 0.5 }]);
        let mut setup = masses(exchange, 1, schedule, vec![Delay::constant(0.0)]);
        setup.agents.truncate(2);
        setup.network.agents = 2;
        setup.agents[0].roots_per_s = vec![4.0].into();
        setup.agents[1].roots_per_s = vec![0.2].into();
        setup.time = TimeSpan { end_s: 54.0, record_every_s: 4.5, record_at: forwardstep_sim::RecordAt::Intervals };
        setup
    };
    let disagreement = |setup: &Setup| -> Vec<f64> {
        let outcome = run(setup);
        let (a, b) = (column(&outcome, 0, Signal::Position, 0), column(&outcome, 1, Signal::Position, 0));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect()
    };

    let bad = diverging(Exchange::PositionVelocity);
    let gap = disagreement(&bad);
    let growth = gap[gap.len() - 1] / gap[gap.len() - 2];
    assert!((growth - 3.8).abs() < 0.1, "grows {growth}× per period");
    let report = check(&bad);
    assert_eq!(report.worst(), Answer::NotCovered);
    let witness = report.hypotheses.iter().find(|h| h.answer() == Answer::NotCovered).unwrap();
    assert!(witness.because().contains("arm-1 has κ₀ = 4 and arm-2 has κ₀ = 0.2"), "{}", witness.because());

    let good = diverging(Exchange::Position);
    let gap = disagreement(&good);
    assert!(gap[gap.len() - 1] < 1e-2 * gap[0]);
    assert_eq!(check(&good).worst(), Answer::Holds);
}

#[test]
fn thm2_hypotheses_hold_with_a_certificate_or_fail_with_a_witness() {
    let agents = || (0..4).map(|i| arm(i, &[1.0, 2.0])).collect::<Vec<_>>();
    let phase = |from, to| Phase { edges: vec![edge(from, to, 1.0, 0)], dwell_s: 1.5 };
    let delays = vec![Delay::constant(0.1)];
    let joint = Schedule::periodic(vec![phase(0, 1), phase(1, 2), phase(2, 3)]);
    let report = check(&setup(agents(), Exchange::PositionVelocity, joint, delays.clone(), 1.0));
    assert_eq!(report.worst(), Answer::Holds);
    assert!(report.theorem.to_string().starts_with("Theorem 2"));
    assert!(report.hypotheses[0].because().contains("lasts 4.5 s"), "{}", report.hypotheses[0].because());

    let split = Schedule::periodic(vec![phase(0, 1), phase(2, 3)]);
    let report = check(&setup(agents(), Exchange::PositionVelocity, split, delays.clone(), 1.0));
    assert_eq!(report.worst(), Answer::Violated);
    let because = report.hypotheses[0].because();
    assert!(because.contains("[arm-1] and [arm-3] hear no agent outside themselves"), "{because}");

    let graphs = vec![vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0)], vec![edge(2, 3, 1.0, 0)]];
    let random = Schedule::random(graphs, [0.1, 0.2], 1);
    let report = check(&setup(agents(), Exchange::Position, random, delays, 30.0));
    assert_eq!(report.worst(), Answer::HoldsOnHorizon);
}
