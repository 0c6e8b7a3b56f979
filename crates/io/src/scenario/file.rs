//! The scenario file as it is written. The doc comments of this file are the descriptions of the published JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::attitude_file::AttitudeStartFile;
use super::chain_file::{
    AdaptiveBacksteppingFile, ChainFile, ImmersionFile, LinearAdaptiveFile, LinearisingFile, PureFeedbackFile,
    StrictFeedbackFile,
};
use super::control_file::ControlFile;
use super::leader_file::{LeaderFile, LeaderReferenceFile};
use super::network_file::NetworkFile;
use super::push_file::PushFile;
use super::spacecraft_file::{AttitudeFile, SpacecraftFile, SpacecraftStartFile};
use super::systems_file::{PositionOnlyFile, TargetFile, TrackingFile};
use super::task_file::TaskSpaceFile;
use super::values::{GainFile, GainOrBandwidth, Named, NotNegative, Positive, StartValues};
use super::vehicle_file::{RotorcraftFile, ThrustFile, VehicleFile};

/// A forwardstep scenario: a network of robots, how they are controlled, and how long to watch them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "forwardstep scenario")]
pub struct ScenarioFile {
    /// The version of this format.
    #[schemars(extend("const" = 1))]
    pub format: At<i64>,
    /// What the scenario shows, in one line.
    pub title: Option<String>,
    /// How long to simulate, and how often to record.
    pub time: TimeFile,
    /// The agents, one by one or as counted populations.
    #[schemars(length(min = 1))]
    pub agents: At<Vec<At<AgentFile>>>,
    /// The reference dynamics of all agents.
    pub reference: At<ReferenceFile>,
    /// What everybody follows, where there is a leader: one more vertex of the network, which hears nobody.
    pub leader: Option<At<LeaderFile>>,
    /// The tracking law of all agents that have none of their own.
    pub law: Option<At<LawFile>>,
    /// Where agents start that say nothing of their own.
    pub start: Option<At<StartFile>>,
    /// Who hears whom, when, and how late. Not needed where every agent follows a target of its own.
    pub network: Option<At<NetworkFile>>,
    /// How the controllers sample. Default: they work in continuous time, as in the paper.
    pub control: Option<ControlFile>,
    /// What acts on the agents from outside: forces, torques and hands.
    #[serde(default)]
    pub pushes: Vec<At<PushFile>>,
    /// How to integrate.
    pub solver: Option<SolverFile>,
    /// What the run is expected to show.
    pub goal: Option<At<GoalFile>>,
}

/// Horizon and recording.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeFile {
    /// The run covers [0, `end_s`], in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end_s: At<f64>,
    /// Rows of the tables are this far apart, in s. Default: 0.02.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub record_every_s: Option<At<f64>>,
}

/// One agent, or a population of agents of one kind.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgentFile {
    /// The agent's name; letters, digits, `-` and `_`. With a `count`, agents are named `name-1`, `name-2`, …
    // Everything in ASCII but these; not all readers of a schema know the classes of Unicode.
    #[schemars(length(max = 64), extend("pattern" = r"^[^\x00-,./:-@\[-^`{-\x7f]+$"))]
    pub name: At<String>,
    /// How many agents of this kind there are.
    #[schemars(range(min = 1))]
    pub count: Option<At<i64>>,
    /// Its robot.
    pub robot: At<RobotFile>,
    /// Lets the robots of a counted population differ. Default: they are all the same.
    pub spread: Option<At<SpreadFile>>,
    /// Where it starts. Default: at rest at zero.
    pub start: Option<At<StartFile>>,
    /// Reference dynamics of its own.
    pub reference: Option<At<AgentReferenceFile>>,
    /// A tracking law of its own.
    pub law: Option<At<LawFile>>,
    /// Where it should be; among agents that agree, its offset from where all of them are.
    pub target: Option<At<TargetFile>>,
    /// Clip torques at the effort limits of the robot, and end the run when a joint leaves its position limits.
    /// Otherwise limits are only reported. Default: false.
    pub enforce_limits: Option<At<bool>>,
}

