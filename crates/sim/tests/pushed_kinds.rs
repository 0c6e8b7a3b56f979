//! Every kind of system is pushed: the Lyapunov balance counts the power of what acts from outside, sampled or not, and what makes
//! no sense for a kind is refused.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use crate::common::chains::{adaptive, cascades, derivatives, linearising, pure_feedback, tracking};
use crate::common::masses;
use crate::common::single::{anthropomorphic, craft, half_a_turn, planar, targets};
use crate::common::vehicles::{ADAPTIVE, DIFFERENTIABLE, rotorcraft, three, vehicle};
use crate::common::{RTOL, assert_first_order, balance_residual, column, last, run, sampled};
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::PlanarTip;
use forwardstep_core::robot::tree::{Axes, LinkPoint, Uncertain};
use forwardstep_sim::push::{AttachmentPoint, Course, Effect, Function, Push, PushError};
use forwardstep_sim::{Outcome, Setup, SetupError, Signal, TaskSpaceLaw, ThrustKind, TipSetup, simulate};

fn constant(values: &[f64]) -> Course {
    Course::Each(values.iter().map(|value| Function::Constant(*value)).collect())
}

/// A constant, and a sinusoid on the first entry.
fn swaying(values: &[f64]) -> Course {
    let mut all: Vec<Function> = values.iter().map(|value| Function::Constant(*value)).collect();
    all[0] = Function::Formula((Expression::variable(0) * PI).sin_of() * values[0]);
    Course::Each(all)
}

fn push(effect: Effect) -> Push {
    Push { effect, from_s: 0.7, until_s: 2.3 }
}

fn spring(axes: &[usize], target: &[f64]) -> Push {
    let (stiffness, damping) = (vec![3.0; axes.len()], vec![1.5; axes.len()]);
    push(Effect::SpringOnAxes { axes: axes.to_vec(), stiffness, damping, target: constant(target) })
}

/// What acts on an agent of each kind, alternately constant and swaying, so that no two agents are pushed alike.
fn pushed(mut setup: Setup, values: &[f64]) -> Setup {
    for (index, agent) in setup.agents.iter_mut().enumerate() {
        let need: usize =
            agent.robot.interface().attachments.blocks(agent.robot.axes.len()).iter().map(|(_, n)| n).sum();
        let own: Vec<f64> = (0..need).map(|k| values[k % values.len()] * (1.0 - 0.4 * index as f64)).collect();
        let course = if index % 2 == 0 { swaying(&own) } else { constant(&own) };
        agent.pushes = vec![push(Effect::Torque(course))];
    }
    setup
}

/// The largest entry of what was recorded of what acts on an agent.
fn largest(outcome: &Outcome, agent: usize, signal: Signal) -> f64 {
    let own = outcome.recording.columns.iter().filter(|c| (c.agent, c.signal) == (agent, signal));
    own.flat_map(|c| &c.values).fold(0.0, |most, value| most.max(value.abs()))
}

/// The balance of everybody, and that it would not hold without what acts from outside.
fn balances(setup: &Setup, floor: f64) {
    let outcome = run(setup);
    for (agent, own) in setup.agents.iter().enumerate() {
        let error = balance_residual(&outcome, agent, floor);
        assert!(error <= 10.0 * RTOL, "{} under {}: {error:e}", own.name, own.law.words().name);
        let acted = [Signal::External, Signal::ExternalTorque, Signal::Disturbance];
        let acted = acted.iter().map(|signal| largest(&outcome, agent, *signal)).fold(0.0, f64::max);
        assert_eq!(acted > 0.0, !own.pushes.is_empty(), "{}", own.name);
    }
}

#[test]
fn thm4_and_thm5_balances_count_the_power_of_forces_on_vehicles() {
    for kind in [vehicle(), rotorcraft()] {
        for design in [DIFFERENTIABLE, ADAPTIVE] {
            for in_formation in [false, true] {
                balances(&pushed(three(&kind, design, in_formation, 5.0), &[1.5, -1.0, 0.8, 0.03, -0.02, 0.04]), 0.0);
            }
        }
    }
}

#[test]
fn eq_a8_balance_counts_the_power_of_forces_on_masses() {
    for setup in [masses::tracking(), masses::consensus(2), masses::consensus(3)] {
        balances(&pushed(setup, &[2.0, -1.5]), 0.0);
    }
}

