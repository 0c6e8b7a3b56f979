//! Predictions by simulating the reference dynamics alone, against runs of robots.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::prediction::{CascadeSpread, NoCascade, PeakTorque, Settled, Unfinished, settled};
use forwardstep_check::{Course, NoCourse, NoIdeal, course, ideal, predict};
use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, RandomHold, SawTooth};
use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral, Tracking};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Adaptive, AgentSetup, ChainModel, Control, Exchange, Known, Outcome, Progress, RecordAt, Setup, Signal, Start,
};

use crate::common::kinds::{blind_mass, cascade, chain, rest_at, tracking};
use crate::common::{arm, column, edge, masses, noise, run, setup};

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

pub(crate) fn predicted(setup: &Setup) -> Course {
    course(setup, &mut go_on).unwrap()
}

fn saw() -> Delay {
    Delay::new(SawTooth { min_s: 0.0, max_s: 0.3, period_s: 0.7, offset_s: 0.1 })
}

/// Four arms with known parameters, at rest or in motion, over a graph that switches, with delays that vary.
fn arms(exchange: Exchange, order: usize) -> Setup {
    let agents = (0..4).map(|i| {
        let mut agent = arm(i, &(0..order).map(|r| 1.0 + 0.5 * r as f64).collect::<Vec<_>>());
        agent.law = Arc::new(Known { damping: Gain::Number(8.0) });
        agent
    });
    let phase = |edges: &[(usize, usize, usize)], dwell_s| Phase {
        edges: edges.iter().map(|&(from, to, delay)| edge(from, to, 1.5, delay)).collect(),
        dwell_s,
    };
    let schedule = Schedule::periodic(vec![
        phase(&[(0, 1, 0), (2, 3, 1)], 0.4),
        phase(&[(1, 2, 1), (3, 0, 0)], 0.3),
        phase(&[(0, 2, 0)], 0.2),
    ]);
    let drawn = RandomHold::draw(5, (0, 1), [0.0, 0.4], [0.1, 0.3], 60.0).unwrap();
    let mut setup = setup(agents.collect(), exchange, schedule, vec![saw(), Delay::new(drawn)], 60.0);
    setup.time.record_every_s = 0.02;
    setup
}

/// max |q_i − q_j| of a run, row by row.
fn disagreement(outcome: &Outcome, agents: usize, axes: usize) -> Vec<f64> {
    let rows = outcome.recording.t_s.len();
    let apart = |row: usize, axis: usize| {
        let q = || (0..agents).map(|agent| column(outcome, agent, Signal::Position, axis)[row]);
        q().fold(f64::NEG_INFINITY, f64::max) - q().fold(f64::INFINITY, f64::min)
    };
    (0..rows).map(|row| (0..axes).map(|axis| apart(row, axis)).fold(0.0, f64::max)).collect()
}

#[test]
fn regress_what_a_run_could_not_record_is_predicted_with_fewer_rows() {
    let mut setup = arms(Exchange::Position, 1);
    setup.time.end_s = 20.0;
    let usual = predicted(&setup);
    setup.time.record_every_s = 1e-6;
    assert!(forwardstep_sim::check_recording(&setup).is_err());
    let fewer = predicted(&setup);
    assert!((1e4..2e6).contains(&(fewer.t_s.len() as f64)), "{} rows", fewer.t_s.len());
    let (at, usual) = (fewer.settled.time_s().unwrap(), usual.settled.time_s().unwrap());
    assert!((at - usual).abs() < 1e-3 * usual, "{at} and {usual}");
}

/// What (3) and (23) integrate over weights that change is not the law: the interval of all cascaded variables can grow.
#[test]
fn regress_3_and_23_have_no_interval_over_links_that_change() {
    let mut setup = arms(Exchange::Position, 2);
    setup.time.end_s = 5.0;
    setup.reference = Arc::new(PureIntegral);
    assert_eq!(predicted(&setup).within, Err(NoCascade::PureIntegral));
    setup.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.0, 0), edge(1, 2, 1.0, 0), edge(2, 3, 1.0, 0)]);
    assert!(predicted(&setup).within.is_ok());
}

