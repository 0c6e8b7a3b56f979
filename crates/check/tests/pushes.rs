//! What pushes do to the value agreed upon: nothing without λ, and with it what Remark 4 says.

mod injected;
mod injected_alone;
mod manipulability;

use forwardstep_sim::reference::{Consensus, PureIntegral, ReferenceDynamics};
use std::sync::Arc;

use crate::common::kinds::{alone, blind_mass, cascade, chain, planar_tip, rest_at, spacecraft, tracking, vehicle};
use crate::common::{axis, column, edge, run, setup};
use forwardstep_check::{Answer, Id, NoPrediction, check, predict};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::CascadeTerms;
use forwardstep_core::reference::polynomial;
use forwardstep_core::robot::{PlanarArm, PlanarLinks, PlanarTip, PointMass};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::graph::Edge;
use forwardstep_sim::push::{AttachmentPoint, Between, Course, Effect, Function, Push, Table};
use forwardstep_sim::schedule::Schedule;
use forwardstep_sim::{
    Adaptive, AgentSetup, ChainModel, Exchange, Known, Law, Method, Outcome, Robot, RobotSetup, Setup, Signal, Start,
    ThrustKind,
};

const DAMPING: f64 = 5.0;

fn agent(index: usize, roots_per_s: &[f64], kind: Arc<dyn Robot>, theta: Vec<f64>, law: Arc<dyn Law>) -> AgentSetup {
    let start = |k: f64| (12.9898 * (index as f64 + k) + 0.7).sin();
    AgentSetup {
        name: format!("agent-{}", index + 1),
        robot: RobotSetup {
            kind,
            theta_names: vec![String::new(); theta.len()],
            theta,
            axes: vec![axis("a"), axis("b")],
        },
        roots_per_s: roots_per_s.to_vec().into(),
        manipulability: 0.0,
        law,
        start: Start {
            q: vec![start(0.0), start(10.0)],
            dq: vec![0.3 * start(20.0), 0.0],
            rest: Vec::new(),
            reference: Vec::new(),
        },
        enforce_limits: false,
        target: None,
        pushes: Vec::new(),
    }
}

fn arm(index: usize, roots_per_s: &[f64], law: Arc<dyn Law>) -> AgentSetup {
    let links = PlanarLinks::uniform([1.0 + 0.2 * index as f64, 1.0], [1.0, 0.8]);
    agent(index, roots_per_s, Arc::new(PlanarArm), links.theta().to_vec(), law)
}

fn mass(index: usize, roots_per_s: &[f64]) -> AgentSetup {
    let known = Arc::new(Known { damping: Gain::Number(DAMPING) });
    agent(index, roots_per_s, Arc::new(PointMass { dimension: 2 }), vec![1.0 + index as f64], known)
}

/// A ring with different weights and constant delays, one of which is none.
fn ring(agents: Vec<AgentSetup>, exchange: Exchange, end_s: f64) -> Setup {
    let edges: Vec<Edge> = match agents.len() {
        1 => Vec::new(),
        2 => vec![edge(0, 1, 1.5, 0), edge(1, 0, 0.7, 1)],
        _ => vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1), edge(2, 0, 1.1, 2), edge(1, 0, 0.4, 0)],
    };
    let delays = [0.3, 0.0, 0.75].map(Delay::constant).to_vec();
    let mut setup = setup(agents, exchange, Schedule::fixed(edges), delays, end_s);
    setup.time.record_every_s = 5.0;
    setup.solver.method = Method::Adaptive { rtol: 1e-10, atol: 1e-11 };
    setup
}

fn ends_at(setup: &Setup, outcome: &Outcome, axis: usize, want: f64) {
    for agent in 0..setup.agents.len() {
        let q = *column(outcome, agent, Signal::Position, axis).last().unwrap();
        assert!((q - want).abs() < 1e-6, "agent {agent}, axis {axis}: {q} is not {want}");
    }
}

fn constant(values: &[f64]) -> Course {
    Course::Each(values.iter().map(|value| Function::Constant(*value)).collect())
}

fn pulse(effect: Effect) -> Push {
    Push { effect, from_s: 2.0, until_s: 3.5 }
}

