//! Rotors, damping and dry friction as Pinocchio and MuJoCo have them: `validation/drives/generate.py`.

use forwardstep_core::Gain;
use forwardstep_core::expression::Expression;
use forwardstep_core::robot::{PlanarLinks, TwoVelocity};
use forwardstep_io::UrdfOptions;
use forwardstep_io::urdf::shipped_robot;
use forwardstep_sim::drives::{JointDrives, JointFriction};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::{Adaptive, AgentSetup, Method, Network, RobotSetup, Setup, Signal, run};
use serde_json::Value;

use super::read_with;
use super::robots::TREE;

const TRUTH: &str = include_str!("../../../../validation/drives/drives.json");

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn val_pinocchio_and_mujoco_robots_with_rotors_and_damping_have_the_same_inertia_and_accelerations() {
    let truth: Value = serde_json::from_str(TRUTH).unwrap();
    for case in truth["robots"].as_array().unwrap() {
        let robot =
            read_with(shipped_robot(case["robot"].as_str().unwrap()).unwrap(), &UrdfOptions::default()).unwrap().robot;
        let (armature, damping) = (numbers(&case["armature"]), numbers(&case["damping"]));
        let drives = JointDrives { damping: Some(damping), armature, friction: None };
        let robot = robot.with_drives(&drives).unwrap();
        let names: Vec<&str> = robot.axes.iter().map(|axis| axis.name.as_str()).collect();
        assert_eq!(
            names,
            case["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect::<Vec<_>>()
        );
        for state in case["states"].as_array().unwrap() {
            let of = |key: &str| numbers(&state[key]);
            let (q, dq, tau, ddq) = (of("q"), of("dq"), of("tau"), of("ddq"));
            let motion = TwoVelocity { q: &q, dq: &dq, z: &dq, dz: &ddq };
            let own = robot.kind.lagrangian().unwrap();
            let found = own.dynamics_at(&robot.theta, motion).unwrap();
            let size = of("mass").iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
            assert!(found.mass.iter().zip(of("mass")).all(|(ours, theirs)| (ours - theirs).abs() < 1e-11 * size));
            // Under their acceleration our equation asks for their torque.
            let mut evaluator = own.evaluator();
            let torque = &evaluator.at(&robot.theta, motion, &tau).unwrap().model;
            let terms = ddq.iter().fold(1.0_f64, |size, entry| size.max(entry.abs()));
            for (ours, theirs) in torque.iter().zip(&tau) {
                assert!((ours - theirs).abs() < 1e-9 * terms, "{ours} {theirs}");
            }
        }
    }
}

#[test]
fn a_damping_that_is_stated_stands_in_the_place_of_that_of_the_file() {
    let robot = read_with(TREE, &UrdfOptions::default()).unwrap().robot;
    let stated = robot.damping();
    assert!(stated.iter().any(|damping| *damping > 0.0) && stated.contains(&0.0), "{stated:?}");
    let kept = robot.clone().with_drives(&JointDrives::default()).unwrap();
    assert_eq!((kept.damping(), &kept.theta_names), (stated.clone(), &robot.theta_names));
    let turned: Vec<f64> = stated.iter().map(|damping| if *damping > 0.0 { 0.0 } else { 0.4 }).collect();
    let changed = robot.clone().with_drives(&JointDrives { damping: Some(turned.clone()), ..JointDrives::default() });
    let changed = changed.unwrap();
    assert_eq!(changed.damping(), turned);
    let bodies = 10 * robot.axes.len();
    assert_eq!(changed.theta[..bodies], robot.theta[..bodies]);
    assert!(changed.theta_names[bodies..].iter().all(|name| !robot.theta_names.contains(name)));
}

/// One joint that nothing controls.
fn alone(robot: RobotSetup, start: [f64; 2], ramp_per_s: f64, end_s: f64, every_s: f64) -> Vec<[f64; 2]> {
    let axes = robot.axes.len();
    let law = Adaptive {
        damping: Gain::Number(1e-9),
        adaptation: Gain::Number(1e-15),
        estimate_start: vec![0.0; robot.theta.len()],
        bounds: None,
    };
    let mut agent = AgentSetup::new("joint", robot, law).roots([1.0]);
    (agent.start.q[0], agent.start.dq[0]) = (start[0], start[1]);
    agent.start.reference = vec![vec![0.0; axes]];
    let ramp = Function::Formula(Expression::variable(0) * ramp_per_s);
    let course = Course::Each((0..axes).map(|k| if k == 0 { ramp.clone() } else { Function::Constant(0.0) }).collect());
    agent.pushes = vec![Push { effect: Effect::Torque(course), from_s: 0.0, until_s: f64::INFINITY }];
    let mut setup = Setup::consensus([agent], Network::silent(1), end_s);
    setup.time.record_every_s = every_s;
    setup.solver.method = Method::Adaptive { rtol: 1e-9, atol: 1e-12 };
    let outcome = run(&setup).unwrap();
    let column = |signal| outcome.recording.values(0, signal, 0).unwrap();
    column(Signal::Position).iter().zip(column(Signal::Velocity)).map(|(q, dq)| [*q, *dq]).collect()
}

/// MuJoCo's friction is a soft constraint, and ours is set once a period: both stay within a millimetre, or as many rad, of what is set-valued.
#[test]
fn val_mujoco_what_rubs_dryly_slides_stops_and_sticks_at_the_same_places() {
    const PERIOD_S: f64 = 1e-3;
    let truth: Value = serde_json::from_str(TRUTH).unwrap();
    let every_s = truth["friction"]["every_s"].as_f64().unwrap();
    let rubbing = |axes: usize| {
        let mut coulomb = vec![0.0; axes];
        coulomb[0] = 3.0;
        Some(JointFriction { coulomb, width: vec![0.01; axes], dry_s: Some(PERIOD_S) })
    };
    let block = || {
        let drives = JointDrives { friction: rubbing(1), ..JointDrives::default() };
        RobotSetup::point_mass(1, 2.0 + 0.1).with_drives(&drives).unwrap()
    };
    // The whole pendulum is the first link; the second weighs next to nothing.
    let pendulum = || {
        let links = PlanarLinks {
            mass_kg: [2.0, 1e-9],
            length_m: [1.0, 1.0],
            com_m: [0.6, 0.0],
            inertia_kg_m2: [0.05, 1e-9],
            gravity_m_s2: 9.81,
        };
        let drives = JointDrives { armature: vec![0.1, 0.0], friction: rubbing(2), damping: None };
        RobotSetup::planar_arm(&links).with_drives(&drives).unwrap()
    };
    let robots: [(&str, &dyn Fn() -> RobotSetup); 3] = [("block", &block), ("pushed", &block), ("pendulum", &pendulum)];
    for (name, robot) in robots {
        let case = &truth["friction"][name];
        let of = |key: &str| case[key].as_f64().unwrap();
        let rows: Vec<Vec<f64>> = case["rows"].as_array().unwrap().iter().map(numbers).collect();
        let end_s = every_s * (rows.len() - 1) as f64;
        let found = alone(robot(), [of("start"), of("speed")], of("ramp_per_s"), end_s, every_s);
        assert_eq!(found.len(), rows.len());
        for (k, (ours, theirs)) in found.iter().zip(&rows).enumerate() {
            let [q, dq] = [0, 1].map(|entry| (ours[entry] - theirs[entry]).abs());
            assert!(q < 1e-3 && dq < 3e-3, "{name}, row {k}: {ours:?} {theirs:?}");
        }
        // It sticks in some rows and moves in others.
        let stuck = found.iter().filter(|[_, dq]| dq.abs() < 1e-6).count();
        assert!(stuck > 10 && stuck < found.len() - 10, "{name}: {stuck}");
    }
}
