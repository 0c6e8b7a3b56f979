//! The setup in which every agent follows its reference exactly.
//!
//! A point mass of 1 kg under (6) with its mass known has q̈ = ż − K s. From z(0) = q̇(0) on s is zero and stays so: both
//! sides integrate the same numbers. So the reference dynamics can be simulated alone by the engine that simulates robots, over the
//! same network, with the same switching, delays and draws.
//!
//! With s ≡ 0 all laws of consensus lead to one equation: x₀ = q, x₁ = q̇, … x_ℓ with dx_r/dt = x_{r+1} and
//! dXᵢ/dt = −Σⱼ w_ij (Xᵢ − heard_j), whatever part of x is measured and whatever part is constructed. A chain of order k
//! starts it from x₀ … x_{k−2} and z, ż, …; a robot from q, z, ż, …; a vehicle, which agrees with the others less its offset d, from
//! x − d, z, ż, …, and under (46), where it is itself the chain, from x − d, ẋ − ḋ, ẍ − d̈.

use std::sync::Arc;

use forwardstep_core::Gain;
use forwardstep_core::attitude::normalized;
use forwardstep_core::controller::Jet;
use forwardstep_core::plant::Vehicle;
use forwardstep_core::robot::PointMass;
use forwardstep_sim::reference::PureIntegral;
use forwardstep_sim::{
    AgentSetup, Axis, ChainLaw, ChainModel, Known, PositionOnlyLaw, RobotSetup, RotorcraftModel, Setup, SetupError,
    Solver, Start, ThrustLaw, VehicleModel, check_shape,
};
use thiserror::Error;

use crate::conserved::Tally;
use crate::instance::{designed, is_consensus};
use crate::kinds::{is_its_own_reference, is_lagrangian};
use crate::links::may_time_out;

/// Why there is no setup in which everybody follows its reference exactly.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoIdeal {
    /// They follow a leader.
    #[error("everybody follows a leader")]
    Leader,
    /// They follow targets of their own.
    #[error("agents follow targets and do not agree with each other")]
    Targets,
    /// The baseline differentiates what it hears: z jumps with messages, and no velocity follows it exactly.
    #[error("the velocity that backstepping asks for jumps with messages, so that it cannot be followed exactly")]
    Backstepping,
    /// Messages that do not count.
    #[error("messages may become older than `message_timeout_s` and do not count then, so that the network is another")]
    TimesOut,
    /// Reference dynamics from outside.
    #[error("the reference dynamics are not those of a design of the paper")]
    Own,
    /// A law whose reference is something else than derivatives of the position.
    #[error("the law of agent number {} has no reference that is known without its robot", agent + 1)]
    Law {
        /// Index of the agent.
        agent: usize,
    },
    /// It agrees with the others up to an offset, and its law knows none.
    #[error("agent number {} keeps an offset from where the others agree", agent + 1)]
    Offset {
        /// Index of the agent.
        agent: usize,
    },
    /// The parts of the setup do not fit together.
    #[error("the parts of the setup do not fit together: {0}")]
    Setup(#[from] Box<SetupError>),
    /// Too few roots for its robot, or a start of the wrong length: the setup has no meaning.
    #[error("the start of agent number {} does not fit its order", agent + 1)]
    Start {
        /// Index of the agent.
        agent: usize,
    },
}

/// `setup` with every agent replaced by a point mass that follows its reference exactly, in continuous time.
///
/// The network, its draws, the roots, the horizon and the solver are those of `setup`; agents keep their names and axes. What
/// has no meaning or no effect while s ≡ 0 is left out: gains, estimates, λ of Remark 4, pushes, limits, sampling. Under
/// (aa10), (a1), (a5) and (24) q̇(0) becomes z(0), which keeps what [`crate::predict`] finds conserved together with
/// [`told_before`]: velocities sent before t = 0 are q̇(0). Under (3) and (23) z(0) becomes q̇(0), which
/// keeps it always. Vehicles in formation are replaced by what agrees, x − d.
///
/// # Errors
/// [`NoIdeal`] when the reference of some agent depends on more than the network, or the parts of the setup do not fit together.
pub fn ideal(setup: &Setup) -> Result<Setup, NoIdeal> {
    check_shape(setup).map_err(Box::new)?;
    let designed = designed(setup);
    let setup = designed.as_ref().unwrap_or(setup);
    let reference = &setup.reference;
    if setup.following().is_some() {
        return Err(NoIdeal::Leader);
    }
    if setup.all_track() {
        return Err(NoIdeal::Targets);
    }
    if reference.is::<forwardstep_sim::reference::Backstepping>() {
        return Err(NoIdeal::Backstepping);
    }
    if !is_consensus(setup) {
        return Err(NoIdeal::Own);
    }
    if may_time_out(setup) {
        return Err(NoIdeal::TimesOut);
    }
    let integral = reference.is::<PureIntegral>();
    let agents = setup.agents.iter().enumerate();
    Ok(Setup {
        agents: agents.map(|(agent, own)| follower(agent, own, integral)).collect::<Result<_, _>>()?,
        solver: Solver { balance: false, ..setup.solver },
        control: None,
        ..setup.clone()
    })
}

