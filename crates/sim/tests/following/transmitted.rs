//! Designs that tell no measurement: an observer of the leader, and one vector to agree on.

use super::*;

/// The same of an observer, and of one vector to agree on, whatever s is: masses that weigh three times what their laws take them for,
/// pushed on the way.
#[test]
fn prop_no_robot_enters_an_observer() {
    no_robot_enters(masses(OBSERVER));
}

#[test]
fn prop_no_robot_enters_the_vector_that_is_told() {
    no_robot_enters(exactly(COMPOSITE));
}

fn no_robot_enters(mut problem: Setup) {
    let alone = without_s(&mut problem).1;
    for agent in &mut problem.agents {
        agent.robot.theta[0] *= 3.0;
        agent.law = Arc::new(Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(1.0),
            estimate_start: vec![0.3],
            bounds: None,
        });
        let effect = Effect::Torque(Course::Each(vec![Function::Constant(-15.0)]));
        agent.pushes = vec![Push { effect, from_s: 1.0, until_s: 2.0 }];
    }
    let (outcome, pushed) = without_s(&mut problem);
    let moved =
        (0..3).map(|agent| column(&outcome, agent, Signal::Error, 0).iter().fold(0.0, |m: f64, e| m.max(e.abs())));
    assert!(moved.fold(0.0, f64::max) > 0.5);
    for (alone, pushed) in alone.iter().zip(&pushed) {
        assert!(alone.iter().zip(pushed).all(|(a, b)| (a - b).abs() < 1e-9), "{alone:?} {pushed:?}");
    }
}

/// Three masses that estimate theirs behind 0.6 sin(0.8 t + 0.3), as `validation` starts them.
fn behind_a_wave(design: FollowingDesign) -> Setup {
    let mut setup = masses(design);
    let waves = vec![Sinusoid { amplitude: 0.6, rad_per_s: 0.8, phase_rad: 0.3 }];
    let trajectory = Trajectory::new(vec![Path::Sinusoids { offset: 0.0, waves }]).unwrap();
    assert!(setup.change_reference(|following: &mut Following| {
        following.leader = Leading::Motion(Leader { name: "leader".into(), trajectory });
    }));
    for (k, agent) in setup.agents.iter_mut().enumerate() {
        agent.robot.theta = vec![[0.8, 1.5, 2.3][k]];
        agent.law = Arc::new(Adaptive {
            damping: Gain::Number(3.0),
            adaptation: Gain::Number(2.0),
            estimate_start: vec![0.2],
            bounds: None,
        });
        (agent.start.q, agent.start.dq) = (vec![[0.9, -0.7, 0.4][k]], vec![[0.1, -0.3, 0.2][k]]);
    }
    setup
}

