//! Complete controllers: reference dynamics and feedback in one vector field, for the systems of Sections IV and V.
//!
//! A robot under (6)–(7) has its reference dynamics in [`crate::reference`] and its tracking law in [`crate::law`], and whole
//! populations are worked on in lanes. Everything else in the paper has a feedback of its own, and often must do without a
//! velocity: it is a [`Controller`].
//!
//! - `attitude`: (97)–(105), a spacecraft without angular velocity measurement.
//! - `joint_tracking`: (6)–(7) behind reference dynamics for tracking, a robot that follows a trajectory.
//! - `linearising`, `immersion`: (33) by feedback linearisation, with χ known or adapted, and by immersion and
//!   invariance; `following` is what they share. `vector_linearising`: the first with several axes and a matrix ψ.
//! - `adaptive_backstepping`: strict-feedback and pure-feedback chains; `steps` is the recursion, `steps_in_series` the same in power series
//!   for high orders, and `recursion` takes the faster one.
//! - `feedback`: any, from closures.
//! - `guide`: where z leads, for plants of any order.
//! - `model_reference`: a point mass by a model and a high gain, without velocity and reference dynamics, beside (a8) and (a9).
//! - `passivity_filter`: a spacecraft by a filter of its attitude error, without reference dynamics, beside Theorem 7.
//! - `position_only`: (a7)–(a9), a point mass without velocity measurement.
//! - `thrust`: (45)–(58), vehicles with one thrust, by angular velocities or by torques; and beside it, by a measured acceleration.
//! - `stepped`: any controller, sampled.
//! - `task_space`: (76)–(82), the tip of a robot with uncertain lengths, without its velocity; and beside it, with a measured one.

mod adaptive_backstepping;
mod attitude;
mod feedback;
mod following;
mod immersion;
mod interior;
mod jets;
mod joint_tracking;
mod linearising;
mod model_reference;
mod passivity_filter;
mod position_only;
mod recursion;
mod reference_model;
mod stepped;
mod steps;
mod steps_in_series;
mod task_space;
mod thrust;
mod vector_linearising;

pub use adaptive_backstepping::{AdaptiveBackstepping, BacksteppingGains, BacksteppingWork};
pub use attitude::{AttitudeMeasured, AttitudeTracking};
pub use feedback::{Feedback, FeedbackInput};
pub use following::{ChainError, ChainMeasured, Following, FollowingWork};
pub use immersion::{Immersion, ImmersionWork};
pub use jets::{Jet, Jets, JetsBuffer};
pub use joint_tracking::{JointTracking, JointTrackingWork, MotionMeasured};
pub use linearising::Linearising;
pub use model_reference::ModelReference;
pub use passivity_filter::PassivityFilter;
pub use position_only::{PositionMeasured, PositionOnly};
pub use reference_model::{ReferenceModel, ReferenceModelError, ReferenceModelInput, ReferenceModelWork};
pub(crate) use stepped::Lengths;
pub use stepped::Stepped;
pub use task_space::{NullSpace, TaskMeasured, TaskMotionMeasured, TaskSpace, TaskSpaceByVelocity};
pub use thrust::{
    AccelerationMeasured, Floor, RateLoop, RotorcraftMeasured, Thrust, ThrustByAcceleration, ThrustCascade,
    ThrustDesign, Yaw,
};
pub use vector_linearising::{VectorLinearising, VectorLinearisingWork};

use alloc::vec::Vec;

use crate::LengthError;
use crate::plant::Plant;
use crate::reference::{Exchange, Heard};
use crate::signal::{Block, Signal};

/// What a controller measures and receives at one instant.
pub struct ControllerInput<'a, C: Controller> {
    /// What it may see of its own plant.
    pub measured: C::Measured<'a>,
    /// What it hears of its neighbours.
    pub heard: Heard<'a, C::Exchange>,
    /// Where it should be, axis by axis: a desired trajectory, or an offset from where the others agree. Empty where there is
    /// none.
    pub target: Jets<'a>,
}

impl<C: Controller> Clone for ControllerInput<'_, C> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<C: Controller> Copy for ControllerInput<'_, C> {}

