//! The integrator of delay-differential equations with break-points.
//!
//! It knows a right-hand side ([`DelaySystem`]), a [`crate::Network`] and a tolerance; robots and laws are above it.
//!
//! - `tableau`: the Runge–Kutta methods and their continuous extensions, as numbers.
//! - `history`: what was transmitted, as self-contained polynomial pieces.
//! - `system`: the right-hand side, as the integrator sees it.
//! - `timeline`: switches, delay jumps, and the arrival of their images, in order.
//! - `delayed_inputs`: the weighted sums of delayed messages at one instant.
//! - `kernels`: loops over columns.
//! - `integrator`: the stepping itself, and why it ends (`integrator/failure`).
//! - `stiffness`: how fast the fastest motion is.
//! - `forcing`: what enters as a function of time, and how long a step may be that sees it.
//! - `sampled_channel`: what is sent and heard at the samples of digital controllers.

mod delayed_inputs;
mod forcing;
mod history;
mod integrator;
mod kernels;
mod sampled_channel;
mod stiffness;
mod system;
mod tableau;
mod timeline;

pub(crate) use delayed_inputs::{Heard, Port, Refuted};
pub(crate) use forcing::{Forcing, Shape};
pub(crate) use integrator::{Failure, FailureCause, Integrator};
pub(crate) use sampled_channel::SampledChannel;
pub(crate) use system::{DelaySystem, EventOutcome, Step};
pub(crate) use timeline::Passed;
