//! Why a network is refused.

use forwardstep_sim::delay::packets::PacketError;
use forwardstep_sim::topology::TopologyError;
use thiserror::Error;

use crate::wording::number;

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
    #[error("`{name}` leads and hears no agent")]
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
    /// A delay of a link that is stated once more, by `link_delays` or by an edge.
    #[error("the delay of the link from `{from}` to `{to}` is stated in `link_delays` on line {first_line} already")]
    LinkDelayTwice {
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
        /// Where `link_delays` states it.
        first_line: usize,
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
    /// A link whose held values a log does not have.
    #[error("the log `{file}` has no hold {hold} from `{from}` to `{to}`")]
    NotHeld {
        /// The log.
        file: String,
        /// Its number.
        hold: usize,
        /// The sender.
        from: String,
        /// The receiver.
        to: String,
    },
    /// A log that does not begin with the run.
    #[error("this log does not begin at 0 s")]
    StartsLate,
    /// A log that does not say when it ends.
    #[error("this log does not say when it ends")]
    NoEnd,
    /// Something after the end of a log.
    #[error("this comes after the end of the log")]
    AfterTheEnd,
    /// A log that is shorter than the run.
    #[error("this log ends at {} s, but the run ends at {} s", number(*.until_s), number(*.end_s))]
    LogEndsEarly {
        /// Until when it is, s.
        until_s: f64,
        /// The end of the run, s.
        end_s: f64,
    },
    /// A number of a phase or of a hold that is not whole.
    #[error("{} is no whole number", number(*.found))]
    NotANumber {
        /// What there is.
        found: f64,
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
            NetworkProblem::Topology(_) => "an agent hears no other twice, and never itself".into(),
            NetworkProblem::EdgesAndPhases => "move the edges into a phase, or delete the phases".into(),
            NetworkProblem::Missing => "say who hears whom: `[network]` with `edges`".into(),
            NetworkProblem::NoGraph => "for agents that never hear each other write `edges = []`".into(),
            NetworkProblem::NoDwell { .. } => {
                "only the last phase of a network that switches \"once\" needs none, and random switching".into()
            }
            NetworkProblem::LinkDiffers { .. } => {
                "packets are those of a radio, whatever the graph: give `delay.packets` once, for the network".into()
            }
            NetworkProblem::NotHeld { .. } => "every link that names this log needs its lines".into(),
            NetworkProblem::NoEnd | NetworkProblem::AfterTheEnd => {
                "the last line has a time alone: when the last value ends".into()
            }
            NetworkProblem::LogEndsEarly { .. } => "shorten the run, or write a longer log".into(),
            NetworkProblem::LinkDelayTwice { .. } => {
                "`link_delays` holds for all graphs; leave one of the two statements out".into()
            }
            NetworkProblem::NotInLog { .. } => {
                "every edge of the network needs at least one row; a lost packet has an empty `delay_s`".into()
            }
            _ => return None,
        };
        Some(text)
    }
}
