//! What is asked whatever the reference dynamics are, and which member of a family a theorem is claimed for.

use std::sync::Arc;

use forwardstep_check::{Answer, Hypothesis, Id, Theorem, check};
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree, inertia_about_frame};
use forwardstep_core::robot::{Drives, Friction};
use forwardstep_sim::delay::{Delay, SawTooth};
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::reference::{Backstepping, PureIntegral, Tracking};
use forwardstep_sim::schedule::{Logged, Phase, Schedule};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{Exchange, Setup};

use super::{chain_of_three, constant, control, led, pair, with_weights};
use crate::common::kinds::{alone, blind_mass, chain, rest_at, tracking};
use crate::common::{edge, masses};

fn about(setup: &Setup, id: Id) -> Vec<Hypothesis> {
    check(setup).hypotheses.into_iter().filter(|hypothesis| hypothesis.id == id).collect()
}

/// The one hypothesis with this name.
fn the(setup: &Setup, id: Id) -> Hypothesis {
    let mut found = about(setup, id);
    assert_eq!(found.len(), 1, "{id:?}: {found:?}");
    found.remove(0)
}

/// Point masses under all reference dynamics.
fn everything() -> Vec<Setup> {
    let agreeing = || pair([constant(0.1), constant(0.1)]);
    let mut integral = agreeing();
    integral.reference = Arc::new(PureIntegral);
    let mut backstepping = agreeing();
    backstepping.reference = Arc::new(Backstepping { filter_s: 0.01, acceleration_limit: None });
    let mut targets = agreeing();
    targets.reference = Arc::new(Tracking);
    for agent in &mut targets.agents {
        agent.target = Some(Trajectory::new(vec![rest_at(1.0), rest_at(0.0)]).unwrap());
    }
    let swarm = FollowingDesign::Swarm { coupling: 10.0 };
    let follow = |design| led(chain_of_three(), design, [1.0, 2.5]);
    vec![agreeing(), integral, backstepping, targets, follow(FollowingDesign::Differentiable), follow(swarm)]
}

#[test]
fn what_surrounds_a_law_is_asked_under_all_reference_dynamics_and_of_all_kinds() {
    let one = Expression::number(1.0);
    let others = [tracking(blind_mass(1.0, 1.0), vec![rest_at(1.0)]), alone(chain(&one, 0, false))];
    for mut setup in everything().into_iter().chain(others) {
        let at_rest = [Id::PushesEnd, Id::ContinuousTime, Id::ExactMeasurements, Id::SmoothFriction];
        assert!(at_rest.iter().all(|id| about(&setup, *id).is_empty()), "{:?}", check(&setup));
        assert_eq!(the(&setup, Id::AppliedTorque).answer(), Answer::Holds);
        setup.agents[0].enforce_limits = true;
        assert_eq!(the(&setup, Id::AppliedTorque).answer(), Answer::NotCovered);
        let effect = Effect::Torque(Course::Each(vec![Function::Constant(1.0); 2]));
        let last = setup.agents.len() - 1;
        setup.agents[last].pushes = vec![Push { effect, from_s: 1.0, until_s: f64::INFINITY }];
        assert_ne!(the(&setup, Id::PushesEnd).answer(), Answer::Holds);
        setup.agents[last].pushes[0].until_s = 2.0;
        assert_eq!(the(&setup, Id::PushesEnd).answer(), Answer::Holds);
        setup.control = control(0.0);
        assert_eq!(the(&setup, Id::ContinuousTime).answer(), Answer::NotCovered);
        assert!(about(&setup, Id::ExactMeasurements).is_empty());
        setup.control.as_mut().unwrap().sensors.position_noise = 1e-3;
        assert_eq!(the(&setup, Id::ExactMeasurements).answer(), Answer::NotCovered);
    }
}

