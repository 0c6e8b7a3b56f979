//! What is known of vehicles and of chains before they move.

use std::sync::Arc;

use forwardstep_check::prediction::{CascadeSpread, NoCascade};
use forwardstep_check::{NoIdeal, NoPrediction, ideal, predict};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::Formulas;
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    AgentSetup, ChainModel, Exchange, Outcome, RotorcraftModel, Setup, Signal, ThrustKind, ThrustLaw,
};

use super::course::predicted;
use crate::common::kinds::{chain, rest_at, vehicle};
use crate::common::{column, edge, noise, run, setup};

const MASS_KG: f64 = 2.0;

/// All four laws, with the true mass where it is adapted.
fn designs(estimate_start: f64) -> [ThrustKind; 4] {
    let (alpha_star, gamma_star, bounds) = (4.0, 0.2, None);
    [
        ThrustKind::Continuous,
        ThrustKind::Differentiable { alpha_star, stiffness: 20.0 },
        ThrustKind::Adaptive { alpha_star, gamma_star, estimate_start, bounds },
        ThrustKind::ByAcceleration { alpha_star, gamma_star, estimate_start, bounds, bias: [0.0; 3] },
    ]
}

fn has_reference(design: ThrustKind) -> bool {
    design != ThrustKind::Continuous
}

/// d(t) of an agent, which moves.
fn offset(index: usize) -> Trajectory {
    let at = |k: usize| 0.8 * noise(7 * index + k);
    let turning = |k: usize| {
        let wave = Sinusoid { amplitude: 0.3, rad_per_s: 0.7, phase_rad: k as f64 + at(k) };
        Path::Sinusoids { offset: at(k), waves: vec![wave] }
    };
    Trajectory::new(vec![turning(0), turning(1), rest_at(at(2))]).unwrap()
}

/// A vehicle that is neither upright nor at rest.
fn moving(design: ThrustKind, index: usize, in_formation: bool) -> AgentSetup {
    let mut agent = vehicle(design, Floor::Stops(0.5));
    agent.name = format!("vehicle-{index}");
    agent.roots_per_s =
        (0..design.order()).map(|r| 0.8 + 0.5 * r as f64 + 0.1 * index as f64).collect::<Vec<_>>().into();
    let entry = |k: usize| 0.5 * noise(31 * index + k);
    agent.start.q = (0..3).map(entry).collect();
    agent.start.dq = (3..6).map(|k| 0.4 * entry(k)).collect();
    let tilt = 0.15 * entry(6);
    agent.start.rest = vec![tilt.sin(), 0.0, 0.0, tilt.cos()];
    agent.change_law(|law: &mut ThrustLaw| law.thrust_start = Some(9.81 * MASS_KG + entry(8)));
    agent.target = in_formation.then(|| offset(index));
    agent
}

fn to_be(design: ThrustKind, in_formation: bool) -> Vec<AgentSetup> {
    (0..4).map(|index| moving(design, index, in_formation)).collect()
}

/// Over a graph that switches, with a delay that jumps.
fn switched(agents: Vec<AgentSetup>) -> Setup {
    let phase = |edges: &[(usize, usize, usize)], dwell_s| Phase {
        edges: edges.iter().map(|&(from, to, delay)| edge(from, to, 0.9, delay)).collect(),
        dwell_s,
    };
    let schedule =
        Schedule::periodic(vec![phase(&[(0, 1, 0), (2, 3, 1)], 0.7), phase(&[(1, 2, 1), (3, 0, 0), (0, 2, 0)], 0.9)]);
    let saw = Delay::new(SawTooth { min_s: 0.0, max_s: 0.3, period_s: 0.7, offset_s: 0.1 });
    setup(agents, Exchange::Position, schedule, vec![saw, Delay::constant(0.25)], 6.0)
}

