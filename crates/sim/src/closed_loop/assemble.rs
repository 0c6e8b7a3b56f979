//! From a setup to populations, with everything checked.

use std::ops::Range;
use std::sync::Arc;

use forwardstep_core::agent::{Agent, FilterError, Limiter, LimiterError, VelocityFilter};
use forwardstep_core::law::SlotineLi;
use forwardstep_core::reference::{
    Backstepping, BacksteppingError, Consensus, Exchange as CoreExchange, Position, PositionVelocity, PureIntegral,
    Reference, RootsError,
};
use forwardstep_core::robot::tree::Tree;
use forwardstep_core::robot::{Lagrangian, PlanarArm, PointMass};
use forwardstep_core::{Gain, GainError, InverseQuadratic, Lanes, LengthError, ResolvedGain};
use thiserror::Error;

use super::fleet::Member;
use super::population::{Columns, Inputs, Population};
use super::pushes::Pushes;
use super::sampler::{Sampler, Sensor};
use super::sampling::Sampling;
use crate::engine::{DelaySystem, Happened, Heard, Port};
use crate::network::NetworkError;
use crate::push::PushError;
use crate::recording::Signal;
use crate::setup::{AgentSetup, Control, Exchange, Law, Method, ReferenceKind, RobotKind, Setup, VelocitySensor};

/// Why a setup cannot be simulated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetupError {
    /// The network has no meaning.
    #[error("network: {0}")]
    Network(#[from] NetworkError),
    /// The network was made for another number of agents.
    #[error("the network has {network} agents, but {agents} are described")]
    AgentCount {
        /// Vertices of the network.
        network: usize,
        /// Agents described.
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
    /// A torque limit of one agent.
    #[error("agent `{agent}`: {error}")]
    Limiter {
        /// The agent.
        agent: String,
        /// What is wrong.
        error: LimiterError,
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
    /// A time, tolerance or step that is not positive.
    #[error("{what} is {value}, but must be positive and finite")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// The value.
        value: f64,
    },
}

/// Populations of at least so many agents are worked on in lanes.
const LANES_FROM: usize = 3;

/// All populations and where their blocks stand.
pub(crate) struct ClosedLoop<'a> {
    blocks: Vec<Block>,
    ports: Vec<Port>,
    entries: usize,
    start: Vec<f64>,
    /// When control is digital.
    sampling: Option<Sampling<'a>>,
    pushes: Pushes,
    /// A row of the recording of an agent that is pushed.
    row: Vec<f64>,
}

/// One population and its part of everything.
pub(super) struct Block {
    pub(super) columns: Box<dyn Columns>,
    pub(super) state: Range<usize>,
    pub(super) degree: Range<usize>,
    pub(super) sums: Range<usize>,
    external: Range<usize>,
}

impl Block {
    /// The population's part of what is heard and felt.
    pub(super) fn inputs<'a>(&self, heard: &'a Heard, felt: Option<&'a [f64]>) -> Inputs<'a> {
        Inputs {
            degree: &heard.degree[self.degree.clone()],
            sums: &heard.sums[self.sums.clone()],
            external: felt.map(|felt| &felt[self.external.clone()]),
        }
    }
}

impl<'a> ClosedLoop<'a> {
    /// Checks a setup and builds its closed loop.
    pub(crate) fn new(setup: &'a Setup) -> Result<Self, SetupError> {
        check(setup)?;
        match setup.exchange {
            Exchange::Position => Self::with_exchange::<Position>(setup),
            Exchange::PositionVelocity => Self::with_exchange::<PositionVelocity>(setup),
        }
    }