/// `setup` with every agent that follows a leader, and a leader that is an agent, replaced by a point mass of 1 kg under (6) that starts where it
/// starts, in continuous time; `None` where a law is none of (6)–(7), or messages
/// may be too old to count. With z(0) = q̇(0) it follows its reference exactly, as in [`ideal`].
pub(crate) fn behind_leader(setup: &Setup) -> Option<Setup> {
    setup.following().filter(|_| !may_time_out(setup))?;
    let mass = |(agent, own): (usize, &AgentSetup)| {
        let start = Start { rest: Vec::new(), ..own.start.clone() };
        is_lagrangian(own)
            .then(|| AgentSetup { target: own.target.clone().filter(|_| setup.tracks(agent)), ..unit_mass(own, start) })
    };
    Some(Setup {
        agents: setup.agents.iter().enumerate().map(mass).collect::<Option<_>>()?,
        solver: Solver { balance: false, ..setup.solver },
        control: None,
        ..setup.clone()
    })
}

/// What the agents of `setup` sent before t = 0, positions and velocities as they are measured, where that is not what those of [`ideal`]
/// send at the start.
pub fn told_before(setup: &Setup, ideal: &Setup) -> Option<Vec<Vec<f64>>> {
    let message = |agent: &AgentSetup| -> Option<Vec<f64>> {
        let Some(law) = agent.law.downcast() else { return Some([&agent.start.q[..], &agent.start.dq].concat()) };
        let measured = in_formation(agent, law)?;
        Some(measured.into_iter().take(2).flatten().map(|x| x.value).collect())
    };
    let before: Vec<Vec<f64>> = setup.agents.iter().map(message).collect::<Option<_>>()?;
    let differs = |(told, agent): (&Vec<f64>, &AgentSetup)| *told != [&agent.start.q[..], &agent.start.dq].concat();
    let designed = designed(setup);
    let setup = designed.as_ref().unwrap_or(setup);
    let velocities = setup.exchange.has_velocities() && !setup.reference.is::<PureIntegral>();
    (velocities && before.iter().zip(&ideal.agents).any(differs)).then_some(before)
}

/// Damping of what rounding leaves of s, 1/s: with s = 0 it acts on nothing.
const DAMPING_PER_S: f64 = 1.0;

fn follower(agent: usize, own: &AgentSetup, integral: bool) -> Result<AgentSetup, NoIdeal> {
    Ok(unit_mass(own, start(agent, own, integral)?))
}

/// A point mass of 1 kg, which is known, in the place of a robot.
fn unit_mass(own: &AgentSetup, start: Start) -> AgentSetup {
    let axes = own.robot.axes.iter().map(|axis| Axis {
        position_limits: None,
        velocity_limit: None,
        effort_limit: None,
        ..axis.clone()
    });
    AgentSetup {
        robot: RobotSetup {
            kind: Arc::new(PointMass { dimension: own.robot.axes.len() }),
            theta: vec![1.0],
            theta_names: vec!["mass".into()],
            axes: axes.collect(),
        },
        manipulability: 0.0,
        law: Arc::new(Known { damping: Gain::Number(DAMPING_PER_S) }),
        target: None,
        start,
        enforce_limits: false,
        pushes: Vec::new(),
        name: own.name.clone(),
        roots_per_s: own.roots_per_s.clone(),
    }
}

/// q, q̇ = z, ż, … at the start.
fn start(agent: usize, own: &AgentSetup, integral: bool) -> Result<Start, NoIdeal> {
    let numbers = |x: Vec<Tally>| x.into_iter().map(|x| x.value).collect::<Vec<_>>();
    let mut x = family_start(agent, own, integral)?.into_iter().map(numbers);
    let (q, reference) = (x.next().unwrap_or_default(), x.collect::<Vec<_>>());
    Ok(Start { q, dq: reference.first().cloned().unwrap_or_default(), rest: Vec::new(), reference })
}

