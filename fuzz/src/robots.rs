//! Robots by themselves: described, and moved by the program's own dynamics.

use forwardstep::io::UrdfRobot;
use forwardstep::io::robot::{JointState, RobotDescription};

use crate::dynamics::{DynamicsError, dynamics};
use crate::{one_line, prompt};

/// Robots with more joints are not moved: a mass matrix is their square.
const MOST_JOINTS: usize = 200;

/// Describes a robot as `forwardstep robot` does.
pub fn described(robot: &UrdfRobot) {
    let description = RobotDescription::new(robot);
    assert_eq!(description.joints.len(), robot.robot.axes.len());
    assert_eq!(description.bodies.len(), robot.bodies.len());
    description.notices.iter().for_each(|notice| one_line(notice));
    description.bodies.iter().for_each(|body| assert!(body.mass_kg.is_finite(), "{body:?}"));
    let json = description.to_json();
    assert!(json.starts_with('{') && json.ends_with('}'), "{json}");
}

/// Computes M, g, τ and q̈ at a state; `None` when a number overflows, or the robot is too large to be moved here.
pub fn moved(robot: &UrdfRobot, state: &JointState) -> Option<()> {
    let joints = robot.robot.axes.len();
    if joints > MOST_JOINTS {
        return None;
    }
    match prompt("dynamics", || dynamics(robot, state)) {
        Ok(dynamics) => {
            let again = crate::dynamics::dynamics(robot, state);
            assert_eq!(again.as_ref(), Ok(&dynamics), "computed twice");
            for (j, row) in dynamics.mass_matrix.iter().enumerate() {
                assert!(row[j] >= 0.0, "M[{j}][{j}] = {}", row[j]);
                row.iter().enumerate().for_each(|(k, entry)| assert_eq!(*entry, dynamics.mass_matrix[k][j]));
            }
            assert!(!dynamics.to_json().is_empty());
            Some(())
        }
        Err(error @ DynamicsError::NotFinite { .. }) => {
            one_line(&error.to_string());
            None
        }
        Err(error) => panic!("{error:?} of a robot that was read"),
    }
}