/// Over a fixed graph with constant delays, and a listener.
fn fixed(agents: Vec<AgentSetup>, end_s: f64) -> Setup {
    let edges =
        vec![edge(0, 1, 1.0, 0), edge(1, 2, 0.7, 1), edge(2, 0, 0.6, 0), edge(1, 0, 0.4, 1), edge(2, 3, 0.9, 0)];
    let delays = vec![Delay::constant(0.3), Delay::constant(0.0)];
    let mut setup = setup(agents, Exchange::Position, Schedule::fixed(edges), delays, end_s);
    setup.time.record_every_s = end_s / 20.0;
    setup
}

/// x − d of an agent on an axis, row by row.
fn agreed(setup: &Setup, outcome: &Outcome, agent: usize, axis: usize) -> Vec<f64> {
    let x = column(outcome, agent, Signal::Position, axis).iter();
    let Some(offset) = &setup.agents[agent].target else { return x.copied().collect() };
    let d = |t_s: &f64| offset.paths()[axis].jet(*t_s)[0];
    x.zip(&outcome.recording.t_s).map(|(x, t_s)| x - d(t_s)).collect()
}

#[test]
fn thm4_thm5_vehicles_that_follow_exactly_run_as_their_references_alone() {
    for design in designs(MASS_KG) {
        for in_formation in [false, true] {
            let mut agents = to_be(design, in_formation);
            if has_reference(design) {
                // ṡ(0) vanishes as well where ż(0) = ẍ(0) − d̈(0), which (46) starts from.
                let own = ideal(&switched(to_be(ThrustKind::Continuous, in_formation))).unwrap();
                agents.iter_mut().zip(own.agents).for_each(|(agent, own)| agent.start.reference = own.start.reference);
            }
            let setup = switched(agents);
            let followed = ideal(&setup).unwrap();
            let (outcome, alone) = (run(&setup), run(&followed));
            if has_reference(design) {
                // The interval of ψ as well.
                let of = |setup: &Setup, outcome: &Outcome| CascadeSpread::of(setup, &outcome.recording).unwrap();
                let (robots, references) = (of(&setup, &outcome), of(&followed, &alone));
                for (a, b) in [(&robots.low, &references.low), (&robots.high, &references.high)] {
                    let mut apart = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs());
                    assert!(apart.all(|apart| apart < 1e-5), "{design:?} {in_formation}");
                }
            }
            let (mut away, mut moved) = (0.0_f64, 0.0_f64);
            for (agent, axis) in (0..4).flat_map(|agent| (0..3).map(move |axis| (agent, axis))) {
                let x = agreed(&setup, &outcome, agent, axis);
                let reference = column(&alone, agent, Signal::Position, axis);
                assert_eq!(x.len(), reference.len());
                let apart = x.iter().zip(reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                (away, moved) = (away.max(apart), moved.max((x[0] - x[x.len() - 1]).abs()));
            }
            assert!(moved > 0.1 && away < 1e-6, "{design:?} {in_formation}: {away:e} of {moved}");
        }
    }
}

#[test]
fn thm4_thm5_the_value_that_vehicles_agree_on_is_known_before_they_fly() {
    for design in designs(MASS_KG).into_iter().filter(|design| design.estimate_start().is_none()) {
        for in_formation in [false, true] {
            let mut agents = to_be(design, in_formation);
            if has_reference(design) {
                agents[0].start.reference = vec![vec![0.2, -0.1, 0.3], vec![0.1, 0.0, -0.2]];
            }
            // A push for a while moves nobody for good, but under (46), where it moves all by its impulse.
            let course = Course::Each([0.6, -0.4, 0.2].map(Function::Constant).into());
            agents[1].pushes = vec![Push { effect: Effect::Torque(course), from_s: 1.0, until_s: 2.5 }];
            let setup = fixed(agents, 90.0);
            let prediction = predict(&setup).unwrap();
            assert_eq!(prediction.influence[3], 0.0);
            let (outcome, course) = (run(&setup), predicted(&setup));
            for (agent, axis) in (0..4).flat_map(|agent| (0..3).map(move |axis| (agent, axis))) {
                let x = *agreed(&setup, &outcome, agent, axis).last().unwrap();
                let c = prediction.value[axis];
                assert!((x - c).abs() < 2e-6, "{design:?} {in_formation} agent {agent}: {x} is not {c}");
                let unpushed = {
                    let mut setup = setup.clone();
                    setup.agents[1].pushes.clear();
                    predict(&setup).unwrap().value[axis]
                };
                assert_eq!(has_reference(design), unpushed == c, "{unpushed} {c}");
                let alone = course.value[axis];
                assert!((alone - unpushed).abs() < 2e-6, "{design:?}: {alone} is not {unpushed}");
                let [low, high] = course.within.as_ref().unwrap()[axis];
                assert!(low - 1e-6 <= alone && alone <= high + 1e-6, "{design:?}: {alone} is not in {low} … {high}");
            }
        }
    }
}