#[test]
fn who_follows_exactly_never_has_a_tracking_error() {
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=4 {
            let mut setup = arms(exchange, order);
            // It need not start so.
            setup.agents[1].start.reference = vec![vec![0.4, -0.3]];
            setup.time.end_s = 5.0;
            let outcome = run(&ideal(&setup).unwrap());
            let errors = outcome.recording.columns.iter().filter(|column| column.signal == Signal::TrackingError);
            let largest = errors.flat_map(|column| &column.values).fold(0.0_f64, |most, s| most.max(s.abs()));
            assert!(largest < 1e-13, "{exchange:?} of order {order}: {largest:e}");
        }
    }
}

#[test]
fn with_known_parameters_the_prediction_is_the_run() {
    for (exchange, order) in [
        (Exchange::Position, 1),
        (Exchange::Position, 3),
        (Exchange::PositionVelocity, 1),
        (Exchange::PositionVelocity, 2),
    ] {
        let setup = arms(exchange, order);
        let (predicted, outcome) = (predicted(&setup), run(&setup));
        let observed = disagreement(&outcome, 4, 2);
        assert_eq!(predicted.t_s, outcome.recording.t_s);
        let away = predicted.disagreement.iter().zip(&observed).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(away < 1e-6, "{exchange:?} of order {order}: {away:e}");
        let (Settled::At(predicted_s), Settled::At(observed_s)) =
            (predicted.settled, settled(&outcome.recording.t_s, &observed))
        else {
            panic!("{exchange:?} of order {order} settles")
        };
        assert!((predicted_s / observed_s - 1.0).abs() < 0.01, "{predicted_s} s, {observed_s} s");
        for axis in 0..2 {
            let [low, high] = predicted.within.as_ref().unwrap()[axis];
            let last = *column(&outcome, 2, Signal::Position, axis).last().unwrap();
            assert!(low - 1e-6 <= last && last <= high + 1e-6 && high - low < 0.1, "{low} {last} {high}");
            assert!((predicted.value[axis] - last).abs() < 0.05);
        }
        assert!(predicted.is_reached());
    }
}

#[test]
fn the_value_agreed_upon_is_the_conserved_one_where_there_is_one() {
    for (integral, exchange, z) in [
        (false, Exchange::Position, Some([0.7, -0.5])),
        (false, Exchange::PositionVelocity, None),
        (true, Exchange::Position, Some([0.7, -0.5])),
        (true, Exchange::PositionVelocity, Some([0.7, -0.5])),
    ] {
        let mut setup = arms(exchange, 2);
        if integral {
            setup.reference = Arc::new(PureIntegral);
        }
        let ring: Vec<_> = (0..4).map(|i| edge(i, (i + 1) % 4, 1.0 + 0.1 * i as f64, i % 2)).collect();
        setup.network.schedule = Schedule::fixed(ring);
        setup.network.delays = vec![Delay::constant(0.2), Delay::constant(0.35)];
        setup.time.end_s = 150.0;
        // Neither z(0) nor ż(0) is what follows from q̇(0).
        if let Some(z) = z {
            setup.agents[2].start.reference = vec![z.to_vec(), vec![0.2, 0.1]];
        }
        let (predicted, conserved) = (predicted(&setup), predict(&setup).unwrap().value);
        for axis in 0..2 {
            assert!((predicted.value[axis] - conserved[axis]).abs() < 1e-6, "{:?} {conserved:?}", predicted.value);
            let [low, high] = predicted.within.as_ref().unwrap()[axis];
            assert!(low - 1e-7 <= conserved[axis] && conserved[axis] <= high + 1e-7);
        }
    }
}

