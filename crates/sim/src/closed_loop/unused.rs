//! What a setup states and nothing reads: refused, so that it is not taken to have an effect.

use forwardstep_core::LengthError;

use super::error::SetupError;
use super::limit_error::LimitError;
use super::velocity_quantity::VelocityQuantity;
use crate::reference::{Desired, ReferenceDynamics, ReferenceInterface, Roots};
use crate::setup::{AgentSetup, Axis, Control, Setup, VelocitySensor};
use crate::system::{ActuatorLimits, Interface};

/// Everything about the whole setup.
pub(super) fn of_setup(setup: &Setup) -> Result<(), SetupError> {
    // A law that cannot track is refused for that.
    let tracks = |agent: &AgentSetup| {
        agent.interface().is_some_and(|interface| interface.follows.iter().any(|family| family.has_targets()))
    };
    let hears = setup.reference.downcast().is_some_and(Desired::hears_beside_target);
    if setup.all_track() && !hears && setup.agents.iter().all(tracks) {
        let edges = setup.network.schedule.graphs.iter().map(Vec::len).sum();
        if edges > 0 {
            return Err(SetupError::UnusedEdges { edges });
        }
    }
    setup.control.as_ref().map_or(Ok(()), |control| of_sensors(control, &setup.agents))
}

/// Noise and steps of velocities where none are measured.
fn of_sensors(control: &Control, agents: &[AgentSetup]) -> Result<(), SetupError> {
    let sensors = &control.sensors;
    let watches = |agent: &AgentSetup| {
        agent.interface().is_none_or(|interface| interface.measures.contains(&"task-space velocity"))
    };
    if sensors.tip_velocity_noise != 0.0 && !agents.iter().any(watches) {
        let (quantity, value) = (VelocityQuantity::TipNoise, sensors.tip_velocity_noise);
        return Err(SetupError::VelocityUnused { quantity, value, filtered: false });
    }
    // A law beside a robot that it is not made for is refused for that.
    let measured = agents.iter().any(|agent| agent.interface().is_none_or(|interface| interface.measures_velocity));
    let (filtered, cut_off_hz) = match sensors.velocity {
        VelocitySensor::Measured if measured => return Ok(()),
        VelocitySensor::Measured => (false, 0.0),
        VelocitySensor::Filtered { .. } if measured => (true, 0.0),
        VelocitySensor::Filtered { cut_off_hz } => (false, cut_off_hz),
    };
    for (quantity, value) in [
        (VelocityQuantity::CutOff, cut_off_hz),
        (VelocityQuantity::Noise, sensors.velocity_noise),
        (VelocityQuantity::Step, sensors.velocity_quantum),
    ] {
        if value != 0.0 {
            return Err(SetupError::VelocityUnused { quantity, value, filtered });
        }
    }
    Ok(())
}

/// Everything about one agent.
pub(super) fn of_agent(
    reference: &dyn ReferenceDynamics,
    own: &AgentSetup,
    interface: &Interface,
) -> Result<(), SetupError> {
    manipulability(reference, own, interface)?;
    roots(reference, own, interface)?;
    limits(own)
}

/// λ is read by (3), (23), (a5) and (24) beside laws that measure q̇: it multiplies q̇ − z. Where q̇ is not measured there is no
/// such number to multiply.
fn manipulability(
    reference: &dyn ReferenceDynamics,
    own: &AgentSetup,
    interface: &Interface,
) -> Result<(), SetupError> {
    let without = match reference.interface() {
        _ if own.manipulability == 0.0 => return Ok(()),
        _ if !interface.manipulability => own.law.words().name,
        ReferenceInterface { manipulability: true, .. } => return Ok(()),
        ReferenceInterface { manipulability: false, .. } => reference.words().name,
    };
    Err(SetupError::NoManipulability { agent: own.name.clone(), law: without, value: own.manipulability })
}

/// Roots belong to reference dynamics that are a polynomial.
fn roots(reference: &dyn ReferenceDynamics, own: &AgentSetup, interface: &Interface) -> Result<(), SetupError> {
    let counts = match reference.interface().roots {
        Roots::Every => true,
        Roots::ByLaw => interface.tracks_by_roots,
        Roots::None => false,
    };
    if counts || own.roots_per_s.is_empty() {
        return Ok(());
    }
    let error = LengthError { what: "the list of roots", need: 0, got: own.roots_per_s.len() };
    Err(SetupError::RootCount { agent: own.name.clone(), error })
}

/// Limits that are to be enforced have to be there, and to leave something.
fn limits(own: &AgentSetup) -> Result<(), SetupError> {
    let name = |axis: &Axis| axis.name.clone();
    let missing = |axis: &Axis| LimitError::NoEffortLimit { axis: name(axis) };
    let wrong = |axis: &Axis| match axis.effort_limit {
        None => Some(missing(axis)),
        Some(value) if value > 0.0 => None,
        Some(value) => Some(LimitError::EffortLimit { axis: name(axis), value }),
    };
    let error = match own.robot.interface().actuator_limits {
        ActuatorLimits::Own => None,
        ActuatorLimits::None => own.robot.axes.first().map(missing),
        ActuatorLimits::Axes => own.robot.axes.iter().find_map(wrong),
    };
    match error.filter(|_| own.enforce_limits) {
        Some(error) => Err(SetupError::Limit { agent: own.name.clone(), error }),
        None => Ok(()),
    }
}