/// The robots that can be simulated.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RobotFile {
    /// An arm, or any tree of rigid bodies on a fixed base, from a URDF.
    Urdf(UrdfFile),
    /// The two-link planar arm in closed form: the first angle from the horizontal, the second relative to the first link.
    PlanarArm(PlanarArmFile),
    /// A point mass that is pushed along every axis.
    PointMass(PointMassFile),
    /// A vehicle in space with one thrust along its own axis, whose angular velocity obeys at once.
    Vehicle(VehicleFile),
    /// The same as a rigid body with inertia that torques turn.
    Rotorcraft(RotorcraftFile),
    /// A spacecraft that turns itself by reaction wheels.
    Spacecraft(SpacecraftFile),
    /// A plant of any order with formulas for χ and ψ: Section IV of the paper.
    Chain(ChainFile),
    /// A parametric chain in strict-feedback form.
    StrictFeedback(StrictFeedbackFile),
    /// A parametric chain in pure-feedback form.
    PureFeedback(PureFeedbackFile),
}

/// A robot from a URDF.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UrdfFile {
    /// The URDF, beside the scenario file or in `inputs` beside it, or the name of a shipped robot: `ur5e.urdf`, `panda.urdf`,
    /// `gantry.urdf`.
    pub file: At<String>,
    /// Joints held at a value, in rad or m; each removes one axis.
    #[serde(default)]
    pub locked: Named,
    /// What to do with Coulomb friction in the URDF, which the law does not cover.
    pub friction: Option<FrictionFile>,
    /// Gravity in the base frame, in m/s². Default: [0, 0, -9.81].
    pub gravity_m_s2: Option<[f64; 3]>,
}

/// What to do with Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrictionFile {
    /// Simulate without it.
    Ignore,
}

/// Masses and lengths of a two-link planar arm.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlanarArmFile {
    /// Mass of each link, in kg.
    #[schemars(with = "[Positive; 2]")]
    pub mass_kg: [At<f64>; 2],
    /// Length of each link, in m.
    #[schemars(with = "[Positive; 2]")]
    pub length_m: [At<f64>; 2],
    /// From each joint to the centre of mass of its link, in m. Default: the middle of the link.
    pub com_m: Option<[At<f64>; 2]>,
    /// Inertia of each link about its centre of mass, in kg m². Default: that of a uniform rod, m l²/12.
    #[schemars(with = "Option<[NotNegative; 2]>")]
    pub inertia_kg_m2: Option<[At<f64>; 2]>,
    /// Gravity, pointing down, in m/s². Default: 9.81.
    #[schemars(range(min = 0))]
    pub gravity_m_s2: Option<At<f64>>,
}

/// A point mass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointMassFile {
    /// The number of axes.
    #[schemars(range(min = 1))]
    pub dimension: At<i64>,
    /// Its mass, in kg.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: At<f64>,
}

/// How the robots of a population differ from what is written, each number by a random factor of its own: the masses and
/// lengths of planar arms (centres of mass and inertias follow), the masses of point masses and vehicles, the inertia of
/// spacecraft, all inertia of
/// each body of a URDF.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpreadFile {
    /// The same seed gives the same robots, however many there are.
    #[schemars(range(min = 0))]
    pub seed: At<i64>,
    /// Factors are drawn uniformly from 1 − this to 1 + this.
    #[schemars(range(min = 0, max = 0.9))]
    pub relative: At<f64>,
}

/// Where agents start. Everything that is not given is zero; the reference velocity then starts at the velocity.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartFile {
    /// Positions of robots whose axes are all angles, in rad.
    pub position_rad: Option<At<StartValues>>,
    /// Positions of robots whose axes are all lengths, in m.
    pub position_m: Option<At<StartValues>>,
    /// Positions of any robot, in rad or m as each axis has it.
    pub position: Option<At<StartValues>>,
    /// Velocities of robots whose axes are all angles, in rad/s.
    pub velocity_rad_s: Option<At<StartValues>>,
    /// Velocities of robots whose axes are all lengths, in m/s.
    pub velocity_m_s: Option<At<StartValues>>,
    /// Velocities of any robot, in rad/s or m/s as each axis has it.
    pub velocity: Option<At<StartValues>>,
    /// Attitudes of vehicles, rotorcraft and spacecraft: a quaternion of any length, vector part first, or an axis with an angle.
    /// Default: upright, [0, 0, 0, 1].
    pub attitude: Option<At<AttitudeStartFile>>,
    /// Angular velocities of rotorcraft and spacecraft in the axes of the body, in rad/s.
    pub angular_velocity_rad_s: Option<At<[f64; 3]>>,
    /// Where spacecraft start.
    pub spacecraft: Option<At<SpacecraftStartFile>>,
    /// What else there is of a chain: its derivatives from the second on, or x2, x3, … of one in feedback form.
    pub higher_states: Option<At<StartValues>>,
    /// The state of the reference dynamics.
    pub reference: Option<At<ReferenceStartFile>>,
}

