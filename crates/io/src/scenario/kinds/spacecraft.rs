//! Spacecraft: `robot.spacecraft`, `law.attitude` and `law.passivity_filter`.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::attitude::{IDENTITY, Quaternion};
use forwardstep_core::plant::{SpacecraftError, Wheel, Wheels};
use forwardstep_sim::{AttitudeLaw, AxisUnit, Law, PassivityFilterLaw, RobotSetup, SpacecraftModel, Start};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::{
    At, Fault, GainFile, InputFolder, LawKind, LawReader, LawTable, LawTemplate, Mistake, RobotKind, RobotRead,
    RobotTable, RobotTemplate, Spread, StartReader, Stop, TaskTemplate, axis, fault, filled, gain, gain_or, length,
    number_or, positive, values,
};
use crate::scenario::attitude::{attitude as attitude_of, quaternion, turn};
use crate::scenario::attitude_file::WheelStartFile;
use crate::scenario::value_problem::ValueProblem;
use crate::scenario::values::Positive;

const ERROR_GAIN_PER_S2: f64 = 1.0;
const RATE_GAIN_PER_S: f64 = 2.0;
const FILTER_GAIN_PER_S: f64 = 1.0;
const DAMPING: f64 = 3.0;
const ERROR_GAIN_N_M: f64 = 4.0;

/// What is wrong with a spacecraft.
#[derive(Debug, Error)]
enum SpacecraftProblem {
    /// A spacecraft that makes no sense.
    #[error(transparent)]
    Unsound(SpacecraftError),
    /// Two ways of stating an attitude, or half of one.
    #[error("an attitude is `axis` with `angle_rad`, or `quaternion`")]
    HalfAttitude,
}

impl Mistake for SpacecraftProblem {
    fn help(&self) -> Option<String> {
        let text = match self {
            SpacecraftProblem::Unsound(SpacecraftError::Axis { .. }) => "[1, 0, 0] is the first axis of the body",
            SpacecraftProblem::HalfAttitude => {
                "write `axis = [0, 0, 1]` and `angle_rad = 1.5`, or `quaternion = [0, 0, 0, 1]` alone"
            }
            SpacecraftProblem::Unsound(_) => return None,
        };
        Some(text.into())
    }
}

/// A spacecraft that turns itself by reaction wheels.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpacecraftFile {
    /// The inertia of the body with the wheels, less the inertia of each wheel about its own axis, in kg m²: the diagonal, or the
    /// rows of a symmetric matrix.
    pub inertia_kg_m2: At<GainFile>,
    /// At least three, whose axes are not in one plane. Default: three along the axes of the body, without limits.
    #[schemars(with = "Option<Vec<WheelFile>>", length(min = 3))]
    pub wheels: Option<At<Vec<At<WheelFile>>>>,
}

/// A reaction wheel. Limits are reported, and kept where the agent says `enforce_limits = true`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WheelFile {
    /// Its axis in the body, of any length.
    pub axis: At<[f64; 3]>,
    /// The largest torque of its motor, in N m. Default: none.
    #[schemars(with = "Option<Positive>")]
    pub torque_limit_n_m: Option<At<f64>>,
    /// The largest momentum it can hold, in N m s. Default: none.
    #[schemars(with = "Option<Positive>")]
    pub momentum_limit_n_m_s: Option<At<f64>>,
}

impl RobotKind for SpacecraftFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "spacecraft",
            description: "A spacecraft that turns itself by reaction wheels.",
            usual_law: "attitude",
            template: Some(RobotTemplate {
                name: "craft",
                line: "robot.spacecraft = { inertia_kg_m2 = [[10, 0.5, -0.3], [0.5, 8, 0.2], [-0.3, 0.2, 6]], wheels = [{ axis = [1, 0, 0] }, { axis = [0, 1, 0] }, { axis = [0, 0, 1] }] }".into(),
                says: "about its own axes",
                starts: Vec::new(),
                law: LawTemplate::Lines(
                    "# Attitude without a measured angular velocity: (99) to (105).\n\
                     [law.attitude]\nerror_gain_per_s2 = 0.5\nrate_gain_per_s = 1.2\nfilter_gain_per_s = 1\ndamping = 3\n",
                ),
                dry_friction: None,
                task: TaskTemplate::Track {
                    agent: "start.spacecraft = { axis = [1, 2, -1], angle_rad = 2.5, rate_rad_s = [0.05, -0.03, 0.04] }\n\
                            # Where it is to look: a quaternion of any length, vector part first, of formulas in t.\n\
                            target.formulas = [\"0\", \"0\", \"sin(0.1*t)\", \"cos(0.1*t)\"]\n",
                    reference: "# Each follows its own target.\n[reference.tracking]\n",
                },
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        Ok(RobotRead::new(spacecraft(self)?))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        if let (Some(model), Some(factor)) = (read.robot.kind.downcast::<SpacecraftModel>(), spread.factors(1).first())
        {
            let inertia_kg_m2 = model.inertia_kg_m2.map(|row| row.map(|entry| factor * entry));
            read.robot.kind = Arc::new(SpacecraftModel { inertia_kg_m2, wheels: model.wheels.clone() });
        }
        Ok(())
    }

    fn start(&self, robot: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        let wheels = robot.kind.downcast().map_or(0, |model: &SpacecraftModel| model.wheels.count());
        let (mut q, mut rate, mut momentum) = (None, None, None);
        for table in given.tables(&["attitude", "angular_velocity_rad_s", "spacecraft"]) {
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
            None => vec![0.0; wheels],
            Some(list) => {
                length("wheel_momentum_n_m_s", &list.span, list.value.len(), wheels, given.agent())?;
                values(&list.value)
            }
        };
        let (q, rate, reference) = (q.unwrap_or(IDENTITY), rate.unwrap_or_default(), given.attitude_reference()?);
        Ok(Start { q: q.to_vec(), dq: rate.to_vec(), rest, reference })
    }
}

