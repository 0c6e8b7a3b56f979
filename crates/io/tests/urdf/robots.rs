//! What comes out of an accepted file.

use std::sync::Arc;

use forwardstep_core::robot::Lagrangian;
use forwardstep_core::robot::tree::Tree;
use forwardstep_io::urdf::{SHIPPED_ROBOTS, shipped_robot};
use forwardstep_io::{UrdfOptions, UrdfRobot};
use forwardstep_sim::AxisUnit;

use super::{ARM, BASE, LIMIT, joint, locked, notices, read, read_with, robot};

pub(super) const TREE: &str = include_str!("../../../../validation/urdf/tree.urdf");

fn ur5e() -> UrdfRobot {
    read(shipped_robot("ur5e").unwrap()).unwrap()
}

/// The masses among ϑ, added up.
fn mass(robot: &UrdfRobot) -> f64 {
    let names = robot.robot.theta_names.iter().zip(&robot.robot.theta);
    names.filter(|(name, _)| name.ends_with(".mass_kg")).map(|(_, mass)| mass).sum()
}

fn axis_names(robot: &UrdfRobot) -> Vec<&str> {
    robot.robot.axes.iter().map(|axis| axis.name.as_str()).collect()
}

fn gravity_torque(robot: &UrdfRobot, q: &[f64]) -> Vec<f64> {
    let tree = robot.robot.kind.downcast::<Arc<Tree>>().unwrap();
    let mut torque = vec![0.0; q.len()];
    let mut scratch = Lagrangian::<f64>::scratch(tree.as_ref());
    tree.gravity(&mut scratch, q, &robot.robot.theta, &mut torque).unwrap();
    torque
}

#[test]
fn shipped_robots_load_without_notices() {
    for (name, dof) in [("ur5e", 6), ("panda", 7)] {
        let robot = read(shipped_robot(name).unwrap()).unwrap();
        assert_eq!(robot.name, name);
        assert_eq!(notices(&robot), Vec::<String>::new());
        assert_eq!(robot.robot.axes.len(), dof);
        assert!(robot.robot.axes.iter().all(|axis| {
            axis.unit == AxisUnit::Radian
                && axis.position_limits.is_some()
                && axis.velocity_limit.is_some()
                && axis.effort_limit.is_some()
        }));
    }
    let gantry = read(shipped_robot("gantry").unwrap()).unwrap();
    assert_eq!((notices(&gantry), axis_names(&gantry)), (Vec::new(), vec!["bridge", "carriage", "ram"]));
    assert!(gantry.robot.axes.iter().all(|axis| axis.unit == AxisUnit::Metre));
    assert_eq!(SHIPPED_ROBOTS.map(|(name, _)| name), ["ur5e", "panda", "gantry"]);
    assert_eq!(shipped_robot("ur5e.urdf"), shipped_robot("ur5e"));
    assert_eq!(shipped_robot("ur5"), None);
}

#[test]
fn parameters_and_bodies_are_named_after_links_and_joints() {
    let robot = ur5e();
    assert_eq!(robot.base, "base_link");
    assert_eq!(
        robot.bodies,
        ["shoulder_link", "upper_arm_link", "forearm_link", "wrist_1_link", "wrist_2_link", "wrist_3_link"]
    );
    assert_eq!(robot.links.last().unwrap(), "tool0");
    let names = &robot.robot.theta_names;
    assert_eq!(names.len(), robot.robot.theta.len());
    for name in ["forearm_link.mass_kg", "forearm_link.mass_com_x_kg_m", "wrist_3_link.inertia_zz_kg_m2"] {
        assert!(names.iter().any(|known| known == name), "{name} among {names:?}");
    }
    let mut sorted = names.clone();
    sorted.sort();
    sorted.dedup();
    assert_eq!(sorted.len(), names.len());
    assert_eq!(robot.robot.theta[names.iter().position(|name| name == "forearm_link.mass_kg").unwrap()], 2.846);
}

#[test]
fn degrees_of_freedom_are_depth_first_with_joints_by_name() {
    let tree = read(TREE).unwrap();
    assert_eq!(notices(&tree).len(), 1); // the unnormalised axis
    assert_eq!(axis_names(&tree), ["turn", "a_left", "z_slide", "a_wheel"]);
    assert_eq!(tree.bodies, ["column", "left", "slider", "wheel"]);
    assert_eq!(tree.links, ["world", "column", "left", "tip", "bracket", "slider", "wheel"]);
    let units: Vec<AxisUnit> = tree.robot.axes.iter().map(|axis| axis.unit).collect();
    assert_eq!(units, [AxisUnit::Radian, AxisUnit::Radian, AxisUnit::Metre, AxisUnit::Radian]);
    assert_eq!(tree.robot.axes[3].position_limits, None);
    assert_eq!(tree.robot.axes[3].velocity_limit, Some(20.0));
    assert_eq!(tree.robot.axes[2].position_limits, Some([-0.5, 0.5]));
}

