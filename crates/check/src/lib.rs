//! What the theorems promise for a given network, with certificates and witnesses, and what can be predicted before a run.
//!
//! Never "proved" outside the theorems: a hypothesis *holds* for all time, holds *on the horizon*, is *not covered by the
//! paper*, or is *violated* with a witness.

mod agreement;
mod chains;
mod hypotheses;
mod laws;
mod leader;
mod links;
mod manipulation;
mod sampled;
mod single;
mod tracking;
mod vehicles;
mod verdict;

pub use agreement::{NoPrediction, Prediction, predict};
pub use hypotheses::check;
pub use sampled::{SampledAdaptation, SampledDamping, sampled_adaptation, sampled_damping};
pub use verdict::{Answer, Hypothesis, Report};
