//! When the value agreed upon is known before the run, and every reason why it is not.

mod course;
mod gains;
mod guaranteed;
mod inputs_smoothness;
mod loads;
mod own_smoothness;
mod rate;
mod rubbing;
mod smoothness;
mod start;
mod vehicles;
mod whole_loop;

use forwardstep_sim::reference::{Backstepping, Consensus, PureIntegral, Tracking};
use std::sync::Arc;

use crate::common::kinds::{alone, blind_mass, chain};
use crate::common::{arm, column, edge, masses, run, setup};
use forwardstep_check::{
    Finding, NoPrediction, NotFixed, PowerBound, SamplingMargin, along, mean_power_w, practical, predict,
};
use forwardstep_core::Gain;
use forwardstep_core::agent::VelocityFilter;
use forwardstep_core::expression::Expression;
use forwardstep_sim::coupling::Coupling;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::push::{Between, Course, Effect, Function, Push, Table};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{Adaptive, Control, Exchange, Known, Outcome, Setup, Signal, VelocitySensor};

/// Two masses that hear each other, and a third that only listens.
fn three(exchange: Exchange) -> Setup {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 2.0, 1), edge(1, 2, 1.5, 0)];
    let delays = vec![Delay::constant(0.2), Delay::constant(0.0)];
    let mut setup = masses(exchange, 2, Schedule::fixed(edges), delays);
    setup.agents.truncate(3);
    setup.network.agents = 3;
    setup.time.end_s = 60.0;
    setup.time.record_every_s = 1.0;
    setup
}

fn pushed_for_ever(value: f64) -> Push {
    let course = Course::Each(vec![Function::Constant(value), Function::Constant(0.0)]);
    Push { effect: Effect::Torque(course), from_s: 1.0, until_s: f64::INFINITY }
}

fn ends(setup: &Setup, agent: usize, axis: usize) -> f64 {
    *column(&run(setup), agent, Signal::Position, axis).last().unwrap()
}

#[test]
fn eq_3_and_23_keep_their_value_whoever_pushes_for_ever() {
    // No z is in what they conserve, so a tracking error that stays does not count.
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        let mut setup = three(exchange);
        setup.reference = Arc::new(PureIntegral);
        let untouched = predict(&setup).unwrap();
        setup.agents[0].pushes = vec![pushed_for_ever(2.0)];
        assert_eq!(predict(&setup).unwrap(), untouched);
        for axis in 0..2 {
            assert!((ends(&setup, 1, axis) - untouched.value[axis]).abs() < 1e-6, "{exchange:?}");
        }
        // With λ the integral of s counts, which has no end.
        setup.agents[0].manipulability = 0.5;
        assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 0 }));
        setup.agents[0].manipulability = 0.0;
        setup.reference = Arc::new(Consensus);
        assert_eq!(predict(&setup), Err(NoPrediction::PushedForEver { agent: 0 }));
    }
}

#[test]
fn who_is_heard_by_nobody_counts_for_nothing() {
    let mut setup = three(Exchange::Position);
    let untouched = predict(&setup).unwrap();
    assert_eq!(untouched.influence[2], 0.0);
    setup.agents[2].pushes = vec![pushed_for_ever(3.0)];
    setup.agents[2].manipulability = 1.0;
    setup.agents[2].law = Arc::new(Adaptive {
        damping: Gain::Number(5.0),
        adaptation: Gain::Number(1.0),
        estimate_start: vec![0.0],
        bounds: None,
    });
    assert_eq!(predict(&setup).unwrap(), untouched);
    assert!((ends(&setup, 0, 0) - untouched.value[0]).abs() < 1e-6);
    // Who is heard counts.
    setup.agents.swap(1, 2);
    assert!(matches!(predict(&setup), Err(NoPrediction::PushedForEver { agent: 1 })));
    setup.agents[1].pushes.clear();
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
}

