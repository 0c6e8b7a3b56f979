//! Periods of sampled agents as maps: multipliers against closed forms, and what is said of whole loops by them.

use std::ops::ControlFlow;

use crate::common::kinds::{
    blind_mass, cascade, chain, filtered_spacecraft, formula, modelled_mass, planar_tip, rest_at, spacecraft, tracking,
    vehicle,
};
use crate::common::{arm, masses};
use forwardstep_check::{PracticalAnswer, WholeLoop, practical};
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_sim::drives::{JointDrives, JointFriction};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    AgentSetup, Ending, Exchange, Periods, SampledLoop, Setup, Signal, ThrustKind, VelocitySensor, sampled_loop,
    simulate,
};
use nalgebra::DMatrix;

/// The multipliers of the first agent over these periods.
fn multipliers(setup: &Setup, periods: Periods) -> Vec<nalgebra::Complex<f64>> {
    let SampledLoop { size, own, .. } = sampled_loop(setup, 0, 0.0, periods).unwrap().unwrap();
    DMatrix::from_row_slice(size, size, &own).complex_eigenvalues().iter().copied().collect()
}

#[test]
fn eq_the_multipliers_of_a_sampled_mass_are_those_of_its_recursion() {
    for (late, k) in [(0.0, 0.3), (0.0, 1.7), (0.3, 0.5), (0.5, 1.9), (0.9, 1.2)] {
        // K/m is 5.
        let mut setup = held_mass(&JointDrives::default()).0.sampled(5.0 / k);
        setup.control.as_mut().unwrap().computation_delay_s = late * k / 5.0;
        let found = multipliers(&setup, Periods::FIRST);
        // μ² − (1 − k (1 − δ)) μ + k δ = 0
        let (half, product) = (0.5 * (1.0 - k * (1.0 - late)), k * late);
        let root = nalgebra::Complex::new(half * half - product, 0.0).sqrt();
        // The second is there where a command before is.
        for mu in [root + half, -root + half].into_iter().filter(|mu| late > 0.0 || mu.re != 0.0) {
            let nearest = found.iter().map(|found| (found - mu).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-5, "{late} {k}: {mu} is not among {found:?}");
        }
    }
}

/// A mass at rest under K = 5, with these drives, so slow a reference that z does not count, and its mass.
fn held_mass(drives: &JointDrives) -> (Setup, f64) {
    let mut setup = masses(Exchange::Position, 2, Schedule::fixed(Vec::new()), Vec::new());
    setup.agents.truncate(1);
    setup.network.agents = 1;
    let agent = &mut setup.agents[0];
    agent.roots_per_s = vec![1e-7, 2e-7].into();
    agent.robot = agent.robot.clone().with_drives(drives).unwrap();
    (agent.start.dq, agent.start.reference) = (vec![0.0; 2], vec![vec![0.0; 2]; 2]);
    let mass = agent.robot.theta[0];
    (setup, mass)
}

/// Between samples m v̇ = τ − D v with τ = −K v as it was: v⁺ = (e^(−a) − K (1 − e^(−a))/D) v with a = D h/m.
fn is_damped(setup: &Setup, periods: Periods, (mass, damping): (f64, f64)) {
    let period_s = 1.0 / setup.control.as_ref().unwrap().sample_hz;
    let fades = libm::exp(-damping * period_s / mass);
    let mu = fades - 5.0 * (1.0 - fades) / damping;
    let found = multipliers(setup, periods);
    let nearest = found.iter().map(|found| (found - mu).norm()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 2e-6, "{damping} at {period_s} s: {mu} is {nearest:e} from {found:?}");
}

#[test]
fn eq_the_multiplier_of_a_sampled_mass_with_damping_is_that_of_its_recursion() {
    for (damping, period_s) in [(2.0, 0.3), (20.0, 0.1), (20.0, 0.4), (300.0, 0.1)] {
        let drives = JointDrives { damping: Some(vec![damping; 2]), ..JointDrives::default() };
        let (setup, mass) = held_mass(&drives);
        is_damped(&setup.sampled(1.0 / period_s), Periods::FIRST, (mass, damping));
    }
}

/// It begins fast, where friction is level, and comes to rest, where that is F/ε steep: steps that suffice at first do not there.
#[test]
fn eq_steps_are_those_that_are_needed_where_an_agent_has_come_to() {
    let friction = JointFriction { coulomb: vec![0.5; 2], width: vec![0.0025; 2], dry_s: None };
    let (mut setup, mass) = held_mass(&JointDrives { friction: Some(friction), ..JointDrives::default() });
    setup.agents[0].start.dq = vec![3.0; 2];
    let setup = setup.sampled(10.0);
    is_damped(&setup, Periods { after: 128, ..Periods::FIRST }, (mass, 200.0));
}

