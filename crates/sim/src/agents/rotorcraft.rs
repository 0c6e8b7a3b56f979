//! A vehicle with one thrust as a rigid body that torques turn.

use forwardstep_core::Gain;
use forwardstep_core::plant::{Rotorcraft, Rotors};

use super::LagrangianRobot;
use super::vehicle::plant as vehicle;
use crate::closed_loop::{Assembly, SetupError};
use crate::quantity::{not_negative, positive, such};
use crate::system::{Attachments, PositionKind, Robot, RobotInterface};

/// A rotorcraft. ϑ is its mass; the rest of its start is its attitude and its angular velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct RotorcraftModel {
    /// g, m/s².
    pub gravity: f64,
    /// J, kg m².
    pub inertia: Gain,
    /// Its rotors; without them every thrust and torque that is asked for can be produced.
    pub rotors: Option<Rotors>,
}

impl Robot for RotorcraftModel {
    fn interface(&self, axes: usize) -> RobotInterface {
        RobotInterface {
            rest_len: 7,
            position: PositionKind::Point,
            attachments: Attachments::AxesAndBody,
            torques_on_body: true,
            ..RobotInterface::mechanical(axes)
        }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }
}

/// The plant, with its true mass.
pub(super) fn plant(assembly: &Assembly<'_>, model: &RotorcraftModel) -> Result<Rotorcraft, SetupError> {
    if let Some(rotors) = &model.rotors {
        let (place, [low, high]) = (assembly.of_robot().key("rotors"), rotors.thrust);
        positive(place.clone(), "offset_m", rotors.offset)?;
        positive(place.clone(), "drag_m", rotors.drag)?;
        let thrust = place.key("thrust_n");
        not_negative(thrust.clone().index(0), "", low)?;
        not_negative(thrust.clone().index(1), "", high)?;
        such(high > low, thrust.index(1), "", high, "must be above the least thrust")?;
    }
    let path = assembly.of_robot().key("inertia_kg_m2");
    assembly.resolved(&model.inertia, path.clone(), 3, &[])?;
    Rotorcraft::new(vehicle(assembly, model.gravity)?, &model.inertia, model.rotors).map_err(|error| SetupError::Gain {
        agent: assembly.agent().name.clone(),
        path,
        error,
    })
}
