//! Why a scenario is refused.

use forwardstep_core::GainError;
use forwardstep_core::plant::{CascadeError, SpacecraftError};
use forwardstep_core::robot::tree::TipError;
use forwardstep_sim::SetupError;
use forwardstep_sim::trajectory::{SplineError, TrajectoryError};
use thiserror::Error;

use super::control_problem::ControlProblem;
use super::formula::FormulaProblem;
use super::network_problem::NetworkProblem;
use super::push_problem::PushProblem;
use super::refusal;
use super::table::TableProblem;
use crate::Problem;
use crate::files::ReadError;
use crate::wording::{about, are, axes, choose, count, entry_count, number};

/// Why a scenario has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ScenarioProblem {
    // The text.
    /// The text is not TOML.
    #[error("not valid TOML: {message}")]
    Unreadable {
        /// What the TOML parser says.
        message: String,
    },
    /// A value of another kind was expected.
    #[error("found {found} where {expected} should stand")]
    WrongType {
        /// What was found.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A list of fixed length has another.
    #[error("found a list of {found} where {need} are needed")]
    ListLength {
        /// Entries that were found.
        found: usize,
        /// Entries that are needed.
        need: usize,
    },
    /// A text that is too long, or holds more than letters.
    #[error("the text {found} does not fit into a line")]
    Text {
        /// How it begins.
        found: String,
        /// How many bytes it may have.
        most: usize,
    },
    /// A key that means nothing here.
    #[error("unknown key `{key}`")]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys that mean something.
        allowed: Vec<&'static str>,
    },
    /// A key that must be there is not.
    #[error("the key `{key}` is missing")]
    MissingKey {
        /// The key.
        key: &'static str,
    },
    /// A choice that does not exist.
    #[error("unknown choice `{found}`")]
    UnknownChoice {
        /// What was written.
        found: String,
        /// What can be chosen.
        allowed: Vec<&'static str>,
    },
    /// Nothing was chosen.
    #[error("nothing is chosen here")]
    NoChoice {
        /// What can be chosen.
        allowed: Vec<&'static str>,
    },
    /// Two things were chosen where one is needed.
    #[error("both `{first}` and `{second}` are given, but only one can be")]
    TwoChoices {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// A choice was made without what belongs to it.
    #[error("`{choice}` needs a value")]
    ChoiceNeedsValue {
        /// The choice.
        choice: String,
    },
    /// A value was given to a choice that has none.
    #[error("`{choice}` takes no value")]
    ChoiceTakesNoValue {
        /// The choice.
        choice: String,
    },

    // Numbers.
    /// A number that is infinite, or none.
    #[error("{found} is not a finite number")]
    NotFinite {
        /// What was written.
        found: String,
    },
    /// A number so large that it cannot be computed with.
    #[error("{found} is too large a number")]
    NumberTooLarge {
        /// What was written.
        found: String,
    },
    /// A number that must be positive is not.
    #[error("`{key}` is {}, but must be positive", number(*.value))]
    NotPositive {
        /// The key.
        key: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must not be negative is.
    #[error("`{key}` is {}, but must not be negative", number(*.value))]
    Negative {
        /// The key.
        key: &'static str,
        /// The number.
        value: f64,
    },
    /// A number is outside its range.
    #[error("`{key}` is {}, but must be from {} to {}", number(*.value), number(*.low), number(*.high))]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// The number.
        value: f64,
        /// The smallest that is allowed.
        low: f64,
        /// The largest that is allowed.
        high: f64,
    },
    /// Lowest and highest value in the wrong order.
    #[error("`{key}` is [{}, {}], but the first must not exceed the second", number(*.low), number(*.high))]
    Interval {
        /// The key.
        key: &'static str,
        /// The first.
        low: f64,
        /// The second.
        high: f64,
    },
    /// Lowest and highest value that are one, or in the wrong order.
    #[error("`{key}` is [{}, {}], but the first must be less than the second", number(*.low), number(*.high))]
    Range {
        /// The key.
        key: &'static str,
        /// The first.
        low: f64,
        /// The second.
        high: f64,
    },
    /// A list that needs an entry has none.
    #[error("`{key}` is empty")]
    Empty {
        /// The key.
        key: &'static str,
    },
    /// A text that is no formula in t.
    #[error(transparent)]
    Formula(FormulaProblem),
    /// A version of the format that this program does not read.
    #[error("`format` is {found}, but this version reads format 1")]
    Format {
        /// The version.
        found: i64,
    },

    // Agents.
    /// A name that would not work in tables.
    #[error("{name:?} cannot be the name of an agent")]
    AgentName {
        /// The name.
        name: String,
    },
    /// Two agents of one name.
    #[error("a second agent is named `{name}`; the first is on line {first_line}")]
    AgentTwice {
        /// The name.
        name: String,
        /// Where the first is.
        first_line: usize,
    },
    /// More agents than can be simulated.
    #[error("there are {total} agents, but at most {most} are accepted")]
    TooManyAgents {
        /// How many there are.
        total: u64,
        /// How many are accepted.
        most: u64,
    },
    /// Agents that can never agree, because their positions have different lengths.
    #[error("`{first}` has {} and `{other}` has {other_axes}, but agents that agree need as many", axes(*.first_axes))]
    AxesDiffer {
        /// The first agent.
        first: String,
        /// Its number of axes.
        first_axes: usize,
        /// The agent that differs.
        other: String,
        /// Its number of axes.
        other_axes: usize,
    },
    /// A robot file that cannot be read.
    #[error("cannot read the robot file `{file}`: {reason}")]
    RobotFile {
        /// The name as written.
        file: String,
        /// Why not.
        reason: ReadError,
        /// What might be meant.
        known: Vec<String>,
    },
    /// A joint that cannot be locked.
    #[error(transparent)]
    Lock(Box<crate::urdf::UrdfProblem>),
    /// Limits are to be enforced where there are none.
    #[error("`enforce_limits` is true, but axis `{axis}` of `{agent}` has no effort limit")]
    NoEffortLimit {
        /// The agent.
        agent: String,
        /// The axis.
        axis: String,
    },
    /// A planar arm whose mass matrix is not positive definite.
    #[error("the mass matrix of this arm is not positive definite: its second link resists no torque")]
    MassMatrix,

    /// A spread where there is nothing to differ from.
    #[error("`spread` is given, but there is no `count`")]
    SpreadOfOne,
    /// A robot that its spread has made impossible.
    #[error("with this spread the mass matrix of `{agent}` is not positive definite")]
    SpreadMassMatrix {
        /// The agent.
        agent: String,
    },

    // Start, reference and law.
    /// A vector of the wrong length.
    #[error("`{key}` has {}, but `{agent}` needs {need}", entry_count(*.found))]
    VectorLength {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        need: usize,
        /// By whom.
        agent: String,
    },
    /// One list per agent, but not as many as agents.
    #[error("`{key}` has {}, but there {}", count(*found, "list"), are(*agents, "agent"))]
    ListPerAgent {
        /// The key.
        key: &'static str,
        /// How many lists there are.
        found: usize,
        /// How many agents there are.
        agents: usize,
    },
    /// Numbers and lists side by side.
    #[error("`{key}` mixes numbers and lists")]
    MixedList {
        /// The key.
        key: &'static str,
    },
    /// One quantity under two keys.
    #[error("both `{first}` and `{second}` are given, but they say the same")]
    SameQuantity {
        /// One key.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A key whose unit is not that of the robot's axes.
    #[error("`{key}` does not fit `{agent}`, whose axis `{axis}` is measured in {unit}")]
    Unit {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// An axis with another unit.
        axis: String,
        /// Its unit.
        unit: &'static str,
        /// The key that fits any robot.
        any: &'static str,
    },
    /// An agent without roots.
    #[error("`{agent}` has no `roots_per_s`")]
    NoRoots {
        /// The agent.
        agent: String,
    },
    /// An agent's reference dynamics are of another kind than everybody's.
    #[error("`{agent}` cannot have reference dynamics of its own kind; those of all are `{common}`")]
    ReferenceDiffers {
        /// The agent.
        agent: String,
        /// The key of everybody's.
        common: &'static str,
    },
    /// A design of order two with another number of roots.
    #[error("`roots_per_s` has {}, but `pure_integral` takes 2 of them", entry_count(*.found))]
    TwoRoots {
        /// How many there are.
        found: usize,
    },
    /// Reference dynamics of an order beyond use.
    #[error("`{key}` has {}, but at most {most} are accepted", entry_count(*.found))]
    Order {
        /// The key.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many are accepted.
        most: usize,
    },
    /// More derivatives than the reference dynamics have.
    #[error("`derivatives` has {}, but the reference of `{agent}` is of order {order}", entry_count(*.found))]
    Derivatives {
        /// How many there are.
        found: usize,
        /// The agent.
        agent: String,
        /// The order of its reference.
        order: usize,
    },
    /// A gain that cannot be used.
    #[error("`{key}` of `{agent}`: {error}")]
    Gain {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
        /// What is wrong with it.
        error: GainError,
    },
    /// A matrix whose rows have different lengths.
    #[error("`{key}` has {rows} rows, but row {row} has {}", entry_count(*.entries))]
    NotSquare {
        /// The key.
        key: &'static str,
        /// The number of rows.
        rows: usize,
        /// The row that differs, from one.
        row: usize,
        /// How many entries it has.
        entries: usize,
    },

    // Network.
    /// An agent, or a population, that does not exist.
    #[error("there is no agent `{name}`")]
    NoSuchAgent {
        /// The name.
        name: String,
        /// The agents there are, and the populations where one may be named.
        agents: Vec<String>,
    },
    /// A table that has no meaning, or cannot be read.
    #[error(transparent)]
    Table(#[from] TableProblem),
    /// More switches or jumps than any run could land on.
    #[error("about {} {what} until the end of the run, but at most {} are accepted", about(*.events), number(*.most))]
    TooManyEvents {
        /// Switches of the graph, or jumps of the delay.
        what: &'static str,
        /// How many.
        events: f64,
        /// How many are accepted.
        most: f64,
    },

    /// A network that has no meaning.
    #[error(transparent)]
    Network(#[from] NetworkProblem),
    /// Digital control that has no meaning.
    #[error(transparent)]
    Control(#[from] ControlProblem),
    /// A push that has no meaning.
    #[error(transparent)]
    Push(#[from] PushProblem),

    // Solver.
    /// No step is long enough and short enough.
    #[error("`{key}` is {}, but must not be less than `min_step_s`, which is {}", number(*.value), number(*.min_step_s))]
    StepUnderFloor {
        /// The key.
        key: &'static str,
        /// The step.
        value: f64,
        /// The floor.
        min_step_s: f64,
    },

    // Recording and goal.
    /// A recording that would not fit into memory.
    #[error(
        "the recording would hold {} numbers, {} rows of {columns} columns, but at most {} fit",
        about(*.rows * *.columns as f64), about(*.rows), number(*.most)
    )]
    RecordingTooLarge {
        /// How many rows.
        rows: f64,
        /// How many columns.
        columns: usize,
        /// How many numbers are accepted.
        most: f64,
        /// The shortest `record_every_s` that would do.
        least_s: f64,
    },

    /// A goal that asks for nothing.
    #[error("the goal says nothing about the disagreement")]
    EmptyGoal,
    /// A threshold that is not used.
    #[error("`{key}` says nothing about agents that diverge")]
    ThresholdUnused {
        /// The threshold.
        key: &'static str,
    },
    /// Two goals.
    #[error("`disagreement_below` and `error_below` are both given")]
    TwoGoals,
    /// An error, but no target.
    #[error("`error_below` is about targets and leaders, but the agents agree with each other")]
    NothingTracked,
    /// A disagreement among agents that do not agree.
    #[error("`disagreement_below` is about agreement, but every agent follows a target or a leader")]
    NothingAgreed,

    /// Sinusoids that make no trajectory.
    #[error(transparent)]
    Trajectory(TrajectoryError),
    /// Points and times that do not match.
    #[error("`positions` has {}, but `times_s` has {}", entry_count(*.points), entry_count(*.times))]
    PointsAndTimes {
        /// How many points.
        points: usize,
        /// How many times.
        times: usize,
    },
    /// Points that make no curve.
    #[error(transparent)]
    Points(SplineError),
    /// Followers without a leader.
    #[error("the agents are to follow a leader, but there is none")]
    NoLeader,
    /// A leader whom nobody follows.
    #[error("there is a leader, but `reference.{reference}` does not follow one")]
    LeaderUnused {
        /// The reference dynamics.
        reference: &'static str,
    },
    /// A coupling where there is none.
    #[error("`coupling` belongs to the design `swarm`")]
    CouplingUnused,
    /// As many roots as the design has.
    #[error("`roots_per_s` has {}, but this design needs {need}", entry_count(*.found))]
    LeaderRoots {
        /// How many there are.
        found: usize,
        /// How many are needed.
        need: usize,
    },
    /// A target that has no value somewhere on the run.
    #[error("this has no finite value everywhere from 0 s to {end_s} s, or that could not be shown")]
    TargetValue {
        /// The end of the run, s.
        end_s: f64,
    },
    /// A spacecraft that makes no sense.
    #[error(transparent)]
    Spacecraft(SpacecraftError),
    /// A direction that is zero.
    #[error("this is zero and has no direction")]
    NoDirection {
        /// What would have one.
        instead: &'static str,
    },
    /// A desired attitude that is zero.
    #[error("this is no attitude at {} s: its four entries are zero there", number(*.t_s))]
    NoAttitude {
        /// When, s.
        t_s: f64,
    },
    /// An initial value that an agent does not have.
    #[error("`{key}` says nothing about `{agent}`")]
    StartUnused {
        /// The key.
        key: &'static str,
        /// The agent.
        agent: String,
    },
    /// Two ways of stating an attitude, or half of one.
    #[error("an attitude is `axis` with `angle_rad`, or `quaternion`")]
    HalfAttitude,
    /// A tip whose Jacobian cannot be inverted.
    #[error(transparent)]
    Tip(TipError),
    /// A joint that moves beside the tip.
    #[error("`{joint}` moves, but does not carry `{link}`")]
    TipBeside {
        /// The joint.
        joint: String,
        /// The link with the tip.
        link: String,
    },
    /// A robot from a URDF without a tip.
    #[error("the law `task_space` needs `tip` for a robot from a URDF")]
    NoTip,
    /// A tip where there is one already.
    #[error("the tip of a planar arm is the end of its second link; `tip` is for robots from a URDF")]
    TipOfPlanarArm,
    /// Bounds beside a full matrix.
    #[error("`bounds` need `kinematic_gain` to be a number or a diagonal, not a matrix")]
    BoundsOfMatrix,
    /// A chain without meaning.
    #[error("{0}")]
    Chain(CascadeError),
    /// Antiderivatives that have to be given.
    #[error("agent `{agent}`: a regressor holds the highest derivative of x, so its antiderivative must be given")]
    Antiderivatives {
        /// The agent.
        agent: String,
    },
    /// A law that is made for something else.
    #[error("agent `{agent}`: the law `{law}` is made for {made_for}")]
    LawOfAnother {
        /// The agent.
        agent: String,
        /// The law's key.
        law: &'static str,
        /// What it is made for, in words.
        made_for: &'static str,
        /// The laws that suit the agent's robot.
        laws: &'static str,
    },
    /// What the closed loop refuses although every number by itself has a meaning.
    #[error("{0}")]
    Setup(SetupError),
}

impl Problem for ScenarioProblem {
    fn help(&self) -> Option<String> {
        let text = match self {
            ScenarioProblem::UnknownKey { key, allowed } => choose(key, "allowed here:", allowed),
            ScenarioProblem::UnknownChoice { found, allowed } => choose(found, "choose one of", allowed),
            ScenarioProblem::NoChoice { allowed } => choose("", "choose one of", allowed),
            ScenarioProblem::NumberTooLarge { .. } => {
                "numbers may be up to 1e30 in size, whole numbers up to 9e18".into()
            }
            ScenarioProblem::Text { most, .. } => {
                format!("names, choices and titles are one line of at most {most} bytes without control characters")
            }
            ScenarioProblem::WrongType { found, expected } if found == "a table" && expected == "a list" => {
                "a list of tables has its name in double brackets, such as [[agents]]".into()
            }
            ScenarioProblem::ChoiceNeedsValue { choice } => format!("write it with its value: {{ {choice} = … }}"),
            ScenarioProblem::HalfAttitude => {
                "write `axis = [0, 0, 1]` and `angle_rad = 1.5`, or `quaternion = [0, 0, 0, 1]` alone".into()
            }
            ScenarioProblem::TipBeside { joint, .. } => format!("add `{joint}` to `locked`, or choose a link behind it"),
            ScenarioProblem::TipOfPlanarArm => "leave `tip` out".into(),
            ScenarioProblem::Tip(TipError::Coordinate { .. }) => "choose `x`, `y` and `z`, each at most once".into(),
            ScenarioProblem::Spacecraft(SpacecraftError::Axis { .. }) => "[1, 0, 0] is the first axis of the body".into(),
            ScenarioProblem::ChoiceTakesNoValue { choice } => format!("write it as a text: \"{choice}\""),
            ScenarioProblem::AgentName { .. } => "use up to 64 letters, digits, `-` and `_`".into(),
            ScenarioProblem::AgentTwice { .. } => {
                "agents of a counted population are named after it: `arm` with `count = 2` gives `arm-1` and `arm-2`"
                    .into()
            }
            ScenarioProblem::AxesDiffer { .. } => {
                "agreement is on one vector of axes; `locked` removes joints of a URDF".into()
            }
            ScenarioProblem::RobotFile { reason, .. } if reason.help().is_some() => {
                reason.help().unwrap_or_default().into()
            }
            ScenarioProblem::RobotFile { file, known, .. } if !known.is_empty() => choose(file, "there are", known),
            ScenarioProblem::Lock(problem) => return problem.help(),
            ScenarioProblem::NoTip => "add tip = { link = \"…\" } with a link of the URDF".into(),
            ScenarioProblem::Tip(TipError::Size { .. }) => "`locked` of the robot holds joints of a URDF".into(),
            ScenarioProblem::NoEffortLimit { .. } => {
                "only a URDF states limits, as <limit effort=\"…\"> of a joint".into()
            }
            ScenarioProblem::MassMatrix => "give the second link inertia, or a centre of mass off its joint".into(),
            ScenarioProblem::SpreadOfOne => "a population of `count = 1` may have a spread, too".into(),
            ScenarioProblem::SpreadMassMatrix { .. } => {
                "some body has an inertia that no body can have; correct it, or let `relative` be smaller".into()
            }
            ScenarioProblem::Unit { any, .. } => format!("`{any}` takes rad or m as each axis has it"),
            ScenarioProblem::NoRoots { .. } => {
                "add `roots_per_s` to [reference.consensus], or `reference.consensus.roots_per_s` to the agent".into()
            }
            ScenarioProblem::ReferenceDiffers { common, .. } => match *common {
                "backstepping" => "remove it: the baseline has nothing that an agent could have of its own".into(),
                common => format!("an agent may have `reference.{common}` with roots and a gain of its own"),
            },
            ScenarioProblem::TwoRoots { .. } => {
                "(3) and (23) are of order two; other orders are `reference.consensus`".into()
            }
            ScenarioProblem::Derivatives { .. } => "an order of l has the derivatives 1 to l − 1".into(),
            ScenarioProblem::NoSuchAgent { name, agents } => choose(name, "the agents are", agents),
            ScenarioProblem::Table(problem) => return problem.help(),
            ScenarioProblem::Network(problem) => return problem.help(),
            ScenarioProblem::Control(problem) => return problem.help(),
            ScenarioProblem::Push(problem) => return problem.help(),
            ScenarioProblem::Formula(problem) => return problem.help(),
            ScenarioProblem::RecordingTooLarge { least_s, .. } => {
                format!("for this `end_s` let `record_every_s` be at least {}", about(1.05 * least_s))
            }
            ScenarioProblem::TooManyEvents { what: "samples", .. } => {
                "sample more slowly, or let the run end sooner".into()
            }
            ScenarioProblem::TooManyEvents { .. } => "is a unit of time mistaken? All of them are seconds".into(),
            ScenarioProblem::EmptyGoal => {
                "set `disagreement_below = 1e-3` (with targets `error_below`), or `expect = \"diverges\"`, or delete the goal".into()
            }
            ScenarioProblem::ThresholdUnused { .. } | ScenarioProblem::TwoGoals => "delete one of the two".into(),
            ScenarioProblem::NoLeader => "add `[leader]` with a `motion`".into(),
            ScenarioProblem::LeaderUnused { .. } => "write `reference.leader`, or delete the leader".into(),
            ScenarioProblem::LeaderRoots { .. } => "`continuous` has one root, the other designs have two".into(),
            ScenarioProblem::NothingTracked => "write `disagreement_below`".into(),
            ScenarioProblem::NothingAgreed => "write `error_below`".into(),
            ScenarioProblem::TargetValue { .. } => "roots, logarithms and quotients need arguments that stay where they have values".into(),
            ScenarioProblem::LawOfAnother { laws, .. } => format!("for this robot there is {laws}"),
            ScenarioProblem::NoDirection { instead } => (*instead).into(),
            ScenarioProblem::NoAttitude { .. } => {
                "a quaternion may have any length but zero, vector part first: [0, 0, 0, 1] is no turn".into()
            }
            ScenarioProblem::StartUnused { key, .. } => match *key {
                "attitude" => "vehicles, rotorcraft and spacecraft have an attitude".into(),
                "angular_velocity_rad_s" => "rotorcraft and spacecraft have an angular velocity".into(),
                "spacecraft" => "only spacecraft start by it".into(),
                "higher_states" => "only chains of order two or more in feedback form, else of order three or more, have any".into(),
                key if key.starts_with("velocity") => {
                    "chains of order one or in feedback form have `higher_states`, spacecraft `angular_velocity_rad_s`".into()
                }
                _ => "spacecraft start by `attitude`, `angular_velocity_rad_s` and `spacecraft`".into(),
            },
            ScenarioProblem::Setup(error) => return refusal::advice(error),
            _ => return None,
        };
        Some(text)
    }
}
