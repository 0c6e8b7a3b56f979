//! Vehicles with one thrust: `robot.vehicle`, `robot.rotorcraft` and `law.thrust`.

use std::sync::Arc;

use forwardstep_core::controller::{Floor, Yaw};
use forwardstep_core::plant::Rotors;
use forwardstep_sim::{AxisUnit, Law, Robot, RobotSetup, RotorcraftModel, Start, ThrustKind, ThrustLaw, VehicleModel};
use schemars::JsonSchema;
use serde::Deserialize;

use super::bounds::EstimateBoundsFile;
use super::{
    At, Fault, GainFile, InputFolder, LawKind, LawReader, LawTable, LawTemplate, RobotKind, RobotRead, RobotTable,
    RobotTemplate, Spread, StartReader, Stop, TaskTemplate, axis, fault, gain, number_or,
};
use crate::scenario::system_problem::SystemProblem;
use crate::scenario::values::{NotNegative, Positive};

const GRAVITY_M_S2: f64 = 9.81;
const DAMPING_PER_S: f64 = 3.0;
const STIFFNESS: f64 = 4.0;
const ADAPTATION_GAIN: f64 = 0.2;
const RATE_BANDWIDTH_PER_S: f64 = 30.0;
const YAW_GAIN_PER_S: f64 = 1.0;
const APPROACH_S: f64 = 0.1;
/// The default floor of the thrust, as a part of the weight.
const FLOOR: f64 = 0.1;

/// A vehicle with one thrust. Its third axis points down.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VehicleFile {
    /// Its mass, in kg.
    #[schemars(with = "Positive")]
    pub mass_kg: At<f64>,
    /// Gravity, in m/s². Default: 9.81.
    #[schemars(with = "Option<Positive>")]
    pub gravity_m_s2: Option<At<f64>>,
}

impl RobotKind for VehicleFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "vehicle",
            description: "A vehicle in space with one thrust along its own axis, whose angular velocity obeys at once.",
            usual_law: "thrust",
            template: Some(RobotTemplate {
                name: "vehicle",
                line: "robot.vehicle = { mass_kg = 1.5 }".into(),
                says: "the third axis points down",
                starts: vec![[-2.0, 2.0]; 3],
                law: LawTemplate::Lines(
                    "# How the thrust and the rates of turning make it follow.\n\
                     [law.thrust]\n\
                     design.differentiable = { damping_per_s = 3, stiffness = 4 }\n\
                     yaw = { heading_rad = 0.8 }\n",
                ),
                dry_friction: None,
                task: TaskTemplate::of_orders(3, 3),
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let model = VehicleModel { gravity: number_or(&self.gravity_m_s2, GRAVITY_M_S2) };
        Ok(RobotRead::new(robot(model, self.mass_kg.value)))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        let (q, dq) = (given.position()?, given.velocity()?);
        let rest = given.attitude()?.to_vec();
        Ok(Start { reference: given.reference(&dq)?, q, dq, rest })
    }
}

/// A vehicle with one thrust as a rigid body. Its third axis points down.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotorcraftFile {
    /// Its mass, in kg.
    #[schemars(with = "Positive")]
    pub mass_kg: At<f64>,
    /// Gravity, in m/s². Default: 9.81.
    #[schemars(with = "Option<Positive>")]
    pub gravity_m_s2: Option<At<f64>>,
    /// Inertia about the centre of mass in the axes of the body, in kg m²: a number, the diagonal, or the rows of a symmetric
    /// matrix.
    pub inertia_kg_m2: At<GainFile>,
    /// Four rotors on the corners of a square. Default: every thrust and torque that is asked for can be produced.
    pub rotors: Option<At<RotorsFile>>,
}

/// Four rotors, each as far from the two axes of the body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotorsFile {
    /// How far a rotor is from each of the two axes, in m.
    #[schemars(with = "Positive")]
    pub offset_m: At<f64>,
    /// The torque of its drag for each N of thrust, in m.
    #[schemars(with = "Positive")]
    pub drag_m: At<f64>,
    /// The least and the greatest thrust of one rotor, in N.
    #[schemars(with = "[NotNegative; 2]")]
    pub thrust_n: At<[At<f64>; 2]>,
}

