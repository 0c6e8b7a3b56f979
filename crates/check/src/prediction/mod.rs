//! What can be said of a run before any robot is simulated: the course of agreement, from the reference dynamics alone.
//!
//! Everything here is about robots that follow their reference exactly, *s ≡ 0*. Then q̇ = z, the torques and the robots play
//! no part, and what remains is a network of integrator chains: [`ideal`] writes it as a setup. What is found of it is a prediction for the
//! run of the robots, exact where ϑ is known and z(0) = q̇(0), and otherwise off by what s does.
//!
//! - `ideal`: the setup in which everybody follows exactly.
//! - `cascade`: the cascaded variables ψ of the proofs of Theorems 2 and 3, whose spread does not grow.
//! - `course`: the disagreement over time and the value agreed upon.
//! - `guaranteed`: how much of a spread is left when, for certain.
//! - `period`: the rate of agreement over a network that repeats itself.
//! - `repeats`: whether the network repeats itself exactly, and after how long.
//! - `roots`: the rate of agreement over a fixed graph with constant delays.
//! - `settled`: when a disagreement has settled.
//! - `torque`: peak torques along the reference.

mod cascade;
mod course;
pub mod guaranteed;
mod ideal;
mod period;
mod repeats;
pub(crate) mod roots;
mod settled;
mod torque;
mod unfinished;

pub use cascade::{CascadeSpread, NoCascade};
pub use course::{COURSE_WORK, Course, NoCourse, StartError, course, course_within};
pub(crate) use course::{disagreement, reference_alone, reference_behind, reference_closely};
pub use guaranteed::{ClassBound, Fall, GuaranteedRate, NoGuaranteedRate, Repeat, guaranteed_rate};
pub use ideal::{NoIdeal, ideal, told_before};
pub(crate) use ideal::{family_start, order};
pub use period::{NoPeriodRate, PeriodRate, period_rate, period_rate_within};
pub use repeats::NoRepeat;
pub(crate) use repeats::Repeats;
pub use roots::{NoRate, Rate, rate};
pub use settled::{SHARE, Settled, only_passes, settled};
pub use torque::PeakTorque;
pub use unfinished::Unfinished;
pub(crate) use unfinished::trial;
