//! Evidence of graphs and their schedule.

use forwardstep_sim::Exchange;
use forwardstep_sim::leader::FollowingDesign;
use forwardstep_sim::schedule::ScheduleFault;

use super::holds;
use crate::hypothesis::{Answer, Named, Rigour};

/// What was found of the graphs.
#[derive(Clone, Debug, PartialEq)]
pub enum GraphEvidence {
    /// The union over every window this long has a directed spanning tree.
    Window {
        /// The smallest such length, s; zero when one graph stays for ever.
        length_s: f64,
        /// The switching time from which all of it is needed, s.
        worst_start_s: f64,
        /// The roots of the union over that window.
        roots: Vec<Named>,
        /// Whether that is so for all time, or shown up to the end of the run only.
        for_all_time: bool,
        /// Whether graphs are drawn, some of them without a tree: such a one is almost surely drawn any number of times in a row
        /// some time, so that no window is long enough for ever.
        drawn: bool,
    },
    /// Graphs are drawn, and each of them has a directed spanning tree by itself.
    EveryGraph {
        /// How many there are.
        graphs: usize,
    },
    /// Unions have one, but the run, beyond which nothing is known, is not more than twice as long as one waits for it.
    Once {
        /// How long one waits, s, or until the end.
        wait_s: f64,
        /// From then on, s.
        start_s: f64,
        /// The end of the run, s.
        end_s: f64,
    },
    /// From some time on no union has a directed spanning tree.
    Cut {
        /// From then on, s.
        start_s: f64,
        /// Until then, s, where a schedule that is drawn, or comes from outside, may bring the edge later; `None` for ever.
        until_s: Option<f64>,
        /// The groups that hear no agent outside themselves.
        closed_groups: Vec<Vec<Named>>,
    },
    /// The leader reaches everybody within every window this long.
    Reached {
        /// In s; zero when one graph stays for ever.
        length_s: f64,
        /// As in [`GraphEvidence::Window`].
        for_all_time: bool,
    },
    /// From some time on nothing of the leader reaches these.
    Unreached {
        /// From then on, s.
        start_s: f64,
        /// As in [`GraphEvidence::Cut`].
        until_s: Option<f64>,
        /// They hear no agent outside themselves.
        closed_group: Vec<Named>,
    },
    /// The leader reaches everybody in each graph that is in force at arbitrarily late times.
    InEveryGraph {
        /// How many there are.
        graphs: usize,
        /// As in [`GraphEvidence::Window`].
        for_all_time: bool,
    },
    /// A graph in which nothing of the leader reaches some, in force again and again or for ever.
    Unheard {
        /// Which phase, from one.
        phase: usize,
        /// They hear no agent outside themselves.
        closed_group: Vec<Named>,
        /// As in [`GraphEvidence::Window`].
        for_all_time: bool,
    },
    /// One graph stays for ever, so it never switches.
    NeverSwitches,
    /// The shortest of the phases, but for a last one that stays.
    ShortestPhase {
        /// In s.
        dwell_s: f64,
    },
    /// Phases are drawn, and last at least this long.
    DrawnPhases {
        /// In s.
        least_s: f64,
    },
    /// The shortest of the phases of a table, which says nothing of what follows it.
    LoggedPhases {
        /// In s; `None` where it has one phase alone.
        dwell_s: Option<f64>,
    },
    /// The author of a switching signal says that phases last at least this long.
    DeclaredPhases {
        /// In s.
        least_s: f64,
    },
    /// A switching signal from outside is not what its author says.
    RefutedSwitching {
        /// What it is called.
        words: &'static str,
        /// What was found.
        fault: ScheduleFault,
    },
    /// One graph stays for ever.
    Stays,
    /// One graph stays for ever, but a weight changes.
    VaryingWeight,
    /// Graphs take turns, under reference dynamics for a fixed one.
    Switches {
        /// How many graphs.
        graphs: usize,
        /// What is exchanged.
        exchange: Exchange,
    },
    /// A leader is followed over a graph that switches, by a design for which that matters.
    SwitchesUnderLeader {
        /// The design; (110) here if messages are late besides.
        design: FollowingDesign,
    },
    /// Every edge among agents leads both ways with the same weight.
    Mutual,
    /// An edge that does not.
    OneWay {
        /// Who is heard, and who hears; at least one such pair.
        edges: Vec<[Named; 2]>,
    },
}

impl GraphEvidence {
    pub(super) fn answer(&self) -> Answer {
        match self {
            GraphEvidence::Window { for_all_time, .. }
            | GraphEvidence::Reached { for_all_time, .. }
            | GraphEvidence::InEveryGraph { for_all_time, .. } => holds(*for_all_time),
            GraphEvidence::Unheard { for_all_time: false, .. } => Answer::NotShown,
            GraphEvidence::Cut { until_s: Some(_), .. }
            | GraphEvidence::Unreached { until_s: Some(_), .. }
            | GraphEvidence::Once { .. } => Answer::NotShown,
            GraphEvidence::Cut { until_s: None, .. }
            | GraphEvidence::Unreached { until_s: None, .. }
            | GraphEvidence::Unheard { for_all_time: true, .. }
            | GraphEvidence::RefutedSwitching { .. } => Answer::Violated,
            GraphEvidence::EveryGraph { .. }
            | GraphEvidence::NeverSwitches
            | GraphEvidence::ShortestPhase { .. }
            | GraphEvidence::DrawnPhases { .. }
            | GraphEvidence::Stays
            | GraphEvidence::Mutual => Answer::Holds,
            GraphEvidence::LoggedPhases { .. } => Answer::HoldsOnHorizon,
            GraphEvidence::DeclaredPhases { .. } => Answer::NotShown,
            GraphEvidence::VaryingWeight
            | GraphEvidence::Switches { .. }
            | GraphEvidence::SwitchesUnderLeader { .. }
            | GraphEvidence::OneWay { .. } => Answer::NotCovered,
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            GraphEvidence::Window { for_all_time, .. }
            | GraphEvidence::Reached { for_all_time, .. }
            | GraphEvidence::InEveryGraph { for_all_time, .. }
            | GraphEvidence::Unheard { for_all_time, .. } => {
                if *for_all_time {
                    Rigour::Exact
                } else {
                    Rigour::Given
                }
            }
            GraphEvidence::Cut { until_s: Some(_), .. }
            | GraphEvidence::Unreached { until_s: Some(_), .. }
            | GraphEvidence::Once { .. }
            | GraphEvidence::LoggedPhases { .. }
            | GraphEvidence::RefutedSwitching { .. } => Rigour::Given,
            GraphEvidence::DeclaredPhases { .. } => Rigour::Declared,
            GraphEvidence::Cut { until_s: None, .. }
            | GraphEvidence::Unreached { until_s: None, .. }
            | GraphEvidence::EveryGraph { .. }
            | GraphEvidence::NeverSwitches
            | GraphEvidence::ShortestPhase { .. }
            | GraphEvidence::DrawnPhases { .. }
            | GraphEvidence::Stays
            | GraphEvidence::VaryingWeight
            | GraphEvidence::Switches { .. }
            | GraphEvidence::SwitchesUnderLeader { .. }
            | GraphEvidence::Mutual
            | GraphEvidence::OneWay { .. } => Rigour::Exact,
        }
    }
}