#[test]
fn a_chain_of_any_order_follows_the_same_reference() {
    let zero = || Expression::number(0.0);
    let third = Formulas::new(3, &zero(), Vec::new(), &Expression::number(1.0)).unwrap();
    let starts = [(2, [0.3, 0.5, 0.0]), (3, [-1.0, 0.2, 0.4])];
    let agents = starts.iter().enumerate().map(|(i, (order, x))| {
        let mut agent = chain(&Expression::number(2.0), 0, false);
        if *order == 3 {
            agent.robot.kind = Arc::new(ChainModel::Derivatives(Arc::new(third.clone())));
        }
        agent.start = Start { q: vec![x[0]], dq: vec![x[1]], rest: x[2..*order].to_vec(), reference: Vec::new() };
        agent.roots_per_s = vec![1.0, 2.0, 1.5].into();
        agent.name = format!("chain-{i}");
        agent
    });
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 0.7, 0)];
    let setup = setup(agents.collect(), Exchange::Position, Schedule::fixed(edges), vec![Delay::constant(0.3)], 10.0);
    let (followed, outcome) = (ideal(&setup).unwrap(), run(&setup));
    let alone = run(&followed);
    for agent in 0..2 {
        let [q, reference] = [&outcome, &alone].map(|outcome| column(outcome, agent, Signal::Position, 0));
        let away = q.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(away < 1e-7 && (q[0] - q[q.len() - 1]).abs() > 0.05, "{away:e}");
    }
    // A given z replaces what it follows, and in feedback form it follows the position.
    let mut given = setup.clone();
    given.agents[1].start.reference = vec![vec![0.9], vec![0.1]];
    let start = &ideal(&given).unwrap().agents[1].start;
    assert_eq!((&start.q[..], &start.dq[..]), (&[-1.0][..], &[0.2][..]));
    assert_eq!(start.reference, [[0.2], [0.9], [0.1]]);
    given.agents[1] = cascade(Expression::variable(1), Expression::number(1.0), 1);
    given.agents[1].start.reference = vec![vec![0.9], vec![0.1]];
    let start = &ideal(&given).unwrap().agents[1].start;
    assert_eq!((&start.q[..], &start.dq[..], &start.reference[..]), (&[0.9][..], &[0.1][..], &[vec![0.1]][..]));
    // Without a velocity z(0) is zero, whatever the velocity is.
    given.agents[1] = blind_mass(1.0, 1.0);
    given.agents[1].start.dq = vec![0.6];
    assert_eq!(ideal(&given).unwrap().agents[1].start.dq, [0.0]);
}

#[test]
fn every_reason_for_no_course_is_the_one_that_is_said() {
    let said = |change: &dyn Fn(&mut Setup)| {
        let mut setup = arms(Exchange::Position, 2);
        setup.time.end_s = 1.0;
        change(&mut setup);
        course(&setup, &mut go_on).err()
    };
    let no = |reason: NoIdeal| Some(NoCourse::Ideal(reason));
    assert_eq!(said(&|_| {}), None);
    let backstepping = Arc::new(Backstepping { filter_s: 0.1, acceleration_limit: None });
    assert_eq!(said(&|setup| setup.reference = backstepping.clone()), no(NoIdeal::Backstepping));
    assert_eq!(said(&|setup| setup.reference = Arc::new(Tracking)), no(NoIdeal::Targets));
    let spacecraft = crate::common::kinds::spacecraft();
    assert_eq!(said(&|setup| setup.agents[2].law = spacecraft.law.clone()), no(NoIdeal::Law { agent: 2 }));
    let offset = tracking(arm(0, &[1.0]), vec![rest_at(0.2), rest_at(0.1)]).agents[0].target.clone();
    assert_eq!(said(&|setup| setup.agents[1].target = offset.clone()), no(NoIdeal::Offset { agent: 1 }));
    assert_eq!(said(&|setup| setup.agents[3].start.reference = vec![vec![0.0]]), no(NoIdeal::Start { agent: 3 }));
    assert_eq!(
        said(&|setup| setup.agents[3].start.reference = vec![vec![0.0; 2]; 3]),
        no(NoIdeal::Start { agent: 3 }),
        "order two has no z̈(0)"
    );
    let unfit = |found: Option<NoCourse>| matches!(found, Some(NoCourse::Ideal(NoIdeal::Setup(_))));
    assert!(unfit(said(&|setup| setup.agents[3].start.dq.clear())));
    assert!(matches!(
        said(&|setup| setup.agents[0].roots_per_s.real[1] = -1.0),
        Some(NoCourse::Unfinished(Unfinished::Setup(_)))
    ));
    let alone = |setup: &mut Setup| {
        setup.agents.truncate(1);
        (setup.network.agents, setup.network.schedule) = (1, Schedule::fixed(Vec::new()));
    };
    assert_eq!(said(&alone), Some(NoCourse::FewerThanTwoAgents));
    let one = |setup: &mut Setup| setup.agents[1] = blind_mass(1.0, 1.0);
    assert!(matches!(said(&one), Some(NoCourse::Unfinished(Unfinished::Setup(_)))), "it has one axis");
    let stop = course(&arms(Exchange::Position, 1), &mut |_| ControlFlow::Break(()));
    assert_eq!(stop, Err(NoCourse::Unfinished(Unfinished::Interrupted)));
}