/// Builds the spacecraft.
fn spacecraft(file: &SpacecraftFile) -> Result<RobotSetup, Fault> {
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
                Fault::new(SpacecraftProblem::Unsound(error)).at(&axis.unwrap_or_else(|| list.span.clone()))
            })?
        }
    };
    let place = &file.inertia_kg_m2;
    let sized = |found| length("inertia_kg_m2", &place.span, found, 3, "spacecraft");
    let inertia_kg_m2 = match gain("inertia_kg_m2", &place.value, place)? {
        Gain::Matrix(entries) => {
            sized(entries.len().isqrt())?;
            std::array::from_fn(|row| std::array::from_fn(|column| entries[3 * row + column]))
        }
        Gain::Diagonal(entries) => {
            sized(entries.len())?;
            diagonal(|k| entries[k])
        }
        Gain::Number(entry) | Gain::Bandwidth(entry) => diagonal(|_| entry),
    };
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

/// The attitude of a table, if it says any.
fn turned(file: &WheelStartFile) -> Result<Option<Quaternion>, Fault> {
    Ok(match (&file.quaternion, &file.axis, &file.angle_rad) {
        (None, None, None) => None,
        (Some(given), None, None) => Some(quaternion(given)?),
        (None, Some(axis), Some(angle)) => Some(turn(axis, angle)?),
        (None, Some(axis), None) => return Err(fault(axis, SpacecraftProblem::HalfAttitude)),
        (None, None, Some(angle)) => return Err(fault(angle, SpacecraftProblem::HalfAttitude)),
        (Some(given), ..) => return Err(fault(given, SpacecraftProblem::HalfAttitude)),
    })
}

/// Attitude tracking without angular velocity: (97) to (105) of the paper.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AttitudeFile {
    /// The gain α₁ on the attitude error, in 1/s². Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub error_gain_per_s2: Option<At<f64>>,
    /// The gain α₂ on the rate error, in 1/s. Default: 2.
    #[schemars(with = "Option<Positive>")]
    pub rate_gain_per_s: Option<At<f64>>,
    /// The gain Λ_f of the filter, in 1/s: a number, four, or a 4 × 4 matrix. Default: 1.
    pub filter_gain_per_s: Option<At<GainFile>>,
    /// The gain K of what stands in for the angular velocity: a number, four, or a 4 × 4 matrix. Default: 3.
    pub damping: Option<At<GainFile>>,
}

impl LawKind for AttitudeFile {
    fn table() -> LawTable {
        LawTable {
            key: "attitude",
            description: "A spacecraft follows an attitude, without its angular velocity: (97) to (105) of the paper.",
            made_for: "spacecraft",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<SpacecraftModel>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(AttitudeLaw {
            alpha: [
                number_or(&self.error_gain_per_s2, ERROR_GAIN_PER_S2),
                number_or(&self.rate_gain_per_s, RATE_GAIN_PER_S),
            ],
            filter: gain_or("filter_gain_per_s", &self.filter_gain_per_s, FILTER_GAIN_PER_S)?,
            damping: gain_or("damping", &self.damping, DAMPING)?,
        }))
    }
}

/// A filter of the attitude error, without angular velocity and without reference dynamics, which Remark 10 of the paper compares Theorem 7 with.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PassivityFilterFile {
    /// The gain k on the attitude error, in N m. Default: 4.
    #[schemars(with = "Option<Positive>")]
    pub error_gain_n_m: Option<At<f64>>,
    /// The gain Λ_f of the filter, in 1/s: a number, four, or a 4 × 4 matrix. Default: 1.
    pub filter_gain_per_s: Option<At<GainFile>>,
    /// The gain K of what stands in for the angular velocity: a number, four, or a 4 × 4 matrix. Default: 3.
    pub damping: Option<At<GainFile>>,
}

impl LawKind for PassivityFilterFile {
    fn table() -> LawTable {
        LawTable {
            key: "passivity_filter",
            description: "A spacecraft follows an attitude by a filter of its error, without reference dynamics, to compare `attitude` with: \
                          proved for a target that keeps still.",
            made_for: "spacecraft",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<SpacecraftModel>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(PassivityFilterLaw {
            error_gain_n_m: number_or(&self.error_gain_n_m, ERROR_GAIN_N_M),
            filter: gain_or("filter_gain_per_s", &self.filter_gain_per_s, FILTER_GAIN_PER_S)?,
            damping: gain_or("damping", &self.damping, DAMPING)?,
        }))
    }
}
