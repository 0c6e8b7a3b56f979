//! A controller as plain data, and how it is built.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use thiserror::Error;

use super::Sampled;
use super::feedback::Feedback;
use super::lagrangian::TrackingLaw;
use crate::LengthError;
use crate::agent::{FilterError, Limiter, LimiterError};
use crate::controller::Controller;
use crate::law::SlotineLi;
use crate::plant::Plant;
use crate::reference::Reference;
use crate::robot::Lagrangian;

/// A controller as plain data: a law for a plant, and how it is used. Everything but the law has a default and may be
/// changed before it is built; building does not use the recipe up.
///
/// ```
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::reference::{Consensus, PositionVelocity};
/// use forwardstep_core::robot::{PlanarArm, PlanarLinks};
/// use forwardstep_core::sampled::{EncoderFilter, Limits, Recipe, RecipeError, SafeCommand, StartState};
/// use forwardstep_core::signal::Signal;
/// use forwardstep_core::Gain;
///
/// let reference = Consensus::<PositionVelocity>::new([(&[1.0, 2.0][..], 0.0)]).expect("two positive roots");
/// let damping = Gain::Number(20.0).resolve(2, &[]).expect("a positive gain");
/// let adaptation = Gain::Number(5.0).resolve(5, &[]).expect("a positive gain");
/// let law = SlotineLi { damping, adaptation: Some(adaptation), bounds: None };
/// let guess = PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]).theta().to_vec();
///
/// let mut recipe = Recipe::lagrangian(PlanarArm, reference, law, guess);
/// recipe.limits = Some(Limits { torque: vec![60.0, 30.0], rate: vec![f64::INFINITY; 2] });
/// recipe.filter = Some(EncoderFilter { cut_off_rad_s: 250.0, period_s: Some(0.002) });
/// recipe.start = StartState::FirstSample { wanted: vec![vec![0.0, 0.0]] };
/// recipe.safe = SafeCommand::Zero;
/// let arm = recipe.build()?;
/// assert_eq!(arm.measures(), [(Signal::Position, 2)]);
/// // Angles, then the velocities made of them.
/// assert_eq!(arm.message_len(), 4);
///
/// recipe.safe = SafeCommand::Values(vec![0.0, 31.0]);
/// assert!(matches!(recipe.build(), Err(RecipeError::Unsafe { axis: 1, .. })));
/// # Ok::<(), RecipeError>(())
/// ```
#[derive(Clone)]
pub struct Recipe {
    law: Arc<dyn Assemble>,
    /// Limits of the inputs that are called [`crate::signal::Signal::Torque`]; none by default.
    pub limits: Option<Limits>,
    /// Velocities come from encoders; by default they are measured.
    pub filter: Option<EncoderFilter>,
    /// Where the agent should be; none by default.
    pub target: Option<Target>,
    /// How the state begins; by default the first sample sets it.
    pub start: StartState,
    /// How many vectors of what it measures a message holds, position first: what the law exchanges, or more; for one that others
    /// follow, who hear more than it does.
    pub transmits: usize,
    /// What is commanded when a step fails; by default the last command.
    pub safe: SafeCommand,
}

/// What can be built into a controller: the law of a recipe.
pub trait Assemble: Send + Sync {
    /// Builds it, used as `recipe` says.
    ///
    /// # Errors
    /// [`RecipeError`] for the first part that does not fit.
    fn assemble(&self, recipe: &Recipe) -> Result<Box<dyn Sampled>, RecipeError>;
}

/// Limits of torques or forces, an entry each; infinity for none.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Largest size, N m or N.
    pub torque: Vec<f64>,
    /// Fastest change, N m/s or N/s.
    pub rate: Vec<f64>,
}

/// Velocities from positions: see [`crate::agent::VelocityFilter`].
#[derive(Clone, Debug, PartialEq)]
pub struct EncoderFilter {
    /// Cut-off ω, rad/s.
    pub cut_off_rad_s: f64,
    /// The period of the samples, s, if they are regular: differences are then taken over a whole number of periods, whatever
    /// the clock says. Otherwise over the time that has passed.
    pub period_s: Option<f64>,
}