/// A force and a moment on the tip of a planar arm, and a spring that holds it.
fn at_the_tip() -> [Setup; 2] {
    let at = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 0.8] });
    let wrench = Effect::Wrench { at, wrench: constant(&[5.0, -4.0, 1.0]) };
    let spring = Effect::SpringOnPoint { at, stiffness: 20.0, damping: 2.0, target: constant(&[0.7, 0.9]) };
    [wrench, spring].map(|effect| {
        let mut setup = planar(None, 0.3);
        setup.time.end_s = 5.0;
        setup.agents[0].pushes = vec![push(effect)];
        setup
    })
}

#[test]
fn thm6_balance_counts_the_power_of_forces_on_end_effectors() {
    let mut turntable = anthropomorphic(Uncertain::Tool);
    turntable.time.end_s = 5.0;
    let point = match &turntable.agents[0].law.downcast::<TaskSpaceLaw>().unwrap().tip {
        TipSetup::Point { point, .. } => *point,
        TipSetup::Planar(_) => panic!("it is a tree"),
    };
    let at = AttachmentPoint::Link { point: LinkPoint { at: [0.4, 0.1, 0.0], ..point }, axes: Axes::Base };
    let mut lifted = turntable.clone();
    lifted.agents[0].pushes =
        vec![push(Effect::Wrench { at, wrench: constant(&[6.0, -3.0, 8.0, 0.5, 0.0, 1.0]) }), spring(&[1], &[-0.5])];
    for setup in at_the_tip().into_iter().chain([lifted, pushed(turntable, &[4.0, -6.0, 3.0])]) {
        balances(&setup, 0.0);
    }
}

/// The law goes on with the angular momentum that it was told, and loses what its proof says less what that costs.
#[test]
fn thm7_balance_counts_torques_on_the_body_and_the_momentum_that_they_leave() {
    for target in targets().into_iter().take(3) {
        balances(&pushed(craft(half_a_turn([0.1, -0.05, 0.08]), target, 5.0), &[0.4, -0.3, 0.2]), 0.0);
    }
}

#[test]
fn eq_43_balances_count_the_power_of_disturbances_of_chains() {
    for mut setup in [derivatives(), linearising(), adaptive(), cascades(), pure_feedback(), tracking()] {
        setup.time.end_s = 8.0;
        // Entries of all equations differ.
        balances(&pushed(setup, &[0.3, -0.2, 0.25, 0.15]), 1.0);
    }
}

#[test]
fn forces_that_end_do_not_keep_vehicles_from_their_agreement() {
    for design in [ThrustKind::Continuous, DIFFERENTIABLE, ADAPTIVE] {
        let outcome = run(&pushed(three(&vehicle(), design, false, 60.0), &[1.5, -1.0, 0.8]));
        for axis in 0..3 {
            let ends = [0, 1, 2].map(|agent| last(&outcome, agent, Signal::Position, axis));
            let apart = ends.iter().fold(f64::MIN, |a, b| a.max(*b)) - ends.iter().fold(f64::MAX, |a, b| a.min(*b));
            assert!(apart < 3e-3, "{design:?}: {ends:?}");
        }
    }
}

/// In a formation the state stands relative to the offset; a spring holds the body.
#[test]
fn hands_hold_where_a_vehicle_is_and_not_where_it_is_in_its_formation() {
    for kind in [vehicle(), rotorcraft()] {
        let mut setup = three(&kind, DIFFERENTIABLE, true, 4.0);
        setup.agents[1].pushes = vec![spring(&[2, 0], &[-3.0, 1.0])];
        for setup in [setup.clone(), sampled(setup, 500.0)] {
            let outcome = run(&setup);
            let (t_s, at) = (&outcome.recording.t_s, |signal, axis| column(&outcome, 1, signal, axis));
            for (axis, target) in [(2, -3.0), (0, 1.0)] {
                let (q, dq) = (at(Signal::Position, axis), at(Signal::Velocity, axis));
                for (row, force) in at(Signal::External, axis).iter().enumerate() {
                    let held = (0.7..2.3).contains(&t_s[row]);
                    let want = if held { 3.0 * (target - q[row]) - 1.5 * dq[row] } else { 0.0 };
                    assert!((force - want).abs() < 1e-9, "axis {axis} at {} s: {force} is not {want}", t_s[row]);
                }
            }
            assert!(largest(&outcome, 1, Signal::External) > 1.0);
            assert!(at(Signal::External, 1).iter().all(|force| *force == 0.0), "an axis that nobody holds");
        }
    }
}