    fn with_exchange<X: CoreExchange>(setup: &'a Setup) -> Result<Self, SetupError> {
        let axes = setup.agents[0].robot.axes.len();
        let entries = X::CHANNELS * axes;
        let mut closed_loop = ClosedLoop {
            blocks: Vec::new(),
            ports: vec![Port { state: 0, entry: 0, degree: 0, stride: 0 }; setup.agents.len()],
            entries,
            start: Vec::new(),
            sampling: None,
            pushes: Pushes::default(),
            row: Vec::new(),
        };
        let mut placed = 0;
        for group in populations(&setup.agents) {
            let n = group.len();
            let columns = population::<X>(setup, &group)?;
            let first = closed_loop.start.len();
            closed_loop.append_start(setup, &group, &*columns);
            for (i, &agent) in group.iter().enumerate() {
                closed_loop.ports[agent] =
                    Port { state: first + i, entry: placed * entries + i, degree: placed + i, stride: n };
            }
            closed_loop.blocks.push(Block {
                state: first..closed_loop.start.len(),
                degree: placed..placed + n,
                sums: placed * entries..(placed + n) * entries,
                external: placed * axes..(placed + n) * axes,
                columns,
            });
            placed += n;
        }
        closed_loop.start_references(setup)?;
        if let Some(control) = &setup.control {
            let ClosedLoop { ports, start, .. } = &closed_loop;
            closed_loop.sampling = Some(Sampling::new(setup, control, ports.clone(), entries, start));
        }
        let first_of = |blocks: &[Block], degree: usize| {
            blocks.iter().find(|block| block.degree.contains(&degree)).map_or(0, |block| block.degree.start)
        };
        closed_loop.pushes = Pushes::new(setup, &closed_loop.ports, |degree| first_of(&closed_loop.blocks, degree));
        let longest = closed_loop.blocks.iter().map(|block| block.columns.signals().len()).max();
        closed_loop.row = Vec::with_capacity(longest.unwrap_or(0) + axes);
        Ok(closed_loop)
    }

    /// The initial state of one block, in the order that [`super::population`] documents.
    ///
    /// The reference state is filled with the wanted z(0), ż(0), … for [`ClosedLoop::start_references`] to replace.
    fn append_start(&mut self, setup: &Setup, group: &[usize], columns: &dyn Columns) {
        let first = self.start.len();
        let agents = || group.iter().map(|&agent| &setup.agents[agent]);
        let axes = setup.agents[group[0]].robot.axes.len();
        for axis in 0..axes {
            self.start.extend(agents().map(|a| a.start.q[axis]));
        }
        for axis in 0..axes {
            self.start.extend(agents().map(|a| a.start.dq[axis]));
        }
        for r in 0..columns.reference_vectors() {
            for axis in 0..axes {
                let default = |a: &AgentSetup| if r == 0 { a.start.dq[axis] } else { 0.0 };
                self.start.extend(agents().map(|a| a.start.reference.get(r).map_or(default(a), |z| z[axis])));
            }
        }
        for k in 0..setup.agents[group[0]].robot.theta.len() {
            self.start.extend(agents().filter_map(|a| match &a.law {
                Law::Adaptive { estimate_start, .. } => Some(estimate_start[k]),
                Law::Known { .. } => None,
            }));
        }
        self.start.resize(first + columns.state_len(), 0.0);
    }

    /// From the wanted z(0), ż(0), … to reference states, with what everybody hears at t = 0: the initial messages.
    fn start_references(&mut self, setup: &Setup) -> Result<(), SetupError> {
        let graph = setup.network.schedule.segments().next().map_or(0, |segment| segment.graph);
        let mut degree = vec![0.0; setup.agents.len()];
        let mut sums = vec![0.0; setup.agents.len() * self.entries];
        for edge in setup.network.schedule.graph(graph) {
            let (from, to) = (self.ports[edge.from], self.ports[edge.to]);
            let weight = setup.network.weight_at(edge.weight, 0.0);
            degree[to.degree] += weight;
            for c in 0..self.entries {
                sums[to.entry + c * to.stride] += weight * self.start[from.state + c * from.stride];
            }
        }
        for block in &self.blocks {
            let (degree, sums) = (&degree[block.degree.clone()], &sums[block.sums.clone()]);
            block
                .columns
                .start(&mut self.start[block.state.clone()], degree, sums)
                .map_err(|error| SetupError::Length { agent: setup.agents[0].name.clone(), error })?;
        }
        Ok(())
    }

    /// The initial state.
    pub(crate) fn start(&self) -> Vec<f64> {
        self.start.clone()
    }

    /// Where the messages that flow stand, and how many numbers one has: none when control is digital.
    pub(crate) fn ports(&self) -> (Vec<Port>, usize) {
        (self.ports.clone(), if self.sampling.is_some() { 0 } else { self.entries })
    }

    /// Agent, signal and axis of a state.
    pub(crate) fn locate(&self, state: usize) -> (usize, Signal, usize) {
        let block = self.blocks.iter().find(|block| block.state.contains(&state));
        block.map_or((0, Signal::Position, 0), |block| block.columns.locate(state - block.state.start))
    }