#[test]
fn every_reason_for_which_there_is_none_is_the_one_that_is_said() {
    let said = |change: &dyn Fn(&mut Setup)| {
        let mut setup = three(Exchange::Position);
        change(&mut setup);
        predict(&setup).err()
    };
    assert_eq!(said(&|_| {}), None);
    let backstepping = Arc::new(Backstepping { filter_s: 0.1, acceleration_limit: None });
    assert_eq!(said(&|setup| setup.reference = backstepping.clone()), Some(NoPrediction::Backstepping));
    assert_eq!(said(&|setup| setup.reference = Arc::new(Tracking)), Some(NoPrediction::Targets));
    let blind = || {
        let mut agent = blind_mass(1.0, 1.0);
        agent.roots_per_s = vec![1.0, 2.0].into();
        agent
    };
    assert_eq!(said(&|setup| setup.agents[2].law = blind().law), Some(NoPrediction::Law), "one is enough");
    assert_eq!(predict(&alone(blind())).err(), Some(NoPrediction::Law));
    // A chain of derivatives has one under its own law alone.
    let mut chained = alone(chain(&Expression::number(1.0), 1, true));
    assert_eq!(predict(&chained).err(), None);
    chained.agents[0].law = blind().law;
    assert_eq!(predict(&chained).err(), Some(NoPrediction::Law));
    let tanh = Coupling::Tanh { scale: 1.0 };
    assert_eq!(said(&|setup| setup.network.coupling = tanh), Some(NoPrediction::NotFixed(NotFixed::Coupling)));
    let control = Control {
        failures: Default::default(),
        sample_hz: 100.0,
        computation_delay_s: 0.0,
        sensors: Default::default(),
        actuators: Default::default(),
    };
    assert_eq!(said(&|setup| setup.control = Some(control.clone())), Some(NoPrediction::Sampled));
    let saw = Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 1.0, offset_s: 0.0 });
    for delay in [0, 1] {
        assert_eq!(
            said(&|setup| setup.network.delays[delay] = saw.clone()),
            Some(NoPrediction::NotFixed(NotFixed::VaryingDelay))
        );
    }
    // A delay that no edge has changes nothing.
    assert_eq!(said(&|setup| setup.network.delays.push(saw.clone())), None);
    let swing = Expression::variable(0).sin_of() * 0.5 + 1.0;
    let varying = |setup: &mut Setup| {
        setup.network.weights = vec![BoundedFormula::new(swing.clone(), 60.0)];
        let edges = &mut setup.network.schedule.graphs[0];
        edges[1].weight = Weight::Formula(0);
    };
    assert_eq!(said(&varying), Some(NoPrediction::NotFixed(NotFixed::VaryingWeight)));
    let one_way = Schedule::fixed(vec![edge(0, 1, 1.0, 0)]);
    assert_eq!(
        said(&|setup| setup.network.schedule = one_way.clone()),
        Some(NoPrediction::NoSpanningTree { closed_groups: 2 })
    );
    assert_eq!(
        said(&|setup| setup.agents[1].roots_per_s = vec![1.0, 0.0].into()),
        Some(NoPrediction::Roots { agent: 1 })
    );
}

#[test]
fn a_schedule_of_one_phase_is_one_graph() {
    let base = three(Exchange::PositionVelocity);
    let edges = &base.network.schedule.graphs[0];
    let phase = Phase { edges: edges.clone(), dwell_s: 1.0 };
    let value = |schedule| {
        predict(&Setup { network: forwardstep_sim::Network { schedule, ..base.network.clone() }, ..base.clone() })
    };
    let fixed = predict(&base).unwrap();
    assert_eq!(value(Schedule::periodic(vec![phase.clone()])).unwrap(), fixed);
    assert_eq!(value(Schedule::once(vec![phase.clone()])).unwrap(), fixed);
    // The same twice is one graph as well, in whatever order its edges stand.
    let mut turned = phase.clone();
    turned.edges.reverse();
    for two in [Schedule::periodic(vec![phase.clone(); 2]), Schedule::once(vec![phase.clone(), turned])] {
        assert_eq!(value(two).unwrap(), fixed);
    }
    let mut heavier = phase.clone();
    heavier.edges[0].weight = 3.0.into();
    assert_eq!(
        value(Schedule::periodic(vec![phase, heavier])).err(),
        Some(NoPrediction::NotFixed(NotFixed::Switching))
    );
}