/// The initial state of the reference dynamics, in the units of the axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferenceStartFile {
    /// The reference velocity. Default: the velocity of the robot.
    pub z: Option<At<StartValues>>,
    /// Its first, second, … derivative, at most one fewer than the order has. Default: zero.
    #[serde(default)]
    pub derivatives: Vec<At<StartValues>>,
}

/// The reference dynamics of all agents.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ReferenceFile {
    /// Agreement on a position: the designs (aa10), (a1), (a5) and (24) of the paper.
    Consensus(ConsensusFile),
    /// Agreement over a fixed graph: (3) of the paper or, when only positions are exchanged, (23); two roots.
    PureIntegral(ConsensusFile),
    /// The baseline (aa6) that differentiates what it hears; positions are exchanged.
    Backstepping(BacksteppingFile),
    /// Everybody follows a leader that only some hear: (110), (119) or (122) of the paper.
    Leader(LeaderReferenceFile),
    /// No agreement: every agent follows a target of its own.
    Tracking(TrackingFile),
}

impl ReferenceFile {
    /// The key that it has in a file.
    pub(super) fn key(&self) -> &'static str {
        match self {
            ReferenceFile::Consensus(_) => "consensus",
            ReferenceFile::PureIntegral(_) => "pure_integral",
            ReferenceFile::Backstepping(_) => "backstepping",
            ReferenceFile::Leader(_) => "leader",
            ReferenceFile::Tracking(_) => "tracking",
        }
    }
}

/// Reference dynamics that lead to agreement.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConsensusFile {
    /// The positive numbers κ₀, κ₁, … in 1/s; as many as the order of the reference dynamics. Agents may have their own.
    #[schemars(with = "Option<Vec<Positive>>", length(min = 1, max = 32))]
    pub roots_per_s: Option<At<Vec<At<f64>>>>,
    /// What the agents tell each other.
    pub exchange: At<ExchangeFile>,
    /// The gain λ of Remark 4, in 1/s to the power of the order: how much the reference gives way to the motion. Default: 0.
    pub manipulability_gain: Option<At<f64>>,
}

/// The backstepping baseline.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BacksteppingFile {
    /// The time constant of the filter that differentiates.
    pub filter_s: At<f64>,
    /// The largest reference acceleration, rad/s² or m/s². Default: none.
    pub acceleration_limit: Option<At<f64>>,
}

/// What an agent transmits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExchangeFile {
    /// Its position and velocity: (a5), of which (aa10) is order 1 and (a1) order 2.
    PositionVelocity,
    /// Its position only: (24).
    Position,
}

/// Reference dynamics of one agent; what is exchanged is the same for all.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AgentReferenceFile {
    /// Agreement on a position.
    Consensus(AgentConsensusFile),
    /// Agreement over a fixed graph.
    PureIntegral(AgentConsensusFile),
    /// A target of its own.
    Tracking(TrackingFile),
}

/// Reference dynamics of one agent.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AgentConsensusFile {
    /// The positive numbers κ₀, κ₁, … in 1/s of this agent.
    #[schemars(with = "Option<Vec<Positive>>", length(min = 1, max = 32))]
    pub roots_per_s: Option<At<Vec<At<f64>>>>,
    /// The gain λ of Remark 4 of this agent.
    pub manipulability_gain: Option<At<f64>>,
}