    /// The signals of every agent, in the order of agents.
    pub(crate) fn signals(&self, agents: usize) -> Vec<Vec<(Signal, usize)>> {
        let mut signals = vec![Vec::new(); agents];
        for block in &self.blocks {
            for (agent, port) in self.ports.iter().enumerate() {
                if block.degree.contains(&port.degree) {
                    signals[agent] = block.columns.signals();
                }
            }
        }
        for (agent, signals) in signals.iter_mut().enumerate().filter(|(agent, _)| self.pushes.concern(*agent)) {
            signals.extend((0..self.pushes.felt_by(agent).len()).map(|axis| (Signal::External, axis)));
        }
        signals
    }

    /// Hands every agent's signals at one instant to `write`.
    pub(crate) fn record(&mut self, t_s: f64, x: &[f64], heard: &Heard, mut write: impl FnMut(usize, &[f64])) {
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        self.pushes.feel(t_s, x);
        let (pushes, row) = (&self.pushes, &mut self.row);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, pushes.felt());
            let (columns, state) = (&mut block.columns, &x[block.state.clone()]);
            columns.record(state, inputs, &mut |agent, values| match pushes.felt_by(agent) {
                [] => write(agent, values),
                felt => {
                    row.clear();
                    row.extend_from_slice(values);
                    row.extend_from_slice(felt);
                    write(agent, row);
                }
            });
        }
    }
}

impl DelaySystem for ClosedLoop<'_> {
    fn rates(&mut self, t_s: f64, x: &[f64], heard: &Heard, dx: &mut [f64]) {
        let heard = self.sampling.as_ref().map_or(heard, Sampling::heard);
        self.pushes.feel(t_s, x);
        for block in &mut self.blocks {
            let inputs = block.inputs(heard, self.pushes.felt());
            block.columns.rates(&x[block.state.clone()], inputs, &mut dx[block.state.clone()]);
        }
    }

    fn next_event_s(&self) -> f64 {
        let sample_s = self.sampling.as_ref().map_or(f64::INFINITY, Sampling::next_s);
        sample_s.min(self.pushes.next_event_s())
    }

    fn happen(&mut self, until_s: f64, x: &mut [f64]) -> Happened {
        let pushed = self.pushes.happen(until_s);
        match &mut self.sampling {
            Some(sampling) => pushed.max(sampling.happen(until_s, &mut self.blocks, x)),
            None => pushed,
        }
    }
}

