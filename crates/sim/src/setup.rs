//! Everything a run needs, as plain data: built by a scenario reader or by hand, checked when the closed loop is built.

use std::sync::Arc;

use forwardstep_core::reference::RootSet;
use forwardstep_core::robot::Drives;
use forwardstep_core::sampled::SafeCommand;

use crate::leader::{Following, FollowingDesign, Leading};
use crate::network::Network;
use crate::push::Push;
use crate::reference::{ReferenceDynamics, Tracking};
use crate::system::{Interface, Law, Robot, RobotInterface};
use crate::trajectory::Trajectory;

/// A network of agents and how long to watch it.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The agents, in the order of the network's vertices.
    pub agents: Vec<AgentSetup>,
    /// What produces their reference velocities.
    pub reference: Arc<dyn ReferenceDynamics>,
    /// What the agents tell each other.
    pub exchange: Exchange,
    /// Who hears whom, when, and how late.
    pub network: Network,
    /// Horizon and recording.
    pub time: TimeSpan,
    /// How to integrate.
    pub solver: Solver,
    /// How the controllers sample; `None` when they work in continuous time, as in the paper.
    pub control: Option<Control>,
}

impl Setup {
    /// How a leader is followed, if there is one.
    pub fn following(&self) -> Option<&Following> {
        self.reference.downcast()
    }

    /// The vertex of the leader, if there is one.
    pub fn leader(&self) -> Option<usize> {
        self.following().map(|following| match following.leader {
            Leading::Motion(_) => self.agents.len(),
            Leading::Agent(agent) => agent,
        })
    }

    /// The agent that leads the others, if one does.
    pub fn leading_agent(&self) -> Option<usize> {
        self.leader().filter(|leader| *leader < self.agents.len())
    }

    /// What leads an agent, by its number: what leads all of them, but for an agent that leads the others, which follows a target.
    pub fn reference_of(&self, agent: usize) -> &dyn ReferenceDynamics {
        if self.leader() == Some(agent) { &Tracking } else { &*self.reference }
    }

    /// Whether an agent follows a target of its own.
    pub fn tracks(&self, agent: usize) -> bool {
        self.reference_of(agent).interface().family.has_targets()
    }

    /// Whether every agent follows a target of its own.
    pub fn all_track(&self) -> bool {
        self.reference.interface().family.has_targets()
    }

    /// Changes the reference dynamics, if they are an `R`; whether they are.
    pub fn change_reference<R: ReferenceDynamics + Clone>(&mut self, change: impl FnOnce(&mut R)) -> bool {
        let Some(mut reference) = self.reference.downcast::<R>().cloned() else { return false };
        change(&mut reference);
        self.reference = Arc::new(reference);
        true
    }

    /// What a message holds, in words; nothing where no agent hears another.
    pub fn transmits(&self) -> Vec<&'static str> {
        if !self.network.has_edges() {
            return Vec::new();
        }
        let transmitted = match self.following().map(|following| following.design) {
            Some(FollowingDesign::Differentiable) => Some("acceleration"),
            Some(FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. }) => {
                Some("reference acceleration")
            }
            Some(FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. })
            | None => None,
        };
        self.exchange.words().iter().copied().chain(transmitted).collect()
    }

    /// What an agent measures, in words, whose law measures `law`.
    pub fn measures_for(&self, law: &[&'static str]) -> Vec<&'static str> {
        let following = self.following().is_some_and(|following| following.design == FollowingDesign::Differentiable);
        law.iter().copied().chain(following.then_some("acceleration")).collect()
    }

    /// The name of a vertex of the network.
    pub fn vertex_name(&self, vertex: usize) -> &str {
        let leader = || self.following().and_then(Following::motion).map_or("", |leader| &leader.name);
        self.agents.get(vertex).map_or_else(leader, |agent| &agent.name)
    }
}

/// What an agent transmits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exchange {
    /// q_j: the family (24).
    Position,
    /// q_j and q̇_j: the family (a5), of which (aa10) is order 1 and (a1) order 2.
    PositionVelocity,
    /// y_j = ż_j + β z_j + α q_j, in which agents agree with their leader; of the leader itself q̈_0 + β q̇_0 + α q_0.
    Composite,
    /// x̂_j and v̂_j, where agent j believes the leader to be and how fast it moves; of the leader itself q_0 and q̇_0.
    Estimates,
}

impl Exchange {
    /// What is transmitted, in words: vectors with a number per axis.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Exchange::Position => &["position"],
            Exchange::PositionVelocity => &["position", "velocity"],
            Exchange::Composite => &["composite vector"],
            Exchange::Estimates => &["estimated position of the leader", "estimated velocity of the leader"],
        }
    }

    /// Whether agents transmit how fast they move beside where they are, which makes (a5) of (24).
    pub fn has_velocities(self) -> bool {
        match self {
            Exchange::PositionVelocity => true,
            // What agents estimate of a leader, and y, are no measurements of their own.
            Exchange::Position | Exchange::Composite | Exchange::Estimates => false,
        }
    }
}

