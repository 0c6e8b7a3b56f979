//! (44): a vehicle in ℝ³ with one thrust and ideal angular-rate control.

use forwardstep_core::plant::Vehicle;

use super::LagrangianRobot;
use crate::closed_loop::{Assembly, SetupError};
use crate::quantity::positive;
use crate::system::{ActuatorLimits, PositionKind, Robot, RobotInterface};

/// (44). ϑ is its mass; the rest of its start is its attitude (q_v, q_o).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleModel {
    /// g along the third axis, which points down, m/s².
    pub gravity: f64,
}

impl Robot for VehicleModel {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface {
            rest_len: 4,
            position: PositionKind::Point,
            actuator_limits: ActuatorLimits::None,
            ..RobotInterface::mechanical(axes)
        }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }
}

/// The plant, with its true mass.
pub(super) fn plant(assembly: &Assembly<'_>, gravity: f64) -> Result<Vehicle, SetupError> {
    let own = assembly.agent();
    assembly.length(assembly.of_robot(), "axes", 3, own.robot.axes.len())?;
    assembly.length(assembly.of_robot(), "theta", 1, own.robot.theta.len())?;
    let mass = own.robot.theta[0];
    positive(assembly.of_robot(), "mass_kg", mass)?;
    positive(assembly.of_robot(), "gravity_m_s2", gravity)?;
    Ok(Vehicle { mass, gravity })
}
