//! Why a run converges, derived from its setup: what z is, the closed loop as a differential cascade, how its degree is reduced, and the
//! averages that are left.
//!
//! - `polynomial`, `form`: the one representation, linear chains with delays; `factors`: (25) by its roots.
//! - `dynamics`: reference dynamics in it; `desired`: those that a user writes down, as 𝒵 and 𝓕 of (43); `lower`: what a law makes of s.
//! - `cascade`: the closed loop and its degree.
//! - `reduction`: new variables that absorb derivatives of s.
//! - `laplacian`, `stacked`: chains of averages; all agents together.
//! - `formula`, `notation`: formulas as trees, and from forms to them.
//! - `residual`: its identities along a run; `quaternion`: how attitudes turn.
//! - `case`: the designs in a setup; `explanation`: what is said of them, made by `explained`, `steps`, `averages`, `attitude`, `task_space`,
//!   `adaptation`, with `places` in the paper and `words`.
//!
//! Nothing is a text that is kept for a theorem: equations are multiplied, divided and substituted as polynomials in p with rational
//! coefficients, for any order and any roots.

mod adaptation;
mod attitude;
mod averages;
pub mod cascade;
pub mod case;
mod composite;
pub mod desired;
pub mod dynamics;
mod explained;
mod explanation;
pub mod factors;
pub mod form;
pub mod formula;
pub mod laplacian;
pub mod lower;
mod model_reference;
pub mod notation;
mod observer;
mod places;
pub mod polynomial;
#[cfg(test)]
mod properties;
mod quaternion;
pub mod reduction;
pub mod residual;
pub mod stacked;
mod steps;
mod task_space;
#[cfg(test)]
mod tests;
mod words;

pub(crate) use desired::polynomial_of;
pub use explanation::{Explained, Explanation, Line, Section, Subject, explain};
pub(crate) use factors::Factors;
