//! Spacecraft: `robot.spacecraft`, `start.spacecraft` and `law.attitude`.

use forwardstep_core::Gain;
use forwardstep_core::Scalar;
use forwardstep_core::attitude::{IDENTITY, difference, normalized};
use forwardstep_core::plant::{Spacecraft, Wheel, Wheels};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AttitudeLaw, Axis, AxisUnit, Law, RobotKind, RobotSetup, Start};

use super::at::At;
use super::fault::{Fault, fault, filled, positive};
use super::law::gain;
use super::problem::ScenarioProblem;
use super::spacecraft_file::{AttitudeFile, SpacecraftFile, SpacecraftStartFile, WheelFile};

const ERROR_GAIN_PER_S2: f64 = 1.0;
const RATE_GAIN_PER_S: f64 = 2.0;
const FILTER_GAIN_PER_S: f64 = 1.0;
const DAMPING: f64 = 3.0;

/// Builds the spacecraft.
pub(super) fn spacecraft(file: &SpacecraftFile) -> Result<RobotSetup, Fault> {
    let wheels = match &file.wheels {
        None => Wheels::orthogonal(),
        Some(list) => {
            let wheels =
                filled("wheels", list)?.iter().map(|entry| wheel(&entry.value)).collect::<Result<Vec<_>, _>>()?;
            Wheels::new(&wheels).map_err(|error| fault(list, ScenarioProblem::Spacecraft(error)))?
        }
    };
    let place = &file.inertia_kg_m2;
    let inertia_kg_m2 = match gain("inertia_kg_m2", &place.value, place, "the spacecraft", 3)? {
        Gain::Matrix(entries) => std::array::from_fn(|row| std::array::from_fn(|column| entries[3 * row + column])),
        Gain::Diagonal(entries) => diagonal(|k| entries[k]),
        Gain::Number(entry) | Gain::Bandwidth(entry) => diagonal(|_| entry),
    };
    Spacecraft::new(inertia_kg_m2, wheels.clone(), false)
        .map_err(|error| fault(place, ScenarioProblem::Spacecraft(error)))?;
    let axis = |name: &str| Axis {
        name: name.into(),
        unit: AxisUnit::One,
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
    };
    Ok(RobotSetup {
        kind: RobotKind::Spacecraft { inertia_kg_m2, wheels },
        theta: Vec::new(),
        theta_names: Vec::new(),
        axes: ["x", "y", "z", "o"].map(axis).to_vec(),
    })
}

fn diagonal(entry: impl Fn(usize) -> f64) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| if row == column { entry(row) } else { 0.0 }))
}

fn wheel(file: &WheelFile) -> Result<Wheel, Fault> {
    let limit = |key, value: &Option<At<f64>>| value.as_ref().map(|value| positive(key, value)).transpose();
    Ok(Wheel {
        axis: file.axis.value,
        torque_limit_n_m: limit("torque_limit_n_m", &file.torque_limit_n_m)?,
        momentum_limit_n_m_s: limit("momentum_limit_n_m_s", &file.momentum_limit_n_m_s)?,
    })
}

/// Where `agent` with these wheels starts.
pub(super) fn start(file: Option<&At<SpacecraftStartFile>>, agent: &str, wheels: &Wheels) -> Result<Start, Fault> {
    let still = SpacecraftStartFile::default();
    let file = file.map_or(&still, |file| &file.value);
    let q = match (&file.quaternion, &file.axis, &file.angle_rad) {
        (None, None, None) => IDENTITY,
        (Some(quaternion), None, None) if quaternion.value.iter().any(|x| *x != 0.0) => normalized(quaternion.value),
        (Some(quaternion), None, None) => return Err(fault(quaternion, ScenarioProblem::NoDirection)),
        (None, Some(axis), Some(angle)) => {
            let [x, y, z] = axis.value;
            let [x, y, z, norm] = normalized([x, y, z, 0.0]);
            // Zero gives the identity.
            if norm != 0.0 {
                return Err(fault(axis, ScenarioProblem::NoDirection));
            }
            let (sin, cos) = Scalar::sin_cos(0.5 * angle.value);
            [sin * x, sin * y, sin * z, cos]
        }
        (None, Some(axis), None) => return Err(fault(axis, ScenarioProblem::HalfAttitude)),
        (None, None, Some(angle)) => return Err(fault(angle, ScenarioProblem::HalfAttitude)),
        (Some(quaternion), ..) => return Err(fault(quaternion, ScenarioProblem::HalfAttitude)),
    };
    let rest = match &file.wheel_momentum_n_m_s {
        None => vec![0.0; wheels.count()],
        Some(list) if list.value.len() == wheels.count() => list.value.iter().map(|entry| entry.value).collect(),
        Some(list) => {
            let (found, need, agent) = (list.value.len(), wheels.count(), agent.to_owned());
            let key = "wheel_momentum_n_m_s";
            return Err(fault(list, ScenarioProblem::VectorLength { key, found, need, agent }));
        }
    };
    let dq = file.rate_rad_s.as_ref().map_or([0.0; 3], |rate| rate.value).to_vec();
    Ok(Start { q: q.to_vec(), dq, rest, reference: Vec::new() })
}

/// Of the two quaternions of the attitude at the start, takes the one that is nearer to the target: the law leads to Δq_o = 1
/// and would otherwise take the long way round.
pub(super) fn short_way(start: &mut Start, target: &Trajectory) {
    let mut jets = [[0.0; 5]; 4];
    target.jets(0.0, &mut jets);
    if let Some(q) = start.q.first_chunk_mut::<4>()
        && difference(*q, jets.map(|jet| jet[0]))[3] < 0.0
    {
        *q = q.map(|x| -x);
    }
}

/// Builds (97)–(105).
pub(super) fn attitude(file: &AttitudeFile, agent: &str, robot: &RobotSetup) -> Result<Law, Fault> {
    if !matches!(robot.kind, RobotKind::Spacecraft { .. }) {
        let (agent, law, made_for) = (agent.to_owned(), "attitude", "spacecraft");
        return Err(Fault::new(ScenarioProblem::LawOfAnother { agent, law, made_for }));
    }
    let number = |key, value: &Option<At<f64>>, usual| value.as_ref().map_or(Ok(usual), |value| positive(key, value));
    let matrix = |key, value: &Option<At<_>>, usual| match value {
        None => Ok(Gain::Number(usual)),
        Some(place) => gain(key, &place.value, place, agent, 4),
    };
    Ok(Law::Attitude(Box::new(AttitudeLaw {
        alpha: [
            number("error_gain_per_s2", &file.error_gain_per_s2, ERROR_GAIN_PER_S2)?,
            number("rate_gain_per_s", &file.rate_gain_per_s, RATE_GAIN_PER_S)?,
        ],
        filter: matrix("filter_gain_per_s", &file.filter_gain_per_s, FILTER_GAIN_PER_S)?,
        damping: matrix("damping", &file.damping, DAMPING)?,
    })))
}