/// How the velocity is made to follow the reference velocity.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LawFile {
    /// The parameters of the robot are unknown and estimated: (6) and (7) of the paper.
    Adaptive(AdaptiveFile),
    /// The parameters of the robot are known.
    Known(KnownFile),
    /// A point mass of unknown mass whose velocity is not measured: (a8) of the paper.
    PositionOnly(PositionOnlyFile),
    /// A vehicle with one thrust: (46), (50) or (57) of the paper.
    Thrust(ThrustFile),
    /// The tip of a robot follows a target, with uncertain lengths and without its velocity: (80) to (82) of the paper.
    TaskSpace(Box<TaskSpaceFile>),
    /// A spacecraft follows an attitude, without its angular velocity: (97) to (105) of the paper.
    Attitude(AttitudeFile),
    /// A chain of derivatives that is known.
    Linearising(LinearisingFile),
    /// A chain of derivatives with unknown parameters.
    LinearAdaptive(LinearAdaptiveFile),
    /// The same by immersion and invariance.
    Immersion(ImmersionFile),
    /// A chain in strict-feedback or pure-feedback form with unknown parameters.
    AdaptiveBackstepping(AdaptiveBacksteppingFile),
}

/// The adaptive tracking law.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveFile {
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 8 otherwise.
    pub damping: Option<DampingFile>,
    /// The gain Γ. Default: a bandwidth of 5 1/s for a URDF, 10 otherwise.
    pub adaptation_gain: Option<At<GainOrBandwidth>>,
    /// The estimate at the start. Default: zero.
    pub estimate_start: Option<EstimateStartFile>,
}

/// The tracking law with known parameters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KnownFile {
    /// The gain K. Default: a bandwidth of 20 1/s for a URDF, 8 otherwise.
    pub damping: Option<DampingFile>,
}

/// The gain K of the tracking law.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DampingFile {
    /// A number, the diagonal, or the rows of a symmetric positive definite matrix; in N m s/rad or N s/m.
    Gain(At<GainFile>),
    /// In 1/s; multiplied by the diagonal of the mass matrix at the start.
    BandwidthPerS(#[schemars(with = "Positive")] At<f64>),
}

/// The parameter estimate at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EstimateStartFile {
    /// Nothing is known: all zero.
    Zero,
    /// The true parameters.
    True,
    /// The true parameters times this number.
    Scaled(At<f64>),
    /// These numbers.
    Given(At<Vec<At<f64>>>),
}

/// How to integrate.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SolverFile {
    /// Adaptive or fixed steps. Default: adaptive.
    pub method: Option<MethodFile>,
    /// No step is longer, in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub max_step_s: Option<At<f64>>,
    /// The run breaks down when a shorter step would be needed, in s. Default: 1e-12.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub min_step_s: Option<At<f64>>,
    /// Bytes that transmitted messages may take for as long as they can be heard. The run breaks down when steps become so
    /// short that more would be needed. Default: 1073741824, which is 1 GiB.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub memory_budget_bytes: Option<At<i64>>,
    /// Keep the books of the Lyapunov function along the run. Default: true.
    pub ledger: Option<bool>,
}

/// The time-stepping method.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MethodFile {
    /// Steps chosen so that the error stays within a tolerance.
    Adaptive(AdaptiveMethodFile),
    /// Steps of one length, cut where the network changes.
    Fixed(FixedMethodFile),
}

/// Tolerances of the adaptive method.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveMethodFile {
    /// Relative tolerance. Default: 1e-6.
    #[schemars(range(min = 1e-14, max = 0.1))]
    pub rtol: Option<At<f64>>,
    /// Absolute tolerance. Default: 1e-8.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub atol: Option<At<f64>>,
}

/// The fixed step.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedMethodFile {
    /// Length of a step, in s.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub step_s: At<f64>,
}

/// What the run is expected to show; missing it makes the exit status 1.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1))]
pub struct GoalFile {
    /// Agreement: at the end no two agents are further apart than this on any axis, in rad or m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub disagreement_below: Option<At<f64>>,
    /// Tracking: at the end no agent is further from its target than this on any axis, in rad or m.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub error_below: Option<At<f64>>,
    /// Whether the agents are expected to agree (the default) or to end further apart than they began.
    pub expect: Option<At<ExpectFile>>,
}

/// What is expected of the agents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExpectFile {
    /// They come closer than `disagreement_below`.
    Agrees,
    /// They end further apart than they began.
    Diverges,
}
