//! The scenario file as it is written. The doc comments of this file are the descriptions of the published JSON schema.

use std::borrow::Cow;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Visitor};

use super::at::At;
use super::attitude_file::{AttitudeStartFile, WheelStartFile};
use super::control_file::ControlFile;
use super::leader_file::LeaderFile;
use super::network_file::NetworkFile;
use super::push_file::PushFile;
use super::systems_file::TargetFile;
use super::values::StartValues;

/// The names under which [`RobotFile`], [`LawFile`], [`ReferenceFile`] and [`AgentReferenceFile`] ask their deserialiser for the key of a kind.
pub(super) const ROBOT: &str = "$forwardstep::Robot";
pub(super) const LAW: &str = "$forwardstep::Law";
pub(super) const REFERENCE: &str = "$forwardstep::Reference";
pub(super) const AGENT_REFERENCE: &str = "$forwardstep::AgentReference";

/// A forwardstep scenario: a network of robots, how they are controlled, and how long to watch them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "forwardstep scenario")]
pub struct ScenarioFile {
    /// The version of this format.
    #[schemars(extend("const" = 2))]
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
    /// What everybody follows, where there is a leader: one more vertex of the network, which hears no agent.
    pub leader: Option<At<LeaderFile>>,
    /// The tracking law of all agents that have none of their own.
    pub law: Option<At<LawFile>>,
    /// Where agents start that say nothing of their own.
    pub start: Option<At<StartFile>>,
    /// Who hears whom, when, and how late. Not needed where every agent follows a target of its own.
    pub network: Option<At<NetworkFile>>,
    /// How the controllers sample. Default: they work in continuous time, as in the paper.
    pub control: Option<ControlFile>,
    /// What acts on the agents from outside: forces, torques and virtual springs.
    #[serde(default)]
    pub external_wrenches: Vec<At<PushFile>>,
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
    /// Where rows are, in the place of `record_every_s`. The start and the end of the run have one in any case.
    pub record_at: Option<At<RecordAtFile>>,
}

/// When rows are recorded.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RecordAtFile {
    /// At every sample of the controllers, just after it.
    Samples,
    /// At these times, in s; rising.
    TimesS(At<Vec<At<f64>>>),
    /// At the times of a table.
    Csv(TimesCsvFile),
}

/// A table of times.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimesCsvFile {
    /// The CSV file, beside the scenario file or in `inputs` beside it, with one column, `t_s`, rising.
    pub file: At<String>,
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
    pub parameter_variation: Option<At<SpreadFile>>,
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

/// The robot of an agent: the key of a kind, whose table stays in the tree of the file.
#[derive(Clone, Debug)]
pub struct RobotFile {
    /// The key.
    pub key: String,
}

/// The law of an agent: the key of a kind, whose table stays in the tree of the file.
#[derive(Clone, Debug)]
pub struct LawFile {
    /// The key.
    pub key: String,
}

/// The reference dynamics of all agents: the key of a kind, whose table stays in the tree of the file.
#[derive(Clone, Debug)]
pub struct ReferenceFile {
    /// The key.
    pub key: String,
}

/// What an agent states of its own: the key of everybody's reference dynamics, whose table stays in the tree of the file.
#[derive(Clone, Debug)]
pub struct AgentReferenceFile {
    /// The key.
    pub key: String,
}

/// Implements what a choice of a kind needs: its key goes through serde, its table stays where it is, and the schema is
/// filled in by the list of kinds.
macro_rules! kind {
    ($file:ident, $name:ident, $schema:literal) => {
        impl<'de> Deserialize<'de> for $file {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_newtype_struct($name, KeyVisitor).map(|key| $file { key })
            }
        }

        impl JsonSchema for $file {
            fn schema_name() -> Cow<'static, str> {
                $schema.into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({ "type": "object" })
            }
        }
    };
}

pub(super) use kind;

kind!(RobotFile, ROBOT, "RobotFile");
kind!(LawFile, LAW, "LawFile");
kind!(ReferenceFile, REFERENCE, "ReferenceFile");
kind!(AgentReferenceFile, AGENT_REFERENCE, "AgentReferenceFile");

pub(super) struct KeyVisitor;

impl Visitor<'_> for KeyVisitor {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table with one key")
    }

    fn visit_str<E: serde::de::Error>(self, key: &str) -> Result<String, E> {
        Ok(key.to_owned())
    }
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
    pub spacecraft: Option<At<WheelStartFile>>,
    /// Which of the two quaternions of its attitude a spacecraft with a target starts with, q or −q: they are one attitude, but
    /// the law leads one of them round the longer way. Default: shortest.
    pub rotation: Option<At<RotationFile>>,
    /// What else there is of a chain: its derivatives from the second on, or x2, x3, … of one in feedback form.
    pub higher_states: Option<At<StartValues>>,
    /// The state of the reference dynamics.
    pub reference: Option<At<ReferenceStartFile>>,
}

/// The way round from an attitude to a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RotationFile {
    /// By 180 degrees at most.
    Shortest,
    /// By 180 degrees at least.
    Longest,
    /// Whichever the stated quaternion leads to; an axis and an angle θ are (sin(θ/2) axis, cos(θ/2)).
    AsStated,
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
    /// Of a spacecraft the attitude R_z that turns with z. Default: its own attitude.
    pub attitude: Option<At<AttitudeStartFile>>,
    /// What the filter holds: of a spacecraft y, four numbers; under `reference.backstepping` one for every axis, in rad/s or m/s.
    /// Default: what it settles at.
    pub filter: Option<At<StartValues>>,
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
    /// Compute the Lyapunov balance V + ∫ dissipation = V(0) along the run. Default: true.
    pub lyapunov_balance: Option<bool>,
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
