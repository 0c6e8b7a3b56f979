//! The identities of a derivation, evaluated along a run as a user asks for them: they hold to rounding for any order and any network,
//! and a run of anything else is noticed, by the equations that speak of it and by no other.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::derivation::Subject;
use forwardstep_check::derivation::residual::{Missing, Residual, Residuals};
use forwardstep_core::Gain;
use forwardstep_core::controller::Floor;
use forwardstep_core::expression::Expression;
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::{Wheel, Wheels};
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree};
use forwardstep_core::robot::{Drives, Friction};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::graph::Weight;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Adaptive, Exchange, Observers, PassivityFilterLaw, Setup, SpacecraftModel, ThrustKind, simulate, simulate_with,
};

use super::families::own_start;
use crate::common::{arm, edge, kinds, noise, setup};

/// The run of a setup against what is derived from another, which is the same unless something is to be noticed.
fn held_against(run: &Setup, derived: &Setup) -> Vec<Residual> {
    let mut residuals = Residuals::of(derived).unwrap();
    simulate_with(
        run,
        &mut |_| ControlFlow::Continue(()),
        Observers { moments: Some(&mut |moment| residuals.look(moment)), ..Observers::default() },
    )
    .unwrap();
    residuals.found().into_iter().flat_map(|(_, found)| found).collect()
}

/// The equations that are not rounding, by their places or sections.
fn noticed(run: &Setup, derived: &Setup) -> Vec<&'static str> {
    let found = held_against(run, derived);
    let broken = found.iter().filter(|residual| residual.holds() == Some(false));
    let mut names: Vec<&'static str> =
        broken.map(|one| if one.place.is_empty() { one.subject.name() } else { one.place }).collect();
    names.dedup();
    names
}

fn short(mut setup: Setup) -> Setup {
    setup.time.end_s = 1.0;
    setup.time.record_every_s = 0.05;
    setup
}

/// Four arms that adapt, in motion, over a graph that switches and delays that are late.
fn arms(roots_per_s: &[f64], exchange: Exchange) -> Setup {
    let mut agents: Vec<_> = (0..4).map(|i| arm(i, roots_per_s)).collect();
    for (i, agent) in agents.iter_mut().enumerate() {
        agent.manipulability = 0.2 * i as f64;
        agent.start.dq = vec![noise(i), noise(9 + i)];
        let theta = agent.robot.theta.iter().map(|theta| 0.6 * theta).collect();
        agent.law = Arc::new(Adaptive {
            damping: Gain::Matrix(vec![4.0, 1.0, 1.0, 3.0]),
            adaptation: Gain::Number(2.0),
            estimate_start: theta,
            bounds: None,
        });
    }
    let edges = [vec![edge(0, 1, 1.5, 0), edge(1, 2, 0.7, 1)], vec![edge(2, 3, 0.4, 1), edge(3, 0, 2.0, 0)]];
    let schedule = Schedule::periodic(edges.map(|edges| Phase { edges, dwell_s: 0.15 }).to_vec());
    let mut setup = short(setup(agents, exchange, schedule, vec![Delay::constant(0.04), Delay::constant(0.0)], 1.0));
    own_start(&mut setup, roots_per_s.len());
    setup
}

#[test]
fn prop_identities_of_robots_hold_to_rounding_for_orders_from_one_to_nine() {
    for order in 1..=9 {
        for exchange in [Exchange::Position, Exchange::PositionVelocity] {
            let roots: Vec<f64> = (0..order).map(|r| 0.7 + 0.9 * r as f64).collect();
            let found = held_against(&arms(&roots, exchange), &arms(&roots, exchange));
            assert!(found.iter().all(|one| one.holds() != Some(false)), "{order} {exchange:?}: {found:?}");
            let held = |subject| found.iter().filter(|one| one.subject == subject && one.holds() == Some(true)).count();
            // λ differs, so that each of the four is a design of its own.
            assert_eq!(held(Subject::ReferenceDynamics), 4, "{order} {exchange:?}");
            assert_eq!(held(Subject::Controller), 12);
            // The lower subsystem and the upper one.
            assert_eq!(held(Subject::Cascade), 8);
            assert!(held(Subject::DegreeReduction) >= 4 && held(Subject::Laplacian) >= 4, "{order}: {found:?}");
            // What is left out says only what letters stand for.
            let missing = found.iter().filter_map(|one| one.largest.as_ref().err());
            assert!(missing.clone().all(|missing| *missing == Missing::Definition), "{found:?}");
        }
    }
}