/// Everything that can push a planar arm, at once.
fn rough_handling() -> Vec<Push> {
    let at = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 0.8] });
    let hand = Effect::SpringOnAxes {
        axes: vec![1],
        stiffness: vec![20.0],
        damping: vec![2.0],
        target: Course::Table(Table {
            times_s: vec![4.0, 5.0, 6.0],
            values: vec![0.0, 1.5, 0.3],
            between: Between::Linear,
        }),
    };
    vec![
        pulse(Effect::Torque(constant(&[9.0, -4.0]))),
        pulse(Effect::Wrench { at, wrench: constant(&[6.0, 3.0, 0.5]) }),
        Push { effect: hand, from_s: 0.0, until_s: f64::INFINITY },
        Push {
            effect: Effect::SpringOnPoint { at, stiffness: 30.0, damping: 4.0, target: constant(&[0.2, 1.4]) },
            from_s: 7.0,
            until_s: 9.0,
        },
    ]
}

#[test]
fn prop_without_lambda_no_push_moves_the_agreement() {
    let adaptive = Arc::new(Adaptive {
        damping: Gain::Number(8.0),
        adaptation: Gain::Number(10.0),
        estimate_start: vec![0.0; 5],
        bounds: None,
    });
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=3 {
            let roots = |i: usize| (0..order).map(|r| 1.2 + 0.8 * r as f64 + 0.1 * i as f64).collect::<Vec<_>>();
            let agents = (0..3).map(|i| arm(i, &roots(i), adaptive.clone())).collect();
            let mut setup = ring(agents, exchange, 150.0);
            let untouched = predict(&setup).unwrap();
            setup.agents[0].pushes = rough_handling();
            setup.agents[2].pushes = vec![pulse(Effect::Torque(constant(&[-5.0, 2.0])))];
            assert_eq!(predict(&setup).unwrap(), untouched);
            let outcome = run(&setup);
            (0..2).for_each(|axis| ends_at(&setup, &outcome, axis, untouched.value[axis]));
        }
    }
}

/// Σ uᵢ [1 + dᵢ α₁/α₀ + Σⱼ w_ij (T_ij − 1/κ₀)], by which the conserved quantity is divided.
fn normaliser(setup: &Setup, influence: &[f64]) -> f64 {
    let edges = setup.network.schedule.graph(0);
    let term = |(i, agent): (usize, &AgentSetup)| {
        let alpha = polynomial(&agent.roots_per_s).unwrap();
        let heard = edges.iter().filter(|edge| edge.to == i).map(|edge| {
            let velocity =
                if setup.exchange == Exchange::PositionVelocity { 1.0 / agent.roots_per_s.real[0] } else { 0.0 };
            edge.weight.constant().unwrap()
                * (alpha[1] / alpha[0] + setup.network.delays[edge.delay].max_s() - velocity)
        });
        influence[i] * (1.0 + heard.sum::<f64>())
    };
    setup.agents.iter().enumerate().map(term).sum()
}

/// By Simpson's rule over equal rows.
fn integral(values: &[f64], step_s: f64) -> f64 {
    assert_eq!(values.len() % 2, 1);
    let pairs = values.windows(3).step_by(2).map(|v| v[0] + 4.0 * v[1] + v[2]);
    pairs.sum::<f64>() * step_s / 3.0
}

#[test]
fn eq_31_with_lambda_the_agreement_moves_by_the_integral_of_s() {
    // Arms with known parameters: s is not known before the run, but what it moved is known after it.
    let known = Arc::new(Known { damping: Gain::Number(8.0) });
    for (reference, exchange) in [
        (Arc::new(Consensus) as Arc<dyn ReferenceDynamics>, Exchange::PositionVelocity),
        (Arc::new(Consensus), Exchange::Position),
        (Arc::new(PureIntegral), Exchange::PositionVelocity),
    ] {
        let agents = (0..2).map(|i| arm(i, &[1.0 + 0.2 * i as f64, 2.0], known.clone())).collect();
        let mut setup = ring(agents, exchange, 80.0);
        setup.reference = reference;
        setup.time.record_every_s = 1e-3;
        let before = predict(&setup).unwrap();
        setup.agents[0].manipulability = 3.0;
        setup.agents[1].manipulability = 2.0;
        assert_eq!(predict(&setup).unwrap(), before, "known parameters and nobody pushes: s = 0");
        setup.agents[0].pushes = rough_handling();
        assert_eq!(predict(&setup), Err(NoPrediction::Manipulability { agent: 0 }));
        let outcome = run(&setup);
        for axis in 0..2 {
            let moved: f64 = (0..2)
                .map(|i| {
                    let alpha_0 = polynomial(&setup.agents[i].roots_per_s).unwrap()[0];
                    let s = integral(column(&outcome, i, Signal::TrackingError, axis), 1e-3);
                    before.influence[i] * setup.agents[i].manipulability / alpha_0 * s
                })
                .sum::<f64>()
                / normaliser(&setup, &before.influence);
            assert!(moved.abs() > 0.05, "it moves");
            ends_at(&setup, &outcome, axis, before.value[axis] + moved);
        }
    }
}