#[test]
fn regress_what_settles_and_peaks_between_two_rows_is_that_of_many() {
    let many = arms(Exchange::PositionVelocity, 2);
    let mut few = many.clone();
    few.time.record_every_s = 25.0;
    let (many, few) = (predicted(&many), predicted(&few));
    assert_eq!(few.t_s, [0.0, 25.0, 50.0, 60.0]);
    for (t_s, disagreement) in few.t_s.iter().zip(&few.disagreement) {
        let row = many.t_s.iter().position(|many_s| (many_s - t_s).abs() < 1e-6).unwrap();
        assert!((many.disagreement[row] - disagreement).abs() < 1e-9, "{t_s}: {disagreement}");
    }
    let [settled, known] = [&few, &many].map(|course| course.settled.time_s().unwrap());
    assert!((settled - known).abs() < 0.01 * known, "{settled} {known}");
    for (peak, known) in few.peak_torques.iter().zip(&many.peak_torques) {
        assert!((peak.value - known.value).abs() < 0.01 * known.value, "{peak:?} {known:?}");
    }
}

/// A run of 400 s with two rows a second peaks within its first tenth of a second.
#[test]
fn regress_what_peaks_at_once_is_found_however_long_the_run_is() {
    let edges = vec![edge(0, 1, 20.0, 0), edge(1, 0, 20.0, 0)];
    let mut setup = masses(Exchange::Position, 2, Schedule::fixed(edges), vec![Delay::constant(0.3)]);
    setup.agents.truncate(2);
    setup.network.agents = 2;
    setup.agents.iter_mut().for_each(|agent| agent.roots_per_s = vec![6.0, 8.0].into());
    let with = |setup: &Setup, end_s, record_every_s| {
        let mut setup = setup.clone();
        (setup.time.end_s, setup.time.record_every_s) = (end_s, record_every_s);
        predicted(&setup)
    };
    let (long, close) = (with(&setup, 400.0, 0.5), with(&setup, 5.0, 0.0005));
    assert_eq!((long.t_s.len(), long.t_s[1]), (801, 0.5));
    for (peak, known) in long.peak_torques.iter().zip(&close.peak_torques) {
        assert!((peak.value / known.value - 1.0).abs() < 3e-4 && known.t_s < 0.2, "{peak:?} {known:?}");
        assert!(peak.at_most.unwrap() > known.value.abs() * (1.0 - 3e-4), "{peak:?} {known:?}");
    }
    // Whenever the run has rows.
    for record_at in [RecordAt::Rate { hz: 2.0 }, RecordAt::Times(vec![1.0, 1.5, 3.0].into())] {
        let mut setup = setup.clone();
        (setup.time.end_s, setup.time.record_every_s, setup.time.record_at) = (5.0, 0.5, record_at);
        let (found, run) = (predicted(&setup), run(&setup));
        assert!(found.t_s.len() == run.recording.t_s.len() && found.t_s.len() == found.disagreement.len());
        assert!(found.t_s.iter().zip(&run.recording.t_s).all(|(a, b)| (a - b).abs() < 1e-12), "{:?}", found.t_s);
        for (peak, known) in found.peak_torques.iter().zip(&close.peak_torques) {
            assert!((peak.value / known.value - 1.0).abs() < 3e-4 && peak.at_most.is_some(), "{peak:?} {known:?}");
        }
    }
    // With an estimate that is off, what is added where the torque is largest counts, too, however few the rows are at which that is computed.
    let mut off = setup.clone();
    for agent in &mut off.agents {
        let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(10.0));
        agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![0.5], bounds: None });
    }
    let (long, close) = (with(&off, 400.0, 0.5), with(&off, 5.0, 0.0005));
    for (peak, known) in long.peak_torques.iter().zip(&close.peak_torques) {
        let [most, known_most] = [peak, known].map(|peak| peak.at_most.unwrap());
        assert!(known_most > 1.05 * known.value.abs() && most > 0.999 * known_most, "{peak:?} {known:?}");
    }
    // With so many agents there is no room for rows that are close: what lies between them is not bounded.
    setup.agents = (0..200).flat_map(|_| setup.agents.clone()).collect();
    setup.network.agents = 400;
    let crowd = with(&setup, 400.0, 0.5);
    assert!(crowd.peak_torques.len() == 800 && crowd.peak_torques.iter().all(|peak| peak.at_most.is_none()));
}