/// One agent.
#[derive(Clone, Debug)]
pub struct AgentSetup {
    /// Unique name, used in tables and messages.
    pub name: String,
    /// Its robot.
    pub robot: RobotSetup,
    /// κ₀ … κ_{ℓ−1} in 1/s, all positive, and pairs of complex roots; their number is the order ℓ of the reference dynamics. None
    /// for reference dynamics that have no roots.
    pub roots_per_s: RootSet,
    /// λ of Remark 4, 1/s^ℓ: how much the reference gives way to the motion; zero for not at all.
    pub manipulability: f64,
    /// Its tracking law.
    pub law: Arc<dyn Law>,
    /// Under [`Tracking`] where it should be; otherwise its offset from where all agree, for laws that know
    /// offsets.
    pub target: Option<Trajectory>,
    /// Where it starts.
    pub start: Start,
    /// Clip the torque at the effort limits of the robot's axes, and end the run when an axis leaves its position
    /// limits. Off, limits are only reported.
    pub enforce_limits: bool,
    /// What acts on it from outside, all at once where they overlap.
    pub pushes: Vec<Push>,
}

impl AgentSetup {
    /// What its law can do beside its robot; `None` when it is made for another kind.
    pub fn interface(&self) -> Option<Interface> {
        self.law.interface(&self.robot)
    }

    /// Changes its law, if that is an `L`; whether it is.
    pub fn change_law<L: Law + Clone>(&mut self, change: impl FnOnce(&mut L)) -> bool {
        let Some(mut law) = self.law.downcast::<L>().cloned() else { return false };
        change(&mut law);
        self.law = Arc::new(law);
        true
    }

    /// Whether its law estimates parameters.
    pub fn estimates(&self) -> bool {
        self.interface().is_some_and(|interface| interface.estimates)
    }

    /// What it measures, in words. A law cannot read anything else: its inputs have no room for it.
    pub fn measures(&self) -> &'static [&'static str] {
        self.interface().map_or(&[], |interface| interface.measures)
    }
}

/// A robot with its true parameters.
#[derive(Clone, Debug)]
pub struct RobotSetup {
    /// Geometry and kernels.
    pub kind: Arc<dyn Robot>,
    /// The true ϑ.
    pub theta: Vec<f64>,
    /// A name for each entry of ϑ, for tables, for example `forearm_link.mass`.
    pub theta_names: Vec<String>,
    /// One entry per degree of freedom.
    pub axes: Vec<Axis>,
}

impl RobotSetup {
    /// What its data mean.
    pub fn interface(&self) -> RobotInterface {
        self.kind.interface(self.axes.len())
    }

    /// The true dampings, armatures and frictions of `drives`, which are its own and close ϑ; `None` when ϑ is too short.
    pub fn drive_parameters(&self, drives: &Drives) -> Option<[&[f64]; 3]> {
        let [dampings, armatures, frictions] = drives.ranges_in(self.theta.len())?;
        Some([self.theta.get(dampings)?, self.theta.get(armatures)?, self.theta.get(frictions)?])
    }

    /// Numbers of a velocity, which are those of a position but for a spacecraft.
    pub fn velocity_len(&self) -> usize {
        self.interface().velocity_len
    }
}

/// One degree of freedom of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The joint's name.
    pub name: String,
    /// rad or m.
    pub unit: AxisUnit,
    /// Lowest and highest position.
    pub position_limits: Option<[f64; 2]>,
    /// Highest speed, rad/s or m/s.
    pub velocity_limit: Option<f64>,
    /// Highest torque or force, N m or N.
    pub effort_limit: Option<f64>,
}

/// The unit of an axis position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisUnit {
    /// A revolute joint.
    Radian,
    /// A prismatic joint or a coordinate.
    Metre,
    /// A pure number, as an entry of a quaternion is.
    One,
    /// Whatever a state of an abstract chain measures. Its rate is per second; of its input and its estimates nothing is known.
    Own,
}

impl AxisUnit {
    /// The unit of what moves an axis: a torque or a force.
    pub fn effort(self) -> &'static str {
        match self {
            AxisUnit::Radian | AxisUnit::One => "N m",
            AxisUnit::Metre => "N",
            AxisUnit::Own => "1",
        }
    }
}

/// Initial values of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// q(0).
    pub q: Vec<f64>,
    /// q̇(0).
    pub dq: Vec<f64>,
    /// The rest of a plant's state, if it has more than q and q̇.
    pub rest: Vec<f64>,
    /// z(0), ż(0), … z^(ℓ−1)(0); missing ones take z(0) = q̇(0) where q̇ is measured, else zero, and zero derivatives. Then what
    /// [`Interface::further_starts`] has, empty for the default start. Of the backstepping baseline, instead, what its filter holds.
    pub reference: Vec<Vec<f64>>,
}

/// Rows of a recording are this far apart unless it is said otherwise, s.
pub const RECORD_EVERY_S: f64 = 0.02;

/// Horizon and recording.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeSpan {
    /// The run covers [0, `end_s`].
    pub end_s: f64,
    /// Rows of the recording are this far apart, unless `record_at` says otherwise.
    pub record_every_s: f64,
    /// When there are rows. The first is at 0 and the last at `end_s`, whatever this says.
    pub record_at: RecordAt,
}

