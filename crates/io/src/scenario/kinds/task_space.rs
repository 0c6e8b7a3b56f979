//! `law.task_space`: the end-effector of a robot follows a target with uncertain lengths, Theorem 6 or with a measured velocity.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::controller::NullSpace;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::TipKinematics;
use forwardstep_core::robot::tree::{Follows, LinkPoint, TipError, Tree, TreeTip, Uncertain};
use forwardstep_sim::{Attachments, Law, RobotSetup, TaskSpaceLaw, TipSetup};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

use super::bounds::{EstimateBoundsFile, started};
use super::{
    At, Body, DampingFile, EstimateStartFile, Fault, GainFile, GainOrBandwidth, LawKind, LawReader, LawTable, Mistake,
    adaptation, damping, fault, filled, gain_or, length, number_or, values,
};
use crate::scenario::gains::{has_scales, known_or_given};
use crate::scenario::push_problem::PushProblem;
use crate::scenario::values::Positive;

const DAMPING: f64 = 20.0;
const ADAPTATION: f64 = 30.0;
const TASK_GAIN: f64 = 20.0;
const ATTITUDE_GAIN: f64 = 20.0;
const NULL_SPACE_RATE_PER_S: f64 = 1.0;
const TORQUE_SHARE: f64 = 5.0;
const REFERENCE_GAIN_PER_S: f64 = 3.0;
const KINEMATIC_GAIN: f64 = 0.3;
const KINEMATIC_START: f64 = 1.2;
/// Joints of an arm with poses.
const POSE_JOINTS: usize = 6;
const MARGIN_M: f64 = 0.01;
const DETERMINANT_FLOOR: f64 = 0.01;

/// What is wrong with a tip.
#[derive(Debug, Error)]
enum TipProblem {
    /// A tip whose Jacobian cannot be inverted.
    #[error(transparent)]
    Unsound(TipError),
    /// A joint that moves beside the tip.
    #[error("`{joint}` moves, but does not carry `{link}`")]
    Beside {
        /// The joint.
        joint: String,
        /// The link with the tip.
        link: String,
    },
    /// A robot from a URDF without a tip.
    #[error("the law `task_space` needs `end_effector` for a robot from a URDF")]
    Missing,
    /// A tip where there is one already.
    #[error("the end-effector of a planar arm is the end of its second link; `end_effector` is for robots from a URDF")]
    OfPlanarArm,
    /// A gain of an orientation that does not follow.
    #[error("`attitude_gain` is for an end-effector whose orientation follows the target too")]
    NoPose,
    /// A null-space term of a pose.
    #[error("a pose leaves none of its six joints free, and the theorem has no null-space term beside an orientation")]
    PoseNullSpace,
    /// A null-space term of a planar arm.
    #[error(
        "a planar arm has as many joints as its end-effector has coordinates; `null_space` is for redundant robots from a URDF"
    )]
    PlanarNullSpace,
    /// A measured velocity of a pose, or of redundant joints.
    #[error(
        "with a measured velocity of the end-effector the law is derived for positions of as many coordinates as there are joints"
    )]
    MeasuredVelocity,
    /// Bounds beside a full matrix.
    #[error("`bounds` need `kinematic_gain` to be a number or a diagonal, not a matrix")]
    BoundsOfMatrix,
}

impl Mistake for TipProblem {
    fn help(&self) -> Option<String> {
        Some(match self {
            TipProblem::Beside { joint, .. } => format!("add `{joint}` to `locked`, or choose a link behind it"),
            TipProblem::OfPlanarArm => "leave `end_effector` out".into(),
            TipProblem::Unsound(TipError::Coordinate { .. }) => "choose `x`, `y` and `z`, each at most once".into(),
            TipProblem::Unsound(TipError::Size { joints, coordinates }) if joints > coordinates => {
                "`locked` of the robot holds joints of a URDF; or leave the others to `null_space = { posture = [...] }`".into()
            }
            TipProblem::Unsound(TipError::Size { .. }) => "`locked` of the robot holds joints of a URDF".into(),
            TipProblem::Unsound(TipError::PoseJoints { joints }) if *joints > POSE_JOINTS => {
                "lock joints of the robot until six move, or let the position alone follow, with `null_space`".into()
            }
            TipProblem::Unsound(TipError::PoseCoordinates) => "leave `coordinates` out".into(),
            TipProblem::Unsound(TipError::NotRedundant { .. }) | TipProblem::PoseNullSpace | TipProblem::PlanarNullSpace => {
                "leave `null_space` out".into()
            }
            TipProblem::NoPose => "leave it out, or let `follows` of the end-effector be \"pose\"".into(),
            TipProblem::MeasuredVelocity => "leave `tip_velocity` out: Theorem 6 needs none".into(),
            TipProblem::Missing => "add end_effector = { link = \"…\" } with a link of the URDF".into(),
            TipProblem::Unsound(_) | TipProblem::BoundsOfMatrix => return None,
        })
    }
}

