//! `law.task_space` → [`TaskSpaceLaw`].

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::controller::ParameterBounds;
use forwardstep_core::robot::TipKinematics;
use forwardstep_core::robot::tree::{LinkPoint, TipError, Tree, TreeTip, Uncertain};
use forwardstep_sim::{Attachments, Law, RobotSetup, TaskSpaceLaw, TipSetup};

use super::agents::Body;
use super::at::At;
use super::fault::{Fault, between, fault, filled, length, positive_or, values};
use super::law::{adaptation, damping, estimate, gain_or, known_or_given, of_another};
use super::push_problem::PushProblem;
use super::system_problem::SystemProblem;
use super::task_file::{BoundsFile, CoordinateFile, TaskSpaceFile, TipFile, UncertainFile};
use super::value_problem::ValueProblem;

const DAMPING: f64 = 20.0;
const ADAPTATION: f64 = 30.0;
const TASK_GAIN: f64 = 20.0;
const TORQUE_SHARE: f64 = 5.0;
const REFERENCE_GAIN_PER_S: f64 = 3.0;
const KINEMATIC_GAIN: f64 = 0.3;
const KINEMATIC_START: f64 = 1.2;
const MARGIN_M: f64 = 0.01;
const DETERMINANT_FLOOR: f64 = 0.01;

/// Builds the law of `agent`, which can be held at `body`.
pub(super) fn task_space(
    file: &TaskSpaceFile,
    agent: &str,
    robot: &RobotSetup,
    body: &Body,
) -> Result<Arc<dyn Law>, Fault> {
    let (tip, theta, kinematic_names) = tip(file, agent, robot, body)?;
    let p = theta.len();
    let is_tree = robot.kind.is::<Arc<Tree>>();
    let damping = match &file.damping {
        None if !is_tree => Gain::Number(DAMPING),
        given => damping(given.as_ref(), agent, robot)?,
    };
    let adaptation = match &file.adaptation_gain {
        None if !is_tree => Gain::Number(ADAPTATION),
        given => adaptation(given.as_ref(), agent, robot)?,
    };
    let kinematic_adaptation = gain_or("kinematic_gain", &file.kinematic_gain, KINEMATIC_GAIN, agent, p)?;
    let bounds = file.bounds.as_ref().map(|place| bounds(&place.value, agent, p)).transpose()?;
    if let (Some(place), Gain::Matrix(_)) = (&file.bounds, &kinematic_adaptation) {
        return Err(fault(place, SystemProblem::BoundsOfMatrix));
    }
    let kinematic_start = match &file.kinematic_start {
        None => theta.iter().map(|length| KINEMATIC_START * length).collect(),
        Some(file) => known_or_given("kinematic_start.given", file, agent, &theta)?,
    };
    let floor = file.determinant_floor.as_ref();
    Ok(Arc::new(TaskSpaceLaw {
        tip,
        kinematic_names,
        damping,
        adaptation,
        estimate_start: estimate(file.estimate_start.as_ref(), agent, robot)?,
        task_gain: gain_or("task_gain", &file.task_gain, TASK_GAIN, agent, robot.axes.len())?,
        kappa: positive_or("torque_share", &file.torque_share, TORQUE_SHARE)?,
        alpha_per_s: positive_or("reference_gain_per_s", &file.reference_gain_per_s, REFERENCE_GAIN_PER_S)?,
        kinematic_adaptation: Some(kinematic_adaptation),
        kinematic_start,
        bounds,
        determinant_floor: floor
            .map_or(Ok(DETERMINANT_FLOOR), |floor| between("determinant_floor", floor, 0.0, 0.999))?,
    }))
}

/// The tip with its true θ and the names of its entries.
fn tip(
    file: &TaskSpaceFile,
    agent: &str,
    robot: &RobotSetup,
    body: &Body,
) -> Result<(TipSetup, Vec<f64>, Vec<String>), Fault> {
    match (robot.kind.attachments(), &body.tip, &file.tip) {
        (Attachments::PlanarTip, Some(tip), None) => {
            Ok((TipSetup::Planar(*tip), tip.length_m.to_vec(), tip.parameter_names()))
        }
        (Attachments::PlanarTip, _, Some(place)) => Err(fault(place, SystemProblem::TipOfPlanarArm)),
        (Attachments::Links(tree), _, Some(place)) => {
            of_tree(&place.value, agent, tree, body).and_then(|(setup, tip)| {
                let tip = tip.map_err(|error| no_tip(place, robot, error))?;
                Ok((setup, tip.parameters(), tip.parameter_names()))
            })
        }
        (Attachments::Links(_), _, None) => Err(Fault::new(SystemProblem::NoTip)),
        _ => Err(of_another("task_space", "planar arms and robots from a URDF", agent, robot)),
    }
}

/// What is wrong with a tip, in the words of its robot.
fn no_tip(place: &At<TipFile>, robot: &RobotSetup, error: TipError) -> Fault {
    let TipFile { link, coordinates, .. } = &place.value;
    match (&error, coordinates) {
        (TipError::Beside { joint }, _) => {
            let joint = robot.axes.get(*joint).map_or_else(String::new, |axis| axis.name.clone());
            fault(link, SystemProblem::TipBeside { joint, link: link.value.clone() })
        }
        (TipError::Coordinate { .. }, Some(coordinates)) => fault(coordinates, SystemProblem::Tip(error)),
        _ => fault(place, SystemProblem::Tip(error)),
    }
}

type OfTree = (TipSetup, Result<TreeTip, TipError>);

fn of_tree(file: &TipFile, agent: &str, tree: &Tree, body: &Body) -> Result<OfTree, Fault> {
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
    let tip = TreeTip::new(tree.clone(), &point, &coordinates, uncertain);
    Ok((TipSetup::Point { point, coordinates, uncertain }, tip))
}

fn bounds(file: &BoundsFile, agent: &str, p: usize) -> Result<ParameterBounds, Fault> {
    let list = |key, list: &At<Vec<At<f64>>>| {
        length(key, &list.span, list.value.len(), p, agent)?;
        Ok::<_, Fault>(values(&list.value))
    };
    let (lower, upper) = (list("lower_m", &file.lower_m)?, list("upper_m", &file.upper_m)?);
    for ((low, high), place) in lower.iter().zip(&upper).zip(&file.lower_m.value) {
        if low > high {
            return Err(fault(place, ValueProblem::Interval { key: "bounds", low: *low, high: *high }));
        }
    }
    Ok(ParameterBounds { lower, upper, margin: positive_or("margin_m", &file.margin_m, MARGIN_M)? })
}