#[test]
fn identities_hold_for_one_agent_without_links_weights_that_follow_formulas_and_a_nonlinear_coupling() {
    let mut alone = arms(&[1.0, 2.0], Exchange::PositionVelocity);
    alone.agents.truncate(1);
    alone.network.agents = 1;
    alone.network.schedule = Schedule::fixed(Vec::new());
    assert_eq!(noticed(&alone, &alone), [""; 0]);
    let mut weighted = arms(&[1.0, 2.0, 3.0], Exchange::Position);
    let formula = (Expression::variable(0) * 3.0).sin_of() + 1.5;
    weighted.network.weights = vec![BoundedFormula::new(formula, 1.0)];
    let mut edges = vec![edge(0, 1, 1.0, 0), edge(1, 0, 1.0, 1), edge(1, 2, 1.0, 0), edge(2, 3, 1.0, 0)];
    edges.iter_mut().for_each(|edge| edge.weight = Weight::Formula(0));
    weighted.network.schedule = Schedule::fixed(edges);
    assert_eq!(noticed(&weighted, &weighted), [""; 0]);
}

#[test]
fn a_run_of_something_else_is_noticed_by_the_equations_that_speak_of_it_and_by_no_other() {
    let derived = arms(&[1.0, 2.0], Exchange::PositionVelocity);
    assert_eq!(noticed(&derived, &derived), [""; 0]);
    let change = |change: fn(&mut Setup)| {
        let mut run = derived.clone();
        change(&mut run);
        noticed(&run, &derived)
    };
    // Reference dynamics, and all that follows from them.
    let of_reference = ["(a1)", "(26) for (a1)", "(27)", "(a2)", "degree_reduction", "laplacian"];
    let roots = change(|run| run.agents[2].roots_per_s.real[1] *= 1.0 + 1e-7);
    assert!(roots.iter().all(|name| of_reference.contains(name)) && roots.contains(&"(a1)"), "{roots:?}");
    let lambda = change(|run| run.agents[0].manipulability = 1e-6);
    assert!(lambda.iter().all(|name| of_reference.contains(name)) && lambda.contains(&"(a1)"), "{lambda:?}");
    // The law: what it makes of s, not the robot.
    let gain = change(|run| {
        assert!(run.agents[1].change_law(|law: &mut Adaptive| law.damping = Gain::Matrix(vec![4.0, 1.0, 1.0, 3.0001])));
    });
    assert_eq!(gain, ["(6)", "(26) for (a1)"]);
    let adaptation = change(|run| {
        assert!(run.agents[3].change_law(|law: &mut Adaptive| law.adaptation = Gain::Number(2.000_01)));
    });
    assert_eq!(adaptation, ["(7)"]);
    // The robot: its motion and what is left of s, not the law.
    assert_eq!(change(|run| run.agents[1].robot.theta[0] *= 1.0 + 1e-6), ["(1)", "(26) for (a1)"]);
    // A push that the derivation knows nothing of.
    let pushed = change(|run| {
        let effect = Effect::Torque(Course::Each(vec![Function::Constant(1e-3); 2]));
        run.agents[0].pushes.push(Push { effect, from_s: 0.2, until_s: 0.6 });
    });
    assert_eq!(pushed, ["(1)", "(26) for (a1)"]);
}

