//! Chains and the laws for them, as plain data: Section IV.

use std::sync::Arc;

use forwardstep_core::controller::{AdaptiveBackstepping, Controller, Linearising};
use forwardstep_core::expression::Expression;
use forwardstep_core::plant::{CascadeTerms, Formulas, Terms};

/// What a chain is made of; its true θ stands with the robot.
#[derive(Clone, Debug)]
pub enum ChainModel {
    /// (33): the k-th derivative of x is χ + ψ u.
    Derivatives(Arc<Formulas>),
    /// A strict-feedback or pure-feedback chain.
    Cascade(Arc<CascadeTerms>),
}

impl ChainModel {
    /// k or n.
    pub fn order(&self) -> usize {
        match self {
            ChainModel::Derivatives(terms) => terms.order(),
            ChainModel::Cascade(terms) => terms.order(),
        }
    }

    /// Whether the second state is the velocity of the first.
    pub fn has_velocity(&self) -> bool {
        matches!(self, ChainModel::Derivatives(terms) if terms.order() > 1)
    }

    /// States besides the position, and the velocity where there is one.
    pub fn rest_len(&self) -> usize {
        self.order().saturating_sub(1 + usize::from(self.has_velocity()))
    }

    /// Entries of θ.
    pub fn parameters(&self) -> usize {
        match self {
            ChainModel::Derivatives(terms) => terms.parameters(),
            ChainModel::Cascade(terms) => terms.parameters(),
        }
    }

    /// Whether they are the same chain, not only equal ones.
    pub fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (ChainModel::Derivatives(a), ChainModel::Derivatives(b)) => Arc::ptr_eq(a, b),
            (ChainModel::Cascade(a), ChainModel::Cascade(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// A law for a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainLaw {
    /// The second step of Section IV.
    pub step: ChainStep,
    /// The run ends where the factor of the input comes closer to zero.
    pub floor: f64,
}

/// The second step of Section IV.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainStep {
    /// Feedback linearisation of (33) with the true parameters; see [`forwardstep_core::controller::Linearising`].
    Linearising {
        /// k, 1/s.
        gain_per_s: f64,
    },
    /// Adaptation of (33); see [`forwardstep_core::controller::Linearising`].
    Adaptive {
        /// k, 1/s.
        gain_per_s: f64,
        /// How θ̂ is found.
        estimate: Estimate,
    },
    /// Immersion and invariance for (33); see [`forwardstep_core::controller::Immersion`].
    Immersion {
        /// k, 1/s.
        gain_per_s: f64,
        /// How θ̂ is found.
        estimate: Estimate,
        /// Φ with ∂Φ/∂v = φ, v being the highest derivative.
        antiderivatives: Vec<Expression>,
    },
    /// Adaptive backstepping for strict-feedback and pure-feedback chains; see
    /// [`forwardstep_core::controller::AdaptiveBackstepping`].
    Backstepping {
        /// c_1 … c_n, 1/s.
        gains_per_s: Vec<f64>,
        /// How θ̂ is found.
        estimate: Estimate,
    },
}

/// How θ̂ is found.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The diagonal of Γ.
    pub adaptation: Vec<f64>,
    /// θ̂(0); θ̂(0) + β(0) under immersion and invariance.
    pub start: Vec<f64>,
}

impl ChainLaw {
    /// Whether it estimates parameters.
    pub fn estimates(&self) -> bool {
        !matches!(self.step, ChainStep::Linearising { .. })
    }

    /// What it measures, in words.
    pub fn measures(&self) -> &'static [&'static str] {
        match self.step {
            ChainStep::Backstepping { .. } => AdaptiveBackstepping::MEASURES,
            _ => Linearising::<Formulas>::MEASURES,
        }
    }

    /// What it is called in messages.
    pub fn words(&self) -> &'static str {
        match self.step {
            ChainStep::Linearising { .. } => "feedback linearisation",
            ChainStep::Adaptive { .. } => "the adaptive law for chains",
            ChainStep::Immersion { .. } => "immersion and invariance",
            ChainStep::Backstepping { .. } => "adaptive backstepping",
        }
    }

    /// What it is made for, in messages.
    pub fn made_for(&self) -> &'static str {
        match self.step {
            ChainStep::Backstepping { .. } => "strict-feedback and pure-feedback chains",
            _ => "chains of derivatives",
        }
    }
}