#[test]
fn thm5_the_value_holds_of_rotorcraft_whose_angular_velocity_is_late() {
    let mut agents = to_be(designs(MASS_KG)[1], true);
    for agent in &mut agents {
        let inertia = Gain::Diagonal(vec![0.02, 0.02, 0.04]);
        agent.robot.kind = Arc::new(RotorcraftModel { gravity: 9.81, inertia, rotors: None });
        agent.start.rest.extend([0.0; 3]);
    }
    let setup = fixed(agents, 90.0);
    let (prediction, outcome) = (predict(&setup).unwrap(), run(&setup));
    for (agent, axis) in (0..4).flat_map(|agent| (0..3).map(move |axis| (agent, axis))) {
        let x = *agreed(&setup, &outcome, agent, axis).last().unwrap();
        assert!((x - prediction.value[axis]).abs() < 2e-6, "{x} is not {}", prediction.value[axis]);
    }
    // Under (46) it is not kept: x⃛ is late, and nothing else is conserved.
    let mut late = setup.clone();
    for agent in &mut late.agents {
        agent.roots_per_s = vec![1.0, 2.0].into();
        agent.change_law(|law: &mut ThrustLaw| law.design = ThrustKind::Continuous);
    }
    assert_eq!(predict(&late), Err(NoPrediction::Law));
    assert!(ideal(&late).is_ok());
}

#[test]
fn why_nothing_is_known_of_vehicles_is_said() {
    let said = |design: ThrustKind, change: fn(&mut Setup)| {
        let mut setup = fixed(to_be(design, false), 1.0);
        change(&mut setup);
        predict(&setup).err()
    };
    let [continuous, differentiable, adaptive, by_acceleration] = designs(MASS_KG);
    for design in [adaptive, by_acceleration] {
        assert_eq!(said(design, |_| ()), Some(NoPrediction::ErrorStays { agent: 0 }));
    }
    // Who is heard by nobody moves nothing, but with a bias it comes nowhere to rest.
    let with_listener = |design: ThrustKind| {
        let mut agents = to_be(differentiable, false);
        agents[3] = moving(design, 3, false);
        fixed(agents, 90.0)
    };
    for design in [designs(1.2 * MASS_KG)[2], designs(1.2 * MASS_KG)[3]] {
        let setup = with_listener(design);
        let (value, outcome) = (predict(&setup).unwrap().value, run(&setup));
        for (agent, axis) in (0..4).flat_map(|agent| (0..3).map(move |axis| (agent, axis))) {
            let x = *column(&outcome, agent, Signal::Position, axis).last().unwrap();
            assert!((x - value[axis]).abs() < 1e-5, "{design:?} agent {agent}: {x} is not {}", value[axis]);
        }
        let mut biased = setup;
        let drifts = biased.agents[3].change_law(|law: &mut ThrustLaw| {
            if let ThrustKind::ByAcceleration { bias, .. } = &mut law.design {
                bias[2] = 0.01;
            }
        });
        let said = matches!(design, ThrustKind::ByAcceleration { .. }).then_some(NoPrediction::ErrorStays { agent: 3 });
        assert_eq!((drifts, predict(&biased).err()), (true, said));
    }
    fn push(setup: &mut Setup, until_s: f64) {
        let gust = || Function::Formula((Expression::variable(0) * 3.0).sin_of());
        let course = Course::Each(vec![gust(), gust(), gust()]);
        setup.agents[2].pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.1, until_s }];
    }
    let for_a_while = |setup: &mut Setup| push(setup, 0.2);
    assert_eq!(said(continuous, for_a_while), Some(NoPrediction::Pushed { agent: 2 }));
    assert_eq!(said(differentiable, for_a_while), None);
    let for_ever = |setup: &mut Setup| push(setup, f64::INFINITY);
    assert_eq!(said(differentiable, for_ever), Some(NoPrediction::PushedForEver { agent: 2 }));
    let short = |setup: &mut Setup| setup.agents[3].start.rest.truncate(3);
    assert_eq!(said(continuous, short), Some(NoPrediction::Start(NoIdeal::Start { agent: 3 })));
}