impl RobotKind for RotorcraftFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "rotorcraft",
            description: "The same as a rigid body with inertia that torques turn.",
            usual_law: "thrust",
            template: Some(RobotTemplate {
                name: "quadrotor",
                line: "robot.rotorcraft = { mass_kg = 1.2, inertia_kg_m2 = [0.012, 0.012, 0.022], rotors = { offset_m = 0.15, drag_m = 0.02, thrust_n = [0.2, 8] } }".into(),
                says: "the third axis points down",
                starts: vec![[-2.0, 2.0]; 3],
                law: LawTemplate::Lines(
                    "# How the thrust and the rates of turning make it follow.\n\
                     [law.thrust]\n\
                     design.differentiable = { damping_per_s = 3, stiffness = 4 }\n\
                     yaw = { heading_rad = 0.8 }\nrate_bandwidth_per_s = 30\n",
                ),
                dry_friction: None,
                task: TaskTemplate::of_orders(3, 3),
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let place = &self.inertia_kg_m2;
        let model = RotorcraftModel {
            gravity: number_or(&self.gravity_m_s2, GRAVITY_M_S2),
            inertia: gain("inertia_kg_m2", &place.value, place)?,
            rotors: self.rotors.as_ref().map(|rotors| self::rotors(&rotors.value)),
        };
        Ok(RobotRead::new(robot(model, self.mass_kg.value)))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        let (q, dq) = (given.position()?, given.velocity()?);
        let mut rest = given.attitude()?.to_vec();
        rest.extend(given.angular_velocity());
        Ok(Start { reference: given.reference(&dq)?, q, dq, rest })
    }
}

fn rotors(file: &RotorsFile) -> Rotors {
    let [low, high] = &file.thrust_n.value;
    Rotors { offset: file.offset_m.value, drag: file.drag_m.value, thrust: [low.value, high.value] }
}

fn robot(model: impl Robot, mass: f64) -> RobotSetup {
    RobotSetup {
        kind: Arc::new(model),
        theta: vec![mass],
        theta_names: vec!["mass".into()],
        axes: ["x", "y", "z"].map(|name| axis(name, AxisUnit::Metre)).to_vec(),
    }
}

/// The control of a vehicle with one thrust. Agents agree by positions, with two roots for the continuous design and three for
/// the others.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThrustFile {
    /// Which of the paper's controllers. Default: differentiable.
    pub design: Option<ThrustDesignFile>,
    /// What it does about its heading, which the rest leaves free. Default: keeps it at zero.
    pub yaw: Option<YawFile>,
    /// What happens when the thrust, by which the law divides, comes down to a floor. Default: the run stops at a tenth of the
    /// weight.
    pub floor: Option<FloorFile>,
    /// The thrust at the start, in N. Default: the weight, as the law knows it.
    #[schemars(with = "Option<Positive>")]
    pub thrust_start_n: Option<At<f64>>,
    /// How fast the torques of a rotorcraft bring about the angular velocity that is wanted, in 1/s. Default: 30.
    #[schemars(with = "Option<Positive>")]
    pub rate_bandwidth_per_s: Option<At<f64>>,
}

/// The controllers of Section V-B.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThrustDesignFile {
    /// (45), (46): of order two; angular velocities jump where the network switches.
    Continuous,
    /// (49), (50), Theorem 4: of order three, for a known mass.
    Differentiable(DifferentiableFile),
    /// (49), (57), (58), Theorem 5: of order three, for an unknown mass.
    Adaptive(AdaptiveThrustFile),
    /// (57) and (58) by a measured acceleration, which the paper does without: of order two, for an unknown mass; angular velocities jump
    /// where the network switches. For a `vehicle`.
    ByAcceleration(AcceleratedThrustFile),
}

/// The gains of (50).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DifferentiableFile {
    /// The gain α*, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub damping_per_s: Option<At<f64>>,
    /// The gain k, in kg/s² = N/m. Default: 4.
    #[schemars(with = "Option<Positive>")]
    pub stiffness: Option<At<f64>>,
}

/// The gains of (57) and (58).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveThrustFile {
    /// The gain α*, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub damping_per_s: Option<At<f64>>,
    /// The gain γ* of the mass estimate. Default: 0.2. Zero to keep the estimate as it is.
    #[schemars(range(min = 0))]
    pub adaptation_gain: Option<At<f64>>,
    /// The mass estimate at the start, in kg; positive, for the thrust starts with it.
    #[schemars(with = "Positive")]
    pub estimate_start_kg: At<f64>,
    /// Bounds beyond which the mass estimate is not used. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
}

/// The gains of (57) and (58), and the accelerometer.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AcceleratedThrustFile {
    /// The gain α*, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub damping_per_s: Option<At<f64>>,
    /// The gain γ* of the mass estimate. Default: 0.2. Zero to keep the estimate as it is.
    #[schemars(range(min = 0))]
    pub adaptation_gain: Option<At<f64>>,
    /// The mass estimate at the start, in kg; positive, for the thrust starts with it.
    #[schemars(with = "Positive")]
    pub estimate_start_kg: At<f64>,
    /// Bounds beyond which the mass estimate is not used. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
    /// What the accelerometer gives too much on each axis, in m/s². Default: nothing.
    pub bias_m_s2: Option<At<[At<f64>; 3]>>,
}

/// The heading of a vehicle.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YawFile {
    /// The heading at the start, in rad from the first axis towards the second. Default: 0.
    pub heading_rad: Option<f64>,
    /// How fast it turns, in rad/s. Default: 0.
    pub rate_rad_s: Option<f64>,
    /// How fast the vehicle is led to it, in 1/s. Default: 1. Zero to let it be.
    #[schemars(range(min = 0))]
    pub gain_per_s: Option<At<f64>>,
}