#[test]
fn what_has_no_effect_while_everybody_follows_is_left_out() {
    let plain = arms(Exchange::Position, 2);
    let mut busy = plain.clone();
    for agent in &mut busy.agents {
        agent.manipulability = 0.7;
        enforce_limits(agent);
    }
    busy.control = Some(Control {
        failures: Default::default(),
        sample_hz: 100.0,
        computation_delay_s: 0.0,
        sensors: Default::default(),
        actuators: Default::default(),
    });
    let (mut plain, busy) = (predicted(&plain), predicted(&busy));
    // What is commanded may then be another, so that V may grow.
    assert!(busy.peak_torques.iter().all(|peak| peak.at_most.is_none()));
    plain.peak_torques.iter_mut().for_each(|peak| assert!(peak.at_most.take().is_some()));
    // Sampling leaves some of s, and the graph switches.
    assert!(busy.moved_by_s && !plain.moved_by_s);
    plain.moved_by_s = true;
    assert!(busy == plain);
}

#[test]
fn cascaded_variables_have_an_interval_only_where_messages_are_weighted_means() {
    let said = |change: &dyn Fn(&mut Setup)| {
        let mut setup = arms(Exchange::PositionVelocity, 2);
        setup.time.end_s = 0.1;
        let outcome = run(&setup);
        change(&mut setup);
        CascadeSpread::of(&setup, &outcome.recording).err()
    };
    assert_eq!(said(&|_| {}), None);
    assert_eq!(said(&|setup| setup.network.coupling = Coupling::Tanh { scale: 1.0 }), Some(NoCascade::Coupling));
    assert_eq!(said(&|setup| setup.reference = Arc::new(Tracking)), Some(NoCascade::Reference));
    assert_eq!(said(&|setup| setup.agents[2].law = blind_mass(1.0, 1.0).law), Some(NoCascade::Law { agent: 2 }));
    assert_eq!(said(&|setup| setup.agents[1] = blind_mass(1.0, 1.0)), Some(NoCascade::Law { agent: 1 }));
    assert_eq!(said(&|setup| setup.agents[1].roots_per_s.real.extend([1.0; 3])), Some(NoCascade::NotRecorded));
    let larger = |setup: &mut Setup| setup.agents[0].roots_per_s.real[0] = 1.1;
    assert_eq!(said(&larger), Some(NoCascade::FirstRoots { from: 0, to: 1 }));
    let position = |setup: &mut Setup| {
        larger(setup);
        setup.exchange = Exchange::Position;
    };
    assert_eq!(said(&position), None);
    let axis = |setup: &mut Setup| {
        setup.agents[1].robot.axes.pop();
    };
    assert_eq!(said(&axis), Some(NoCascade::Axes));
}

