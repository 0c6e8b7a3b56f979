//! Friction at the joints: closed forms, and when it is set anew. `balance` has V, and estimates that are kept within bounds.

mod balance;

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::tree::{JointKind, LinkJoint, LinkSpec, Placement, Tree, inertia_about_frame};
use forwardstep_core::robot::{Drives, Friction, PlanarArm, PlanarLinks, PointMass};
use forwardstep_sim::delay::{Delay, PiecewiseConstant};
use forwardstep_sim::drives::{JointDrives, JointFriction};
use forwardstep_sim::graph::Edge;
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::schedule::{Phase, Schedule};
use forwardstep_sim::{
    Adaptive, AgentSetup, Axis, AxisUnit, Known, Method, Network, Outcome, RobotSetup, Setup, Signal, run,
};

const MASS_KG: f64 = 2.0;
const FRICTION_N: f64 = 3.0;

/// Links in a row, prismatic or revolute, with friction and armature at every joint.
fn chain(kinds: &[(JointKind, [f64; 3])], dry_s: Option<f64>, gravity: [f64; 3]) -> (Tree, Vec<f64>) {
    let link = |k: usize| {
        let (kind, axis) = kinds[k];
        LinkSpec {
            parent: k.checked_sub(1),
            x_parent_joint: Placement { translation: [0.4, 0.0, 0.0], ..Placement::IDENTITY },
            joint: LinkJoint::Moving { kind, axis, damping: 0.1 * k as f64 },
            inertia: inertia_about_frame(MASS_KG, [0.2, 0.0, 0.0], [0.03, 0.0, 0.05, 0.0, 0.0, 0.04]),
        }
    };
    let assembled = Tree::assemble(&(0..kinds.len()).map(link).collect::<Vec<_>>(), gravity).unwrap();
    let friction = (0..kinds.len()).map(|joint| Friction { joint, width: 0.05 }).collect();
    let drives = Drives { geared: (0..kinds.len()).collect(), friction, dry_s, ..assembled.tree.drives().clone() };
    let mut theta = assembled.theta;
    theta.extend((0..kinds.len()).map(|k| 0.1 + 0.05 * k as f64));
    theta.extend(kinds.iter().map(|_| FRICTION_N));
    (assembled.tree.with_drives(drives).unwrap(), theta)
}

fn axes(n: usize) -> Vec<Axis> {
    (0..n).map(|k| Axis::new(format!("j{k}"), AxisUnit::Radian)).collect()
}

fn column(outcome: &Outcome, agent: usize, signal: Signal, axis: usize) -> Vec<f64> {
    outcome.recording.values(agent, signal, axis).unwrap().to_vec()
}

/// One block on rails that nothing controls (K is next to nothing), and what pushes it.
fn block(dry_s: Option<f64>, push: Function, velocity: f64, end_s: f64) -> Setup {
    let (tree, theta) = chain(&[(JointKind::Prismatic, [1.0, 0.0, 0.0])], dry_s, [0.0; 3]);
    // A law that does next to nothing.
    let nothing = |p: usize| Adaptive {
        damping: Gain::Number(1e-9),
        adaptation: Gain::Number(1e-15),
        estimate_start: vec![0.0; p],
        bounds: None,
    };
    let robot = RobotSetup::tree(tree, theta.clone(), vec![Axis::new("rail", AxisUnit::Metre)]);
    let mut agent = AgentSetup::new("block", robot, nothing(theta.len())).roots([1.0]).at(&[0.0]).moving(&[velocity]);
    agent.start.reference = vec![vec![0.0]];
    let effect = Effect::Torque(Course::Each(vec![push]));
    agent.pushes = vec![Push { effect, from_s: 0.0, until_s: f64::INFINITY }];
    let mut setup = Setup::consensus([agent], Network::silent(1), end_s);
    setup.time.record_every_s = 0.01;
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-12 };
    setup
}

const INERTIA_KG: f64 = MASS_KG + 0.1;

