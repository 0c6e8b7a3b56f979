//! The door through which every kind of system comes: what is asked of a robot and of a law, whoever wrote them.
//!
//! A [`Robot`] is a plant as data, a [`Law`] what controls it. Each says as data what it is and can do, [`RobotInterface`] and
//! [`Interface`]. Features (pushes, targets, offsets, sampling, verdicts, tables) ask these; none of them asks what kind of system
//! it has before it. No method has a default body but those about estimates, which are none, and what an interface does not state, its
//! system cannot do: a feature that asks for it is refused.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use forwardstep_core::controller::Controller;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::Drives;
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::signal::Block as Signals;

use crate::agents::LagrangianRobot;
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::recording::Signal;
use crate::reference::ReferenceFamily;
use crate::setup::{AxisUnit, Exchange, RobotSetup};

/// A plant as data: its geometry, which is known, but not its true parameters, which stand beside it in [`RobotSetup`].
pub trait Robot: Any + Debug + Send + Sync {
    /// What its data mean, with so many axes.
    fn interface(&self, axes: usize) -> RobotInterface;

    /// Itself as a robot with the three properties of Section II-B, if it is one.
    fn lagrangian(&self) -> Option<&dyn LagrangianRobot>;
}

/// What a robot is made of. Every feature asks this.
#[derive(Clone, Debug)]
pub struct RobotInterface {
    /// Numbers of a velocity; zero for a plant that has none.
    pub velocity_len: usize,
    /// Numbers in a start beside q and q̇.
    pub rest_len: usize,
    /// What its position is.
    pub position: PositionKind,
    /// What can act on it from outside, and where.
    pub attachments: Attachments,
    /// What acts at its joints, whose parameters close its ϑ.
    pub drives: Drives,
    /// Whose limits are those of its actuators.
    pub actuator_limits: ActuatorLimits,
    /// Whether its axes have numbers in place of their names.
    pub numbered_axes: bool,
    /// Whether its torques act about the axes of its body, in N m, whatever its axes are.
    pub torques_on_body: bool,
    /// Limits of its own, which are not those of its axes, and other values to compare its signals with.
    pub lines: Vec<Line>,
}

impl RobotInterface {
    /// A mechanical system with a velocity for every axis and an actuator on every axis, whose limits are those of the axes.
    pub fn mechanical(axes: usize) -> Self {
        RobotInterface {
            velocity_len: axes,
            rest_len: 0,
            position: PositionKind::Coordinates,
            attachments: Attachments::Axes,
            drives: Drives::default(),
            actuator_limits: ActuatorLimits::Axes,
            numbered_axes: false,
            torques_on_body: false,
            lines: Vec::new(),
        }
    }
}

/// What the position of a robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PositionKind {
    /// Coordinates of a configuration.
    Coordinates,
    /// A point of space, so that whoever agrees with it has positions in m.
    Point,
    /// A unit quaternion, vector part first. A target may have any length but zero, and q and −q are the same position.
    UnitQuaternion,
}

impl dyn Robot {
    /// Itself as an `R`, if it is one.
    pub fn downcast<R: Robot>(&self) -> Option<&R> {
        (self as &dyn Any).downcast_ref()
    }

    /// Whether it is an `R`.
    pub fn is<R: Robot>(&self) -> bool {
        self.downcast::<R>().is_some()
    }
}

/// A value to compare a signal with: reports draw it, and limits are watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The signal.
    pub signal: Signal,
    /// Its entry.
    pub entry: usize,
    /// The value.
    pub value: LineValue,
}

/// What a value says of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LineValue {
    /// Its magnitude must not exceed this.
    Limit(f64),
    /// The same of an input, which is clipped at this where limits are enforced.
    Clip(f64),
    /// It must not fall below this.
    Floor(f64),
    /// It estimates this.
    Truth(f64),
}

/// What can act on a robot from outside, and where.
#[derive(Clone, Debug)]
pub enum Attachments {
    /// On its axes only.
    Axes,
    /// On its axes, and on the end of its second link.
    PlanarTip,
    /// On its axes, and on any point of any link.
    Links(Arc<Tree>),
    /// On its axes, and torques about the axes of its body.
    AxesAndBody,
    /// Torques about the axes of its body only.
    Body,
    /// No force, but a disturbance of each of so many equations.
    Equations(usize),
}

impl Attachments {
    /// What acts on a robot with so many axes, block by block, as [`Plant::rate`](forwardstep_core::plant::Plant::rate) takes it.
    pub fn blocks(&self, axes: usize) -> Vec<Signals> {
        let (forces, torques) = ((Signal::External, axes), (Signal::ExternalTorque, 3));
        match self {
            Attachments::Axes | Attachments::PlanarTip | Attachments::Links(_) => vec![forces],
            Attachments::AxesAndBody => vec![forces, torques],
            Attachments::Body => vec![torques],
            Attachments::Equations(equations) => vec![(Signal::Disturbance, *equations)],
        }
    }
}

/// Whose limits are enforced where limits are to be enforced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActuatorLimits {
    /// The effort limits of its axes, every one of which must have one.
    Axes,
    /// Its own, which are part of the robot: those of reaction wheels.
    Own,
    /// It has none.
    None,
}

