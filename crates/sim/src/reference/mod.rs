//! What leads the agents, as data: a file for each of the shipped reference dynamics, which come through the same door as those
//! of a crate outside.
//!
//! A [`ReferenceDynamics`] says as data what it can do, and builds what runs: a [`forwardstep_core::reference::Reference`] for the
//! agents of one batch. No method has a default body.

mod backstepping;
mod consensus;
mod desired;
mod dispatched;
mod linear;
mod tracking;

pub use backstepping::Backstepping;
pub use consensus::{Consensus, PureIntegral};
pub use desired::{Desired, DesiredPolynomial, Protocol};
pub use linear::{LinearReference, LinearTerms};
pub use tracking::Tracking;

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use forwardstep_core::reference::{Composite, Estimates, Position, PositionVelocity, Reference};

use self::dispatched::Dispatched;
use crate::closed_loop::{Assembly, SetupError};
use crate::setup::{AgentSetup, Exchange, Setup};
use crate::system::Known;

/// Reference dynamics of all agents, as data.
pub trait ReferenceDynamics: Any + Debug + Send + Sync {
    /// What messages call it.
    fn words(&self) -> ReferenceWords;

    /// What it can do. Every feature asks this.
    fn interface(&self) -> ReferenceInterface;

    /// How many of z(0), ż(0), …, or of what filters hold, the start of an agent with so many roots may give.
    fn free_derivatives(&self, roots: usize) -> usize;

    /// What is known of it about the long run.
    fn known(&self) -> Known;

    /// z^(ℓ) of an agent as a linear form, on any axis, with what is exchanged, from which `forwardstep explain` derives; `None` where it is not one, or where
    /// there is no z^(ℓ).
    fn linear(&self, agent: &AgentSetup, exchange: Exchange) -> Option<LinearReference>;

    /// Checks what all agents share.
    ///
    /// # Errors
    /// [`SetupError`] when it has no meaning, or not in this setup.
    fn check(&self, setup: &Setup) -> Result<(), SetupError>;

    /// What runs for the agents of `assembly`, side by side in their order, with what [`Setup::exchange`] says.
    ///
    /// # Errors
    /// [`SetupError`] when an agent's part has no meaning.
    fn dynamics(&self, assembly: &Assembly<'_>) -> Result<Dynamics, SetupError>;
}

impl dyn ReferenceDynamics {
    /// Itself as an `R`, if it is one.
    pub fn downcast<R: ReferenceDynamics>(&self) -> Option<&R> {
        (self as &dyn Any).downcast_ref()
    }

    /// Whether it is an `R`.
    pub fn is<R: ReferenceDynamics>(&self) -> bool {
        self.downcast::<R>().is_some()
    }
}

/// What messages call reference dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferenceWords {
    /// What they are, with an article: *the backstepping baseline*.
    pub name: &'static str,
    /// Their key under `reference` in scenario files.
    pub key: &'static str,
}

/// What reference dynamics can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferenceInterface {
    /// What leads the agents; laws say which they follow.
    pub family: ReferenceFamily,
    /// What agents can exchange for it.
    pub exchanges: &'static [Exchange],
    /// Which agents state roots.
    pub roots: Roots,
    /// Whether λ of Remark 4 has an effect.
    pub manipulability: bool,
    /// Whether what is heard may be a nonlinear function of differences of positions, when only positions are exchanged.
    pub nonlinear_coupling: bool,
}

/// Which agents state roots κ₀, κ₁, ….
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roots {
    /// All of them.
    Every,
    /// Those whose law tracks by roots.
    ByLaw,
    /// None.
    None,
}

/// Reference dynamics by what leads the agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceFamily {
    /// The consensus family (aa10), (a1), (a5), (24).
    Consensus,
    /// (3) and (23).
    PureIntegral,
    /// The baseline (aa6).
    Backstepping,
    /// (110), (119), (122) and swarm tracking.
    Leader,
    /// A target of every agent's own.
    Target,
    /// Desired dynamics that a user writes down, in which agents hear each other.
    Desired,
    /// The same, in which every agent follows a target.
    DesiredTarget,
    /// What agents say to each other, in a way of its own: reference dynamics from outside.
    Own,
}

impl ReferenceFamily {
    /// Whether agents are to reach a target or a leader, and not each other.
    pub fn is_followed(self) -> bool {
        match self {
            ReferenceFamily::Leader | ReferenceFamily::Target | ReferenceFamily::DesiredTarget => true,
            ReferenceFamily::Consensus
            | ReferenceFamily::PureIntegral
            | ReferenceFamily::Backstepping
            | ReferenceFamily::Desired
            | ReferenceFamily::Own => false,
        }
    }

    /// Whether every agent has a target of its own to reach.
    pub fn has_targets(self) -> bool {
        match self {
            ReferenceFamily::Target | ReferenceFamily::DesiredTarget => true,
            ReferenceFamily::Consensus
            | ReferenceFamily::PureIntegral
            | ReferenceFamily::Backstepping
            | ReferenceFamily::Leader
            | ReferenceFamily::Desired
            | ReferenceFamily::Own => false,
        }
    }
}

/// Reference dynamics that run, by what their agents exchange.
#[derive(Clone)]
pub enum Dynamics {
    /// Positions.
    Position(Arc<dyn Reference<Exchange = Position>>),
    /// Positions and velocities.
    PositionVelocity(Arc<dyn Reference<Exchange = PositionVelocity>>),
    /// Where they believe their leader to be, and how fast.
    Estimates(Arc<dyn Reference<Exchange = Estimates>>),
    /// One vector, in which they agree with their leader.
    Composite(Arc<dyn Reference<Exchange = Composite>>),
}

impl Dynamics {
    /// Of agents that exchange positions.
    pub fn position(reference: impl Reference<Exchange = Position>) -> Dynamics {
        Dynamics::Position(Arc::new(Dispatched(reference)))
    }

    /// Of agents that exchange positions and velocities.
    pub fn position_velocity(reference: impl Reference<Exchange = PositionVelocity>) -> Dynamics {
        Dynamics::PositionVelocity(Arc::new(Dispatched(reference)))
    }

    /// Of agents that exchange estimates of their leader.
    pub fn estimates(reference: impl Reference<Exchange = Estimates>) -> Dynamics {
        Dynamics::Estimates(Arc::new(Dispatched(reference)))
    }

    /// Of agents that exchange one vector, in which they agree with their leader.
    pub fn composite(reference: impl Reference<Exchange = Composite>) -> Dynamics {
        Dynamics::Composite(Arc::new(Dispatched(reference)))
    }
}