/// K of every kind, for masses that start with a tracking error.
#[test]
fn eq_31_the_agreement_moves_by_the_gain_of_each_axis() {
    for damping in [Gain::Number(3.0), Gain::Diagonal(vec![2.0, 5.0]), Gain::Bandwidth(1.5)] {
        let mut setup = three(Exchange::Position);
        setup.agents[1].law = Arc::new(Known { damping: damping.clone() });
        setup.agents[1].manipulability = 0.8;
        setup.agents[1].start.reference = vec![vec![-0.4, 0.9]];
        let after = predict(&setup).unwrap();
        let outcome = run(&setup);
        for axis in 0..2 {
            for agent in 0..3 {
                let q = *column(&outcome, agent, Signal::Position, axis).last().unwrap();
                assert!((q - after.value[axis]).abs() < 1e-6, "{damping:?}: {q} and {}", after.value[axis]);
            }
        }
    }
    // What a full matrix does to the other axis is not worked out, nor what a limit takes away.
    let mut setup = three(Exchange::Position);
    setup.agents[1].manipulability = 0.8;
    setup.agents[1].start.reference = vec![vec![-0.4, 0.9]];
    setup.agents[1].law = Arc::new(Known { damping: Gain::Matrix(vec![3.0, 0.5, 0.5, 4.0]) });
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
    setup.agents[1].law = Arc::new(Known { damping: Gain::Number(3.0) });
    assert!(predict(&setup).is_ok());
    setup.agents[1].enforce_limits = true;
    assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 1 }));
}

#[test]
fn a_single_agent_stays_where_its_own_dynamics_lead() {
    let mut one = three(Exchange::Position);
    one.agents.truncate(1);
    let mut one = setup(one.agents, Exchange::Position, Schedule::fixed(Vec::new()), Vec::new(), 40.0);
    one.time.record_every_s = 1.0;
    let value = predict(&one).unwrap();
    assert_eq!(value.influence, [1.0]);
    assert!((ends(&one, 0, 0) - value.value[0]).abs() < 1e-6);
}

/// Two arms that hear each other and adapt.
fn two_arms() -> Setup {
    let edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 2.0, 0)];
    let agents = (0..2).map(|index| arm(index, &[1.0, 2.0])).collect();
    let delays = vec![Delay::constant(0.2)];
    let mut setup = setup(agents, Exchange::PositionVelocity, Schedule::fixed(edges), delays, 20.0);
    setup.time.record_every_s = 0.02;
    setup
}

fn bound(setup: &Setup) -> Option<PowerBound> {
    practical(setup).findings.into_iter().find_map(|finding| match finding {
        Finding::TrackingPower(bound) => Some(bound),
        Finding::SamplingMargin(_)
        | Finding::WholeLoop(_)
        | Finding::StaticLoad(_)
        | Finding::ClippedCommands(_)
        | Finding::TrackingDisagreement(_) => None,
    })
}

fn pushed(functions: [Function; 2], from_s: f64, until_s: f64) -> Push {
    Push { effect: Effect::Torque(Course::Each(functions.to_vec())), from_s, until_s }
}

fn sine(amplitude: f64, rate_per_s: f64) -> Function {
    Function::Formula((Expression::variable(0) * rate_per_s).sin_of() * amplitude)
}

#[test]
fn what_feeds_the_mean_is_named_and_nothing_else() {
    let said = |setup: &Setup| Finding::TrackingPower(bound(setup).unwrap()).because();
    let push = || pushed([Function::Constant(2.0), Function::Constant(-1.0)], 0.0, f64::INFINITY);
    let mut setup = two_arms();
    setup.agents[1].pushes = vec![push()];
    let text = said(&setup);
    assert!(text.starts_with("the mean of Σ sᵀKs of 2 agents over 20 s is at most "), "{text}");
    assert!(text.ends_with(", pushes 0.625 W") && !text.contains("σ") && !text.contains("measurement"), "{text}");
    let text = said(&two_arms().sampled(500.0));
    assert!(text.contains(" is expected to be at most ") && text.contains(", with σ = "), "{text}");
    assert!(!text.contains("pushes") && !text.contains("measurement"), "{text}");
    let mut noisy = two_arms().sampled(500.0);
    noisy.control.as_mut().unwrap().sensors.velocity_noise = 0.01;
    assert!(said(&noisy).contains(", measurement errors "), "{}", said(&noisy));
}