#[test]
fn eq_30_the_cascaded_variables_of_vehicles_that_are_led_spread_over_what_s_adds() {
    for design in designs(MASS_KG) {
        let setup = fixed(to_be(design, false), 40.0);
        let spread = CascadeSpread::of(&setup, &run(&setup).recording);
        if !has_reference(design) {
            assert_eq!(spread, Err(NoCascade::Law { agent: 0 }));
            continue;
        }
        let widths = spread.unwrap().widths();
        assert!(widths[0] > 0.3 && widths[widths.len() - 1] < 0.01 * widths[0], "{design:?}: {widths:?}");
    }
}

#[test]
fn eq_38_the_value_that_chains_agree_on_is_known_before_the_run() {
    for order in 2..=4 {
        let model = Formulas::new(order, &Expression::number(0.0), Vec::new(), &Expression::number(1.5)).unwrap();
        let agents = (0..4).map(|index| {
            let mut agent = chain(&Expression::number(2.0), 0, false);
            agent.robot.kind = Arc::new(ChainModel::Derivatives(Arc::new(model.clone())));
            let entry = |k: usize| 0.6 * noise(17 * index + k);
            (agent.start.q, agent.start.dq) = (vec![entry(0)], vec![entry(1)]);
            agent.start.rest = (2..order).map(entry).collect();
            agent.roots_per_s =
                (0..order).map(|r| 1.1 + 0.4 * r as f64 + 0.1 * index as f64).collect::<Vec<_>>().into();
            agent.start.reference = (5..7).map(|k| vec![entry(k)]).collect();
            if index == 1 {
                let effect = Effect::Torque(Course::Each(vec![Function::Constant(1.5)]));
                agent.pushes = vec![Push { effect, from_s: 1.0, until_s: 3.0 }];
            }
            agent
        });
        let mut agents: Vec<AgentSetup> = agents.collect();
        if order == 2 {
            // Whoever adapts agrees there too.
            let mut adaptive = chain(&Expression::number(2.0), 1, true);
            (adaptive.start, adaptive.roots_per_s) = (agents[2].start.clone(), agents[2].roots_per_s.clone());
            agents[2] = adaptive;
        }
        let setup = fixed(agents, 90.0);
        let (prediction, outcome) = (predict(&setup).unwrap(), run(&setup));
        for agent in 0..4 {
            let x = *column(&outcome, agent, Signal::Position, 0).last().unwrap();
            assert!((x - prediction.value[0]).abs() < 2e-6, "order {order}: {x} is not {}", prediction.value[0]);
        }
    }
}

#[test]
fn eq_57_what_is_left_of_s_moves_what_is_agreed_on() {
    // With the mass known m s̈ = −α* m ṡ while m̂ stays true: s ends near s(0) + ṡ(0)/α*, and not at zero.
    let setup = fixed(to_be(designs(MASS_KG)[2], false), 90.0);
    let outcome = run(&setup);
    // They tilt about the first axis, so that they are accelerated along the second.
    let of = |signal| (0..4).map(|agent| *column(&outcome, agent, signal, 1).last().unwrap()).collect::<Vec<_>>();
    let (x, s) = (of(Signal::Position), of(Signal::TrackingError));
    assert!(x.iter().all(|other| (other - x[0]).abs() < 1e-6), "they agree: {x:?}");
    assert!(s.iter().any(|s| s.abs() > 0.01), "{s:?}");
    let away = (x[0] - predicted(&setup).value[1]).abs();
    assert!(away > 1e-3, "{away:e}");
}
