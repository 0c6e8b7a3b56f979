//! Vehicles with one thrust: `robot.vehicle`, `robot.rotorcraft`, their starts and `law.thrust`.

use std::sync::Arc;

use forwardstep_core::attitude::IDENTITY;
use forwardstep_core::controller::{Floor, Yaw};
use forwardstep_core::plant::Rotors;
use forwardstep_sim::{AxisUnit, Law, Robot, RobotSetup, RotorcraftModel, ThrustKind, ThrustLaw, VehicleModel};

use super::at::At;
use super::attitude::attitude;
use super::fault::{Fault, fault, not_negative, not_negative_or, positive, positive_or};
use super::file::StartFile;
use super::law::{gain, of_another};
use super::robots::axis;
use super::system_problem::SystemProblem;
use super::value_problem::ValueProblem;
use super::vehicle_file::{
    AdaptiveThrustFile, DifferentiableFile, FloorFile, RotorcraftFile, RotorsFile, ThrustDesignFile, ThrustFile,
    VehicleFile, YawFile,
};

const GRAVITY_M_S2: f64 = 9.81;
const DAMPING_PER_S: f64 = 3.0;
const STIFFNESS: f64 = 4.0;
const ADAPTATION_GAIN: f64 = 0.2;
const RATE_BANDWIDTH_PER_S: f64 = 30.0;
const YAW_GAIN_PER_S: f64 = 1.0;
const APPROACH_S: f64 = 0.1;
/// The usual floor of the thrust, as a part of the weight.
const FLOOR: f64 = 0.1;

/// Builds a vehicle whose angular velocity obeys at once.
pub(super) fn vehicle(file: &VehicleFile) -> Result<RobotSetup, Fault> {
    let model = VehicleModel { gravity: positive_or("gravity_m_s2", &file.gravity_m_s2, GRAVITY_M_S2)? };
    Ok(robot(model, positive("mass_kg", &file.mass_kg)?))
}

/// Builds a rotorcraft.
pub(super) fn rotorcraft(file: &RotorcraftFile) -> Result<RobotSetup, Fault> {
    let place = &file.inertia_kg_m2;
    let model = RotorcraftModel {
        gravity: positive_or("gravity_m_s2", &file.gravity_m_s2, GRAVITY_M_S2)?,
        inertia: gain("inertia_kg_m2", &place.value, place, "rotorcraft", 3)?,
        rotors: file.rotors.as_ref().map(|rotors| self::rotors(&rotors.value)).transpose()?,
    };
    Ok(robot(model, positive("mass_kg", &file.mass_kg)?))
}

fn rotors(file: &RotorsFile) -> Result<Rotors, Fault> {
    let [low, high] = file.thrust_n.value;
    let least = At { value: low, span: file.thrust_n.span.clone() };
    not_negative("thrust_n", &least)?;
    if low >= high {
        return Err(fault(&file.thrust_n, ValueProblem::Range { key: "thrust_n", low, high }));
    }
    Ok(Rotors {
        offset: positive("offset_m", &file.offset_m)?,
        drag: positive("drag_m", &file.drag_m)?,
        thrust: file.thrust_n.value,
    })
}

fn robot(model: impl Robot, mass: f64) -> RobotSetup {
    RobotSetup {
        kind: Arc::new(model),
        theta: vec![mass],
        theta_names: vec!["mass".into()],
        axes: ["x", "y", "z"].map(|name| axis(name, AxisUnit::Metre)).to_vec(),
    }
}

/// What a start holds beside position and velocity: the attitude, and the angular velocity of a rotorcraft. The agent's own
/// table comes first.
pub(super) fn rest<'a>(
    robot: &RobotSetup,
    tables: impl Iterator<Item = &'a StartFile> + Clone,
) -> Result<Vec<f64>, Fault> {
    let turns = robot.kind.is::<RotorcraftModel>();
    if !turns && !robot.kind.is::<VehicleModel>() {
        return Ok(Vec::new());
    }
    let given = tables.clone().find_map(|table| table.attitude.as_ref());
    let mut rest = given.map_or(Ok(IDENTITY), attitude)?.to_vec();
    if turns {
        let given = { tables }.find_map(|table| table.angular_velocity_rad_s.as_ref());
        rest.extend(given.map_or([0.0; 3], |given| given.value));
    }
    Ok(rest)
}

/// Builds the law of `agent`.
pub(super) fn thrust(file: &ThrustFile, agent: &str, robot: &RobotSetup) -> Result<Arc<dyn Law>, Fault> {
    let vehicle = robot.kind.downcast().map(|model: &VehicleModel| model.gravity);
    let gravity = vehicle
        .or(robot.kind.downcast().map(|model: &RotorcraftModel| model.gravity))
        .ok_or_else(|| of_another("thrust", "vehicles and rotorcraft", agent, robot))?;
    let known = robot.theta.first().copied().unwrap_or_default();
    let (design, mass) = match &file.design {
        None => differentiable(&DifferentiableFile::default(), known)?,
        Some(ThrustDesignFile::Continuous) => (ThrustKind::Continuous, known),
        Some(ThrustDesignFile::Differentiable(file)) => differentiable(file, known)?,
        Some(ThrustDesignFile::Adaptive(AdaptiveThrustFile { damping_per_s, adaptation_gain, estimate_start_kg })) => {
            let estimate_start = positive("estimate_start_kg", estimate_start_kg)?;
            let kind = ThrustKind::Adaptive {
                alpha_star: positive_or("damping_per_s", damping_per_s, DAMPING_PER_S)?,
                gamma_star: not_negative_or("adaptation_gain", adaptation_gain, ADAPTATION_GAIN)?,
                estimate_start,
            };
            (kind, estimate_start)
        }
    };
    let floor = match &file.floor {
        None => Floor::Stops(FLOOR * mass * gravity),
        Some(FloorFile::StopsN(floor)) => Floor::Stops(positive("stops_n", floor)?),
        Some(FloorFile::Kept(kept)) => Floor::Kept {
            floor: positive("thrust_n", &kept.thrust_n)?,
            approach_s: positive_or("approach_s", &kept.approach_s, APPROACH_S)?,
        },
    };
    Ok(Arc::new(ThrustLaw {
        design,
        yaw: yaw(file.yaw.as_ref().unwrap_or(&YawFile::default()))?,
        floor,
        thrust_start: file.thrust_start_n.as_ref().map(|start| positive("thrust_start_n", start)).transpose()?,
        bandwidth_per_s: positive_or("rate_bandwidth_per_s", &file.rate_bandwidth_per_s, RATE_BANDWIDTH_PER_S)?,
    }))
}

fn differentiable(file: &DifferentiableFile, mass: f64) -> Result<(ThrustKind, f64), Fault> {
    let alpha_star = positive_or("damping_per_s", &file.damping_per_s, DAMPING_PER_S)?;
    let stiffness = positive_or("stiffness", &file.stiffness, STIFFNESS)?;
    Ok((ThrustKind::Differentiable { alpha_star, stiffness }, mass))
}

fn yaw(file: &YawFile) -> Result<Yaw, Fault> {
    let gain = not_negative_or("gain_per_s", &file.gain_per_s, YAW_GAIN_PER_S)?;
    if let (Some(place), Some(_)) = (file.gain_per_s.as_ref().filter(|_| gain == 0.0), file.heading_rad) {
        return Err(fault(place, SystemProblem::HeadingUnused));
    }
    Ok(Yaw { heading: file.heading_rad.unwrap_or(0.0), rate: file.rate_rad_s.unwrap_or(0.0), gain })
}