#[test]
fn whoever_hears_a_smaller_first_root_stays_within_the_interval() {
    // Along a path, agent by agent, κ₀ⱼ ≤ κ₀ᵢ.
    let mut setup = arms(Exchange::PositionVelocity, 2);
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        agent.roots_per_s.real[0] = 1.0 + 0.4 * i as f64;
        agent.start.dq = vec![2.0 * noise(i), -noise(i + 3)];
    }
    let path = (0..3).map(|i| edge(i, i + 1, 1.5, 0)).collect();
    (setup.network.schedule, setup.network.delays) = (Schedule::fixed(path), vec![saw()]);
    setup.time.record_every_s = 0.004;
    setup.reference = Arc::new(Consensus);
    let followed = ideal(&setup).unwrap();
    let widths = CascadeSpread::of(&followed, &run(&followed).recording).unwrap().widths();
    for pair in widths.windows(2) {
        assert!(pair[1] <= pair[0] + 1e-4 * widths[0], "{} → {}", pair[0], pair[1]);
    }
    assert!(widths[widths.len() - 1] < 0.01 * widths[0]);
}

/// The largest |τ| of an axis of a run.
fn observed_peak(outcome: &Outcome, agent: usize, axis: usize) -> f64 {
    column(outcome, agent, Signal::Torque, axis).iter().fold(0.0, |peak, torque| torque.abs().max(peak))
}

#[test]
fn peak_torques_are_those_of_the_reference_where_parameters_are_known_or_nearly_so() {
    let mut setup = arms(Exchange::Position, 2);
    let outcome = run(&setup);
    let peaks = predicted(&setup).peak_torques;
    assert_eq!(
        peaks.iter().map(|peak| (peak.agent, peak.axis)).collect::<Vec<_>>(),
        [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1), (3, 0), (3, 1)]
    );
    for peak in &peaks {
        let observed = observed_peak(&outcome, peak.agent, peak.axis);
        assert!((peak.value.abs() / observed - 1.0).abs() < 1e-6, "{peak:?}, not {observed}");
        let row = (peak.t_s / setup.time.record_every_s).round() as usize;
        assert!((column(&outcome, peak.agent, Signal::Torque, peak.axis)[row] - peak.value).abs() < 1e-5);
        assert_eq!(peak.estimate_off, 0.0);
        // Nothing feeds V, which is zero.
        assert!((peak.at_most.unwrap() / peak.value.abs() - 1.0).abs() < 1e-9 && peak.is_practical(), "{peak:?}");
    }
    for agent in &mut setup.agents {
        let estimate_start = agent.robot.theta.iter().map(|theta| 0.95 * theta).collect();
        let (damping, adaptation) = (Gain::Number(8.0), Gain::Number(1.0));
        agent.law = Arc::new(Adaptive { damping, adaptation, estimate_start, bounds: None });
    }
    let outcome = run(&setup);
    for peak in predicted(&setup).peak_torques {
        let observed = observed_peak(&outcome, peak.agent, peak.axis);
        assert!((peak.value.abs() / observed - 1.0).abs() < 0.06, "{peak:?}, not {observed}");
        assert!((peak.estimate_off - 0.05).abs() < 1e-12);
    }
    setup.agents = setup.agents.iter().map(|_| blind_mass(1.0, 1.0)).collect();
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        agent.start.q[0] = noise(i);
    }
    assert_eq!(predicted(&setup).peak_torques, [], "the torque of another law is not that of (6)");
}

/// Limits that nothing reaches.
fn enforce_limits(agent: &mut AgentSetup) {
    agent.enforce_limits = true;
    agent.robot.axes.iter_mut().for_each(|axis| axis.effort_limit = Some(1e9));
}

