//! The shipped kinds of robots and laws, one file each. They come in by the same traits as those of a user's own crate.
//!
//! - `lagrangian`: robots under (6)–(7), a batch at a time; `models`: those that are shipped; `series`: their dynamics with derivatives.
//! - `model_reference`: the same by a model and a high gain, which Remark 7 compares it with.
//! - `position_only`: a point mass without velocity, Remark 7.
//! - `vehicle`, `rotorcraft`: one thrust, Section V-B; `thrust` is the law that they share.
//! - `task_space`: the end-effector of a robot, Theorem 6.
//! - `ship`: a surface ship under (6)–(7).
//! - `spacecraft`: an attitude, Theorem 7.
//! - `chain`: Section IV.

mod chain;
mod lagrangian;
mod model_reference;
mod models;
mod position_only;
mod rotorcraft;
mod series;
mod ship;
mod spacecraft;
mod task_space;
mod thrust;
mod vehicle;

pub use chain::{ChainLaw, ChainModel, ChainStep, Estimate};
pub use lagrangian::{Adaptive, DynamicsAt, Evaluator, Known, LagrangianRobot, ProductsAt, RobotModel};
pub use model_reference::ModelReferenceLaw;
pub use position_only::PositionOnlyLaw;
pub use rotorcraft::RotorcraftModel;
pub use series::{Series, SeriesEvaluator};
pub use spacecraft::{AttitudeLaw, PassivityFilterLaw, SpacecraftModel};
pub use task_space::{TaskSpaceLaw, TipSetup};
pub use thrust::{ThrustKind, ThrustLaw};
pub use vehicle::VehicleModel;