/// Agents that can stand side by side: one robot model, one order, all adaptive or none. Groups in order of their first
/// agent.
fn populations(agents: &[AgentSetup]) -> Vec<Vec<usize>> {
    let alike = |a: &AgentSetup, b: &AgentSetup| {
        let same_model = match (&a.robot.kind, &b.robot.kind) {
            (RobotKind::Tree(a), RobotKind::Tree(b)) => Arc::ptr_eq(a, b),
            (RobotKind::PlanarArm, RobotKind::PlanarArm) => true,
            (RobotKind::PointMass { dimension: a }, RobotKind::PointMass { dimension: b }) => a == b,
            _ => false,
        };
        same_model
            && a.roots_per_s.len() == b.roots_per_s.len()
            && matches!(a.law, Law::Adaptive { .. }) == matches!(b.law, Law::Adaptive { .. })
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, agent) in agents.iter().enumerate() {
        match groups.iter_mut().find(|group| alike(&agents[group[0]], agent)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}

fn population<X: CoreExchange>(setup: &Setup, group: &[usize]) -> Result<Box<dyn Columns>, SetupError> {
    let first = &setup.agents[group[0]];
    match &first.robot.kind {
        RobotKind::Tree(tree) => boxed::<Tree, X>(Tree::clone(tree), setup, group),
        RobotKind::PlanarArm => boxed::<PlanarArm, X>(PlanarArm, setup, group),
        RobotKind::PointMass { dimension } => boxed::<PointMass, X>(PointMass { dimension: *dimension }, setup, group),
    }
}

fn boxed<R, X>(robot: R, setup: &Setup, group: &[usize]) -> Result<Box<dyn Columns>, SetupError>
where
    R: Lagrangian<f64> + Lagrangian<Lanes<8>> + Clone + 'static,
    X: CoreExchange,
{
    let mut members = Vec::new();
    for &agent in group {
        members.push(member(&robot, &setup.agents[agent], agent)?);
    }
    let first = &setup.agents[group[0]];
    let design = |agent: usize| (&setup.agents[agent].roots_per_s[..], setup.agents[agent].manipulability);
    let roots = |error| SetupError::Roots { agent: first.name.clone(), error };
    match setup.reference {
        ReferenceKind::Consensus => columns(robot, members, setup, |group| {
            Consensus::<X>::new(group.iter().map(|&agent| design(agent))).map_err(roots)
        }),
        ReferenceKind::PureIntegral => columns(robot, members, setup, |group| {
            PureIntegral::<X>::new(group.iter().map(|&agent| design(agent))).map_err(roots)
        }),
        ReferenceKind::Backstepping { filter_s, acceleration_limit } => columns(robot, members, setup, |group| {
            let limit = acceleration_limit.unwrap_or(f64::INFINITY);
            Ok(Backstepping::new(group.iter().map(|_| (filter_s, limit)))?)
        }),
    }
}

/// A population with the reference dynamics that `reference` makes for a group of agents; under digital control every
/// agent has its own.
fn columns<R, F>(
    robot: R,
    members: Vec<Member>,
    setup: &Setup,
    reference: impl Fn(&[usize]) -> Result<F, SetupError>,
) -> Result<Box<dyn Columns>, SetupError>
where
    R: Lagrangian<f64> + Lagrangian<Lanes<8>> + Clone + 'static,
    F: Reference,
{
    let group: Vec<usize> = members.iter().map(|member| member.agent).collect();
    let sampler = match &setup.control {
        None => None,
        Some(control) => {
            let (mut agents, mut sensors) = (Vec::new(), Vec::new());
            for member in &members {
                agents.push(digital(&robot, member, reference(&[member.agent])?, setup, control)?);
                sensors.push(sensor(member.agent, setup, control)?);
            }
            Some(Sampler::new(agents, sensors, control, setup.agents[group[0]].robot.axes.len()))
        }
    };
    let reference = reference(&group)?;
    // What a held torque does is not what the ledger balances.
    let ledger = setup.solver.ledger && sampler.is_none();
    // Eight lanes cost about as much as two or three robots one at a time, so idle lanes pay from three robots on.
    Ok(if members.len() < LANES_FROM {
        Box::new(Population::<R, F, f64>::new(robot, members, reference, sampler, ledger))
    } else {
        Box::new(Population::<R, F, Lanes<8>>::new(robot, members, reference, sampler, ledger))
    })
}

/// The sampled controller of one member.
fn digital<R: Lagrangian<f64> + Clone, F: Reference>(
    robot: &R,
    member: &Member,
    reference: F,
    setup: &Setup,
    control: &Control,
) -> Result<Agent<R, F>, SetupError> {
    let agent = &setup.agents[member.agent];
    let name = || agent.name.clone();
    let axes = agent.robot.axes.len();
    let unlimited = || vec![f64::INFINITY; axes];
    let mut limit = control.actuators.torque_limit.clone().unwrap_or_else(unlimited);
    for (limit, effort) in limit.iter_mut().zip(member.effort_limits.iter().flatten()) {
        *limit = limit.min(*effort);
    }
    let rate = control.actuators.torque_rate_limit.clone().unwrap_or_else(unlimited);
    for (what, values) in [("the torque limits", &limit), ("the torque rate limits", &rate)] {
        LengthError::check(what, axes, values.len()).map_err(|error| SetupError::Length { agent: name(), error })?;
    }
    let limiter = Limiter::new(limit, rate).map_err(|error| SetupError::Limiter { agent: name(), error })?;
    let theta_hat = match &agent.law {
        Law::Adaptive { estimate_start, .. } => estimate_start.clone(),
        Law::Known { .. } => agent.robot.theta.clone(),
    };
    Agent::new(robot.clone(), reference, member.law.clone(), theta_hat, limiter)
        .map_err(|error| SetupError::Length { agent: name(), error })
}

fn sensor(agent: usize, setup: &Setup, control: &Control) -> Result<Sensor, SetupError> {
    let filter = match control.sensors.velocity {
        VelocitySensor::Measured => None,
        VelocitySensor::Filtered { cut_off_hz } => Some(
            VelocityFilter::new(core::f64::consts::TAU * cut_off_hz, setup.agents[agent].robot.axes.len())
                .map_err(SetupError::VelocityFilter)?,
        ),
    };
    Ok(Sensor::new(control.sensors, agent, filter))
}

fn member<R: Lagrangian<f64>>(robot: &R, agent: &AgentSetup, index: usize) -> Result<Member, SetupError> {
    let (m, p) = (robot.dof(), robot.parameter_count());
    let name = || agent.name.clone();
    let length = |what, need, got| {
        LengthError::check(what, need, got).map_err(|error| SetupError::Length { agent: name(), error })
    };
    length("axes", m, agent.robot.axes.len())?;
    length("theta", p, agent.robot.theta.len())?;
    let mut mass = vec![0.0; m * m];
    robot
        .mass_matrix(&mut robot.scratch(), &agent.start.q, &agent.robot.theta, &mut mass)
        .map_err(|error| SetupError::Length { agent: name(), error })?;
    let diagonal: Vec<f64> = mass.iter().step_by(m + 1).copied().collect();

    let resolve = |gain: &Gain, which, size, scale: &[f64]| -> Result<ResolvedGain, SetupError> {
        gain.resolve(size, scale).map_err(|error| SetupError::Gain { agent: name(), gain: which, error })
    };
    let (damping, adaptation) = match &agent.law {
        Law::Known { damping } => (damping, None),
        Law::Adaptive { damping, adaptation, estimate_start } => {
            length("start of the estimate", p, estimate_start.len())?;
            (damping, Some(adaptation))
        }
    };
    let adaptation = match adaptation {
        Some(gain) => {
            // Γ = ω² diag(scale): one ω is multiplied in here, the other by `resolve`.
            let omega = if let Gain::Bandwidth(omega) = gain { *omega } else { 1.0 };
            let scale = robot.adaptation_scale(&agent.start.q, &agent.robot.theta);
            let scale: Vec<f64> = scale.iter().map(|scale| omega * scale).collect();
            Some(resolve(gain, "Γ", p, &scale)?)
        }
        None => None,
    };
    let estimate_cost = match &adaptation {
        Some(gamma) => {
            Some(InverseQuadratic::new(gamma).map_err(|error| SetupError::Gain { agent: name(), gain: "Γ", error })?)
        }
        None => None,
    };
    let law = SlotineLi { damping: resolve(damping, "K", m, &diagonal)?, adaptation };
    let effort_limits = if agent.enforce_limits {
        let limit = |axis: &crate::setup::Axis| {
            axis.effort_limit.ok_or_else(|| SetupError::NoEffortLimit { agent: name(), axis: axis.name.clone() })
        };
        Some(agent.robot.axes.iter().map(limit).collect::<Result<_, _>>()?)
    } else {
        None
    };
    Ok(Member {
        agent: index,
        theta: agent.robot.theta.clone(),
        viscous: agent.robot.viscous(),
        law,
        estimate_cost,
        effort_limits,
    })
}

/// Everything that does not need a robot's kernels.
fn check(setup: &Setup) -> Result<(), SetupError> {
    setup.network.validate()?;
    if setup.network.agents != setup.agents.len() {
        return Err(SetupError::AgentCount { network: setup.network.agents, agents: setup.agents.len() });
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
    setup.control.as_ref().map_or(Ok(()), check_control)?;
    if matches!(setup.reference, ReferenceKind::Backstepping { .. }) && setup.exchange != Exchange::Position {
        return Err(SetupError::BacksteppingExchange);
    }
    let first = &setup.agents[0];
    let axes = first.robot.axes.len();
    for agent in &setup.agents {
        check_agent(agent, first, axes, setup.reference.free_derivatives(agent))?;
    }
    Ok(())
}

fn check_control(control: &Control) -> Result<(), SetupError> {
    let wrong = |what, value, requirement| Err(SetupError::Control { what, value, requirement });
    let Control { sample_hz, computation_delay_s, sensors, actuators } = control;
    if !(*sample_hz > 0.0 && sample_hz.is_finite()) {
        return wrong("the sample rate", *sample_hz, "must be positive and finite");
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

fn check_agent(agent: &AgentSetup, first: &AgentSetup, axes: usize, vectors: usize) -> Result<(), SetupError> {
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
    vector("the start velocity", axes, &agent.start.dq)?;
    for z in &agent.start.reference {
        vector("the start of the reference", axes, z)?;
    }
    if agent.start.reference.len() > vectors {
        let (need, got) = (vectors, agent.start.reference.len());
        let error = LengthError { what: "the start of the reference", need, got };
        return Err(SetupError::Length { agent: agent.name.clone(), error });
    }
    vector("theta", agent.robot.theta.len(), &agent.robot.theta)?;
    if let Law::Adaptive { estimate_start, .. } = &agent.law {
        vector("the start of the estimate", agent.robot.theta.len(), estimate_start)?;
    }
    for (k, push) in agent.pushes.iter().enumerate() {
        let problem = |error| SetupError::Push { agent: agent.name.clone(), push: k + 1, error };
        push.check(&agent.robot).map_err(problem)?;
    }
    Ok(())
}
