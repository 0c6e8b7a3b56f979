//! Robots, reference dynamics, laws and network joined into one delay-differential equation.
//!
//! - `robot_batch`: robots with their tracking laws, several at once.
//! - `gain_rates`: how fast the gains of (6)–(7) make a robot.
//! - `columns`: what the closed loop asks of its parts.
//! - `population`: agents of one kind, side by side in columns: reference dynamics, then the robots.
//! - `asked`: what their reference dynamics ask for.
//! - `solo`: one agent by itself: any plant under any controller; `pair`: what it asks of both.
//! - `sampler`: sampled controllers with their sensors and actuators.
//! - `sampling`: the instants at which they sample and act.
//! - `pushes`: what acts on the robots from outside.
//! - `recipes`: from agents to the recipes of their sampled controllers.
//! - `references`: from reference dynamics as data to those that run.
//! - `probe`, `probe_reference`: what a law and reference dynamics say of themselves, tried.
//! - `guide`: the leader; `driven`: an agent that leads.
//! - `sliding`: who sets the set-valued signs in continuous time.
//! - `members`: from agents to batches.
//! - `assembly`: what a law builds its agents with.
//! - `unused`: what a setup states and nothing reads.
//! - `error`: what makes a [`crate::Setup`] meaningless; `error_path`: where it stands.
//! - `valid`: finds it.
//! - `assemble`: all populations and what joins them: the right-hand side as a whole, and its events.

mod asked;
mod assemble;
mod assembly;
mod columns;
mod driven;
mod error;
mod error_path;
mod frictions;
mod gain_rates;
mod injected;
mod leader_block;
mod limit_error;
mod members;
mod pair;
mod population;
mod probe;
mod probe_reference;
mod pushes;
mod recipes;
mod references;
mod robot_batch;
mod sampled_map;
mod sampler;
mod sampling;
mod sliding;
mod solo;
mod unused;
mod valid;
mod velocity_quantity;

pub(crate) use assemble::ClosedLoop;
pub use assembly::{Assembly, Block};
pub use error::SetupError;
pub use injected::{Energy, Powers};
pub use limit_error::LimitError;
pub(crate) use members::tracking_law;
pub use probe::{probe_balance, singular_start};
pub use probe_reference::probe_reference;
pub use recipes::{recipe, recipes};
pub use references::reference_dynamics;
pub use sampled_map::{Periods, SampledLoop, sampled_loop};
pub use valid::{check_shape, validate};
pub use velocity_quantity::VelocityQuantity;