/// When rows of a recording are taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum RecordAt {
    /// Every [`TimeSpan::record_every_s`].
    #[default]
    Intervals,
    /// At k/hz for k = 0, 1, …: with [`Control::sample_hz`] at the very instants of the samples, just after them.
    Rate {
        /// Rows per second.
        hz: f64,
    },
    /// At these times, which rise, s.
    Times(Arc<[f64]>),
}

/// Digital control: at every sample all agents measure, send, hear and compute, and hold the torque until the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Samples per second.
    pub sample_hz: f64,
    /// How long after the sample the torque changes, s; at most a period. Until the first command arrives it is zero.
    pub computation_delay_s: f64,
    /// What the agents measure.
    pub sensors: Sensors,
    /// What the actuators can do, besides the limits of the robots if those are enforced.
    pub actuators: Actuators,
    /// What happens when a controller cannot go on as usual.
    pub failures: Failures,
}

/// What agents measure: the truth, then noise, then quantisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Where velocities come from.
    pub velocity: VelocitySensor,
    /// Standard deviation of the noise of positions, rad or m.
    pub position_noise: f64,
    /// Standard deviation of the noise of velocities, rad/s or m/s; not used with [`VelocitySensor::Filtered`].
    pub velocity_noise: f64,
    /// Standard deviation of the noise of the velocities of tips, m/s, where a law measures them.
    pub tip_velocity_noise: f64,
    /// Seed of the noise; every agent has a stream of its own.
    pub seed: u64,
    /// Step of the positions, rad or m; zero for none.
    pub position_quantum: f64,
    /// Step of the velocities, rad/s or m/s; zero for none; not used with [`VelocitySensor::Filtered`].
    pub velocity_quantum: f64,
}

impl Default for Sensors {
    /// Exact measurements.
    fn default() -> Self {
        Sensors {
            velocity: VelocitySensor::Measured,
            position_noise: 0.0,
            velocity_noise: 0.0,
            tip_velocity_noise: 0.0,
            seed: 0,
            position_quantum: 0.0,
            velocity_quantum: 0.0,
        }
    }
}

/// Where velocities come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VelocitySensor {
    /// They are measured.
    Measured,
    /// There are encoders only: see [`forwardstep_core::agent::VelocityFilter`].
    Filtered {
        /// Cut-off of the filter, Hz.
        cut_off_hz: f64,
    },
}

/// What actuators can do.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Actuators {
    /// Largest torque of every axis, N m or N.
    pub torque_limit: Option<Vec<f64>>,
    /// Fastest change of the torque of every axis, N m/s or N/s.
    pub torque_rate_limit: Option<Vec<f64>>,
    /// Step of the torques, N m or N; zero for none. Torques are limited, then rounded: they keep their limit, and change by
    /// at most a step more than their rate allows.
    pub torque_quantum: f64,
}

impl Actuators {
    /// The largest torque that is given under `limit`, N m or N: of torques that are rounded the last step that lies within it.
    pub fn largest_within(&self, limit: f64) -> f64 {
        // 0.6/0.2 is rounded to less than three.
        const ROUNDING: f64 = 1e-12;
        let quantum = self.torque_quantum;
        if quantum > 0.0 && limit.is_finite() { quantum * (limit / quantum * (1.0 + ROUNDING)).floor() } else { limit }
    }
}

/// The default relative tolerance of an adaptive method.
pub const RTOL: f64 = 1e-6;
/// The default absolute tolerance of an adaptive method.
pub const ATOL: f64 = 1e-8;

/// What happens when a sampled controller cannot go on as usual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Failures {
    /// What is commanded when a step fails, and the run goes on; `None` to end the run there.
    pub safe_command: Option<SafeCommand>,
    /// A message that is older than this does not count until a newer one arrives, s; `None` for messages of any age.
    pub message_timeout_s: Option<f64>,
}

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solver {
    /// Adaptive pair or fixed step.
    pub method: Method,
    /// No step is longer.
    pub max_step_s: Option<f64>,
    /// The run breaks down when the error control asks for a shorter step.
    pub min_step_s: f64,
    /// Bytes that what was transmitted may take, as far back as the longest delay. The run breaks down when shorter steps
    /// would need more.
    pub memory_budget_bytes: u64,
    /// Integrate sᵀ(K + D)s − sᵀτ_ext of every agent as an extra state, so that V + ∫ … = V(0) can be checked.
    pub balance: bool,
}

/// The time-stepping method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The Dormand–Prince pair of order 5(4) with its continuous extension of order 4.
    Adaptive {
        /// Relative tolerance.
        rtol: f64,
        /// Absolute tolerance.
        atol: f64,
    },
    /// The classical Runge–Kutta method of order 4 with steps of at most this length, cut at break-points.
    Fixed {
        /// In s.
        step_s: f64,
    },
}

impl Default for Solver {
    fn default() -> Self {
        Solver {
            method: Method::Adaptive { rtol: RTOL, atol: ATOL },
            max_step_s: None,
            min_step_s: 1e-12,
            memory_budget_bytes: 1 << 30,
            balance: true,
        }
    }
}