#[test]
fn prop_sampled_systems_that_are_pushed_come_closer_to_continuous_ones_in_proportion_to_the_period() {
    let [arm, _] = at_the_tip();
    let setups = [
        (pushed(three(&rotorcraft(), ADAPTIVE, false, 3.0), &[1.5, -1.0, 0.8, 0.03, -0.02, 0.04]), 500.0),
        (pushed(masses::consensus(2), &[2.0, -1.5]), 500.0),
        (arm, 200.0),
        (pushed(craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(1), 5.0), &[0.4, -0.3, 0.2]), 200.0),
        (pushed(cascades(), &[0.3, -0.2, 0.25, 0.15]), 250.0),
    ];
    for (mut setup, hz) in setups {
        setup.time.end_s = 3.0;
        assert_first_order(&setup, hz);
        // It is no small thing that is compared.
        let [free, acted] = [false, true].map(|acted| {
            let mut setup = sampled(setup.clone(), hz);
            setup.agents.iter_mut().filter(|_| !acted).for_each(|agent| agent.pushes.clear());
            last(&run(&setup), 0, Signal::Position, 0)
        });
        assert!((free - acted).abs() > 1e-3, "{}: {free} and {acted}", setup.agents[0].name);
    }
}

#[test]
fn agents_that_nobody_pushes_are_as_they_were_beside_one_that_is() {
    // Spacecraft hear nobody: what acts on one is no business of the other.
    let mut setup = craft(half_a_turn([0.1, -0.05, 0.08]), targets().swap_remove(0), 5.0);
    setup.time.end_s = 3.0;
    setup.agents.push(setup.agents[0].clone());
    setup.agents[1].name = "other".into();
    setup.network.agents = 2;
    let free = run(&setup);
    let beside = run(&pushed_first(setup));
    assert!(largest(&beside, 0, Signal::ExternalTorque) > 0.1);
    assert_eq!(largest(&beside, 1, Signal::ExternalTorque), 0.0);
    let (was, is) = (last(&free, 1, Signal::Velocity, 0), last(&beside, 1, Signal::Velocity, 0));
    assert!((was - is).abs() < 1e-7 && (is - last(&beside, 0, Signal::Velocity, 0)).abs() > 1e-3);
}

fn pushed_first(setup: Setup) -> Setup {
    let mut setup = pushed(setup, &[0.4, -0.3, 0.2]);
    setup.agents[1].pushes.clear();
    setup
}

#[test]
fn what_cannot_act_on_a_kind_is_refused() {
    let refused = |mut setup: Setup, effect: Effect| {
        setup.agents[0].pushes = vec![push(effect)];
        match simulate(&setup, &mut |_| ControlFlow::Continue(())) {
            Err(SetupError::Push { push: 1, error, .. }) => error,
            other => panic!("{other:?}"),
        }
    };
    let spring = |axes: &[usize]| spring(axes, &vec![0.0; axes.len()]).effect;
    let attitude = || craft(half_a_turn([0.0; 3]), targets().swap_remove(0), 5.0);
    // Springs need axes that forces move: neither a quaternion nor a state of a chain is one.
    for setup in [attitude(), derivatives(), cascades()] {
        assert_eq!(refused(setup, spring(&[0])), PushError::NoSpring);
    }
    let torque = |values: &[f64]| Effect::Torque(constant(values));
    let length = |need, got| PushError::Length { what: "the torque", need, got };
    assert_eq!(refused(attitude(), torque(&[0.0; 4])), length(3, 4));
    assert_eq!(refused(derivatives(), torque(&[0.0; 2])), length(1, 2));
    assert_eq!(refused(cascades(), torque(&[0.0; 1])), length(2, 1));
    assert_eq!(refused(three(&vehicle(), ADAPTIVE, false, 1.0), torque(&[0.0; 6])), length(3, 6));
    assert_eq!(refused(three(&rotorcraft(), ADAPTIVE, false, 1.0), torque(&[0.0; 3])), length(6, 3));
    assert_eq!(
        refused(three(&rotorcraft(), ADAPTIVE, false, 1.0), spring(&[3])),
        PushError::NoSuchAxis { axis: 3, axes: 3 }
    );
    let at = AttachmentPoint::Tip(PlanarTip { length_m: [1.0, 1.0] });
    assert_eq!(refused(derivatives(), Effect::Wrench { at, wrench: constant(&[0.0; 3]) }), PushError::AttachmentPoint);
}