#[test]
fn eq_31_the_push_of_a_known_mass_moves_the_agreement_by_its_impulse() {
    // K ∫ s = ∫ τ_ext: known before the run.
    for exchange in [Exchange::Position, Exchange::PositionVelocity] {
        for order in 1..=3 {
            let roots: Vec<f64> = (0..order).map(|r| 1.0 + 0.7 * r as f64).collect();
            let mut setup = ring((0..3).map(|i| mass(i, &roots)).collect(), exchange, 150.0);
            let before = predict(&setup).unwrap();
            for agent in &mut setup.agents {
                agent.manipulability = 1.5;
            }
            let table = |between| {
                let (times_s, values) = (vec![4.0, 5.0, 7.0], vec![2.0, 0.0, 4.0, -1.0, 8.0, 3.0]);
                let course = Course::Table(Table { times_s, values, between });
                Push { effect: Effect::Torque(course), from_s: 4.5, until_s: 6.0 }
            };
            setup.agents[0].pushes = vec![pulse(Effect::Torque(constant(&[4.0, -2.0]))), table(Between::Linear)];
            setup.agents[1].pushes = vec![table(Between::Hold)];
            let after = predict(&setup).unwrap();
            let alpha_0 = polynomial(&roots).unwrap()[0];
            // 1.5 s of 4; the line from 3 over 4 to 6; 0.5 s of 2 and 1 s of 4.
            let impulses = [6.0 + 1.75 + 5.0, 1.0 + 4.0, 0.0];
            let weighted: f64 = before.influence.iter().zip(impulses).map(|(u, impulse)| u * impulse).sum();
            let moved = 1.5 / (alpha_0 * DAMPING) * weighted / normaliser(&setup, &before.influence);
            assert!((after.value[0] - before.value[0] - moved).abs() < 1e-12);
            let outcome = run(&setup);
            (0..2).for_each(|axis| ends_at(&setup, &outcome, axis, after.value[axis]));
        }
    }
}

#[test]
fn eq_31_a_push_and_a_tracking_error_at_the_start_move_the_agreement_together() {
    // K ∫ s = ∫ τ_ext + m s(0), with z(0) of its own.
    for (pushed, reference) in [
        (false, Arc::new(Consensus) as Arc<dyn ReferenceDynamics>),
        (true, Arc::new(Consensus)),
        (true, Arc::new(PureIntegral)),
    ] {
        let mut setup = ring((0..3).map(|i| mass(i, &[1.0, 1.7])).collect(), Exchange::Position, 150.0);
        setup.reference = reference;
        for agent in &mut setup.agents {
            agent.start.reference = vec![vec![agent.start.dq[0] - 0.8, agent.start.dq[1] + 0.5]];
        }
        let before = predict(&setup).unwrap();
        setup.agents[1].manipulability = 1.5;
        if pushed {
            setup.agents[1].pushes = vec![pulse(Effect::Torque(constant(&[4.0, -2.0])))];
        }
        let after = predict(&setup).unwrap();
        let outcome = run(&setup);
        for axis in 0..2 {
            // 1.5 s of the push, and 2 kg times s(0).
            let impulse = [6.0, -3.0][axis] * f64::from(u8::from(pushed)) + [1.6, -1.0][axis];
            let moved =
                1.5 / (1.0 * 1.7 * DAMPING) * before.influence[1] * impulse / normaliser(&setup, &before.influence);
            assert!((after.value[axis] - before.value[axis] - moved).abs() < 1e-12, "{pushed}, axis {axis}");
            ends_at(&setup, &outcome, axis, after.value[axis]);
        }
    }
}