#[test]
fn eq_the_power_balance_solves_its_quadratic() {
    for (drive_w, supply_w, start_w, sigma) in
        [(0.0, 0.0, 3.0, 0.0), (2.0, 0.0, 0.0, 0.0), (0.7, 0.3, 1.9, 0.0), (0.7, 0.3, 1.9, 0.6), (0.0, 1.0, 1.0, 0.5)]
    {
        let mean_w: f64 = mean_power_w(drive_w, supply_w, start_w, sigma);
        // (1 − σ) x² = x D + E + V(0)/T
        let fed = (mean_w * drive_w).sqrt() + supply_w + start_w;
        assert!(((1.0 - sigma) * mean_w - fed).abs() < 1e-12 * (1.0 + fed), "{drive_w} {sigma}: {mean_w}");
    }
    assert_eq!(mean_power_w(1.0, 0.0, 1.0, 1.0), f64::INFINITY);
}

#[test]
fn thm_no_mean_of_the_tracking_error_exceeds_its_power_bound() {
    assert_eq!(bound(&two_arms()), None, "nothing feeds V but its start");
    let strong = || [sine(4.0, 3.0), Function::Constant(-2.0)];
    for (pushes, sample_hz) in [
        (vec![pushed(strong(), 0.0, f64::INFINITY)], None),
        (vec![pushed(strong(), 0.0, f64::INFINITY), pushed([sine(1.0, 40.0), sine(-0.5, 0.4)], 3.0, 5.0)], None),
        (vec![pushed(strong(), 0.0, f64::INFINITY)], Some(400.0)),
        (Vec::new(), Some(150.0)),
    ] {
        let mut setup = two_arms();
        setup.agents[1].pushes = pushes;
        setup = if let Some(sample_hz) = sample_hz { setup.sampled(sample_hz) } else { setup };
        let (before, outcome) = (bound(&setup).unwrap(), run(&setup));
        let power = along(&setup, &outcome.recording).power.unwrap();
        let after = power.bound.unwrap();
        let v: f64 = (0..2).map(|agent| column(&outcome, agent, Signal::Lyapunov, 0)[0]).sum();
        assert!((before.start_w - v / 20.0).abs() < 1e-9 * v && (after.start_w - before.start_w).abs() < 1e-9 * v);
        assert!(power.mean_w > 0.02 * after.mean_w && power.mean_w < after.mean_w, "{power:?}");
        assert!(after.push_w <= before.push_w && before.agents == 2, "{before:?} {after:?}");
        assert_eq!(before.sigma > 0.0, sample_hz.is_some());
    }
}

#[test]
fn eq_what_pushes_feed_is_known_before_the_run_where_they_are_torques() {
    let push_w = |push: Push| {
        let mut setup = two_arms();
        setup.agents[1].pushes = vec![push];
        bound(&setup).map(|bound| bound.push_w)
    };
    let constant = || [Function::Constant(2.0), Function::Constant(-1.0)];
    // K is 8.
    assert!((push_w(pushed(constant(), 0.0, f64::INFINITY)).unwrap() - 5.0 / 8.0).abs() < 1e-12);
    assert!((push_w(pushed(constant(), 15.0, f64::INFINITY)).unwrap() - 0.25 * 5.0 / 8.0).abs() < 1e-12);
    assert!((push_w(pushed(constant(), 5.0, 7.0)).unwrap() - 0.1 * 5.0 / 8.0).abs() < 1e-12);
    assert!((push_w(pushed([sine(2.0, 3.0), sine(-1.0, 9.0)], 0.0, 20.0)).unwrap() - 5.0 / 8.0).abs() < 1e-6);
    // Of a table the largest size of every column counts: 2 and 1.
    let values = vec![0.5, -1.0, -2.0, 0.3];
    let table = Course::Table(Table { times_s: vec![0.0, 20.0], values, between: Between::Linear });
    let push = Push { effect: Effect::Torque(table), from_s: 0.0, until_s: f64::INFINITY };
    assert!((push_w(push).unwrap() - 5.0 / 8.0).abs() < 1e-12);
    let hand = Effect::SpringOnAxes {
        axes: vec![0],
        stiffness: vec![1.0],
        damping: vec![0.0],
        target: Course::Each(vec![Function::Constant(0.0)]),
    };
    assert_eq!(push_w(Push { effect: hand, from_s: 0.0, until_s: 1.0 }), None, "only the run knows");
    let mut baseline = two_arms().sampled(500.0);
    assert!(bound(&baseline).is_some());
    baseline.reference = Arc::new(PureIntegral);
    assert_eq!(bound(&baseline), None, "z(0) depends on what is heard");
}