/// Against `validation/observer`, which integrates the errors of the proof.
#[test]
fn val_an_observer_agrees_with_an_independent_solver() {
    let truths: serde_json::Value =
        serde_json::from_str(include_str!("../../../../validation/observer/observer.json")).unwrap();
    let mut setup = behind_a_wave(FollowingDesign::Observer { kappa: 1.5 });
    assert!(setup.change_reference(|following: &mut Following| {
        (following.alpha, following.gain, following.choice) = (1.2, 2.0, Choice::Layer { width: 0.05 });
    }));
    setup.agents.iter_mut().for_each(|agent| agent.start.reference = vec![vec![0.0]]);
    let edge = |to, from, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    let edges = vec![edge(0, 3, 1.4), edge(1, 0, 0.9), edge(1, 2, 0.5), edge(2, 1, 1.1)];
    setup.network.schedule = Schedule::fixed(edges);
    let times: Vec<f64> = truths[0]["t_s"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect();
    (setup.time.end_s, setup.time.record_every_s) = (times.last().unwrap() + 0.1, times[0]);
    setup.solver.method = Method::Adaptive { rtol: 1e-11, atol: 1e-12 };
    let outcome = run(&setup);
    let signals = [
        ("q", Signal::Position),
        ("dq", Signal::Velocity),
        ("x", Signal::LeaderPosition),
        ("v", Signal::LeaderVelocity),
        ("theta_hat", Signal::Estimate),
    ];
    for (agent, (name, signal)) in (0..3).flat_map(|agent| signals.map(|signal| (agent, signal))) {
        let values = column(&outcome, agent, signal, 0);
        for (row, truth) in truths[0]["agents"][agent][name].as_array().unwrap().iter().enumerate() {
            let apart = (values[row + 1] - truth.as_f64().unwrap()).abs();
            assert!(apart < 1e-7, "{name} of agent {agent}, row {row}: {apart:e}");
        }
    }
}

/// Against `validation/composite`, which integrates z and ż and puts y together from them: over links that lead one way, over graphs that
/// take turns, and over links that delay.
#[test]
fn val_one_vector_agrees_with_an_independent_solver() {
    let truths = truth::read(include_str!("../../../../validation/composite/composite.json"));
    let mut setup = behind_a_wave(COMPOSITE);
    let edge = |to, from, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    let one_way = vec![edge(0, 3, 1.4), edge(1, 0, 0.9), edge(1, 2, 0.5), edge(2, 1, 1.1)];
    let other = vec![edge(2, 3, 0.8), edge(0, 2, 1.6), edge(1, 0, 0.4)];
    let phase = |edges: &[Edge]| Phase { dwell_s: 0.7, edges: edges.to_vec() };
    let teeth = Delay::new(SawTooth { min_s: 0.02, max_s: 0.12, period_s: 0.5, offset_s: 0.0 });
    let cases = [
        (Schedule::fixed(one_way.clone()), Delay::constant(0.0)),
        (Schedule::periodic(vec![phase(&one_way), phase(&other)]), Delay::constant(0.0)),
        (Schedule::fixed(one_way), teeth),
    ];
    assert_eq!(truths.len(), cases.len());
    for ((schedule, delay), truth) in cases.into_iter().zip(&truths) {
        (setup.network.schedule, setup.network.delays) = (schedule, vec![delay]);
        let worst = truth.largest_difference(setup.clone());
        assert!(worst < 1e-6, "({}): {worst:e}", truth.name);
    }
}

/// Over graphs that take turns and links whose delays jump ż goes on without a jump, where that of (122) jumps.
#[test]
fn own_one_vector_keeps_reference_accelerations_continuous_where_that_of_122_jumps() {
    let edge = |to, from, weight: f64| Edge { from, to, weight: weight.into(), delay: 0 };
    let phase = |edges| Phase { dwell_s: 0.5, edges };
    let jumps = |design, delay: Option<Delay>| {
        let mut problem = masses(design);
        problem.network.schedule = Schedule::periodic(vec![
            phase(vec![edge(0, 3, 1.0), edge(1, 0, 1.5), edge(2, 1, 0.7)]),
            phase(vec![edge(2, 3, 1.3), edge(1, 2, 0.8), edge(0, 1, 1.1)]),
        ]);
        if let Some(delay) = delay {
            problem.network.delays = vec![delay];
        }
        (problem.time.record_every_s, problem.time.end_s) = (1e-3, 3.0);
        let outcome = run(&problem);
        let steepest = |values: &&[f64]| values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        columns(&outcome, Signal::Reference(1)).iter().map(steepest).fold(0.0, f64::max)
    };
    let late =
        Delay::new(PiecewiseConstant { times_s: vec![0.0, 0.2], values_s: vec![0.15, 0.02], period_s: Some(0.45) });
    let (transmitted, late, of_122) =
        (jumps(COMPOSITE, None), jumps(COMPOSITE, Some(late)), jumps(FollowingDesign::WithoutAcceleration, None));
    // γ = 2.5 and what is heard move ż by hundredths in a millisecond.
    assert!(transmitted < 0.03 && late < 0.03 && of_122 > 0.2, "{transmitted} {late} {of_122}");
}

/// Arms on the move under samples come to continuous ones as samples come faster; with what each says at which sample.
fn first_messages(design: FollowingDesign) -> (Setup, Vec<(usize, u64, Vec<f64>)>) {
    let mut setup = arms(design, Choice::Layer { width: 0.05 }, 0.8, 6.0);
    setup.agents.iter_mut().for_each(|agent| agent.start.dq = vec![0.2, -0.1]);
    crate::common::assert_first_order(&setup, 400.0);
    let mut first = Vec::new();
    setup.time.end_s = 0.005;
    let setup = sampled(setup, 500.0);
    simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers {
            samples: Some(&mut |sample| {
                first.push((sample.agent, sample.sample, sample.message.to_vec()));
            }),
            ..Observers::default()
        },
    )
    .unwrap();
    (setup, first)
}

/// Sampled agents tell the vector that they held a sample ago, and come to the continuous ones as samples come faster.
#[test]
fn prop_sampled_agents_that_agree_on_one_vector_come_to_continuous_ones() {
    let (setup, first) = first_messages(COMPOSITE);
    let following = setup.following().unwrap();
    // y(0) = β z(0) + α q(0), with z(0) = q̇(0).
    for (agent, _, message) in first.iter().filter(|(_, sample, _)| *sample == 0) {
        for (axis, dq) in [0.2, -0.1].into_iter().enumerate() {
            let y = following.beta * dq + following.alpha * setup.agents[*agent].start.q[axis];
            assert!((message[axis] - y).abs() < 1e-12 && message.len() == 2, "{message:?}");
        }
    }
    assert_eq!(first.iter().filter(|(_, sample, _)| *sample == 2).count(), 4);
}

/// Sampled observers tell what they held a sample ago, and come to the continuous ones as samples come faster.
#[test]
fn prop_sampled_observers_come_to_continuous_ones() {
    let (setup, first) = first_messages(OBSERVER);
    // What is told first is what each starts with, not zeros.
    for (agent, _, message) in first.iter().filter(|(_, sample, _)| *sample == 0) {
        assert_eq!(message[..2], setup.agents[*agent].start.q[..]);
        assert_eq!(message[2..], [0.2, -0.1]);
    }
    let second: Vec<_> = first.iter().filter(|(_, sample, _)| *sample == 2).collect();
    assert_eq!(second.len(), 4);
    assert!(second.iter().all(|(agent, _, message)| message[..2] != setup.agents[*agent].start.q[..]));
}
