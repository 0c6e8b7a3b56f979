//! Everything that a robot, a law, reference dynamics, a delay and a program of one's own are made of, to be imported at once.
//!
//! `examples/tank.rs` brings a robot and a law with nothing else. The tables of scenario files derive `serde::Deserialize` and
//! `schemars::JsonSchema`, on which a crate that brings kinds depends itself.

pub use std::ops::Range;
pub use std::sync::Arc;

pub use forwardstep_core::LengthError;
pub use forwardstep_core::controller::{
    Balance, Controller, ControllerInput, ControllerOutput, Feedback, FeedbackInput, Singularity, Truth,
};
pub use forwardstep_core::plant::{Plant, VectorField};
pub use forwardstep_core::reference::{
    AxisInput, AxisOutput, PerAxis, Position, PositionVelocity, RootPair, RootSet, polynomial,
};
pub use forwardstep_core::signal::{Entries, OwnSignal, Signal, Unit};
pub use forwardstep_io::scenario::kinds::{
    At, DelayKind, DelayPlan, Fault, InputFolder, KindError, KindTable, Kinds, LawKind, LawReader, LawTable, Mistake,
    NetworkReader, ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable, RobotKind, RobotRead, RobotTable,
    RootsFile, Spread, StartReader, Stop, fault, length, not_negative, positive,
};
pub use forwardstep_sim::delay::{Arrivals, Delay, DelayFunction, DelayPiece, Known as KnownDelay};
pub use forwardstep_sim::quantity::{self, QuantityError};
pub use forwardstep_sim::reference::{
    Dynamics, LinearReference, LinearTerms, ReferenceDynamics, ReferenceFamily, ReferenceInterface, ReferenceWords,
    Roots,
};
pub use forwardstep_sim::system::{Declaration, DeclaredClaim, Known};
pub use forwardstep_sim::{
    ActuatorLimits, AgentSetup, Assembly, Attachments, Axis, AxisUnit, Block, Coordinates, Exchange, Interface,
    LagrangianRobot, Law, LawWords, Line, LineValue, PositionKind, Robot, RobotInterface, RobotSetup, Setup,
    SetupError, Start,
};
