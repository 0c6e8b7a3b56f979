//! Why a network is refused.

use forwardstep_sim::delay::packets::PacketError;
use forwardstep_sim::topology::TopologyError;
use thiserror::Error;

use crate::wording::{entry_count, number, rounded};

/// Why a network has no meaning.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NetworkProblem {
    /// An edge from an agent to itself.
    #[error("`{name}` cannot hear itself")]
    SelfLoop {
        /// The agent.
        name: String,
    },
    /// An edge that leads to the leader.
    #[error("`{name}` leads and hears nobody")]
    LeaderHears {
        /// The leader.
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
    /// Both a fixed graph and phases.
    #[error("`edges` and `phases` are both given, but a network is either fixed or switches")]
    EdgesAndPhases,
    /// Agents that are to agree need one.
    #[error("there is no network, but the agents are to agree")]
    Missing,
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
}

impl NetworkProblem {
    /// What to do about it.
    pub fn help(&self) -> Option<String> {
        let text = match self {
            NetworkProblem::LeaderHears { .. } => "leave this edge out, or turn it round".into(),
            NetworkProblem::Topology(_) => "an agent hears nobody twice, and never itself".into(),
            NetworkProblem::EdgesAndPhases => "move the edges into a phase, or delete the phases".into(),
            NetworkProblem::Missing => "say who hears whom: `[network]` with `edges`".into(),
            NetworkProblem::NoGraph => "for agents that never hear each other write `edges = []`".into(),
            NetworkProblem::NoDwell { .. } => {
                "only the last phase of a network that switches \"once\" needs none, and random switching".into()
            }
            NetworkProblem::DelayBounds { .. } => {
                "write `max(0, …)` or `abs(…)` around it, or in a simpler way: bounds are best where t appears once"
                    .into()
            }
            NetworkProblem::WeightBounds { .. } => {
                "write `max(0.1, …)` around it; an edge that is not there for a while is left out of a phase".into()
            }
            NetworkProblem::LinkDiffers { .. } => {
                "packets are those of a radio, whatever the graph: give `delay.packets` once, for the network".into()
            }
            NetworkProblem::NotInLog { .. } => {
                "every edge of the network needs at least one row; a lost packet has an empty `delay_s`".into()
            }
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