/// Where a controller puts its results.
#[derive(Debug)]
pub struct ControllerOutput<'a> {
    /// u, as [`Plant::inputs`] has it.
    pub input: &'a mut [f64],
    /// d/dt of the controller's state.
    pub d_state: &'a mut [f64],
    /// What it can tell of itself, as [`Controller::shown`] has it.
    pub shown: &'a mut [f64],
}

/// The plant as it is, which a controller does not know: for the Lyapunov balance, never for the law.
pub struct Truth<'a, P> {
    /// The plant with its true parameters.
    pub plant: &'a P,
    /// Its state.
    pub state: &'a [f64],
    /// What acts on it from outside, as [`Plant::rate`] takes it; empty when nothing ever does.
    pub external: &'a [f64],
}

/// The Lyapunov-like function of a proof and what it loses by it: value + ∫ dissipation is constant along every run, with the
/// power of what acts from outside taken from the dissipation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// V.
    pub value: f64,
    /// −V̇.
    pub dissipation: f64,
}

/// What can go wrong with a controller although all numbers are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Singularity {
    /// A quantity by which the law divides comes too close to zero.
    Vanishes {
        /// What it is.
        signal: Signal,
        /// Its axis.
        axis: usize,
        /// Its value.
        value: f64,
        /// What it must stay away from zero by.
        floor: f64,
    },
}

/// A controller of one agent as a pure vector field: it knows no clock, no network, no allocator, and of its plant only
/// [`Controller::Measured`].
///
/// Behind the check of lengths nothing panics, whatever the numbers.
pub trait Controller: Clone + Send + Sync + 'static {
    /// What it is made for.
    type Plant: Plant;
    /// What agents tell each other; [`crate::reference::Position`] also for those without neighbours.
    type Exchange: Exchange;
    /// What it may see; what is not in it cannot be read.
    type Measured<'a>: Copy;
    /// Working memory of one call.
    type Scratch: Send + Sync;

    /// What it measures, in words, for people: `position`, `attitude`, ….
    const MEASURES: &'static [&'static str];

    /// Whether a target may also be an offset from where all agree.
    const KNOWS_OFFSETS: bool;

    /// Entries of a target that it follows: one for each of the plant's `axes`, unless other coordinates follow.
    fn target_len(&self, axes: usize) -> usize {
        axes
    }

    /// Up to which derivative it reads its target. It is given so many at least, and [`Jets::LEAST`].
    fn target_derivatives(&self) -> usize;

    /// Allocates working memory.
    fn scratch(&self) -> Self::Scratch;

    /// What its state is, block by block.
    fn states(&self) -> Vec<Block>;

    /// What it tells of itself, block by block: references, estimates, errors.
    fn shown(&self) -> Vec<Block>;

    /// Whether `signal` of the plant's output is something that it sees. What is not need not be measured.
    fn reads(&self, signal: Signal) -> bool;

    /// The part of the plant's output that it sees.
    ///
    /// # Errors
    /// [`LengthError`] when `output` is not a whole output.
    fn see<'a>(&self, output: &'a [f64]) -> Result<Self::Measured<'a>, LengthError>;

    /// Its state at the start, from what it sees and hears there. `wanted` holds what a user asks z(0), ż(0), … to be,
    /// each with an entry per axis, as many as are given.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn start(
        &self,
        scratch: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError>;

    /// The input, the rate of the state, and what is shown.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn evaluate(
        &self,
        scratch: &mut Self::Scratch,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError>;

    /// Brings `state` back to its manifold, as [`Plant::settle`] does.
    fn settle(&self, state: &mut [f64]);

    /// What is about to go wrong in this state.
    fn trouble(&self, state: &[f64], shown: &[f64]) -> Option<Singularity>;

    /// V and −V̇ by the proof, of a plant and its controller in continuous time. `shown` is what [`Controller::evaluate`]
    /// left.
    ///
    /// # Errors
    /// [`LengthError`] when a slice has the wrong length.
    fn balance(
        &self,
        scratch: &mut Self::Scratch,
        truth: Truth<'_, Self::Plant>,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError>;
}