/// x₀, x₁ = z, … at the start, as many as are not zero and two at least, with the sizes of what they were subtracted from.
pub(crate) fn family_start(agent: usize, own: &AgentSetup, integral: bool) -> Result<Vec<Vec<Tally>>, NoIdeal> {
    let order = order(own).ok_or(NoIdeal::Law { agent })?;
    let (start, axes) = (&own.start, own.robot.axes.len());
    // x₀ … x_{k−2}, then what z follows.
    let tallies = |x: &[f64]| x.iter().copied().map(Tally::of).collect::<Vec<_>>();
    let mut measured: Vec<Vec<Tally>> = match own.law.downcast() {
        Some(law) => in_formation(own, law).ok_or(NoIdeal::Start { agent })?,
        None if own.target.is_some() => return Err(NoIdeal::Offset { agent }),
        None => {
            [&start.q, &start.dq, &start.rest].iter().flat_map(|part| part.chunks(axes.max(1))).map(tallies).collect()
        }
    };
    if measured.len() < order || measured.iter().any(|x| x.len() != axes) {
        return Err(NoIdeal::Start { agent });
    }
    let at_rest = vec![Tally::default(); axes];
    let followed = if own.law.is::<PositionOnlyLaw>() { at_rest.clone() } else { measured[order - 1].clone() };
    let keeps_velocity = integral || start.reference.is_empty();
    let z = if keeps_velocity { followed } else { tallies(&start.reference[0]) };
    measured.truncate(order - 1);
    measured.push(z);
    measured.extend(start.reference.iter().skip(1).map(|x| tallies(x)));
    measured.resize(measured.len().max(2), at_rest);
    if measured.iter().any(|x| x.len() != axes) || measured.len() > own.roots_per_s.len() + 1 {
        return Err(NoIdeal::Start { agent });
    }
    Ok(measured)
}

/// x − d, ẋ − ḋ and ẍ − d̈ of a vehicle at the start, the last where its law has no z; `None` when its start does not fit.
fn in_formation(own: &AgentSetup, law: &ThrustLaw) -> Option<Vec<Vec<Tally>>> {
    let start = &own.start;
    let mut measured: Vec<Vec<Tally>> =
        [&start.q, &start.dq].map(|x| x.iter().copied().map(Tally::of).collect()).into();
    if is_its_own_reference(own) {
        let kind = &own.robot.kind;
        let of_vehicle = kind.downcast().map(|VehicleModel { gravity }| *gravity);
        let gravity = of_vehicle.or_else(|| Some(kind.downcast::<RotorcraftModel>()?.gravity))?;
        let mass = *own.robot.theta.first()?;
        let attitude = normalized(start.rest.get(..4)?.try_into().ok()?);
        let sigma = law.thrust_start.unwrap_or(mass * gravity);
        let weight = Tally { value: 0.0, size: gravity + (sigma / mass).abs() };
        measured.push(Vehicle { mass, gravity }.acceleration(attitude, sigma).map(|x| weight + Tally::of(x)).to_vec());
    }
    if let Some(offset) = &own.target {
        let mut jets = vec![Jet::default(); offset.axes()];
        offset.jets(0.0, &mut jets);
        for (r, x) in measured.iter_mut().enumerate() {
            x.iter_mut().zip(&jets).for_each(|(x, d)| *x = *x + Tally::of(-d[r]));
        }
    }
    Some(measured)
}

/// The largest |s| of an axis of `own` at the start, where z(0) is given beside what follows it.
pub(crate) fn start_error(own: &AgentSetup) -> f64 {
    let axes = own.robot.axes.len();
    let followed = match own.law.downcast() {
        Some(law) if is_its_own_reference(own) || in_formation(own, law).is_none() => return 0.0,
        Some(law) => {
            in_formation(own, law).and_then(|mut measured| Some(measured.pop()?.iter().map(|x| x.value).collect()))
        }
        None if own.law.is::<PositionOnlyLaw>() => return 0.0,
        None => {
            let all = [&own.start.q[..], &own.start.dq, &own.start.rest].concat();
            order(own).and_then(|order| all.chunks(axes.max(1)).nth(order - 1).map(<[f64]>::to_vec))
        }
    };
    let z = own.start.reference.first();
    let apart = followed.zip(z).map(|(followed, z)| {
        followed.iter().zip(z).map(|(followed, z): (&f64, &f64)| (followed - z).abs()).fold(0.0, f64::max)
    });
    apart.unwrap_or(0.0)
}

/// k, where z follows the derivative of order k − 1 of the position.
pub(crate) fn order(own: &AgentSetup) -> Option<usize> {
    if is_lagrangian(own) || own.law.is::<PositionOnlyLaw>() {
        return Some(2);
    }
    if own.law.is::<ThrustLaw>() {
        return Some(if is_its_own_reference(own) { 3 } else { 2 });
    }
    own.law.downcast::<ChainLaw>()?;
    match own.robot.kind.downcast()? {
        model @ (ChainModel::Derivatives(_) | ChainModel::Vector(_)) => Some(model.order()),
        // Its feedback leads the first state to z.
        ChainModel::Cascade(_) => Some(1),
    }
}
