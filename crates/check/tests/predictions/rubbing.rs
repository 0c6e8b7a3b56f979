//! Dry friction feeds V, and the mean of the tracking error stays below what it can feed.

use std::ops::ControlFlow;
use std::sync::Arc;

use forwardstep_check::derivation::{Line, Subject, explain};
use forwardstep_check::manipulability::{Manipulability, NoManipulability, Trial, measure};
use forwardstep_check::smoothness::{NoSmoothness, NotCovered, smoothness};
use forwardstep_check::{
    Finding, Injection, InjectionBalance, InjectionWatch, NoPrediction, PowerBound, along, predict,
};
use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree, inertia_about_frame};
use forwardstep_core::robot::{Drives, Friction, SMOOTHING_LOSS};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Known, Network, Observers, RobotSetup, Setup, simulate_with,
};

use super::course::predicted;
use super::{bound, sine};
use crate::common::run;

const FRICTION: f64 = 3.0;
const WIDTH: f64 = 0.05;

/// A tree of these joints in a row with dry friction, and its parameters.
fn rubbing(kinds: &[(JointKind, [f64; 3])], dry_s: Option<f64>) -> (Tree, Vec<f64>) {
    let links = kinds.iter().enumerate().map(|(k, (kind, axis))| LinkSpec {
        parent: k.checked_sub(1),
        x_parent_joint: Placement { translation: [0.4, 0.0, 0.0], ..Placement::IDENTITY },
        joint: LinkJoint::Moving { kind: *kind, axis: *axis, damping: 0.1 },
        inertia: inertia_about_frame(2.0, [0.2, 0.0, 0.0], [0.03, 0.0, 0.05, 0.0, 0.0, 0.04]),
    });
    let assembled = Tree::assemble(&links.collect::<Vec<_>>(), [0.0, 0.0, -9.81]).unwrap();
    let friction = (0..kinds.len()).map(|joint| Friction { joint, width: WIDTH }).collect();
    let mut theta = assembled.theta;
    theta.extend(kinds.iter().map(|_| FRICTION));
    let drives = Drives { friction, dry_s, ..assembled.tree.drives().clone() };
    (assembled.tree.with_drives(drives).unwrap(), theta)
}