/// Something that moves: a function of time.
///
/// ```
/// use forwardstep_core::sampled::Motion;
///
/// /// 0.5 t on every axis.
/// struct Ramp;
/// impl Motion for Ramp {
///     fn axes(&self) -> usize {
///         2
///     }
///     fn known_derivatives(&self) -> usize {
///         usize::MAX
///     }
///     fn derivatives(&self, _: usize, at_s: f64, out: &mut [f64]) {
///         out.fill(0.0);
///         out.iter_mut().zip([0.5 * at_s, 0.5]).for_each(|(out, value)| *out = value);
///     }
/// }
/// let mut jet = [0.0; 3];
/// Ramp.derivatives(0, 4.0, &mut jet);
/// assert_eq!(jet, [2.0, 0.5, 0.0]);
/// ```
pub trait Motion: Send + Sync {
    /// Its axes.
    fn axes(&self) -> usize;

    /// How many derivatives it has, four at least.
    fn known_derivatives(&self) -> usize;

    /// The value of one axis at `at_s` and its first derivatives, as many as `out` has room for, without allocation.
    fn derivatives(&self, axis: usize, at_s: f64, out: &mut [f64]);
}

/// Where an agent should be.
#[derive(Clone)]
pub enum Target {
    /// A desired trajectory.
    Follow(Arc<dyn Motion>),
    /// An offset from where all agree: what is sent is the position without it.
    Offset(Arc<dyn Motion>),
}

impl Target {
    /// What moves.
    pub fn motion(&self) -> &dyn Motion {
        match self {
            Target::Follow(motion) | Target::Offset(motion) => &**motion,
        }
    }
}

/// How the state of a controller begins.
#[derive(Clone, Debug, PartialEq)]
pub enum StartState {
    /// From what is measured and heard at the first sample.
    FirstSample {
        /// z(0), ż(0), …, an entry per axis each, as many as are given; by default z(0) is the velocity, where that is
        /// measured, and its derivatives are zero.
        wanted: Vec<Vec<f64>>,
    },
    /// As [`Sampled::state`] was.
    State(Vec<f64>),
}

/// What is commanded when a step fails, and before the first one.
///
/// ```
/// use forwardstep_core::agent::Inbox;
/// # use forwardstep_core::{Gain, law::SlotineLi, robot::PointMass};
/// # use forwardstep_core::reference::{Consensus, Position};
/// use forwardstep_core::sampled::{Recipe, SafeCommand, Sampled};
/// # let reference = Consensus::<Position>::new([(&[1.0][..], 0.0)]).expect("a positive root");
/// # let law = SlotineLi { damping: Gain::Number(8.0).resolve(1, &[])?, adaptation: None, bounds: None };
///
/// let mut recipe = Recipe::lagrangian(PointMass { dimension: 1 }, reference, law, vec![2.0]);
/// recipe.safe = SafeCommand::Values(vec![-0.5]);
/// let mut controller = recipe.build()?;
/// let inbox = Inbox { degree: 0.0, sums: &[0.0] };
/// controller.step(0.0, &[0.1, 0.0], inbox)?;
/// assert_eq!(controller.command(), [0.0]);
/// // A sensor breaks.
/// let failed = controller.step(0.001, &[f64::NAN, 0.0], inbox);
/// assert!(failed.is_err());
/// assert_eq!(controller.command(), [-0.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum SafeCommand {
    /// The last command; zeros before there is one.
    HoldLast,
    /// Zeros.
    Zero,
    /// These, an entry per input, within the limits.
    Values(Vec<f64>),
}