/// Of a linear agent what it hears does over several periods what it does in each, carried on: Σ_k J^k B.
#[test]
fn prop_what_is_heard_adds_up_over_periods() {
    let setup = masses(Exchange::PositionVelocity, 3, Schedule::fixed(Vec::new()), Vec::new()).sampled(50.0);
    let of = |over: u32| {
        let found = sampled_loop(&setup, 0, 2.0, Periods { over, ..Periods::FIRST }).unwrap().unwrap();
        let heard = found.hears.map(|hears| DMatrix::from_row_slice(found.size, found.message, &hears));
        (DMatrix::from_row_slice(found.size, found.size, &found.own), heard)
    };
    let ((own, one), (_, five)) = (of(1), of(5));
    assert!(one.iter().any(|heard| heard.norm() > 1e-3), "{one:?}");
    for (one, five) in one.into_iter().zip(five) {
        let sum = (1..5).fold(one.clone(), |sum, _| &own * sum + &one);
        assert!((&sum - &five).norm() < 1e-8, "{sum:.6}{five:.6}");
    }
}

/// What a controller remembers of its last sample follows from its state: periods after each other, which one controller carries on, are what
/// single ones are behind each other, each with a controller that is built anew.
#[test]
fn prop_a_map_of_several_periods_is_the_product_of_those_of_single_ones() {
    let swing = |amplitude: f64| formula((Expression::variable(0) * 1.3).sin_of() * amplitude);
    let attitude = || vec![swing(0.3), rest_at(0.1), swing(-0.2), rest_at(1.0)];
    let flight =
        tracking(vehicle(ThrustKind::Continuous, Floor::Stops(1.0)), vec![swing(0.4), rest_at(0.3), rest_at(1.0)]);
    let cascade = cascade(Expression::variable(1), Expression::number(1.0), 1);
    let kinds = [
        ("an arm", tracking(arm(0, &[1.0, 2.0]), vec![swing(0.5), swing(0.3)])),
        ("blind", tracking(blind_mass(1.0, 2.0), vec![swing(0.2)])),
        ("a model", tracking(modelled_mass(1.0, 2.0), vec![swing(0.2)])),
        ("a tip", tracking(planar_tip(), vec![swing(0.2), rest_at(1.0)])),
        ("a chain", tracking(chain(&Expression::number(1.5), 1, true), vec![swing(0.2)])),
        ("a cascade", tracking(cascade, vec![swing(0.2)])),
        ("a spacecraft", tracking(spacecraft(), attitude())),
        ("a filter", tracking(filtered_spacecraft(), attitude())),
        ("a vehicle", flight),
    ];
    let ways = [(0.0, None), (0.4, None), (0.0, Some(8.0)), (0.4, Some(8.0))];
    let (mut looked, mut moved) = (0, 0);
    for ((name, setup), (late, filter_hz)) in kinds.iter().flat_map(|kind| ways.map(|way| (kind, way))) {
        let mut setup = setup.clone().sampled(400.0);
        let control = setup.control.as_mut().unwrap();
        control.computation_delay_s = late / control.sample_hz;
        if let Some(cut_off_hz) = filter_hz {
            control.sensors.velocity = VelocitySensor::Filtered { cut_off_hz };
        }
        let map = |after: u32, over: u32| -> Option<DMatrix<f64>> {
            let found = sampled_loop(&setup, 0, 0.0, Periods { begin_s: 0.3, after, over });
            let SampledLoop { size, own, .. } = found.ok()??;
            Some(DMatrix::from_row_slice(size, size, &own))
        };
        let Some(whole) = map(2, 4) else { continue };
        let product = (2..6).map(|after| map(after, 1).unwrap()).reduce(|before, next| next * before).unwrap();
        let apart = (&whole - &product).norm() / whole.norm();
        assert!(apart < 1e-6, "{name}, {late} late, filtered at {filter_hz:?} Hz: {apart}");
        looked += 1;
        moved += usize::from((&whole - map(2, 1).unwrap().pow(4)).norm() / whole.norm() > 1e-5);
    }
    assert!(looked >= 24 && moved > 10, "{looked}, of which {moved} change along the way");
}