/// The same block in closed form, whose rotor is part of its mass.
fn mass(setup: &Setup) -> Setup {
    let mut setup = setup.clone();
    let agent = &mut setup.agents[0];
    let dry_s = agent.robot.interface().drives.dry_s;
    let friction = Some(JointFriction { coulomb: vec![FRICTION_N], width: vec![0.05], dry_s });
    agent.robot =
        RobotSetup::point_mass(1, INERTIA_KG).with_drives(&JointDrives { friction, ..JointDrives::default() }).unwrap();
    assert!(agent.change_law(|law: &mut Adaptive| law.estimate_start = vec![0.0; 2]));
    setup
}

#[test]
fn a_mass_with_friction_slides_sticks_and_creeps_as_a_block_on_rails() {
    let ramp = || Function::Formula(Expression::variable(0) * 2.0);
    let setups = [
        block(Some(1e-3), Function::Constant(0.0), 1.2, 2.0),
        block(Some(1e-3), ramp(), 0.0, 4.0),
        block(None, Function::Constant(1.0), 0.7, 4.0),
    ];
    for setup in setups {
        let [rails, mass] = [&setup, &mass(&setup)].map(|setup| run(setup).unwrap());
        for signal in [Signal::Position, Signal::Velocity, Signal::External] {
            for (one, other) in column(&rails, 0, signal, 0).iter().zip(column(&mass, 0, signal, 0)) {
                assert!((one - other).abs() < 1e-7, "{signal:?}: {one} {other}");
            }
        }
    }
}

#[test]
fn drives_of_robots_in_closed_form_are_data_and_robots_without_keep_their_kernels() {
    let links = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]);
    let friction = JointFriction { coulomb: vec![0.0, 0.5], width: vec![0.01; 2], dry_s: Some(1e-3) };
    let drives =
        JointDrives { damping: Some(vec![0.3, 0.0]), armature: vec![0.2, 0.1], friction: Some(friction.clone()) };
    let arm = RobotSetup::planar_arm(&links).with_drives(&drives).unwrap();
    let names = ["shoulder.damping_n_m_s", "shoulder.armature_kg_m2", "elbow.armature_kg_m2", "elbow.friction_n_m"];
    assert_eq!(arm.theta_names[5..], names);
    assert_eq!((arm.damping(), arm.armature(), arm.coulomb()), (vec![0.3, 0.0], vec![0.2, 0.1], vec![0.0, 0.5]));
    let found = arm.interface().drives;
    assert_eq!((found.damped, found.geared, found.dry_s), (vec![0], vec![0, 1], Some(1e-3)));
    // M, C, g, Y, accelerations and lanes agree, where friction is a function of q̇.
    let smooth = JointFriction { dry_s: None, ..friction.clone() };
    let smooth = arm.clone().with_drives(&JointDrives { friction: Some(smooth), ..drives }).unwrap();
    assert_eq!(smooth.kind.lagrangian().unwrap().probe(&smooth).unwrap().found, None);
    // Damping stays unless it is stated, the rest is replaced; without any it is the robot of before.
    let damped = arm.clone().with_drives(&JointDrives::default()).unwrap();
    assert_eq!((damped.theta.len(), damped.theta_names.len(), damped.damping()), (6, 6, vec![0.3, 0.0]));
    let bare = arm.with_drives(&JointDrives { damping: Some(vec![0.0; 2]), ..JointDrives::default() }).unwrap();
    assert!(bare.kind.is::<PlanarArm>());
    assert_eq!((bare.theta.as_slice(), bare.theta_names.len()), (&links.theta()[..], 5));
    assert!(RobotSetup::point_mass(3, 1.0).with_drives(&JointDrives::default()).unwrap().kind.is::<PointMass>());
    // What has no meaning.
    let wrong = |drives: JointDrives| RobotSetup::planar_arm(&links).with_drives(&drives).unwrap_err().to_string();
    assert!(wrong(JointDrives { armature: vec![0.1; 3], ..JointDrives::default() }).contains("armature"));
    assert!(wrong(JointDrives { damping: Some(vec![f64::NAN, 0.0]), ..JointDrives::default() }).contains("NaN"));
    let negative = JointFriction { coulomb: vec![-1.0, 0.0], ..friction };
    assert!(wrong(JointDrives { friction: Some(negative), ..JointDrives::default() }).contains("-1"));
    let ship = RobotSetup::ship([2.0, 3.0, 0.7, 1.5, 0.3, 0.9, 0.2, -0.4, 0.8]);
    let armed = JointDrives { armature: vec![0.1; 3], ..JointDrives::default() };
    assert!(ship.clone().with_drives(&armed).unwrap_err().to_string().contains("no joints"));
    assert_eq!(ship.with_drives(&JointDrives::default()).unwrap().theta.len(), 9);
}

