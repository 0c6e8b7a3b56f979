//! What makes a setup meaningless.

use forwardstep_core::agent::FilterError;
use forwardstep_core::controller::ChainError;
use forwardstep_core::plant::SpacecraftError;
use forwardstep_core::reference::{BacksteppingError, DesiredError, RootsError};
use forwardstep_core::robot::tree::TipError;
use forwardstep_core::sampled::RecipeError;
use forwardstep_core::{GainError, LengthError};
use thiserror::Error;

use super::limit_error::LimitError;
use super::velocity_quantity::VelocityQuantity;
use crate::network::NetworkError;
use crate::push::PushError;
use crate::quantity::{Name, Path, QuantityError, about, entries, number};
use crate::setup::Exchange;
use crate::trajectory::TrajectoryError;

/// Why a setup cannot be simulated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetupError {
    /// The network has no meaning.
    #[error("network: {0}")]
    Network(NetworkError),
    /// A target, an offset or a leader that cannot be landed on where it has kinks.
    #[error("`{agent}`: {error}")]
    Trajectory {
        /// Whose it is.
        agent: String,
        /// What is wrong.
        error: TrajectoryError,
    },
    /// The network was made for another number of agents.
    #[error("the network has {network} agents, but {agents} are described")]
    AgentCount {
        /// Vertices of the network.
        network: usize,
        /// Agents described.
        agents: usize,
    },
    /// An agent that there is not.
    #[error("there is no agent {agent}: there are {agents}, counted from zero")]
    NoAgent {
        /// The number asked for.
        agent: usize,
        /// How many there are.
        agents: usize,
    },
    /// Consensus needs all agents in the same space.
    #[error("agent `{agent}` has {axes} axes, but `{first}` has {first_axes}; agents can only agree in the same space")]
    AxesDiffer {
        /// The agent that differs.
        agent: String,
        /// Its number of axes.
        axes: usize,
        /// The first agent.
        first: String,
        /// The first agent's number of axes.
        first_axes: usize,
    },
    /// A robot that cannot move.
    #[error("agent `{agent}` has no axes, so that there is nothing to control")]
    NoAxes {
        /// The agent.
        agent: String,
    },
    /// A vector of one agent has the wrong length.
    #[error("agent `{agent}`: {error}")]
    Length {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: LengthError,
    },
    /// A list of one agent has the wrong length.
    #[error("{} has {}, but `{agent}` needs {need}", Name(.path.name()), entries(*.got))]
    Entries {
        /// The agent.
        agent: String,
        /// Where the list stands.
        path: Path,
        /// How many entries it needs.
        need: usize,
        /// How many there are.
        got: usize,
    },
    /// Another number of roots than the law takes.
    #[error("agent `{agent}`: {error}")]
    RootCount {
        /// The agent.
        agent: String,
        /// How many there are, and how many there must be.
        error: LengthError,
    },
    /// Desired dynamics without meaning.
    #[error("{error}")]
    Desired {
        /// What is wrong.
        error: DesiredError,
    },
    /// Desired dynamics of a lower order than a plant.
    #[error(
        "the desired dynamics are of order {order}, but the plant of agent `{agent}` is of order {least}: they must be of that order or of a \
         higher one"
    )]
    DesiredOrder {
        /// The agent.
        agent: String,
        /// N.
        order: usize,
        /// k.
        least: usize,
    },
    /// A nonlinear protocol by which a robot that is no chain follows a target, and velocities that are heard.
    #[error(
        "agent `{agent}`: a robot that follows its target by a nonlinear protocol hears positions, and no velocities: leave the second \
         entry of `heard` out, or the target"
    )]
    ProtocolHearsVelocities {
        /// The agent.
        agent: String,
    },
    /// A law that takes desired dynamics in what is measured alone.
    #[error(
        "agent `{agent}`: {law} follows a target by desired dynamics that are written in what is measured, not in x or z alone"
    )]
    DesiredVariables {
        /// The agent.
        agent: String,
        /// What its law is called.
        law: &'static str,
    },
    /// Limits of actuators.
    #[error("agent `{agent}`: {error}")]
    Limit {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: LimitError,
    },
    /// A manipulability gain beside a law that has none.
    #[error("agent `{agent}`: {law} has no manipulability gain, but {value} is given")]
    NoManipulability {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
        /// The gain.
        value: f64,
    },
    /// The roots of one agent.
    #[error("agent `{agent}`: {error}")]
    Roots {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: RootsError,
    },
    /// A nonlinear coupling of what it does not suit.
    #[error("a nonlinear coupling goes with consensus by positions only")]
    Coupling,
    /// A target with fewer derivatives than what follows it reads.
    #[error(
        "`{agent}` follows its target by {need} derivatives, one for every root of its reference dynamics, but its target has {known}"
    )]
    TargetDerivatives {
        /// The agent.
        agent: String,
        /// How many it reads.
        need: usize,
        /// How many there are.
        known: usize,
    },
    /// A law for a chain.
    #[error("agent `{agent}`: {error}")]
    Chain {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: ChainError,
    },
    /// The filter of the backstepping baseline.
    #[error(transparent)]
    Backstepping(#[from] BacksteppingError),
    /// The reference dynamics do not go with what is exchanged.
    #[error("{reference} does not go with agents that exchange {}", exchange.words().join(" and "))]
    ReferenceExchange {
        /// Name of the reference dynamics.
        reference: &'static str,
        /// What is exchanged.
        exchange: Exchange,
    },
    /// Reference dynamics from outside that are not made for their agents.
    #[error("{reference}: {error}")]
    ReferenceShape {
        /// Name of the reference dynamics.
        reference: &'static str,
        /// How many there are, and how many there must be.
        error: LengthError,
    },
    /// Reference dynamics from outside with a set-valued sign.
    #[error("{reference} has a set-valued sign, which is settled for followers of a leader only")]
    SignWithoutLeader {
        /// Name of the reference dynamics.
        reference: &'static str,
    },
    /// A gain of one agent.
    #[error("`{}` of `{agent}`: {error}", .path.name())]
    Gain {
        /// The agent.
        agent: String,
        /// Where it stands.
        path: Path,
        /// What is wrong.
        error: GainError,
    },
    /// A push on one agent.
    #[error("agent `{agent}`, push {push}: {error}")]
    Push {
        /// The agent.
        agent: String,
        /// Which of its pushes, from one.
        push: usize,
        /// What is wrong.
        error: PushError,
    },
    /// A law that is made for something else.
    #[error("agent `{agent}`: {law} is made for {made_for}")]
    LawOfAnother {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
        /// What that is made for, in words.
        made_for: &'static str,
    },
    /// A law that has reference dynamics of its own, beside reference dynamics that are another's.
    #[error("agent `{agent}`: {law} does not go with these reference dynamics")]
    ReferenceOfLaw {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// A law that cannot follow a target.
    #[error("agent `{agent}`: {law} does not follow a target of its own; it goes with consensus")]
    NotTracking {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// A law that cannot agree with others.
    #[error("agent `{agent}`: {law} follows a target of its own; it does not agree with others")]
    OnlyTracks {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// More of z(0), ż(0), … than the state of the reference dynamics has.
    #[error("agent `{agent}`: {error}")]
    StartOfReference {
        /// The agent.
        agent: String,
        /// How many there are, and how many there may be.
        error: LengthError,
    },
    /// Edges among agents that do not agree on anything.
    #[error("agents that follow targets of their own hear no other, but the network has edges ({edges} in all)")]
    UnusedEdges {
        /// How many, over all graphs.
        edges: usize,
    },
    /// A reference of too low an order for a law.
    #[error("agent `{agent}`: its reference dynamics have order {order}, but its law needs {least} roots or more")]
    OrderTooLow {
        /// The agent.
        agent: String,
        /// How many roots it has.
        order: usize,
        /// How many it needs.
        least: usize,
    },
    /// A law that transmits positions among agents that exchange more.
    #[error("agent `{agent}`: {law} sends its position only, but the agents exchange positions and velocities")]
    SendsPositionOnly {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// A position in space among positions that are no lengths.
    #[error(
        "agent `{vehicle}` moves in space and exchanges positions in m, but axis `{axis}` of `{agent}` is an angle; they have \
         nothing to agree on"
    )]
    UnitsDiffer {
        /// The agent in space.
        vehicle: String,
        /// The other.
        agent: String,
        /// Its axis.
        axis: String,
    },
    /// A push on an agent whose law does not know any.
    #[error("agent `{agent}`: nothing may push a robot under {law}, which does not say what that does to it")]
    NotPushed {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// An agent that cannot lead.
    #[error("agent `{agent}` cannot lead the others: {why}")]
    CannotLead {
        /// The agent.
        agent: String,
        /// Why not.
        why: &'static str,
    },
    /// Somebody talks to the leader.
    #[error("`{leader}` leads and hears no agent, but an edge leads to it; leave that edge out")]
    LeaderHears {
        /// The leader.
        leader: String,
    },
    /// q̈ or ż would have to be remembered.
    #[error(
        "a link has a delay of up to {delay_s} s, but accelerations are transmitted at once in continuous time; take the \
         design `continuous` or `composite`, no delay, or sampled control"
    )]
    DelayedDerived {
        /// The longest delay of the link, s.
        delay_s: f64,
    },
    /// Nothing to track.
    #[error("agent `{agent}` is to track a target, but has none")]
    NoTarget {
        /// The agent.
        agent: String,
    },
    /// An offset for a law that knows none.
    #[error("agent `{agent}`: {law} knows no offsets")]
    NoOffsets {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// A tip whose Jacobian cannot be inverted.
    #[error("agent `{agent}`: {error}")]
    Tip {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: TipError,
    },
    /// A spacecraft that makes no sense.
    #[error("agent `{agent}`: {error}")]
    Spacecraft {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: SpacecraftError,
    },
    /// Bounds of estimates beside a full matrix Γ or Λ.
    #[error(
        "agent `{agent}`: bounds of what is estimated need the gain of its adaptation to be a number or a diagonal, not a matrix"
    )]
    ProjectionOfMatrix {
        /// The agent.
        agent: String,
    },
    /// A null-space term without redundant joints, or redundant joints without one.
    #[error("agent `{agent}`: {}", if *has {
        "a null-space term is for more joints than coordinates of the end-effector"
    } else {
        "more joints than coordinates of the end-effector need a null-space term"
    })]
    NullSpace {
        /// The agent.
        agent: String,
        /// There is such a term.
        has: bool,
    },
    /// The law with a measured velocity of the tip, for a pose or for joints to spare.
    #[error(
        "agent `{agent}`: with a measured velocity of the end-effector the law is derived for positions of as many coordinates as there are joints"
    )]
    TipVelocity {
        /// The agent.
        agent: String,
    },
    /// Bounds of parameters that are not adapted.
    #[error("agent `{agent}`: bounds of estimates have no effect where these are not adapted: leave them out")]
    BoundsOfKnown {
        /// The agent.
        agent: String,
    },
    /// What a sensor of velocities would do, where it has no part in anything.
    #[error(
        "{} is {value}, but {}", .quantity.words(),
        match (*.filtered, *.quantity) {
            (true, _) => "velocities come from filtered differences of positions",
            (false, VelocityQuantity::TipNoise) => "no law measures the velocity of an end-effector",
            (false, _) => "no law measures velocities",
        }
    )]
    VelocityUnused {
        /// What it is.
        quantity: VelocityQuantity,
        /// The value.
        value: f64,
        /// Whether there are velocities, but from positions.
        filtered: bool,
    },
    /// Anything else that keeps an agent's controller from being built.
    #[error("agent `{agent}`: {error}")]
    Recipe {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: RecipeError,
    },
    /// The filter that gives velocities.
    #[error(transparent)]
    VelocityFilter(FilterError),
    /// Messages that can still be heard take more than the budget before the run has begun.
    #[error(
        "messages that can still be heard take {need_bytes} bytes or more, but the memory budget is {budget_bytes} bytes"
    )]
    Memory {
        /// The least that they take.
        need_bytes: u64,
        /// [`crate::Solver::memory_budget_bytes`].
        budget_bytes: u64,
    },
    /// A recording that would not fit into memory.
    #[error(
        "the recording would hold {} numbers, {} rows of {columns} columns, but at most {} fit",
        about(*.rows * *.columns as f64).typed(), about(*.rows).typed(), number(*.most)
    )]
    RecordingTooLarge {
        /// How many rows.
        rows: f64,
        /// How many columns.
        columns: usize,
        /// How many numbers are accepted.
        most: f64,
        /// The shortest [`crate::TimeSpan::record_every_s`] that would do, where that says how many there are.
        least_s: Option<f64>,
    },
    /// A quantity out of its range.
    #[error("{}: {_0}", _0.path)]
    Quantity(#[from] QuantityError),
}

impl From<NetworkError> for SetupError {
    fn from(error: NetworkError) -> Self {
        match error {
            NetworkError::Quantity(error) => SetupError::Quantity(error),
            error => SetupError::Network(error),
        }
    }
}