/// Two slides with friction.
fn slides(dry_s: Option<f64>) -> (Tree, Vec<f64>) {
    let link = |k: usize| LinkSpec {
        parent: k.checked_sub(1),
        x_parent_joint: Placement::IDENTITY,
        joint: LinkJoint::Moving {
            kind: JointKind::Prismatic,
            axis: if k == 0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] },
            damping: 0.0,
        },
        inertia: inertia_about_frame(2.0, [0.0; 3], [0.1, 0.0, 0.1, 0.0, 0.0, 0.1]),
    };
    let assembled = Tree::assemble(&[link(0), link(1)], [0.0, 0.0, -9.81]).unwrap();
    let friction = vec![Friction { joint: 1, width: 0.01 }];
    let mut theta = assembled.theta;
    theta.push(0.5);
    (assembled.tree.with_drives(Drives { friction, dry_s, ..Drives::default() }).unwrap(), theta)
}

#[test]
fn friction_is_asked_for_under_all_reference_dynamics() {
    for mut setup in everything() {
        for (dry_s, answer) in [(None, Answer::Holds), (Some(1e-3), Answer::NotCovered)] {
            let (tree, theta) = slides(dry_s);
            setup.agents[1].robot.kind = Arc::new(Arc::new(tree));
            setup.agents[1].robot.theta_names = vec![String::new(); theta.len()];
            setup.agents[1].robot.theta = theta;
            let friction = the(&setup, Id::SmoothFriction);
            assert_eq!(friction.answer(), answer);
            assert_eq!(friction.because().contains("arm-2"), dry_s.is_some(), "{}", friction.because());
        }
    }
}

/// Masses that all hear each other at once, with these roots.
fn with_roots(exchange: Exchange, roots: &[&[f64]]) -> Setup {
    let n = roots.len();
    let edges = (0..n).flat_map(|from| (0..n).map(move |to| (from, to))).filter(|(from, to)| from != to);
    let edges = edges.map(|(from, to)| edge(from, to, 1.0, 0)).collect();
    let mut setup = masses(exchange, 2, Schedule::fixed(edges), vec![constant(0.1)]);
    setup.agents.truncate(n);
    setup.network.agents = n;
    for (agent, roots) in setup.agents.iter_mut().zip(roots) {
        agent.roots_per_s = roots.to_vec().into();
    }
    setup
}

#[test]
fn thm3_names_the_member_of_the_family_by_exchange_order_and_roots() {
    let theorem = |exchange, roots: &[&[f64]]| check(&with_roots(exchange, roots)).theorem;
    let velocities = |roots: &[&[f64]]| theorem(Exchange::PositionVelocity, roots);
    assert_eq!(velocities(&[&[1.0], &[1.0]]), Theorem::FirstOrder);
    assert_eq!(velocities(&[&[1.0, 2.0], &[1.0, 2.0], &[1.0, 2.0]]), Theorem::Theorem2);
    // One agent with roots of its own is enough, wherever it stands.
    for odd in 0..3 {
        let mut roots: [&[f64]; 3] = [&[1.0, 2.0]; 3];
        roots[odd] = &[1.0, 2.5];
        assert_eq!(velocities(&roots), Theorem::Theorem3Velocities { order: 2 });
    }
    assert_eq!(velocities(&[&[1.0, 2.0, 2.0], &[1.0, 2.0, 2.0]]), Theorem::Theorem3Velocities { order: 3 });
    for order in 1..5 {
        let same: &[f64] = &vec![1.5; order];
        assert_eq!(theorem(Exchange::Position, &[same, same]), Theorem::Theorem3Positions { order });
    }
    let exchange = Exchange::PositionVelocity;
    let own = Theorem::OwnOrders { exchange, least: 1, most: 3 };
    assert_eq!(velocities(&[&[1.0, 2.0], &[1.0, 2.0, 3.0], &[1.0]]), own);
}

