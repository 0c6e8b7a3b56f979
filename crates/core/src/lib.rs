//! Robots, reference dynamics and tracking laws of forwardstepping control.
//!
//! Everything here is a pure function of explicit state: no clock, no network, no file, no allocation but to build a
//! model. Kernels are generic over a [`Scalar`], so that the same source computes one robot in `f64` or `f32`, or several
//! robots of one model side by side in [`Lanes`]. The equations and the letters are those of Wang, Ren and Cheah,
//! *A Differential-Cascaded Paradigm for Control of Nonlinear Systems*; `NOTATION.md` lists them.
//!
//! # Bits
//!
//! Results are the same to the last bit with and without hardware fused multiply-add, and for every vector width:
//! kernels use explicit [`Scalar::mul_add`] and this crate's own sine and cosine, and no sum depends on an order that a
//! thread or a vector could change.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

pub mod agent;
pub mod attitude;
pub mod controller;
mod definite;
mod dispatch;
mod error;
pub mod expression;
mod gain;
pub mod law;
mod linear;
pub mod plant;
pub mod reference;
pub mod robot;
pub mod sampled;
mod scalar;
pub mod signal;
mod taylor;
mod trig;

pub use definite::Indefinite;
pub use dispatch::{Kernel, Vectors, dispatch};
pub use error::{GainError, LengthError};
pub use gain::{Gain, InverseQuadratic, ResolvedGain};
pub use scalar::{Lanes, Packed, Scalar};
pub use taylor::Taylor;
pub use trig::sine_and_cosine;