/// The end-effector follows the target with uncertain lengths and parameters, without its velocity: (80) to (82) of the paper.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TaskSpaceFile {
    /// The end-effector of a robot from a URDF. A planar arm has one of its own.
    pub end_effector: Option<At<TipFile>>,
    /// Where the velocity of the end-effector comes from. Default: there is none, and z is integrated as in Theorem 6.
    pub tip_velocity: Option<At<TipVelocityFile>>,
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 20 otherwise.
    pub damping: Option<DampingFile>,
    /// The gain Γ. Default: a bandwidth of 5 1/s for a URDF, 30 otherwise.
    pub adaptation_gain: Option<At<GainOrBandwidth>>,
    /// The estimate of the parameters at the start. Default: zero, or the nearest within `estimate_bounds`.
    pub estimate_start: Option<EstimateStartFile>,
    /// Bounds that the estimate of the parameters is kept within. Default: none.
    pub estimate_bounds: Option<EstimateBoundsFile>,
    /// The gain K* on the error of the end-effector in the reference dynamics: a number, a diagonal or a matrix. Default: 20.
    pub task_gain: Option<At<GainFile>>,
    /// The gain k_o on Δq_v of an end-effector whose orientation follows too. It is one number: with a matrix no energy is left to
    /// fall. Default: 20.
    #[schemars(with = "Option<Positive>")]
    pub attitude_gain: Option<At<f64>>,
    /// What joints beyond the coordinates of the end-effector do: not from the paper.
    pub null_space: Option<At<NullSpaceFile>>,
    /// The gain κ with which that error enters the torque. Default: 5.
    #[schemars(with = "Option<Positive>")]
    pub torque_share: Option<At<f64>>,
    /// The rate α at which the reference velocity forgets, in 1/s; with a measured velocity of the end-effector, the rate at which its error
    /// vanishes. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub reference_gain_per_s: Option<At<f64>>,
    /// The gain Λ of the lengths: a number, a diagonal or a matrix. Large ones can drive the estimated Jacobian through a
    /// singularity. Default: 0.3.
    pub kinematic_gain: Option<At<GainFile>>,
    /// The estimate of the lengths at the start. Zero would be singular. Default: the true ones times 1.2.
    pub kinematic_start: Option<EstimateStartFile>,
    /// Keeps the estimates of the lengths within bounds. Default: there are none.
    pub bounds: Option<At<BoundsFile>>,
    /// The run ends when det Ĵ, or of poses and redundant joints its smallest singular value, falls below this share of its first
    /// value. Default: 0.01.
    #[schemars(range(min = 0, max = 1))]
    pub determinant_floor: Option<At<f64>>,
}

/// A point of a link, and what is known of it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TipFile {
    /// The link, by its name in the URDF.
    pub link: At<String>,
    /// The point in the frame of the link, in m. Default: its origin.
    pub at_m: Option<[f64; 3]>,
    /// Which coordinates of the base frame are controlled: as many as joints move. Default: all three.
    #[schemars(length(min = 1, max = 3))]
    pub coordinates: Option<At<Vec<At<CoordinateFile>>>>,
    /// What follows the target. Default: the position.
    pub follows: Option<FollowsFile>,
    /// Which lengths are uncertain. Default: the tool.
    pub uncertain: Option<UncertainFile>,
}

/// What of the end-effector follows the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FollowsFile {
    /// Its position.
    Position,
    /// Its position and its orientation, by exactly six joints: not from the paper. The target has a quaternion after the
    /// position, of the link in the base.
    Pose,
}

/// Where the velocity of a tip comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TipVelocityFile {
    /// It is measured, and z is a function of it: not from the paper, whose Remark 9 names such laws for contrast.
    Measured,
}