#[test]
fn the_order_in_the_file_has_no_influence() {
    let inside = TREE.split_once("name=\"tree\">").unwrap().1.rsplit_once("</robot>").unwrap().0;
    let (links, joints) = inside.split_once("<joint").unwrap();
    let turned = format!("<robot name=\"tree\"><joint{joints}{links}</robot>");
    let (one, other) = (read(TREE).unwrap(), read(&turned).unwrap());
    assert_eq!(one.robot.theta, other.robot.theta);
    assert_eq!(one.robot.theta_names, other.robot.theta_names);
    assert_eq!(one.robot.axes, other.robot.axes);
    assert_eq!(one.links, other.links);
}

#[test]
fn locked_joints_lose_their_freedom_and_keep_the_mass() {
    let free = read(TREE).unwrap();
    let held = read_with(TREE, &locked(&[("z_slide", 0.2), ("a_left", -0.9)])).unwrap();
    assert_eq!(axis_names(&held), ["turn", "a_wheel"]);
    assert_eq!(held.bodies, ["column", "wheel"]);
    let total = 0.35 + 6.5 + 0.8 + 1.7 + 1.1 + 0.6;
    assert!((mass(&free) - total).abs() < 1e-12);
    assert!((mass(&held) - total).abs() < 1e-12);
    let arm = read_with(shipped_robot("ur5e").unwrap(), &locked(&[("wrist_3_joint", 0.0)])).unwrap();
    assert_eq!(arm.robot.axes.len(), 5);
    assert!((mass(&arm) - mass(&ur5e())).abs() < 1e-12);
}

#[test]
fn damping_is_the_end_of_theta() {
    let tree = read(TREE).unwrap();
    let tail = |values: usize| tree.robot.theta_names.iter().zip(&tree.robot.theta).skip(values);
    let dampings: Vec<(&str, f64)> = tail(40).map(|(name, value)| (name.as_str(), *value)).collect();
    let expected = [("turn.damping_n_m_s", 0.7), ("a_left.damping_n_m_s", 0.25), ("z_slide.damping_n_s_m", 3.5)];
    assert_eq!(dampings, expected); // a_wheel has none
}

#[test]
fn a_joint_that_is_locked_needs_no_word_about_limits() {
    let tool = r#"<joint name="grip" type="revolute"><parent link="arm"/><child link="tool"/></joint>"#;
    let turning = joint("revolute", &format!(r#"<axis xyz="0 0 1"/>{LIMIT}"#));
    let text = robot(&[BASE, ARM, &turning, r#"<link name="tool"/>"#, tool]);
    assert_eq!(notices(&read_with(&text, &locked(&[("grip", 0.3)])).unwrap()), Vec::<String>::new());
}

#[test]
fn the_stretched_ur5e_weighs_on_its_shoulder_what_its_levers_say() {
    let robot = ur5e();
    let lever = 8.058 * 0.2125 + 2.846 * (0.425 + 0.3922 - 0.15) + (1.37 + 1.3 + 0.365) * (0.425 + 0.3922);
    let stretched = gravity_torque(&robot, &[0.3, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(stretched[0].abs() < 1e-12);
    assert!((stretched[1] + 9.81 * lever).abs() < 1e-12, "{}", stretched[1]);
    // Upright, the arm rests on itself.
    let upright = gravity_torque(&robot, &[0.3, -core::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0]);
    assert!(upright[1].abs() < 0.1 * stretched[1].abs());
    // Within the torques the real robot is built for.
    assert!(stretched.iter().zip(&robot.robot.axes).all(|(torque, axis)| torque.abs() < axis.effort_limit.unwrap()));
}

#[test]
fn gravity_can_be_turned() {
    let options = UrdfOptions { gravity: [0.0; 3], ..UrdfOptions::default() };
    let floating = read_with(shipped_robot("panda").unwrap(), &options).unwrap();
    assert_eq!(gravity_torque(&floating, &[0.1, 0.2, 0.3, -0.4, 0.5, 0.6, 0.7]), [0.0; 7]);
}
