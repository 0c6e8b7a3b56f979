//! What reading a robot gives.

use std::rc::Rc;

use forwardstep_core::robot::PlanarTip;
use forwardstep_core::robot::tree::Anchor;
use forwardstep_sim::{Axis, AxisUnit, RobotSetup};

use super::ScenarioError;
use super::fault::Fault;
use super::problem::ScenarioProblem;
use crate::urdf::{self, UrdfProblem};
use crate::{InputError, SourceText};

/// A mistake in the scenario, or in a file that it names.
#[derive(Debug)]
pub enum Stop {
    /// In the scenario, or in a table that it names.
    Here(Fault),
    /// In a robot file.
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
            Stop::Here(fault) => ScenarioError::Scenario(Box::new(in_file(fault, source))),
        }
    }
}

/// A mistake with its file, and those beside it.
fn in_file(fault: Fault, scenario: &SourceText) -> InputError<ScenarioProblem> {
    let Fault { problem, span, source, others } = fault;
    let source = source.unwrap_or_else(|| scenario.clone());
    let others = others.into_iter().map(|other| in_file(other, scenario)).collect();
    InputError { source, span, problem: *problem, others }
}

/// A robot, where it can be held, and what its file's reader had to remark.
#[derive(Clone, Debug)]
pub struct RobotRead {
    /// The robot.
    pub robot: RobotSetup,
    /// Where it can be held.
    pub body: Body,
    /// Remarks on a robot file.
    pub notices: Vec<urdf::Notice>,
}

impl RobotRead {
    /// A robot that can be held by its axes only.
    pub fn new(robot: RobotSetup) -> Self {
        RobotRead { robot, body: Body::default(), notices: Vec::new() }
    }
}

/// Where a robot can be held beside its axes.
#[derive(Clone, Debug)]
pub struct Body {
    /// The links of a URDF.
    pub links: Rc<[(String, Anchor)]>,
    /// The tip of a planar arm.
    pub tip: Option<PlanarTip>,
    /// The URDF, which also says what its links look like.
    pub urdf: Option<SourceText>,
}

/// A robot from a URDF: its text, and what holds its links.
#[derive(Clone, Debug)]
pub struct Model {
    /// Under the path that it was read from.
    pub urdf: SourceText,
    /// All links by their names.
    pub links: Vec<(String, Anchor)>,
}

impl Model {
    pub(super) fn of(body: &Body) -> Option<Model> {
        Some(Model { urdf: body.urdf.clone()?, links: body.links.to_vec() })
    }
}

impl Default for Body {
    /// Nowhere.
    fn default() -> Self {
        Body { links: Rc::new([]), tip: None, urdf: None }
    }
}

/// An axis without limits.
pub fn axis(name: &str, unit: AxisUnit) -> Axis {
    Axis::new(name, unit)
}