/// The law of one agent, as data.
pub trait Law: Any + Debug + Send + Sync {
    /// What messages call it.
    fn words(&self) -> LawWords;

    /// What it can do beside `robot`; `None` when it is made for another kind.
    fn interface(&self, robot: &RobotSetup) -> Option<Interface>;

    /// What is known of it about the long run.
    fn known(&self) -> Known;

    /// Bounds that its estimate of the robot's parameters is kept within. Default: none.
    fn kept_within(&self) -> Option<ParameterBounds> {
        None
    }

    /// The same law with an estimate that starts at these parameters of its robot, and everything else that it estimates of `robot` right; nothing
    /// where it estimates none. Default: none.
    fn with_estimate(&self, _theta: &[f64], _robot: &RobotSetup) -> Option<Arc<dyn Law>> {
        None
    }

    /// Checks what only this law can check, and builds the agents of `assembly`, which share a batch.
    ///
    /// # Errors
    /// [`SetupError`] when the law or its robot has no meaning, or one does not go with the other.
    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError>;
}

/// What messages call a law: *the law for a level is made for tanks*.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawWords {
    /// Its name, with an article.
    pub name: &'static str,
    /// The robots that it is made for.
    pub made_for: &'static str,
}

impl dyn Law {
    /// Whether both are laws of one type, whatever their gains.
    pub fn same_type(&self, other: &dyn Law) -> bool {
        self.type_id() == other.type_id()
    }

    /// Itself as an `L`, if it is one.
    pub fn downcast<L: Law>(&self) -> Option<&L> {
        (self as &dyn Any).downcast_ref()
    }

    /// Whether it is an `L`.
    pub fn is<L: Law>(&self) -> bool {
        self.downcast::<L>().is_some()
    }
}

/// What a law can do beside a robot. Every feature asks this; what it says no to is refused with the reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// What it measures, in words: `position`, `velocity`, …. It cannot read anything else.
    pub measures: &'static [&'static str],
    /// What it can transmit and hear.
    pub exchanges: &'static [Exchange],
    /// Which reference dynamics lead it.
    pub follows: &'static [ReferenceFamily],
    /// Whether it measures a velocity that a sensor gives, or a filter of positions.
    pub measures_velocity: bool,
    /// Whether λ of its reference dynamics has an effect beside it.
    pub manipulability: bool,
    /// Whether it follows a target by reference dynamics that the agent's roots state.
    pub tracks_by_roots: bool,
    /// Whether a target may be an offset from where all agree.
    pub offsets: bool,
    /// Whether pushes may act on its robot: its balance has their power.
    pub pushed: bool,
    /// Whether it estimates parameters of its robot.
    pub estimates: bool,
    /// Whether agents under laws of this type whose robots have the same kernel and whose references have the same order are
    /// built side by side, as one batch.
    pub in_batches: bool,
    /// What follows a target, where that is something else than the axes of the robot.
    pub coordinates: Option<Coordinates>,
    /// Lengths of what else of the law's own state a start may give, after as many of z(0), ż(0), … as its reference dynamics have.
    pub further_starts: &'static [usize],
    /// Where what the plant has beside the robot starts: actuators with states of their own, behind those of the robot.
    pub actuator_start: Vec<f64>,
    /// Values to compare its signals with.
    pub lines: Vec<Line>,
}

impl Interface {
    /// A law that follows a target of its own, exchanges positions, if anything, and has no further feature.
    pub fn tracking(measures: &'static [&'static str]) -> Self {
        Interface {
            measures,
            exchanges: &[Exchange::Position],
            follows: &[ReferenceFamily::Target],
            measures_velocity: false,
            manipulability: false,
            tracks_by_roots: false,
            offsets: false,
            pushed: false,
            estimates: false,
            in_batches: false,
            coordinates: None,
            further_starts: &[],
            actuator_start: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// The same for a controller, with offsets if it knows them.
    pub fn of<C: Controller>() -> Self {
        Interface { offsets: C::KNOWS_OFFSETS, ..Interface::tracking(C::MEASURES) }
    }
}

/// What is known of a law about the long run.
#[derive(Clone, Debug, PartialEq)]
pub enum Known {
    /// `forwardstep_check` has a file of its own for it.
    Checked,
    /// What its author says of it. It is reported as declared, never as shown.
    Declared(Declaration),
}

/// What the author of a law says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Declaration {
    /// Where it is proved, or that it is not: a paper, a page, `no proof`.
    pub source: String,
    /// What happens in the long run.
    pub promises: String,
    /// What the proof asks for, one sentence each, and why it should be so.
    pub claims: Vec<DeclaredClaim>,
}

/// One hypothesis that the author of a law answers for.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredClaim {
    /// What is required.
    pub requires: String,
    /// Why it is so.
    pub because: String,
}

/// Coordinates that follow a target in the place of the axes of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordinates {
    /// What each is called.
    pub names: Vec<String>,
    /// The unit of each.
    pub units: Vec<AxisUnit>,
    /// Where the four entries of a quaternion begin among them, if there is one.
    pub quaternion: Option<usize>,
    /// What each of their uncertain parameters is called.
    pub parameters: Vec<String>,
}
