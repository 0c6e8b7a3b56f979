//! Why a scenario is refused.

use forwardstep_core::GainError;
use forwardstep_sim::delay::packets::PacketError;
use forwardstep_sim::topology::TopologyError;
use thiserror::Error;

use super::formula::FormulaProblem;
use super::push_problem::PushProblem;
use super::table::TableProblem;
use crate::Problem;
use crate::files::ReadError;
use crate::wording::{about, are, choose, count, entry_count, number, rounded};

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
    #[error("`{first}` has {first_axes} axes and `{other}` has {other_axes}, but agents that agree need as many")]
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
    #[error("`roots_per_s` has {}, but at most {most} are accepted", entry_count(*.found))]
    Order {
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
    /// An edge from or to an agent that does not exist.
    #[error("there is no agent `{name}`")]
    NoSuchAgent {
        /// The name.
        name: String,
        /// The agents there are.
        agents: Vec<String>,
    },
    /// An edge from an agent to itself.
    #[error("`{name}` cannot hear itself")]
    SelfLoop {
        /// The agent.
        name: String,
    },
    /// An edge that is there twice.
    #[error("a second edge from `{from}` to `{to}` in one graph; the first is on line {first_line}")]
    EdgeTwice {
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
        /// Where the first is.
        first_line: usize,
    },
    /// A rule for edges that has no meaning for so many agents.
    #[error(transparent)]
    Topology(TopologyError),
    /// An agent that is named twice where each can be once.
    #[error("`{name}` is named twice in `among`")]
    AmongTwice {
        /// The agent.
        name: String,
    },
    /// More edges by rule or from tables than fit into memory.
    #[error("there are {edges} edges, but at most {most} are accepted")]
    TooManyEdges {
        /// How many there are.
        edges: u64,
        /// How many are accepted.
        most: u64,
    },
    /// A table that has no meaning, or cannot be read.
    #[error(transparent)]
    Table(#[from] TableProblem),
    /// Both a fixed graph and phases.
    #[error("`edges` and `phases` are both given, but a network is either fixed or switches")]
    EdgesAndPhases,
    /// Neither a fixed graph nor phases.
    #[error("the network has neither `edges` nor `phases`")]
    NoGraph,
    /// Switching without anything to switch.
    #[error("`switching` is given, but there are no `phases`")]
    NothingToSwitch,
    /// A phase that does not say how long it lasts.
    #[error("phase {phase} has no `dwell_s`")]
    NoDwell {
        /// Its number, from one.
        phase: usize,
    },
    /// A saw-tooth that falls.
    #[error("`min_s` is {}, but must not exceed `max_s`, which is {}", number(*.min_s), number(*.max_s))]
    SawTooth {
        /// The least delay.
        min_s: f64,
        /// The largest delay.
        max_s: f64,
    },
    /// A sinusoid that would be negative at times.
    #[error(
        "`amplitude_s` is {}, but must not exceed `mean_s`, which is {}: a delay is never negative",
        number(*.amplitude_s), number(*.mean_s)
    )]
    Amplitude {
        /// The amplitude.
        amplitude_s: f64,
        /// The mean.
        mean_s: f64,
    },
    /// A piecewise constant delay that does not begin at zero.
    #[error("`times_s` begins at {}, but must begin at 0", number(*.first_s))]
    TimesBegin {
        /// The first time.
        first_s: f64,
    },
    /// Times that do not rise.
    #[error("`times_s` goes from {} to {}, but must rise", number(*.before_s), number(*.after_s))]
    TimesRise {
        /// A time.
        before_s: f64,
        /// The next.
        after_s: f64,
    },
    /// Times and values that do not match.
    #[error("`values_s` has {}, but `times_s` has {}", entry_count(*.values), entry_count(*.times))]
    TimesAndValues {
        /// How many times.
        times: usize,
        /// How many values.
        values: usize,
    },
    /// A period that ends before the last time.
    #[error("`period_s` is {}, but must exceed the last time, {}", number(*.period_s), number(*.last_s))]
    PeriodTooShort {
        /// The period.
        period_s: f64,
        /// The last time.
        last_s: f64,
    },
    /// A formula for a delay that could not be shown to be one.
    #[error("{}", bounds_words("the delay", "must not be negative", *.low, *.high, *.witness, *.end_s))]
    DelayBounds {
        /// The lower bound that was found.
        low: f64,
        /// The upper bound that was found.
        high: f64,
        /// A time at which it is no delay, and its value there, if one was met.
        witness: Option<(f64, f64)>,
        /// The end of the run.
        end_s: f64,
    },
    /// A formula for a weight that could not be shown to be one.
    #[error("{}", bounds_words("the weight", "must be positive", *.low, *.high, *.witness, *.end_s))]
    WeightBounds {
        /// The lower bound that was found.
        low: f64,
        /// The upper bound that was found.
        high: f64,
        /// A time at which it is no weight, and its value there, if one was met.
        witness: Option<(f64, f64)>,
        /// The end of the run.
        end_s: f64,
    },
    /// A formula without t that has no value.
    #[error("the formula for `{key}` has no finite value")]
    NoValue {
        /// The key.
        key: &'static str,
    },
    /// More formulas than can be looked at.
    #[error("there are more than {most} different formulas for delays or for weights")]
    TooManyFormulas {
        /// How many are accepted.
        most: usize,
    },
    /// Packets or random values that make no delay.
    #[error(transparent)]
    Link(PacketError),
    /// One edge with packets of two kinds.
    #[error("the edge from `{from}` to `{to}` has other packets in another graph, but it is one link")]
    LinkDiffers {
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
    },
    /// An edge that a log says nothing about.
    #[error("the log `{file}` has no packet from `{from}` to `{to}`")]
    NotInLog {
        /// The log.
        file: String,
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
    },
    /// Two packets of one edge sent at one time.
    #[error("a second packet from `{from}` to `{to}` sent at {} s; the first is on line {first_line}", number(*.send_s))]
    PacketTwice {
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
        /// When they were sent.
        send_s: f64,
        /// Where the first is.
        first_line: usize,
    },
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
    // Control.
    /// A computation that takes longer than a period.
    #[error("`computation_delay_s` is {}, but the next sample is taken after {} s", number(*.delay_s), number(*.period_s))]
    ComputationDelay {
        /// The delay, s.
        delay_s: f64,
        /// The period, s.
        period_s: f64,
    },
    /// Messages that are on their way for so long that they do not fit into memory.
    #[error(
        "messages are up to {} s old when they are heard, so {} numbers have to be kept, but at most {} are accepted",
        number(*.oldest_s), about(*.numbers), about(*.most)
    )]
    MessagesTooLarge {
        /// The oldest, s.
        oldest_s: f64,
        /// Numbers in all messages that are kept.
        numbers: f64,
        /// How many are accepted.
        most: f64,
    },
    /// A property of measured velocities where none are measured.
    #[error("`{key}` has no effect: velocities are not measured, but come from filtered differences")]
    VelocityNotMeasured {
        /// The key.
        key: &'static str,
    },
    /// A list with an entry for each axis has another length.
    #[error("`{key}` has {found} where the agents have {need} {}", if *.need == 1 { "axis" } else { "axes" })]
    AxisCount {
        /// The key.
        key: &'static str,
        /// Entries that were found.
        found: usize,
        /// Axes.
        need: usize,
    },

    /// A goal that asks for nothing.
    #[error("the goal says nothing about the disagreement")]
    EmptyGoal,
    /// A threshold that is not used.
    #[error("`disagreement_below` says nothing about agents that diverge")]
    ThresholdUnused,
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
            ScenarioProblem::Topology(_) => "an agent hears nobody twice, and never itself".into(),
            ScenarioProblem::Table(problem) => return problem.help(),
            ScenarioProblem::Push(problem) => return problem.help(),
            ScenarioProblem::Formula(problem) => return problem.help(),
            ScenarioProblem::EdgesAndPhases => "move the edges into a phase, or delete the phases".into(),
            ScenarioProblem::NoGraph => "for agents that never hear each other write `edges = []`".into(),
            ScenarioProblem::NoDwell { .. } => {
                "only the last phase of a network that switches \"once\" needs none, and random switching".into()
            }
            ScenarioProblem::RecordingTooLarge { least_s, .. } => {
                format!("for this `end_s` let `record_every_s` be at least {}", about(1.05 * least_s))
            }
            ScenarioProblem::DelayBounds { .. } => {
                "write `max(0, …)` or `abs(…)` around it, or in a simpler way: bounds are best where t appears once"
                    .into()
            }
            ScenarioProblem::WeightBounds { .. } => {
                "write `max(0.1, …)` around it; an edge that is not there for a while is left out of a phase".into()
            }
            ScenarioProblem::LinkDiffers { .. } => {
                "packets are those of a radio, whatever the graph: give `delay.packets` once, for the network".into()
            }
            ScenarioProblem::NotInLog { .. } => {
                "every edge of the network needs at least one row; a lost packet has an empty `delay_s`".into()
            }
            ScenarioProblem::TooManyEvents { what: "samples", .. } => {
                "sample more slowly, or let the run end sooner".into()
            }
            ScenarioProblem::TooManyEvents { .. } => "is a unit of time mistaken? All of them are seconds".into(),
            ScenarioProblem::ComputationDelay { .. } => {
                "a computation must be done before the next begins; sample more slowly, or compute faster".into()
            }
            ScenarioProblem::MessagesTooLarge { .. } => "sample more slowly, or let delays be shorter".into(),
            ScenarioProblem::VelocityNotMeasured { .. } => {
                "delete it, or let `velocity` be \"measured\"; noise and steps of positions count".into()
            }
            ScenarioProblem::AxisCount { .. } => "a single number stands for all axes".into(),
            ScenarioProblem::EmptyGoal => {
                "set `disagreement_below = 1e-3`, or `expect = \"diverges\"`, or delete the goal".into()
            }
            ScenarioProblem::ThresholdUnused => "delete one of the two".into(),
            _ => return None,
        };
        Some(text)
    }
}

/// Why a formula is no delay or weight: at a time that was met, else by its bounds.
fn bounds_words(what: &str, must: &str, low: f64, high: f64, witness: Option<(f64, f64)>, end_s: f64) -> String {
    match witness {
        Some((t_s, value)) if value.is_finite() => {
            format!("{what} is {} at t = {} s, but {must}", number(rounded(value)), number(rounded(t_s)))
        }
        Some((t_s, _)) => format!("{what} has no finite value at t = {} s", number(rounded(t_s))),
        None => format!(
            "{what} {must}, but could only be shown to lie between {} and {} until the end of the run at {} s",
            number(rounded(low)),
            number(rounded(high)),
            number(end_s)
        ),
    }
}