#[test]
fn a_block_slows_down_at_f_over_m_and_stops() {
    for period_s in [1e-2, 1e-3] {
        let outcome = run(&block(Some(period_s), Function::Constant(0.0), 1.2, 2.0)).unwrap();
        let (x, v) = (column(&outcome, 0, Signal::Position, 0), column(&outcome, 0, Signal::Velocity, 0));
        // The law knows no friction at z = 0, and K is nothing.
        let stops_s = 1.2 * INERTIA_KG / FRICTION_N;
        for (row, t) in outcome.recording.t_s.iter().enumerate() {
            let t = t.min(stops_s);
            let (want_v, want_x) = (1.2 - FRICTION_N / INERTIA_KG * t, 1.2 * t - 0.5 * FRICTION_N / INERTIA_KG * t * t);
            assert!(
                (v[row] - want_v).abs() < 2.0 * period_s && (x[row] - want_x).abs() < period_s,
                "{row}: {} {}",
                v[row],
                x[row]
            );
        }
        assert!(v.last().unwrap().abs() < 1e-9, "it stands: {:?}", v.last());
    }
}

#[test]
fn a_block_sticks_until_the_push_exceeds_f_and_friction_balances_it() {
    // 2 t N: more than 3 N from 1.5 s on.
    let ramp = Expression::variable(0) * 2.0;
    let ramp = Function::Formula(ramp);
    let outcome = run(&block(Some(1e-3), ramp, 0.0, 4.0)).unwrap();
    let (x, external) = (column(&outcome, 0, Signal::Position, 0), column(&outcome, 0, Signal::External, 0));
    for (row, t) in outcome.recording.t_s.iter().enumerate() {
        let late = (t - 1.5).max(0.0);
        // ẍ = 2 (t − 1.5)/m.
        let want = late.powi(3) / (3.0 * INERTIA_KG);
        assert!((x[row] - want).abs() < 5e-3 * (1.0 + late), "{t} s: {}, not {want}", x[row]);
        let net = if late > 0.0 { 2.0 * late } else { 0.0 };
        assert!((external[row] - net).abs() < 5e-3, "{t} s: {}", external[row]);
    }
}

#[test]
fn friction_is_held_for_a_period_and_no_longer() {
    // It is set to stop the block within the period h under the push at hand, which grows by 2 N/s: v = 2 h²/(2 m) at the end.
    for period_s in [0.05, 0.02] {
        let outcome = run(&block(Some(period_s), Function::Formula(Expression::variable(0) * 2.0), 0.0, 1.0)).unwrap();
        let fastest = column(&outcome, 0, Signal::Velocity, 0).into_iter().fold(0.0, f64::max);
        let want = period_s * period_s / INERTIA_KG;
        assert!((fastest / want - 1.0).abs() < 0.01, "{period_s} s: {fastest} m/s, not {want}");
    }
}

#[test]
fn smooth_friction_creeps_where_dry_friction_sticks() {
    // 1 N of 3: F tanh(v/ε) = 1.
    let outcome = run(&block(None, Function::Constant(1.0), 0.0, 4.0)).unwrap();
    let v = column(&outcome, 0, Signal::Velocity, 0);
    let creeps = 0.05 * (1.0_f64 / FRICTION_N).atanh();
    assert!((v.last().unwrap() - creeps).abs() < 1e-6, "{:?}, not {creeps}", v.last());
    let stuck = run(&block(Some(1e-3), Function::Constant(1.0), 0.0, 4.0)).unwrap();
    assert!(stuck.recording.last(0, Signal::Position, 0).abs() < 1e-6);
}

#[test]
fn friction_answers_at_once_to_a_push_that_begins_within_a_period() {
    // From 0.503 s on 5 N, of which 2 are left: what was held must not stay until 0.51 s.
    let mut setup = block(Some(1e-2), Function::Constant(5.0), 0.0, 1.0);
    setup.agents[0].pushes[0].from_s = 0.503;
    let outcome = run(&setup).unwrap();
    let want = (5.0 - FRICTION_N) / INERTIA_KG * (1.0 - 0.503);
    let found = outcome.recording.last(0, Signal::Velocity, 0);
    assert!((found - want).abs() < 1e-6, "{found}, not {want}");
}