/// The posture that redundant joints keep to where the end-effector leaves them free.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NullSpaceFile {
    /// How fast each joint at most goes there, in 1/s. Default: 1.
    #[schemars(with = "Option<Positive>")]
    pub rate_per_s: Option<At<f64>>,
    /// The posture, an entry per joint, in rad or m.
    pub posture: At<Vec<At<f64>>>,
}

/// A coordinate of the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CoordinateFile {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// Which lengths are uncertain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UncertainFile {
    /// From the last joint to the end-effector.
    Tool,
    /// From each joint to the next as well, for the Jacobian; the regressor of the dynamics keeps the geometry of the URDF, so no
    /// theorem covers those of them that enter it: see what `check` says.
    Chain,
}

/// Bounds of the lengths, an entry for each.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundsFile {
    /// In m.
    pub lower_m: At<Vec<At<f64>>>,
    /// In m.
    pub upper_m: At<Vec<At<f64>>>,
    /// How far beyond an estimate may go before it stands, in m. Default: 0.01.
    #[schemars(with = "Option<Positive>")]
    pub margin_m: Option<At<f64>>,
}

impl LawKind for TaskSpaceFile {
    fn table() -> LawTable {
        LawTable {
            key: "task_space",
            description: "The end-effector of a robot follows a target, with uncertain lengths and without its velocity: (80) to (82) of the paper.",
            made_for: "planar arms and robots from a URDF",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        matches!(robot.interface().attachments, Attachments::PlanarTip | Attachments::Links(_))
    }

    fn law(&self, reader: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let LawReader { agent, robot, body, .. } = *reader;
        let (tip, theta, kinematic_names) = tip(self, agent, robot, body)?;
        let scaled = has_scales(robot);
        let damping = match &self.damping {
            None if !scaled => Gain::Number(DAMPING),
            given => damping(given.as_ref(), reader)?,
        };
        let adaptation = match &self.adaptation_gain {
            None if !scaled => Gain::Number(ADAPTATION),
            given => adaptation(given.as_ref(), reader)?,
        };
        let kinematic_adaptation = gain_or("kinematic_gain", &self.kinematic_gain, KINEMATIC_GAIN)?;
        let estimate_bounds = self.estimate_bounds.as_ref().map(|bounds| bounds.of(robot)).transpose()?;
        let bounds = self.bounds.as_ref().map(|place| bounds(&place.value));
        if let (Some(place), Gain::Matrix(_)) = (&self.bounds, &kinematic_adaptation) {
            return Err(fault(place, TipProblem::BoundsOfMatrix));
        }
        let kinematic_start = match &self.kinematic_start {
            None => theta.iter().map(|length| KINEMATIC_START * length).collect(),
            Some(file) => known_or_given(file, &theta),
        };
        if let (Some(place), false) = (&self.attitude_gain, tip.follows() == Follows::Pose) {
            return Err(fault(place, TipProblem::NoPose));
        }
        let by_velocity = self.tip_velocity.is_some();
        if let (Some(place), false) = (&self.tip_velocity, tip.follows() == Follows::Position) {
            return Err(fault(place, TipProblem::MeasuredVelocity));
        }
        let null_space = self.null_space.as_ref().map(|place| null_space(&place.value, agent, robot)).transpose()?;
        Ok(Arc::new(TaskSpaceLaw {
            tip,
            by_velocity,
            kinematic_names,
            damping,
            adaptation,
            estimate_start: started(self.estimate_start.as_ref(), estimate_bounds.as_ref(), reader),
            estimate_bounds,
            task_gain: gain_or("task_gain", &self.task_gain, TASK_GAIN)?,
            attitude_gain: number_or(&self.attitude_gain, ATTITUDE_GAIN),
            null_space,
            kappa: number_or(&self.torque_share, TORQUE_SHARE),
            alpha_per_s: number_or(&self.reference_gain_per_s, REFERENCE_GAIN_PER_S),
            kinematic_adaptation: Some(kinematic_adaptation),
            kinematic_start,
            bounds,
            determinant_floor: number_or(&self.determinant_floor, DETERMINANT_FLOOR),
        }))
    }
}

/// The tip with its true θ and the names of its entries.
fn tip(
    file: &TaskSpaceFile,
    agent: &str,
    robot: &RobotSetup,
    body: &Body,
) -> Result<(TipSetup, Vec<f64>, Vec<String>), Fault> {
    if let (Attachments::PlanarTip, Some(place)) = (robot.interface().attachments, &file.null_space) {
        return Err(fault(place, TipProblem::PlanarNullSpace));
    }
    match (robot.interface().attachments, &body.tip, &file.end_effector) {
        (Attachments::PlanarTip, Some(tip), None) => {
            Ok((TipSetup::Planar(*tip), tip.length_m.to_vec(), tip.parameter_names()))
        }
        (Attachments::PlanarTip, _, Some(place)) => Err(fault(place, TipProblem::OfPlanarArm)),
        (Attachments::Links(tree), _, Some(place)) => {
            let follows = match (place.value.follows, &file.null_space) {
                (Some(FollowsFile::Pose), Some(null_space)) => {
                    return Err(fault(null_space, TipProblem::PoseNullSpace));
                }
                (Some(FollowsFile::Pose), None) => Follows::Pose,
                (Some(FollowsFile::Position) | None, Some(_)) => Follows::RedundantPosition,
                (Some(FollowsFile::Position) | None, None) => Follows::Position,
            };
            of_tree(&place.value, agent, (&tree, follows), body).and_then(|(setup, tip)| {
                let tip = tip.map_err(|error| no_tip(place, robot, error))?;
                Ok((setup, tip.parameters(), tip.parameter_names()))
            })
        }
        _ => Err(Fault::new(TipProblem::Missing)),
    }
}

/// What is wrong with a tip, in the words of its robot.
fn no_tip(place: &At<TipFile>, robot: &RobotSetup, error: TipError) -> Fault {
    let TipFile { link, coordinates, .. } = &place.value;
    match (&error, coordinates) {
        (TipError::Beside { joint }, _) => {
            let joint = robot.axes.get(*joint).map_or_else(String::new, |axis| axis.name.clone());
            fault(link, TipProblem::Beside { joint, link: link.value.clone() })
        }
        (TipError::Coordinate { .. } | TipError::PoseCoordinates, Some(coordinates)) => {
            fault(coordinates, TipProblem::Unsound(error))
        }
        _ => fault(place, TipProblem::Unsound(error)),
    }
}

type OfTree = (TipSetup, Result<TreeTip, TipError>);

fn of_tree(file: &TipFile, agent: &str, (tree, follows): (&Tree, Follows), body: &Body) -> Result<OfTree, Fault> {
    let Some((_, link)) = body.links.iter().find(|(name, _)| *name == file.link.value) else {
        let links = body.links.iter().map(|(name, _)| name.clone()).collect();
        let (link, agent) = (file.link.value.clone(), agent.to_owned());
        return Err(fault(&file.link, PushProblem::NoSuchLink { link, agent, links }));
    };
    let point = LinkPoint { link: *link, at: file.at_m.unwrap_or_default() };
    let coordinates: Vec<usize> = match &file.coordinates {
        None => vec![0, 1, 2],
        Some(list) => filled("coordinates", list)?
            .iter()
            .map(|entry| match entry.value {
                CoordinateFile::X => 0,
                CoordinateFile::Y => 1,
                CoordinateFile::Z => 2,
            })
            .collect(),
    };
    let uncertain = match file.uncertain {
        None | Some(UncertainFile::Tool) => Uncertain::Tool,
        Some(UncertainFile::Chain) => Uncertain::Chain,
    };
    let tip = TreeTip::new(tree.clone(), &point, &coordinates, follows, uncertain);
    Ok((TipSetup::Point { point, coordinates, follows, uncertain }, tip))
}

fn null_space(file: &NullSpaceFile, agent: &str, robot: &RobotSetup) -> Result<NullSpace, Fault> {
    let posture = values(&file.posture.value);
    length("posture", &file.posture.span, posture.len(), robot.axes.len(), agent)?;
    Ok(NullSpace { rate_per_s: number_or(&file.rate_per_s, NULL_SPACE_RATE_PER_S), posture })
}

fn bounds(file: &BoundsFile) -> ParameterBounds {
    let [lower, upper] = [&file.lower_m, &file.upper_m].map(|list| values(&list.value));
    ParameterBounds::new(lower, upper, number_or(&file.margin_m, MARGIN_M))
}