#[test]
fn eq_noise_feeds_the_power_that_its_filter_lets_through() {
    let noise_w = |change: fn(&mut Control)| {
        let mut setup = two_arms().sampled(500.0);
        change(setup.control.as_mut().unwrap());
        bound(&setup).unwrap().noise_w
    };
    assert_eq!(noise_w(|_| {}), 0.0);
    // tr K is 16, of two agents.
    assert!((noise_w(|control| control.sensors.velocity_noise = 0.01) - 32.0 * 1e-4).abs() < 1e-12);
    assert!((noise_w(|control| control.sensors.velocity_quantum = 0.012) - 32.0 * 36e-6).abs() < 1e-12);
    let filtered = noise_w(|control| {
        control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 60.0 };
        control.sensors.position_noise = 3e-4;
    });
    let mut filter = VelocityFilter::new(core::f64::consts::TAU * 60.0, 1).unwrap();
    let (mut sum, samples) = (0.0, 200_000);
    for k in 0..samples {
        // Even on an interval of length √12: variance one.
        let even =
            12.0_f64.sqrt() * ((k as f64 * 0.618_033_988_749_894_9 + 0.1 * (k as f64).sqrt() * k as f64).fract() - 0.5);
        sum += filter.feed(0.002, &[3e-4 * even]).unwrap()[0].powi(2);
    }
    let found = 32.0 * sum / f64::from(samples);
    assert!((filtered / found - 1.0).abs() < 0.02, "{filtered} {found}");
}

/// At rest M errs as much as references ask for by what they hear, which comes later with late torques; rounding is not noise where a loop swings up.
#[test]
fn errors_of_positions_count_by_what_is_heard_of_them() {
    let of = |roots: &[f64], delay_s: f64, noise: [f64; 2]| {
        let mut setup = two_arms().sampled(500.0);
        for agent in &mut setup.agents {
            (agent.start.q, agent.start.dq) = (vec![0.3, 0.4], vec![0.0; 2]);
            agent.roots_per_s = roots.to_vec().into();
        }
        let control = setup.control.as_mut().unwrap();
        control.computation_delay_s = delay_s;
        [control.sensors.position_noise, control.sensors.position_quantum] = noise;
        bound(&setup).unwrap()
    };
    let [slow, fast] = [[1.0, 2.0], [10.0, 20.0]].map(|roots| of(&roots, 0.0, [0.01, 0.0]));
    assert!(fast.positions_w > 1.05 * slow.positions_w && fast.between_w > 100.0 * slow.between_w, "{slow:?} {fast:?}");
    // ⅓ + δ + δ² for a δ of one, beside ⅓.
    let late = of(&[1.0, 2.0], 0.002, [0.01, 0.0]);
    assert!((late.between_w / slow.between_w - 7.0).abs() < 1e-9, "{slow:?} {late:?}");
    let filtered = |noise: [f64; 2]| {
        let mut setup = two_arms().sampled(500.0);
        let sensors = &mut setup.control.as_mut().unwrap().sensors;
        sensors.velocity = VelocitySensor::Filtered { cut_off_hz: 8.0 };
        [sensors.position_noise, sensors.position_quantum] = noise;
        bound(&setup).unwrap()
    };
    let [noise, steps] = [[1e-3, 0.0], [0.0, 1e-3 * 12.0_f64.sqrt()]].map(filtered);
    assert!((noise.noise_w / steps.noise_w - 1.0).abs() < 1e-12 && noise.swing == steps.swing, "{noise:?} {steps:?}");
    // What estimates start from is V(0), of which more is left where a loop swings.
    let alone = filtered([0.0; 2]);
    assert!(alone.swing.started > 1.2 && alone.mean_w >= alone.swing.started * alone.start_w, "{alone:?}");
    assert!(noise.is_white && !steps.is_white && noise.mean_w < steps.mean_w, "{noise:?} {steps:?}");
}