/// A block that sticks and hears another one that is far away from 0.503 s on; of `late` messages only that it was near is heard until then.
/// Both know their masses.
fn called(period_s: f64, late: bool) -> Setup {
    let friction = JointFriction { coulomb: vec![FRICTION_N], width: vec![0.05], dry_s: Some(period_s) };
    let rubs = JointDrives { friction: Some(friction), ..JointDrives::default() };
    let sticks = RobotSetup::point_mass(1, INERTIA_KG).with_drives(&rubs).unwrap();
    let agent = |name: &str, robot| AgentSetup::new(name, robot, Known::gain(1.0)).roots([1.0]);
    let far = agent("far", RobotSetup::point_mass(1, 1.0));
    let far = if late { far.at(&[0.0]).moving(&[20.0]) } else { far.at(&[6.0]) };
    let agents = [agent("block", sticks).at(&[0.0]), far];
    let edges = vec![Edge { from: 1, to: 0, weight: 1.0.into(), delay: 0 }];
    let network = match late {
        true => Network {
            schedule: Schedule::fixed(edges),
            delays: vec![Delay::new(PiecewiseConstant {
                times_s: vec![0.0, 0.503],
                values_s: vec![0.6, 0.0],
                period_s: None,
            })],
            ..Network::silent(2)
        },
        false => Network {
            schedule: Schedule::periodic(vec![Phase { dwell_s: 0.503, edges: vec![] }, Phase { dwell_s: 9.0, edges }]),
            delays: vec![Delay::constant(0.0)],
            ..Network::silent(2)
        },
    };
    let mut setup = Setup::consensus(agents, network, 0.51);
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-12 };
    setup
}

#[test]
fn regress_friction_answers_at_once_to_what_is_heard_first_within_a_period() {
    let fastest = |setup: &Setup| run(setup).unwrap().recording.last(0, Signal::Velocity, 0);
    for late in [false, true] {
        // What was held must not stay until 0.51 s.
        let [coarse, fine] = [1e-2, 1e-4].map(|period_s| fastest(&called(period_s, late)));
        assert!(fine > 5e-3 && (coarse - fine).abs() < 0.05 * fine, "{late}: {coarse}, not {fine}");
    }
}

#[test]
fn regress_periods_of_friction_that_no_run_comes_to_the_end_of_are_refused() {
    let setup = block(Some(1e-30), Function::Constant(0.0), 1.2, 2.0);
    let said = run(&setup).unwrap_err().to_string();
    assert!(said.contains("period_s") && said.contains("settings of dry friction"), "{said}");
}

#[test]
fn a_joint_that_sticks_stands_whatever_its_law_makes_of_what_it_hears() {
    // K brings less than F, and what is heard of the other moves; what is left is of second order in the period.
    let mut setup = block(Some(1e-3), Function::Constant(0.0), 0.0, 2.0);
    let mut other = setup.agents[0].clone();
    (other.name, other.start.q[0]) = ("other".into(), 0.3);
    let wave = Expression::variable(0).sin_of() * 30.0;
    other.pushes[0].effect = Effect::Torque(Course::Each(vec![Function::Formula(wave)]));
    setup.agents.push(other);
    setup.network = Network::fixed(2, [(1, 0)], Delay::constant(0.1));
    setup.agents[0].pushes.clear();
    setup.agents[0].change_law(|law: &mut Adaptive| law.damping = Gain::Number(1.0));
    let outcome = run(&setup).unwrap();
    let torque = column(&outcome, 0, Signal::Torque, 0);
    let v = column(&outcome, 0, Signal::Velocity, 0);
    let sticks = torque.iter().take_while(|torque| torque.abs() < 0.9 * FRICTION_N).count();
    let [least, most] = [f64::min, f64::max].map(|of| torque[..sticks].iter().copied().fold(0.0, of));
    assert!(sticks > 50 && most - least > 1.0, "{sticks} rows, {least}, {most}");
    let moves = v[..sticks].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(moves < 1e-5, "{moves} m/s");
}
