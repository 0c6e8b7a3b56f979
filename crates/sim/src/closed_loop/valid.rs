//! What makes a setup meaningless.

use forwardstep_core::agent::{FilterError, LimiterError};
use forwardstep_core::controller::ChainError;
use forwardstep_core::plant::SpacecraftError;
use forwardstep_core::reference::{BacksteppingError, Choice, RootsError};
use forwardstep_core::robot::tree::TipError;
use forwardstep_core::sampled::RecipeError;
use forwardstep_core::{GainError, LengthError};
use thiserror::Error;

use super::unused;
use crate::agents::Adaptive;
use crate::engine::{Integrator, Radio};
use crate::leader::{Following, FollowingDesign};
use crate::network::NetworkError;
use crate::push::PushError;
use crate::setup::{AgentSetup, AxisUnit, Control, Exchange, Method, ReferenceKind, Setup};
use crate::system::ReferenceFamily;
use crate::trajectory::TrajectoryError;

/// Why a setup cannot be simulated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetupError {
    /// The network has no meaning.
    #[error("network: {0}")]
    Network(#[from] NetworkError),
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
    /// A vector of one agent has the wrong length.
    #[error("agent `{agent}`: {error}")]
    Length {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: LengthError,
    },
    /// Another number of roots than the law takes.
    #[error("agent `{agent}`: {error}")]
    RootCount {
        /// The agent.
        agent: String,
        /// How many there are, and how many there must be.
        error: LengthError,
    },
    /// Limits for axes where the robot has another number of torques.
    #[error("agent `{agent}`: {error}")]
    TorqueLimitCount {
        /// The agent.
        agent: String,
        /// Limits of rates, not of torques.
        of_rates: bool,
        /// How many there are, and how many there must be.
        error: LengthError,
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
    /// A number of one agent is not finite.
    #[error("agent `{agent}`: {what} has the entry {value}, which is not a finite number")]
    NotFinite {
        /// The agent.
        agent: String,
        /// Which vector.
        what: &'static str,
        /// The value.
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
    #[error("the backstepping baseline exchanges positions only")]
    BacksteppingExchange,
    /// A gain of one agent.
    #[error("agent `{agent}`: {gain}: {error}")]
    Gain {
        /// The agent.
        agent: String,
        /// `K` or `Γ`.
        gain: &'static str,
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
    /// Limits are to be enforced, but an axis has none.
    #[error("agent `{agent}`: limits are to be enforced, but axis `{axis}` has no effort limit")]
    NoEffortLimit {
        /// The agent.
        agent: String,
        /// The axis.
        axis: String,
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
    #[error("agents that follow targets of their own hear nobody, but the network has edges ({edges} in all)")]
    NobodyHears {
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
    #[error("agent `{agent}`: pushes act on robots under the adaptive or the known law, not on {law}")]
    NotPushed {
        /// The agent.
        agent: String,
        /// Its law, in words.
        law: &'static str,
    },
    /// Somebody talks to the leader.
    #[error("`{leader}` leads and hears nobody, but an edge leads to it; leave that edge out")]
    LeaderHears {
        /// The leader.
        leader: String,
    },
    /// Following a leader takes velocities.
    #[error("following a leader exchanges positions and velocities")]
    FollowingExchange,
    /// q̈ or ż would have to be remembered.
    #[error(
        "a link has a delay of up to {delay_s} s, but accelerations are transmitted at once in continuous time; take the \
         design that exchanges positions and velocities only, no delay, or sampled control"
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
    /// Bounds of kinematic parameters beside a full matrix Λ.
    #[error("agent `{agent}`: bounds of kinematic parameters need Λ to be a number or a diagonal, not a matrix")]
    ProjectionOfMatrix {
        /// The agent.
        agent: String,
    },
    /// A number of a law that makes no sense.
    #[error("agent `{agent}`: {what} is {value}, but {requirement}")]
    LawNumber {
        /// The agent.
        agent: String,
        /// Which number.
        what: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
    /// Bounds of kinematic parameters that are not adapted.
    #[error("agent `{agent}`: bounds of kinematic parameters have no effect where these are not adapted")]
    BoundsOfKnown {
        /// The agent.
        agent: String,
    },
    /// A torque limit of one agent.
    #[error("agent `{agent}`: {error}")]
    Limiter {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: LimiterError,
    },
    /// What a sensor of velocities would do, where it has no part in anything.
    #[error(
        "{} is {value}, but {}", .quantity.words(),
        if *.filtered { "velocities come from filtered differences of positions" } else { "no law measures velocities" }
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
    /// A number of the digital control that makes no sense.
    #[error("{what} is {value}, but {requirement}")]
    Control {
        /// What it is.
        what: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
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
    /// A time, tolerance or step that is not positive.
    #[error("{what} is {value}, but must be positive and finite")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// The value.
        value: f64,
    },
}

impl SetupError {
    /// The reference dynamics of `setup` do not lead the law of `agent`.
    pub(crate) fn wrong_reference(setup: &Setup, agent: &AgentSetup) -> Self {
        let (name, law) = (agent.name.clone(), agent.law.words());
        let only_tracks = agent.interface().is_some_and(|interface| interface.follows == [ReferenceFamily::Target]);
        match setup.reference {
            ReferenceKind::Tracking => SetupError::NotTracking { agent: name, law },
            _ if only_tracks => SetupError::OnlyTracks { agent: name, law },
            _ => SetupError::ReferenceOfLaw { agent: name, law },
        }
    }
}

/// What is said of a sensor of velocities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityQuantity {
    /// [`crate::Sensors::velocity_noise`].
    Noise,
    /// [`crate::Sensors::velocity_quantum`].
    Step,
    /// [`crate::VelocitySensor::Filtered`].
    CutOff,
}

impl VelocityQuantity {
    /// What it is called in messages.
    pub fn words(self) -> &'static str {
        match self {
            VelocityQuantity::Noise => "the noise of velocities",
            VelocityQuantity::Step => "the step of velocities",
            VelocityQuantity::CutOff => "the cut-off of the filter of velocities",
        }
    }
}

/// Samples that a run may have.
const MOST_SAMPLES: f64 = 1e7;

/// Everything that does not need a robot's kernels.
///
/// # Errors
/// [`SetupError`] when the setup has no meaning.
pub fn validate(setup: &Setup) -> Result<(), SetupError> {
    setup.network.validate()?;
    let leaders = usize::from(setup.following().is_some());
    if setup.network.agents != setup.agents.len() + leaders {
        let agents = setup.agents.len() + leaders;
        return Err(SetupError::AgentCount { network: setup.network.agents, agents });
    }
    let positive = |what, value: f64| {
        if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SetupError::NotPositive { what, value }) }
    };
    positive("the horizon", setup.time.end_s)?;
    positive("the recording interval", setup.time.record_every_s)?;
    positive("the smallest step", setup.solver.min_step_s)?;
    setup.solver.max_step_s.map_or(Ok(()), |step| positive("the largest step", step))?;
    match setup.solver.method {
        Method::Adaptive { rtol, atol } => {
            positive("the relative tolerance", rtol)?;
            positive("the absolute tolerance", atol)?;
        }
        Method::Fixed { step_s } => positive("the step", step_s)?,
    }
    setup.control.as_ref().map_or(Ok(()), |control| check_control(control, setup))?;
    check_memory(setup)?;
    let goes = setup.reference == ReferenceKind::Consensus && setup.exchange == Exchange::Position;
    if !setup.network.coupling.is_linear() && !goes {
        return Err(SetupError::Coupling);
    }
    if matches!(setup.reference, ReferenceKind::Backstepping { .. }) && setup.exchange != Exchange::Position {
        return Err(SetupError::BacksteppingExchange);
    }
    if let Some(following) = setup.following() {
        check_following(following, setup)?;
    }
    setup.agents.iter().try_for_each(|agent| check_agent(setup, agent))?;
    unused::of_setup(setup)?;
    same_space(setup)
}

/// More of z(0), ż(0), … than there may be.
pub(super) fn too_many(agent: &AgentSetup, need: usize, got: usize) -> SetupError {
    let error = LengthError { what: "the start of the reference", need, got };
    SetupError::StartOfReference { agent: agent.name.clone(), error }
}

/// Whoever agrees with a vehicle has a position in m. (An arm and a cart may agree on a number.)
fn same_space(setup: &Setup) -> Result<(), SetupError> {
    let moves = |agent: &&AgentSetup| agent.robot.kind.moves_in_space();
    let Some(vehicle) = setup.agents.iter().find(moves) else { return Ok(()) };
    for agent in &setup.agents {
        if let Some(axis) = agent.robot.axes.iter().find(|axis| axis.unit != AxisUnit::Metre) {
            let (vehicle, agent) = (vehicle.name.clone(), agent.name.clone());
            return Err(SetupError::UnitsDiffer { vehicle, agent, axis: axis.name.clone() });
        }
    }
    Ok(())
}

/// What following a leader needs.
fn check_following(following: &Following, setup: &Setup) -> Result<(), SetupError> {
    let positive = |what, value: f64| {
        if value > 0.0 && value.is_finite() { Ok(()) } else { Err(SetupError::NotPositive { what, value }) }
    };
    positive("α", following.alpha)?;
    positive("γ", following.gain)?;
    if following.design != FollowingDesign::Continuous {
        positive("β", following.beta)?;
    }
    if let FollowingDesign::Swarm { coupling } = following.design {
        positive("the coupling k", coupling)?;
    }
    match following.choice {
        Choice::Layer { width } => positive("the width of the boundary layer", width)?,
        Choice::Implicit | Choice::Explicit if setup.control.is_none() => {
            positive("the period of the sign", following.period_s)?;
            let settings = setup.time.end_s / following.period_s;
            if settings > MOST_SAMPLES {
                let what = "the number of times that the sign is set";
                return Err(SetupError::Control { what, value: settings, requirement: "must not exceed 1e7" });
            }
        }
        _ => {}
    }
    if setup.exchange != Exchange::PositionVelocity {
        return Err(SetupError::FollowingExchange);
    }
    let (leader, axes) = (&following.leader, setup.agents.first().map_or(0, |agent| agent.robot.axes.len()));
    LengthError::check("the leader's trajectory", axes, leader.trajectory.axes())
        .map_err(|error| SetupError::Length { agent: leader.name.clone(), error })?;
    let told = following.sliding().told() > 0 && setup.control.is_none();
    for edge in setup.network.schedule.graphs().into_iter().flatten() {
        if edge.to == setup.agents.len() {
            return Err(SetupError::LeaderHears { leader: leader.name.clone() });
        }
        let delay_s = setup.network.delays.get(edge.delay).map_or(0.0, |delay| delay.max_s());
        if told && delay_s > 0.0 {
            return Err(SetupError::DelayedDerived { delay_s });
        }
    }
    Ok(())
}

/// The numbers in a message. What is computed is sent by sampled controllers; in continuous time it is looked up.
pub(super) fn message_len(setup: &Setup) -> usize {
    let axes = setup.agents.first().map_or(0, |agent| agent.robot.axes.len());
    let computed = if setup.control.is_some() { setup.following().map_or(0, |f| f.sliding().told()) } else { 0 };
    (setup.exchange.words().len() + computed) * axes
}

/// Samples are kept as long as any delay from the start on; pieces of history need room for the first at least.
fn check_memory(setup: &Setup) -> Result<(), SetupError> {
    let numbers = setup.network.agents.saturating_mul(message_len(setup));
    let need_bytes = match &setup.control {
        Some(control) => Radio::bytes(&setup.network, setup.time.end_s, control.sample_hz, numbers),
        None => Integrator::least_bytes(numbers),
    };
    let budget_bytes = setup.solver.memory_budget_bytes;
    if need_bytes > budget_bytes { Err(SetupError::Memory { need_bytes, budget_bytes }) } else { Ok(()) }
}

fn check_control(control: &Control, setup: &Setup) -> Result<(), SetupError> {
    let wrong = |what, value, requirement| Err(SetupError::Control { what, value, requirement });
    let Control { sample_hz, computation_delay_s, sensors, actuators } = control;
    if !(*sample_hz > 0.0 && sample_hz.is_finite()) {
        return wrong("the sample rate", *sample_hz, "must be positive and finite");
    }
    if setup.time.end_s * sample_hz > MOST_SAMPLES {
        return wrong("the number of samples", setup.time.end_s * sample_hz, "must not exceed 1e7");
    }
    if !(*computation_delay_s >= 0.0 && *computation_delay_s <= 1.0 / sample_hz) {
        return wrong("the computation delay", *computation_delay_s, "must be from 0 to one period");
    }
    for (what, value) in [
        ("the noise of positions", sensors.position_noise),
        ("the noise of velocities", sensors.velocity_noise),
        ("the step of positions", sensors.position_quantum),
        ("the step of velocities", sensors.velocity_quantum),
        ("the step of torques", actuators.torque_quantum),
    ] {
        if !(value >= 0.0 && value.is_finite()) {
            return wrong(what, value, "must be finite and not negative");
        }
    }
    Ok(())
}

fn check_agent(setup: &Setup, agent: &AgentSetup) -> Result<(), SetupError> {
    let first = &setup.agents[0];
    let (axes, vectors) = (first.robot.axes.len(), setup.reference.free_derivatives(agent));
    if agent.robot.axes.len() != axes {
        return Err(SetupError::AxesDiffer {
            agent: agent.name.clone(),
            axes: agent.robot.axes.len(),
            first: first.name.clone(),
            first_axes: axes,
        });
    }
    let vector = |what: &'static str, need: usize, values: &[f64]| {
        LengthError::check(what, need, values.len())
            .map_err(|error| SetupError::Length { agent: agent.name.clone(), error })?;
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(SetupError::NotFinite { agent: agent.name.clone(), what, value: *value }),
            None => Ok(()),
        }
    };
    vector("the start position", axes, &agent.start.q)?;
    let velocities = agent.robot.velocity_len();
    vector("the start velocity", velocities, &agent.start.dq)?;
    // How much more a state has is known where the plant is built.
    vector("the start of the plant", agent.start.rest.len(), &agent.start.rest)?;
    goes_together(setup, agent)?;
    // The second state of a chain may be no velocity, but it has a z.
    let leads = if velocities == 0 { axes } else { velocities };
    for z in &agent.start.reference {
        vector("the start of the reference", leads, z)?;
    }
    if agent.start.reference.len() > vectors {
        let (need, got) = (vectors, agent.start.reference.len());
        return Err(too_many(agent, need, got));
    }
    vector("theta", agent.robot.theta.len(), &agent.robot.theta)?;
    if let Some(Adaptive { estimate_start, .. }) = agent.law.downcast() {
        vector("the start of the estimate", agent.robot.theta.len(), estimate_start)?;
    }
    for (k, push) in agent.pushes.iter().enumerate() {
        let problem = |error| SetupError::Push { agent: agent.name.clone(), push: k + 1, error };
        push.check(&agent.robot).map_err(problem)?;
    }
    Ok(())
}

/// Whether the law goes with the robot, the reference dynamics, what is exchanged and what acts on the agent.
fn goes_together(setup: &Setup, agent: &AgentSetup) -> Result<(), SetupError> {
    let (name, law) = (|| agent.name.clone(), agent.law.words());
    let Some(interface) = agent.interface() else {
        return Err(SetupError::LawOfAnother { agent: name(), law, made_for: agent.law.made_for() });
    };
    let tracks = setup.reference == ReferenceKind::Tracking;
    if !interface.follows.contains(&setup.reference.family()) {
        return Err(SetupError::wrong_reference(setup, agent));
    }
    if !interface.exchanges.contains(&setup.exchange) {
        return Err(SetupError::SendsPositionOnly { agent: name(), law });
    }
    if !interface.pushed && !agent.pushes.is_empty() {
        return Err(SetupError::NotPushed { agent: name(), law });
    }
    match (&agent.target, tracks) {
        (None, true) => Err(SetupError::NoTarget { agent: name() }),
        (Some(_), false) if !interface.offsets => Err(SetupError::NoOffsets { agent: name(), law }),
        _ => unused::of_agent(setup, agent, &interface),
    }
}