/// A torque in steps of q is off by q/2 at most, of every axis and for ever.
#[test]
fn eq_steps_of_the_torque_feed_the_power_as_pushes_of_half_a_step() {
    let of = |quantum: f64| {
        let mut setup = two_arms().sampled(500.0);
        setup.control.as_mut().unwrap().actuators.torque_quantum = quantum;
        bound(&setup).unwrap()
    };
    let (none, steps) = (of(0.0), of(3.0));
    // ¼ q² Σ 1/K_jj: K is 8 on both axes of both arms.
    assert_eq!(none.steps_w, 0.0);
    assert!((steps.steps_w - 2.25 * 4.0 / 8.0).abs() < 1e-12 && steps.mean_w > none.mean_w, "{steps:?}");
    let drive = 0.5 * steps.steps_w.sqrt() / (1.0 - steps.sigma);
    assert!(steps.mean_w > drive * drive, "{steps:?}");
    // Nothing is late or filtered, so that σ is what counts.
    for found in [none, steps] {
        let drive = [found.steps_w, found.held_w, found.positions_w].into_iter().map(f64::sqrt).sum::<f64>();
        assert!(found.mean_w >= mean_power_w(drive * drive, 0.0, found.start_w, found.sigma), "{found:?}");
    }
}

#[test]
fn what_is_watched_is_the_worst_of_what_was_recorded() {
    let mut setup = two_arms().sampled(200.0);
    setup.agents[1].robot.axes[0].effort_limit = Some(50.0);
    let mut outcome = run(&setup);
    let hold = |outcome: &mut Outcome, agent: usize, rows: core::ops::Range<usize>, q: [f64; 2]| {
        for column in &mut outcome.recording.columns {
            if column.agent == agent && column.signal != Signal::Estimate {
                let value = if column.signal == Signal::Position { q[column.axis] } else { 0.0 };
                column.values[rows.clone()].fill(value);
            }
        }
    };
    let rows = outcome.recording.t_s.len();
    for agent in 0..2 {
        hold(&mut outcome, agent, 0..rows, [0.3, 1.5]);
    }
    // Stretched, the arm is lightest about its elbow, and its shoulder bears most where it is level.
    hold(&mut outcome, 1, 400..401, [1.0, 0.0]);
    hold(&mut outcome, 1, 700..701, [0.0, 0.8]);
    let found = along(&setup, &outcome.recording);
    let (margin, load) = (found.margin.unwrap(), found.load.unwrap());
    assert_eq!((margin.agent, margin.t_s), (1, outcome.recording.t_s[400]));
    assert_eq!((load.load.agent.index, load.load.axis, load.t_s), (1, 0, outcome.recording.t_s[700]));
    let expected = 9.81 * (1.6 + 0.4 * 0.8_f64.cos());
    assert!((load.load.torque - expected).abs() < 0.02 && load.load.limit == 50.0, "{load:?}");
    // At rest there it is what is said before a run that starts there.
    let mut there = setup.clone();
    there.agents.iter_mut().for_each(|agent| agent.start.dq = vec![0.0; 2]);
    there.agents[0].start.q = vec![0.3, 1.5];
    there.agents[1].start.q = vec![1.0, 0.0];
    assert!((SamplingMargin::of(&there).unwrap().start.sigma - margin.sigma).abs() < 1e-12, "{margin:?}");
    let mut free = setup.clone();
    free.control = None;
    free.agents[1].robot.axes[0].effort_limit = None;
    let none = along(&free, &outcome.recording);
    assert!(none.margin.is_none() && none.load.is_none() && none.power.is_none() && none.states == 0, "{none:?}");
}