/// Why a recipe cannot be built.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RecipeError {
    /// Parts that do not fit together.
    #[error(transparent)]
    Length(#[from] LengthError),
    /// Limits that cannot be kept.
    #[error(transparent)]
    Limiter(#[from] LimiterError),
    /// A filter that cannot be built.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A number that must be finite.
    #[error("{what} has the entry {value}, which is not a finite number")]
    NotFinite {
        /// Which one.
        what: &'static str,
        /// The entry.
        value: f64,
    },
    /// A period that is not positive.
    #[error("the period of the encoders is {period_s} s, but it must be positive and finite")]
    Period {
        /// The period, s.
        period_s: f64,
    },
    /// A safe command beyond its limit.
    #[error("the safe command of axis {axis} is {value}, beyond its limit of {limit}; state one within")]
    Unsafe {
        /// The axis among the torques, from zero.
        axis: usize,
        /// The command.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// A target for a law that has no use for it.
    #[error("this law follows no target of its own")]
    NoTarget,
    /// A target with fewer derivatives than the law reads.
    #[error("this law reads {needed} derivatives of its target, which has {known}")]
    Derivatives {
        /// How many it reads.
        needed: usize,
        /// How many there are.
        known: usize,
    },
    /// An offset for a law that knows none.
    #[error("this law knows no offsets from where all agree")]
    NoOffsets,
}

impl Recipe {
    /// Whatever `law` assembles.
    pub fn new(law: Arc<dyn Assemble>) -> Self {
        let start = StartState::FirstSample { wanted: Vec::new() };
        Recipe { law, limits: None, filter: None, target: None, start, transmits: 0, safe: SafeCommand::HoldLast }
    }

    /// A robot under (6)–(7) with `reference` for one agent; `theta_hat` is ϑ̂(0), or ϑ when `law` does not adapt.
    pub fn lagrangian<R, F>(robot: R, reference: F, law: SlotineLi, theta_hat: Vec<f64>) -> Self
    where
        R: Lagrangian<f64> + Clone + Send + Sync + 'static,
        F: Reference + Clone,
    {
        Recipe::new(Arc::new(TrackingLaw { robot, reference, law, theta_hat }))
    }

    /// A controller for systems like `plant`, of which nothing is used but what its inputs and outputs are.
    pub fn feedback<C: Controller>(plant: &C::Plant, controller: C) -> Self {
        Recipe::new(Arc::new(Feedback {
            axes: plant.axes(),
            outputs: plant.outputs(),
            inputs: plant.inputs(),
            controller,
        }))
    }

    /// Builds the controller.
    ///
    /// # Errors
    /// [`RecipeError`] for the first part that does not fit.
    pub fn build(&self) -> Result<Box<dyn Sampled>, RecipeError> {
        if let Some(EncoderFilter { period_s: Some(period_s), .. }) = self.filter
            && !(period_s > 0.0 && period_s.is_finite())
        {
            return Err(RecipeError::Period { period_s });
        }
        match &self.start {
            StartState::State(state) => finite("the state at the start", state)?,
            StartState::FirstSample { wanted } => {
                wanted.iter().try_for_each(|block| finite("the start of the reference", block))?;
            }
        }
        self.law.assemble(self)
    }

    /// The limiter of `torques` inputs, and the safe command for `inputs` inputs of which the torques begin at `first`.
    pub(super) fn limiter(&self, inputs: usize, first: usize, torques: usize) -> Result<Limiter, RecipeError> {
        let limiter = match &self.limits {
            None => Limiter::none(torques),
            Some(Limits { torque, rate }) => {
                LengthError::check("torque limits", torques, torque.len())?;
                Limiter::new(torque.clone(), rate.clone())?
            }
        };
        if let SafeCommand::Values(values) = &self.safe {
            LengthError::check("the safe command", inputs, values.len())?;
            finite("the safe command", values)?;
            let limits = self.limits.iter().flat_map(|limits| &limits.torque);
            for (axis, (limit, value)) in limits.zip(&values[first..first + torques]).enumerate() {
                if value.abs() > *limit {
                    return Err(RecipeError::Unsafe { axis, value: *value, limit: *limit });
                }
            }
        }
        Ok(limiter)
    }
}

/// Checks that all values are numbers.
fn finite(what: &'static str, values: &[f64]) -> Result<(), RecipeError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(RecipeError::NotFinite { what, value: *value }),
        None => Ok(()),
    }
}
