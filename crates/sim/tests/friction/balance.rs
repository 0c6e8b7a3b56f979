//! V along runs with drives, smooth or dry, and with estimates within bounds: the balance, and what samples make of it.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::tree::JointKind;
use forwardstep_core::robot::{PlanarLinks, PlanarTip, SMOOTHING_LOSS};
use forwardstep_sim::delay::Delay;
use forwardstep_sim::drives::{JointDrives, JointFriction};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep_sim::{
    Adaptive, AgentSetup, Ending, Method, Network, Outcome, RobotSetup, Setup, Signal, TaskSpaceLaw, TipSetup, run,
};

use super::{FRICTION_N, axes, chain, column};

/// Four arms of three joints that agree, with all that is at their joints estimated.
fn arms(agents: usize, dry_s: Option<f64>, bounds: bool, seed: u64) -> Setup {
    let kinds = [
        (JointKind::Revolute, [0.0, 0.0, 1.0]),
        (JointKind::Revolute, [0.0, 1.0, 0.0]),
        (JointKind::Prismatic, [1.0, 0.0, 0.0]),
    ];
    let (tree, theta) = chain(&kinds, dry_s, [0.0, 0.0, -9.81]);
    let tree = Arc::new(tree);
    let mut draws = seed;
    // Uniform in [−1, 1), the same everywhere.
    let mut random = || {
        draws = draws.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (draws >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let arm = |k: usize| {
        let robot = RobotSetup::new(Arc::clone(&tree), theta.clone(), axes(3));
        let slack: Vec<f64> = theta.iter().map(|own| 0.2 * own.abs() + 0.02).collect();
        let [lower, upper] =
            [-1.0, 1.0].map(|sign| theta.iter().zip(&slack).map(|(own, by)| own + sign * by).collect());
        let law = Adaptive {
            damping: Gain::Number(10.0),
            adaptation: Gain::Number(4.0),
            estimate_start: theta.iter().zip(&slack).map(|(own, by)| own + by * random()).collect(),
            bounds: bounds.then(|| ParameterBounds::new(lower, upper, 0.01)),
        };
        AgentSetup::new(format!("arm-{k}"), robot, law).roots([1.0, 2.0]).at(&[random(), random(), random()]).moving(&[
            random(),
            random(),
            random(),
        ])
    };
    let ring = (0..agents).map(|k| (k, (k + 1) % agents)).filter(|(from, to)| from != to);
    let network = Network::fixed(agents, ring, Delay::constant(0.1));
    let agents: Vec<AgentSetup> = (0..agents).map(arm).collect();
    let mut setup = Setup::consensus(agents, network, 6.0);
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-11 };
    setup.solver.balance = true;
    setup.time.record_every_s = 0.02;
    setup
}

/// Planar arms, or masses in the plane, with all that can act at their joints.
fn closed_forms(arms: bool, agents: usize, dry_s: Option<f64>, bounds: bool) -> Setup {
    let links = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]);
    let agent = |k: usize| {
        let robot = if arms { RobotSetup::planar_arm(&links) } else { RobotSetup::point_mass(2, 3.0) };
        let drives = JointDrives {
            damping: Some(vec![0.2, 0.1]),
            armature: if arms { vec![0.3, 0.1] } else { Vec::new() },
            friction: Some(JointFriction { coulomb: vec![2.0, 1.0], width: vec![0.05, 0.04], dry_s }),
        };
        let robot = robot.with_drives(&drives).unwrap();
        let theta = robot.theta.clone();
        let [lower, upper] = [0.8, 1.2].map(|share| theta.iter().map(|own| own * share).collect());
        let law = Adaptive {
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(4.0),
            estimate_start: theta.iter().map(|own| if bounds { 0.8 * own } else { 0.3 * own }).collect(),
            bounds: bounds.then(|| ParameterBounds::new(lower, upper, 0.01)),
        };
        let at = k as f64;
        AgentSetup::new(format!("agent-{k}"), robot, law)
            .roots([1.0, 2.0])
            .at(&[0.4 * at - 0.5, 0.7 - 0.3 * at])
            .moving(&[0.5 - 0.2 * at, 0.3])
    };
    let ring = (0..agents).map(|k| (k, (k + 1) % agents)).filter(|(from, to)| from != to);
    let network = Network::fixed(agents, ring, Delay::constant(0.1));
    let mut setup = Setup::consensus((0..agents).map(agent).collect::<Vec<_>>(), network, 6.0);
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-11 };
    setup.solver.balance = true;
    setup.time.record_every_s = 0.02;
    setup
}