#[test]
fn eq_what_v_can_add_to_a_torque_is_that_of_its_norm() {
    // |Y ϑ| = m |ż| of a mass is zero while nobody hears anything and rests.
    let mut setup = super::three(Exchange::Position);
    setup.network.schedule = Schedule::fixed(Vec::new());
    for agent in &mut setup.agents {
        agent.robot.theta = vec![3.0];
        (agent.start.q, agent.start.dq) = (vec![0.0; 2], vec![0.0; 2]);
    }
    // Γ adds Y Γ Yᵀ = γ ż² and ½ Δm²/γ: where ż is zero, |Δm|/√γ K/√m.
    let (damping, adaptation) = (Gain::Number(5.0), Gain::Number(2.0));
    setup.agents[1].law = Arc::new(Adaptive { damping, adaptation, estimate_start: vec![2.0], bounds: None });
    let expected = (1.0 / 2.0_f64).sqrt() * 5.0 / 3.0_f64.sqrt();
    let peaks = predicted(&setup).peak_torques;
    let found = peaks.iter().find(|peak| peak.agent == 1).unwrap();
    assert!((found.at_most.unwrap() - expected).abs() < 1e-9 && !found.is_practical(), "{found:?} {expected}");
    assert!(peaks[0].at_most.unwrap() < 1e-12, "{peaks:?}");
    let mut moving = setup.clone();
    moving.agents[1].start.dq = vec![0.2, 0.0];
    moving.agents[1].roots_per_s = [2.0].into();
    let peaks = predicted(&moving).peak_torques;
    let found = peaks.iter().find(|peak| peak.agent == 1).unwrap();
    assert!((found.value + 1.2).abs() < 1e-6 && (found.estimate_off - 1.0 / 3.0).abs() < 1e-12, "{found:?}");
    // Twice what is predicted, of whatever sign, is practical still; an estimate that is right is off by nothing.
    let is_practical = |at_most: f64| PeakTorque { value: -1.2, at_most: Some(at_most), ..*found }.is_practical();
    assert_eq!([2.4, 2.5].map(is_practical), [true, false]);
    moving.agents[1].change_law(|law: &mut Adaptive| law.estimate_start = vec![3.0]);
    assert!(predicted(&moving).peak_torques.iter().all(|peak| peak.estimate_off == 0.0));
    // What may feed V takes the bound away: limits from the one that has them, a push from all.
    enforce_limits(&mut setup.agents[1]);
    let without: Vec<usize> =
        predicted(&setup).peak_torques.iter().filter(|peak| peak.at_most.is_none()).map(|peak| peak.agent).collect();
    assert_eq!(without, [1, 1]);
    setup.agents[0].pushes = vec![super::pushed_for_ever(1.0)];
    assert!(predicted(&setup).peak_torques.iter().all(|peak| peak.at_most.is_none()));
}

#[test]
fn val_no_run_exceeds_what_v_allows_near_its_reference() {
    let mut largest = 0.0_f64;
    for (case, off) in [0.0, 0.05, 0.3, 1.0].into_iter().enumerate() {
        for family in 0..3 {
            let exchange = [Exchange::Position, Exchange::PositionVelocity][(case + family) % 2];
            let mut setup = arms(exchange, 2);
            for (i, agent) in setup.agents.iter_mut().enumerate() {
                if family == 1 {
                    agent.robot.kind = Arc::new(forwardstep_core::robot::PointMass { dimension: 2 });
                    (agent.robot.theta, agent.robot.theta_names) = (vec![1.5 + i as f64], vec!["mass".into()]);
                }
                let estimate_start = agent.robot.theta.iter().map(|theta| (1.0 - off) * theta).collect();
                let (damping, adaptation) = (Gain::Number(6.0), Gain::Number(4.0));
                let known = Gain::Matrix(vec![7.0, 1.0, 1.0, 4.0]);
                agent.law = if family == 2 {
                    Arc::new(Known { damping: known })
                } else {
                    Arc::new(Adaptive { damping, adaptation, estimate_start, bounds: None })
                };
            }
            let outcome = run(&setup);
            for peak in predicted(&setup).peak_torques {
                let (observed, at_most) = (observed_peak(&outcome, peak.agent, peak.axis), peak.at_most.unwrap());
                assert!(observed <= at_most * (1.0 + 1e-6), "{case} {family}: {observed} {peak:?}");
                largest = largest.max(observed / at_most);
            }
        }
    }
    assert!(largest > 0.9, "{largest}");
}