#[test]
fn eq_31_one_agent_moves_by_lambda_over_alpha_beta_k_times_the_impulse() {
    // q = (p² + λ) s / (p (p + α)(p + β)) with s = τ_ext / (M p + K): one pole at the origin, and none for λ = 0.
    let (alpha, beta) = (1.3, 2.1);
    for (lambda, reference) in [
        (0.0, Arc::new(PureIntegral) as Arc<dyn ReferenceDynamics>),
        (2.5, Arc::new(PureIntegral)),
        (2.5, Arc::new(Consensus)),
    ] {
        let mut setup = ring(vec![mass(0, &[alpha, beta])], Exchange::Position, 40.0);
        setup.reference = reference;
        setup.agents[0].start = Start { q: vec![0.4, -0.2], dq: vec![0.0; 2], rest: Vec::new(), reference: Vec::new() };
        setup.agents[0].manipulability = lambda;
        setup.agents[0].pushes = vec![pulse(Effect::Torque(constant(&[4.0, 0.0])))];
        let moved = lambda / (alpha * beta * DAMPING) * 4.0 * 1.5;
        let outcome = run(&setup);
        ends_at(&setup, &outcome, 0, 0.4 + moved);
        ends_at(&setup, &outcome, 1, -0.2);
        assert!((predict(&setup).unwrap().value[0] - 0.4 - moved).abs() < 1e-12);
    }
}

#[test]
fn thm_verdicts_on_pushes_that_end_and_that_do_not() {
    let verdict = |pushes: Vec<Push>| {
        let mut setup = ring((0..2).map(|i| mass(i, &[1.0, 2.0])).collect(), Exchange::PositionVelocity, 10.0);
        setup.agents[1].pushes = pushes;
        let mut hypotheses = check(&setup).hypotheses;
        hypotheses.retain(|h| h.requires().starts_with("external torques"));
        assert!(hypotheses.len() < 2);
        hypotheses.pop().map(|h| (h.answer(), h.because()))
    };
    let forever = |effect| Push { effect, from_s: 1.0, until_s: f64::INFINITY };
    let hand = |target| Effect::SpringOnAxes { axes: vec![0], stiffness: vec![5.0], damping: vec![1.0], target };
    assert_eq!(verdict(Vec::new()), None);
    let nothing = Push { from_s: 1.0, until_s: 1.0, ..pulse(Effect::Torque(constant(&[1.0; 2]))) };
    assert_eq!(verdict(vec![nothing]), None);
    let ends = verdict(vec![pulse(Effect::Torque(constant(&[1.0; 2]))), pulse(hand(constant(&[0.1])))]).unwrap();
    assert_eq!(ends, (Answer::Holds, "agent-2 is pushed, and the last push has ended by t = 3.5 s".into()));
    let (answer, because) = verdict(vec![forever(Effect::Torque(constant(&[1.0; 2])))]).unwrap();
    assert!(answer == Answer::NotCovered && because.contains("K s = tau_ext"), "{because}");
    let (answer, because) = verdict(vec![forever(hand(constant(&[0.1])))]).unwrap();
    assert!(
        answer == Answer::NotCovered && because.starts_with("a virtual spring never lets go of agent-2"),
        "{because}"
    );
    // Of what is no robot under (6)-(7) neither.
    let mut blind = alone(blind_mass(1.0, 1.0));
    blind.agents[0].pushes = vec![forever(hand(constant(&[0.1])))];
    let (answer, because) = said(&blind, Id::PushesEnd).unwrap();
    assert!(
        answer == Answer::NotCovered && because.starts_with("a virtual spring never lets go of agent"),
        "{because}"
    );
    // A hand that stands at zero holds on to what it has.
    assert_eq!(verdict(vec![forever(hand(constant(&[0.0])))]).unwrap().0, Answer::NotCovered);
    // A torque that comes to zero after minutes has ended by then.
    let fading = || Function::Formula((Expression::variable(0) * -0.01 + 1.0).larger(0.0));
    let (answer, because) = verdict(vec![forever(Effect::Torque(Course::Each(vec![fading(), fading()])))]).unwrap();
    assert!(answer == Answer::Holds && because.contains("t = 128 s"), "{because}");
}

