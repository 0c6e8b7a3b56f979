//! What a setup states and nothing reads: refused, so that nobody takes it to have an effect.

use forwardstep_core::LengthError;

use super::valid::{SetupError, VelocityQuantity};
use crate::setup::{AgentSetup, Control, Law, ReferenceKind, RobotKind, Setup, VelocitySensor};

/// Everything about the whole setup.
pub(super) fn of_setup(setup: &Setup) -> Result<(), SetupError> {
    // A law that cannot track is refused for that, once it is built.
    let tracks = setup.agents.iter().all(|agent| !matches!(agent.law, Law::Thrust(_)));
    if setup.reference == ReferenceKind::Tracking && tracks {
        let edges = setup.network.schedule.graphs().into_iter().map(<[_]>::len).sum();
        if edges > 0 {
            return Err(SetupError::NobodyHears { edges });
        }
    }
    setup.control.as_ref().map_or(Ok(()), |control| of_sensors(control, &setup.agents))
}

/// Noise and steps of velocities where none are measured.
fn of_sensors(control: &Control, agents: &[AgentSetup]) -> Result<(), SetupError> {
    let sensors = &control.sensors;
    let measured = agents.iter().any(measures_velocity);
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

/// Whether a sensor of velocities has a part in what the agent does.
fn measures_velocity(agent: &AgentSetup) -> bool {
    match &agent.law {
        Law::Adaptive { .. } | Law::Known { .. } | Law::Thrust(_) | Law::TaskSpace(_) => true,
        Law::PositionOnly { .. } | Law::Attitude(_) => false,
        // A velocity is a state of its own in some chains only.
        Law::Chain(_) => agent.robot.velocity_len() > 0,
    }
}

/// Everything about one agent.
pub(super) fn of_agent(setup: &Setup, own: &AgentSetup) -> Result<(), SetupError> {
    manipulability(setup, own)?;
    roots(setup, own)?;
    limits(own)
}

/// λ is read by (3), (23), (a5) and (24) beside (6)–(7). In all other laws z obeys equations without it.
///
/// In (24) λ multiplies q̇ − z. Where q̇ is not measured there is no such number to multiply, see
/// [`forwardstep_core::controller::Guide`].
fn manipulability(setup: &Setup, own: &AgentSetup) -> Result<(), SetupError> {
    let law = match (&own.law, &setup.reference) {
        (Law::Adaptive { .. } | Law::Known { .. }, ReferenceKind::Consensus | ReferenceKind::PureIntegral) => {
            return Ok(());
        }
        (Law::Adaptive { .. } | Law::Known { .. }, ReferenceKind::Backstepping { .. }) => "the backstepping baseline",
        (Law::Adaptive { .. } | Law::Known { .. }, ReferenceKind::Following(_)) => "following a leader",
        (Law::Adaptive { .. } | Law::Known { .. }, ReferenceKind::Tracking)
        | (
            Law::PositionOnly { .. } | Law::Chain(_) | Law::Thrust(_) | Law::TaskSpace(_) | Law::Attitude(_),
            ReferenceKind::Consensus
            | ReferenceKind::PureIntegral
            | ReferenceKind::Backstepping { .. }
            | ReferenceKind::Following(_)
            | ReferenceKind::Tracking,
        ) => own.law.words(),
    };
    if own.manipulability == 0.0 {
        return Ok(());
    }
    Err(SetupError::NoManipulability { agent: own.name.clone(), law, value: own.manipulability })
}

/// Roots belong to reference dynamics that are a polynomial.
fn roots(setup: &Setup, own: &AgentSetup) -> Result<(), SetupError> {
    let counts = match (&setup.reference, &own.law) {
        (ReferenceKind::Consensus | ReferenceKind::PureIntegral, _) => true,
        (ReferenceKind::Backstepping { .. } | ReferenceKind::Following(_), _) => false,
        (ReferenceKind::Tracking, Law::TaskSpace(_) | Law::Attitude(_)) => false,
        (
            ReferenceKind::Tracking,
            Law::Adaptive { .. } | Law::Known { .. } | Law::PositionOnly { .. } | Law::Chain(_) | Law::Thrust(_),
        ) => true,
    };
    if counts || own.roots_per_s.is_empty() {
        return Ok(());
    }
    let error = LengthError { what: "the list of roots", need: 0, got: own.roots_per_s.len() };
    Err(SetupError::RootCount { agent: own.name.clone(), error })
}

/// Limits that are to be enforced have to be there. Those of a spacecraft are its wheels', and a vehicle has no torque of an axis.
fn limits(own: &AgentSetup) -> Result<(), SetupError> {
    let mut axes = own.robot.axes.iter();
    let missing = match own.robot.kind {
        RobotKind::Spacecraft { .. } => None,
        RobotKind::Vehicle { .. } => axes.next(),
        RobotKind::Tree(_)
        | RobotKind::PlanarArm
        | RobotKind::PointMass { .. }
        | RobotKind::Chain(_)
        | RobotKind::Rotorcraft { .. } => axes.find(|axis| axis.effort_limit.is_none()),
    };
    match missing {
        Some(axis) if own.enforce_limits => {
            Err(SetupError::NoEffortLimit { agent: own.name.clone(), axis: axis.name.clone() })
        }
        _ => Ok(()),
    }
}
