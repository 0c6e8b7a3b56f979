//! `robot` of an agent → [`RobotSetup`].

use std::rc::Rc;

use forwardstep_core::robot::PlanarLinks;
use forwardstep_core::robot::tree::Anchor;
use forwardstep_sim::{Axis, AxisUnit, RobotSetup};

use super::ScenarioError;
use super::at::At;
use super::chain;
use super::fault::{Fault, count, fault, not_negative, positive};
use super::file::{FrictionFile, PlanarArmFile, PointMassFile, RobotFile, UrdfFile};
use super::inputs::InputFolder;
use super::problem::ScenarioProblem;
use super::spacecraft::spacecraft;
use super::values::Named;
use super::vehicle;
use crate::files::ReadError;
use crate::urdf::{self, FrictionPolicy, UrdfOptions, UrdfProblem};
use crate::{InputError, SourceText};

/// Axes a point mass may have.
const MOST_DIMENSIONS: u32 = 100;

/// A mistake in the scenario, or in a file that it names.
pub(super) enum Stop {
    Here(Fault),
    Robot(Box<InputError<UrdfProblem>>),
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Stop::Here(fault)
    }
}

impl Stop {
    /// Names the scenario file.
    pub(super) fn in_file(self, source: &SourceText) -> ScenarioError {
        match self {
            Stop::Robot(error) => ScenarioError::Robot(error),
            Stop::Here(Fault { problem, span, source: other }) => {
                let source = other.unwrap_or_else(|| source.clone());
                ScenarioError::Scenario(Box::new(InputError { source, span, problem: *problem }))
            }
        }
    }
}

/// A robot, and what its file's reader had to remark.
pub(super) struct ReadRobot {
    pub(super) robot: RobotSetup,
    pub(super) notices: Vec<urdf::Notice>,
    /// The links of a URDF and where they are held.
    pub(super) links: Rc<[(String, Anchor)]>,
}

/// Builds a robot; `folder` is where files that it names are looked for before the shipped ones.
pub(super) fn robot(file: &At<RobotFile>, folder: &mut InputFolder) -> Result<ReadRobot, Stop> {
    let robot = match &file.value {
        RobotFile::Urdf(file) => return from_urdf(file, folder),
        RobotFile::PlanarArm(arm) => {
            planar_links(arm).and_then(|links| planar_robot(&links)).map_err(|fault| fault.at(&file.span))?
        }
        RobotFile::PointMass(mass) => point_mass(mass)?,
        RobotFile::Vehicle(file) => vehicle::vehicle(file)?,
        RobotFile::Rotorcraft(file) => vehicle::rotorcraft(file)?,
        RobotFile::Spacecraft(file) => spacecraft(file)?,
        RobotFile::Chain(file) => chain::chain(file)?,
        RobotFile::StrictFeedback(file) => chain::strict(file)?,
        RobotFile::PureFeedback(file) => chain::pure(file)?,
    };
    Ok(ReadRobot { robot, notices: Vec::new(), links: Rc::new([]) })
}

fn from_urdf(file: &UrdfFile, folder: &mut InputFolder) -> Result<ReadRobot, Stop> {
    let source = robot_text(&file.file, folder)?;
    let usual = UrdfOptions::default();
    let options = UrdfOptions {
        locked: file.locked.0.iter().map(|(joint, value)| (joint.value.clone(), value.value)).collect(),
        friction: match file.friction {
            Some(FrictionFile::Ignore) => FrictionPolicy::Ignore,
            None => usual.friction,
        },
        gravity: file.gravity_m_s2.unwrap_or(usual.gravity),
    };
    match urdf::read_urdf(&source, &options) {
        Ok(read) => {
            let links = read.links.into_iter().zip(read.anchors).collect();
            Ok(ReadRobot { robot: read.robot, notices: read.notices, links })
        }
        Err(error) => match lock_of(&error.problem, &file.locked) {
            // What is wrong stands in the scenario, not in the URDF.
            Some((joint, _)) => {
                let fault = Fault::new(ScenarioProblem::Lock(Box::new(error.problem.clone())));
                Err(Stop::Here(fault.at(&joint.span)))
            }
            None => Err(Stop::Robot(Box::new(error))),
        },
    }
}

/// The lock that a problem is about: that of the joint it names, or the last one when nothing is left to move.
fn lock_of<'a>(problem: &UrdfProblem, locked: &'a Named) -> Option<&'a (At<String>, At<f64>)> {
    match problem {
        UrdfProblem::LockUnknown { joint, .. } | UrdfProblem::LockFixed { joint } => {
            locked.0.iter().find(|(name, _)| name.value == *joint)
        }
        UrdfProblem::NothingMoves { .. } => locked.0.last(),
        _ => None,
    }
}

/// The text of a robot file: beside the scenario if there is one, else the shipped robot of that name.
fn robot_text(file: &At<String>, folder: &mut InputFolder) -> Result<SourceText, Fault> {
    let name = file.value.as_str();
    let reason = match folder.text(name) {
        Ok(source) => return Ok(source),
        Err(reason) => reason,
    };
    // A shipped robot must not stand in for a file that is known to have been read.
    if reason == ReadError::Missing
        && folder.moved(name).is_none()
        && let Some(text) = urdf::shipped_robot(name)
    {
        return Ok(SourceText::new(name, text));
    }
    let mut known: Vec<String> = urdf::SHIPPED_ROBOTS.iter().map(|(name, _)| format!("{name}.urdf")).collect();
    known.extend(folder.neighbours(name, "urdf"));
    Err(fault(file, ScenarioProblem::RobotFile { file: name.into(), reason, known }))
}

/// The links of a planar arm as its table says.
pub(super) fn planar_links(file: &PlanarArmFile) -> Result<PlanarLinks, Fault> {
    let pair = |key, [first, second]: &[At<f64>; 2]| Ok([positive(key, first)?, positive(key, second)?]);
    let mut links = PlanarLinks::uniform(pair("mass_kg", &file.mass_kg)?, pair("length_m", &file.length_m)?);
    if let Some([first, second]) = &file.com_m {
        links.com_m = [first.value, second.value];
    }
    if let Some([first, second]) = &file.inertia_kg_m2 {
        links.inertia_kg_m2 = [not_negative("inertia_kg_m2", first)?, not_negative("inertia_kg_m2", second)?];
    }
    if let Some(gravity) = &file.gravity_m_s2 {
        links.gravity_m_s2 = not_negative("gravity_m_s2", gravity)?;
    }
    Ok(links)
}

/// The arm with these links.
pub(super) fn planar_robot(links: &PlanarLinks) -> Result<RobotSetup, Fault> {
    let theta = links.theta();
    // det M = ϑ₂(ϑ₁ − ϑ₂) − ϑ₃² cos² q₂, smallest where the arm is straight.
    let [whole, outer, coupling, ..] = theta;
    let determinant = outer * (whole - outer) - coupling * coupling;
    if !(outer > 0.0 && determinant > 0.0 && theta.iter().all(|entry| entry.is_finite())) {
        return Err(Fault::new(ScenarioProblem::MassMatrix));
    }
    Ok(RobotSetup::planar_arm(links))
}

fn point_mass(file: &PointMassFile) -> Result<RobotSetup, Fault> {
    let dimension = count("dimension", &file.dimension, MOST_DIMENSIONS)?;
    Ok(RobotSetup::point_mass(dimension, positive("mass_kg", &file.mass_kg)?))
}

pub(super) fn axis(name: &str, unit: AxisUnit) -> Axis {
    Axis::new(name, unit)
}
