//! Chains of any order and the laws for them: Section IV.

use std::sync::Arc;

use forwardstep_core::controller::{
    AdaptiveBackstepping, BacksteppingGains, ChainError, Following, Immersion, Linearising, ReferenceModel,
    VectorLinearising,
};
use forwardstep_core::expression::Expression;
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::{
    Cascade, CascadeError, CascadeTerms, Chain, Formulas, Terms, VectorChain, VectorFormulas,
};
use forwardstep_core::reference::{Consensus, Position, polynomial};

use super::LagrangianRobot;
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::{each, positive};
use crate::reference::{Desired, ReferenceFamily};
use crate::setup::RobotSetup;
use crate::system::{Attachments, Interface, Known, Law, LawWords, Robot, RobotInterface};

/// What a chain is made of; its true θ stands with the robot.
#[derive(Clone, Debug)]
pub enum ChainModel {
    /// (33): the k-th derivative of x is χ + ψ u.
    Derivatives(Arc<Formulas>),
    /// The same with several axes, whose ψ is a matrix.
    Vector(Arc<VectorFormulas>),
    /// A strict-feedback or pure-feedback chain.
    Cascade(Arc<CascadeTerms>),
}

impl ChainModel {
    /// k or n.
    pub fn order(&self) -> usize {
        match self {
            ChainModel::Derivatives(terms) => terms.order(),
            ChainModel::Vector(terms) => terms.order(),
            ChainModel::Cascade(terms) => terms.order(),
        }
    }

    /// m.
    pub fn axes(&self) -> usize {
        match self {
            ChainModel::Vector(terms) => terms.axes(),
            ChainModel::Derivatives(_) | ChainModel::Cascade(_) => 1,
        }
    }

    /// Whether the second state is the velocity of the first.
    pub fn has_velocity(&self) -> bool {
        match self {
            ChainModel::Derivatives(_) | ChainModel::Vector(_) => self.order() > 1,
            ChainModel::Cascade(_) => false,
        }
    }

    /// Entries of θ.
    pub fn parameters(&self) -> usize {
        match self {
            ChainModel::Derivatives(terms) => terms.parameters(),
            ChainModel::Vector(terms) => terms.parameters(),
            ChainModel::Cascade(terms) => terms.parameters(),
        }
    }
}

impl Robot for ChainModel {
    fn interface(&self, axes: usize) -> RobotInterface {
        // The second state of a chain in feedback form is no velocity.
        RobotInterface {
            velocity_len: if self.has_velocity() { axes } else { 0 },
            rest_len: self.order().saturating_sub(1 + usize::from(self.has_velocity())) * axes,
            // Of a chain of derivatives only the last equation is one that something can be added to.
            attachments: Attachments::Equations(match self {
                ChainModel::Derivatives(_) | ChainModel::Vector(_) => self.axes(),
                ChainModel::Cascade(terms) => terms.order(),
            }),
            numbered_axes: true,
            ..RobotInterface::mechanical(axes)
        }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
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
    /// Bounds that θ̂ is kept within. Their margins count for nothing but under adaptation by the gradient.
    pub bounds: Option<ParameterBounds>,
}

impl ChainLaw {
    /// Every number under the key that it has in a file.
    fn check(&self, assembly: &Assembly<'_>, model: &ChainModel) -> Result<(), SetupError> {
        let (law, p) = (assembly.of_law(), model.parameters());
        positive(law.clone(), "floor", self.floor)?;
        let estimate = match &self.step {
            ChainStep::Linearising { gain_per_s } => return Ok(positive(law, "gain_per_s", *gain_per_s)?),
            ChainStep::Adaptive { gain_per_s, estimate } => {
                positive(law.clone(), "gain_per_s", *gain_per_s)?;
                estimate
            }
            ChainStep::Immersion { gain_per_s, estimate, antiderivatives } => {
                positive(law.clone(), "gain_per_s", *gain_per_s)?;
                assembly.length(law.clone(), "antiderivatives", p, antiderivatives.len())?;
                estimate
            }
            ChainStep::Backstepping { gains_per_s, estimate } => {
                assembly.length(law.clone(), "gains_per_s", model.order(), gains_per_s.len())?;
                each(law.clone(), "gains_per_s", gains_per_s, positive)?;
                estimate
            }
        };
        assembly.length(law.clone(), "adaptation_gain", p, estimate.adaptation.len())?;
        if let Some(bounds) = &estimate.bounds {
            assembly.bounds(bounds, ["lower", "upper", "margin"], p)?;
        }
        each(law, "adaptation_gain", &estimate.adaptation, positive)?;
        assembly.estimate("estimate_start.given", &estimate.start, p)
    }

