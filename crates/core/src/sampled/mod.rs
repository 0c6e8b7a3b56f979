//! One controller for every kind of system, as it runs on a processor: without clock, network and, once built, allocator.
//!
//! - `recipe`: a controller as plain data, and how it is built.
//! - `mailbox`: the newest messages of the neighbours, and their weighted sums.
//! - `lagrangian`: (6)–(7) behind [`Sampled`].
//! - `feedback`: any [`crate::controller::Controller`] behind [`Sampled`].
//! - `sensing`: from what is measured to what a law reads.
//! - `safe`: what is commanded when a step fails.
//!
//! A period of an agent has five parts, and somebody else makes the time pass:
//!
//! 1. measure;
//! 2. [`Sampled::message`], which is sent to whoever listens;
//! 3. [`Mailbox::post`] for everything that has arrived, then [`Mailbox::inbox`];
//! 4. [`Sampled::step`];
//! 5. hand [`Sampled::command`] to the actuators, whether the step went well or not.
//!
//! The simulator does the same, with the same controllers: what it records is, bit by bit, what these functions return for
//! the same measurements and messages.

mod feedback;
mod lagrangian;
mod mailbox;
mod recipe;
mod safe;
mod sensing;

pub use mailbox::{Arrival, BeforeFirst, Counts, Keep, Mailbox, MailboxError};
pub use recipe::{Assemble, EncoderFilter, Limits, Motion, Recipe, RecipeError, SafeCommand, StartState, Target};

use crate::agent::{Clipped, Inbox, StepError};
use crate::signal::{Block, Signal};

/// A controller of one agent, stepped at samples; built by [`Recipe::build`].
///
/// **Guarantees**: no allocation and no panic in any method but those that are called while it is built.
///
/// ```
/// use forwardstep_core::agent::Inbox;
/// use forwardstep_core::law::SlotineLi;
/// use forwardstep_core::reference::{Consensus, Position};
/// use forwardstep_core::robot::PointMass;
/// use forwardstep_core::sampled::{Recipe, Sampled};
/// use forwardstep_core::signal::Signal;
/// use forwardstep_core::Gain;
///
/// let reference = Consensus::<Position>::new([(&[1.0, 2.0][..], 0.0)]).expect("two positive roots");
/// let law = SlotineLi { damping: Gain::Number(8.0).resolve(1, &[])?, adaptation: None, bounds: None };
/// let recipe = Recipe::lagrangian(PointMass { dimension: 1 }, reference, law, vec![2.0]);
/// let mut controller: Box<dyn Sampled> = recipe.build()?;
/// assert_eq!(controller.measures(), [(Signal::Position, 1), (Signal::Velocity, 1)]);
/// assert_eq!(controller.inputs(), [(Signal::Torque, 1)]);
///
/// let mut message = [0.0];
/// controller.message(0.0, &[0.3, 0.0], &mut message)?;
/// assert_eq!(message, [0.3]);
/// // One neighbour stands at 1 m and counts 0.5.
/// for k in 0..3 {
///     controller.step(0.001 * f64::from(k), &[0.3, 0.0], Inbox { degree: 0.5, sums: &[0.5] })?;
/// }
/// assert!(controller.command()[0] > 0.0);
/// assert!(controller.diagnostics(Signal::Reference(0)).is_some_and(|z| z[0] > 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Sampled: Send + Sync {
    /// What it measures, block by block; [`Sampled::step`] takes the numbers in this order. Nothing else has to be known of
    /// the plant.
    fn measures(&self) -> &[Block];

    /// What it commands, block by block.
    fn inputs(&self) -> &[Block];

    /// Numbers in a message, its own as well as its neighbours': what is exchanged, a number per axis each, then what is
    /// computed where the design transmits that too.
    fn message_len(&self) -> usize;

    /// The message to be sent at `now_s`, from what is measured then: before [`Sampled::step`] for that sample, or without it.
    ///
    /// # Errors
    /// [`StepError`] for slices of the wrong length and for measurements that are not finite.
    fn message(&self, now_s: f64, measured: &[f64], out: &mut [f64]) -> Result<(), StepError>;

    /// Takes the sample of time `now_s`; then [`Sampled::command`] is what to hold until the next one.
    ///
    /// # Errors
    /// [`StepError`], and then [`Sampled::command`] is the safe one of the recipe. What is wrong with the arguments is found
    /// before anything else has changed.
    fn step(&mut self, now_s: f64, measured: &[f64], inbox: Inbox<'_>) -> Result<(), StepError>;

    /// What the actuators are to hold now: what the last step gave, or the safe command after a failure and before the first
    /// step.
    fn command(&self) -> &[f64];

    /// How many of its commands the limits of the recipe have changed.
    fn clipped(&self) -> Clipped;

    /// What it carries from sample to sample: the reference dynamics, then estimates; see [`StartState::State`].
    fn state(&self) -> &[f64];

    /// A quantity of the last sample: what was measured, references, errors, estimates, the command. `None` for what this
    /// controller does not know.
    fn diagnostics(&self, signal: Signal) -> Option<&[f64]>;
}
