//! `robot.urdf`: an arm, or any tree of rigid bodies on a fixed base.

use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_sim::drives::JointDrives;
use forwardstep_sim::{RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::drives::{FrictionFile, each};
use super::{
    At, AxisValues, Body, Fault, InputFolder, RobotKind, RobotRead, RobotTable, Spread, StartReader, Stop, fault,
};
use crate::SourceText;
use crate::files::ReadError;
use crate::scenario::problem::ScenarioProblem;
use crate::scenario::values::{Named, NotNegativeEach};
use crate::urdf::{self, FrictionPolicy, UrdfOptions, UrdfProblem};

/// Positions at which the mass matrix of a tree is looked at.
const SAMPLES: usize = 16;

/// A robot from a URDF.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UrdfFile {
    /// The URDF, beside the scenario file or in `inputs` beside it, or the name of a shipped robot: `ur5e.urdf`, `panda.urdf`,
    /// `gantry.urdf`.
    pub file: At<String>,
    /// Joints held at a value, in rad or m; each removes one axis.
    #[serde(default)]
    pub locked: Named,
    /// Viscous damping, for all joints or for each, in N m s or N s/m. Default: what the URDF states.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub damping: Option<At<AxisValues>>,
    /// The inertia of the rotors behind the gears, for all joints or for each, in kg m² or kg: n²J for a rotor with the inertia J that
    /// turns n times as fast as its joint. It may be all that resists the joint of a link without mass. Default: none.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub armature: Option<At<AxisValues>>,
    /// What to do with Coulomb friction. Without it a URDF that states some is refused.
    pub friction: Option<FrictionFile>,
    /// Gravity in the base frame, in m/s². Default: [0, 0, -9.81].
    pub gravity_m_s2: Option<[f64; 3]>,
}

impl RobotKind for UrdfFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "urdf",
            description: "An arm, or any tree of rigid bodies on a fixed base, from a URDF.",
            usual_law: "adaptive",
            template: None,
        }
    }

    fn read(&self, folder: &mut InputFolder) -> Result<RobotRead, Stop> {
        from_urdf(self, folder)
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        let robot = &mut read.robot;
        // Ten parameters per body come first; they scale together, and dampings stay.
        let bodies = robot.theta.chunks_exact_mut(10).zip(spread.factors(robot.axes.len()));
        bodies.for_each(|(body, factor)| body.iter_mut().for_each(|entry| *entry *= factor));
        let anywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let range: Vec<[f64; 2]> = robot.axes.iter().map(|axis| axis.position_limits.unwrap_or(anywhere)).collect();
        let tree = robot.kind.downcast::<Arc<Tree>>();
        tree.map_or(Ok(()), |tree| tree.check_mass_matrix(&robot.theta, &range, SAMPLES)).map_err(|_| spread.unsound())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        given.position_and_velocity()
    }
}

fn from_urdf(file: &UrdfFile, folder: &mut InputFolder) -> Result<RobotRead, Stop> {
    let source = robot_text(&file.file, folder)?;
    let usual = UrdfOptions::default();
    let options = UrdfOptions {
        locked: file.locked.0.iter().map(|(joint, value)| (joint.value.clone(), value.value)).collect(),
        armature: file.armature.as_ref().map_or_else(Vec::new, |place| place.value.each(1)),
        friction: match file.friction {
            Some(FrictionFile::Ignore) => FrictionPolicy::Ignore,
            Some(FrictionFile::Dry(_) | FrictionFile::Smooth(_)) => FrictionPolicy::Read,
            None => usual.friction,
        },
        gravity: file.gravity_m_s2.unwrap_or(usual.gravity),
    };
    match urdf::read_urdf(&source, &options) {
        Ok(read) => {
            let axes = read.coulomb.len();
            let damping = file.damping.as_ref().map(|place| place.value.each(axes));
            let friction = file.friction.as_ref().and_then(|friction| friction.of(&read.coulomb));
            let drives = JointDrives { damping, armature: each(file.armature.as_ref(), &vec![0.0; axes]), friction };
            let robot = read.robot.with_drives(&drives).map_err(Fault::from)?;
            let links = read.links.into_iter().zip(read.anchors).collect();
            Ok(RobotRead { robot, notices: read.notices, body: Body { links, tip: None, urdf: Some(source) } })
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
        && !folder.is_named(name)
        && let Some(text) = urdf::shipped_robot(name)
    {
        return Ok(SourceText::new(name, text));
    }
    let mut known: Vec<String> = urdf::SHIPPED_ROBOTS.iter().map(|(name, _)| format!("{name}.urdf")).collect();
    known.extend(folder.neighbours(name, "urdf"));
    Err(fault(file, ScenarioProblem::RobotFile { file: name.into(), reason, known }))
}
