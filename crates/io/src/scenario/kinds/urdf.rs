//! `robot.urdf`: an arm, or any tree of rigid bodies on a fixed base.

use std::sync::Arc;

use forwardstep_core::robot::tree::Tree;
use forwardstep_sim::{RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    At, AxisValues, Body, Fault, InputFolder, RobotKind, RobotRead, RobotTable, Spread, StartReader, Stop, fault,
    number_or,
};
use crate::SourceText;
use crate::files::ReadError;
use crate::scenario::problem::ScenarioProblem;
use crate::scenario::values::{Named, NotNegativeEach, Positive};
use crate::urdf::{self, FrictionPolicy, JointDrives, JointFriction, UrdfOptions, UrdfProblem};

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
    /// The inertia of the rotors behind the gears, for all joints or for each, in kg m² or kg: n²J for a rotor with the inertia J that
    /// turns n times as fast as its joint. Default: none.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub armature: Option<At<AxisValues>>,
    /// What to do with Coulomb friction. Without it a URDF that states some is refused.
    pub friction: Option<FrictionFile>,
    /// Gravity in the base frame, in m/s². Default: [0, 0, -9.81].
    pub gravity_m_s2: Option<[f64; 3]>,
}

/// What to do with Coulomb friction.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFile {
    /// Simulate without it.
    Ignore,
    /// F sgn(q̇), set-valued, so that joints stick. The law compensates F tanh(z/ε); no theorem covers what is left.
    Dry(DryFile),
    /// F tanh(q̇/ε), which the theorems cover.
    Smooth(SmoothFile),
}

/// Dry friction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DryFile {
    /// F for all joints or for each, in N m or N. Default: what the URDF states.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub coulomb: Option<At<AxisValues>>,
    /// ε of the law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
    /// The longest period over which the friction of the robot is held, in s. Default: 0.001.
    #[schemars(with = "Option<Positive>")]
    pub period_s: Option<At<f64>>,
}

/// Smooth friction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothFile {
    /// F for all joints or for each, in N m or N. Default: what the URDF states.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub coulomb: Option<At<AxisValues>>,
    /// ε of robot and law, in rad/s or m/s. Default: 0.01.
    pub width: Option<At<AxisValues>>,
}

/// ε, rad/s or m/s.
const WIDTH: f64 = 0.01;
/// The longest period over which dry friction is held, s.
const PERIOD_S: f64 = 1e-3;

impl FrictionFile {
    /// The friction of a robot whose URDF states `stated`.
    fn of(&self, stated: &[f64]) -> Option<JointFriction> {
        let (coulomb, width, dry_s) = match self {
            FrictionFile::Ignore => return None,
            FrictionFile::Dry(DryFile { coulomb, width, period_s }) => {
                (coulomb, width, Some(number_or(period_s, PERIOD_S)))
            }
            FrictionFile::Smooth(SmoothFile { coulomb, width }) => (coulomb, width, None),
        };
        Some(JointFriction { coulomb: each(coulomb, stated), width: each(width, &vec![WIDTH; stated.len()]), dry_s })
    }
}

/// One number for each axis, or the usual ones.
fn each(file: &Option<At<AxisValues>>, usual: &[f64]) -> Vec<f64> {
    file.as_ref().map_or_else(|| usual.to_vec(), |place| place.value.each(usual.len()))
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
        friction: match file.friction {
            Some(FrictionFile::Ignore) => FrictionPolicy::Ignore,
            Some(FrictionFile::Dry(_) | FrictionFile::Smooth(_)) => FrictionPolicy::Read,
            None => usual.friction,
        },
        gravity: file.gravity_m_s2.unwrap_or(usual.gravity),
    };
    match urdf::read_urdf(&source, &options) {
        Ok(read) => {
            let none = vec![0.0; read.coulomb.len()];
            let friction = file.friction.as_ref().and_then(|friction| friction.of(&read.coulomb));
            let drives = JointDrives { armature: each(&file.armature, &none), friction };
            let read = read.with_drives(&drives).map_err(Fault::from)?;
            let links = read.links.into_iter().zip(read.anchors).collect();
            Ok(RobotRead { robot: read.robot, notices: read.notices, body: Body { links, tip: None } })
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