const Z: [f64; 3] = [0.0, 0.0, 1.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const X: [f64; 3] = [1.0, 0.0, 0.0];

/// Arms in a ring that start with s = 0, and with estimates that are `off` by so much of themselves.
fn arms(kinds: &[(JointKind, [f64; 3])], agents: usize, dry_s: Option<f64>, off: f64) -> Setup {
    let (tree, theta) = rubbing(kinds, dry_s);
    let tree = Arc::new(tree);
    let n = kinds.len();
    let arm = |k: usize| {
        let axes: Vec<Axis> = (0..n).map(|joint| Axis::new(format!("j{joint}"), AxisUnit::Radian)).collect();
        let robot = RobotSetup::new(Arc::clone(&tree), theta.clone(), axes);
        let bounds = |sign: f64| theta.iter().map(|own| own + sign * (0.3 * own.abs() + 0.02)).collect();
        let law = Adaptive {
            damping: Gain::Number(30.0),
            adaptation: Gain::Number(0.4),
            estimate_start: theta.iter().map(|own| own * (1.0 - off)).collect(),
            bounds: Some(ParameterBounds::new(bounds(-1.0), bounds(1.0), 0.01)),
        };
        let at = |joint: usize| (1.3 * (k * n + joint) as f64).sin();
        AgentSetup::new(format!("arm-{k}"), robot, law)
            .roots([1.0, 2.0])
            .at(&(0..n).map(at).collect::<Vec<_>>())
            .moving(&vec![0.0; n])
    };
    let ring = (0..agents).map(|k| (k, (k + 1) % agents)).filter(|(from, to)| from != to);
    let network = Network::fixed(agents, ring, Delay::constant(0.1));
    let mut setup = Setup::consensus((0..agents).map(arm).collect::<Vec<_>>(), network, 20.0);
    setup.time.record_every_s = 0.02;
    setup
}

const SPATIAL: &[(JointKind, [f64; 3])] =
    &[(JointKind::Revolute, Z), (JointKind::Revolute, Y), (JointKind::Prismatic, X)];
const PLANAR: &[(JointKind, [f64; 3])] = &[(JointKind::Revolute, Y), (JointKind::Revolute, Y)];

fn watched(setup: &Setup) -> (f64, PowerBound, PowerBound) {
    let before = bound(setup).unwrap();
    let power = along(setup, &run(setup).recording).power.unwrap();
    (power.mean_w, before, power.bound.unwrap())
}

#[test]
fn thm_dry_friction_leaves_no_more_tracking_error_than_it_feeds() {
    for (kinds, agents, off, sample_hz, least) in [
        (SPATIAL, 3, 0.0, None, 0.25),
        (SPATIAL, 3, 0.0, Some(500.0), 0.2),
        (PLANAR, 2, 0.0, None, 0.2),
        (PLANAR, 2, 0.0, Some(2000.0), 0.12),
        (PLANAR, 4, 0.002, Some(2000.0), 0.02),
    ] {
        let setup = arms(kinds, agents, Some(1e-3), off);
        let setup = if let Some(sample_hz) = sample_hz { setup.sampled(sample_hz) } else { setup };
        let (mean_w, before, after) = watched(&setup);
        let supply_w = SMOOTHING_LOSS * WIDTH * FRICTION * (agents * kinds.len()) as f64;
        assert!((before.friction_w - supply_w).abs() < 1e-12 && after.friction_w == before.friction_w);
        assert_eq!((before.push_w, after.push_w), (0.0, 0.0), "what rubs is no push");
        assert!(mean_w < after.mean_w && mean_w > least * after.mean_w, "{mean_w} {after:?}");
        assert!(mean_w < before.mean_w, "{before:?}");
        if sample_hz.is_none() {
            assert!((before.mean_w - supply_w).abs() < 1e-9, "V(0) = 0 and nothing pushes: {before:?}");
        }
    }
}

#[test]
fn what_rubs_and_what_pushes_are_told_apart_before_and_after_the_run() {
    let mut setup = arms(PLANAR, 2, Some(1e-3), 0.0);
    setup.time.end_s = 6.0;
    let rubbed = bound(&setup).unwrap();
    let effect = Effect::Torque(Course::Each(vec![Function::Constant(3.0), sine(2.0, 5.0)]));
    setup.agents[1].pushes = vec![Push { effect, from_s: 1.0, until_s: 4.0 }];
    let (mean_w, before, after) = watched(&setup);
    // (9 + 4)/30 over half of the time.
    assert!(
        (before.push_w - 0.5 * 13.0 / 30.0).abs() < 1e-6 && (after.push_w - before.push_w).abs() < 1e-6,
        "{after:?}"
    );
    assert!(before.friction_w == rubbed.friction_w && mean_w < after.mean_w, "{mean_w} {after:?}");
    let text = Finding::TrackingPower(before).because();
    assert!(text.contains(", pushes 0.2167 W, dry friction 0.1671 W") && text.contains(" is at most "), "{text}");
    let numbers = Finding::TrackingPower(before).numbers();
    assert!(numbers.contains(&("friction_w", before.friction_w)), "{numbers:?}");
    // A hand is known only along the run, and there only together with what rubs.
    let effect = Effect::SpringOnAxes {
        axes: vec![0],
        stiffness: vec![1.0],
        damping: vec![0.0],
        target: Course::Each(vec![Function::Constant(0.0)]),
    };
    setup.agents[1].pushes = vec![Push { effect, from_s: 1.0, until_s: 4.0 }];
    assert_eq!(bound(&setup), None);
    let power = along(&setup, &run(&setup).recording).power.unwrap();
    assert!(power.bound.is_none() && power.mean_w > 0.0, "{power:?}");
}

#[test]
fn v_may_grow_where_friction_is_dry_and_not_where_it_is_smooth() {
    let bounded = |dry_s: Option<f64>| {
        let mut setup = arms(PLANAR, 2, dry_s, 0.1);
        setup.time.end_s = 2.0;
        predicted(&setup).peak_torques.iter().map(|peak| peak.at_most.is_some()).collect::<Vec<_>>()
    };
    assert_eq!(bound(&arms(PLANAR, 2, None, 0.1)), None, "nothing feeds V but its start");
    assert_eq!(bounded(None), [true; 4]);
    assert_eq!(bounded(Some(1e-3)), [false; 4], "a bound on the torque from V(0) needs a V that does not grow");
}

/// The balances of a run at samples, whose terms add up to what V changes by.
fn balances(setup: &Setup) -> Vec<InjectionBalance> {
    let mut watch = InjectionWatch::of(setup).unwrap();
    simulate_with(
        setup,
        &mut |_| ControlFlow::Continue(()),
        Observers { inside: Some(&mut watch), ..Observers::default() },
    )
    .unwrap();
    let balances = watch.balances();
    assert_eq!(balances.len(), setup.agents.len());
    for balance in &balances {
        assert!(balance.residual_j().abs() < 1e-9 * balance.largest_j, "{balance:?}, {}", balance.residual_j());
    }
    balances
}

#[test]
fn prop_what_dry_friction_puts_into_v_counts_by_itself_and_not_as_pushed() {
    let mut setup = arms(PLANAR, 2, Some(1e-3), 0.0).sampled(500.0);
    setup.time.end_s = 6.0;
    let dry = balances(&setup);
    let most_j = bound(&setup).unwrap().friction_w * setup.time.end_s;
    let rubbed_j: f64 = dry.iter().map(|balance| balance.term_j(Injection::Rubbed)).sum();
    assert!(rubbed_j > 0.1 * most_j && rubbed_j < most_j, "{rubbed_j} of {most_j}");
    for balance in &dry {
        assert_eq!(balance.term_j(Injection::Pushed), 0.0, "{balance:?}");
        assert!(balance.term_j(Injection::Dissipated) < 0.0, "{balance:?}");
    }
    assert!(dry.iter().any(|balance| matches!(balance.first, Some((Injection::Rubbed, _)))), "{dry:?}");
    // Smooth, it damps, and nothing else.
    let mut smooth = arms(PLANAR, 2, None, 0.05).sampled(500.0);
    smooth.time.end_s = 6.0;
    assert!(balances(&smooth).iter().all(|balance| balance.term_j(Injection::Rubbed) == 0.0));
    // What else acts is a push, as if nothing rubbed.
    let effect = Effect::Torque(Course::Each(vec![Function::Constant(6.0), sine(5.0, 5.0)]));
    setup.agents[1].pushes = vec![Push { effect, from_s: 1.0, until_s: 4.0 }];
    let pushed = balances(&setup);
    let terms = |balance: &InjectionBalance| [Injection::Rubbed, Injection::Pushed].map(|of| balance.term_j(of));
    assert!(terms(&pushed[0])[1] == 0.0 && terms(&pushed[1])[1] > 0.05, "{pushed:?}");
    assert!(pushed.iter().all(|balance| terms(balance)[0] < most_j), "{pushed:?}");
}

#[test]
fn what_needs_an_s_that_vanishes_is_refused_where_joints_rub_dryly() {
    let (dry, smooth) = (arms(PLANAR, 2, Some(1e-3), 0.0), arms(PLANAR, 2, None, 0.0));
    assert_eq!(predict(&dry), Err(NoPrediction::DryFriction { agent: 0 }));
    assert!(predict(&smooth).is_ok());
    let transfer = |setup: &Setup| Manipulability::of(setup, 1, 0).err();
    assert_eq!((transfer(&dry), transfer(&smooth)), (Some(NoManipulability::DryFriction { agent: 0 }), None));
    let jumps = |setup: &Setup| smoothness(setup, &mut |_| ControlFlow::Continue(())).err();
    let refused = Some(NoSmoothness::NoAgent { name: "arm-0".into(), reason: NotCovered::DryFriction });
    assert_eq!((jumps(&dry), jumps(&smooth)), (refused, None));
    // (3) and (23) conserve nothing that friction moves, but for the manipulability gain, which lets s do so.
    let integral = |dry_s, lambda| {
        let mut setup = arms(PLANAR, 2, dry_s, 0.0);
        setup.reference = Arc::new(PureIntegral);
        for agent in &mut setup.agents {
            agent.law = Arc::new(Known { damping: Gain::Number(30.0) });
            agent.manipulability = lambda;
        }
        predict(&setup)
    };
    assert!(integral(Some(1e-3), 0.0).is_ok() && integral(None, 0.5).is_ok());
    assert_eq!(integral(Some(1e-3), 0.5), Err(NoPrediction::Manipulability { agent: 0 }));
}

#[test]
fn eq_31_smooth_friction_damps_a_slow_push_by_f_over_its_width() {
    let gain = |width: f64| {
        let mut setup = arms(PLANAR, 2, None, 0.0);
        let law = Arc::new(Known { damping: Gain::Number(30.0) });
        for agent in &mut setup.agents {
            agent.law = law.clone();
            let tree = Tree::clone(agent.robot.kind.downcast::<Arc<Tree>>().unwrap());
            let friction = (0..2).map(|joint| Friction { joint, width }).collect();
            let drives = Drives { friction, ..tree.drives().clone() };
            agent.robot.kind = Arc::new(Arc::new(tree.with_drives(drives).unwrap()));
        }
        let theory = Manipulability::of(&setup, 0, 1).unwrap().low_frequency();
        let trial = Trial { agent: 0, axis: 1, torque: 0.01, for_s: 1.0 };
        let measured = measure(&setup, trial, &mut |_| ControlFlow::Continue(())).unwrap();
        assert!((measured.by_constant / theory.by_constant() - 1.0).abs() < 1e-3, "{measured:?} {theory:?}");
        theory.gain
    };
    // (K + D + F/ε)⁻¹ with D = 0.1.
    let ratio = gain(0.05) / gain(0.1);
    assert!((ratio - (30.1 + FRICTION / 0.1) / (30.1 + FRICTION / 0.05)).abs() < 1e-9, "{ratio}");
}

/// The words of a section of what is explained of the first design.
fn explained(setup: &Setup, subject: Subject) -> String {
    let design = explain(setup).designs.swap_remove(0);
    let section = design.sections.into_iter().find(|section| section.subject == subject).unwrap();
    let words = section.lines.into_iter().filter_map(|line| match line {
        Line::Words(words) => Some(words),
        Line::Formula(..) => None,
    });
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn why_a_loop_converges_says_what_friction_and_pushes_bring_into_v() {
    let words = |setup: &Setup| explained(setup, Subject::Convergence);
    let smooth = words(&arms(PLANAR, 2, None, 0.0));
    assert!(smooth.contains("V̇ = −sᵀ(K + D)s − sᵀF[tanh(ε⁻¹q̇) − tanh(ε⁻¹z)] ≤ −sᵀ(K + D)s"), "{smooth}");
    assert!(smooth.contains("tanh rises") && smooth.contains("s is bounded and square-integrable"), "{smooth}");
    assert!(smooth.contains("qᵢ − qⱼ → 0") && !smooth.contains("τ_ext"), "{smooth}");
    let mut setup = arms(PLANAR, 2, Some(1e-3), 0.0);
    let dry = words(&setup);
    assert!(dry.contains("V̇ ≤ −sᵀ(K + D)s + 0.2785 Σ ε F") && dry.contains("need not vanish"), "{dry}");
    assert!(dry.contains("ϑ̂ stays within its bounds"), "{dry}");
    assert!(!dry.contains("square-integrable") && !dry.contains("→ 0") && !dry.contains("τ_ext"), "{dry}");
    assert!(explained(&setup, Subject::Controller).contains("τ_ext holds the dry friction"));
    assert_eq!(explained(&arms(PLANAR, 2, None, 0.0), Subject::Controller), "");
    let effect = Effect::Torque(Course::Each(vec![Function::Constant(3.0), sine(2.0, 5.0)]));
    setup.agents[1].pushes = vec![Push { effect, from_s: 1.0, until_s: 4.0 }];
    let mut law = setup.agents[0].law.downcast::<Adaptive>().unwrap().clone();
    law.bounds = None;
    let law = Arc::new(law);
    setup.agents.iter_mut().for_each(|agent| agent.law = law.clone());
    let pushed = words(&setup);
    assert!(pushed.contains("its power sᵀτ_ext") && pushed.contains("nothing keeps ϑ̂ from drifting"), "{pushed}");
}