    /// Whether it estimates parameters.
    pub fn estimates(&self) -> bool {
        self.estimate().is_some()
    }

    /// How it does.
    pub fn estimate(&self) -> Option<&Estimate> {
        match &self.step {
            ChainStep::Linearising { .. } => None,
            ChainStep::Adaptive { estimate, .. }
            | ChainStep::Immersion { estimate, .. }
            | ChainStep::Backstepping { estimate, .. } => Some(estimate),
        }
    }
}

impl Law for ChainLaw {
    fn words(&self) -> LawWords {
        let name = match self.step {
            ChainStep::Linearising { .. } => "feedback linearisation",
            ChainStep::Adaptive { .. } => "the adaptive law for chains",
            ChainStep::Immersion { .. } => "immersion and invariance",
            ChainStep::Backstepping { .. } => "adaptive backstepping",
        };
        let made_for = match self.step {
            ChainStep::Backstepping { .. } => "strict-feedback and pure-feedback chains",
            ChainStep::Linearising { .. } | ChainStep::Adaptive { .. } | ChainStep::Immersion { .. } => {
                "chains of derivatives"
            }
        };
        LawWords { name, made_for }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let interface = match (robot.kind.downcast()?, &self.step) {
            (ChainModel::Cascade(_), ChainStep::Backstepping { .. }) => Interface::of::<AdaptiveBackstepping>(),
            (ChainModel::Derivatives(_), ChainStep::Linearising { .. } | ChainStep::Adaptive { .. }) => {
                Interface::of::<Linearising<Formulas>>()
            }
            (ChainModel::Vector(_), ChainStep::Linearising { .. } | ChainStep::Adaptive { .. }) => {
                Interface::of::<VectorLinearising>()
            }
            (ChainModel::Derivatives(_), ChainStep::Immersion { .. }) => Interface::of::<Immersion>(),
            (ChainModel::Derivatives(_) | ChainModel::Vector(_) | ChainModel::Cascade(_), _) => return None,
        };
        Some(Interface {
            follows: &[
                ReferenceFamily::Consensus,
                ReferenceFamily::Target,
                ReferenceFamily::Desired,
                ReferenceFamily::DesiredTarget,
            ],
            measures_velocity: robot.velocity_len() > 0,
            tracks_by_roots: true,
            pushed: true,
            estimates: self.estimates(),
            ..interface
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        self.estimate()?.bounds.clone()
    }

    fn with_estimate(&self, theta: &[f64], _: &RobotSetup) -> Option<Arc<dyn Law>> {
        let mut law = self.clone();
        match &mut law.step {
            ChainStep::Linearising { .. } => return None,
            ChainStep::Adaptive { estimate, .. }
            | ChainStep::Immersion { estimate, .. }
            | ChainStep::Backstepping { estimate, .. } => estimate.start = theta.to_vec(),
        }
        Some(Arc::new(law))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let own = assembly.agent();
        let model: &ChainModel = assembly.robot()?;
        let wrong = |error: ChainError| SetupError::Chain { agent: own.name.clone(), error };
        let floor = self.floor;
        self.check(assembly, model)?;
        let guide = guide(assembly)?;
        match (model, &self.step) {
            (ChainModel::Derivatives(terms), ChainStep::Linearising { gain_per_s }) => {
                let following = Following { guide, gain_per_s: *gain_per_s, floor };
                let law =
                    Linearising::new(Formulas::clone(terms), own.robot.theta.clone(), following).map_err(wrong)?;
                assembly.solo(derivatives(assembly, terms), law)
            }
            (ChainModel::Derivatives(terms), ChainStep::Adaptive { gain_per_s, estimate }) => {
                let following = Following { guide, gain_per_s: *gain_per_s, floor };
                let (gamma, start) = (estimate.adaptation.clone(), estimate.start.clone());
                let mut law = Linearising::adaptive(Formulas::clone(terms), following, gamma, start).map_err(wrong)?;
                if let Some(bounds) = &estimate.bounds {
                    law = law.bounded(bounds.clone()).map_err(wrong)?;
                }
                assembly.solo(derivatives(assembly, terms), law)
            }
            (ChainModel::Vector(terms), ChainStep::Linearising { gain_per_s }) => {
                let following = Following { guide, gain_per_s: *gain_per_s, floor };
                let (terms, theta) = (VectorFormulas::clone(terms), own.robot.theta.clone());
                let law = VectorLinearising::new(terms.clone(), theta.clone(), following).map_err(wrong)?;
                assembly.solo(VectorChain { terms, theta }, law)
            }
            (ChainModel::Vector(terms), ChainStep::Adaptive { gain_per_s, estimate }) => {
                let following = Following { guide, gain_per_s: *gain_per_s, floor };
                let (gamma, start) = (estimate.adaptation.clone(), estimate.start.clone());
                let (terms, theta) = (VectorFormulas::clone(terms), own.robot.theta.clone());
                let mut law = VectorLinearising::adaptive(terms.clone(), following, gamma, start).map_err(wrong)?;
                if let Some(bounds) = &estimate.bounds {
                    law = law.bounded(bounds.clone()).map_err(wrong)?;
                }
                assembly.solo(VectorChain { terms, theta }, law)
            }
            (ChainModel::Derivatives(terms), ChainStep::Immersion { gain_per_s, estimate, antiderivatives }) => {
                let following = Following { guide, gain_per_s: *gain_per_s, floor };
                let (gamma, start) = (estimate.adaptation.clone(), estimate.start.clone());
                let mut law =
                    Immersion::new(Formulas::clone(terms), antiderivatives, following, gamma, start).map_err(wrong)?;
                if let Some(bounds) = &estimate.bounds {
                    law = law.bounded(bounds.clone()).map_err(wrong)?;
                }
                assembly.solo(derivatives(assembly, terms), law)
            }
            (ChainModel::Cascade(terms), ChainStep::Backstepping { gains_per_s, estimate }) => {
                let gains_per_s = gains_per_s.clone();
                let gains = BacksteppingGains { gains_per_s, adaptation: estimate.adaptation.clone(), floor };
                let (start, bounds) = (estimate.start.clone(), estimate.bounds.as_ref());
                let law = AdaptiveBackstepping::within(terms, guide, gains, start, bounds).map_err(wrong)?;
                let plant =
                    Cascade::new(terms.as_ref().clone(), own.robot.theta.clone()).map_err(|error| match error {
                        CascadeError::Length(error) => SetupError::Length { agent: own.name.clone(), error },
                        CascadeError::Expression(error) => wrong(ChainError::Expression(error)),
                        CascadeError::Empty | CascadeError::TooMany { .. } | CascadeError::Above { .. } => {
                            assembly.law_of_another()
                        }
                    })?;
                assembly.solo(plant, law)
            }
            (ChainModel::Derivatives(_) | ChainModel::Vector(_) | ChainModel::Cascade(_), _) => {
                Err(assembly.law_of_another())
            }
        }
    }
}

fn derivatives(assembly: &Assembly<'_>, terms: &Formulas) -> Chain<Formulas> {
    Chain { terms: terms.clone(), theta: assembly.agent().robot.theta.clone() }
}

/// Where z leads: to a target, or to agreement.
fn guide(assembly: &Assembly<'_>) -> Result<ReferenceModel, SetupError> {
    let own = assembly.agent();
    let roots = |error| SetupError::Roots { agent: own.name.clone(), error };
    match assembly.reference().interface().family {
        ReferenceFamily::Target => {
            let mut alpha = polynomial(&own.roots_per_s).map_err(roots)?;
            // The leading one is not listed.
            alpha.pop();
            Ok(ReferenceModel::Tracking { alpha })
        }
        ReferenceFamily::Consensus => {
            Ok(ReferenceModel::Consensus(Consensus::<Position>::new([(&own.roots_per_s, 0.0)]).map_err(roots)?))
        }
        ReferenceFamily::Desired | ReferenceFamily::DesiredTarget => {
            assembly.reference().downcast::<Desired>().ok_or_else(|| assembly.wrong_reference())?.guide(own)
        }
        ReferenceFamily::PureIntegral
        | ReferenceFamily::Backstepping
        | ReferenceFamily::Leader
        | ReferenceFamily::Own => Err(assembly.wrong_reference()),
    }
}