#[test]
fn regress_agents_that_are_pushed_for_ever_rest_where_nobody_predicts() {
    // s does not vanish, and z = −s takes part in what is conserved.
    let push = Push {
        effect: Effect::Torque(Course::Each(vec![Function::Constant(6.0), Function::Constant(0.0)])),
        from_s: 1.0,
        until_s: f64::INFINITY,
    };
    let mut setup = ring(vec![mass(0, &[1.0, 2.0]), mass(1, &[1.0, 2.0])], Exchange::Position, 60.0);
    assert!(predict(&setup).is_ok());
    setup.agents[1].pushes = vec![push.clone()];
    assert_eq!(predict(&setup), Err(NoPrediction::PushedForEver { agent: 1 }));
    setup.agents[1].pushes = vec![Push { until_s: 5.0, ..push }];
    assert!(predict(&setup).is_ok());
}

/// What check says of the agents' pushes, of the disturbances of chains and of the momentum of a spacecraft.
fn said(setup: &Setup, id: Id) -> Option<(Answer, String)> {
    let found: Vec<_> = check(setup).hypotheses.into_iter().filter(|hypothesis| hypothesis.id == id).collect();
    assert!(found.len() < 2);
    found.first().map(|hypothesis| (hypothesis.answer(), hypothesis.because()))
}

#[test]
fn thm_verdicts_on_pushes_are_given_for_every_kind_that_tracks_or_agrees() {
    let design = ThrustKind::Differentiable { alpha_star: 3.0, stiffness: 4.0 };
    let to = |agent| tracking(agent, vec![rest_at(0.1); 2]);
    let one = |agent| tracking(agent, vec![rest_at(0.1)]);
    let psi = Expression::number(1.0);
    for (setup, entries, conserves) in [
        (alone(vehicle(design, Floor::Stops(1.0))), 3, true),
        (one(blind_mass(5.0, 1.0)), 1, false),
        (alone(blind_mass(5.0, 1.0)), 1, false),
        (to(planar_tip()), 2, false),
        (one(chain(&psi, 1, true)), 1, false),
        (alone(chain(&psi, 1, true)), 1, true),
    ] {
        let verdict = |until_s: f64| {
            let mut setup = setup.clone();
            let effect = Effect::Torque(constant(&vec![0.5; entries]));
            setup.agents[0].pushes = vec![Push { effect, from_s: 1.0, until_s }];
            said(&setup, Id::PushesEnd).unwrap()
        };
        assert_eq!(said(&setup, Id::PushesEnd), None);
        assert_eq!(verdict(2.0), (Answer::Holds, "agent is pushed, and the last push has ended by t = 2 s".into()));
        let (answer, because) = verdict(f64::INFINITY);
        assert_eq!(answer, Answer::NotCovered);
        assert_eq!(because, "agent is pushed for ever: nothing says that the tracking error vanishes");
        // What is conserved is known of those whose tracking error drops out of it.
        let none = if setup.all_track() { NoPrediction::Targets } else { NoPrediction::Law };
        assert_eq!(predict(&setup).err(), (!conserves).then_some(none));
    }
}

/// V̇ ≤ −sᵀKs + sᵀτ: s is square-integrable where τ is, whether τ ends or not.
#[test]
fn prop_a_torque_whose_square_has_an_integral_need_not_end() {
    let t = || Expression::variable(0);
    let verdict = |by: fn(Course) -> Effect, torque: Expression| {
        let mut setup = ring(vec![mass(0, &[1.0, 2.0]), mass(1, &[1.0, 2.0])], Exchange::PositionVelocity, 20.0);
        let course = Course::Each(vec![Function::Formula(torque)]);
        setup.agents[1].pushes = vec![Push { effect: by(course), from_s: 0.0, until_s: f64::INFINITY }];
        said(&setup, Id::PushesEnd).unwrap()
    };
    let over = |by: Expression| (by + 1.0).power(-1.0);
    for fading in
        [(-t()).exp_of(), (t() * -0.05).exp_of() * t().sin_of(), over(t()) * 2.0, over(t().power(2.0)) * t().sin_of()]
    {
        let (answer, because) = verdict(Effect::Torque, fading.clone());
        assert_eq!(answer, Answer::Holds, "{fading:?}: {because}");
        assert!(because.contains("fades at least like 1/t"), "{because}");
    }
    // Neither ∫ sin² is finite nor ∫ 1/t, and what has no value at some time is no torque.
    for stays in [t().sin_of(), over(t()).power(0.5), over(t()) * t(), (t() - 30.0).power(-2.0)] {
        assert_eq!(verdict(Effect::Torque, stays.clone()).0, Answer::NotCovered, "{stays:?}");
    }
}