#[test]
fn thm1_v_balances_for_robots_in_closed_form_with_drives_alone_or_in_lanes() {
    for arms in [true, false] {
        for (agents, dry_s) in [(1, None), (4, None), (2, Some(2e-3)), (5, Some(2e-3))] {
            for bounds in [false, true] {
                let outcome = run(&closed_forms(arms, agents, dry_s, bounds)).unwrap();
                let off = unbalanced(&outcome, agents);
                assert!(off < 1e-7, "{arms} {agents} {dry_s:?} {bounds}: {off}");
            }
        }
    }
}

#[test]
fn thm6_v_balances_for_a_tip_of_an_arm_with_drives_smooth_or_dry() {
    for dry_s in [None, Some(2e-3)] {
        let mut agent = closed_forms(true, 1, dry_s, false).agents.swap_remove(0);
        let tip = TipSetup::Planar(PlanarTip { length_m: [1.0, 0.8] });
        agent.law = Arc::new(TaskSpaceLaw {
            tip,
            by_velocity: false,
            damping: Gain::Number(8.0),
            adaptation: Gain::Number(4.0),
            estimate_start: agent.robot.theta.iter().map(|own| 0.5 * own).collect(),
            estimate_bounds: None,
            task_gain: Gain::Number(6.0),
            kappa: 1.0,
            alpha_per_s: 5.0,
            kinematic_adaptation: Some(Gain::Number(0.1)),
            kinematic_names: vec!["l1".into(), "l2".into()],
            kinematic_start: vec![0.9, 0.9],
            bounds: None,
            determinant_floor: 0.01,
            attitude_gain: 1.0,
            null_space: None,
        });
        agent.roots_per_s = forwardstep_core::reference::RootSet::default();
        (agent.start.q, agent.start.dq) = (vec![0.3, 1.2], vec![0.2, -0.4]);
        let wave = |offset: f64, amplitude: f64| Path::Sinusoids {
            offset,
            waves: vec![Sinusoid { amplitude, rad_per_s: 1.0, phase_rad: 0.0 }],
        };
        let target = Trajectory::new(vec![wave(0.9, 0.2), wave(0.8, 0.1)]).unwrap();
        let mut setup = Setup::tracking([agent.following(target)], 6.0);
        setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-11 };
        setup.solver.balance = true;
        let outcome = run(&setup).unwrap();
        let off = unbalanced(&outcome, 1);
        assert!(off < 1e-7, "{dry_s:?}: {off}");
    }
}

/// The largest V + ∫ what it loses, less V(0), of V(0).
fn unbalanced(outcome: &Outcome, agents: usize) -> f64 {
    assert_eq!(outcome.ending, Ending::Completed);
    (0..agents).fold(0.0, |worst: f64, agent| {
        let (v, lost) = (column(outcome, agent, Signal::Lyapunov, 0), column(outcome, agent, Signal::Dissipation, 0));
        v.iter().zip(&lost).fold(worst, |worst, (now, lost)| worst.max((now + lost - v[0]).abs() / v[0]))
    })
}

#[test]
fn thm1_v_balances_with_rotors_friction_and_bounds_smooth_or_dry_alone_or_in_lanes() {
    for (agents, dry_s) in [(1, None), (4, None), (2, Some(2e-3)), (5, Some(2e-3))] {
        for bounds in [false, true] {
            let outcome = run(&arms(agents, dry_s, bounds, 3)).unwrap();
            let off = unbalanced(&outcome, agents);
            assert!(off < 1e-7, "{agents} {dry_s:?} {bounds}: {off}");
        }
    }
}