/// Whether it keeps near its target to the end; a run that takes many steps has long left it.
fn settles(setup: &Setup) -> bool {
    let mut steps = 0;
    let mut few = |_| {
        steps += 1;
        if steps < 10_000 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    };
    let outcome = simulate(setup, &mut few).unwrap();
    let errors = outcome.recording.columns.iter().filter(|column| column.signal == Signal::TrackingError);
    let late =
        errors.flat_map(|column| column.values.iter().rev().take(200)).fold(0.0_f64, |most, s| most.max(s.abs()));
    outcome.ending == Ending::Completed && late < 0.1
}

#[test]
fn the_linearised_period_tells_which_laws_settle_when_they_are_sampled() {
    use PracticalAnswer::{Adequate, Inadequate, Marginal};
    let psi = Expression::number(1.5);
    let cascade = cascade(Expression::variable(1), Expression::number(1.0), 1);
    for (setup, stable, unstable) in [
        (tracking(blind_mass(1.0, 2.0), vec![rest_at(0.2)]), (0.05, Marginal), 0.1),
        (tracking(blind_mass(1.0, 2.0), vec![rest_at(0.2)]), (0.01, Adequate), 0.1),
        (tracking(planar_tip(), vec![rest_at(0.9), rest_at(1.0)]), (0.01, Marginal), 0.05),
        (tracking(chain(&psi, 1, true), vec![rest_at(0.2)]), (0.4, Marginal), 0.8),
        (tracking(chain(&psi, 1, false), vec![rest_at(0.2)]), (0.4, Marginal), 0.8),
        (tracking(cascade, vec![rest_at(0.2)]), (0.8, Marginal), 1.6),
    ] {
        for (period_s, answer, settled) in [(stable.0, stable.1, true), (unstable, Inadequate, false)] {
            let setup = setup.clone().sampled(1.0 / period_s);
            let found = practical(&setup).findings;
            let [finding] = &found[..] else { panic!("{found:?}") };
            assert_eq!((finding.name(), finding.answer()), ("whole-loop", answer), "{}", finding.because());
            assert_eq!(settles(&setup), settled, "{}", finding.because());
        }
    }
}

#[test]
fn of_several_agents_the_worst_linearised_period_is_shown() {
    let psi = Expression::number(1.5);
    let agents = [chain(&psi, 1, true), chain(&psi, 1, false)];
    for period_s in [0.4, 0.8] {
        let found = |agents: &[AgentSetup]| {
            let mut setup = tracking(agents[0].clone(), vec![rest_at(0.2)]).sampled(1.0 / period_s);
            let target = setup.agents[0].target.clone();
            setup.agents = agents.iter().map(|own| AgentSetup { target: target.clone(), ..own.clone() }).collect();
            setup.network.agents = agents.len();
            let whole = WholeLoop::of(&setup).unwrap();
            let last = whole.last();
            (last.alone.per_s, whole.start.leftmost.unwrap()[0], whole.answer())
        };
        let [first, second] = [found(&agents[..1]), found(&agents[1..])];
        assert!(first != second && (first.2.max(second.2) == PracticalAnswer::Inadequate) == (period_s > 0.5));
        let [mut turned, both] = [agents.clone(), agents.clone()];
        turned.reverse();
        // Each of the worst that any has.
        let worst = (first.0.max(second.0), first.1.min(second.1), first.2.max(second.2));
        assert_eq!([found(&both), found(&turned)], [worst; 2]);
    }
}

#[test]
fn a_period_is_linearised_of_few_of_many() {
    let one = tracking(blind_mass(1.0, 2.0), vec![rest_at(0.2)]);
    assert_eq!(sampled_loop(&one, 0, 0.0, Periods::FIRST).unwrap(), None, "control is continuous");
    let sampled = one.sampled(20.0);
    assert_eq!(sampled_loop(&sampled, 1, 0.0, Periods::FIRST).unwrap(), None, "there is no such agent");
    let mut many = sampled.clone();
    let said = |many: &Setup| practical(many).findings[0].because();
    let of = |many: &mut Setup, count: usize| {
        many.agents = vec![sampled.agents[0].clone(); count];
        many.network.agents = count;
    };
    of(&mut many, 10);
    assert!(said(&many).contains("(agent, the worst of all 10 agents)"), "{}", said(&many));
    of(&mut many, 40);
    assert!(said(&many).contains("the worst of 14 of 40 agents"), "{}", said(&many));
    let alone = said(&sampled);
    assert!(alone.contains("(agent), with a period of 50 ms: the slowest mode decays at 0.3763/s"), "{alone}");
}