#[test]
fn thm7_a_torque_from_outside_spoils_the_momentum_that_the_law_was_told() {
    let mut setup = tracking(spacecraft(), [0.0, 0.0, 0.0, 1.0].map(rest_at).to_vec());
    assert_eq!(said(&setup, Id::KnownMomentum).unwrap().0, Answer::Holds);
    let torque = |until_s| Push { effect: Effect::Torque(constant(&[0.1; 3])), from_s: 1.0, until_s };
    // It ends, but what it leaves does not.
    setup.agents[0].pushes = vec![torque(2.0)];
    assert_eq!(said(&setup, Id::PushesEnd).unwrap().0, Answer::Holds);
    let (answer, because) = said(&setup, Id::KnownMomentum).unwrap();
    assert!(answer == Answer::NotCovered && because.contains("goes on with what it was at the start"), "{because}");
    setup.agents[0].pushes = vec![torque(1.0)];
    assert_eq!(said(&setup, Id::KnownMomentum).unwrap().0, Answer::Holds, "a push that never acts");
}

#[test]
fn a_disturbance_of_a_cascade_is_covered_where_the_input_enters_a_strict_one() {
    let (x, number) = (Expression::variable, Expression::number);
    let pushed = |known, input, values: &[f64]| {
        let mut setup = alone(cascade(known, input, 1));
        let effect = Effect::Torque(constant(values));
        setup.agents[0].pushes = vec![Push { effect, from_s: 1.0, until_s: 2.0 }];
        said(&setup, Id::MatchedDisturbance).map(|(answer, _)| answer)
    };
    let strict = |values: &[f64]| pushed(x(1), number(1.0), values);
    assert_eq!(strict(&[0.0, 0.7]), Some(Answer::Holds));
    assert_eq!(strict(&[0.2, 0.7]), Some(Answer::NotCovered));
    assert_eq!(pushed(x(1) * 2.0 + x(1).sin_of(), number(1.0), &[0.0, 0.7]), Some(Answer::NotCovered));
    let table = |values: &[f64]| {
        let mut setup = alone(cascade(x(1), number(1.0), 1));
        let (times_s, values) = (vec![0.0, 1.0], values.to_vec());
        let course = Course::Table(Table { times_s, values, between: Between::Linear });
        setup.agents[0].pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.0, until_s: 2.0 }];
        said(&setup, Id::MatchedDisturbance).unwrap().0
    };
    assert_eq!(table(&[0.0, 1.0, 0.0, 2.0]), Answer::Holds);
    assert_eq!(table(&[0.0, 1.0, 0.3, 2.0]), Answer::NotCovered);
    assert_eq!(said(&alone(cascade(x(1), number(1.0), 1)), Id::MatchedDisturbance), None, "nobody is disturbed");
    // Of three equations the first two are to be left alone.
    let three = |values: &[f64]| {
        let mut setup = alone(cascade(x(1), number(1.0), 1));
        let regressors = vec![vec![number(0.0)], vec![number(0.0)], vec![x(0)]];
        let terms = CascadeTerms::new(vec![x(1), x(2), number(0.0)], regressors, number(1.0)).unwrap();
        setup.agents[0].robot.kind = Arc::new(ChainModel::Cascade(Arc::new(terms)));
        setup.agents[0].pushes = vec![pulse(Effect::Torque(constant(values)))];
        said(&setup, Id::MatchedDisturbance).unwrap().0
    };
    assert_eq!(three(&[0.0, 0.0, 0.7]), Answer::Holds);
    assert_eq!([three(&[0.2, 0.0, 0.7]), three(&[0.0, 0.2, 0.7])], [Answer::NotCovered; 2]);
    // A chain of derivatives has one place only.
    let mut derivatives = alone(chain(&number(1.0), 1, true));
    derivatives.agents[0].pushes = vec![pulse(Effect::Torque(constant(&[0.3])))];
    assert_eq!(said(&derivatives, Id::MatchedDisturbance), None);
}