#[test]
fn v_balances_where_some_have_bounds_and_some_a_full_matrix_and_where_targets_are_followed() {
    let mut setup = arms(4, None, true, 13);
    setup.agents[1].change_law(|law: &mut Adaptive| law.bounds = None);
    setup.agents[2].change_law(|law: &mut Adaptive| {
        let p = law.estimate_start.len();
        law.bounds = None;
        law.adaptation = Gain::Matrix((0..p * p).map(|k| if k % (p + 1) == 0 { 4.0 } else { 0.01 }).collect());
    });
    let outcome = run(&setup).unwrap();
    assert!(unbalanced(&outcome, 4) < 1e-7);
    let wave = |k: usize| Path::Sinusoids {
        offset: 0.2,
        waves: vec![Sinusoid { amplitude: 0.5, rad_per_s: 1.0 + k as f64, phase_rad: 0.0 }],
    };
    for dry_s in [None, Some(2e-3)] {
        let mut tracking = arms(1, dry_s, true, 17);
        let target = Trajectory::new((0..3).map(wave).collect()).unwrap();
        let agent = tracking.agents.swap_remove(0).following(target);
        let mut tracking = Setup { solver: tracking.solver, ..Setup::tracking([agent], 6.0) };
        tracking.time.record_every_s = 0.02;
        assert!(unbalanced(&run(&tracking).unwrap(), 1) < 1e-7, "{dry_s:?}");
    }
}

#[test]
fn thm1_smooth_friction_is_covered_and_all_agree() {
    let mut setup = arms(4, None, false, 5);
    setup.time.end_s = 60.0;
    setup.solver.balance = false;
    setup.solver.method = Method::Adaptive { rtol: 1e-6, atol: 1e-8 };
    let outcome = run(&setup).unwrap();
    for axis in 0..3 {
        let ends: Vec<f64> = (0..4).map(|agent| outcome.recording.last(agent, Signal::Position, axis)).collect();
        let spread = ends.iter().fold(0.0_f64, |worst, end| worst.max((end - ends[0]).abs()));
        assert!(spread < 2e-3, "{axis}: {ends:?}");
    }
}

#[test]
fn estimates_keep_to_their_bounds_and_margins_and_at_samples_to_the_bounds() {
    let mut setup = arms(3, None, true, 11);
    // A push that the law takes for parameters.
    for agent in &mut setup.agents {
        let course = Course::Each(vec![Function::Constant(6.0); 3]);
        agent.pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.0, until_s: f64::INFINITY }];
    }
    setup.solver.balance = false;
    let bounds = setup.agents[0].law.downcast::<Adaptive>().unwrap().bounds.clone().unwrap();
    let free = {
        let mut free = setup.clone();
        free.agents.iter_mut().for_each(|agent| {
            agent.change_law(|law: &mut Adaptive| law.bounds = None);
        });
        free
    };
    let strays = |outcome: &Outcome| {
        (0..bounds.lower.len()).fold(f64::NEG_INFINITY, |worst, k| {
            let hats = (0..3).flat_map(|agent| column(outcome, agent, Signal::Estimate, k));
            hats.fold(worst, |worst, hat| worst.max(hat - bounds.upper[k]).max(bounds.lower[k] - hat))
        })
    };
    let margin = 0.01;
    let (kept, lost) = (strays(&run(&setup).unwrap()), strays(&run(&free).unwrap()));
    assert!(kept > 0.0 && kept < margin + 1e-9, "beyond a bound, within its margin: {kept}");
    assert!(lost > 5.0 * margin, "without bounds: {lost}");
    let sampled = strays(&run(&setup.sampled(200.0)).unwrap());
    assert!(sampled <= 0.0, "{sampled}");
}

#[test]
fn v_grows_by_what_dry_friction_brings_at_most() {
    // V̇ = −sᵀ(K + D)s + Σ s (F tanh(z/ε) − F σ), and the last is κ ε ΣF at most.
    let mut setup = arms(4, Some(1e-3), false, 7);
    setup.time.end_s = 10.0;
    let outcome = run(&setup).unwrap();
    let most_w = SMOOTHING_LOSS * 0.05 * 3.0 * FRICTION_N;
    for agent in 0..4 {
        let v = column(&outcome, agent, Signal::Lyapunov, 0);
        for (k, pair) in v.windows(2).enumerate() {
            assert!(pair[1] - pair[0] <= 1.05 * most_w * 0.02 + 1e-9, "{agent} row {k}: {pair:?}");
        }
    }
}