#[test]
fn thm3_orders_that_differ_are_named_with_the_first_two_that_do() {
    let orders = |roots: &[&[f64]]| check(&with_roots(Exchange::Position, roots)).hypotheses;
    let found = |hypotheses: Vec<Hypothesis>, id| hypotheses.into_iter().find(|hypothesis| hypothesis.id == id);
    let own = orders(&[&[1.0, 2.0], &[1.0, 2.0], &[1.0, 2.0, 3.0], &[1.0]]);
    let words = found(own.clone(), Id::OwnOrders).unwrap().because();
    assert!(words.contains("arm-1") && words.contains("arm-3") && !words.contains("arm-4"), "{words}");
    assert!(words.contains('2') && words.contains('3'), "{words}");
    assert!(found(own, Id::CommonOrder).is_none());
    let same = orders(&[&[1.0, 2.0, 4.0], &[1.0, 2.0, 3.0]]);
    assert!(found(same.clone(), Id::CommonOrder).unwrap().because().contains('3'));
    assert!(found(same, Id::OwnOrders).is_none());
}

#[test]
fn thm3_first_roots_that_differ_need_one_graph_that_stays_with_all_its_weights_and_delays() {
    let differing = |mut setup: Setup| {
        setup.exchange = Exchange::PositionVelocity;
        setup.agents[1].roots_per_s = vec![1.4, 2.0].into();
        the(&setup, Id::CommonFirstRoot).answer()
    };
    let saw = || Delay::new(SawTooth { min_s: 0.0, max_s: 0.1, period_s: 1.0, offset_s: 0.0 });
    assert_eq!(differing(pair([constant(0.1), constant(0.2)])), Answer::Holds);
    // One link that varies is enough, by its delay or by its weight.
    let broken = differing(pair([saw(), saw()]));
    assert_ne!(broken, Answer::Holds);
    assert_eq!(differing(pair([saw(), constant(0.2)])), broken);
    assert_eq!(differing(pair([constant(0.1), saw()])), broken);
    let wave = (Expression::variable(0) * 1.0).sin_of() + 2.0;
    assert_eq!(differing(with_weights([wave.clone(), wave])), broken);
    // Who only hears may have any.
    let mut chain = pair([constant(0.1), saw()]);
    chain.network.schedule = Schedule::fixed(vec![edge(0, 1, 1.0, 1)]);
    assert_eq!(differing(chain), Answer::Holds);
    // What comes before the graph that stays acts for a finite time.
    let both = || vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 1)];
    let phase = |edges| Phase { dwell_s: 1.0, edges };
    let mut once = pair([constant(0.1), constant(0.2)]);
    once.network.schedule = Schedule::once(vec![phase(vec![edge(0, 1, 1.0, 0)]), phase(both())]);
    assert_eq!(differing(once.clone()), Answer::Holds);
    once.network.schedule = Schedule::periodic(vec![phase(vec![edge(0, 1, 1.0, 0)]), phase(both())]);
    assert_eq!(differing(once), broken);
}

#[test]
fn what_a_table_says_of_switching_is_known_for_the_run_and_no_longer() {
    let logged = |starts_s: Vec<f64>, graphs: Vec<usize>| {
        let mut setup = pair([constant(0.1), constant(0.1)]);
        let each = vec![vec![edge(0, 1, 1.0, 0)], vec![edge(1, 0, 1.0, 1)]];
        setup.network.schedule = Schedule::logged(each, Logged { starts_s, graphs, until_s: 20.0 });
        setup
    };
    let several = logged(vec![0.0, 1.0, 3.0], vec![0, 1, 0]);
    let dwell = the(&several, Id::DwellTime);
    assert_eq!(dwell.answer(), Answer::HoldsOnHorizon);
    assert!(dwell.because().contains("lasts 1 s") && dwell.change().is_some(), "{dwell:?}");
    assert_eq!(the(&several, Id::SpanningTree).answer(), Answer::HoldsOnHorizon);
    // One phase is all that was seen of two.
    let one = logged(vec![0.0], vec![1]);
    assert_eq!(the(&one, Id::DwellTime).answer(), Answer::HoldsOnHorizon);
    assert_eq!(the(&one, Id::SpanningTree).answer(), Answer::HoldsOnHorizon);
    for setup in [several, one] {
        assert!(check(&setup).hypotheses.iter().all(|asked| {
            !matches!(asked.id, Id::DwellTime | Id::SpanningTree | Id::LeaderInEveryGraph)
                || asked.answer() != Answer::Holds
        }));
    }
}
