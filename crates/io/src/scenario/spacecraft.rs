//! Spacecraft: `robot.spacecraft`, `start.spacecraft` and `law.attitude`.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::attitude::{IDENTITY, Quaternion, difference};
use forwardstep_core::plant::{Spacecraft, SpacecraftError, Wheel, Wheels};
use forwardstep_sim::trajectory::Trajectory;
use forwardstep_sim::{AttitudeLaw, AxisUnit, Law, RobotSetup, SpacecraftModel, Start};

use super::at::At;
use super::attitude::{attitude as attitude_of, quaternion, turn};
use super::fault::{Fault, fault, filled, length, positive, positive_or, values};
use super::file::StartFile;
use super::law::{gain, gain_or, of_another};
use super::robots::axis;
use super::spacecraft_file::{AttitudeFile, SpacecraftFile, SpacecraftStartFile, WheelFile};
use super::system_problem::SystemProblem;
use super::value_problem::ValueProblem;

const ERROR_GAIN_PER_S2: f64 = 1.0;
const RATE_GAIN_PER_S: f64 = 2.0;
const FILTER_GAIN_PER_S: f64 = 1.0;
const DAMPING: f64 = 3.0;
/// Times at which the length of a target is looked at, and what part of its greatest counts as zero.
const SAMPLES: u32 = 1000;
const VANISHING: f64 = 1e-9;

/// Builds the spacecraft.
pub(super) fn spacecraft(file: &SpacecraftFile) -> Result<RobotSetup, Fault> {
    let wheels = match &file.wheels {
        None => Wheels::orthogonal(),
        Some(list) => {
            let wheels =
                filled("wheels", list)?.iter().map(|entry| wheel(&entry.value)).collect::<Result<Vec<_>, _>>()?;
            Wheels::new(&wheels).map_err(|error| {
                let axis = match error {
                    SpacecraftError::Axis { wheel, .. } => {
                        list.value.get(wheel).map(|wheel| wheel.value.axis.span.clone())
                    }
                    _ => None,
                };
                Fault::new(SystemProblem::Spacecraft(error)).at(&axis.unwrap_or_else(|| list.span.clone()))
            })?
        }
    };
    let place = &file.inertia_kg_m2;
    let inertia_kg_m2 = match gain("inertia_kg_m2", &place.value, place, "spacecraft", 3)? {
        Gain::Matrix(entries) => std::array::from_fn(|row| std::array::from_fn(|column| entries[3 * row + column])),
        Gain::Diagonal(entries) => diagonal(|k| entries[k]),
        Gain::Number(entry) | Gain::Bandwidth(entry) => diagonal(|_| entry),
    };
    Spacecraft::new(inertia_kg_m2, wheels.clone(), false)
        .map_err(|error| fault(place, SystemProblem::Spacecraft(error)))?;
    Ok(RobotSetup {
        kind: Arc::new(SpacecraftModel { inertia_kg_m2, wheels }),
        theta: Vec::new(),
        theta_names: Vec::new(),
        axes: ["x", "y", "z", "o"].map(|name| axis(name, AxisUnit::One)).to_vec(),
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

/// Where `agent` with these wheels starts. The agent's own table comes first.
pub(super) fn start<'a>(
    tables: impl Iterator<Item = &'a StartFile>,
    agent: &str,
    wheels: &Wheels,
) -> Result<Start, Fault> {
    let (mut q, mut rate, mut momentum) = (None, None, None);
    for table in tables {
        let own = table.spacecraft.as_ref().map(|own| &own.value);
        let attitude = own.map(turned).transpose()?.flatten();
        let spun = own.and_then(|own| own.rate_rad_s.as_ref());
        if let (Some(_), Some(second)) = (attitude, &table.attitude) {
            return Err(fault(second, ValueProblem::SameQuantity { first: "spacecraft", second: "attitude" }));
        }
        if let (Some(_), Some(second)) = (spun, &table.angular_velocity_rad_s) {
            let problem = ValueProblem::SameQuantity { first: "rate_rad_s", second: "angular_velocity_rad_s" };
            return Err(fault(second, problem));
        }
        q = q.or(attitude).or(table.attitude.as_ref().map(attitude_of).transpose()?);
        rate = rate.or(spun.or(table.angular_velocity_rad_s.as_ref()).map(|rate| rate.value));
        momentum = momentum.or(own.and_then(|own| own.wheel_momentum_n_m_s.as_ref()));
    }
    let rest = match momentum {
        None => vec![0.0; wheels.count()],
        Some(list) => {
            length("wheel_momentum_n_m_s", &list.span, list.value.len(), wheels.count(), agent)?;
            values(&list.value)
        }
    };
    let (q, rate) = (q.unwrap_or(IDENTITY), rate.unwrap_or_default());
    Ok(Start { q: q.to_vec(), dq: rate.to_vec(), rest, reference: Vec::new() })
}

/// The attitude of a table, if it says any.
fn turned(file: &SpacecraftStartFile) -> Result<Option<Quaternion>, Fault> {
    Ok(match (&file.quaternion, &file.axis, &file.angle_rad) {
        (None, None, None) => None,
        (Some(given), None, None) => Some(quaternion(given)?),
        (None, Some(axis), Some(angle)) => Some(turn(axis, angle)?),
        (None, Some(axis), None) => return Err(fault(axis, SystemProblem::HalfAttitude)),
        (None, None, Some(angle)) => return Err(fault(angle, SystemProblem::HalfAttitude)),
        (Some(given), ..) => return Err(fault(given, SystemProblem::HalfAttitude)),
    })
}

/// Refuses a target that is no attitude at some time.
pub(super) fn points_somewhere<T>(place: &At<T>, target: &Trajectory, end_s: f64) -> Result<(), Fault> {
    let mut jets = [[0.0; 5]; 4];
    let mut size = |t_s: f64| {
        target.jets(t_s, &mut jets);
        jets.iter().map(|jet| jet[0].abs()).fold(0.0, f64::max)
    };
    let times = (0..=SAMPLES).map(|k| end_s * f64::from(k) / f64::from(SAMPLES));
    let (t_s, least, most) = times.fold((0.0, f64::INFINITY, 0.0_f64), |(at, least, most), t_s| {
        let size = size(t_s);
        if size < least { (t_s, size, most.max(size)) } else { (at, least, most.max(size)) }
    });
    if least > VANISHING * most { Ok(()) } else { Err(fault(place, SystemProblem::NoAttitude { t_s })) }
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
pub(super) fn attitude(file: &AttitudeFile, agent: &str, robot: &RobotSetup) -> Result<Arc<dyn Law>, Fault> {
    if !robot.kind.is::<SpacecraftModel>() {
        return Err(of_another("attitude", "spacecraft", agent, robot));
    }
    Ok(Arc::new(AttitudeLaw {
        alpha: [
            positive_or("error_gain_per_s2", &file.error_gain_per_s2, ERROR_GAIN_PER_S2)?,
            positive_or("rate_gain_per_s", &file.rate_gain_per_s, RATE_GAIN_PER_S)?,
        ],
        filter: gain_or("filter_gain_per_s", &file.filter_gain_per_s, FILTER_GAIN_PER_S, agent, 4)?,
        damping: gain_or("damping", &file.damping, DAMPING, agent, 4)?,
    }))
}