/// Four trees with damping, rotors and friction, whose estimates are kept within bounds.
fn rubbing_arms(dry_s: Option<f64>, friction_n_m: f64) -> Setup {
    let mut setup = arms(&[1.0, 2.0], Exchange::PositionVelocity);
    let tree = |damping: f64| {
        let link = |k: usize| LinkSpec {
            parent: k.checked_sub(1),
            x_parent_joint: Placement { translation: [0.4, 0.1, 0.2], ..Placement::IDENTITY },
            joint: LinkJoint::Moving { kind: JointKind::Revolute, axis: [0.0, 1.0, 0.0], damping },
            inertia: [3.0, 0.5, 0.0, 0.0, 0.1, 0.0, 0.5, 0.0, 0.0, 0.5],
        };
        let assembled = Tree::assemble(&[link(0), link(1)], [0.0, 0.0, -9.81]).unwrap();
        let friction = vec![Friction { joint: 0, width: 0.3 }, Friction { joint: 1, width: 0.2 }];
        let theta = [&assembled.theta[..], &[0.3, friction_n_m, 0.7]].concat();
        let drives = Drives { geared: vec![1], friction, dry_s, ..assembled.tree.drives().clone() };
        (Arc::new(assembled.tree.with_drives(drives).unwrap()), theta)
    };
    let trees = [tree(0.0), tree(0.4)];
    for (i, agent) in setup.agents.iter_mut().enumerate() {
        let (tree, theta) = &trees[i % 2];
        agent.robot.kind = Arc::new(Arc::clone(tree));
        agent.robot.theta.clone_from(theta);
        agent.robot.theta_names = (0..theta.len()).map(|k| format!("t{k}")).collect();
        let ends = |by: f64| theta.iter().map(|own| own + by * (own.abs() + 0.1)).collect();
        agent.law = Arc::new(Adaptive {
            damping: Gain::Number(4.0),
            adaptation: Gain::Number(2.0),
            // At a bound, so that projection acts.
            estimate_start: theta.iter().map(|own| own + 0.31 * (own.abs() + 0.1)).collect(),
            bounds: Some(ParameterBounds::new(ends(-0.3), ends(0.3), 0.05)),
        });
    }
    setup
}

#[test]
fn identities_hold_with_rotors_and_friction_smooth_or_dry_and_notice_another_friction() {
    for dry_s in [None, Some(2e-3)] {
        let derived = rubbing_arms(dry_s, 0.5);
        assert_eq!(noticed(&derived, &derived), [""; 0], "{dry_s:?}");
        let mut other = derived.clone();
        other.agents[1].robot = rubbing_arms(dry_s, 0.500_01).agents.swap_remove(1).robot;
        // Dry friction is a part of what acts from outside, whatever it is: no equation holds F then.
        let noticed_by: &[&str] = if dry_s.is_none() { &["(1)", "(26) for (a1)"] } else { &[] };
        assert_eq!(noticed(&other, &derived), noticed_by);
        let mut free = derived.clone();
        for agent in &mut free.agents {
            assert!(agent.change_law(|law: &mut Adaptive| law.bounds = None));
        }
        assert_eq!(noticed(&free, &derived), ["(7)"], "{dry_s:?}");
    }
}

#[test]
fn the_run_that_is_looked_at_has_the_same_bits() {
    let setup = arms(&[1.0, 2.0], Exchange::PositionVelocity);
    let plain = simulate(&setup, &mut |_| ControlFlow::Continue(())).unwrap();
    let mut count = 0_usize;
    let looked = simulate_with(
        &setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { moments: Some(&mut |_| count += 1), ..Observers::default() },
    )
    .unwrap();
    assert_eq!(plain.recording, looked.recording);
    assert_eq!(count, 4 * plain.recording.t_s.len());
}

