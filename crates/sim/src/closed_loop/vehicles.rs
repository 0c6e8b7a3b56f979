//! From agents to vehicles with one thrust and to rotorcraft, with their controllers.

use forwardstep_core::LengthError;
use forwardstep_core::controller::{Floor, RateLoop, Thrust, ThrustCascade, ThrustDesign};
use forwardstep_core::plant::{Rotorcraft, Vehicle};

use super::population::Columns;
use super::systems::{not_negative, positive, root_count, solo};
use super::valid::SetupError;
use crate::setup::{AgentSetup, ReferenceKind, RobotKind, Setup};
use crate::vehicles::{ThrustKind, ThrustLaw};

/// The agent number `agent`, a vehicle whose angular velocity obeys at once.
pub(super) fn vehicle(
    setup: &Setup,
    agent: usize,
    gravity: f64,
    law: ThrustLaw,
) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    let plant = true_vehicle(own, gravity)?;
    let controller = outer(setup, own, &plant, law)?;
    solo(setup, agent, plant, controller)
}

/// The agent number `agent`, a rotorcraft.
pub(super) fn rotorcraft(setup: &Setup, agent: usize, law: ThrustLaw) -> Result<Box<dyn Columns>, SetupError> {
    let own = &setup.agents[agent];
    let RobotKind::Rotorcraft { gravity, inertia, rotors } = &own.robot.kind else {
        let (law, made_for) = (own.law.words(), own.law.made_for());
        return Err(SetupError::LawOfAnother { agent: own.name.clone(), law, made_for });
    };
    positive(own, "the bandwidth of the angular velocity", law.bandwidth_per_s)?;
    if let Some(rotors) = rotors {
        positive(own, "the offset of the rotors", rotors.offset)?;
        positive(own, "the drag of the rotors", rotors.drag)?;
        not_negative(own, "the least thrust of a rotor", rotors.thrust[0])?;
        positive(own, "what the greatest thrust of a rotor has above the least", rotors.thrust[1] - rotors.thrust[0])?;
    }
    let vehicle = true_vehicle(own, *gravity)?;
    let outer = outer(setup, own, &vehicle, law)?;
    let plant = Rotorcraft::new(vehicle, inertia, *rotors).map_err(|error| SetupError::Gain {
        agent: own.name.clone(),
        gain: "J",
        error,
    })?;
    let rates = RateLoop { inertia: *plant.inertia(), bandwidth_per_s: law.bandwidth_per_s };
    solo(setup, agent, plant, ThrustCascade { outer, rates })
}

fn true_vehicle(own: &AgentSetup, gravity: f64) -> Result<Vehicle, SetupError> {
    let length = |error| SetupError::Length { agent: own.name.clone(), error };
    LengthError::check("axes", 3, own.robot.axes.len()).map_err(length)?;
    LengthError::check("theta", 1, own.robot.theta.len()).map_err(length)?;
    let mass = own.robot.theta[0];
    positive(own, "m", mass)?;
    positive(own, "g", gravity)?;
    Ok(Vehicle { mass, gravity })
}

/// The outer law, which knows the true mass unless it adapts it.
fn outer(setup: &Setup, own: &AgentSetup, vehicle: &Vehicle, law: ThrustLaw) -> Result<Thrust, SetupError> {
    let name = || own.name.clone();
    if setup.reference != ReferenceKind::Consensus {
        return Err(match setup.reference {
            ReferenceKind::Tracking => SetupError::NotTracking { agent: name(), law: own.law.words() },
            _ => SetupError::ReferenceOfLaw { agent: name(), law: own.law.words() },
        });
    }
    let roots = &own.roots_per_s;
    root_count(own, law.design.order())?;
    let (design, mass) = match law.design {
        ThrustKind::Continuous => (ThrustDesign::Continuous { roots_per_s: [roots[0], roots[1]] }, vehicle.mass),
        ThrustKind::Differentiable { alpha_star, stiffness } => {
            positive(own, "k", stiffness)?;
            positive(own, "α*", alpha_star)?;
            let roots_per_s = [roots[0], roots[1], roots[2]];
            (ThrustDesign::Differentiable { roots_per_s, alpha_star, stiffness }, vehicle.mass)
        }
        ThrustKind::Adaptive { alpha_star, gamma_star, estimate_start } => {
            positive(own, "α*", alpha_star)?;
            not_negative(own, "γ*", gamma_star)?;
            positive(own, "m̂(0)", estimate_start)?;
            let roots_per_s = [roots[0], roots[1], roots[2]];
            (ThrustDesign::Adaptive { roots_per_s, alpha_star, gamma_star }, estimate_start)
        }
    };
    positive(own, "the floor of the thrust", law.floor.newtons())?;
    if let Floor::Kept { approach_s, .. } = law.floor {
        positive(own, "the time in which the floor of the thrust is approached", approach_s)?;
    }
    not_negative(own, "the gain of the heading", law.yaw.gain)?;
    let mut outer =
        Thrust::new(design, mass, vehicle.gravity).map_err(|error| SetupError::Roots { agent: name(), error })?;
    positive(own, "the thrust at the start", law.thrust_start.unwrap_or(mass * vehicle.gravity))?;
    (outer.yaw, outer.floor, outer.thrust_start) = (law.yaw, law.floor, law.thrust_start);
    Ok(outer)
}