/// What happens when the thrust comes down to a floor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FloorFile {
    /// The run stops at this thrust, in N.
    StopsN(#[schemars(with = "Positive")] At<f64>),
    /// The thrust is kept above a floor; no theorem covers that.
    Kept(KeptFloorFile),
}

/// A floor that the thrust stays above.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeptFloorFile {
    /// The floor, in N.
    #[schemars(with = "Positive")]
    pub thrust_n: At<f64>,
    /// The time constant with which it is approached at the fastest, in s. Default: 0.1.
    #[schemars(with = "Option<Positive>")]
    pub approach_s: Option<At<f64>>,
}

impl LawKind for ThrustFile {
    fn table() -> LawTable {
        LawTable {
            key: "thrust",
            description: "A vehicle with one thrust: (46), (50) or (57) of the paper, or (57) by a measured acceleration.",
            made_for: "vehicles and rotorcraft",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<VehicleModel>() || robot.kind.is::<RotorcraftModel>()
    }

    fn law(&self, agent: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let robot = agent.robot;
        let turned = agent.sharing.iter().any(|robot| robot.kind.is::<RotorcraftModel>());
        if let (Some(place), false) = (&self.rate_bandwidth_per_s, turned) {
            return Err(fault(place, SystemProblem::RateBandwidthUnused { agent: agent.agent.to_owned() }));
        }
        let vehicle = robot.kind.downcast().map(|model: &VehicleModel| model.gravity);
        let rotorcraft = robot.kind.downcast().map(|model: &RotorcraftModel| model.gravity);
        let gravity = vehicle.or(rotorcraft).unwrap_or(GRAVITY_M_S2);
        let known = robot.theta.first().copied().unwrap_or_default();
        let (design, mass) = match &self.design {
            None => differentiable(&DifferentiableFile::default(), known),
            Some(ThrustDesignFile::Continuous) => (ThrustKind::Continuous, known),
            Some(ThrustDesignFile::Differentiable(file)) => differentiable(file, known),
            Some(ThrustDesignFile::Adaptive(AdaptiveThrustFile {
                damping_per_s,
                adaptation_gain,
                estimate_start_kg,
                bounds,
            })) => {
                let estimate_start = estimate_start_kg.value;
                let kind = ThrustKind::Adaptive {
                    alpha_star: number_or(damping_per_s, DAMPING_PER_S),
                    gamma_star: number_or(adaptation_gain, ADAPTATION_GAIN),
                    estimate_start,
                    bounds: bounds.as_ref().map(|bounds| bounds.of_mass(robot, agent.agent)).transpose()?,
                };
                (kind, estimate_start)
            }
            Some(ThrustDesignFile::ByAcceleration(file)) => {
                let estimate_start = file.estimate_start_kg.value;
                let bias = file.bias_m_s2.as_ref().map(|bias| bias.value.each_ref().map(|entry| entry.value));
                let kind = ThrustKind::ByAcceleration {
                    alpha_star: number_or(&file.damping_per_s, DAMPING_PER_S),
                    gamma_star: number_or(&file.adaptation_gain, ADAPTATION_GAIN),
                    estimate_start,
                    bounds: file.bounds.as_ref().map(|bounds| bounds.of_mass(robot, agent.agent)).transpose()?,
                    bias: bias.unwrap_or_default(),
                };
                (kind, estimate_start)
            }
        };
        let floor = match &self.floor {
            None => Floor::Stops(FLOOR * mass * gravity),
            Some(FloorFile::StopsN(floor)) => Floor::Stops(floor.value),
            Some(FloorFile::Kept(kept)) => {
                Floor::Kept { floor: kept.thrust_n.value, approach_s: number_or(&kept.approach_s, APPROACH_S) }
            }
        };
        Ok(Arc::new(ThrustLaw {
            design,
            yaw: yaw(self.yaw.as_ref().unwrap_or(&YawFile::default()))?,
            floor,
            thrust_start: self.thrust_start_n.as_ref().map(|start| start.value),
            bandwidth_per_s: number_or(&self.rate_bandwidth_per_s, RATE_BANDWIDTH_PER_S),
        }))
    }
}

fn differentiable(file: &DifferentiableFile, mass: f64) -> (ThrustKind, f64) {
    let alpha_star = number_or(&file.damping_per_s, DAMPING_PER_S);
    (ThrustKind::Differentiable { alpha_star, stiffness: number_or(&file.stiffness, STIFFNESS) }, mass)
}

fn yaw(file: &YawFile) -> Result<Yaw, Fault> {
    let gain = number_or(&file.gain_per_s, YAW_GAIN_PER_S);
    if let (Some(place), Some(_)) = (file.gain_per_s.as_ref().filter(|_| gain == 0.0), file.heading_rad) {
        return Err(fault(place, SystemProblem::HeadingUnused));
    }
    Ok(Yaw { heading: file.heading_rad.unwrap_or(0.0), rate: file.rate_rad_s.unwrap_or(0.0), gain })
}
