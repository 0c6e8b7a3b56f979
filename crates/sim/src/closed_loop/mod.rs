//! Robots, reference dynamics, laws and network joined into one delay-differential equation.
//!
//! - `fleet`: robots with their tracking laws, several at once.
//! - `population`: agents of one kind, side by side in columns: reference dynamics, then the fleet.
//! - `solo`: one agent by itself: any plant under any controller.
//! - `sampler`: sampled controllers with their sensors and actuators.
//! - `sampling`: the instants at which they sample and act.
//! - `pushes`: what acts on the robots from outside.
//! - `recipes`: from agents to the recipes of their sampled controllers.
//! - `references`: from agents to reference dynamics.
//! - `guide`: the leader.
//! - `sliding`: who sets the set-valued signs in continuous time.
//! - `members`: from agents to populations.
//! - `systems`: from agents to plants and controllers that stand by themselves.
//! - `vehicles`: the same for vehicles with one thrust.
//! - `single`: the same for the robot's tip and the spacecraft of Section V-C.
//! - `valid`: what makes a [`crate::Setup`] meaningless.
//! - `assemble`: all populations and what joins them: the right-hand side as a whole, and its events.

mod assemble;
mod chains;
mod fleet;
mod guide;
mod members;
mod population;
mod pushes;
mod recipes;
mod references;
mod sampler;
mod sampling;
mod single;
mod sliding;
mod solo;
mod systems;
mod valid;
mod vehicles;

pub(crate) use assemble::ClosedLoop;
pub use recipes::{recipe, recipes};
pub use valid::{SetupError, validate};
