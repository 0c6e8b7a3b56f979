//! Networks of forwardstepping agents: switching digraphs, discontinuous delays, the closed loop as a delay-differential
//! equation, and an integrator whose steps land on every break-point; or, under digital control, held torques between samples.
//!
//! The layers, each of which uses only those before it: [`quantity`], [`formula`], [`trajectory`], [`graph`], [`topology`] and [`schedule`], [`delay`] and
//! [`network`]; [`leader`], [`setup`] and [`push`], the plain data of a run; the integrator with its history and break-points; the closed
//! loop; [`recording`] and [`simulate`].

mod agents;
mod build;
pub mod busy;
mod closed_loop;
pub mod coupling;
pub mod delay;
pub mod drives;
mod engine;
mod forcing;
pub mod formula;
pub mod graph;
mod inside;
mod jumps;
pub mod leader;
mod limit_watch;
mod moment;
pub mod network;
pub mod probe;
pub mod push;
pub mod quantity;
mod ranges;
pub mod recording;
pub mod reference;
mod rows;
mod same;
pub mod schedule;
pub mod setup;
mod simulate;
pub mod system;
pub mod topology;
pub mod trajectory;

pub use agents::{
    Adaptive, AttitudeLaw, ChainLaw, ChainModel, ChainStep, DynamicsAt, Estimate, Evaluator, Known, LagrangianRobot,
    ModelReferenceLaw, PassivityFilterLaw, PositionOnlyLaw, ProductsAt, RobotModel, RotorcraftModel, Series,
    SeriesEvaluator, SpacecraftModel, TaskSpaceLaw, ThrustKind, ThrustLaw, TipSetup, VehicleModel,
};
pub use build::run;
pub use closed_loop::{
    Assembly, Block, Energy, LimitError, Periods, Powers, SampledLoop, SetupError, VelocityQuantity, check_shape,
    recipe, recipes, reference_dynamics, sampled_loop, validate,
};
pub use inside::{Inside, Place, Watch};
pub use jumps::{HeardAt, InputJump, InputOrder, NetworkJump, input_orders};
pub use moment::{Moment, StateRate};
pub use network::Network;
pub use recording::{
    Breakdown, BreakdownCause, ClippedSamples, Column, Drive, Ending, GainRates, Outcome, Progress, Recording,
    SampleTaken, Signal, Statistics, Stiffness,
};
pub use reference::{ReferenceDynamics, ReferenceFamily};
pub use rows::RowSink;
pub use same::Same;
pub use setup::{
    ATOL, Actuators, AgentSetup, Axis, AxisUnit, Control, Exchange, Failures, Method, RECORD_EVERY_S, RTOL, RecordAt,
    RobotSetup, Sensors, Setup, Solver, Start, TimeSpan, VelocitySensor,
};
pub use simulate::{Observers, check_recording, check_setup, recorded_columns, simulate, simulate_with, state_entries};
pub use system::{
    ActuatorLimits, Attachments, Coordinates, Interface, Law, LawWords, Line, LineValue, PositionKind, Robot,
    RobotInterface,
};