#[test]
fn masses_without_velocity_spacecraft_and_chains_have_identities_of_their_own() {
    let mass = short(kinds::alone(kinds::blind_mass(3.0, 1.4)));
    let heavier = |mass: &Setup| {
        let mut other = mass.clone();
        other.agents[0].robot.theta[0] += 1e-6;
        other
    };
    let mut moving = mass.clone();
    moving.agents[0].start.dq = vec![0.4];
    assert_eq!(noticed(&moving, &moving), [""; 0]);
    let found = noticed(&heavier(&moving), &moving);
    assert!(found.contains(&"(a7)") && !found.contains(&"(a8)"), "{found:?}");

    let rest = [0.3, -0.2, 0.1, 1.0].map(kinds::rest_at).to_vec();
    let mut craft = short(kinds::tracking(kinds::spacecraft(), rest));
    craft.agents[0].start.dq = vec![0.2, -0.1, 0.3];
    let held = held_against(&craft, &craft);
    let places: Vec<_> = held.iter().filter(|one| one.holds() == Some(true)).map(|one| one.place).collect();
    assert_eq!(
        places,
        ["(97)", "(94)", "(99)", "(100)", "(106)", "(107), second line", "(107), first line"],
        "{held:?}"
    );
    let mut slower = craft.clone();
    assert!(slower.agents[0].change_law(|law: &mut forwardstep_sim::AttitudeLaw| law.filter = Gain::Number(1.001)));
    assert_eq!(noticed(&slower, &craft), ["(100)"]);

    // Without z: beside a target that turns, whose ω_d stands in the law and in what is left.
    let wave = |rate: f64| kinds::formula((Expression::variable(0) * rate).sin_of());
    let turning = vec![wave(0.7), wave(0.4), kinds::rest_at(0.1), kinds::rest_at(1.0)];
    let mut filtered = short(kinds::tracking(kinds::filtered_spacecraft(), turning));
    filtered.agents[0].start.dq = vec![0.2, -0.1, 0.3];
    filtered.agents[0].start.rest = vec![1.0, -0.5, 0.4];
    let held = held_against(&filtered, &filtered);
    assert!(held.len() == 5 && held.iter().all(|one| one.holds() == Some(true)), "{held:?}");
    let differ = |change: &dyn Fn(&mut PassivityFilterLaw)| {
        let mut other = filtered.clone();
        assert!(other.agents[0].change_law(change));
        held_against(&other, &filtered).iter().filter(|one| one.holds() == Some(false)).count()
    };
    assert_eq!(differ(&|law| law.error_gain_n_m *= 1.0 + 1e-6), 2, "the law and what is left");
    assert_eq!(differ(&|law| law.filter = Gain::Number(1.001)), 1);

    // Three wheels whose axes lie in one plane but for a ten-thousandth: what the motors do cancels nearly.
    let wheel = |axis| Wheel { axis, torque_limit_n_m: None, momentum_limit_n_m_s: None };
    let flat = Wheels::new(&[[0.745, 0.0, 0.667], [-0.737, 0.675, 0.0], [0.065, -0.742, -0.667]].map(wheel)).unwrap();
    let with = |inertia_kg_m2| {
        let mut craft = craft.clone();
        craft.agents[0].robot.kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels: flat.clone() });
        craft
    };
    let [flat, lighter] = [10.0, 9.99].map(|first| with([[first, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 6.0]]));
    assert_eq!(noticed(&flat, &flat), [""; 0]);
    assert!(noticed(&lighter, &flat).contains(&"(94)"), "{:?}", noticed(&lighter, &flat));

    let measured = |estimate_start: f64, gamma_star: f64, bounds| {
        let design =
            ThrustKind::ByAcceleration { alpha_star: 3.0, gamma_star, estimate_start, bounds, bias: [0.1, 0.0, -0.2] };
        let mut vehicle = short(kinds::alone(kinds::vehicle(design, Floor::Stops(1.0))));
        vehicle.agents[0].start.dq = vec![0.4, -0.2, 0.1];
        vehicle
    };
    let within = Some(Range { lower: 1.8, upper: 2.5 });
    for bounds in [None, within] {
        let vehicle = measured(1.6, 0.2, bounds);
        assert_eq!(noticed(&vehicle, &vehicle), [""; 0]);
        assert_eq!(noticed(&measured(1.6, 0.201, bounds), &vehicle), ["(58)"]);
    }
    assert_eq!(noticed(&measured(1.6, 0.2, None), &measured(1.6, 0.2, within)), ["(58)"]);

    let mut chain = short(kinds::alone(kinds::chain(&Expression::number(2.0), 1, true)));
    chain.agents[0].start.dq = vec![0.5];
    assert_eq!(noticed(&chain, &chain), [""; 0]);
    let mut other = chain.clone();
    other.agents[0].robot.theta[0] += 1e-3;
    let found = noticed(&other, &chain);
    assert!(found.contains(&"(33)") && found.contains(&"(43)"), "{found:?}");
}
